// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/robot_maker.hpp"

#include <algorithm>
#include <fstream>

#include "common/base/errors.hpp"
#include "common/config/described.hpp"
#include "common/config/resources.hpp"
#include "common/config/search_path.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/robot_capsules.hpp"
#include "deploy/handsel/own_robot/description_text.hpp"
#include "deploy/handsel/own_robot/mount.hpp"
#include "deploy/handsel/own_robot/rest_search.hpp"
#include "deploy/handsel/own_robot/robot_picture.hpp"
#include "deploy/handsel/own_robot/srdf_pairs.hpp"
#include "deploy/handsel/own_robot/urdf_correction.hpp"

namespace handsel {
namespace {

namespace fs = std::filesystem;

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush())
    throw ConfigError("cannot write " + file.string() + "; --out names another folder");
}

class Maker {
 public:
  Maker(const RobotWishes& wishes, const MakerProgress& progress)
      : wishes_(wishes), progress_(progress) {
    made_.description = wishes.folder / (wishes.name + ".txtpb");
    made_.scenario = wishes.folder / (wishes.name + "_give.txtpb");
  }

  MadeRobot make() {
    progress_("reading " + wishes_.urdf.string(), 0);
    const CorrectedUrdf urdf = correct_urdf(
        {wishes_.urdf, wishes_.packages, wishes_.folder / (wishes_.name + ".urdf"), {}});
    made_.notes = urdf.notes;
    made_.files = {made_.description};
    const bool corrected = urdf.file != wishes_.urdf;
    if (corrected) made_.files.push_back(urdf.file);
    const RobotModel tree = RobotModel::load_urdf(urdf.file);
    made_.parts = find_parts(tree, {.tool = wishes_.tool});
    text_.name = wishes_.name;
    text_.urdf = corrected ? urdf.file.filename().string() : fs::absolute(urdf.file).string();
    text_.without = wishes_.without;
    attach_hand(tree, urdf.file);
    set_limits(tree);
    hold_others(tree);
    write_file(made_.description, text_of(text_));  // a draft: all pairs of links are tested
    const RobotModel draft = RobotModel::load(made_.description);
    made_.pairs = sample_pairs(draft, wishes_.matrix, [&](double done) {
      return progress_("sampling which links can touch", done);
    });
    write_pairs(draft);
    finish();
    return std::move(made_);
  }

 private:
  /// Describes the hand of the URDF, or mounts one that has a URDF of its own.
  void attach_hand(const RobotModel& tree, const fs::path& urdf) {
    const std::string flange = tree.links()[static_cast<std::size_t>(made_.parts.flange)].name;
    text_.flange = flange;
    if (wishes_.hand.empty() && !made_.parts.hand.empty()) {
      describe_gripper(tree, urdf);
      text_.tool = flange;
      return;
    }
    text_.hand = wishes_.hand.empty() ? "parallel" : wishes_.hand;
    const HandModel hand = HandModel::load(hand_description(text_.hand));
    if (is_path(text_.hand)) text_.hand = fs::absolute(text_.hand).string();
    const std::vector<Axis>& axes = hand.model().axes();
    const bool inside = std::all_of(axes.begin(), axes.end(), [&](const Axis& axis) {
      return std::find(made_.parts.hand.begin(), made_.parts.hand.end(), axis.name) !=
             made_.parts.hand.end();
    });
    if (!inside) mount(tree, flange);
    text_.tool = inside ? flange : hand.model().links().front().name;
    move_to_held(axes);
    T_tool_grasp_ = hand.T_hand_grasp();
    const Vector3 offset = T_tool_grasp_.translation();
    if (offset.norm() > 1e-3) tool_direction_ = offset.normalized();
    pinches_ = hand.pinches();
  }

