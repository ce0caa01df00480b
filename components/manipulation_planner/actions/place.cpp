// SPDX-License-Identifier: Apache-2.0
// Putting down: a place is chosen before the object is picked, so that the grasp serves there too
// (chapter section 3.2.9). Own method: the places.
#include "components/manipulation_planner/actions/place.hpp"

#include <algorithm>

#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/motion/motion_executor.hpp"
#include "components/manipulation_planner/placing/destination_search.hpp"

namespace handsel::manipulation_planner {
namespace {

/// Returns whether a person is at the palm or about to be. Fingers that open move toward them, and
/// no guard slows fingers.
bool is_person_near_hand(const Parts& parts) {
  const Vector3 p = parts.arm.T_world_tool().translation();
  const auto& s = parts.settings;
  const auto is_near = [&](const BodyJoint& joint) {
    const Vector3 to_hand = p - joint.position;
    const double left = to_hand.norm() - s.place_person_distance,
                 closing = joint.velocity.dot(to_hand.normalized());
    return left < 0 || (closing > 0 && left < s.place_person_time * closing);
  };
  const auto& people = parts.now.people().people;
  return std::any_of(people.begin(), people.end(), [&](const Person& person) {
    return std::any_of(person.joints.begin(), person.joints.end(), is_near);
  });
}

bool has_other_arm(const Parts& parts) {
  const auto& all = parts.arm.manipulators();
  return std::any_of(all.begin(), all.end(), [&](const Manipulator& m) {
    return m.arm != nullptr && m.name != parts.arm.group().name;
  });
}

Outcome no_place_on(const std::string& onto, const std::string& taker, const FoundPlaces& found) {
  return Outcome::failure("no free place on " + onto + " within the reach of " +
                          (taker.empty() ? "the arm: " : "both arms: ") + found.objections);
}

/// Searches places for the held object; its outcome says why there can be none. `taker`: as of
/// put_on().
Routine<FoundPlaces> places_in_reach(Parts& parts, const std::string& object,
                                     const std::string& onto, const std::string& taker) {
  FoundPlaces found;
  const SceneBox* surface = parts.now.surface(onto);
  if (!parts.held.is_holding() || parts.held.id() != object)
    found.outcome = Outcome::failure("the hand does not hold " + object);
  else if (surface == nullptr)
    found.outcome = Outcome::failure("there is no surface called " + onto);
  else if (parts.now.model_of(object) == nullptr)
    found.outcome = Outcome::failure("object " + object + " has no model");
  if (!found.outcome.good) co_return found;
  parts.action.phase = ActionPhase::choosing_place;
  const Vector open = opening(parts);
  found = co_await find_places(parts, *surface, open, taker);
  co_return found;
}

/// Puts the held object down at one of the places. `taker`: as of put_on().
Routine<Outcome> put_down_at(Parts& parts, const std::string& object, const std::string& onto,
                             const std::string& taker, const FoundPlaces& found) {
  if (!found.outcome.good) co_return found.outcome;
  if (found.configurations.empty()) co_return no_place_on(onto, taker, found);
  if (found.is_lying) parts.refuse("place upright", found.objections);
  Outcome lowered;
  if (taker.empty()) {
    lowered = co_await lower(parts, found.configurations);
  } else {
    // The best place for the taker, not the nearest to the arm in use.
    for (const PlacingConfiguration& configuration : found.configurations) {
      const std::vector<PlacingConfiguration> this_one{configuration};
      lowered = co_await lower(parts, this_one);
      if (lowered.good) break;
    }
  }
  if (!lowered.good) co_return lowered;
  parts.destinations.clear();
  co_await parts.waiting.until([&parts] { return !is_person_near_hand(parts); },
                               parts.settings.place_person_timeout);
  const Vector open = opening(parts);
  HandResult released =
      co_await parts.hand.run(HandAction::release, open, parts.settings.hand_timeout);
  if (!released.outcome.good) co_return released.outcome;
  parts.held.release();
  const std::string nobody;
  Outcome back = co_await retreat(parts, nobody, object);
  if (!back.good) parts.refuse("retreat", back.reason);
  co_return Outcome{};
}

}  // namespace

Routine<GraspList> ask_grasps_onto(Parts& parts, const std::string& object,
                                   const std::string& onto) {
  parts.destinations.clear();
  GraspList list = co_await ask_grasps(parts, object, "", parts.settings.max_grasps_onto);
  if (!list.outcome.good || parts.now.surface(onto) == nullptr ||
      parts.now.object(object) == nullptr)
    co_return list;
  parts.action.phase = ActionPhase::choosing_place;
  const DestinationLimits limits{parts.settings.max_grasps, parts.settings.surface_places};
  const ServingGrasps found = co_await find_destinations(parts, object, onto, list.grasps, limits);
  if (!found.outcome.good || found.at.empty()) {
    const std::string none =
        "no grasp of " + object + " serves on " + onto + " too: " + found.objections;
    parts.refuse("place", found.outcome.good ? none : found.outcome.reason);
    co_return list;
  }
  GraspList serving;
  for (const auto& [grasp, destination] : found.at) {
    serving.grasps.push_back(list.grasps[grasp]);
    parts.destinations.add(destination);
  }
  co_return serving;
}

Routine<Outcome> lower(Parts& parts, std::vector<PlacingConfiguration> places) {
  Outcome last = Outcome::failure("no configuration puts the object down");
  while (!places.empty()) {
    MotionSpec above;
    above.phase = ActionPhase::carry;
    for (const PlacingConfiguration& place : places) above.goals.push_back(place.arm_above);
    above.speed = parts.settings.carry_speed;
    last = co_await move(parts, above);
    if (!last.good) co_return last;
    const auto distance = [joints = parts.arm.joints()](const PlacingConfiguration& place) {
      return (place.arm_above - joints).cwiseAbs().maxCoeff();
    };
    const auto reached =
        std::min_element(places.begin(), places.end(),
                         [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    MotionSpec down = above;
    down.phase = ActionPhase::put_down;
    down.goals = {reached->arm_at};
    down.shape = MotionShape::straight_tool;
    down.speed = parts.settings.approach_speed;
    last = co_await move(parts, down);
    if (last.good) co_return last;
    parts.refuse("put down", last.reason);
    places.erase(reached);
  }
  co_return last;
}

Routine<Outcome> place(Parts& parts, const std::string& object, const std::string& onto) {
  const std::string nobody;
  const FoundPlaces found = co_await places_in_reach(parts, object, onto, nobody);
  if (found.outcome.good && found.configurations.empty() && has_other_arm(parts)) {
    const Outcome none = no_place_on(onto, nobody, found);
    parts.refuse("place by the hand that holds the object", none.reason);
    ActionGoal goal;
    goal.object = object;
    goal.surface = onto;
    Outcome passed = co_await regrasp(parts, goal);
    if (passed.good) co_return passed;
    co_return Outcome::failure(none.reason + "; by a change of hands: " + passed.reason,
                               passed.kind);
  }
  Outcome done = co_await put_down_at(parts, object, onto, nobody, found);
  co_return done;
}

Routine<Outcome> put_on(Parts& parts, const std::string& object, const std::string& onto,
                        const std::string& taker) {
  const FoundPlaces found = co_await places_in_reach(parts, object, onto, taker);
  Outcome done = co_await put_down_at(parts, object, onto, taker, found);
  co_return done;
}

}  // namespace handsel::manipulation_planner
