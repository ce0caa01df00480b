// SPDX-License-Identifier: Apache-2.0
// The action regrasp without a place where the object is to stand: the object ends in the other
// hand. Own method: the first hand puts it down within reach of both, the other picks it up there.
#include <algorithm>

#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/pick.hpp"
#include "components/manipulation_planner/actions/place.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {
namespace {

/// Returns the surfaces that an arm can reach, those nearest to the object first.
std::vector<std::string> surfaces_for(const Parts& parts, const std::string& arm) {
  const Vector3 p_object = parts.held.T_world_object().translation();
  std::vector<std::pair<double, std::string>> near;
  for (const SceneBox& box : parts.now.scene().boxes) {
    if (!box.supports) continue;
    const Vector3 p = nearest_on_top(box, p_object);
    const std::vector<std::string> arms = arms_for(parts, p_object, &box);
    if (std::find(arms.begin(), arms.end(), arm) != arms.end())
      near.emplace_back((p - p_object).norm(), box.id);
  }
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> out;
  out.reserve(near.size());
  for (auto& [distance, surface] : near) out.push_back(std::move(surface));
  return out;
}

/// Puts the held object where `taker` reaches it, on the first surface that serves.
Routine<Outcome> put_within_reach(Parts& parts, const std::string& object,
                                  const std::string& taker) {
  Outcome last = Outcome::failure("there is no surface within reach of both arms on which " +
                                  object + " could change hands");
  const std::vector<std::string> surfaces = surfaces_for(parts, taker);
  for (const std::string& surface : surfaces) {
    last = co_await put_on(parts, object, surface, taker);
    if (last.good || !parts.held.is_holding()) co_return last;
    parts.refuse("changing hands on " + surface, last.reason);
  }
  co_return last;
}

}  // namespace

Routine<Outcome> change_hands(Parts& parts, const std::string& object) {
  if (!parts.held.is_holding() || parts.held.id() != object)
    co_return Outcome::failure("the hand does not hold " + object);
  const std::size_t holder = parts.arm.index();
  Outcome last = Outcome::failure("robot " + parts.arm.robot().name() + " has no other arm");
  for (std::size_t i = 0; i < parts.arm.manipulators().size(); ++i) {
    const Manipulator& other = parts.arm.manipulators()[i];
    if (i == holder || other.arm == nullptr) continue;
    const std::string taker = other.name, nobody;
    last = co_await put_within_reach(parts, object, taker);
    if (!last.good) continue;
    // The hand that has put the object down is in the way of the other.
    Outcome rested = co_await rest_all(parts);
    if (!rested.good) parts.refuse("to rest", rested.reason);
    last = co_await use_arm(parts, taker);
    if (last.good) last = co_await pick_by_arm(parts, object, nobody, nobody);
    co_return last;
  }
  co_return last;
}

}  // namespace handsel::manipulation_planner
