// SPDX-License-Identifier: Apache-2.0
// Computes factors of the velocity, acceleration and jerk limits along a path because of people
// (chapter section 2.1). Own method: from the human-aware cost (chapter section 4.1.2), the
// approach of people and their gaze. Pure.
#pragma once

#include <vector>

#include "common/cost/human_cost.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/path/smooth.hpp"

namespace handsel::trajectory_planner {

/// The people around the robot, and the pose of the robot.
struct Surroundings {
  HumanState people;  ///< joints in the world frame
  /// Pose of the root link of the robot in the world.
  Pose T_world_base{Pose::Identity()};
  double cost_gain{1.0};  ///< factor of the human-aware cost, by attention
};

/// Parameters of the factors of the limits.
struct SpeedSettings {
  double cost_step{0.1};  ///< sampling step of the path [rad, max norm]
  /// Factors at cost 1; linear to 1 at cost 0.
  LimitScale min_factors{0.5, 0.7, 0.7};
  /// Distance from the tool at which the effect of people's behaviour ends; full effect up to half
  /// of it [m].
  double concern_radius{1.5};
  /// Speed of a trunk toward the tool from which approach_factor has full effect [m/s].
  double approach_speed{0.8};
  double approach_factor{0.7};  ///< factor at full effect of an approach, (0, 1]
  /// Angle between gaze and tool from which the tool counts as unseen [rad].
  double unseen_angle{1.2};
  double unseen_factor{0.8};  ///< factor for an unseen tool, (0, 1]
  /// Angle of the transition from seen to unseen, below unseen_angle [rad].
  double unseen_transition{0.35};
};

class SpeedAlong {
 public:
  /// `cost` must contain the same people; `cost` and `robot` must outlive this.
  SpeedAlong(const RobotModel& robot, const HumanCost& cost, const Surroundings& around,
             const SpeedSettings& settings);

  struct SpeedSample {
    double at{};        ///< position on the motion, 0 at its start, 1 at its end
    double cost{};      ///< human-aware cost, [0, 1]
    LimitScale factor;  ///< factors of the limits
  };
  /// Returns whether no person is present and no layer adds a cost: the factor is 1 everywhere.
  bool unconcerned() const { return !cost_.concerned(); }
  SpeedSample at(const Vector& q) const;  ///< all axes [rad]
  /// Returns samples of the straight motion between two configurations, ends included.
  std::vector<SpeedSample> along(const Vector& from, const Vector& to) const;
  /// Returns the factor of all limits because of people's behaviour, (0, 1]; 1 without people.
  double behaviour_factor(const Vector& q) const;

  /// Returns zones with the lower factors of adjacent samples, rounded down to multiples of kStep
  /// and at least kStep; merges equal adjacent zones.
  static LimitZones zones(const std::vector<SpeedSample>& samples);
  /// Step and min value of the factors of zones().
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
