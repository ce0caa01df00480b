// SPDX-License-Identifier: Apache-2.0
// handsel._grasp: what handsel/grasp.py calls.
#include "common/grasp/force_closure.hpp"
#include "common/grasp/grip_force.hpp"
#include "common/python/arguments.hpp"

namespace handsel::python {
namespace {

constexpr long long kMaxEdges = 256;

/// Returns one number a contact: of a scalar the same for all.
Eigen::VectorXd per_contact(py::handle value, const char* name, Eigen::Index contacts) {
  if (PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr()))
    return Eigen::VectorXd::Constant(contacts, number(value, name));
  return vector(value, name, contacts);
}

std::vector<PointContact> contacts(py::handle positions, py::handle normals, py::handle friction,
                                   py::handle torsion) {
  const RowMatrix p = rows(positions, "positions", 3), n = rows(normals, "normals", 3);
  if (p.rows() != n.rows())
    throw py::value_error("normals must have " + std::to_string(p.rows()) +
                          " rows as positions, not " + std::to_string(n.rows()) + ".");
  const Eigen::VectorXd mu = per_contact(friction, "friction", p.rows()),
                        turn = per_contact(torsion, "torsion", p.rows());
  std::vector<PointContact> out;
  for (Eigen::Index i = 0; i < p.rows(); ++i) {
    const double length = n.row(i).norm();
    if (!(length > 1e-9))
      throw py::value_error("normals must not be zero; row " + std::to_string(i) + " is.");
    if (mu[i] < 0 || turn[i] < 0)
      throw py::value_error("friction and torsion must be at least 0; those of contact " +
                            std::to_string(i) + " are not.");
    out.push_back({p.row(i).transpose(), n.row(i).transpose() / length, mu[i], turn[i]});
  }
  return out;
}

/// `cone`: edges, centre, torque scale.
RowMatrix wrenches(py::handle positions, py::handle normals, py::handle friction,
                   py::handle torsion, const py::tuple& cone) {
  const auto at = contacts(positions, normals, friction, torsion);
  const int edges = static_cast<int>(whole(cone[0], "edges", 3, kMaxEdges));
  const double torque_scale = number(cone[2], "torque_scale");
  if (!(torque_scale > 0)) throw py::value_error("torque_scale must be positive.");
  return contact_wrenches(at, edges, vector(cone[1], "centre", 3), torque_scale);
}

bool closed(py::handle value) {
  const RowMatrix w = rows(value, "wrenches");
  if (w.rows() == 0 || w.cols() == 0) return false;
  const Unlocked released;
  return force_closure(w);
}

py::tuple grip(py::handle positions, py::handle normals, py::handle friction, py::handle torsion,
               const py::tuple& load) {
  const auto at = contacts(positions, normals, friction, torsion);
  GripForceSettings settings;
  const Vector3 com = vector(load[0], "centre_of_mass", 3);
  const double mass = number(load[1], "mass");
  settings.max_normal = number(load[2], "max_normal");
  settings.friction_fraction = number(load[3], "friction_fraction");
  settings.acceleration = number(load[4], "acceleration");
  if (!(mass >= 0) || !(settings.max_normal > 0) || !(settings.acceleration >= 0))
    throw py::value_error(
        "mass and acceleration must be at least 0 and max_normal must be positive.");
  if (!(settings.friction_fraction > 0 && settings.friction_fraction <= 1))
    throw py::value_error("friction_fraction must be in (0, 1].");
  GripForces out;
  {
    const Unlocked released;
    out = grip_forces(at, com, mass, settings);
  }
  RowMatrix forces(static_cast<Eigen::Index>(out.forces.size()), 3);
  for (std::size_t i = 0; i < out.forces.size(); ++i)
    forces.row(static_cast<Eigen::Index>(i)) = out.forces[i].transpose();
  return py::make_tuple(to_array(forces), out.margin);
}

}  // namespace

PYBIND11_MODULE(_grasp, m) {
  m.def("contact_wrenches",
        [](py::handle p, py::handle n, py::handle mu, py::handle torsion, const py::tuple& cone) {
          return to_array(wrenches(p, n, mu, torsion, cone));
        });
  m.def("force_closure", &closed);
  m.def("grip_forces", &grip);
}

}  // namespace handsel::python
