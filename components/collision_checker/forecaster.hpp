// Where the running trajectory leads: contact, clearance and cost over the next moments, against
// the newest scene and people. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/execution.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel::collision_checker {

/// Range and sampling of a forecast.
struct ForecastSettings {
  double horizon{1.5};     ///< time ahead that is checked, at present speed [s]
  double min_speed{0.25};  ///< speed factor assumed for a slower or held trajectory
  double spacing{0.05};    ///< of states, in time of the trajectory [s]
  /// Other robots are expected to keep their velocity for at most this long [s].
  double robot_ahead{0.5};
};

/// The fingers of all hands as last measured. Pure.
class MeasuredFingers {
 public:
  explicit MeasuredFingers(const RobotModel& robot);
  /// Takes the measured position of all axes [rad].
  void set(const Vector& measured) { measured_ = measured; }
  /// Returns a configuration with the fingers as measured, unchanged until they are known; all
  /// axes.
  Vector in(Vector q) const;

 private:
  std::vector<int> axes_;
  Vector measured_;
};

/// Torso, head, upper arms and legs of people count as contact; their forearms and hands only lower
/// the clearance, the controller's guard answers for them. A hand counts where it is and where
/// SPARK expects it when the robot gets there. Another robot counts where it is and where its
/// velocity leads meanwhile. Fingers count where they are measured: the set-point
/// of a finger that presses on an object lies inside the object. What scene and robot themselves
/// say about a state of a trajectory is remembered until one of them changes.
class Forecaster {
 public:
  Forecaster(const RobotModel& robot, ObjectLibrary library, CostSettings cost,
             ForecastSettings settings);

  /// Replaces the scene; verdicts of the old one are dropped when its revision or the base differs.
  void set_scene(const Scene& scene);
  /// Replaces the people and the predicted motion of their hands.
  void set_people(const HumanState& people);
  /// Replaces the cost-map layers that the cost ahead is computed from.
  void set_layers(LayersNow layers);

  /// At rest: no contact is reported, clearance and cost of where the robot stands. A trajectory
  /// that does not fit the robot is reported as a collision now, with the reason.
  TrajectoryForecast forecast(const ActiveTrajectory& active);

  /// Number of configurations checked for collisions so far.
  std::uint64_t checks() const { return world_.checks(); }

 private:
  enum class Memory : char { unknown, free, collides };
  bool fits(const ActiveTrajectory& active) const;
  void remember_for(const ActiveTrajectory& active, const Vector& now);
  void sample_at(const Vector& q, double ahead, TrajectoryForecast& forecast);
  double distance_to_ball(const Vector3& centre, double radius) const;
  /// A link and another robot, where they are nearest to each other.
  struct RobotApproach {
    double distance{};          // [m], +inf without other robots
    const LinkCapsule* link{};  // nullptr without other robots
    const OtherRobot* other{};
  };
  RobotApproach other_robot_at(const Vector& q, double ahead);
  CollisionVerdict scene_verdict(std::size_t index, const Vector& q);

  const RobotModel& robot_;
  ForecastSettings settings_;
  CollisionWorld world_;
  HumanCost cost_;
  MeasuredFingers fingers_;
  std::uint64_t revision_{0};
  Pose T_world_base_{Pose::Identity()};

  std::uint64_t trajectory_{0};  // that memory_ is about
  Attachment attachment_;
  std::vector<std::string> allowed_;
  Trajectory path_;             // gives the times of memory_; grows when commands queue
  Vector others_;               // axes the trajectory does not move, when memory_ began
  std::vector<Memory> memory_;  // by state of the trajectory
  std::vector<CollisionVerdict> contacts_;
  MotionState3 sample_;
  struct Hand {
    double radius{};
    std::vector<HandAhead> motion;  // from now on
  };
  std::vector<Hand> hands_;
  std::vector<OtherRobot> other_robots_;
  std::vector<LinkCapsule> capsules_, moving_capsules_;  // all; on links that an axis moves
  std::vector<Pose> links_;

  Vector rest_position_;                    // where `rest_` was computed
  std::optional<TrajectoryForecast> rest_;  // nullopt: to be computed
};

/// Checks the states of a query in order. `clearance` is over the free ones.
StateVerdict check_states(const RobotModel& robot, CollisionWorld& world, const StateQuery& query);

}  // namespace handsel::collision_checker
