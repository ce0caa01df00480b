// SPDX-License-Identifier: Apache-2.0
// The schemas of the settings files, one row each.
#pragma once

#include <vector>

#include "common/config/schema/attention.pb.h"
#include "common/config/schema/bridge.pb.h"
#include "common/config/schema/calibration.pb.h"
#include "common/config/schema/collision_checker.pb.h"
#include "common/config/schema/cost.pb.h"
#include "common/config/schema/costmap.pb.h"
#include "common/config/schema/driver.pb.h"
#include "common/config/schema/grasp_planner.pb.h"
#include "common/config/schema/launcher.pb.h"
#include "common/config/schema/manipulation_planner.pb.h"
#include "common/config/schema/path_planner.pb.h"
#include "common/config/schema/people.pb.h"
#include "common/config/schema/ros2_lane.pb.h"
#include "common/config/schema/sim.pb.h"
#include "common/config/schema/spark.pb.h"
#include "common/config/schema/supervisor.pb.h"
#include "common/config/schema/trajectory_controller.pb.h"
#include "common/config/schema/trajectory_planner.pb.h"

namespace handsel::test {

/// Returns the outermost messages of the settings files.
inline std::vector<const google::protobuf::Descriptor*> settings_schemas() {
  using namespace config;
  return {
      AttentionSettings::descriptor(),
      BridgeSettings::descriptor(),
      Calibration::descriptor(),
      CollisionCheckerSettings::descriptor(),
      CostmapSettings::descriptor(),
      GraspPlannerSettings::descriptor(),
      HumanCostSettings::descriptor(),
      LauncherSettings::descriptor(),
      ManipulationPlannerSettings::descriptor(),
      PathPlannerSettings::descriptor(),
      PeopleProfiles::descriptor(),
      PositionArmSettings::descriptor(),
      ReflexArmSettings::descriptor(),
      Ros2LaneSettings::descriptor(),
      SimSettings::descriptor(),
      SparkSettings::descriptor(),
      SupervisorSettings::descriptor(),
      TrajectoryControllerSettings::descriptor(),
      TrajectoryPlannerSettings::descriptor(),
  };
}

}  // namespace handsel::test
