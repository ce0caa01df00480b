// SPDX-License-Identifier: Apache-2.0
#include "sim/people/taking_hand.hpp"

namespace handsel::sim {

void TakingHand::choose(const FreeGraspQuery& query, const HumanHand& shape,
                        const FreeGraspSettings& settings) {
  if (query.arm.side != side_) forget();
  side_ = query.arm.side;
  if (place_) return;
  if (!search_) search_.emplace(query, shape, settings);
  if (!search_->advance()) return;
  place_ = search_->found();
  search_.reset();
}

bool TakingHand::hold(const FreeGraspQuery& query, const HumanHand& shape,
                      const FreeGraspSettings& settings) {
  side_ = query.arm.side;
  search_.reset();
  place_ = find_free_grasp(query, shape, settings);
  return place_.has_value();
}

void TakingHand::forget() {
  search_.reset();
  place_.reset();
}

Vector3 TakingHand::position_at(const Vector3& from, double s, double curve,
                                const Pose& T_world_object) const {
  const Pose T = goal(T_world_object);
  const Vector3 to = T.translation(), control = behind(to, curve, Eigen::Quaterniond(T.linear()));
  return (1 - s) * (1 - s) * from + 2 * s * (1 - s) * control + s * s * to;
}

Vector3 TakingHand::behind(const Vector3& from, double curve,
                           const Eigen::Quaterniond& R_world_hand) {
  return from - curve * (R_world_hand * Vector3::UnitX());
}

HandConfiguration TakingHand::configuration(const Eigen::Quaterniond& R_world_rest, double turned,
                                            double closed, const Pose& T_world_object) const {
  HandConfiguration out;
  out.R_world_hand = R_world_rest.slerp(turned, Eigen::Quaterniond(goal(T_world_object).linear()));
  for (std::size_t d = 0; d < out.closures.size(); ++d)
    out.closures[d] = closed * place_->closures[d];
  return out;
}

}  // namespace handsel::sim
