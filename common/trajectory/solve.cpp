#include "common/trajectory/solve.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/min_time.hpp"
#include "common/trajectory/three_segment.hpp"

namespace handsel {

namespace {

std::string size_mismatch(const MotionState3& s, const char* which, Eigen::Index n) {
  if (s.position.size() == n && s.velocity.size() == n && s.acceleration.size() == n) return {};
  return std::string("the ") + which + " state has " + std::to_string(s.position.size()) + " positions, " +
         std::to_string(s.velocity.size()) + " velocities and " + std::to_string(s.acceleration.size()) + " accelerations, wanted " +
         std::to_string(n) + " of each";
}

std::string axis_reason(Eigen::Index axis, const std::string& what) { return "axis " + std::to_string(axis) + ": " + what; }

}  // namespace

bool SynchronisedAxes::read(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits) noexcept {
  for (std::size_t k = 0; k < problems_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const AxisState a{from.position[i], from.velocity[i], from.acceleration[i]}, b{to.position[i], to.velocity[i], to.acceleration[i]};
    outcome_ = problems_[k].init(a, b, limits_of(limits, i));
    axis_ = static_cast<int>(k);
    if (outcome_ != AxisOutcome::ok) return false;
  }
  return true;
}

double SynchronisedAxes::least_common() const noexcept {
  double common = 0;
  for (const AxisProblem& p : problems_) common = std::max(common, p.minimum());
  for (bool grown = true; grown;) {
    grown = false;
    for (const AxisProblem& p : problems_) {
      const double next = p.earliest(common);
      if (next > common) common = next, grown = true;
    }
  }
  return common;
}

bool SynchronisedAxes::solve(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits) noexcept {
  if (!read(from, to, limits)) return false;
  duration_ = least_common();
  for (std::size_t k = 0; k < problems_.size(); ++k) {
    axis_ = static_cast<int>(k);
    outcome_ = problems_[k].profile(duration_, profiles_[k]);
    if (outcome_ != AxisOutcome::ok) return false;
  }
  return true;
}

Solution solve(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits, Sync sync, std::optional<double> imposed) {
  Solution out;
  const Eigen::Index n = from.position.size();
  if ((out.reason = size_mismatch(from, "start", n)); !out.ok()) return out;
  if ((out.reason = size_mismatch(to, "end", n)); !out.ok()) return out;
  if (limits.velocity.size() != n || limits.acceleration.size() != n || limits.jerk.size() != n) {
    out.reason = "limits do not have " + std::to_string(n) + " axes";
    return out;
  }
  if (imposed && (!std::isfinite(*imposed) || *imposed < 0)) {
    out.reason = "the imposed duration must be finite and not negative";
    return out;
  }
  SynchronisedAxes axes(static_cast<int>(n));
  if (!axes.read(from, to, limits)) {
    out.reason = axis_reason(axes.axis(), reason(axes.outcome()));
    return out;
  }
  double common = 0;
  for (int i = 0; i < n; ++i) {
    out.min_durations.push_back(axes.minimum(i));
    common = std::max(common, axes.minimum(i));
  }
  if (imposed) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (*imposed < out.min_durations[i] * (1 - 1e-12)) {
        out.reason = axis_reason(i, "needs " + std::to_string(out.min_durations[i]) + " s, imposed are " + std::to_string(*imposed) + " s");
        return out;
      }
    }
    common = *imposed;
  } else if (sync == Sync::time) {
    common = axes.least_common();
  }
  out.trajectory.axes.resize(n);
  for (int i = 0; i < n; ++i) {
    AxisProfile profile;
    const AxisState start{from.position[i], from.velocity[i], from.acceleration[i]};
    const bool own = sync == Sync::none && !imposed;
    if (own) {
      axes.problem(i).minimum_profile(profile);
      if (axes.minimum(i) < common) {
        if (to.velocity[i] != 0 || to.acceleration[i] != 0) {
          out.reason = axis_reason(i, "ends early and moving, so it cannot wait for the others");
          out.trajectory.axes.clear();
          return out;
        }
        profile.push(common - axes.minimum(i), 0);
      }
    } else if (axes.problem(i).profile(common, profile) != AxisOutcome::ok) {
      const auto three = three_segment(start, {to.position[i], to.velocity[i], to.acceleration[i]}, common);
      out.excess = std::max(out.excess, excess(start, three.data(), 3, limits_of(limits, i)));
      profile.clear();
      for (const Segment& s : three) profile.push(s.duration, s.jerk);
    }
    out.trajectory.axes[i] = {start, {profile.segments.begin(), profile.segments.begin() + profile.count}};
  }
  return out;
}

}  // namespace handsel
