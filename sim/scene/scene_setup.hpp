// From a scenario file to what the world starts with: poses, people, sensors; the seed decides what is jittered.
#pragma once

#include <filesystem>
#include <random>

#include "common/bus/node_context.hpp"
#include "common/config/schema/scenario.pb.h"
#include "common/messages/system.hpp"
#include "common/model/robot_model.hpp"
#include "sim/people/person.hpp"
#include "sim/sensing/sensors.hpp"

namespace handsel::sim {

Pose pose_of(const config::PoseRpy&);

struct StartObject {
  std::string id, model_name;
  const ObjectModel* model{};
  Pose T_world_object{Pose::Identity()};
};

struct StartBox {
  std::string id;
  Pose T_world_box{Pose::Identity()};
  Vector3 size{Vector3::Zero()};
  bool supports{};
};

struct StartPerson {
  PersonSettings settings;
  std::string holds;    ///< object id, for a giver
  std::string fetches;  ///< object id, for who fetches something
};

struct TimedControl {
  double at{};  ///< [s]
  SimControl control;
};

struct SceneSetup {
  Pose T_world_base{Pose::Identity()};
  Vector start;  ///< all axes
  std::vector<StartBox> boxes;
  std::vector<StartObject> objects;
  std::vector<StartPerson> people;
  std::vector<SensorSettings> human_sensors, object_sensors;
  std::vector<TimedControl> disturbances;  ///< in time order
  std::string watched;                     ///< object of the first task, else the first object; may be empty
  bool never_releases{};
  bool no_weld{};
};

/// Throws ConfigError or MissingError naming what in the scenario is wrong and what there is.
SceneSetup set_up(const config::Scenario&, const RobotModel&, const ObjectLibrary&, double coverage, const std::filesystem::path& data_root,
                  std::uint64_t seed);

/// "person_dart" -> SimAction::person_dart. Throws ConfigError listing the names.
SimAction sim_action(const std::string& name);

}  // namespace handsel::sim
