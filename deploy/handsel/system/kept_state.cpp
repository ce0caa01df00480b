// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/kept_state.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>

namespace handsel {

std::string standing(const supervisor::DurableState& state) {
  const SafetyState& s = state.safety;
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  const std::string why = s.reason.substr(0, s.reason.find("; next: "));
  if (!why.empty())
    add(why + (s.fault ? " (`handsel task acknowledge`" : " (`handsel task resume`") +
        (s.fault && s.paused ? ", then `handsel task resume`)" : ")"));
  if (s.override_factor < 1.0)
    add("speed override " + std::to_string(std::lround(100 * s.override_factor)) +
        " % (`handsel speed 100`)");
  for (const Person& person : s.lost)
    add(person.id + " is lost from sight (`handsel task clear-person " + person.id + "`)");
  return text;
}

KeptState::KeptState(const std::filesystem::path& folder) {
  if (folder.empty()) return;
  store_.emplace(folder);
  const Stamp now =
      std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())
          .count();
  const auto state = store_->read(1, now);
  if (!state) return;
  if (const std::string text = standing(*state); !text.empty())
    std::fprintf(stderr, "handsel: the system before did not end in order; still in force: %s\n",
                 text.c_str());
}

KeptState::~KeptState() {
  if (!store_) return;
  if (const std::string why = store_->forget(); !why.empty())
    std::fprintf(stderr, "handsel: %s\n", why.c_str());
}

}  // namespace handsel
