// SPDX-License-Identifier: Apache-2.0
#include "common/python/people_arguments.hpp"

#include <algorithm>

namespace handsel::python {
namespace {

RowMatrix positions(const std::vector<BodyJoint>& joints) {
  RowMatrix out(static_cast<Eigen::Index>(joints.size()), 3);
  for (std::size_t i = 0; i < joints.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)) = joints[i].position.transpose();
  return out;
}

/// Returns the complete body of a few joints, given as names and positions of shape (n, 3).
py::array_t<double> fitted(const py::list& names, py::handle points, py::handle stature) {
  const RowMatrix p = rows(points, "joints", 3);
  ObservedPerson seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = text(names[i], "a name of joints");
    if (body_joint_index(name) < 0)
      throw py::value_error("joints has \"" + name + "\", which is no joint of a body.");
    seen.joints.push_back({name, p.row(static_cast<Eigen::Index>(i)).transpose(), 1.0});
  }
  return to_array(positions(fit_body(seen, nullptr, number(stature, "stature"))));
}

py::array_t<double> body(py::handle feet, py::handle yaw, py::handle stature, bool seated) {
  const Vector3 at = vector(feet, "position", 3);
  const double turn = number(yaw, "yaw"), height = number(stature, "stature");
  return to_array(
      positions(seated ? sitting_body(at, turn, height) : standing_body(at, turn, height)));
}

}  // namespace

Pose pose_of(py::handle value, const char* name) {
  const RowMatrix m = rows(value, name, 4);
  require_size(m.rows(), 4, name);
  constexpr double kTolerance = 1e-6;
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  const bool rigid =
      (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kTolerance &&
      R.determinant() > 0 &&
      (m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < kTolerance;
  if (!rigid)
    throw py::value_error(std::string(name) +
                          " must be a rigid transform with the last row 0 0 0 1.");
  return make_pose(m.topRightCorner<3, 1>(), Eigen::Quaterniond(R));
}

Person person_of(const py::tuple& value) {
  Person person;
  person.id = text(value[0], "name");
  const RowMatrix joints = rows(value[1], "joints", 3);
  require_size(joints.rows(), static_cast<py::ssize_t>(kBodyJoints.size()), "joints");
  for (std::size_t i = 0; i < kBodyJoints.size(); ++i) {
    BodyJoint joint;
    joint.name = kBodyJoints[i];
    joint.position = joints.row(static_cast<Eigen::Index>(i)).transpose();
    person.joints.push_back(joint);
  }
  person.stature = number(value[2], "stature");
  if (!value[3].is_none()) {
    const Vector3 gaze = vector(value[3], "gaze", 3);
    if (!(gaze.norm() > 1e-9)) throw py::value_error("gaze must not be zero.");
    person.gaze_known = true;
    person.gaze_direction = gaze.normalized();
    person.gaze_origin = person.joints[static_cast<std::size_t>(body_joint_index("head"))].position;
  }
  return person;
}

HumanState people_of(const py::list& values) {
  HumanState state;
  for (py::handle value : values)
    state.people.push_back(person_of(py::reinterpret_borrow<py::tuple>(value)));
  return state;
}

void add_people(py::module_& m) {
  py::list names;
  for (const char* name : kBodyJoints) names.append(name);
  m.attr("joint_names") = py::tuple(names);
  m.def("fit_body", &fitted);
  m.def("body", &body);
}

}  // namespace handsel::python
