// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/config/resources.hpp"
#include "common/model/description/robot_model_builder.hpp"
#include "common/model/description/robot_text.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

std::string quoted(const std::string& name) { return "\"" + name + "\""; }

std::string where(const fs::path& file, const std::string& name) {
  return locate(file, quoted(name)) + ": ";
}

constexpr double kGuardMargin = 1.1, kSlack = 1 + 1e-9;

void require_below(const Vector& small, const Vector& large, const std::vector<Axis>& axes,
                   const std::string& what, const fs::path& file) {
  for (Eigen::Index i = 0; i < small.size(); ++i)
    if (small[i] > large[i] * kSlack)
      throw ConfigError(where(file, axes[i].name) + "axis " + axes[i].name + ": " + what);
}

}  // namespace

int RobotModelBuilder::joint_index(const std::string& name) const {
  for (std::size_t i = 0; i < model_.joints_.size(); ++i)
    if (model_.joints_[i].name == name) return static_cast<int>(i);
  return -1;
}

int RobotModelBuilder::axis_of(const std::string& joint) const {
  for (std::size_t i = 0; i < model_.axes_.size(); ++i)
    if (model_.axes_[i].name == joint) return static_cast<int>(i);
  return -1;
}

int RobotModelBuilder::require_link(const std::string& name, const std::string& field,
                                    const fs::path& source) const {
  const int index = model_.link_index(name);
  if (index < 0)
    throw ConfigError(where(source, name) + field + " is " + quoted(name) +
                      ", which is no link of " + urdf_.string());
  return index;
}

std::vector<std::string> RobotModelBuilder::actuated() const {
  std::vector<std::string> names;
  for (int j : document_order_)
    if (model_.joints_[j].kind != JointKind::fixed && !model_.joints_[j].is_mimic)
      names.push_back(model_.joints_[j].name);
  return names;
}

void RobotModelBuilder::set_axes(const std::vector<std::string>& names,
                                 const std::map<std::string, double>& held,
                                 const fs::path& source) {
  for (const auto& name : names) {
    const int j = joint_index(name);
    if (j < 0)
      throw ConfigError(where(source, name) + "no joint " + quoted(name) + " in " + urdf_.string());
    const Joint& joint = model_.joints_[j];
    if (joint.kind == JointKind::fixed || joint.is_mimic)
      throw ConfigError(where(source, name) + "joint " + quoted(name) +
                        " cannot be an axis: it is " +
                        (joint.is_mimic ? "a mimic joint" : "fixed"));
    if (axis_of(name) >= 0)
      throw ConfigError(where(source, name) + "joint " + quoted(name) + " is named twice");
    if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper))
      throw ConfigError(where(urdf_, name) + "joint " + quoted(name) + " needs finite limits");
    model_.axes_.push_back({name, j, joint.lower, joint.upper, joint.max_effort});
  }
  if (model_.axes_.empty()) throw ConfigError(source.string() + ": the robot has no axis");
  for (auto& joint : model_.joints_) {
    if (joint.kind == JointKind::fixed) continue;
    const Joint& driver = model_.joints_[joint.dof];
    const int axis = axis_of(driver.name);
    joint.dof = axis;
    if (axis >= 0) continue;
    const auto value = held.find(driver.name);
    joint.mimic_offset += joint.mimic_factor * (value != held.end() ? value->second : 0.0);
    joint.mimic_factor = 0;
  }
  model_.rest_ = Vector::Zero(model_.dof());
  for (int i = 0; i < model_.dof(); ++i)
    model_.rest_[i] = std::clamp(0.0, model_.axes_[i].lower, model_.axes_[i].upper);
  const std::size_t n = model_.links_.size();
  model_.disabled_pairs_.assign(n * n, false);
}

void RobotModelBuilder::add_group(const std::string& name, const std::vector<std::string>& joints,
                                  const std::string& tip, const fs::path& source) {
  if (model_.group(name) != nullptr)
    throw ConfigError(where(source, name) + "group " + quoted(name) + " is defined twice");
  Group group{name, {}, tip.empty() ? -1 : require_link(tip, "tip_link", source)};
  for (const auto& joint : joints) group.axes.push_back(axis_of(joint));
  model_.groups_.push_back(group);
}

