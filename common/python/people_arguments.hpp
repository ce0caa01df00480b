// SPDX-License-Identifier: Apache-2.0
// People and poses from Python, for the bindings of models, collision and costs.
#pragma once

#include "common/model/human/human_body.hpp"
#include "common/python/arguments.hpp"

namespace handsel::python {

/// Returns a rigid transform from a 4 x 4 matrix. Throws ValueError when it is none.
Pose pose_of(py::handle value, const char* name = "pose");

/// Returns a person from (id, joints of shape (18, 3) in the order of kBodyJoints, stature, gaze or
/// None).
Person person_of(const py::tuple& value);
/// Returns the people of a list of such tuples.
HumanState people_of(const py::list& values);

/// Adds the functions about people to a module.
void add_people(py::module_& m);
/// Adds the class World to a module; after the class Robot.
void add_collision(py::module_& m);
/// Adds costs to a module; after the class Robot.
void add_costs(py::module_& m);

}  // namespace handsel::python