  void mount(const RobotModel& tree, const std::string& flange) {
    text_.mounted = true;
    text_.T_flange_palm = mount_pose(tree, made_.parts);
    if (!made_.parts.hand.empty())  // another hand is on the flange
      for (const Joint& joint : tree.joints())
        if (joint.parent == made_.parts.flange)
          text_.without.push_back(tree.links()[static_cast<std::size_t>(joint.child)].name);
    made_.parts.hand.clear();
    made_.only_you.push_back("whether hand \"" + text_.hand + "\" is on link " + flange +
                             " as `mount` says: compare the picture with the robot");
  }

  /// The group "hand" has the joints of the hand's description in its order; others are held.
  void move_to_held(const std::vector<Axis>& axes) {
    std::vector<std::string> order;
    for (const Axis& axis : axes) order.push_back(axis.name);
    for (const std::string& joint : made_.parts.hand)
      if (std::find(order.begin(), order.end(), joint) == order.end())
        made_.parts.held.push_back(joint);
    made_.parts.hand = order;
  }

  void describe_gripper(const RobotModel& tree, const fs::path& urdf) {
    const std::string name = wishes_.name + "_hand";
    const fs::path own_urdf = wishes_.folder / (name + ".urdf"),
                   file = wishes_.folder / (name + ".txtpb");
    const Gripper gripper = find_gripper(tree, made_.parts);
    write_hand_urdf(urdf, tree, made_.parts, own_urdf);
    write_file(file, gripper_text(name, own_urdf.filename().string(), gripper, tree));
    const HandModel hand = HandModel::load(file);  // checks that it can be read
    made_.files.insert(made_.files.end(), {file, own_urdf});
    text_.hand = file.filename().string();
    T_tool_grasp_ = hand.T_hand_grasp();
    tool_direction_ = gripper.reach;
    pinches_ = hand.pinches();
    for (const GripperFinger& f : gripper.fingers)
      for (const std::string& joint : f.joints)
        rest_[joint] = 0.5 * (gripper.open.at(joint) + gripper.closed.at(joint));
    move_to_held(hand.model().axes());
    made_.only_you.push_back("whether the pads in " + file.filename().string() +
                             " are where the fingers touch, and how hard they may press "
                             "(grip_force)");
  }

  void set_limits(const RobotModel& tree) {
    std::map<std::string, YamlLimits> given;
    if (!wishes_.joint_limits.empty()) {
      given = read_joint_limits(wishes_.joint_limits);
      for (const auto& [joint, limits] : given)
        if (std::none_of(tree.joints().begin(), tree.joints().end(),
                         [&, name = joint](const Joint& j) { return j.name == name; }))
          made_.notes.push_back(wishes_.joint_limits.filename().string() + " names joint " + joint +
                                ", which the URDF does not have: passed over");
    }
    std::vector<AxisLimitSet> all = find_limits(tree, indices(tree, made_.parts.arm), given);
    if (text_.mounted) {
      const RobotModel hand = HandModel::load(hand_description(text_.hand)).model();
      const auto more = find_limits(hand, Group{}, given);
      all.insert(all.end(), more.begin(), more.end());
    }
    std::vector<std::string> assumed;
    for (const auto* group : {&made_.parts.arm, &made_.parts.hand})
      for (const std::string& joint : *group)
        for (const AxisLimitSet& set : all)
          if (set.joint == joint) {
            text_.limits.push_back(set);
            if (set.assumed) assumed.push_back(joint);
          }
    if (!assumed.empty())
      made_.only_you.push_back("the accelerations and jerks of the maker: assumed for " +
                               std::to_string(assumed.size()) + " of " +
                               std::to_string(text_.limits.size()) + " axes");
  }

  static Group indices(const RobotModel& tree, const std::vector<std::string>& joints) {
    Group group;
    for (const std::string& joint : joints)
      for (int i = 0; i < tree.dof(); ++i)
        if (tree.axes()[static_cast<std::size_t>(i)].name == joint) group.axes.push_back(i);
    return group;
  }

