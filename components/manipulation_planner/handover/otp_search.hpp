// Where and how to offer an object: exchange poses ranked by comfort, safety, visibility,
// legibility and the robot's effort (chapter sections 3.2.9 and 4.1.2). Own method: the sum. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/config/schema/manipulation_planner.pb.h"
#include "common/cost/human_cost.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::manipulation_planner {

struct ExchangePose {
  Pose T_world_object{Pose::Identity()};  ///< where and how the object is offered
  Vector arm_joints;                      ///< arm axes that put the held object there
  double cost{};                          ///< as exchange_cost() counts it, the lower the better
};

struct ExchangeSearch {
  std::vector<ExchangePose> poses;  ///< best first, reachable by robot and person
  std::string reason;               ///< when there is none
  std::uint32_t tried{};            ///< inverse kinematics solved for
};

/// Returns where the fingers of a hand that pinches stand, seen from the object (outward normals,
/// object frame): the object cannot be drawn out in these directions. Empty when more than two
/// fingers hold it: they open away from it.
std::vector<Vector3> barred_ways(const Grasp& grasp);

/// `q`: all axes, near which configurations are searched; `T_world_object_now`: where the object
/// is. The object keeps its tilt; only its place and heading change. Places in, under or behind
/// furniture as the person sees it, and those an outside layer forbids, are none. `barred`: as
/// barred_ways() gives them; the person must be able to draw the object toward them.
ExchangeSearch find_exchange(const RobotModel& robot, const Scene& scene, const Person& person, const LayersNow& layers, const Vector& q,
                             const Pose& T_world_object_now, const Pose& T_tool_object, const config::ManipulationPlannerSettings& settings,
                             const std::vector<Vector3>& barred = {});

/// Returns what a pose of the object costs as find_exchange() counts it, whether the robot reaches
/// it or not; nullopt: it could not be one.
std::optional<double> exchange_cost(const Scene& scene, const Person& person, const LayersNow& layers, const Pose& T_world_object,
                                    const Pose& T_world_object_now, const Pose& T_tool_object,
                                    const config::ManipulationPlannerSettings& settings, const std::vector<Vector3>& barred = {});

}  // namespace handsel::manipulation_planner
