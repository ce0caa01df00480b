// SPDX-License-Identifier: Apache-2.0
// Converts a scenario file to the start of the world: poses, people, sensors; the seed determines
// the random variations.
#pragma once

#include <filesystem>
#include <optional>
#include <random>

#include "common/bus/node_context.hpp"
#include "common/config/schema/scenario.pb.h"
#include "common/messages/system.hpp"
#include "common/model/robot_model.hpp"
#include "sim/people/person.hpp"
#include "sim/sensing/sensors.hpp"

namespace handsel::sim {

/// Returns the pose with xyz [m] and roll, pitch, yaw [rad] about fixed axes: R = Rz(yaw) Ry(pitch)
/// Rx(roll).
Pose pose_of(const config::PoseRpy&);

struct StartObject {
  std::string id, model_name;             ///< unique in the scenario; name in the object library
  const ObjectModel* model{};             ///< in the object library; not null
  Pose T_world_object{Pose::Identity()};  ///< at the start, jitter included
};

struct StartBox {
  std::string id;                      ///< unique in the scenario
  Pose T_world_box{Pose::Identity()};  ///< pose of the centre
  Vector3 size{Vector3::Zero()};       ///< full extents [m]
  bool supports{};                     ///< objects may stand on it
};

struct StartPerson {
  PersonSettings settings;  ///< with the variation drawn from the seed
  std::string holds;        ///< id of the object held at the start; may be empty
  std::string fetches;      ///< id of the object that a fetcher fetches; may be empty
  /// Orientation of the held object in the hand; nullopt: not drawn.
  std::optional<Eigen::Quaterniond> hand_turn;
};

struct TimedControl {
  double at{};         ///< scenario time [s]
  SimControl control;  ///< the disturbance at that time
};

struct SceneSetup {
  /// Root of the robot's model; for a mobile robot the reference of the platform's pose.
  Pose T_world_base{Pose::Identity()};
  Vector start;                            ///< positions of all axes [rad] ([m])
  Vector3 p_world_robot{Vector3::Zero()};  ///< position of the robot [m]
  std::vector<StartBox> boxes;             ///< in the order of the scenario
  std::vector<StartObject> objects;        ///< in the order of the scenario
  /// In the order of the scenario, without the people that are absent for this seed.
  std::vector<StartPerson> people;
  std::vector<SensorSettings> human_sensors, object_sensors;  ///< in the order of the scenario
  std::vector<TimedControl> disturbances;                     ///< in time order
  std::string watched;    ///< object of the first task, else the first; may be empty
  bool never_releases{};  ///< injected fault: the hand does not open (StuckHand)
  bool help_hold{};       ///< a grasp constraint helps to hold objects
};

/// Returns the start of a scenario. Throws ConfigError or MissingError that names the wrong entry
/// and the valid ones.
SceneSetup set_up(const config::Scenario&, const RobotModel&, const ObjectLibrary&, double coverage,
                  const std::filesystem::path& data_root, std::uint64_t seed);

/// Returns the action with this name, such as "person_dart". Throws ConfigError that lists the
/// names.
SimAction sim_action(const std::string& name);

}  // namespace handsel::sim
