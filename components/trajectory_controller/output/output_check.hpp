// SPDX-License-Identifier: Apache-2.0
// The last check of every set-point: inside the limits, with a checked stop behind it, where a live
// source observes. What fails is replaced by the next set-point of the stop checked before. Pure,
// no heap, noexcept.
#pragma once

#include <utility>

#include "components/trajectory_controller/arm/arm_motion.hpp"
#include "components/trajectory_controller/axis_groups.hpp"
#include "components/trajectory_controller/hand/hands.hpp"
#include "components/trajectory_controller/output/set_points.hpp"
#include "components/trajectory_controller/supervise/stop/stop_space.hpp"

namespace handsel::trajectory_controller {

/// What the checks do.
struct OutputCheckSettings {
  double period{0.001};            ///< of control [s]
  bool dry_run{};                  ///< no set-point is sent: what is not observed does not matter
  int max_rejoins{4};              ///< attempts to rejoin a path before it is given up
  double shown_time{0.5};          ///< an unproven set-point is shown for so long [s]
  std::uint32_t blind_cycles{10};  ///< between two checks at rest that the arm is observed
};

/// Inputs of one check.
struct OutputCheckInputs {
  const PersonCapsules& people;  ///< newest
  const Pose& T_world_base;      ///< base of the robot in the world
  double age{};                  ///< of the human data [s]
  double payload{};              ///< mass held [kg]
  bool follows{};                ///< the robot side follows set-points
  bool moves_nothing{};          ///< set-points do not move the robot
  bool complying{};              ///< the arm gives in to a push: a person is there
  std::uint64_t cycle{};         ///< number of the cycle
};

/// What moves, to be stopped.
struct MovingParts {
  ArmMotion& arm;    ///< arm
  Hands& hands;      ///< all hands
  AxisMovers& head;  ///< head
};

class OutputCheck {
 public:
  /// Keeps references to all but the settings.
  OutputCheck(const OutputCheckSettings& settings, const RobotModel& robot,
              const AxisGroups& groups, StopProof& proof, StopSpace& stop_space);

  /// Checks the next set-point, and replaces what fails.
  void step(const OutputCheckInputs& in, MovingParts parts, SetPoints& set_points) noexcept;

  /// Returns whether a set-point broke a limit since the last call.
  bool take_limit_violation() noexcept {
    const bool out = limit_violation_;
    limit_violation_ = false;
    return out;
  }
  /// Number of set-points that had no checked stop behind them.
  std::uint64_t unproven() const noexcept { return unproven_; }
  /// Returns whether there was one lately.
  bool shows_unproven() const noexcept { return shown_cycles_ > 0; }
  /// Returns whether no live source observes where the arm can be within the stop of the last
  /// set-point.
  bool blind() const noexcept { return blind_; }

 private:
  void check_limits(MovingParts parts, SetPoints& set_points) noexcept;
  bool check_stop(const OutputCheckInputs& in, MovingParts parts, SetPoints& set_points) noexcept;
  void check_observed(const OutputCheckInputs& in, MovingParts parts,
                      SetPoints& set_points) noexcept;

  OutputCheckSettings settings_;
  const RobotModel& robot_;
  const AxisGroups& groups_;
  StopProof& proof_;
  StopSpace& stop_space_;
  bool limit_violation_{};
  bool blind_{};
  std::uint64_t unproven_{};
  int shown_cycles_{};    // for which an unproven set-point is still shown
  int failed_rejoins_{};  // how often, lately, the path was left again for want of a proof
};

}  // namespace handsel::trajectory_controller
