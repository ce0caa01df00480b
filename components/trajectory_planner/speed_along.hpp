// Velocity, acceleration and jerk that the robot may have at each place of its path because of
// people (chapter section 2.1). Own method: what the place costs them (chapter section 4.1.2), and
// what they do: come nearer, or look elsewhere. Pure.
#pragma once

#include <vector>

#include "common/cost/human_cost.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/path/smooth.hpp"

namespace handsel::trajectory_planner {

/// The people around the robot, and where the robot stands.
struct Surroundings {
  HumanState people;  ///< joints in the world frame
  /// Pose of the root link of the robot in the world.
  Pose T_world_base{Pose::Identity()};
  double cost_gain{1.0};  ///< factor of what people cost, of attention
};

/// Factors of the limits, because of people.
struct SpeedSettings {
  double cost_step{0.1};  ///< the path is sampled this often [rad, max norm]
  /// Factors where the cost is 1; 1 where it is 0, linear between.
  LimitScale min_factors{0.5, 0.7, 0.7};
  /// What people do counts in full up to half this distance from the tool, and fades to nothing
  /// here [m].
  double concern_radius{1.5};
  /// A trunk that comes nearer to the tool this fast, or faster, counts in full [m/s].
  double approach_speed{0.8};
  double approach_factor{0.7};  ///< then it is this, (0, 1]
  /// A tool this far from where someone looks, or farther, counts as unseen [rad].
  double unseen_angle{1.2};
  double unseen_factor{0.8};  ///< then it is this, (0, 1]
};

class SpeedAlong {
 public:
  /// `cost` knows the same people; it, and the robot, must live on.
  SpeedAlong(const RobotModel& robot, const HumanCost& cost, const Surroundings& around,
             const SpeedSettings& settings);

  struct SpeedSample {
    double at{};        ///< position on the motion, 0 at its start, 1 at its end
    double cost{};      ///< human-aware, [0, 1]
    LimitScale factor;  ///< of the limits
  };
  /// Returns whether no person is present and no layer adds a cost: the factor is 1 everywhere.
  bool unconcerned() const { return !cost_.concerned(); }
  SpeedSample at(const Vector& q) const;  ///< all axes [rad]
  /// Returns samples of the straight motion between two configurations, ends included.
  std::vector<SpeedSample> along(const Vector& from, const Vector& to) const;
  /// Factor of all limits because of what people do, (0, 1]; 1 without people.
  double what_people_do(const Vector& q) const;

  /// Between two samples the lower factors of both count, in steps of kStep downward, never below
  /// kStep; equal neighbours are one zone.
  static LimitZones zones(const std::vector<SpeedSample>& samples);
  /// Step, and least value, of the factors that zones() gives.
  static constexpr double kStep = 0.05;

 private:
  struct Someone {
    SimplifiedBody body;
    Vector3 trunk{Vector3::Zero()}, velocity{Vector3::Zero()};
    std::optional<Sight> sight;
  };
  LimitScale factor(double cost, const Vector& q) const;

  const RobotModel& robot_;
  const HumanCost& cost_;
  SpeedSettings settings_;
  Pose T_world_base_;
  int tool_;
  std::vector<Someone> someone_;
};

}  // namespace handsel::trajectory_planner
