// The emulated world: robot, objects, people, sensors, and the oracle that watches them. Pure: time
// advances by step() only, chance comes from the seed; same seed and inputs, same bits.
#pragma once

#include <memory>
#include <vector>

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
  /// Keeps references to robot and library. Throws ConfigError or MissingError naming what is
  /// wrong.
  SimWorld(const RobotModel&, const ObjectLibrary&, const config::Scenario&, const SimSettings&,
           std::uint64_t seed);
  ~SimWorld();
  SimWorld(SimWorld&&) noexcept;

  /// One physics step.
  void step();
  double time() const;  ///< [s] since the start

  /// Takes a set-point as received; `writer` tells its writers apart. `arrival`: when it arrived,
  /// by a clock that never stops [s]; negative: the world's own time.
  void command(const JointCommand&, std::uint64_t writer = 1, double arrival = -1);
  /// Takes what a source outside says of people; moves those that follow this source.
  void observe(const HumanObservation&);
  /// Whether any person follows a source outside.
  bool follows() const;
  /// Tells the people what the robot does: a give action offers the object, a receive action asks
  /// for it.
  void announce(const ActionStatus&);
  /// Whether any person listens to the robot.
  bool listens() const;
  /// Carries out every action but pause, resume and reset, which are the caller's. Returns an empty
  /// text, or one sentence when the subject does not exist.
  std::string control(const SimControl&);

  /// What the robot's driver reports now; false while it is silenced.
  bool robot_state(RobotState& out);
  /// Appends what the sensors of people hand over since the last call; clears `out` while they are
  /// silenced.
  void human_observations(std::vector<Delivery<HumanObservation>>& out);
  /// Appends what the sensors of objects hand over since the last call.
  void object_observations(std::vector<Delivery<ObjectObservation>>& out);
  /// Writes what the other robots report about themselves; stamps left to the publisher.
  void robot_reports(std::vector<RobotReport>& out);
  /// Writes all fields but stamp and real_time_factor.
  void ground_truth(GroundTruth& out) const;

  const std::string& last_limit_violation() const;  ///< one sentence; empty: none
  const std::string& last_collision() const;        ///< "link hits table"; empty: none
  DriveMode mode() const;                           ///< as the emulated robot reports it
  bool robot_grips() const;                       ///< whether any hand of the robot holds an object
  const std::vector<Touch>& touches() const;      ///< of the last step; robot bodies by number
  const std::string& robot_body(int body) const;  ///< name of its link
  double robot_pressure() const;  ///< normal force of its hands on the watched object [N]
  /// Returns the fraction of the time the robot held something in which the grasp constraints
  /// carried more than the contacts; 0 if nothing was held yet.
  double constraint_fraction() const;
  const Pose& T_world_object(const std::string& id) const;  ///< throws std::out_of_range
  /// Returns the ground truth of a person, numbered as in the scenario without those that are
  /// absent. Throws std::out_of_range.
  const Person& person(std::size_t index) const;
  /// Returns what that person does now. Throws std::out_of_range.
  PersonPhase person_phase(std::size_t index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel::sim
