// SPDX-License-Identifier: Apache-2.0
// The emulated world: robot, objects, people, sensors, and oracles. Pure: time advances only by
// step(), random numbers come from the seed; the same seed and inputs give the same bits.
#pragma once

#include <memory>
#include <vector>

#include "common/messages/attention.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"
#include "sim/physics/contacts.hpp"
#include "sim/scene/scene_setup.hpp"
#include "sim/scene/settings.hpp"

namespace handsel::sim {

class SimWorld {
 public:
  /// Keeps references to robot and library. Throws ConfigError or MissingError naming the wrong or
  /// missing entry.
  SimWorld(const RobotModel&, const ObjectLibrary&, const config::Scenario&, const SimSettings&,
           std::uint64_t seed);
  ~SimWorld();
  SimWorld(SimWorld&&) noexcept;

  /// Advances by one physics step.
  void step();
  double time() const;  ///< Returns the time since the start [s].

  /// Takes a set-point as received; `writer` distinguishes writers. `arrival`: time of arrival by a
  /// clock that never stops [s]; negative: the world's own time.
  void command(const JointCommand&, std::uint64_t writer = 1, double arrival = -1);
  /// Takes observations of people from outside; moves the people that follow this source.
  void observe(const HumanObservation&);
  /// Takes a request of attention to the sensors.
  void request(const SensorRequest&);
  /// Returns whether any person follows observations from outside.
  bool follows() const;
  /// Announces the robot's action to the people: a give action offers the object, a receive action
  /// asks for the object.
  void announce(const ActionStatus&);
  /// Returns whether any person reacts to announcements of the robot.
  bool listens() const;
  /// Executes every action except pause, resume and reset, which the caller executes. Returns an
  /// empty text, or one sentence if the subject does not exist.
  std::string control(const SimControl&);

  /// Writes the present report of the robot's driver; returns false while the driver is silenced.
  bool robot_state(RobotState& out);
  /// Appends what the sensors of people have delivered since the last call; clears `out` while the
  /// sensors are silenced.
  void human_observations(std::vector<Delivery<HumanObservation>>& out);
  /// Appends what the sensors of objects have delivered since the last call.
  void object_observations(std::vector<Delivery<ObjectObservation>>& out);
  /// Writes what the other robots report about themselves; stamps left to the publisher.
  void robot_reports(std::vector<RobotReport>& out);
  /// Writes all fields but stamp and real_time_factor.
  void ground_truth(GroundTruth& out) const;

  const std::string& first_limit_violation() const;  ///< one sentence; empty: none
  const std::string& last_collision() const;         ///< "link hits table"; empty: none
  DriveMode mode() const;                            ///< as reported by the emulated robot
  bool robot_grips() const;                       ///< Returns whether a robot hand holds an object.
  const std::vector<Touch>& touches() const;      ///< of the last step; robot bodies by number
  const std::string& robot_body(int body) const;  ///< name of its link
  double robot_pressure() const;  ///< Returns the hands' normal force on the watched object [N].
  /// Returns the fraction of the robot's holding time in which the grasp constraints carried more
  /// than the contacts; 0 if the robot has not held an object.
  double constraint_fraction() const;
  const Pose& T_world_object(const std::string& id) const;  ///< throws std::out_of_range
  /// Returns the ground truth of a person; the index counts the scenario's people without absent
  /// ones. Throws std::out_of_range.
  const Person& person(std::size_t index) const;
  /// Returns the present phase of that person. Throws std::out_of_range.
  PersonPhase person_phase(std::size_t index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel::sim
