// SPDX-License-Identifier: Apache-2.0
// Computes the joints at every period, and their approximation.
#include <algorithm>
#include <cmath>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/segment_table.hpp"
#include "components/trajectory_planner/cartesian/cartesian_planning.hpp"

namespace handsel::trajectory_planner {
namespace {

// Max approximations, each with 1/10 of the tolerance, until the result is within the position
// limits.
constexpr int kMaxTries = 3;
constexpr double kRounding = 1e-7;  // rounding error of positions [rad]

}  // namespace

bool CartesianPlanning::followed() {
  motion_.samples.clear();
  times_.clear();
  const CartesianTrajectory& path = motion_.path;
  const double duration = path.duration();
  if (path.nodes_.size() < 2) {
    motion_.samples = {request_.start(motion_.axes)};
    times_ = {0.0};
    return true;
  }
  const int steps = std::max(4, static_cast<int>(std::ceil(duration / settings_.period - 1e-9)));
  ik::Axes q = RobotModel::part(request_.start, group_);
  if (joined_) joined_->restart();
  const SegmentTable table(path.active_);
  MotionState3 state = path.active_.at(0);
  int cursor = 0;
  std::vector<Vector> configurations;
  const auto ahead = [&](double t) {
    const std::size_t node = path.node_at(t);
    return given_[std::min(path.nodes_.size() - 1,
                           path.middles_.empty() || node == 0 ? 1 : ahead_of(t, node))];
  };
  std::string why;
  for (int k = 0; k <= steps && why.empty(); ++k) {
    const double t = k == steps ? duration : std::min(duration, k * settings_.period);
    table.evaluate(t, cursor, state);
    const Pose T = path.pose_at(state.position, path.node_at(t));
    const Vector also = state.position.tail(state.position.size() - kElbow);
    times_.push_back(t);
    if (!held_upright(request_.level, T)) {
      why = "on the path to " + node_name(ahead(t)) + " what is held leans over too far";
    } else if (!arm_->advance(T, state.position[kTool], also, settings_.largest_step, q)) {
      why = why_stopped(ahead(t), T, state.position[kTool], also, q);
    } else if (std::string arm; joined_ && !joined_->follow(T, settings_.largest_step, arm)) {
      why = "on the path to " + node_name(ahead(t)) + " " + arm;
    } else {
      Vector sample(static_cast<Eigen::Index>(motion_.axes.size()));
      if (joined_)
        sample << q, also, joined_->joints();
      else
        sample << q, also;
      motion_.samples.push_back(std::move(sample));
      configurations.push_back(whole(q, also));
    }
  }
  std::size_t last = times_.size() - 1;
  if (const std::size_t touching = first_touching(world_, configurations, settings_.collision_step);
      touching < configurations.size()) {
    last = touching;
    const CollisionVerdict verdict = world_.check(configurations[touching]);
    why = "on the path to " + node_name(ahead(times_[last])) + " " + verdict.first + " touches " +
          verdict.second;
  }
  if (why.empty()) return true;
  end_before(ahead(times_[last]), why);
  return false;
}

std::size_t CartesianPlanning::ahead_of(double t, std::size_t node) const {
  const Vector &at = motion_.path.nodes_[node].active,
               &before = motion_.path.nodes_[node - 1].active;
  return (motion_.path.active_.at(t).position - at).dot(at - before) < 0 ? node : node + 1;
}

std::string CartesianPlanning::why_stopped(std::size_t given, const Pose& T, double elbow,
                                           const Vector& also, const ik::Axes& q) const {
  const std::string place = "on the path to " + node_name(given);
  const auto next = arm_->srs().nearest(arm_->for_arm(T, also), elbow, q);
  if (!next)
    return place + (arm_->srs().branches(arm_->for_arm(T, also), elbow).empty()
                        ? " the arm does not reach"
                        : " a joint meets its limit");
  Eigen::Index joint = 0;
  (*next - q).cwiseAbs().maxCoeff(&joint);
  return place + " joint " +
         robot_.axes()[static_cast<std::size_t>(group_.axes[static_cast<std::size_t>(joint)])]
             .name +
         " would jump: shoulder, elbow or wrist is stretched there";
}

void CartesianPlanning::approximated() {
  const KinematicLimits& all = robot_.comfort_limits();
  const KinematicLimits limits{request_.speed_scale * all.velocity(motion_.axes),
                               all.acceleration(motion_.axes), all.jerk(motion_.axes)};
  if (motion_.samples.size() < 2) return;
  Derived derived = differentiate(times_, motion_.samples);
  for (MotionState3* end : {&derived.samples.front(), &derived.samples.back()}) {
    end->velocity.setZero();
    end->acceleration.setZero();
  }
  derived.samples.front().position = motion_.samples.front();
  derived.samples.back().position = motion_.samples.back();
  ApproximationTolerance tolerance = settings_.tolerance;
  for (int tries = 0; tries < kMaxTries; ++tries, tolerance.position *= 0.1) {
    motion_.executable = approximate_within(times_, derived.samples, tolerance, limits);
    if (!motion_.executable.approximation.ok() ||
        inside_limits(motion_.executable.approximation.trajectory))
      break;
  }
  if (!motion_.executable.approximation.ok()) refuse(motion_.executable.approximation.reason);
  if (joined_ && motion_.executable.approximation.ok()) measure_join();
}

void CartesianPlanning::measure_join() {
  const Trajectory& run = motion_.executable.approximation.trajectory;
  const int samples =
      std::max(1, static_cast<int>(std::ceil(run.duration() / (4 * settings_.period))));
  for (int k = 0; k <= samples; ++k) {
    const Vector q = run.at(run.duration() * k / samples).position;
    const JoinError e = joined_->error(
        arm_->chain().forward(q.head(static_cast<Eigen::Index>(group_.axes.size())), nullptr),
        q.tail(static_cast<Eigen::Index>(joined_->axes().size())));
    motion_.joined = {std::max(motion_.joined.apart, e.apart),
                      std::max(motion_.joined.turned, e.turned)};
  }
  if (motion_.joined.apart > settings_.max_apart.apart ||
      motion_.joined.turned > settings_.max_apart.turned)
    refuse(formatted("the hands would come %.2f mm and %.2f degrees apart on the path",
                     1e3 * motion_.joined.apart, motion_.joined.turned * 180 / M_PI));
}

bool CartesianPlanning::inside_limits(const Trajectory& trajectory) const {
  for (std::size_t i = 0; i < motion_.axes.size(); ++i) {
    const Axis& axis = robot_.axes()[static_cast<std::size_t>(motion_.axes[i])];
    const AxisExtremes e = extremes(trajectory.axes[i]);
    if (e.lowest < axis.lower - kRounding || e.highest > axis.upper + kRounding) return false;
  }
  return true;
}

}  // namespace handsel::trajectory_planner
