// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/path/approximate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "common/trajectory/edit.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/min_time.hpp"
#include "common/trajectory/three_segment.hpp"

namespace handsel {

namespace {

std::string why_bad(const std::vector<double>& times, const std::vector<MotionState3>& samples) {
  if (samples.size() < 2 || times.size() != samples.size())
    return "there must be two samples or more, and as many times";
  const Eigen::Index n = samples[0].position.size();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const MotionState3& s = samples[k];
    if (s.position.size() != n || s.velocity.size() != n || s.acceleration.size() != n) {
      return "sample " + std::to_string(k) + " does not have " + std::to_string(n) + " axes";
    }
    if (!s.position.allFinite() || !s.velocity.allFinite() || !s.acceleration.allFinite() ||
        !std::isfinite(times[k])) {
      return "sample " + std::to_string(k) + " has a number that is not finite";
    }
    if (k > 0 && !(times[k] > times[k - 1]))
      return "the times must grow, sample " + std::to_string(k) + " does not";
  }
  return {};
}

class Fit {
 public:
  Fit(const std::vector<double>& times, const std::vector<MotionState3>& samples,
      const ApproximationTolerance& tolerance)
      : times_(times), samples_(samples), tolerance_(tolerance) {}

  /// Returns the sample indices at which pieces meet.
  std::vector<std::size_t> pieces() const {
    std::vector<std::size_t> ends{0};
    split(0, samples_.size() - 1, ends);
    std::vector<std::size_t> joined{0};
    for (std::size_t k = 1; k < ends.size();) {
      while (k + 1 < ends.size() && good(joined.back(), ends[k + 1])) ++k;
      joined.push_back(ends[k++]);
    }
    return joined;
  }
  void emit(std::size_t first, std::size_t last, Approximation& out) const {
    const double T = times_[last] - times_[first];
    for (Eigen::Index i = 0; i < samples_[0].position.size(); ++i) {
      const auto fitted = three_segment(state(first, i), state(last, i), T);
      auto& segments = out.trajectory.axes[i].segments;
      segments.insert(segments.end(), fitted.begin(), fitted.end());
    }
    const auto [x, v] = errors(first, last);
    out.position_error = std::max(out.position_error, x);
    out.velocity_error = std::max(out.velocity_error, v);
    ++out.pieces;
  }

 private:
  void split(std::size_t first, std::size_t last, std::vector<std::size_t>& ends) const {
    if (good(first, last)) {
      ends.push_back(last);
      return;
    }
    const std::size_t middle = (first + last) / 2;
    split(first, middle, ends);
    split(middle, last, ends);
  }
  /// Checks a few samples first: most pieces that do not fit deviate by far.
  bool good(std::size_t first, std::size_t last) const {
    if (last - first < 2) return true;
    return fits(first, last, std::max<std::size_t>(1, (last - first) / 8)) && fits(first, last, 1);
  }
  bool fits(std::size_t first, std::size_t last, std::size_t stride) const {
    for (Eigen::Index i = 0; i < samples_[0].position.size(); ++i) {
      const AxisState begin = state(first, i);
      const auto fitted = three_segment(begin, state(last, i), times_[last] - times_[first]);
      for (std::size_t k = first + stride; k < last; k += stride) {
        const AxisState s = at(begin, fitted, times_[k] - times_[first]), wanted = state(k, i);
        if (!(std::abs(s.position - wanted.position) <= tolerance_.position)) return false;
        if (!(std::abs(s.velocity - wanted.velocity) <= tolerance_.velocity)) return false;
      }
    }
    return true;
  }
  std::pair<double, double> errors(std::size_t first, std::size_t last) const {
    double x = 0, v = 0;
    for (Eigen::Index i = 0; i < samples_[0].position.size(); ++i) {
      const AxisState begin = state(first, i);
      const auto fitted = three_segment(begin, state(last, i), times_[last] - times_[first]);
      for (std::size_t k = first + 1; k < last; ++k) {
        const AxisState s = at(begin, fitted, times_[k] - times_[first]), wanted = state(k, i);
        x = std::max(x, std::abs(s.position - wanted.position));
        v = std::max(v, std::abs(s.velocity - wanted.velocity));
      }
    }
    return {x, v};
  }
  AxisState state(std::size_t k, Eigen::Index i) const {
    return {samples_[k].position[i], samples_[k].velocity[i], samples_[k].acceleration[i]};
  }
  static AxisState at(AxisState s, const std::array<Segment, 3>& segments, double t) {
    for (const Segment& g : segments) {
      const double step = std::min(t, g.duration);
      s = advanced(s, step, g.jerk);
      t -= step;
      if (!(t > 0)) break;
    }
    return s;
  }
  const std::vector<double>& times_;
  const std::vector<MotionState3>& samples_;
  const ApproximationTolerance& tolerance_;
};

/// Returns the min of the values within `reach` [s] on either side.
std::vector<double> min_around(const std::vector<double>& times, const std::vector<double>& values,
                               double reach) {
  std::vector<double> out(values.size());
  std::size_t first = 0, last = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    while (times[k] - times[first] > reach) ++first;
    while (last + 1 < values.size() && times[last + 1] - times[k] <= reach) ++last;
    out[k] = *std::min_element(values.begin() + static_cast<std::ptrdiff_t>(first),
                               values.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  }
  return out;
}

/// Returns the mean of the values within `reach` [s] on either side, with weights that fall to
/// zero.
std::vector<double> mean_around(const std::vector<double>& times, const std::vector<double>& values,
                                double reach) {
  std::vector<double> out(values.size());
  std::size_t first = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    while (times[k] - times[first] > reach) ++first;
    double sum = 0, weights = 0;
    for (std::size_t i = first; i < values.size() && times[i] - times[k] <= reach; ++i) {
      const double u = (times[i] - times[k]) / reach, w = (1 - u * u) * (1 - u * u) + 1e-9;
      sum += w * values[i];
      weights += w;
    }
    out[k] = sum / weights;
  }
  return out;
}

