// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/drawn_urdf.hpp"

#include <cmath>
#include <sstream>

#include "common/model/robot_capsules.hpp"

namespace handsel::bridge {
namespace {

/// Returns the rotations about fixed axes x, y, z, as in URDF.
Vector3 roll_pitch_yaw(const Eigen::Matrix3d& R) {
  const double across = std::hypot(R(0, 0), R(1, 0)), pitch = std::atan2(-R(2, 0), across);
  if (across < 1e-9) return {std::atan2(-R(1, 2), R(1, 1)), pitch, 0};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

class Writer {
 public:
  explicit Writer(const RobotModel& robot) : robot_(robot), capsules_(robot_capsules(robot)) {
    out_.precision(9);
  }

  std::string write() {
    out_ << "<?xml version=\"1.0\"?>\n<robot name=\"" << robot_.name() << "\">\n";
    for (std::size_t l = 0; l < robot_.links().size(); ++l) link(l);
    for (const Joint& j : robot_.joints()) joint(j);
    out_ << "</robot>\n";
    return out_.str();
  }

 private:
  void origin(const Pose& T) {
    const Vector3 p = T.translation(), r = roll_pitch_yaw(T.linear());
    out_ << "<origin xyz=\"" << p.x() << ' ' << p.y() << ' ' << p.z() << "\" rpy=\"" << r.x() << ' '
         << r.y() << ' ' << r.z() << "\"/>";
  }
  void visual(const Pose& T, const std::string& geometry) {
    out_ << "<visual>";
    origin(T);
    out_ << "<geometry>" << geometry << "</geometry></visual>";
  }
  static std::string sphere(double radius) {
    return "<sphere radius=\"" + std::to_string(radius) + "\"/>";
  }
  static std::string cylinder(double radius, double length) {
    return "<cylinder radius=\"" + std::to_string(radius) + "\" length=\"" +
           std::to_string(length) + "\"/>";
  }
  void capsule(const Vector3& a, const Vector3& b, double radius) {
    visual(make_pose(a), sphere(radius));
    if ((b - a).norm() < 1e-6) return;
    visual(make_pose(b), sphere(radius));
    visual(make_pose((a + b) / 2, Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), b - a)),
           cylinder(radius, (b - a).norm()));
  }

  void link(std::size_t index) {
    const Link& link = robot_.links()[index];
    out_ << "  <link name=\"" << link.name << "\">";
    bool has_mesh = false;
    for (const PlacedShape& s : link.collision)
      has_mesh = has_mesh || std::holds_alternative<MeshPtr>(s.shape);
    for (const LinkCapsule& c : capsules_)
      if (has_mesh && c.link == static_cast<int>(index)) capsule(c.a, c.b, c.radius);
    for (const PlacedShape& s : link.collision) {
      if (has_mesh) break;
      const Pose& T = s.T_parent_shape;
      if (const auto* x = std::get_if<Sphere>(&s.shape)) visual(T, sphere(x->radius));
      if (const auto* x = std::get_if<Cylinder>(&s.shape))
        visual(T, cylinder(x->radius, x->length));
      if (const auto* x = std::get_if<Capsule>(&s.shape))
        capsule(T * Vector3(0, 0, -x->length / 2), T * Vector3(0, 0, x->length / 2), x->radius);
      if (const auto* x = std::get_if<Box>(&s.shape))
        visual(T, "<box size=\"" + std::to_string(x->size.x()) + ' ' + std::to_string(x->size.y()) +
                      ' ' + std::to_string(x->size.z()) + "\"/>");
    }
    out_ << "</link>\n";
  }

  void joint(const Joint& j) {
    const bool moves = j.kind != JointKind::fixed && j.dof >= 0;
    out_ << "  <joint name=\"" << j.name << "\" type=\""
         << (!moves                           ? "fixed"
             : j.kind == JointKind::prismatic ? "prismatic"
                                              : "revolute")
         << "\"><parent link=\"" << robot_.links()[static_cast<std::size_t>(j.parent)].name
         << "\"/><child link=\"" << robot_.links()[static_cast<std::size_t>(j.child)].name
         << "\"/>";
    Pose T = j.T_parent_joint;
    if (!moves && j.kind == JointKind::prismatic)
      T.translate(Vector3(j.mimic_offset * j.axis));  // the joint is fixed there
    if (!moves && j.kind != JointKind::prismatic && j.kind != JointKind::fixed)
      T.rotate(Eigen::AngleAxisd(j.mimic_offset, j.axis));
    origin(T);
    if (moves) {
      out_ << "<axis xyz=\"" << j.axis.x() << ' ' << j.axis.y() << ' ' << j.axis.z()
           << "\"/><limit lower=\"" << j.lower << "\" upper=\"" << j.upper << "\" velocity=\""
           << j.max_velocity << "\" effort=\"" << j.max_effort << "\"/>";
      if (j.is_mimic)
        out_ << "<mimic joint=\"" << robot_.axes()[static_cast<std::size_t>(j.dof)].name
             << "\" multiplier=\"" << j.mimic_factor << "\" offset=\"" << j.mimic_offset << "\"/>";
    }
    out_ << "</joint>\n";
  }

  const RobotModel& robot_;
  std::vector<LinkCapsule> capsules_;
  std::ostringstream out_;
};

}  // namespace

std::string drawn_urdf(const RobotModel& robot) { return Writer(robot).write(); }

}  // namespace handsel::bridge
