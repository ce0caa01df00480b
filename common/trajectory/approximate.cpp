#include "common/trajectory/approximate.hpp"

#include <algorithm>
#include <cmath>

#include "common/trajectory/three_segment.hpp"

namespace handsel {

namespace {

std::string why_bad(const std::vector<double>& times, const std::vector<MotionState3>& samples) {
  if (samples.size() < 2 || times.size() != samples.size()) return "there must be two samples or more, and as many times";
  const Eigen::Index n = samples[0].position.size();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const MotionState3& s = samples[k];
    if (s.position.size() != n || s.velocity.size() != n || s.acceleration.size() != n) {
      return "sample " + std::to_string(k) + " does not have " + std::to_string(n) + " axes";
    }
    if (!s.position.allFinite() || !s.velocity.allFinite() || !s.acceleration.allFinite() || !std::isfinite(times[k])) {
      return "sample " + std::to_string(k) + " has a number that is not finite";
    }
    if (k > 0 && !(times[k] > times[k - 1])) return "the times must grow, sample " + std::to_string(k) + " does not";
  }
  return {};
}

class Fit {
 public:
  Fit(const std::vector<double>& times, const std::vector<MotionState3>& samples, const ApproximationTolerance& tolerance,
      Approximation& out)
      : times_(times), samples_(samples), tolerance_(tolerance), out_(out) {}

  void piece(std::size_t first, std::size_t last) {
    const double T = times_[last] - times_[first];
    std::vector<std::array<Segment, 3>> fitted;
    double x_error = 0, v_error = 0;
    for (Eigen::Index i = 0; i < samples_[0].position.size(); ++i) {
      fitted.push_back(three_segment(state(first, i), state(last, i), T));
      for (std::size_t k = first + 1; k < last; ++k) {
        const AxisState s = at(state(first, i), fitted.back(), times_[k] - times_[first]), wanted = state(k, i);
        x_error = std::max(x_error, std::abs(s.position - wanted.position));
        v_error = std::max(v_error, std::abs(s.velocity - wanted.velocity));
      }
    }
    if (last - first > 1 && (x_error > tolerance_.position || v_error > tolerance_.velocity)) {
      const std::size_t middle = (first + last) / 2;
      piece(first, middle);
      piece(middle, last);
      return;
    }
    ++out_.pieces;
    out_.position_error = std::max(out_.position_error, x_error);
    out_.velocity_error = std::max(out_.velocity_error, v_error);
    for (std::size_t i = 0; i < fitted.size(); ++i) {
      auto& segments = out_.trajectory.axes[i].segments;
      segments.insert(segments.end(), fitted[i].begin(), fitted[i].end());
    }
  }

 private:
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
  Approximation& out_;
};

}  // namespace

Approximation approximate(const std::vector<double>& times, const std::vector<MotionState3>& samples,
                          const ApproximationTolerance& tolerance) {
  Approximation out;
  if (!(tolerance.position > 0 && tolerance.velocity > 0)) out.reason = "the tolerances must be positive";
  if (out.ok()) out.reason = why_bad(times, samples);
  if (!out.ok()) return out;
  const Eigen::Index n = samples[0].position.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    out.trajectory.axes.push_back({{samples[0].position[i], samples[0].velocity[i], samples[0].acceleration[i]}, {}});
  }
  Fit(times, samples, tolerance, out).piece(0, samples.size() - 1);
  const double sampled = 3.0 * static_cast<double>(samples.size()), kept = 3.0 + 6.0 * out.pieces;
  out.compression = sampled / kept;
  return out;
}

}  // namespace handsel
