// The human-aware costs (chapter section 4.1.2, eq. 1): safety, visibility, arm comfort, each in [0, 1], and their weighted sum.
#pragma once

#include <memory>
#include <vector>

#include "common/messages/world.hpp"
#include "common/model/human_body.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

struct CostSettings {
  double safety_radius{1.0};        ///< R [m]
  double visibility_cutoff{3.0};    ///< nothing beyond this distance of the eyes [m]
  double w_safety{1.0}, w_visibility{0.3}, w_comfort{0.3};
};

double safety_cost(double distance, double radius);                                            ///< ours, formulas of section 4.1.2
double visibility_cost(const Person&, const Vector3& p, double cutoff);                        ///< angle(gaze, p - eyes)/pi
/// Marler's form on the person's arm reaching p with the nearer hand; 1 when out of reach.
double arm_comfort_cost(const Person&, const Vector3& p);
bool within_reach(const Person&, const Vector3& p);

/// Cost of a robot configuration for everyone in the scene; the largest over people.
class HumanCost {
 public:
  HumanCost(const RobotModel& robot, CostSettings settings);
  void set_people(const HumanState& people) { people_ = people; }
  void set_base(const Pose& T_world_base) { T_world_base_ = T_world_base; }
  bool anyone() const { return !people_.people.empty(); }
  double operator()(const Vector& q) const;   ///< all axes; 0 when nobody is there
 private:
  const RobotModel& robot_;
  CostSettings settings_;
  std::vector<LinkCapsule> capsules_;
  HumanState people_;
  Pose T_world_base_{Pose::Identity()};
  mutable std::vector<Pose> links_;
};

}  // namespace handsel
