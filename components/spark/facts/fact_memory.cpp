// SPDX-License-Identifier: Apache-2.0
#include "components/spark/facts/fact_memory.hpp"

#include <cstdarg>
#include <cstdio>

namespace handsel::spark {

std::string evidence(const char* format, ...) {
  char line[120];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

std::vector<Fact> FactMemory::update(const std::vector<Candidate>& candidates, TimePoint now) {
  for (const Candidate& c : candidates) {
    const auto known = states_.find({c.kind, c.subject, c.object});
    if (known == states_.end() ? !c.begins : !c.begins && !c.stays) continue;
    State& state = known == states_.end() ? states_[{c.kind, c.subject, c.object}] : known->second;
    if (known == states_.end()) state.since = now;
    state.confirmed = now;
    state.fact = {c.kind, c.subject, c.object, c.value, 0, c.evidence};
  }
  std::vector<Fact> facts;
  for (auto entry = states_.begin(); entry != states_.end();) {
    State& state = entry->second;
    if (to_seconds(now - state.confirmed) > dwell_) {
      entry = states_.erase(entry);
      continue;
    }
    state.fact.since = to_seconds(now - state.since);
    facts.push_back(state.fact);
    ++entry;
  }
  return facts;
}

}  // namespace handsel::spark
