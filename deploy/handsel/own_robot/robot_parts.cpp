// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/robot_parts.hpp"

#include <algorithm>

#include "common/base/errors.hpp"
#include "common/config/nearest_name.hpp"

namespace handsel {
namespace {

/// The moving joints of a robot as a tree.
class JointTree {
 public:
  explicit JointTree(const RobotModel& robot) : robot_(robot) {
    const auto& joints = robot.joints();
    for (std::size_t j = 0; j < joints.size(); ++j)
      if (joints[j].is_mimic && joints[j].dof >= 0) {
        const std::size_t driver = axis_joint(joints[j].dof);
        if (std::find(mimicked_.begin(), mimicked_.end(), driver) == mimicked_.end())
          mimicked_.push_back(driver);
      }
  }

  /// Moving joints directly above a link, mimic joints too; fixed joints are passed.
  std::vector<std::size_t> next(int link) const {
    std::vector<std::size_t> out;
    for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
      const Joint& joint = robot_.joints()[j];
      if (joint.parent != link) continue;
      if (joint.kind != JointKind::fixed) {
        out.push_back(j);
        continue;
      }
      const auto below = next(joint.child);
      out.insert(out.end(), below.begin(), below.end());
    }
    return out;
  }

  /// Returns whether a joint can be one of an arm: actuated, turning, with no joint that mimics it.
  bool is_arm_joint(std::size_t j) const {
    const Joint& joint = robot_.joints()[j];
    return !joint.is_mimic &&
           (joint.kind == JointKind::revolute || joint.kind == JointKind::continuous) &&
           std::find(mimicked_.begin(), mimicked_.end(), j) == mimicked_.end();
  }

  /// Returns the serial chain of arm joints that begins with joint j.
  std::vector<std::size_t> chain(std::size_t j) const {
    std::vector<std::size_t> out;
    while (is_arm_joint(j)) {
      out.push_back(j);
      const auto after = next(robot_.joints()[j].child);
      if (after.size() != 1) break;
      j = after.front();
    }
    return out;
  }

  /// Returns the chains of arm joints, each once, the longest first; of equal ones that of the
  /// right side first.
  std::vector<std::vector<std::size_t>> chains() const {
    std::vector<std::vector<std::size_t>> all;
    for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
      auto found = chain(j);
      const auto inside = [&](const auto& other) {
        return !found.empty() && !other.empty() && other.back() == found.back();
      };
      if (!found.empty() && std::none_of(all.begin(), all.end(), inside)) all.push_back(found);
    }
    const auto right = [&](const std::vector<std::size_t>& c) {
      const std::string& name = robot_.joints()[c.back()].name;
      return name.find("right") != std::string::npos || name.starts_with("r_");
    };
    std::stable_sort(all.begin(), all.end(), [&](const auto& a, const auto& b) {
      return a.size() != b.size() ? a.size() > b.size() : right(a) > right(b);
    });
    return all;
  }

 private:
  std::size_t axis_joint(int dof) const {
    return static_cast<std::size_t>(robot_.axes()[static_cast<std::size_t>(dof)].joint);
  }
  const RobotModel& robot_;
  std::vector<std::size_t> mimicked_;
};

/// Returns the link below the arm that carries the finger joints: of several the last common one.
int palm_below(const RobotModel& robot, int from, const std::vector<std::size_t>& fingers) {
  const auto ancestors = [&](int link) {
    std::vector<int> out{link};
    while (link != from) {
      link = robot
                 .joints()[static_cast<std::size_t>(
                     robot.links()[static_cast<std::size_t>(link)].parent_joint)]
                 .parent;
      out.push_back(link);
    }
    return out;
  };
  std::vector<int> common = ancestors(robot.joints()[fingers.front()].parent);
  for (const std::size_t f : fingers) {
    const auto other = ancestors(robot.joints()[f].parent);
    std::erase_if(common, [&](int link) {
      return std::find(other.begin(), other.end(), link) == other.end();
    });
  }
  return common.front();
}