/// Runs through the samples with time increment alpha.
void run_through(const std::vector<double>& times, const std::vector<MotionState3>& samples,
                 SlowedDown& out) {
  const std::size_t n = samples.size();
  out.times.assign(n, times[0]);
  out.samples = samples;
  for (std::size_t k = 0; k < n; ++k) {
    if (k > 0)
      out.times[k] =
          out.times[k - 1] + (times[k] - times[k - 1]) * 2 / (out.alpha[k] + out.alpha[k - 1]);
    const std::size_t before = k > 0 ? k - 1 : k, after = k + 1 < n ? k + 1 : k;
    const double slope = (out.alpha[after] - out.alpha[before]) / (times[after] - times[before]),
                 a = out.alpha[k];
    out.samples[k].velocity = a * samples[k].velocity;
    out.samples[k].acceleration = a * a * samples[k].acceleration + a * slope * samples[k].velocity;
  }
}

}  // namespace

Approximation approximate(const std::vector<double>& times,
                          const std::vector<MotionState3>& samples,
                          const ApproximationTolerance& tolerance) {
  Approximation out;
  if (!(tolerance.position > 0 && tolerance.velocity > 0))
    out.reason = "the tolerances must be positive";
  if (out.ok()) out.reason = why_bad(times, samples);
  if (!out.ok()) return out;
  const Eigen::Index n = samples[0].position.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    out.trajectory.axes.push_back(
        {{samples[0].position[i], samples[0].velocity[i], samples[0].acceleration[i]}, {}});
  }
  const Fit fit(times, samples, tolerance);
  const std::vector<std::size_t> ends = fit.pieces();
  for (std::size_t k = 1; k < ends.size(); ++k) fit.emit(ends[k - 1], ends[k], out);
  const double sampled = 3.0 * static_cast<double>(samples.size()), kept = 3.0 + 6.0 * out.pieces;
  out.compression = sampled / kept;
  return out;
}

Derived differentiate(const std::vector<double>& times,
                      const std::vector<Eigen::VectorXd>& positions, int reach) {
  Derived out;
  const int count = static_cast<int>(positions.size());
  if (count < 4 || times.size() != positions.size()) {
    out.reason = "there must be four samples or more, and as many times";
    return out;
  }
  for (const Eigen::VectorXd& x : positions) {
    if (x.size() != positions[0].size()) {
      out.reason = "the samples do not have the same number of axes";
      return out;
    }
    out.samples.push_back({x, Eigen::VectorXd::Zero(x.size()), Eigen::VectorXd::Zero(x.size())});
  }
  if (out.reason = why_bad(times, out.samples); !out.ok()) {
    out.samples.clear();
    return out;
  }
  reach = std::max(2, reach);
  const Eigen::Index axes = positions[0].size();
  for (int k = 0; k < count; ++k) {
    const int first = std::clamp(k - reach, 0, std::max(0, count - 2 * reach - 1)),
              last = std::min(count - 1, first + 2 * reach);
    const double scale = times[last] - times[first];
    Eigen::MatrixX4d powers(last - first + 1, 4);
    Eigen::MatrixXd values(last - first + 1, axes);
    for (int i = first; i <= last; ++i) {
      const double u = (times[i] - times[k]) / scale;
      powers.row(i - first) << 1, u, u * u, u * u * u;
      values.row(i - first) = positions[i].transpose();
    }
    const Eigen::Matrix4d square = powers.transpose() * powers;
    const Eigen::MatrixXd c = square.ldlt().solve(powers.transpose() * values);
    out.samples[k].position = c.row(0).transpose();
    out.samples[k].velocity = c.row(1).transpose() / scale;
    out.samples[k].acceleration = 2 * c.row(2).transpose() / (scale * scale);
  }
  return out;
}

