#include "components/grasp_planner/load.hpp"

#include <algorithm>

#include "common/config/resources.hpp"
#include "common/model/platform.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr std::uint32_t kTakerPositions = 40, kTakerOrientations = 72;

// A person's list is one of several for an object: fewer frames do.
GraspListSettings taker_settings(const config::GraspPlannerSettings& text) {
  GraspListSettings s = list_settings(text, 1);
  s.positions = std::min(s.positions, kTakerPositions);
  s.spacing = 0;
  s.orientations = std::min(s.orientations, kTakerOrientations);
  return s;
}

}  // namespace

config::GraspPlannerSettings load_settings(const std::filesystem::path& folder) {
  config::GraspPlannerSettings settings;
  load_text_proto(folder / "grasp_planner.txtpb", settings);
  return settings;
}

GraspStore store_of(const config::GraspPlannerSettings& text) {
  return GraspStore(text.store() ? default_store() : "");
}

std::shared_ptr<const HandGeometry> load_hand_geometry(const RobotModel& robot) {
  if (robot.hand().empty())
    throw ConfigError("robot " + robot.name() + " names no hand; the grasp planner needs one");
  return std::make_shared<const HandGeometry>(HandModel::load(hand_description(robot.hand())));
}

std::shared_ptr<const RobotModel> mobile(const RobotModel& robot,
                                         const std::filesystem::path& description) {
  if (description.empty()) return nullptr;
  auto model = on_platform(robot, description);
  return model ? std::make_shared<const RobotModel>(std::move(*model)) : nullptr;
}

std::vector<ArmGrasps> load_arms(const RobotModel& robot, const std::filesystem::path& description,
                                 const std::shared_ptr<const HandGeometry>& hand_geometry,
                                 const std::shared_ptr<GraspCache>& cache,
                                 const GraspListSettings& settings, const GraspStore& store) {
  std::vector<ArmGrasps> arms;
  if (description.empty()) return arms;
  for (const Manipulator& m : manipulators(description, robot)) {
    if (arms.empty()) {
      arms.push_back({m, hand_geometry, cache});
      continue;
    }
    const auto other =
        std::make_shared<const HandGeometry>(HandModel::load(hand_description(m.hand)));
    arms.push_back({m, other, std::make_shared<GraspCache>(other, settings, store)});
  }
  return arms;
}

RegraspSettings regrasp_settings(const config::GraspPlannerSettings& text) {
  RegraspSettings s;
  s.lift = text.lift();
  s.stand_off = text.stand_off();
  s.grip = list_settings(text, 1).grip;
  return s;
}

double positive(const char* key, double value) {
  if (!(value > 0)) throw ConfigError(std::string("grasp_planner.txtpb: ") + key + " must be > 0");
  return value;
}

std::shared_ptr<TransferCache> make_transfer_cache(const config::GraspPlannerSettings& text,
                                                   const std::shared_ptr<const HandGeometry>& robot,
                                                   const GraspStore& store) {
  if (text.taker().empty()) return nullptr;
  const auto taker =
      std::make_shared<const HandGeometry>(HandModel::load(hand_description(text.taker())));
  return std::make_shared<TransferCache>(robot, taker, taker_settings(text), store);
}

GraspListSettings list_settings(const config::GraspPlannerSettings& t, std::uint64_t seed) {
  GraspListSettings s;
  s.positions = static_cast<std::uint32_t>(positive("positions", t.positions()));
  s.spacing = positive("spacing", t.spacing());
  s.orientations = static_cast<std::uint32_t>(positive("orientations", t.orientations()));
  s.step_fraction = positive("step_fraction", t.step_fraction());
  if (t.cone_edges() < 6) throw ConfigError("grasp_planner.txtpb: cone_edges must be at least 6");
  s.cone_edges = static_cast<int>(t.cone_edges());
  s.full_epsilon = positive("full_epsilon", t.full_epsilon());
  s.weights = {t.weight_stability(), t.weight_centre(), t.weight_force(), t.weight_curvature()};
  if (std::min({t.weight_stability(), t.weight_centre(), t.weight_force(), t.weight_curvature()}) <
          0 ||
      !(t.weight_stability() + t.weight_centre() + t.weight_force() + t.weight_curvature() > 0)) {
    throw ConfigError(
        "grasp_planner.txtpb: the weights of the quality must not be negative, and one must be > "
        "0");
  }
  s.contacts_per_finger =
      static_cast<std::uint32_t>(positive("contacts_per_finger", t.contacts_per_finger()));
  s.tries_per_finger =
      static_cast<std::uint32_t>(positive("tries_per_finger", t.tries_per_finger()));
  s.opening = positive("opening", t.opening());
  s.open_clearance = positive("open_clearance", t.open_clearance());
  s.free_distance = positive("free_distance", t.free_distance());
  s.grip.max_normal = positive("grip_force", t.grip_force());
  s.grip.friction_fraction = positive("grip_friction", t.grip_friction());
  if (s.grip.friction_fraction > 1)
    throw ConfigError("grasp_planner.txtpb: grip_friction must be at most 1");
  s.grip.acceleration = positive("grip_acceleration", t.grip_acceleration());
  s.seed = seed;
  return s;
}

ChoiceSettings choice_settings(const config::GraspPlannerSettings& t) {
  ChoiceSettings s;
  s.stand_off = positive("stand_off", t.stand_off());
  s.approach_clearance = positive("approach_clearance", t.approach_clearance());
  s.lift = positive("lift", t.lift());
  s.support_gap = positive("support_gap", t.support_gap());
  s.reach_budget = static_cast<std::uint32_t>(positive("reach_budget", t.reach_budget()));
  s.rank_quality = t.rank_quality();
  s.rank_configuration = t.rank_configuration();
  s.rank_contacts = t.rank_contacts();
  s.rank_room = t.rank_room();
  s.rank_handover = t.rank_handover();
  s.rank_partner = t.rank_partner();
  s.rank_transfer = t.rank_transfer();
  s.rank_sturdy = t.rank_sturdy();
  s.sturdy_margin = positive("sturdy_margin", t.sturdy_margin());
  s.rank_visible = t.rank_visible();
  s.rank_tilt = t.rank_tilt();
  s.rank_away = t.rank_away();
  s.rank_stands = t.rank_stands();
  s.off_fingers = positive("off_fingers", t.off_fingers());
  s.off_giver = positive("off_giver", t.off_giver());
  if (s.off_giver < s.off_fingers)
    throw ConfigError("grasp_planner.txtpb: off_giver must be at least off_fingers");
  s.rank_drive = t.rank_drive();
  s.platform_room = t.platform_room();
  s.platform_reaches =
      static_cast<std::uint32_t>(positive("platform_reaches", t.platform_reaches()));
  return s;
}

}  // namespace handsel::grasp_planner
