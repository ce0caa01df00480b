// SPDX-License-Identifier: Apache-2.0
// Safety and visibility of up to sixteen states of a robot at once, for HumanCost where the moving
// axes are known. Own method: batches in single precision.
#pragma once

#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "common/collision/batch_chain.hpp"
#include "common/cost/person_frame.hpp"
#include "common/cost/simd_cost_kernel.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {

/// A point that moves with a link.
struct LinkPoint {
  /// Index of the link in the robot model.
  int link{};
  Vector3 p_link{Vector3::Zero()};  ///< in the frame of the link [m]
};

class BatchCost {
 public:
  /// Number of states in one batch.
  static constexpr int kStates = detail::kBatchStates;

  /// `points`: visibility is that of the first.
  BatchCost(const RobotModel& robot, std::vector<LinkCapsule> capsules,
            std::vector<LinkPoint> points);

  /// Sets the axes in which the states of a batch differ; where another axis has changed, the fixed
  /// parts of the robot are placed anew. Empty: run() is false.
  void set_axes(const std::vector<int>& axes);
  /// Sets the pose of the root link of the robot in the world.
  void set_base(const Pose& T_world_base);
  struct Someone {
    SimplifiedBody body;         ///< cylinder and head, world [m]
    std::optional<Sight> sight;  ///< eyes and gaze; nullopt: unknown, visibility is then 0
  };
  /// Replaces all people. `safety_radius`: R [m]; `visibility_cutoff`: nothing beyond this distance
  /// of the eyes [m].
  void set_people(std::vector<Someone> people, double safety_radius, double visibility_cutoff);

  /// Evaluates the states from + at[i] (to - from), i < count <= kStates, with the first `points`
  /// of the points. False where a batch does not apply: no axes are set, another axis differs
  /// between the ends, or an axis turns too far for single precision.
  bool run(const Vector& from, const Vector& to, const double* at, int count, std::size_t points);
  /// Returns the safety cost, [0, 1], of a person by index in one state of the last run(), by
  /// index.
  double safety(std::size_t person, int slot) const {
    return safety_[person * kStates + static_cast<std::size_t>(slot)];
  }
  /// Returns the visibility cost, [0, 1], of the first point for a person by index in one state of
  /// the last run(), by index.
  double visibility(std::size_t person, int slot) const {
    return visibility_[person * kStates + static_cast<std::size_t>(slot)];
  }
  /// Returns where a point by index is in one state of the last run(), world [m].
  Vector3 point(std::size_t i, int slot) const {
    const float* p = point_.get() + 3 * i * kStates + slot;
    return base_.translation() + Vector3(p[0], p[kStates], p[2 * kStates]);
  }
  /// Sets another register width than the widest, for tests and measurements.
  void set_kernel(const detail::CostKernel& kernel) { kernel_ = &kernel; }

 private:
  struct Free {
    void operator()(float* p) const { ::operator delete[](p, std::align_val_t(64)); }
  };
  using Floats = std::unique_ptr<float[], Free>;
  static Floats rows(std::size_t count);
  bool fold(const Vector& from, const Vector& to);
  void place_people();

  const RobotModel& robot_;
  const detail::CostKernel* kernel_;
  std::vector<LinkCapsule> link_capsules_;
  std::vector<LinkPoint> link_points_;
  std::vector<int> axes_;
  Vector folded_;  // the state the chain was folded at; empty: not yet
  BatchChain chain_;
  Pose base_{Pose::Identity()};
  std::vector<detail::CostCapsule> capsules_;
  std::vector<detail::CostPoint> points_;
  std::vector<detail::CostPerson> people_;
  std::vector<Someone> someone_;
  double safety_radius_{1}, visibility_cutoff_{1};
  Floats pose_, ends_, safety_, visibility_, point_, q_;
};

}  // namespace handsel