void RobotModelBuilder::disable(int a, int b) {
  const std::size_t n = model_.links_.size();
  model_.disabled_pairs_[static_cast<std::size_t>(a) * n + static_cast<std::size_t>(b)] = true;
  model_.disabled_pairs_[static_cast<std::size_t>(b) * n + static_cast<std::size_t>(a)] = true;
}

KinematicLimits RobotModelBuilder::limits(
    const google::protobuf::RepeatedPtrField<config::AxisLimits>& entries, const std::string& field,
    const fs::path& source) const {
  const int n = model_.dof();
  KinematicLimits out{Vector::Zero(n), Vector::Zero(n), Vector::Zero(n)};
  for (const auto& entry : entries) {
    for (const auto& name : entry.joints()) {
      const int i = axis_of(name);
      if (i < 0)
        throw ConfigError(where(source, name) + field + " names " + quoted(name) +
                          ", which is no axis of a group");
      if (out.velocity[i] > 0)
        throw ConfigError(where(source, name) + field + " names " + quoted(name) + " twice");
      const auto positive = [&](double value, const char* key) {
        if (!(value > 0) || !std::isfinite(value))
          throw ConfigError(where(source, name) + field + "." + key + " of " + quoted(name) +
                            " must be > 0");
        return value;
      };
      out.velocity[i] = positive(entry.velocity(), "velocity");
      out.acceleration[i] = positive(entry.acceleration(), "acceleration");
      out.jerk[i] = positive(entry.jerk(), "jerk");
    }
  }
  for (int i = 0; i < n; ++i)
    if (out.velocity[i] == 0)
      throw ConfigError(source.string() + ": " + field + " has no entry for " +
                        quoted(model_.axes_[i].name));
  return out;
}

void RobotModelBuilder::apply(const config::RobotDescription& description, const fs::path& file) {
  if (description.name().empty()) throw ConfigError(file.string() + ": name is missing");
  if (description.groups().empty())
    throw ConfigError(file.string() +
                      ": groups is missing; the groups in order give the robot's axes");
  const std::map<std::string, double> rest(description.rest().begin(), description.rest().end());
  for (const auto& [joint, value] : rest) {
    const int j = joint_index(joint);
    if (j < 0)
      throw ConfigError(where(file, joint) + "rest names " + quoted(joint) +
                        ", which is no joint of " + urdf_.string());
    if (!(value >= model_.joints_[j].lower && value <= model_.joints_[j].upper))
      throw ConfigError(where(file, joint) + "rest of " + quoted(joint) +
                        " is outside the joint's limits");
  }
  model_.name_ = description.name();
  std::vector<std::string> axes;
  for (const auto& group : description.groups()) {
    if (group.name().empty() || group.joints().empty())
      throw ConfigError(file.string() + ": a group needs a name and joints");
    axes.insert(axes.end(), group.joints().begin(), group.joints().end());
  }
  set_axes(axes, rest, file);
  for (const auto& group : description.groups())
    add_group(group.name(), {group.joints().begin(), group.joints().end()}, group.tip_link(), file);
  for (int i = 0; i < model_.dof(); ++i)
    if (const auto value = rest.find(model_.axes_[i].name); value != rest.end())
      model_.rest_[i] = value->second;
  if (!description.srdf().empty()) read_srdf(described_path(file, description.srdf()), false, true);

  model_.hand_ = described_name(file, description.hand());
  if (!description.tool_link().empty())
    model_.tool_ = require_link(description.tool_link(), "tool_link", file);
  if (!description.gaze_link().empty())
    model_.gaze_ = require_link(description.gaze_link(), "gaze_link", file);
  if (!description.redundancy_joint().empty()) {
    model_.redundancy_ = axis_of(description.redundancy_joint());
    if (model_.redundancy_ < 0)
      throw ConfigError(where(file, description.redundancy_joint()) + "redundancy_joint is " +
                        quoted(description.redundancy_joint()) + ", which is no axis");
  }
  model_.comfort_ = limits(description.comfort(), "comfort", file);
  model_.guard_ = limits(description.guard(), "guard", file);
  model_.stop_ = limits(description.stop(), "stop", file);
  const auto check = [&](const KinematicLimits& a, double factor, const std::string& what) {
    require_below(factor * a.velocity, model_.guard_.velocity, model_.axes_, what + " (velocity)",
                  file);
    require_below(factor * a.acceleration, model_.guard_.acceleration, model_.axes_,
                  what + " (acceleration)", file);
    require_below(factor * a.jerk, model_.guard_.jerk, model_.axes_, what + " (jerk)", file);
  };
  check(model_.comfort_, kGuardMargin, "comfort must be at most guard / 1.1");
  check(model_.stop_, 1.0, "stop must be at most guard");
}

