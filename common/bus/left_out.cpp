// SPDX-License-Identifier: Apache-2.0
#include "common/bus/left_out.hpp"

#include "common/bus/intake.hpp"

namespace handsel {
namespace {
constexpr std::size_t kMaxCounts = 32;  // bound of ComponentHealth.left_out
constexpr std::size_t kMaxNames = 24;   // max names, the rest is for subscriptions
constexpr const char* kOther = "other";
}  // namespace

void LeftOutCounts::add(const std::string& what, std::uint64_t more) {
  if (more == 0) return;
  const bool room = counts_.contains(what) || counts_.size() + 1 < kMaxNames;
  counts_[room ? what : kOther] += more;
}

std::vector<NamedCount> LeftOutCounts::counts() const {
  std::vector<NamedCount> out;
  for (const auto& [name, count] : counts_) out.push_back({name, count});
  return out;
}

void add_left_out(const Intake& intake, std::vector<NamedCount>& counts) {
  if (intake.status().left_out == 0 || counts.size() >= kMaxCounts) return;
  counts.push_back({std::string(intake.type().row().topic) + ": malformed elements of lists",
                    intake.status().left_out});
}

}  // namespace handsel
