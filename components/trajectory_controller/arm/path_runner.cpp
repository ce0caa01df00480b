// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/arm/path_runner.hpp"

#include <cmath>
#include <limits>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "components/trajectory_controller/output/setpoint_check.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kSlack = 1e-6;  // tolerance of rounding beyond a bound [rad]

double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

/// Returns whether a trajectory begins close to the state `from`: then all of it is run, except for
/// a short transition from that state.
bool begins_alike(const MotionState3& from, const MotionState3& first,
                  const KinematicLimits& limits, const PathRunnerSettings& settings) {
  const double ratio = settings.alike_ratio;
  return apart(from.position, first.position) <= settings.alike_distance &&
         ((from.velocity - first.velocity).cwiseAbs().array() <= ratio * limits.velocity.array())
             .all() &&
         ((from.acceleration - first.acceleration).cwiseAbs().array() <=
          ratio * limits.acceleration.array())
             .all();
}

}  // namespace

std::string PathRunner::start(const Trajectory& trajectory, const PathLimits& limits) {
  if (std::string why = scaling_.init(trajectory, limits.motion, settings_.period); !why.empty())
    return why;
  limits_ = limits;
  path_ = trajectory;
  stale_ = false;
  cursor_ = 0;
  finished_ = scaling_.finished();
  state_ = scaling_.state();
  return {};
}

const Trajectory& PathRunner::path() const {
  if (stale_) path_ = to_trajectory(scaling_.path());
  stale_ = false;
  return path_;
}

bool PathRunner::rejoin(const MotionState3& state) noexcept {
  if (finished_) return false;
  SwitchSettings settings;
  settings.first = std::max(0.0, scaling_.time());
  settings.last = settings.first + settings_.rejoin_time;
  settings.tries = settings_.rejoin_tries;
  if (scaling_.start_from(state, scaling_.path(), settings) != SwitchOutcome::ok) return false;
  shift_ = this->offset();
  state_ = state;
  stale_ = true;
  cursor_ = 0;
  return true;
}

std::string PathRunner::why_out_of_bounds() const {
  const SegmentTable& path = scaling_.path();
  MotionState3 at = rest_state(Eigen::VectorXd::Zero(axes()));
  const double joins = offset() + scaling_.joined_at();
  for (int k = path.find(scaling_.switched_at(), 0); k < path.segments() && path.knot(k) < joins;
       ++k) {
    int cursor = k;
    path.evaluate(path.knot(k), cursor, at);
    for (Eigen::Index i = 0; i < axes(); ++i) {
      if (!(limits_.lower[i] < limits_.upper[i])) continue;
      const Segment piece{path.knot(k + 1) - path.knot(k), path.jerks(cursor)[i]};
      const AxisExtremes reached =
          extremes({at.position[i], at.velocity[i], at.acceleration[i]}, &piece, 1);
      if (reached.lowest >= limits_.lower[i] - kSlack &&
          reached.highest <= limits_.upper[i] + kSlack)
        continue;
      return "the motion that leads over to it would take axis " + std::to_string(i) + " to [" +
             std::to_string(reached.lowest) + ", " + std::to_string(reached.highest) +
             "] rad, outside its bounds";
    }
  }
  return {};
}

template <class Switch>
std::string PathRunner::switch_to(const MotionState3& from, const Trajectory& next, double reach,
                                  bool from_rest, Switch&& go) {
  if (std::string why = why_not_runnable(next, limits_.motion); !why.empty()) return why;
  SwitchSettings settings;
  MotionState3 there = next.at(0.0);
  if (begins_alike(from, there, limits_.motion, settings_)) {
    settings.last = from_rest || same_motion(from, there)
                        ? 0.0
                        : std::min(settings_.join_time, next.duration());
  } else {
    constexpr int kSamples = 200;
    double nearest = std::numeric_limits<double>::infinity();
    settings.first = -1.0;
    for (int k = 0; k <= (from_rest ? 0 : kSamples); ++k) {
      const double t = next.duration() * k / kSamples;
      next.sample(t, there);
      const double off = apart(there.position, from.position);
      nearest = std::min(nearest, off);
      if (off > reach && settings.first >= 0) break;
      if (off > reach) continue;
      if (settings.first < 0) settings.first = t;
      settings.last = t;
    }
    if (settings.first < 0)
      return "it comes no nearer than " + std::to_string(nearest) +
             " rad to the switch point of the running motion";
  }
  if (const SwitchOutcome outcome = go(SegmentTable(next), settings); outcome != SwitchOutcome::ok)
    return reason(outcome);
  if (std::string why = why_out_of_bounds(); !why.empty()) {
    scaling_.undo_switch();
    return why;
  }
  stale_ = true;
  cursor_ = 0;
  finished_ = scaling_.finished();
  return {};
}

std::string PathRunner::switch_at(double leave, const Trajectory& next, double reach) {
  if (next.size() != axes()) return reason(SwitchOutcome::wrong_size);
  MotionState3 from = scaling_.state();
  scaling_.path().evaluate(std::max(leave, scaling_.time()), cursor_, from);
  if (!(leave > scaling_.time())) {
    if (scaling_.standing()) from.velocity.setZero();
    if (scaling_.standing()) from.acceleration.setZero();
    if (scaling_.alpha() < 0) from.velocity = -from.velocity;
  }
  return switch_to(from, next, reach, leave >= scaling_.duration(),
                   [&](const SegmentTable& table, const SwitchSettings& settings) {
                     return scaling_.switch_at(leave, table, settings);
                   });
}

std::string PathRunner::start_from(const MotionState3& state, const Trajectory& next,
                                   double reach) {
  if (next.size() != axes()) return reason(SwitchOutcome::wrong_size);
  if (std::string why = switch_to(state, next, reach, false,
                                  [&](const SegmentTable& table, const SwitchSettings& settings) {
                                    return scaling_.start_from(state, table, settings);
                                  });
      !why.empty())
    return why;
  state_ = state;
  return {};
}

bool PathRunner::step(double wanted) noexcept {
  if (finished_) return true;
  scaling_.set_target(scaling_.time() <= 0.0 ? std::max(0.0, wanted) : wanted);
  scaling_.advance(settings_.period);
  const MotionState3& next = scaling_.state();
  for (Eigen::Index i = 0; i < next.position.size(); ++i)
    if (!acceptable(state_, next, i, limits_.motion, settings_.period)) return false;
  state_ = next;
  finished_ = scaling_.finished();
  return true;
}

}  // namespace handsel::trajectory_controller