namespace {
/// Slows the samples down. `bound` of alpha at each sample is lowered where needed.
SlowedDown slow_down_from(const std::vector<double>& times,
                          const std::vector<MotionState3>& samples, const KinematicLimits& limits,
                          std::vector<double>& bound) {
  SlowedDown out;
  const std::size_t n = samples.size();
  const double reach = std::min(0.2, (times.back() - times.front()) / 4);
  for (int round = 0; round < 200; ++round) {
    const bool slowed = std::any_of(bound.begin(), bound.end(), [](double b) { return b < 1; });
    out.alpha = slowed ? mean_around(times, min_around(times, bound, reach), reach)
                       : std::vector<double>(n, 1.0);
    run_through(times, samples, out);
    bool kept = true;
    for (std::size_t k = 0; k < n; ++k) {
      double excess = 1;
      for (Eigen::Index i = 0; i < samples[k].position.size(); ++i) {
        excess = std::max(excess, std::abs(out.samples[k].velocity[i]) / limits.velocity[i]);
        const double a = std::abs(out.samples[k].acceleration[i]) / limits.acceleration[i];
        if (a > 1) excess = std::max(excess, std::sqrt(a));
        if (k + 1 == n) continue;
        const double jerk = (out.samples[k + 1].acceleration[i] - out.samples[k].acceleration[i]) /
                            (out.times[k + 1] - out.times[k]);
        if (std::abs(jerk) > limits.jerk[i])
          excess = std::max(excess, std::cbrt(std::abs(jerk) / limits.jerk[i]));
      }
      if (excess <= 1) continue;
      kept = false;
      bound[k] = std::min(bound[k], 0.995 * out.alpha[k] / excess);
    }
    if (kept) return out;
  }
  const double slowest = *std::min_element(bound.begin(), bound.end());
  out.alpha.assign(n, slowest);
  run_through(times, samples, out);
  return out;
}
}  // namespace

namespace {

std::string why_not_slowed(const std::vector<double>& times,
                           const std::vector<MotionState3>& samples,
                           const KinematicLimits& limits) {
  const std::string bad = why_bad(times, samples);
  return bad.empty() ? why_bad_limits(limits, static_cast<int>(samples[0].position.size())) : bad;
}

}  // namespace

SlowedDown slow_down(const std::vector<double>& times, const std::vector<MotionState3>& samples,
                     const KinematicLimits& limits) {
  SlowedDown out;
  out.reason = why_not_slowed(times, samples, limits);
  if (!out.ok()) return out;
  std::vector<double> bound(samples.size(), 1.0);
  return slow_down_from(times, samples, limits, bound);
}

Executable approximate_within(const std::vector<double>& times,
                              const std::vector<MotionState3>& samples,
                              const ApproximationTolerance& tolerance,
                              const KinematicLimits& limits) {
  Executable out;
  out.approximation.reason = why_not_slowed(times, samples, limits);
  if (!out.approximation.ok()) return out;
  std::vector<double> bound(samples.size(), 1.0);
  for (int round = 0; round < 12; ++round) {
    const SlowedDown slowed = slow_down_from(times, samples, limits, bound);
    out.slowest = *std::min_element(slowed.alpha.begin(), slowed.alpha.end());
    out.approximation = approximate(slowed.times, slowed.samples, tolerance);
    out.times = slowed.times;
    if (!out.approximation.ok()) return out;
    out.stretch = 1;
    for (const AxisTrajectory& axis : out.approximation.trajectory.axes) {
      const auto i = &axis - out.approximation.trajectory.axes.data();
      AxisState s = axis.start;
      double t = times[0];
      for (std::size_t k = 0; k < axis.segments.size(); ++k) {
        const Segment& g = axis.segments[k];
        const AxisExtremes e = rate_extremes(s, &g, 1);
        const double beyond = std::max({e.velocity / limits.velocity[i],
                                        std::sqrt(e.acceleration / limits.acceleration[i]),
                                        std::cbrt(e.jerk / limits.jerk[i])});
        s = advanced(s, g.duration, g.jerk);
        t += g.duration;
        out.stretch = std::max(out.stretch, beyond);
        if (!(beyond > 1)) continue;
        const auto begin =
            std::lower_bound(slowed.times.begin(), slowed.times.end(), t - 3 * g.duration) -
            slowed.times.begin();
        for (auto m = begin;
             m < static_cast<std::ptrdiff_t>(bound.size()) && slowed.times[m] <= t + 3 * g.duration;
             ++m) {
          bound[m] = std::min(bound[m], 0.98 * slowed.alpha[m] / beyond);
        }
      }
    }
    if (!(out.stretch > 1)) return out;
  }
  out.approximation.trajectory = stretched(out.approximation.trajectory, out.stretch);
  for (double& t : out.times) t = times[0] + (t - times[0]) * out.stretch;
  return out;
}

}  // namespace handsel