  /// Joints outside the groups are held within their limits.
  void hold_others(const RobotModel& tree) {
    for (const Axis& axis : tree.axes())
      if (const double value = std::clamp(0.0, axis.lower, axis.upper);
          value != 0 && !rest_.contains(axis.name) && !is_left_out(tree, axis))
        rest_[axis.name] = value;
    if (text_.mounted) {
      const HandModel hand = HandModel::load(hand_description(text_.hand));
      for (int i = 0; i < hand.model().dof(); ++i)
        rest_[hand.model().axes()[static_cast<std::size_t>(i)].name] = hand.rest()[i];
    }
    if (!made_.parts.held.empty())
      made_.only_you.push_back("where these joints stand, which are neither arm nor hand (rest): " +
                               joined_names(made_.parts.held));
    if (!made_.parts.other_arms.empty())
      made_.only_you.push_back("whether a further arm takes part (other_arms), ending with joint " +
                               joined_names(made_.parts.other_arms));
    text_.parts = made_.parts;
    text_.rest = rest_;
  }

  bool is_left_out(const RobotModel& tree, const Axis& axis) const {
    const int child = tree.joints()[static_cast<std::size_t>(axis.joint)].child;
    return std::any_of(text_.without.begin(), text_.without.end(), [&](const std::string& link) {
      const int top = tree.link_index(link);
      return top >= 0 && descends_from(tree, top)[static_cast<std::size_t>(child)];
    });
  }

  static std::string joined_names(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
  }

  /// Disables the pairs of the user's SRDF between links that it names, the sampled ones of all
  /// other links, and those inside the hand.
  void write_pairs(const RobotModel& robot) {
    const auto given =
        wishes_.srdf.empty() ? std::vector<SrdfPair>{} : read_srdf_pairs(wishes_.srdf);
    const std::set<std::string> named = links_of(given);
    std::vector<SrdfPair> pairs;
    std::set<std::string> unknown, not_named;
    std::set<std::pair<std::string, std::string>> disabled;
    for (const SrdfPair& pair : given) {
      bool both = true;
      for (const std::string& link : {pair.a, pair.b})
        if (robot.link_index(link) < 0) unknown.insert(link), both = false;
      if (!both) continue;
      pairs.push_back(pair);
      disabled.insert(std::minmax(pair.a, pair.b));
    }
    const auto hand = descends_from(robot, robot.tool_link());
    for (const LinkPair& pair : made_.pairs) {
      const std::string &a = robot.links()[static_cast<std::size_t>(pair.a)].name,
                        &b = robot.links()[static_cast<std::size_t>(pair.b)].name;
      const bool of_hand =
          hand[static_cast<std::size_t>(pair.a)] && hand[static_cast<std::size_t>(pair.b)];
      const bool by_srdf = named.contains(a) && named.contains(b);
      if (!given.empty())
        for (const std::string& link : {a, b})
          if (!named.contains(link)) not_named.insert(link);
      if (disabled.contains(std::minmax(a, b))) continue;
      if (of_hand)
        pairs.push_back({a, b, "Hand"});
      else if (pair.kind == PairKind::always || (pair.kind == PairKind::never && !by_srdf))
        pairs.push_back({a, b, name_of(pair.kind)});
      if (pair.kind == PairKind::always && !of_hand)
        made_.notes.push_back("links " + a + " and " + b + " touch in " +
                              std::to_string(static_cast<int>(100 * pair.touched)) +
                              " % of the configurations and are not tested against each other");
    }
    for (const std::string& link : unknown)
      made_.notes.push_back("the SRDF names link " + link +
                            ", which the robot does not have: its pairs are passed over");
    for (const std::string& link : not_named)
      made_.notes.push_back("the SRDF does not name link " + link + ": its pairs were sampled");
    const fs::path file = wishes_.folder / (wishes_.name + ".srdf");
    write_srdf(file, wishes_.name,
               "Pairs of links that are not tested against each other, written by `handsel model "
               "new`; Never and Always: " +
                   std::to_string(wishes_.matrix.configurations) + " configurations sampled.",
               pairs);
    made_.files.push_back(file);
    text_.srdf = file.filename().string();
  }

