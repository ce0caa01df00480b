#include "common/config/people.hpp"

#include <set>
#include <string>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"

namespace handsel {

config::PeopleProfiles load_people(const std::filesystem::path& settings) {
  constexpr double kShortest = 0.8, kTallest = 2.5;  // [m]
  config::PeopleProfiles profiles;
  const std::filesystem::path file = settings / "people.txtpb";
  if (!std::filesystem::exists(file)) return profiles;
  load_text_proto(file, profiles);
  std::set<std::string> known;
  for (const config::PersonProfile& one : profiles.people()) {
    const auto refuse = [&](const std::string& what) {
      throw ConfigError(file.string() + ": people: " + what);
    };
    if (one.id().empty()) refuse("a profile needs the person's id");
    if (!known.insert(one.id()).second) refuse(one.id() + " has two profiles");
    if (one.height() != 0 && !(one.height() >= kShortest && one.height() <= kTallest))
      refuse("height of " + one.id() + " must be 0 (as it is seen) or in [0.8, 2.5]");
  }
  return profiles;
}

}  // namespace handsel
