// SPDX-License-Identifier: Apache-2.0
// handsel._trajectory: what handsel/trajectory.py calls. Failures that are no misuse (no trajectory
// exists) come back as a text.
#include "common/python/arguments.hpp"

#include <pybind11/stl.h>

#include "common/python/trajectory_batch.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "common/trajectory/path/smooth.hpp"
#include "common/trajectory/solve.hpp"
#include "common/trajectory/stop.hpp"
#include "common/trajectory/switch.hpp"
#include "common/trajectory/time_scaling.hpp"

namespace handsel::python {
namespace {

KinematicLimits limits(py::handle velocity, py::handle acceleration, py::handle jerk) {
  KinematicLimits out{vector(velocity, "velocity"), {}, {}};
  if (out.velocity.size() == 0) throw py::value_error("limits must have at least one axis.");
  out.acceleration = vector(acceleration, "acceleration", out.velocity.size());
  out.jerk = vector(jerk, "jerk", out.velocity.size());
  const std::string fault = why_bad_limits(out, static_cast<int>(out.velocity.size()));
  if (!fault.empty()) throw py::value_error(fault + ".");
  return out;
}

/// Returns a state; None for velocity or acceleration is 0.
MotionState3 state(py::handle position, py::handle velocity, py::handle acceleration) {
  MotionState3 out;
  out.position = vector(position, "position");
  const Eigen::Index axes = out.position.size();
  out.velocity =
      velocity.is_none() ? Eigen::VectorXd::Zero(axes) : vector(velocity, "velocity", axes);
  out.acceleration = acceleration.is_none() ? Eigen::VectorXd::Zero(axes)
                                            : vector(acceleration, "acceleration", axes);
  return out;
}

/// Returns the state that a Python object is: a State, or a position at rest.
MotionState3 state_of(py::handle value, const char* name, Eigen::Index axes) {
  if (py::isinstance<MotionState3>(value)) {
    const auto& out = value.cast<const MotionState3&>();
    require_size(out.position.size(), axes, name);
    return out;
  }
  return rest_state(vector(value, name, axes));
}

/// Returns the object of a type of this module that a Python object is.
template <class Type>
const Type& require(py::handle value, const char* name, const char* expected) {
  if (!py::isinstance<Type>(value))
    throw py::type_error(std::string(name) + " must be a " + expected + ", not " +
                         type_name(value) + ".");
  return value.cast<const Type&>();
}
const KinematicLimits& limits_argument(py::handle value) {
  return require<KinematicLimits>(value, "limits", "Limits");
}
const Trajectory& trajectory_argument(py::handle value) {
  return require<Trajectory>(value, "trajectory", "Trajectory");
}

py::object solve_states(py::handle start, py::handle end, py::handle limits, py::handle duration,
                        bool synchronize) {
  const KinematicLimits& bounds = limits_argument(limits);
  const Eigen::Index axes = bounds.velocity.size();
  std::optional<double> imposed;
  if (!duration.is_none()) imposed = number(duration, "duration");
  Solution out = solve(state_of(start, "start", axes), state_of(end, "end", axes), bounds,
                       synchronize ? Sync::time : Sync::none, imposed);
  if (!out.ok()) return py::str(out.reason);
  return py::cast(std::move(out.trajectory));
}

py::object smooth_waypoints(py::handle waypoints, py::handle limits, py::handle allowed_excess,
                            py::handle reach) {
  const KinematicLimits& bounds = limits_argument(limits);
  const RowMatrix points = rows(waypoints, "waypoints", bounds.velocity.size());
  if (points.rows() < 2) throw py::value_error("waypoints must have at least two rows.");
  std::vector<Eigen::VectorXd> nodes;
  for (Eigen::Index i = 0; i < points.rows(); ++i) nodes.push_back(points.row(i).transpose());
  SmoothSettings settings;
  settings.allowed_excess = number(allowed_excess, "allowed_excess");
  if (settings.allowed_excess < 0) throw py::value_error("allowed_excess must be at least 0.");
  if (!reach.is_none()) {
    settings.tau = number(reach, "reach");
    if (*settings.tau < 0) throw py::value_error("reach must be at least 0.");
  }
  SmoothResult out;
  {
    const Unlocked released;
    const KinematicLimits copy = bounds;
    out = smooth(nodes, copy, settings);
  }
  if (!out.ok()) return py::str(out.reason);
  py::list blends;
  for (const BlendReport& blend : out.corners)
    blends.append(
        py::make_tuple(blend.node, name(blend.method), blend.excess, blend.saved, blend.reason));
  return py::make_tuple(std::move(out.trajectory), out.duration_ptp, blends);
}

py::tuple samples(const Trajectory& trajectory, py::handle times) {
  const Eigen::VectorXd at = vector(times, "times");
  const py::ssize_t count = at.size(), axes = trajectory.size();
  py::array_t<double> position({count, axes}), velocity({count, axes}), acceleration({count, axes});
  double *x = position.mutable_data(), *v = velocity.mutable_data(),
         *a = acceleration.mutable_data();
  const SegmentTable table(trajectory);
  MotionState3 now = rest_state(Eigen::VectorXd::Zero(axes));
  int cursor = 0;
  for (py::ssize_t i = 0; i < count; ++i) {
    table.evaluate(at[i], cursor, now);
    std::copy_n(now.position.data(), axes, x + i * axes);
    std::copy_n(now.velocity.data(), axes, v + i * axes);
    std::copy_n(now.acceleration.data(), axes, a + i * axes);
  }
  return py::make_tuple(position, velocity, acceleration);
}

py::tuple axis_segments(const Trajectory& trajectory, py::handle axis) {
  const auto i =
      static_cast<std::size_t>(whole(axis, "axis", 0, std::max(0, trajectory.size() - 1)));
  const auto& segments = trajectory.axes[i].segments;
  py::array_t<double> durations(static_cast<py::ssize_t>(segments.size())),
      jerks(static_cast<py::ssize_t>(segments.size()));
  for (std::size_t k = 0; k < segments.size(); ++k) {
    durations.mutable_data()[k] = segments[k].duration;
    jerks.mutable_data()[k] = segments[k].jerk;
  }
  return py::make_tuple(durations, jerks);
}

py::object switch_trajectory(py::handle now, py::handle next, py::handle limits, bool on_clock) {
  const Trajectory& target = trajectory_argument(next);
  const KinematicLimits& bounds = limits_argument(limits);
  SwitchSettings settings;
  settings.on_clock = on_clock;
  Switched out = switch_to(state_of(now, "start", target.size()), target, bounds, settings);
  if (!out.ok()) return py::str(out.reason);
  return py::make_tuple(std::move(out.trajectory), out.joins_at, out.connecting);
}

py::array_t<double> extremes_of(const Trajectory& trajectory) {
  RowMatrix out(trajectory.size(), 5);
  for (int i = 0; i < trajectory.size(); ++i) {
    const AxisExtremes axis = extremes(trajectory.axes[static_cast<std::size_t>(i)]);
    out.row(i) << axis.lowest, axis.highest, axis.velocity, axis.acceleration, axis.jerk;
  }
  return to_array(out);
}

void bind_values(py::module_& m) {
  py::class_<KinematicLimits>(m, "Limits")
      .def(py::init(&limits))
      .def_property_readonly("velocity",
                             [](const KinematicLimits& l) { return to_array(l.velocity); })
      .def_property_readonly("acceleration",
                             [](const KinematicLimits& l) { return to_array(l.acceleration); })
      .def_property_readonly("jerk", [](const KinematicLimits& l) { return to_array(l.jerk); });
  py::class_<MotionState3>(m, "State")
      .def(py::init(&state))
      .def_property_readonly("position", [](const MotionState3& s) { return to_array(s.position); })
      .def_property_readonly("velocity", [](const MotionState3& s) { return to_array(s.velocity); })
      .def_property_readonly("acceleration",
                             [](const MotionState3& s) { return to_array(s.acceleration); });
}

void bind_trajectory(py::module_& m) {
  py::class_<Trajectory>(m, "Trajectory")
      .def("duration", &Trajectory::duration)
      .def("axes", &Trajectory::size)
      .def("samples", &samples)
      .def("segments", &axis_segments)
      .def("extremes", &extremes_of)
      .def("at", [](const Trajectory& t, py::handle time) { return t.at(number(time, "time")); })
      .def("cut",
           [](const Trajectory& t, py::handle from, py::handle to) {
             const double begin = number(from, "begin"), end = number(to, "end");
             if (end < begin) throw py::value_error("end must not be before begin.");
             return cut(t, begin, end);
           })
      .def("reversed", [](const Trajectory& t) { return reversed(t); })
      .def("stretched",
           [](const Trajectory& t, py::handle factor) {
             const double by = number(factor, "factor");
             if (!(by > 0)) throw py::value_error("factor must be positive.");
             return stretched(t, by);
           })
      .def("why_not_within", [](const Trajectory& t, py::handle limits, py::handle tolerance) {
        return why_not_within(t, limits_argument(limits), number(tolerance, "tolerance"));
      });
}

/// A running trajectory: the time scaling, with checks of what Python may give.
class Run {
 public:
  Run(py::handle trajectory, py::handle guard, py::handle step) {
    const double period = number(step, "step");
    if (!(period > 0)) throw py::value_error("step must be positive.");
    const std::string fault =
        scaling_.init(trajectory_argument(trajectory),
                      require<KinematicLimits>(guard, "guard", "Limits"), period);
    if (!fault.empty()) throw py::value_error(fault + ".");
  }
  void set_target(py::handle alpha) { scaling_.set_target(number(alpha, "target")); }
  void advance(py::handle dt) {
    const double by = number(dt, "dt");
    if (by < 0 || by > kMaxAdvance)
      throw py::value_error("dt must be in 0 .. " + std::to_string(static_cast<int>(kMaxAdvance)) +
                            " s.");
    scaling_.advance(by);
  }
  const TimeScaling& scaling() const { return scaling_; }

 private:
  static constexpr double kMaxAdvance = 3600;  // [s]
  TimeScaling scaling_;
};

void bind_run(py::module_& m) {
  py::class_<Run>(m, "Run")
      .def(py::init<py::handle, py::handle, py::handle>())
      .def("set_target", &Run::set_target)
      .def("advance", &Run::advance)
      .def("state", [](const Run& r) { return r.scaling().state(); })
      .def("alpha", [](const Run& r) { return r.scaling().alpha(); })
      .def("time", [](const Run& r) { return r.scaling().time(); })
      .def("finished", [](const Run& r) { return r.scaling().finished(); });
}

}  // namespace

PYBIND11_MODULE(_trajectory, m) {
  bind_values(m);
  bind_trajectory(m);
  bind_run(m);
  m.def("solve", &solve_states);
  m.def("smooth", &smooth_waypoints);
  m.def("switch_to", &switch_trajectory);
  m.def("stop", [](py::handle start, py::handle limits) {
    const KinematicLimits& bounds = limits_argument(limits);
    return stop_trajectory(state_of(start, "start", bounds.velocity.size()), bounds);
  });
  m.def("solve_batch", &solve_batch);
  m.def("outcome_text", &outcome_text);
}

}  // namespace handsel::python
