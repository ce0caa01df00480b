// The human-aware costs (chapter section 4.1.2, eq. 1): safety, visibility, arm comfort, each in [0, 1], and their weighted sum.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/messages/world.hpp"
#include "common/model/human_body.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

struct CostSettings {
  double safety_radius{1.0};                                ///< R [m]
  double visibility_cutoff{3.0};                            ///< nothing beyond this distance of the eyes [m]
  double w_safety{1.0}, w_visibility{0.3}, w_comfort{0.3};  ///< >= 0, not all 0; their sum is scaled to 1
};

/// 1 at contact, 0 from `radius` on, falling in between (ours, formulas of section 4.1.2).
double safety_cost(double distance, double radius);
/// angle(gaze, p - eyes)/pi; where the gaze is unknown the body's front stands in for it.
double visibility_cost(const Person&, const Vector3& p, double cutoff);
/// Marler's form on the person's arm reaching p with the more comfortable hand: joint displacement, raised mass, nearness to joint
/// limits, weighted to [0, 1] (the arm's joints, limits and weights are ours); 1 when out of reach.
double arm_comfort_cost(const Person&, const Vector3& p);
double arm_comfort_cost(const Person&, Side side, const Vector3& p);
/// A person's arm by its lengths.
struct ArmSize {
  double upper{};  ///< shoulder to elbow [m]
  double fore{};   ///< elbow to wrist to hand [m]
};
/// nullopt when the joints of that arm are not all there.
std::optional<ArmSize> arm_size(const Person&, Side side);
/// arm_comfort_cost of an arm alone: p from the shoulder, along (forward, outward, up) of the torso [m].
double arm_comfort_cost(const ArmSize& arm, const Vector3& p_arm);
/// Some arm reaches p with the torso where it is.
bool within_reach(const Person&, const Vector3& p);
/// Shoulder to hand, the longer arm [m].
double arm_length(const Person&);

/// The parts of the cost of one configuration, before weighting.
struct CostParts {
  double safety{}, visibility{}, comfort{};
  double distance{};  ///< robot to the simplified body [m]; +inf if nobody
};

/// The weighted sum, in [0, 1].
double weighted_cost(const CostParts&, const CostSettings&);
/// The costs of a hand or object at p, as a point, for one person.
CostParts point_cost(const Person&, const Vector3& p, const CostSettings&);

/// Cost of a robot configuration for everyone in the scene, in [0, 1]; the largest over people. Safety looks at the links that axes move
/// (a platform that stands still would hide what the arm does), visibility and comfort at the tool frame.
class HumanCost {
 public:
  HumanCost(const RobotModel& robot, CostSettings settings);
  void set_people(const HumanState& people);
  void set_base(const Pose& T_world_base) { T_world_base_ = T_world_base; }
  bool anyone() const { return !people_.people.empty(); }
  double operator()(const Vector& q) const;  ///< all axes; 0 when nobody is there
  CostParts parts(const Vector& q) const;    ///< of the person it is worst for

 private:
  struct PlacedCapsule {
    Vector3 a, b;
    double radius{};
  };
  double distance_to(const SimplifiedBody&) const;
  const RobotModel* robot_;
  CostSettings settings_;
  std::vector<LinkCapsule> capsules_;
  HumanState people_;
  std::vector<SimplifiedBody> bodies_;
  Pose T_world_base_{Pose::Identity()};
  int tool_{-1};
  mutable std::vector<Pose> links_;
  mutable std::vector<PlacedCapsule> placed_;
  mutable std::vector<double> bounds_;
};

/// Distance of a capsule (segment and radius) to the simplified body [m]; negative when they overlap.
double simplified_distance(const SimplifiedBody&, const Vector3& a, const Vector3& b, double radius);

}  // namespace handsel
