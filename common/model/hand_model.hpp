// SPDX-License-Identifier: Apache-2.0
// A hand as data: fingers in order (thumb first), their joints, fingertips, grasp frame
// (common/config/hand.proto).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/model/robot_model.hpp"

namespace handsel {

/// A flat fingertip.
struct Pad {
  /// Its middle; z is the direction in which it presses, x and y lie in it.
  Pose T_tip_pad{Pose::Identity()};
  double width{}, height{};  ///< along x and y [m]
};

struct Finger {
  std::string name;  ///< also that of the finger's group in model()
  /// Indices into the hand's own axes (0 = first actuated hand axis); fingers that move together
  /// share them.
  std::vector<int> axes;
  std::string tip_link;    ///< centre of the fingertip sphere is this link's origin
  double tip_radius{};     ///< [m]; of a pad half its lesser side, when none is given
  std::optional<Pad> pad;  ///< instead of a fingertip sphere
};

class HandModel {
 public:
  /// Loads a hand description; its URDF is the hand alone with the palm (= tool link of a robot
  /// that carries it) as root.
  static HandModel load(const std::filesystem::path& description);

  const std::string& name() const { return name_; }   ///< as in its description
  const RobotModel& model() const { return model_; }  ///< root link = palm / hand frame
  const std::vector<Finger>& fingers() const { return fingers_; }  ///< thumb first
  /// Grasp frame: about where contacts happen.
  const Pose& T_hand_grasp() const { return T_hand_grasp_; }
  const Vector& rest() const { return rest_; }                    ///< stretched
  const Vector& pregrasp() const { return pregrasp_; }            ///< open, ready to enclose
  const Vector& lower_contact() const { return lower_contact_; }  ///< bounds shrunk for contacts
  const Vector& upper_contact() const { return upper_contact_; }  ///< bounds shrunk for contacts
  /// Two fingers with pads: it pinches. All other hands hold with fingertips.
  bool pinches() const { return fingers_.size() == 2 && fingers_[0].pad && fingers_[1].pad; }
  /// A finger presses with no more than this [N]; 0: not said.
  double grip_force() const { return grip_force_; }

 private:
  friend class HandModelBuilder;
  std::string name_;
  RobotModel model_;
  std::vector<Finger> fingers_;
  Pose T_hand_grasp_{Pose::Identity()};
  Vector rest_, pregrasp_, lower_contact_, upper_contact_;
  double grip_force_{};
};

}  // namespace handsel
