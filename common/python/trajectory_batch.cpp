// SPDX-License-Identifier: Apache-2.0
#include "common/python/trajectory_batch.hpp"

#include <array>
#include <limits>

#include "common/python/arguments.hpp"
#include "common/trajectory/solve.hpp"

namespace handsel::python {
namespace {

constexpr std::size_t kColumns = 9;  // six of states, three of limits, as in AxisBatchInput
constexpr std::array<const char*, kColumns> kNames{"start",
                                                   "end",
                                                   "start_velocity",
                                                   "end_velocity",
                                                   "start_acceleration",
                                                   "end_acceleration",
                                                   "velocity",
                                                   "acceleration",
                                                   "jerk"};
// Problems solved at a time: their data stay in the cache of a processor.
constexpr py::ssize_t kChunk = 256;

/// One input: a row for each problem, one row for all, or zeros.
struct Column {
  RowMatrix values;
  bool given{};
  bool shared() const { return values.rows() == 1; }
};

Column column(py::handle value, const char* name) {
  if (value.is_none()) return {};
  const auto array = number_array(value, name);
  if (array.ndim() != 1 && array.ndim() != 2)
    throw py::value_error(std::string(name) + " must have one or two dimensions, not " +
                          std::to_string(array.ndim()) + ".");
  require_finite(array.data(), array.size(), name);
  const py::ssize_t row_count = array.ndim() == 2 ? array.shape(0) : 1;
  const py::ssize_t axes = array.shape(array.ndim() - 1);
  return {Eigen::Map<const RowMatrix>(array.data(), row_count, axes), true};
}

/// Number of problems and axes that all inputs agree on. Throws ValueError.
std::pair<py::ssize_t, py::ssize_t> common_shape(const std::array<Column, kColumns>& columns) {
  const py::ssize_t axes = columns[6].values.cols();
  py::ssize_t problems = 1;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const Column& c = columns[i];
    if (!c.given) continue;
    if (c.values.cols() != axes || axes == 0)
      throw py::value_error(std::string(kNames[i]) + " must have " + std::to_string(axes) +
                            " axes as the limits have, at least 1, not " +
                            std::to_string(c.values.cols()) + ".");
    if (c.shared()) continue;
    if (problems != 1 && c.values.rows() != problems)
      throw py::value_error(std::string(kNames[i]) + " must have 1 or " + std::to_string(problems) +
                            " rows, not " + std::to_string(c.values.rows()) + ".");
    problems = c.values.rows();
  }
  return {problems, axes};
}

struct Results {
  double* durations;
  std::int32_t* outcomes;
  std::int32_t* axes;
};

void solve_all(const std::array<Column, kColumns>& columns, py::ssize_t problems, py::ssize_t axes,
               const Results& out) {
  const py::ssize_t room = std::min(problems, kChunk);
  SynchronisedBatch batch(static_cast<int>(axes), static_cast<int>(room));
  std::array<RowMatrix, kColumns> chunk;
  for (std::size_t i = 0; i < kColumns; ++i) {
    chunk[i] = RowMatrix::Zero(room, axes);
    if (columns[i].given && columns[i].shared()) chunk[i].rowwise() = columns[i].values.row(0);
  }
  for (py::ssize_t first = 0; first < problems; first += room) {
    const py::ssize_t count = std::min(room, problems - first);
    std::array<const double*, kColumns> at{};
    for (std::size_t i = 0; i < kColumns; ++i) {
      const bool own_rows = columns[i].given && !columns[i].shared();
      at[i] = own_rows ? columns[i].values.data() + first * axes : chunk[i].data();
    }
    batch.solve({at[0], at[2], at[4], at[1], at[3], at[5], at[6], at[7], at[8]},
                static_cast<int>(count));
    for (py::ssize_t p = 0; p < count; ++p) {
      const AxisOutcome outcome = batch.outcome(static_cast<int>(p));
      out.durations[first + p] = outcome == AxisOutcome::ok
                                     ? batch.duration(static_cast<int>(p))
                                     : std::numeric_limits<double>::quiet_NaN();
      out.outcomes[first + p] = static_cast<std::int32_t>(outcome);
      out.axes[first + p] = outcome == AxisOutcome::ok ? -1 : batch.axis(static_cast<int>(p));
    }
  }
}

}  // namespace

py::tuple solve_batch(const py::tuple& states, const py::tuple& limits) {
  std::array<Column, kColumns> columns;
  for (std::size_t i = 0; i < 6; ++i) columns[i] = column(states[i], kNames[i]);
  for (std::size_t i = 0; i < 3; ++i) columns[6 + i] = column(limits[i], kNames[6 + i]);
  const auto [problems, axes] = common_shape(columns);
  constexpr py::ssize_t kMaxAxes = 4096;  // a chunk of as many numbers as an int holds
  if (axes > kMaxAxes)
    throw py::value_error("the batch takes at most " + std::to_string(kMaxAxes) + " axes.");
  py::array_t<double> durations(problems);
  py::array_t<std::int32_t> outcomes(problems), failed(problems);
  const Results out{durations.mutable_data(), outcomes.mutable_data(), failed.mutable_data()};
  {
    const Unlocked released;
    solve_all(columns, problems, axes, out);
  }
  return py::make_tuple(durations, outcomes, failed);
}

py::str outcome_text(int outcome) {
  const auto last = static_cast<int>(AxisOutcome::blocked);
  return py::str(outcome < 0 || outcome > last ? "" : reason(static_cast<AxisOutcome>(outcome)));
}

}  // namespace handsel::python
