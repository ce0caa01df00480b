// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/load.hpp"

#include <algorithm>

#include "common/config/resources.hpp"
#include "common/config/settings_text.hpp"
#include "common/model/platform.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr std::uint32_t kTakerPositions = 40, kTakerOrientations = 72;

// Returns settings with fewer frames: an object has several lists of a person's hands.
GraspListSettings taker_settings(const settings::GraspPlannerSettings& text) {
  GraspListSettings s = list_settings(text, 1);
  s.positions = std::min(s.positions, kTakerPositions);
  s.spacing = 0;
  s.orientations = std::min(s.orientations, kTakerOrientations);
  return s;
}

TransferSettings transfer_settings(const settings::GraspPlannerSettings& text) {
  TransferSettings s;
  s.clearance = text.transfer_clearance;
  s.palm_clearance = text.transfer_palm_clearance;
  s.min_opposition = text.transfer_min_opposition;
  s.max_of_each = text.transfer_grasps;
  s.partners = text.transfer_partners;
  s.pool = text.transfer_pool;
  s.min_turn = text.transfer_turn;
  s.max_aim = text.transfer_max_aim;
  s.headings = static_cast<int>(text.transfer_headings);
  s.max_tilt = text.transfer_max_tilt;
  return s;
}

/// Returns the transfers from a hand of the robot to that of a person, described under `name`;
/// nullptr: no such hand is known.
std::shared_ptr<TransferCache> make_transfer_cache(const settings::GraspPlannerSettings& text,
                                                   const std::string& name,
                                                   const std::shared_ptr<const HandGeometry>& robot,
                                                   const GraspStore& store) {
  if (name.empty()) return nullptr;
  const auto taker = std::make_shared<const HandGeometry>(HandModel::load(hand_description(name)));
  return std::make_shared<TransferCache>(robot, taker, taker_settings(text),
                                         transfer_settings(text), store);
}

}  // namespace

settings::GraspPlannerSettings load_settings(const std::filesystem::path& folder) {
  SettingsText text;
  auto s = settings::read_grasp_planner_settings(folder / "grasp_planner.txtpb", &text);
  if (!(s.weight_stability + s.weight_centre + s.weight_force + s.weight_curvature > 0))
    text.refuse("weight_stability",
                "is 0 as the other weights of the quality; one must be above 0");
  if (s.min_margin_held > s.min_margin)
    text.refuse("min_margin_held", "must be at most min_margin");
  if (s.transfer_pool < s.transfer_partners)
    text.refuse("transfer_pool", "must be at least transfer_partners");
  if (s.off_giver < s.off_fingers) text.refuse("off_giver", "must be at least off_fingers");
  return s;
}

std::shared_ptr<const RobotModel> mobile(const RobotModel& robot,
                                         const std::filesystem::path& description) {
  if (description.empty()) return nullptr;
  auto model = on_platform(robot, description);
  return model ? std::make_shared<const RobotModel>(std::move(*model)) : nullptr;
}

std::vector<ArmGrasps> load_arms(const RobotModel& robot, const std::filesystem::path& description,
                                 const settings::GraspPlannerSettings& text) {
  if (robot.hand().empty())
    throw ConfigError("robot " + robot.name() + " names no hand; the grasp planner needs one");
  // Lists do not depend on the seed of the node: they are stored on disk and shared.
  const GraspListSettings lists = list_settings(text, 1);
  const GraspStore store(text.store ? default_store() : "");
  const std::vector<Manipulator> all =
      description.empty() ? hands_of(robot) : manipulators(description, robot);
  std::vector<ArmGrasps> arms;
  for (const Manipulator& arm : all) {
    if (arm.hand.empty()) continue;
    ArmGrasps one;
    one.arm = arm;
    one.hand_geometry =
        std::make_shared<const HandGeometry>(HandModel::load(hand_description(arm.hand)));
    one.cache = std::make_shared<GraspCache>(one.hand_geometry, lists, store);
    one.transfers = make_transfer_cache(text, text.taker, one.hand_geometry, store);
    one.left_transfers = make_transfer_cache(text, text.taker_left, one.hand_geometry, store);
    arms.push_back(std::move(one));
  }
  return arms;
}

RegraspSettings regrasp_settings(const settings::GraspPlannerSettings& text) {
  RegraspSettings s;
  s.max_of_each = text.regrasp_grasps;
  s.clearance = text.regrasp_clearance;
  s.slack = text.regrasp_slack;
  s.stand_off = text.stand_off;
  s.lift = text.lift;
  s.max_turn = text.max_approach_turn;
  s.handover_tries = static_cast<int>(text.regrasp_poses);
  s.max_steps_tried = text.regrasp_steps;
  s.costs.quality = text.regrasp_quality_cost;
  s.costs.weak = text.regrasp_weak_cost;
  s.costs.max_weakness = text.regrasp_max_weakness;
  s.costs.strain = text.regrasp_strain_cost;
  s.comfortable = text.regrasp_comfortable;
  s.hand_clearance = text.regrasp_hand_clearance;
  s.min_apart = text.both_apart;
  s.max_pairs_tried = text.both_pairs;
  s.motions_tried = text.both_motions;
  s.grip = list_settings(text, 1).grip;
  return s;
}

GraspListSettings list_settings(const settings::GraspPlannerSettings& t, std::uint64_t seed) {
  GraspListSettings s;
  s.positions = t.positions;
  s.spacing = t.spacing;
  s.orientations = t.orientations;
  s.step_fraction = t.step_fraction;
  s.cone_edges = static_cast<int>(t.cone_edges);
  s.full_epsilon = t.full_epsilon;
  s.weights = {t.weight_stability, t.weight_centre, t.weight_force, t.weight_curvature};
  s.contacts_per_finger = t.contacts_per_finger;
  s.tries_per_finger = t.tries_per_finger;
  s.opening = t.opening;
  s.open_clearance = t.open_clearance;
  s.pad_hollow = t.pad_hollow;
  s.free_distance = t.free_distance;
  s.grip.max_normal = t.grip_force;
  s.grip.friction_fraction = t.grip_friction;
  s.grip.acceleration = t.grip_acceleration;
  s.grip.enough = t.enough_margin;
  s.creep = t.grip_creep;
  s.weight_grip = t.weight_grip;
  s.sturdy_margin = t.sturdy_margin;
  s.min_margin = t.min_margin;
  s.seed = seed;
  return s;
}

}  // namespace handsel::grasp_planner
