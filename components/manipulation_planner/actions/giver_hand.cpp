// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/actions/giver_hand.hpp"

#include <functional>
#include <memory>

#include "common/model/human/holding_hand.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr int kClearanceSteps = 6;  // checks of the straight motion in, and of the closing

/// Returns the people now, the giver larger by giver_hand_clearance, and with assumed digits around
/// the object on offer, the hand turned about its fingers by each of `turns` [rad].
HumanState people_with_digits(const Parts& parts, const Offer& offer,
                              const std::vector<double>& turns) {
  HumanState around = parts.now.people_averaged();
  const SceneObject* held = parts.now.object(offer.object);
  const ObjectModel* model = parts.now.model_of(offer.object);
  for (Person& person : around.people) {
    if (person.id != offer.giver) continue;
    const double margin = person.inflation + parts.settings.giver_hand_clearance;
    if (held != nullptr && model != nullptr) {
      around.robots.push_back(
          digits_as_obstacles(person, *model, held->T_world_object, margin, turns));
      person = with_fingers_bent(person, held->T_world_object.translation());
    }
    person.inflation = margin;
  }
  return around;
}

/// Returns whether the palm of the hand that holds the object on offer is observed.
bool is_palm_observed(const Parts& parts, const Offer& offer) {
  const Person* giver = parts.now.person(offer.giver);
  const SceneObject* held = parts.now.object(offer.object);
  const ObjectModel* model = parts.now.model_of(offer.object);
  if (giver == nullptr || held == nullptr || model == nullptr) return false;
  const auto holding = holding_hand(*giver, *model, held->T_world_object);
  return holding && holding->palm;
}

/// What select_clear() found.
struct ClearGrasps {
  Outcome outcome;            ///< whether the search ended
  std::vector<Grasp> grasps;  ///< in the order given
};

/// Returns the grasps whose approach and closing fingers are clear of these people.
Routine<ClearGrasps> select_clear(Parts& parts, const HumanState& around, const std::string& object,
                                  const std::vector<Grasp>& grasps) {
  auto clear = std::make_shared<std::vector<Grasp>>();
  const std::function<void()> job = [clear, around, grasps, object,
                                     world =
                                         parts.worker.world(parts.arm.robot(), parts.now.objects()),
                                     scene = parts.now.scene(), q = parts.arm.configuration(),
                                     arm = parts.arm.group(), fingers = parts.arm.fingers()] {
    world->set_scene(scene);
    world->set_people(around);
    world->set_attachment({}, {object});
    world->set_moving_axes(arm.axes);
    const auto is_free = [&](const Vector& arm_joints, const Vector& hand_joints) {
      return world
          ->check_people(
              RobotModel::with(RobotModel::with(q, arm, arm_joints), fingers, hand_joints))
          .free;
    };
    for (const Grasp& g : grasps) {
      bool is_clear = true;
      for (int k = kClearanceSteps; k >= 0 && is_clear; --k) {
        const double s = static_cast<double>(k) / kClearanceSteps;
        is_clear =
            is_free(g.approach_joints + s * (g.arm_joints - g.approach_joints),
                    g.pregrasp_joints) &&
            is_free(g.arm_joints, g.pregrasp_joints + s * (g.hand_joints - g.pregrasp_joints));
      }
      if (is_clear) clear->push_back(g);
    }
  };
  ClearGrasps result;
  result.outcome = co_await parts.worker.run(job);
  // After a timeout the job may still write.
  if (result.outcome.good) result.grasps = std::move(*clear);
  co_return result;
}

}  // namespace

Routine<Outcome> select_clear_of_hand(Parts& parts, const Offer& offer,
                                      std::vector<Grasp>& grasps) {
  const HumanState around = people_with_digits(parts, offer, {0.0});
  ClearGrasps clear = co_await select_clear(parts, around, offer.object, grasps);
  if (!clear.outcome.good) co_return clear.outcome;
  grasps = std::move(clear.grasps);
  if (grasps.empty())
    clear.outcome =
        Outcome::failure("the hand would come too near to the fingers of " + offer.giver);
  co_return clear.outcome;
}

Routine<std::optional<GraspIds>> clear_of_turned_hand(Parts& parts, const Offer& offer,
                                                      const std::vector<Grasp>& grasps) {
  const double turn = is_palm_observed(parts, offer) ? 0 : parts.settings.digits_turn;
  std::vector<double> turns{0.0};
  if (turn > 0) turns = {-turn, -turn / 2, 0.0, turn / 2, turn};
  const HumanState around = people_with_digits(parts, offer, turns);
  const ClearGrasps clear = co_await select_clear(parts, around, offer.object, grasps);
  std::optional<GraspIds> ids;
  if (!clear.outcome.good) co_return ids;
  ids.emplace();
  for (const Grasp& grasp : clear.grasps) ids->insert(grasp.id);
  co_return ids;
}

}  // namespace handsel::manipulation_planner
