// SPDX-License-Identifier: Apache-2.0
// Where the arm can be within its stop, and whether a live source of people observes that: no arm
// moves blind. Pure, no heap after construction, noexcept. Own method.
#pragma once

#include <string>
#include <vector>

#include "components/trajectory_controller/input/observed_space.hpp"
#include "components/trajectory_controller/supervise/stop/stop_proof.hpp"

namespace handsel::trajectory_controller {

/// Requirements on the observation of the space of a stop.
struct ViewSettings {
  /// True: a live source must observe where the arm can be within its stop; false: in a cell
  /// without tracking of people.
  bool require_view{true};
  double max_view_age{0.25};  ///< a view counts for so long after its capture [s]
  double margin{0.05};        ///< about the links, for held objects and tracking errors [m]
  /// Added about the links on the path ahead, so that the arm seldom stops off its
  /// path [m].
  double ahead_margin{0.05};
  /// Speed factor where a stop from full speed would lead out of the observed space, (0, 1].
  double boundary_factor{0.3};
  /// No person is below the floor or reaches above the ceiling: the space beyond need not be
  /// observed [m].
  double floor{0.0}, ceiling{2.5};
};

class StopSpace {
 public:
  StopSpace(const ViewSettings& settings, const StopProof& proof, const RobotModel& robot);
  StopSpace(const StopSpace&) = delete;
  StopSpace& operator=(const StopSpace&) = delete;

  /// Replaces the views by those of the newest HumanState.
  void set(const HumanState& people) noexcept { space_.set(people.views); }
  /// Returns whether all links are inside the observed space in both stops of the set-point that
  /// the proof has checked last. `position`: of it, all axes. `since`: the age of the views'
  /// message [s].
  bool observes_stops(const Vector& position, const Pose& T_world_base, double since) noexcept;
  /// Returns the max of the speed factors 1, boundary_factor and 0 at which a stop on the path,
  /// from a point where it has this velocity at full speed, stays inside the observed space.
  double factor(const Vector& position, const Vector& velocity, const Pose& T_world_base,
                double since) noexcept;
  /// Link found outside of the observed space; -1: none yet.
  int link() const noexcept { return link_; }
  /// Whether any view counts.
  bool any(double since) const noexcept { return space_.any(since); }

 private:
  static constexpr int kIntervals = 6;  // of a stop that is sampled

  bool inside(const Vector& position, double margin, const Pose& T_world_base,
              double since) noexcept;
  bool inside_during(bool robot_side, const Pose& T_world_base, double since) noexcept;
  bool inside_from(const Vector& position, const Pose& T_world_base, double since) noexcept;

  ViewSettings settings_;
  const StopProof& proof_;
  KinematicLimits limits_;  // of the stops
  ObservedSpace space_;
  MovingChain chain_;
  std::vector<char> all_frames_;
  std::vector<FrameMotion> motions_;
  std::vector<Box> boxes_;      // of the capsules
  std::vector<double> travel_;  // of the capsules [m]
  std::vector<double> by_axis_;
  Vector rest_, position_, stop_;
  int link_{-1};
};

/// Returns why nothing, or not enough, is observed, by the views of the newest HumanState; `link`:
/// name of the one outside. One sentence.
std::string why_blind(const HumanState& people, const std::string& link);

}  // namespace handsel::trajectory_controller