/// Returns the link of a bare arm that carries a hand: a link of a usual name, else the last link
/// of the chain.
int flange_below(const RobotModel& robot, int from) {
  const auto below = descends_from(robot, from);
  for (const char* usual : {"tool0", "end_effector_link", "ee_link", "flange", "tool_frame", "tcp"})
    for (std::size_t l = 0; l < below.size(); ++l)
      if (below[l] && robot.links()[l].name.ends_with(usual)) return static_cast<int>(l);
  // A link without shapes and with nothing beyond, as panda_link8.
  for (std::size_t l = below.size(); l-- > 0;)
    if (below[l] && robot.links()[l].collision.empty() &&
        robot.links()[l].name.find("link") != std::string::npos)
      return static_cast<int>(l);
  return from;
}

std::vector<std::size_t> wished_chain(const RobotModel& robot, const JointTree& tree,
                                      const std::string& tool) {
  const int link = robot.link_index(tool);
  if (link < 0) {
    std::vector<std::string> names;
    for (const Link& l : robot.links()) names.push_back(l.name);
    const auto near = nearest_names(tool, names);
    throw ConfigError("--tool " + tool + ": the URDF has no such link" +
                      (near.empty() ? "" : "; it has " + joined(near)));
  }
  std::vector<std::size_t> chain;
  for (int at = link; robot.links()[static_cast<std::size_t>(at)].parent_joint >= 0;) {
    const auto j =
        static_cast<std::size_t>(robot.links()[static_cast<std::size_t>(at)].parent_joint);
    const Joint& joint = robot.joints()[j];
    if (tree.is_arm_joint(j))
      chain.insert(chain.begin(), j);
    else if (joint.kind != JointKind::fixed)
      break;
    at = joint.parent;
  }
  return chain;
}

void require_range(const RobotModel& robot, const std::vector<std::string>& names) {
  for (const Axis& axis : robot.axes())
    if (std::find(names.begin(), names.end(), axis.name) != names.end() && axis.lower >= axis.upper)
      throw ConfigError("joint " + axis.name +
                        " has no range: its lower and upper limit are the same; write the limits "
                        "into the URDF, or make the joint fixed");
}

}  // namespace

std::vector<bool> descends_from(const RobotModel& robot, int top) {
  std::vector<bool> below(robot.links().size());
  below[static_cast<std::size_t>(top)] = true;
  for (const Joint& joint : robot.joints())
    if (below[static_cast<std::size_t>(joint.parent)])
      below[static_cast<std::size_t>(joint.child)] = true;
  return below;
}

RobotParts find_parts(const RobotModel& robot, const PartWishes& wishes) {
  const JointTree tree(robot);
  const auto chains = tree.chains();
  std::vector<std::size_t> arm = chains.empty() ? std::vector<std::size_t>{} : chains.front();
  if (!wishes.tool.empty()) arm = wished_chain(robot, tree, wishes.tool);
  const auto max_axes = static_cast<std::size_t>(wishes.max_axes);
  if (arm.size() < static_cast<std::size_t>(wishes.min_axes))
    throw ConfigError("no arm was found: the longest chain of turning joints" +
                      (wishes.tool.empty() ? std::string() : " above link " + wishes.tool) +
                      " has " + std::to_string(arm.size()) + " axes, an arm has at least " +
                      std::to_string(wishes.min_axes));
  RobotParts parts;
  for (const auto& other : chains)
    if (other.back() != arm.back() && other.size() >= static_cast<std::size_t>(wishes.min_axes))
      parts.other_arms.push_back(robot.joints()[other.back()].name);
  if (arm.size() > max_axes) arm.erase(arm.begin(), arm.end() - static_cast<long>(max_axes));
  for (const std::size_t j : arm) parts.arm.push_back(robot.joints()[j].name);
  if (arm.size() == max_axes) parts.redundancy = robot.joints()[arm[2]].name;

  const int last = robot.joints()[arm.back()].child;
  const auto fingers = tree.next(wishes.tool.empty() ? last : robot.link_index(wishes.tool));
  parts.flange = !wishes.tool.empty() ? robot.link_index(wishes.tool)
                 : fingers.empty()    ? flange_below(robot, last)
                                      : palm_below(robot, last, fingers);
  const auto below = descends_from(robot, parts.flange);
  for (const Axis& axis : robot.axes()) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(axis.joint)];
    if (std::find(parts.arm.begin(), parts.arm.end(), axis.name) != parts.arm.end()) continue;
    (below[static_cast<std::size_t>(joint.child)] ? parts.hand : parts.held).push_back(axis.name);
  }
  require_range(robot, parts.arm);
  require_range(robot, parts.hand);
  return parts;
}

}  // namespace handsel
