// SPDX-License-Identifier: Apache-2.0
// Where the servos of the robot side hold, as the robot side reports it. Pure.
#pragma once

#include <cstdint>
#include <vector>

#include "common/messages/robot.hpp"

namespace handsel::trajectory_controller {

/// How the reference is compared.
struct ReferenceSettings {
  double bent{0.06};         ///< max bending by load and touch at rest [rad]
  double apart{0.01};        ///< larger than the lag of a following robot side at rest [rad]
  std::uint32_t cycles{20};  ///< between two comparisons
};

/// Decides whether set-points move the robot: they do not while its reference rests elsewhere. A
/// robot side can stop without reporting it, so the reference decides, not the mode alone. Own
/// method.
class RobotReference {
 public:
  enum class State : std::uint8_t {
    unknown,   ///< not reported, or too far from the measured configuration
    followed,  ///< set-points are followed, as far as one can tell
    moving,    ///< the robot side does not follow; its reference comes to rest or to the set-points
    resting,   ///< the reference has come to rest; set-points move nothing until they rest near it
  };

  /// `axes`: of the arm. `dof`: number of axes of the robot.
  RobotReference(std::vector<int> axes, int dof, const ReferenceSettings& settings);

  /// Evaluates the newest state, every `cycles` cycles. `follows`: the robot side says so.
  void update(const RobotState& state, const Vector& set_point, bool follows) noexcept;
  /// Notes that the newest state is too old: unknown until the next evaluation. A reference that
  /// is where it was before the gap counts as before.
  void set_stale() noexcept { stale_ = true; }
  /// Result of the last evaluation.
  State state() const noexcept { return stale_ ? State::unknown : state_; }
  /// Returns whether the reference is reported and the measured arm may rest there.
  bool reported(const RobotState& state) const noexcept;

 private:
  double farthest(const Vector& a, const Vector& b) const noexcept;

  std::vector<int> axes_;
  ReferenceSettings settings_;
  Vector seen_;
  State state_{State::unknown};
  bool stale_{};
};

}  // namespace handsel::trajectory_controller