  /// Searches the rest configuration and writes description, scenario and picture.
  void finish() {
    write_file(made_.description, text_of(text_));
    const RobotModel robot = RobotModel::load(made_.description);
    progress_("searching a rest configuration", 1);
    Vector rest = robot.rest_configuration();
    if (const auto found = find_rest(robot, T_tool_grasp_, tool_direction_)) {
      rest = *found;
      for (int i = 0; i < robot.dof(); ++i)
        if (std::abs(rest[i]) > 5e-4)
          text_.rest[robot.axes()[static_cast<std::size_t>(i)].name] =
              std::round(rest[i] * 1e3) / 1e3;
    } else {
      made_.only_you.push_back(
          "a rest configuration: none was found with the hand before the base and fingers down");
    }
    made_.only_you.push_back(
        "where the robot stands (`base`), and where table and person are, in " +
        made_.scenario.filename().string());
    text_.notes = made_.notes;
    text_.only_you = made_.only_you;
    write_file(made_.description, text_of(text_));
    made_.capsules = static_cast<int>(robot_capsules(robot).size());
    write_scenario(robot, rest);
    const fs::path picture = wishes_.folder / (wishes_.name + ".png");
    write_file(picture, robot_picture(robot, rest, tool_direction_, 480).png());
    made_.files.push_back(picture);
  }

  void write_scenario(const RobotModel& robot, const Vector& rest) {
    FirstScene scene;
    scene.name = wishes_.name + "_give";
    scene.robot = wishes_.name;
    std::error_code error;
    try {
      if (!fs::equivalent(find_file(FileKind::robot, wishes_.name), made_.description, error))
        throw MissingError("");
    } catch (const std::exception&) {  // the name is no robot of the search path, or another one
      scene.robot = fs::absolute(made_.description).string();
    }
    scene.object = pinches_ ? "box" : "mug";
    scene.arm = size_of_arm(robot, T_tool_grasp_);
    made_.reach = scene.arm.reach;
    const int first =
        robot
            .joints()[static_cast<std::size_t>(
                robot.axes()[static_cast<std::size_t>(robot.require_group("arm").axes.front())]
                    .joint)]
            .child;
    const auto moved = descends_from(robot, first);
    std::vector<Pose> T;
    robot.forward(rest, T);
    for (const LinkCapsule& c : robot_capsules(robot)) {
      const auto link = static_cast<std::size_t>(c.link);
      if (moved[link]) continue;
      for (const Vector3& end : {c.a, c.b})
        scene.footprint = std::max(scene.footprint, c.radius - (T[link] * end).y());
    }
    write_file(made_.scenario, first_scenario(scene));
    made_.files.push_back(made_.scenario);
  }

  const RobotWishes& wishes_;
  const MakerProgress& progress_;
  MadeRobot made_;
  RobotText text_;
  std::map<std::string, double> rest_;
  Pose T_tool_grasp_{Pose::Identity()};
  Vector3 tool_direction_{Vector3::UnitZ()};  // in which the hand reaches, tool frame
  bool pinches_{};
};

}  // namespace

MadeRobot make_robot(const RobotWishes& wishes, const MakerProgress& progress) {
  std::error_code error;
  const bool is_new = fs::create_directories(wishes.folder, error);
  if (!fs::is_directory(wishes.folder, error))
    throw ConfigError("cannot make the folder " + wishes.folder.string() +
                      "; --out names another one");
  Maker maker(wishes, progress);
  try {
    return maker.make();
  } catch (...) {
    fs::remove(wishes.folder / (wishes.name + ".txtpb"), error);
    if (is_new) fs::remove(wishes.folder, error);  // only while it is empty
    throw;
  }
}

}  // namespace handsel
