// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/hand/finger_workspace.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::grasp_planner {
namespace {

constexpr std::size_t kSeedsPerCell = 3;
constexpr double kDistinct = 0.35;  // [rad] seeds of one cell differ by more in some axis
constexpr std::int64_t kMaxSamples = 1'000'000;

// Returns the samples per axis with less than `step` [m] of tip motion between two of them.
std::vector<int> samples_per_axis(const HandModel& hand, const FingerChain& chain, double step) {
  std::vector<int> counts;
  const Vector &lower = hand.lower_contact(), &upper = hand.upper_contact();
  for (std::size_t k = 0; k < chain.axes().size(); ++k) {
    const int a = chain.axes()[k];
    double lever = 0;
    std::vector<Pose> T;
    for (const double ratio : {0.0, 0.5, 1.0}) {
      Vector q = hand.rest();
      for (const int b : chain.axes()) q[b] = lower[b] + ratio * (upper[b] - lower[b]);
      chain.forward(q, T);
      lever = std::max(lever, chain.jacobian(T).col(static_cast<Eigen::Index>(k)).norm());
    }
    counts.push_back(
        1 + static_cast<int>(std::ceil(lever * std::max(0.0, upper[a] - lower[a]) / step)));
  }
  return counts;
}

}  // namespace

FingerWorkspace::FingerWorkspace(const HandModel& hand, const FingerChain& chain,
                                 const WorkspaceSettings& settings)
    : step_(settings.step) {
  sample(hand, chain);
  cover(settings);
}

/// Finds box, cells and seeds from samples over all axes.
void FingerWorkspace::sample(const HandModel& hand, const FingerChain& chain) {
  const Vector &lower = hand.lower_contact(), &upper = hand.upper_contact();
  double fine = 0.7 * step_;
  std::vector<int> counts = samples_per_axis(hand, chain, fine);
  const auto total = [&counts] {
    std::int64_t n = 1;
    for (const int c : counts) n *= c;
    return n;
  };
  while (total() > kMaxSamples) {
    fine *= 1.1;
    counts = samples_per_axis(hand, chain, fine);
  }
  const std::int64_t samples = total();
  const std::size_t n = chain.axes().size();
  Vector q = hand.rest();
  std::vector<Pose> T;
  const auto set_sample = [&](std::int64_t index) {
    double centrality = 1;
    for (std::size_t k = 0; k < n; ++k) {
      const int a = chain.axes()[k];
      const double ratio =
          counts[k] > 1 ? static_cast<double>(index % counts[k]) / (counts[k] - 1) : 0.5;
      index /= counts[k];
      q[a] = lower[a] + ratio * (upper[a] - lower[a]);
      centrality = std::min(centrality, 2 * std::min(ratio, 1 - ratio));
    }
    return centrality;
  };
  std::vector<Eigen::Vector3f> tips(static_cast<std::size_t>(samples));
  for (std::int64_t i = 0; i < samples; ++i) {
    set_sample(i);
    chain.forward(q, T);
    const Vector3 p = chain.tip(T);
    box_.extend(p);
    tips[static_cast<std::size_t>(i)] = p.cast<float>();
  }
  cells_ = (box_.sizes() / step_).array().floor().cast<int>() + 1;
  entry_.assign(static_cast<std::size_t>(cells_.x()) * static_cast<std::size_t>(cells_.y()) *
                    static_cast<std::size_t>(cells_.z()),
                0);
  for (std::int64_t i = 0; i < samples; ++i) {
    const double centrality = set_sample(i);
    const Vector3 p =
        tips[static_cast<std::size_t>(i)].cast<double>().cwiseMax(box_.min()).cwiseMin(box_.max());
    std::uint32_t& entry = entry_[static_cast<std::size_t>(cell(p))];
    if (entry == 0) {
      seeds_.emplace_back();
      entry = static_cast<std::uint32_t>(seeds_.size());
    }
    std::vector<Seed>& seeds = seeds_[entry - 1];
    bool near = false, worse = false;
    for (const Seed& s : seeds) {
      double differ = 0;
      for (std::size_t k = 0; k < n; ++k)
        differ = std::max(differ, std::abs(s.q[static_cast<Eigen::Index>(k)] - q[chain.axes()[k]]));
      near = near || differ <= kDistinct;
      worse = worse || (differ <= kDistinct && s.centrality >= centrality);
    }
    if (worse || (!near && seeds.size() >= kSeedsPerCell && seeds.back().centrality >= centrality))
      continue;
    chain.forward(q, T);
    Seed seed{Vector(static_cast<Eigen::Index>(n)), centrality, chain.tip_direction(T),
              chain.closing_direction(T)};
    for (std::size_t k = 0; k < n; ++k) seed.q[static_cast<Eigen::Index>(k)] = q[chain.axes()[k]];
    std::erase_if(seeds,
                  [&](const Seed& s) { return (s.q - seed.q).cwiseAbs().maxCoeff() <= kDistinct; });
    seeds.insert(
        std::upper_bound(seeds.begin(), seeds.end(), seed,
                         [](const Seed& a, const Seed& b) { return a.centrality > b.centrality; }),
        seed);
    if (seeds.size() > kSeedsPerCell) seeds.pop_back();
  }
}

