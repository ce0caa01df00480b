// SPDX-License-Identifier: Apache-2.0
#include "common/config/people.hpp"

#include <set>
#include <string>

#include "common/config/settings_text.hpp"

namespace handsel {

settings::PeopleProfiles load_people(const std::filesystem::path& folder) {
  constexpr double kMinHeight = 0.8;  // min height of a person [m]
  const std::filesystem::path file = folder / "people.txtpb";
  if (!std::filesystem::exists(file)) return {};
  SettingsText text;
  auto profiles = settings::read_people_profiles(file, &text);
  std::set<std::string> known;
  for (const settings::PersonProfile& one : profiles.people) {
    if (one.id.empty()) text.refuse("people", "a profile needs the person's id");
    if (!known.insert(one.id).second) text.refuse("people", one.id + " has two profiles");
    if (one.height != 0 && one.height < kMinHeight)
      text.refuse("people", "height of " + one.id + " must be 0 (as it is seen) or in [0.8, 2.5]");
  }
  return profiles;
}

}  // namespace handsel
