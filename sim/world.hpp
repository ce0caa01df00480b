// The emulated world: robot, objects, people, sensors, and the oracle that watches them. Pure: time advances by step() only, chance
// comes from the seed; same seed and inputs, same bits.
#pragma once

#include <memory>
#include <vector>

#include "common/messages/perception.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "sim/physics/contacts.hpp"
#include "sim/scene/scene_setup.hpp"
#include "sim/scene/settings.hpp"

namespace handsel::sim {

class SimWorld {
 public:
  /// Keeps references to robot and library. Throws ConfigError or MissingError naming what is wrong.
  SimWorld(const RobotModel&, const ObjectLibrary&, const config::Scenario&, const SimSettings&, std::uint64_t seed);
  ~SimWorld();
  SimWorld(SimWorld&&) noexcept;

  /// One physics step.
  void step();
  double time() const;  ///< [s] since the start

  /// A set-point as received; `writer` tells its writers apart.
  /// `arrival`: when it arrived, by a clock that never stands still [s]; negative: the world's own time.
  void command(const JointCommand&, std::uint64_t writer = 1, double arrival = -1);
  /// What a source outside says of people; moves those who follow it.
  void observe(const HumanObservation&);
  /// Does somebody follow a source outside?
  bool follows() const;
  /// Everything but pause, resume and reset, which are the caller's. Returns a sentence when it names nobody.
  std::string control(const SimControl&);

  /// What the robot's driver reports now; false while it is silenced.
  bool robot_state(RobotState& out);
  /// What the sensors hand over since the last call.
  void human_observations(std::vector<Delivery<HumanObservation>>& out);
  void object_observations(std::vector<Delivery<ObjectObservation>>& out);
  /// Everything but stamp and real_time_factor.
  void truth(GroundTruth& out) const;

  const std::string& last_limit_violation() const;  ///< one sentence; empty: none
  const std::string& last_collision() const;        ///< "link hits table"; empty: none
  DriveMode mode() const;
  bool robot_grips() const;
  const std::vector<Touch>& touches() const;                ///< of the last step; robot bodies by number
  const std::string& robot_body(int body) const;            ///< name of its link
  double robot_pressure() const;                            ///< normal force of the hand on the watched object [N]
  double constraint_share() const;                          ///< of the time the robot held something, that in which the constraint did
  const Pose& T_world_object(const std::string& id) const;  ///< throws std::out_of_range
  const Person& person(std::size_t index) const;
  PersonPhase person_phase(std::size_t index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel::sim
