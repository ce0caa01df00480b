// SPDX-License-Identifier: Apache-2.0
// Contact of the arm with something unforeseen, from the torques its model does not explain. A
// steady push never becomes usual: a clamp stays a contact until it is freed. Own method. Pure, no
// heap after construction.
#pragma once

#include <vector>

#include "common/trajectory/trajectory.hpp"

namespace handsel::trajectory_controller {

struct ContactSettings {
  double torque{25.0};           ///< beyond what is usual at the moment [Nm]
  double handover_torque{50.0};  ///< the same during a handover, where a pull is expected [Nm]
  double time{0.02};             ///< for this long [s]
  double usual_time{0.5};        ///< time constant of the usual torque: load, friction, model [s]
  double follow_torque{5.0};     ///< what is usual follows only torques this near to it [Nm]
  double max_usual{15.0};        ///< and is never larger than this [Nm]
  double yield_torque{15.0};     ///< at rest, an axis pushed by more than this complies [Nm]
  double yield_time{3.0};        ///< a longer push below `torque` is taken for a load [s]
  double clamp_time{1.0};        ///< a contact that lasts longer is a clamp [s]
};

enum class Contact { none, contact, clamped };

class ContactWatch {
 public:
  /// `axes`: the axes watched.
  ContactWatch(const ContactSettings& settings, std::vector<int> axes);
  /// Starts over from the next sample, unless there is a contact: its cause would become usual.
  void reset() noexcept { seen_ = contact_ != Contact::none; }
  /// Takes one sample of the external torques of all axes [Nm], `dt` [s] after the one before, and
  /// returns whether there is contact. A robot that does not measure them (empty vector) has none.
  /// `resting`: the arm does not move by itself; `in_handover`: during a handover.
  Contact update(const Eigen::VectorXd& external_torque, double dt, bool resting,
                 bool in_handover) noexcept;
  /// Returns the push on the i-th watched axis, for complying: beyond the usual before it began, 0
  /// within yield_torque [Nm].
  double push(std::size_t i) const noexcept { return pushes_[i]; }
  /// Returns whether an axis was pushed by more than yield_torque in the last sample.
  bool pushed() const noexcept { return pushed_for_ > 0.0; }
  /// Result of the last sample.
  Contact contact() const noexcept { return contact_; }
  int axis() const noexcept { return axis_; }         ///< where it was felt most
  double torque() const noexcept { return torque_; }  ///< beyond the usual, there [Nm]

 private:
  void forget() noexcept;

  ContactSettings settings_;
  std::vector<int> axes_;
  std::vector<double> usual_, before_, pushes_;
  bool seen_{};
  Contact contact_{Contact::none};
  double pressed_for_{}, pushed_for_{}, torque_{};
  int axis_{-1};
};

}  // namespace handsel::trajectory_controller
