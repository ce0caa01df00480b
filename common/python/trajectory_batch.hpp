// SPDX-License-Identifier: Apache-2.0
// Many problems between two states in one call from Python.
#pragma once

#include <pybind11/pybind11.h>

namespace handsel::python {

/// Solves n problems, all axes of each ending together. `states`: start and end position, start and
/// end velocity, start and end acceleration; each an array n x axes, or of one row that all
/// problems share, or None for 0. `limits`: velocity, acceleration and jerk, each n x axes or one
/// row, all > 0. Returns (durations [s], NaN where there is no solution; outcomes as numbers of
/// AxisOutcome, 0 solved; the axis that failed). Runs without the interpreter lock.
pybind11::tuple solve_batch(const pybind11::tuple& states, const pybind11::tuple& limits);

/// Returns what an outcome of solve_batch means, empty for 0.
pybind11::str outcome_text(int outcome);

}  // namespace handsel::python