/// Covers the cells that were reached with spheres.
void FingerWorkspace::cover(const WorkspaceSettings& settings) {
  // Boundary cells have a neighbour that was not reached; the others are inner.
  std::vector<Vector3> boundary, inner, all;
  const auto reached = [&](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= cells_.x() || y >= cells_.y() || z >= cells_.z())
      return false;
    return entry_[static_cast<std::size_t>(
               (static_cast<std::int64_t>(z) * cells_.y() + y) * cells_.x() + x)] != 0;
  };
  for (int z = 0; z < cells_.z(); ++z) {
    for (int y = 0; y < cells_.y(); ++y) {
      for (int x = 0; x < cells_.x(); ++x) {
        if (!reached(x, y, z)) continue;
        const Vector3 c = centre((static_cast<std::int64_t>(z) * cells_.y() + y) * cells_.x() + x);
        const bool inside = reached(x - 1, y, z) && reached(x + 1, y, z) && reached(x, y - 1, z) &&
                            reached(x, y + 1, z) && reached(x, y, z - 1) && reached(x, y, z + 1);
        (inside ? inner : boundary).push_back(c);
        all.push_back(c);
      }
    }
  }
  for (const Vector3& c : all) centroid_ += c / static_cast<double>(all.size());
  std::vector<double> room(inner.size(), 0.0);
  for (std::size_t i = 0; i < inner.size(); ++i) {
    double min_square = 1e9;
    for (const Vector3& b : boundary)
      min_square = std::min(min_square, (inner[i] - b).squaredNorm());
    room[i] = std::sqrt(min_square) - 0.5 * step_;  // a boundary cell may be reached in part only
  }
  while (spheres_.size() < settings.max_spheres && !inner.empty()) {
    const auto best =
        static_cast<std::size_t>(std::max_element(room.begin(), room.end()) - room.begin());
    if (room[best] < settings.min_radius) break;
    const WorkspaceSphere s{inner[best], room[best]};
    spheres_.push_back(s);
    for (std::size_t i = 0; i < inner.size(); ++i)
      room[i] = std::min(room[i], (inner[i] - s.centre).norm() - s.radius);
  }
  has_volume_ = !spheres_.empty();
  if (!has_volume_) {
    for (const Vector3& c : all) spheres_.push_back({c, step_ * 0.87});
  }
}

std::int64_t FingerWorkspace::cell(const Vector3& p) const {
  const Eigen::Vector3i c = ((p - box_.min()) / step_).array().floor().cast<int>();
  if ((c.array() < 0).any() || (c.array() >= cells_.array()).any()) return -1;
  return (static_cast<std::int64_t>(c.z()) * cells_.y() + c.y()) * cells_.x() + c.x();
}

Vector3 FingerWorkspace::centre(std::int64_t cell) const {
  const std::int64_t x = cell % cells_.x(), y = cell / cells_.x() % cells_.y(),
                     z = cell / cells_.x() / cells_.y();
  return box_.min() + step_ * Vector3(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5,
                                      static_cast<double>(z) + 0.5);
}

std::vector<Vector3> FingerWorkspace::cells() const {
  std::vector<Vector3> out;
  for (std::size_t c = 0; c < entry_.size(); ++c) {
    if (entry_[c] != 0) out.push_back(centre(static_cast<std::int64_t>(c)));
  }
  return out;
}

const std::vector<FingerWorkspace::Seed>& FingerWorkspace::seeds(const Vector3& p_hand) const {
  static const std::vector<Seed> none;
  const std::int64_t c = cell(p_hand);
  if (c < 0 || entry_[static_cast<std::size_t>(c)] == 0) return none;
  return seeds_[entry_[static_cast<std::size_t>(c)] - 1];
}

}  // namespace handsel::grasp_planner
