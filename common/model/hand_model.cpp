#include "common/model/hand_model.hpp"

#include <cmath>

#include "common/config/resources.hpp"
#include "common/model/description_parts.hpp"
#include "common/model/robot_model_builder.hpp"

namespace handsel {
namespace fs = std::filesystem;

class HandModelBuilder {
 public:
  HandModelBuilder(const fs::path& file) : file_(file) { load_text_proto(file, text_); }

  HandModel build() {
    if (text_.name().empty()) throw ConfigError(file_.string() + ": name is missing");
    if (text_.urdf().empty()) throw ConfigError(file_.string() + ": urdf is missing");
    if (text_.fingers().size() < 2) throw ConfigError(file_.string() + ": a hand needs at least two fingers, the thumb first");
    hand_.name_ = text_.name();
    read_model();
    read_fingers();
    hand_.rest_ = posture(text_.rest(), "rest", hand_.model_.rest_posture());
    hand_.pregrasp_ = posture(text_.pregrasp(), "pregrasp", hand_.rest_);
    shrink();
    hand_.T_hand_grasp_ = text_.has_grasp_frame() ? to_pose(text_.grasp_frame()) : workspace_centre();
    return std::move(hand_);
  }

 private:
  void read_model() {
    const fs::path urdf = file_.parent_path() / text_.urdf();
    if (!fs::exists(urdf)) throw MissingError(locate(file_, text_.urdf()) + ": no file " + urdf.string());
    std::vector<std::string> joints;
    for (const auto& finger : text_.fingers()) joints.insert(joints.end(), finger.joints().begin(), finger.joints().end());
    RobotModelBuilder builder(urdf, Meshes::load);
    builder.set_axes(joints, {}, file_);
    builder.add_group("all", joints, "", file_);
    int next = 0;
    for (const auto& finger : text_.fingers()) {
      if (finger.joints().empty()) throw ConfigError(where(finger.name()) + "finger " + finger.name() + " has no joints");
      builder.add_group(finger.name(), {finger.joints().begin(), finger.joints().end()}, finger.tip_link(), file_);
      Finger out{finger.name(), {}, finger.tip_link(), finger.tip_radius()};
      for (int i = 0; i < finger.joints().size(); ++i) out.axes.push_back(next++);
      hand_.fingers_.push_back(out);
    }
    builder.default_limits();
    hand_.model_ = builder.finish();
  }

  void read_fingers() const {
    for (const auto& finger : hand_.fingers_) {
      if (hand_.model_.link_index(finger.tip_link) < 0)
        throw ConfigError(where(finger.name) + "finger " + finger.name + " has no tip_link");
      if (!(finger.tip_radius > 0)) throw ConfigError(where(finger.name) + "tip_radius of finger " + finger.name + " must be > 0");
    }
  }

  Vector posture(const google::protobuf::Map<std::string, double>& values, const std::string& field, Vector q) const {
    for (const auto& [joint, value] : values) {
      int axis = -1;
      for (int i = 0; i < hand_.model_.dof(); ++i)
        if (hand_.model_.axes()[i].name == joint) axis = i;
      if (axis < 0) throw ConfigError(where(joint) + field + " names \"" + joint + "\", which is no actuated joint of the hand");
      const Axis& a = hand_.model_.axes()[axis];
      if (!(value >= a.lower && value <= a.upper))
        throw ConfigError(where(joint) + field + " of \"" + joint + "\" is outside the joint's limits");
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
        throw ConfigError(locate(file_, "contact_margin") + ": contact_margin leaves no range for joint " + axis.name);
    }
  }

  /// Where the finger workspaces meet: the mean of the tips' mid-range positions, thumb and the others weighing the same. Axes of the palm.
  Pose workspace_centre() const {
    const Vector middle = (hand_.lower_contact_ + hand_.upper_contact_) / 2;
    std::vector<Pose> links;
    hand_.model_.forward(middle, links);
    Vector3 others = Vector3::Zero();
    for (std::size_t f = 1; f < hand_.fingers_.size(); ++f)
      others += links[hand_.model_.link_index(hand_.fingers_[f].tip_link)].translation();
    others /= static_cast<double>(hand_.fingers_.size() - 1);
    return make_pose((links[hand_.model_.link_index(hand_.fingers_[0].tip_link)].translation() + others) / 2);
  }

  std::string where(const std::string& name) const { return locate(file_, "\"" + name + "\"") + ": "; }

  fs::path file_;
  config::HandDescription text_;
  HandModel hand_;
};

HandModel HandModel::load(const fs::path& description) { return HandModelBuilder(description).build(); }

}  // namespace handsel
