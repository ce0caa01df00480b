// SPDX-License-Identifier: Apache-2.0
#include "common/model/hand_model.hpp"

#include <algorithm>
#include <cmath>

#include "common/config/resources.hpp"
#include "common/model/description/description_parts.hpp"
#include "common/model/description/robot_model_builder.hpp"

namespace handsel {
namespace fs = std::filesystem;

class HandModelBuilder {
 public:
  HandModelBuilder(const fs::path& file) : file_(file) { load_text_proto(file, text_); }

  HandModel build() {
    if (text_.name().empty()) throw ConfigError(file_.string() + ": name is missing");
    if (text_.fingers().size() < 2)
      throw ConfigError(file_.string() + ": a hand needs at least two fingers, the thumb first");
    hand_.name_ = text_.name();
    read_model();
    read_fingers();
    hand_.rest_ = posture(text_.rest(), "rest", hand_.model_.rest_configuration());
    hand_.pregrasp_ = posture(text_.pregrasp(), "pregrasp", hand_.rest_);
    shrink();
    hand_.grip_force_ = text_.grip_force();
    if (!(hand_.grip_force_ >= 0))
      throw ConfigError(locate(file_, "grip_force") + ": grip_force must not be negative");
    hand_.T_hand_grasp_ =
        text_.has_grasp_frame() ? to_pose(text_.grasp_frame()) : workspace_centre();
    return std::move(hand_);
  }

 private:
  void read_model() {
    std::vector<std::string>
        joints;  // in the order of the fingers; a joint that moves several fingers occurs once
    for (const auto& finger : text_.fingers())
      for (const std::string& joint : finger.joints())
        if (std::find(joints.begin(), joints.end(), joint) == joints.end()) joints.push_back(joint);
    RobotModelBuilder builder = described_urdf(file_, text_, {});
    builder.set_axes(joints, {}, file_);
    builder.add_group("all", joints, "", file_);
    for (const auto& finger : text_.fingers()) {
      if (finger.joints().empty())
        throw ConfigError(where(finger.name()) + "finger " + finger.name() + " has no joints");
      builder.add_group(finger.name(), {finger.joints().begin(), finger.joints().end()},
                        finger.tip_link(), file_);
      Finger out{finger.name(), {}, finger.tip_link(), finger.tip_radius(), {}};
      for (const std::string& joint : finger.joints())
        out.axes.push_back(
            static_cast<int>(std::find(joints.begin(), joints.end(), joint) - joints.begin()));
      if (finger.has_pad()) out.pad = read_pad(finger);
      if (out.pad && out.tip_radius == 0)
        out.tip_radius = std::min(out.pad->width, out.pad->height) / 2;
      hand_.fingers_.push_back(out);
    }
    builder.default_limits();
    hand_.model_ = builder.finish();
  }

  Pad read_pad(const config::FingerDescription& finger) const {
    Pad pad{to_pose(finger.pad().pose()), finger.pad().width(), finger.pad().height()};
    if (!(pad.width > 0) || !(pad.height > 0))
      throw ConfigError(where(finger.name()) + "the pad of finger " + finger.name() +
                        " needs width and height > 0");
    return pad;
  }

  void read_fingers() const {
    const auto with_pad = std::count_if(hand_.fingers_.begin(), hand_.fingers_.end(),
                                        [](const Finger& f) { return f.pad.has_value(); });
    if (hand_.fingers_.size() == 2 && with_pad < 2)
      throw ConfigError(file_.string() +
                        ": a hand of two fingers holds with areas; each needs a pad");
    if (hand_.fingers_.size() > 2 && with_pad > 0)
      throw ConfigError(file_.string() + ": a hand of " + std::to_string(hand_.fingers_.size()) +
                        " fingers touches with fingertips (tip_radius); pads are for two fingers");
    for (const auto& finger : hand_.fingers_) {
      if (hand_.model_.link_index(finger.tip_link) < 0)
        throw ConfigError(where(finger.name) + "finger " + finger.name + " has no tip_link");
      if (!(finger.tip_radius > 0))
        throw ConfigError(where(finger.name) + "tip_radius of finger " + finger.name +
                          " must be > 0");
    }
  }

  Vector posture(const google::protobuf::Map<std::string, double>& values, const std::string& field,
                 Vector q) const {
    for (const auto& [joint, value] : values) {
      int axis = -1;
      for (int i = 0; i < hand_.model_.dof(); ++i)
        if (hand_.model_.axes()[i].name == joint) axis = i;
      if (axis < 0)
        throw ConfigError(where(joint) + field + " names \"" + joint +
                          "\", which is no actuated joint of the hand");
      const Axis& a = hand_.model_.axes()[axis];
      if (!(value >= a.lower && value <= a.upper))
        throw ConfigError(where(joint) + field + " of \"" + joint +
                          "\" is outside the joint's limits");
      q[axis] = value;
    }
    return q;
  }

  void shrink() {
    const double margin = text_.contact_margin();
    const int n = hand_.model_.dof();
    hand_.lower_contact_.resize(n);
    hand_.upper_contact_.resize(n);
    for (int i = 0; i < n; ++i) {
      const Axis& axis = hand_.model_.axes()[i];
      hand_.lower_contact_[i] = axis.lower + margin;
      hand_.upper_contact_[i] = axis.upper - margin;
      if (!(margin >= 0) || hand_.lower_contact_[i] >= hand_.upper_contact_[i])
        throw ConfigError(locate(file_, "contact_margin") +
                          ": contact_margin leaves no range for joint " + axis.name);
    }
  }

  /// Returns the centre of the finger workspaces: the mean of the mid-range positions of the tips,
  /// with equal weight of the thumb and all others. Axes of the palm.
  Pose workspace_centre() const {
    const Vector middle = (hand_.lower_contact_ + hand_.upper_contact_) / 2;
    std::vector<Pose> links;
    hand_.model_.forward(middle, links);
    Vector3 others = Vector3::Zero();
    for (std::size_t f = 1; f < hand_.fingers_.size(); ++f)
      others += links[hand_.model_.link_index(hand_.fingers_[f].tip_link)].translation();
    others /= static_cast<double>(hand_.fingers_.size() - 1);
    return make_pose(
        (links[hand_.model_.link_index(hand_.fingers_[0].tip_link)].translation() + others) / 2);
  }

  std::string where(const std::string& name) const {
    return locate(file_, "\"" + name + "\"") + ": ";
  }

  fs::path file_;
  config::HandDescription text_;
  HandModel hand_;
};

HandModel HandModel::load(const fs::path& description) {
  return HandModelBuilder(description).build();
}

}  // namespace handsel
