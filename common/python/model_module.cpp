// SPDX-License-Identifier: Apache-2.0
// handsel._model: what handsel/model.py, collision.py and cost.py call. One native module holds the
// three, since a process may hold the Protobuf types of the models once.
#include "common/config/search_path.hpp"
#include "common/model/robot_model.hpp"
#include "common/python/people_arguments.hpp"

#include <pybind11/stl.h>

namespace handsel::python {
namespace {

RobotModel load(py::handle name_or_path) {
  const std::string name = text(name_or_path, "name");
  const Unlocked released;
  return RobotModel::load(find_file(FileKind::robot, name));
}

RobotModel load_urdf(py::handle urdf, py::handle srdf, bool meshes) {
  const std::string file = text(urdf, "urdf");
  const std::string groups = srdf.is_none() ? std::string() : text(srdf, "srdf");
  const Unlocked released;
  return RobotModel::load_urdf(file, groups, meshes ? Meshes::load : Meshes::skip);
}

/// Returns the index of a link by its name, or of the tool link for None. Throws ValueError.
int link_of(const RobotModel& robot, py::handle link) {
  if (link.is_none()) {
    if (robot.tool_link() < 0)
      throw py::value_error(robot.name() + " has no tool link; name a link.");
    return robot.tool_link();
  }
  const std::string name = text(link, "link");
  const int index = robot.link_index(name);
  if (index < 0) throw py::value_error(robot.name() + " has no link \"" + name + "\".");
  return index;
}

const Group& group_of(const RobotModel& robot, py::handle group) {
  const std::string name = text(group, "group");
  const Group* found = robot.group(name);
  if (found == nullptr) {
    std::string names;
    for (const Group& other : robot.groups()) names += (names.empty() ? "" : ", ") + other.name;
    throw py::value_error(robot.name() + " has no group \"" + name + "\"; it has: " + names + ".");
  }
  if (found->tip < 0)
    throw py::value_error("group " + name + " of " + robot.name() + " has no tip link.");
  return *found;
}

void write_pose(const Pose& pose, double* out) {
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> to(out);
  to = pose.matrix();
}

/// Returns T_root_link for one configuration, shape (4, 4), or for n of them, shape (n, 4, 4).
py::array_t<double> link_poses(const RobotModel& robot, py::handle q, py::handle link) {
  const int index = link_of(robot, link);
  const auto array = number_array(q, "q");
  const RowMatrix values = array.ndim() == 1
                               ? RowMatrix(vector(array, "q", robot.dof()).transpose())
                               : rows(array, "q", robot.dof());
  std::vector<py::ssize_t> shape{4, 4};
  if (array.ndim() != 1) shape.insert(shape.begin(), values.rows());
  py::array_t<double> out(shape);
  double* at = out.mutable_data();
  std::vector<Pose> poses;
  Vector one(robot.dof());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    one = values.row(i).transpose();
    robot.forward(one, poses);
    write_pose(poses[static_cast<std::size_t>(index)], at + 16 * i);
  }
  return out;
}

py::dict all_poses(const RobotModel& robot, py::handle q) {
  std::vector<Pose> poses;
  robot.forward(vector(q, "q", robot.dof()), poses);
  py::dict out;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    py::array_t<double> pose({4, 4});
    write_pose(poses[i], pose.mutable_data());
    out[py::str(robot.links()[i].name)] = pose;
  }
  return out;
}

py::object inverse(const RobotModel& robot, py::handle pose, py::handle group, py::handle seed) {
  const Group& axes = group_of(robot, group);
  const Pose T_root_tip = pose_of(pose);
  const Vector start =
      seed.is_none() ? robot.rest_configuration() : vector(seed, "seed", robot.dof());
  std::optional<Vector> found;
  {
    const Unlocked released;
    found = robot.inverse(axes, T_root_tip, start);
  }
  if (!found) return py::none();
  return to_array(RobotModel::with(start, axes, *found));
}

py::tuple limits(const KinematicLimits& values) {
  return py::make_tuple(to_array(values.velocity), to_array(values.acceleration),
                        to_array(values.jerk));
}

template <class Named>
py::list names_of(const std::vector<Named>& items) {
  py::list out;
  for (const Named& item : items) out.append(item.name);
  return out;
}

py::tuple position_limits(const RobotModel& robot) {
  Vector lower(robot.dof()), upper(robot.dof());
  for (int i = 0; i < robot.dof(); ++i) {
    lower[i] = robot.axes()[static_cast<std::size_t>(i)].lower;
    upper[i] = robot.axes()[static_cast<std::size_t>(i)].upper;
  }
  return py::make_tuple(to_array(lower), to_array(upper));
}

}  // namespace

PYBIND11_MODULE(_model, m) {
  py::register_local_exception<ConfigError>(m, "DescriptionError", PyExc_ValueError);
  py::register_local_exception<MissingError>(m, "MissingError", PyExc_FileNotFoundError);
  m.def("load", &load);
  m.def("load_urdf", &load_urdf);
  py::class_<RobotModel>(m, "Robot")
      .def("name", &RobotModel::name)
      .def("dof", &RobotModel::dof)
      .def("axes", [](const RobotModel& r) { return names_of(r.axes()); })
      .def("links", [](const RobotModel& r) { return names_of(r.links()); })
      .def("groups",
           [](const RobotModel& r) {
             py::dict out;
             for (const Group& group : r.groups()) out[py::str(group.name)] = group.axes;
             return out;
           })
      .def("rest", [](const RobotModel& r) { return to_array(r.rest_configuration()); })
      .def("position_limits", &position_limits)
      .def("comfort_limits", [](const RobotModel& r) { return limits(r.comfort_limits()); })
      .def("guard_limits", [](const RobotModel& r) { return limits(r.guard_limits()); })
      .def("link_poses", &link_poses)
      .def("all_poses", &all_poses)
      .def("jacobian",
           [](const RobotModel& r, py::handle q, py::handle group) {
             return to_array(RowMatrix(r.jacobian(vector(q, "q", r.dof()), group_of(r, group))));
           })
      .def("inverse", &inverse);
  add_people(m);
  add_collision(m);
  add_costs(m);
}

}  // namespace handsel::python
