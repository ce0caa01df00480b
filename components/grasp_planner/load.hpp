// SPDX-License-Identifier: Apache-2.0
// What the grasp planner reads when it starts: settings, hands and the grasp lists of each.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/config/settings/grasp_planner.hpp"
#include "components/grasp_planner/arm_grasps.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/regrasp/regrasp_desk.hpp"

namespace handsel::grasp_planner {

/// Returns the settings of the grasp lists. `seed`: of
/// the contact points and samples.
GraspListSettings list_settings(const settings::GraspPlannerSettings& text, std::uint64_t seed);
/// Returns the settings of the regrasp planner.
RegraspSettings regrasp_settings(const settings::GraspPlannerSettings& text);

/// Returns the settings of grasp_planner.txtpb in `folder`. Throws ConfigError "file:line:key:
/// ...".
settings::GraspPlannerSettings load_settings(const std::filesystem::path& folder);
/// Returns the robot of a description on its platform; nullptr: it has none.
std::shared_ptr<const RobotModel> mobile(const RobotModel& robot,
                                         const std::filesystem::path& description);
/// Returns the arms of a robot with their hands, each with its lists; that of the tool link comes
/// first. `description`: the robot's file, empty: it has this arm only. ConfigError when a hand is
/// not described.
std::vector<ArmGrasps> load_arms(const RobotModel& robot, const std::filesystem::path& description,
                                 const settings::GraspPlannerSettings& text);

}  // namespace handsel::grasp_planner
