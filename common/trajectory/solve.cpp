// SPDX-License-Identifier: Apache-2.0
#include "common/trajectory/solve.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/trajectory/min_time.hpp"
#include "common/trajectory/three_segment.hpp"

namespace handsel {

namespace {

std::string size_mismatch(const MotionState3& s, const char* which, Eigen::Index n) {
  if (s.position.size() == n && s.velocity.size() == n && s.acceleration.size() == n) return {};
  return std::string("the ") + which + " state has " + std::to_string(s.position.size()) +
         " positions, " + std::to_string(s.velocity.size()) + " velocities and " +
         std::to_string(s.acceleration.size()) + " accelerations, wanted " + std::to_string(n) +
         " of each";
}

AxisState state_of(const MotionState3& s, Eigen::Index i) {
  return {s.position[i], s.velocity[i], s.acceleration[i]};
}

std::string axis_reason(Eigen::Index axis, const std::string& what) {
  return "axis " + std::to_string(axis) + ": " + what;
}

/// Solves for the imposed duration, or each axis in min time; returns the reason of a failure, or
/// an empty text.
std::string one_by_one(const MotionState3& from, const MotionState3& to,
                       const KinematicLimits& limits, std::optional<double> imposed,
                       std::vector<AxisProfile>& profiles, Solution& out) {
  const auto n = static_cast<Eigen::Index>(profiles.size());
  std::vector<AxisProblem> problems(profiles.size());
  double max_duration = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    AxisProblem& problem = problems[static_cast<std::size_t>(i)];
    const AxisOutcome outcome =
        problem.init(state_of(from, i), state_of(to, i), limits_of(limits, i));
    if (outcome != AxisOutcome::ok) return axis_reason(i, reason(outcome));
    out.min_durations.push_back(problem.minimum());
    max_duration = std::max(max_duration, problem.minimum());
    if (imposed && *imposed < problem.minimum() * (1 - 1e-12)) {
      return axis_reason(i, "needs " + std::to_string(problem.minimum()) + " s, imposed are " +
                                std::to_string(*imposed) + " s");
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const AxisProblem& problem = problems[static_cast<std::size_t>(i)];
    AxisProfile& profile = profiles[static_cast<std::size_t>(i)];
    if (!imposed) {
      problem.minimum_profile(profile);
      if (problem.minimum() == max_duration) continue;
      if (to.velocity[i] != 0 || to.acceleration[i] != 0)
        return axis_reason(i, "ends early and moving, so it cannot wait for the others");
      profile.push(max_duration - problem.minimum(), 0);
    } else if (problem.profile(*imposed, profile) != AxisOutcome::ok) {
      const auto three = three_segment(state_of(from, i), state_of(to, i), *imposed);
      out.excess =
          std::max(out.excess, excess(state_of(from, i), three.data(), 3, limits_of(limits, i)));
      profile.clear();
      for (const Segment& s : three) profile.push(s.duration, s.jerk);
    }
  }
  return {};
}

}  // namespace

SynchronisedBatch::SynchronisedBatch(int axes, int problems) : axes_(axes) {
  const std::size_t total = static_cast<std::size_t>(axes) * static_cast<std::size_t>(problems);
  const std::size_t blocks = (total + detail::kBatchAxes - 1) / detail::kBatchAxes;
  problems_.resize(static_cast<std::size_t>(problems));
  blocks_.resize(blocks);
  odd_.resize(blocks);
  slow_.resize(total);
  minima_.resize(total);
  durations_.resize(blocks * detail::kBatchAxes);
  profiles_.resize(total);
}

void SynchronisedBatch::take_over(const detail::AxisBatchInput& in, int entry) noexcept {
  const auto i = static_cast<std::size_t>(entry);
  odd_[i / detail::kBatchAxes] |= 1U << entry % detail::kBatchAxes;
  const AxisOutcome outcome =
      slow_[i].init({in.position[i], in.velocity[i], in.acceleration[i]},
                    {in.end_position[i], in.end_velocity[i], in.end_acceleration[i]},
                    {in.max_velocity[i], in.max_acceleration[i], in.max_jerk[i]});
  Problem& problem = problems_[i / static_cast<std::size_t>(axes_)];
  problem.open = true;
  minima_[i] = slow_[i].minimum();
  if (outcome == AxisOutcome::ok || problem.outcome != AxisOutcome::ok) return;
  problem.outcome = outcome;
  problem.axis = entry % axes_;
}

void SynchronisedBatch::find_durations(int count) noexcept {
  for (int p = 0; p < count; ++p) {
    Problem& problem = problems_[static_cast<std::size_t>(p)];
    if (!problem.open || problem.outcome != AxisOutcome::ok) continue;
    const int first = p * axes_;
    double T = 0;
    for (int i = first; i < first + axes_; ++i)
      T = std::max(T, minima_[static_cast<std::size_t>(i)]);
    for (bool grown = true; grown;) {
      grown = false;
      for (int i = first; i < first + axes_; ++i) {
        if (!(odd_[static_cast<std::size_t>(i / detail::kBatchAxes)] >> i % detail::kBatchAxes & 1))
          continue;
        const double next = slow_[static_cast<std::size_t>(i)].earliest(T);
        if (next > T) T = next, grown = true;
      }
    }
    problem.duration = T;
    std::fill_n(durations_.begin() + first, axes_, T);
  }
}

int SynchronisedBatch::solve(const detail::AxisBatchInput& in, int count) noexcept {
  using detail::kBatchAxes;
  const int total = count * axes_, blocks = (total + kBatchAxes - 1) / kBatchAxes;
  const detail::BatchKernels& kernels = detail::batch_kernels();
  for (int p = 0; p < count; ++p)
    problems_[static_cast<std::size_t>(p)] = {0, AxisOutcome::ok, 0, true};
  for (int b = 0; b < blocks; ++b) {
    const auto k = static_cast<std::size_t>(b);
    const int first = b * kBatchAxes, here = std::min(kBatchAxes, total - first);
    odd_[k] = 0;
    const std::uint32_t odd = kernels.prepare(in, first, here, blocks_[k]);
    std::copy_n(blocks_[k].minimum, here, minima_.begin() + first);
    for (std::uint32_t left = odd; left != 0; left &= left - 1)
      take_over(in, first + std::countr_zero(left));
  }
  for (bool again = true; again;) {
    again = false;
    find_durations(count);
    for (Problem& problem : problems_) problem.open = false;
    for (int b = 0; b < blocks; ++b) {
      const auto k = static_cast<std::size_t>(b);
      std::uint32_t blocked = 0, failed = 0;
      failed = kernels.finish(blocks_[k], durations_.data() + k * kBatchAxes, odd_[k], &blocked);
      for (std::uint32_t left = failed | blocked; left != 0; left &= left - 1) {
        take_over(in, b * kBatchAxes + std::countr_zero(left));
        again = true;
      }
    }
  }
  write_profiles(total);
  int solved = 0;
  for (int p = 0; p < count; ++p)
    solved += problems_[static_cast<std::size_t>(p)].outcome == AxisOutcome::ok;
  return solved;
}

void SynchronisedBatch::write_profiles(int total) noexcept {
  for (int i = 0; i < total; ++i) {
    AxisProfile& out = profiles_[static_cast<std::size_t>(i)];
    const auto b = static_cast<std::size_t>(i / detail::kBatchAxes),
               entry = static_cast<std::size_t>(i % detail::kBatchAxes);
    if (odd_[b] >> entry & 1) {
      Problem& problem = problems_[static_cast<std::size_t>(i / axes_)];
      if (problem.outcome != AxisOutcome::ok) continue;
      problem.outcome = slow_[static_cast<std::size_t>(i)].profile(problem.duration, out);
      problem.axis = i % axes_;
      continue;
    }
    const detail::AxisBatch& block = blocks_[b];
    int n = 0;
    for (int k = 0; k < block.segments; ++k) {
      out.segments[static_cast<std::size_t>(n)] = {block.duration[k][entry], block.jerk[k][entry]};
      n += block.duration[k][entry] > 0;
    }
    out.count = n;
  }
}

bool SynchronisedAxes::solve(const MotionState3& from, const MotionState3& to,
                             const KinematicLimits& limits) noexcept {
  wrong_size_ = false;
  for (const Eigen::VectorXd* all :
       {&from.position, &from.velocity, &from.acceleration, &to.position, &to.velocity,
        &to.acceleration, &limits.velocity, &limits.acceleration, &limits.jerk}) {
    wrong_size_ = wrong_size_ || all->size() != axes_;
  }
  if (wrong_size_) return false;
  return batch_.solve({from.position.data(), from.velocity.data(), from.acceleration.data(),
                       to.position.data(), to.velocity.data(), to.acceleration.data(),
                       limits.velocity.data(), limits.acceleration.data(), limits.jerk.data()},
                      1) == 1;
}

Solution solve(const MotionState3& from, const MotionState3& to, const KinematicLimits& limits,
               Sync sync, std::optional<double> imposed) {
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
  std::vector<AxisProfile> profiles(static_cast<std::size_t>(n));
  if (sync == Sync::time && !imposed) {
    SynchronisedAxes axes(static_cast<int>(n));
    if (!axes.solve(from, to, limits)) {
      out.reason = axis_reason(axes.axis(), reason(axes.outcome()));
      return out;
    }
    for (int i = 0; i < n; ++i) {
      out.min_durations.push_back(axes.minimum(i));
      profiles[static_cast<std::size_t>(i)] = axes.profile(i);
    }
  } else if (out.reason = one_by_one(from, to, limits, imposed, profiles, out); !out.ok()) {
    return out;
  }
  out.trajectory.axes.resize(n);
  for (int i = 0; i < n; ++i) {
    const AxisProfile& p = profiles[static_cast<std::size_t>(i)];
    out.trajectory.axes[static_cast<std::size_t>(i)] = {
        {from.position[i], from.velocity[i], from.acceleration[i]},
        {p.segments.begin(), p.segments.begin() + p.count}};
  }
  return out;
}

}  // namespace handsel
