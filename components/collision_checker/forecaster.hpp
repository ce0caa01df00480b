// SPDX-License-Identifier: Apache-2.0
// Forecasts contact, clearance and cost of the running trajectory with the newest scene and people.
// Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "common/messages/execution.hpp"
#include "common/model/robot_capsules.hpp"
#include "components/collision_checker/robot_forecast.hpp"

namespace handsel::collision_checker {

/// Range and sampling of a forecast.
struct ForecastSettings {
  double horizon{1.5};     ///< checked time ahead at present speed [s]
  double min_speed{0.25};  ///< speed factor assumed for a slower or held trajectory
  double spacing{0.05};    ///< time between checked states on the trajectory [s]
  /// Max time for which other robots are expected to keep their velocity [s].
  double robot_ahead{0.5};
  double min_approach{1e-3};  ///< min decrease of the distance of robots that counts [m]
};

/// The measured finger positions of all hands. Pure.
class MeasuredFingers {
 public:
  explicit MeasuredFingers(const RobotModel& robot);
  /// Takes the measured position of all axes [rad].
  void set(const Vector& measured) { measured_ = measured; }
  /// Returns the configuration (all axes) with measured fingers; unchanged before the first
  /// measurement.
  Vector in(Vector q) const;

 private:
  std::vector<int> axes_;
  Vector measured_;
};

/// Overlap with torso, head, upper arms and legs of people is a contact; forearms and hands only
/// reduce the clearance, because the controller's guard handles them. A hand counts at its present
/// position and at SPARK's prediction for the time of the robot's arrival. Another
/// robot counts at its present position and where its velocity leads by then. Fingers count at
/// measured positions, because the set-point of a pressing finger lies inside the object. Results
/// for scene and robot without people are cached until one of them changes.
class Forecaster {
 public:
  Forecaster(const RobotModel& robot, ObjectLibrary library, CostSettings cost,
             ForecastSettings settings);

  /// Replaces the scene; drops cached results if its revision or the base differs.
  void set_scene(const Scene& scene);
  /// Replaces the people and the predicted motion of their hands.
  void set_people(const HumanState& people);
  /// Replaces the cost-map layers of the forecast cost.
  void set_layers(LayersNow layers);

  /// Returns the forecast. At rest: no contact, with clearance and cost at the present
  /// configuration. A trajectory that does not match the robot is an immediate collision with a
  /// reason.
  TrajectoryForecast forecast(const ActiveTrajectory& active);

  /// Returns the number of configurations checked for collisions so far.
  std::uint64_t checks() const { return world_.checks(); }

 private:
  enum class Memory : char { unknown, free, collides };
  bool fits(const ActiveTrajectory& active) const;
  void remember_for(const ActiveTrajectory& active, const Vector& now);
  void sample_at(const Vector& q, double ahead, TrajectoryForecast& forecast);
  double distance_to_ball(const Vector3& centre, double radius) const;
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
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_;

  RobotForecast other_robots_;
  struct AtRest {
    Vector position;                             // configuration of the forecast
    std::optional<TrajectoryForecast> forecast;  // nullopt: to be computed
  };
  AtRest rest_;
};

/// Checks all states of a query; one of the wrong size is not free. `clearance`: min distance of
/// the free ones to scene and people, at most 5 m; infinity: no free one.
StateVerdict check_states(const RobotModel& robot, CollisionWorld& world, const StateQuery& query);

}  // namespace handsel::collision_checker
