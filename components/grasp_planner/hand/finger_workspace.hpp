// SPDX-License-Identifier: Apache-2.0
// Where a fingertip can be: a grid of sampled forward kinematics and a hierarchy of spheres inside
// it (chapter section 3.2.5).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "components/grasp_planner/hand/finger_chain.hpp"

namespace handsel::grasp_planner {

struct WorkspaceSettings {
  double step{0.005};             ///< edge of a grid cell [m]
  double min_radius{0.004};       ///< spheres smaller than this are not made [m]
  std::uint32_t max_spheres{60};  ///< at most so many are made; smaller ones are left out
};

struct WorkspaceSphere {
  Vector3 centre{Vector3::Zero()};  ///< hand frame [m]
  double radius{};                  ///< [m]
};

class FingerWorkspace {
 public:
  /// Samples the finger's axes within the contact bounds of the hand. The other axes of the hand do
  /// not matter.
  FingerWorkspace(const HandModel& hand, const FingerChain& chain,
                  const WorkspaceSettings& settings = {});

  /// Largest first; strictly inside the workspace. A workspace without volume (fewer than three
  /// axes) is covered by balls of one cell instead: there the inverse kinematics decides.
  const std::vector<WorkspaceSphere>& spheres() const { return spheres_; }
  /// Returns whether the smallest sphere of the settings fits inside; false for fewer than three
  /// axes.
  bool has_volume() const { return has_volume_; }
  /// Joint values (the chain's axes) that put the tip into the cell of a point: up to three,
  /// clearly different, the farthest from the joint bounds first. Empty outside the workspace.
  struct Seed {
    Vector q;             ///< values of the chain's axes [rad]
    double centrality{};  ///< min distance to a bound / half range, [0, 1]
    /// Hand frame, unit.
    Vector3 tip_direction{Vector3::UnitZ()}, closing_direction{Vector3::UnitX()};
  };
  /// Returns the seeds of the cell that holds a point, hand frame [m]; empty where the tip does not
  /// reach.
  const std::vector<Seed>& seeds(const Vector3& p_hand) const;
  /// Centres of the grid cells the tip reaches, hand frame [m].
  std::vector<Vector3> cells() const;
  /// Returns the axis-aligned box around all sampled tip centres, hand frame [m].
  Eigen::AlignedBox3d box() const { return box_; }
  /// Returns the mean of the centres of all cells reached, hand frame [m].
  Vector3 centroid() const { return centroid_; }

 private:
  void sample(const HandModel& hand, const FingerChain& chain);
  void cover(const WorkspaceSettings& settings);
  std::int64_t cell(const Vector3& p) const;
  Vector3 centre(std::int64_t cell) const;

  double step_{};
  Eigen::AlignedBox3d box_;
  Eigen::Vector3i cells_{0, 0, 0};
  std::vector<std::uint32_t> entry_;  // per cell: 0 = not reached, else index + 1 into seeds_
  std::vector<std::vector<Seed>> seeds_;
  std::vector<WorkspaceSphere> spheres_;
  Vector3 centroid_{Vector3::Zero()};
  bool has_volume_{};
};

}  // namespace handsel::grasp_planner