void RobotModelBuilder::default_limits() {
  const int n = model_.dof();
  Vector v(n);
  for (int i = 0; i < n; ++i) {
    const double given = model_.joints_[model_.axes_[i].joint].max_velocity;
    v[i] = given > 0 ? given : 1.0;
  }
  model_.guard_ = model_.stop_ = {v, 2 * v, 6 * v};
  const double k = 1 / kGuardMargin;
  model_.comfort_ = {k * v, 2 * k * v, 6 * k * v};
}

void RobotModelBuilder::require_masses() const {
  std::vector<double> carried(model_.links_.size(), 0.0);
  for (std::size_t l = model_.links_.size(); l-- > 0;) {
    carried[l] += model_.links_[l].mass;
    const int j = model_.links_[l].parent_joint;
    if (j < 0) continue;
    const Joint& joint = model_.joints_[j];
    if (joint.kind == JointKind::fixed) {
      carried[joint.parent] += carried[l];
    } else if (!(carried[l] > 0)) {
      const std::string& name = model_.links_[l].name;
      throw ConfigError(where(urdf_, name) + "link " + quoted(name) + " is moved by joint " +
                        quoted(joint.name) + " and needs a mass > 0");
    }
  }
}

RobotModel RobotModelBuilder::finish() {
  const auto& links = model_.links_;
  std::vector<int> body(links.size());
  for (std::size_t l = 0; l < links.size(); ++l) {
    const int j = links[l].parent_joint;
    const bool rigid = j >= 0 && model_.joints_[j].dof < 0;
    body[l] = rigid ? body[model_.joints_[j].parent] : static_cast<int>(l);
  }
  for (std::size_t a = 0; a < links.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b)
      if (body[a] == body[b]) disable(static_cast<int>(a), static_cast<int>(b));
    int up = static_cast<int>(a);
    do {
      up = links[up].parent_joint >= 0 ? model_.joints_[links[up].parent_joint].parent : -1;
    } while (up >= 0 && links[up].collision.empty());
    if (up >= 0) disable(static_cast<int>(a), up);
  }
  return std::move(model_);
}

RobotModel RobotModel::load_urdf(const fs::path& urdf, const fs::path& srdf, Meshes meshes) {
  RobotModelBuilder builder(urdf, meshes);
  const auto axes = builder.actuated();
  builder.set_axes(axes, {}, urdf);
  builder.add_group("all", axes, "", urdf);
  if (!srdf.empty()) builder.read_srdf(srdf, true, false);
  builder.default_limits();
  return builder.finish();
}

RobotModel RobotModel::load(const fs::path& description) {
  const config::RobotDescription text = read_robot_text(description);
  if (text.urdf().empty()) throw ConfigError(description.string() + ": urdf is missing");
  RobotModelBuilder builder = described_urdf(description, text, text.without());
  if (text.has_mount()) {
    if (text.hand().empty())
      throw ConfigError(where(description, "mount") + "mount is given but no hand");
    config::HandDescription hand;
    const fs::path file = hand_description(described_name(description, text.hand()));
    load_text_proto(file, hand);
    builder.mount(described_urdf(file, hand, {}), text.mount(), description);
  }
  builder.apply(text, description);
  builder.require_masses();
  RobotModel robot = builder.finish();
  if (!text.platform().drives()) return robot;
  return with_platform_axes(robot, text.platform(), description);
}

}  // namespace handsel
