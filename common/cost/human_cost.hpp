// SPDX-License-Identifier: Apache-2.0
// The human-aware costs (chapter section 4.1.2, eq. 1): safety, visibility, arm comfort, each
// in [0, 1], and their weighted sum.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/config/settings/cost.hpp"
#include "common/cost/batch_cost.hpp"
#include "common/cost/cost_layers.hpp"
#include "common/cost/person_frame.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

/// Settings of the human-aware cost: cost.txtpb.
using CostSettings = settings::HumanCostSettings;

/// Returns 1 at contact, 0 from `radius` [m] on, falling exponentially in between (formula of
/// section 4.1.2).
double safety_cost(double distance, double radius);
/// Returns angle(gaze, p - eyes) / pi, in [0, 1]; 0 beyond `cutoff` [m] from the eyes. `p`:
/// world [m].
double visibility_cost(const Sight&, const Vector3& p, double cutoff);
/// The same for a person; where the gaze is unknown the body's front stands in for it. 0 when not
/// even the head is known.
double visibility_cost(const Person&, const Vector3& p, double cutoff);
/// Marler's form on the person's arm reaching p with the more comfortable hand: joint displacement,
/// raised mass, nearness to joint limits, weighted to [0, 1] (own method: joints, limits and
/// weights of the arm); 1 when out of reach.
double arm_comfort_cost(const Person&, const Vector3& p);
/// The same for one arm only; 1 when its joints are not all known or p is out of reach.
double arm_comfort_cost(const Person&, Side side, const Vector3& p);
/// A person's arm by its lengths.
struct ArmSize {
  double upper{};  ///< shoulder to elbow [m]
  double fore{};   ///< elbow to wrist to hand [m]
};
/// Returns the lengths of an arm; nullopt when its joints are not all known.
std::optional<ArmSize> arm_size(const Person&, Side side);
/// arm_comfort_cost of an arm alone: p from the shoulder, along (forward, outward, up) of the
/// torso [m].
double arm_comfort_cost(const ArmSize& arm, const Vector3& p_arm);
/// An arm where it is.
struct PlacedArm {
  /// Lengths of its two parts.
  ArmSize size;
  Vector3 shoulder{Vector3::Zero()};  ///< world [m]
  /// From the world to (forward, outward, up) of the torso.
  Eigen::Matrix3d to_arm{Eigen::Matrix3d::Identity()};
  double length() const { return size.upper + size.fore; }  ///< shoulder to hand [m]
};
/// Returns the arm with its shoulder and the axes of the torso; nullopt when its joints are not all
/// known.
std::optional<PlacedArm> placed_arm(const Person&, Side side);
/// Returns the comfort cost of the better of these arms at p: from the layer where there is one
/// (out of reach, or blocked by furniture: 1), else arm_comfort_cost.
double arm_comfort_cost(const CostGrid* layer, const std::vector<PlacedArm>& arms,
                        const Vector3& p);
/// Returns the arms of the person whose joints are known.
std::vector<PlacedArm> placed_arms(const Person&);
/// Returns whether an arm reaches p (world) with the torso where it is.
bool within_reach(const Person&, const Vector3& p);
/// Returns the length of the longer arm, shoulder to hand [m]; 0 when no arm is known.
double arm_length(const Person&);

/// The parts of the cost of one configuration, before weighting.
struct CostParts {
  /// Each in [0, 1]; comfort is that of the arm.
  double safety{}, visibility{}, comfort{};
  double distance{};  ///< robot to the simplified body [m]; +inf without people
  double outside{};   ///< what outside layers add, weighted, each where the robot fares worst in it
};

/// Returns the sum of safety, visibility and comfort by their weights, in [0, 1], plus what outside
/// layers add.
double weighted_cost(const CostParts&, const CostSettings&);
/// Returns the costs of a hand or object at p, as a point, for one person.
CostParts point_cost(const Person&, const Vector3& p, const CostSettings&);

/// What an outside layer forbids: which link is there.
struct ForbiddenPlace {
  const CostGrid* layer{};  ///< null: nowhere forbidden
  int link{-1};             ///< robot link that is in the forbidden place; -1: none
};

/// Cost of a robot configuration for all people in the scene: the max over people. Safety looks
/// at the links that axes move (a platform at rest would hide what the arm does), visibility and
/// comfort at the tool frame, outside layers at points along those links and the tool frame.
class HumanCost {
 public:
  HumanCost(const RobotModel& robot, CostSettings settings);
  /// Replaces all people; their joints are in the world frame.
  void set_people(const HumanState& people);
  /// Arm comfort of the person it is about comes from the layer then (out of reach, or blocked by
  /// furniture: 1), that of others and without a layer from arm_comfort_cost.
  void set_layers(LayersNow layers);
  /// Sets the pose of the root link of the robot in the world.
  void set_base(const Pose& T_world_base);
  /// Multiplies what people cost from now on; `gain` >= 0, 1 at the beginning. What outside layers
  /// add, and parts(), stay as they are.
  void set_gain(double gain) { gain_ = gain; }
  /// Returns the factor of what people cost.
  double gain() const { return gain_; }
  /// From now on states that differ in these axes only are evaluated in batches, in single
  /// precision: costs within 2e-4 of parts(). When another axis differs, the robot is folded anew.
  /// Empty: one by one, as at the beginning.
  void set_moving_axes(const std::vector<int>& axes);
  /// Returns whether at least one person is in the scene.
  bool anyone() const { return !people_.people.empty(); }
  /// Returns whether a person is in the scene or an outside layer adds costs; else every cost is 0.
  bool concerned() const { return anyone() || !layers_.outside.empty(); }
  double operator()(const Vector& q) const;  ///< all axes; in [0, gain()] without outside layers
  /// Writes the costs of the states from + at[i] (to - from), i < count.
  void on_line(const Vector& from, const Vector& to, const double* at, int count,
               double* cost) const;
  CostParts parts(const Vector& q) const;    ///< of the person it is worst for
  double outside(const Vector& q) const;     ///< CostParts::outside alone
  bool forbids() const { return forbids_; }  ///< some outside layer forbids some place
  /// Returns the first layer that forbids a place the robot is at, `q`: all axes; a null layer when
  /// none does.
  ForbiddenPlace forbidden(const Vector& q) const;

 private:
  struct PlacedCapsule {
    Vector3 a, b;
    double radius{};
  };
  struct Someone {
    SimplifiedBody body;
    std::optional<Sight> sight;
    std::vector<PlacedArm> arms;
    const CostGrid* comfort{};
  };
  void find_comfort_layers();
  template <class PointAt>
  double outside_cost(PointAt&& point_at) const;
  void set_batch_people();
  double distance_to(const SimplifiedBody&) const;
  const RobotModel* robot_;
  CostSettings settings_;
  std::vector<LinkCapsule> capsules_;
  HumanState people_;
  LayersNow layers_;
  bool forbids_{false};
  double gain_{1.0};
  std::vector<Someone> someone_;
  std::vector<LinkPoint> probes_;  // at which outside layers are sampled; the tool first
  std::unique_ptr<BatchCost> batch_;
  Pose T_world_base_{Pose::Identity()};
  int tool_{-1};
  mutable std::vector<Pose> links_;
  mutable std::vector<PlacedCapsule> placed_;
  mutable std::vector<double> bounds_;
};

/// Returns the distance of a capsule (segment and radius) to the simplified body [m]; negative when
/// they overlap.
double simplified_distance(const SimplifiedBody&, const Vector3& a, const Vector3& b,
                           double radius);

}  // namespace handsel
