// Contact of the arm with something unforeseen, from the torques its model does not explain (ours). Pure, no heap after construction.
#pragma once

#include <vector>

#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_controller {

struct ContactSettings {
  double torque{25.0};        ///< beyond what is usual at the moment [Nm]
  double time{0.02};          ///< for this long [s]
  double usual_time{0.5};     ///< time constant of what is usual: load, friction, errors of the model [s]
  double yield_torque{15.0};  ///< at rest, an axis pushed by more than this beyond the usual gives way [Nm]
  double yield_time{3.0};     ///< a push longer than this is taken for a load [s]
};

class ContactWatch {
 public:
  /// `axes`: the axes watched.
  ContactWatch(const ContactSettings& settings, std::vector<int> axes);
  /// Starts over from the next sample.
  void reset() noexcept { seen_ = false; }
  /// One sample of the external torques of all axes [Nm], `dt` [s] after the one before. True while there is contact. A robot that does not
  /// measure them (empty vector) has none. `resting`: the arm does not move by itself.
  bool update(const Eigen::VectorXd& external_torque, double dt, bool resting) noexcept;
  /// The push on the i-th watched axis, for giving way: beyond the usual before it began, 0 within yield_torque [Nm].
  double push(std::size_t i) const noexcept { return pushes_[i]; }
  bool pushed() const noexcept { return pushed_for_ > 0.0; }
  int axis() const noexcept { return axis_; }         ///< where it was felt most
  double torque() const noexcept { return torque_; }  ///< beyond the usual, there [Nm]

 private:
  ContactSettings settings_;
  std::vector<int> axes_;
  std::vector<double> usual_, before_, pushes_;
  bool seen_{};
  double pressed_for_{}, pushed_for_{}, torque_{};
  int axis_{-1};
};

}  // namespace handsel::trajectory_controller
