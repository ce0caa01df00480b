// What the grasp planner reads when it starts: settings, hands and the grasp lists of each.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/config/schema/grasp_planner.pb.h"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"
#include "components/grasp_planner/regrasp/regrasp_desk.hpp"

namespace handsel::grasp_planner {

/// Returns the settings of the grasp lists. ConfigError names the field that is wrong. `seed`: of
/// the contact points and samples.
GraspListSettings list_settings(const config::GraspPlannerSettings& text, std::uint64_t seed);
/// Returns the settings of the choice. ConfigError names the field that is wrong.
ChoiceSettings choice_settings(const config::GraspPlannerSettings& text);
/// Returns the settings of the regrasp planner. ConfigError names the field that is wrong.
RegraspSettings regrasp_settings(const config::GraspPlannerSettings& text);
/// Returns the value. Throws ConfigError that names the key unless the value is above 0.
double positive(const char* key, double value);

/// Returns the settings of grasp_planner.txtpb in `folder`, whose ranges are not checked.
config::GraspPlannerSettings load_settings(const std::filesystem::path& folder);
/// Returns the store of lists on disk; one that keeps nothing when the settings say so.
GraspStore store_of(const config::GraspPlannerSettings& text);
/// Returns the geometry of the robot's hand. ConfigError when the robot names no hand.
std::shared_ptr<const HandGeometry> load_hand_geometry(const RobotModel& robot);
/// Returns the robot of a description on its platform; nullptr: it has none.
std::shared_ptr<const RobotModel> mobile(const RobotModel& robot,
                                         const std::filesystem::path& description);
/// Returns the arms of the robot's description; the first has the geometry and the lists that are
/// there already.
std::vector<ArmGrasps> load_arms(const RobotModel& robot, const std::filesystem::path& description,
                                 const std::shared_ptr<const HandGeometry>& hand_geometry,
                                 const std::shared_ptr<GraspCache>& cache,
                                 const GraspListSettings& settings, const GraspStore& store);
/// Returns the transfers from the robot's hand to that of a person; nullptr: no such hand is known.
std::shared_ptr<TransferCache> make_transfer_cache(const config::GraspPlannerSettings& text,
                                                   const std::shared_ptr<const HandGeometry>& robot,
                                                   const GraspStore& store);

}  // namespace handsel::grasp_planner
