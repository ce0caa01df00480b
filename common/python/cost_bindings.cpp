// SPDX-License-Identifier: Apache-2.0
// What handsel/cost.py calls.
#include "common/cost/human_cost.hpp"

#include "common/python/people_arguments.hpp"

namespace handsel::python {
namespace {

/// Returns settings from (safety radius, visibility cutoff, weights of safety, visibility,
/// comfort).
CostSettings settings_of(const py::tuple& value) {
  CostSettings out;
  out.safety_radius = number(value[0], "safety_radius");
  out.visibility_cutoff = number(value[1], "visibility_cutoff");
  out.w_safety = number(value[2], "safety");
  out.w_visibility = number(value[3], "visibility");
  out.w_comfort = number(value[4], "comfort");
  if (!(out.safety_radius > 0) || !(out.visibility_cutoff > 0))
    throw py::value_error("safety_radius and visibility_cutoff must be positive.");
  const bool negative = out.w_safety < 0 || out.w_visibility < 0 || out.w_comfort < 0;
  if (negative || !(out.w_safety + out.w_visibility + out.w_comfort > 0))
    throw py::value_error("the weights must be at least 0 and one of them above 0.");
  return out;
}

/// Returns safety, visibility, arm comfort and their weighted sum at points (n, 3), shape (n, 4).
py::array_t<double> at_points(const py::tuple& who, py::handle points, const py::tuple& weights) {
  const Person person = person_of(who);
  const CostSettings settings = settings_of(weights);
  const RowMatrix p = rows(points, "points", 3);
  RowMatrix out(p.rows(), 4);
  {
    const Unlocked released;
    for (Eigen::Index i = 0; i < p.rows(); ++i) {
      const CostParts parts = point_cost(person, p.row(i).transpose(), settings);
      out.row(i) << parts.safety, parts.visibility, parts.comfort, weighted_cost(parts, settings);
    }
  }
  return to_array(out);
}

/// Returns safety, visibility, arm comfort, their weighted sum and the distance to the simplified
/// body for configurations (n, axes), shape (n, 5).
py::array_t<double> of_robot(const RobotModel& robot, py::handle base, const py::list& people,
                             py::handle q, const py::tuple& weights) {
  const CostSettings settings = settings_of(weights);
  const HumanState state = people_of(people);
  const Pose T_world_base = pose_of(base, "base");
  const RowMatrix all = rows(q, "q", robot.dof());
  RowMatrix out(all.rows(), 5);
  {
    const Unlocked released;
    HumanCost cost(robot, settings);
    cost.set_base(T_world_base);
    cost.set_people(state);
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
      const CostParts parts = cost.parts(all.row(i).transpose());
      out.row(i) << parts.safety, parts.visibility, parts.comfort, weighted_cost(parts, settings),
          parts.distance;
    }
  }
  return to_array(out);
}

}  // namespace

void add_costs(py::module_& m) {
  m.def("point_costs", &at_points);
  m.def("robot_costs", &of_robot);
}

}  // namespace handsel::python
