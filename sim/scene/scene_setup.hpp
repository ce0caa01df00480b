// From a scenario file to what the world starts with: poses, people, sensors; the seed decides what
// is jittered.
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

/// Returns the pose of xyz [m] and roll, pitch, yaw [rad] about fixed axes: R = Rz(yaw) Ry(pitch)
/// Rx(roll).
Pose pose_of(const config::PoseRpy&);

struct StartObject {
  std::string id, model_name;             ///< unique in the scenario; name in the object library
  const ObjectModel* model{};             ///< in the object library; not null
  Pose T_world_object{Pose::Identity()};  ///< at the start, jitter included
};

struct StartBox {
  std::string id;                      ///< unique in the scenario
  Pose T_world_box{Pose::Identity()};  ///< of its centre
  Vector3 size{Vector3::Zero()};       ///< full extents [m]
  bool supports{};                     ///< objects may stand on it
};

struct StartPerson {
  PersonSettings settings;  ///< variation drawn from the seed included
  std::string holds;        ///< object id, for a giver
  std::string fetches;      ///< object id, for a fetcher
  /// Of the object in the hand that holds it, where that is drawn.
  std::optional<Eigen::Quaterniond> hand_turn;
};

struct TimedControl {
  double at{};         ///< [s]
  SimControl control;  ///< the disturbance that happens then
};

struct SceneSetup {
  /// Root of the robot's model: of one that drives, what its platform's place refers to.
  Pose T_world_base{Pose::Identity()};
  Vector start;                            ///< all axes [rad] ([m])
  Vector3 p_world_robot{Vector3::Zero()};  ///< where the robot stands
  std::vector<StartBox> boxes;             ///< in the order of the scenario
  std::vector<StartObject> objects;        ///< in the order of the scenario
  /// In the order of the scenario, without those absent this time.
  std::vector<StartPerson> people;
  std::vector<SensorSettings> human_sensors, object_sensors;  ///< in the order of the scenario
  std::vector<TimedControl> disturbances;                     ///< in time order
  std::string watched;    ///< object of the first task, else the first object; may be empty
  bool never_releases{};  ///< injected fault: the hand does not open again (StuckHand)
  bool help_hold{};       ///< a grasp constraint helps to hold objects
};

/// Throws ConfigError or MissingError naming what in the scenario is wrong and what there is.
SceneSetup set_up(const config::Scenario&, const RobotModel&, const ObjectLibrary&, double coverage,
                  const std::filesystem::path& data_root, std::uint64_t seed);

/// "person_dart" -> SimAction::person_dart. Throws ConfigError listing the names.
SimAction sim_action(const std::string& name);

}  // namespace handsel::sim
