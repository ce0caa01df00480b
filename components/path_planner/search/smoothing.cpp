// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/smoothing.hpp"

#include <algorithm>
#include <cmath>

namespace handsel::path_planner {
namespace {

constexpr double kMinGain = 1e-6;  // min reduction of the price

/// A place on the path: the preceding waypoint and the fraction of the segment.
struct Place {
  std::size_t node{};
  double fraction{};
};

class Line {
 public:
  explicit Line(const std::vector<Vector>& path) : path_(path), length_(path.size(), 0.0) {
    for (std::size_t i = 1; i < path.size(); ++i)
      length_[i] = length_[i - 1] + (path[i] - path[i - 1]).norm();
  }
  double length() const { return length_.back(); }
  Place at(double s) const {
    std::size_t i = static_cast<std::size_t>(std::upper_bound(length_.begin(), length_.end(), s) -
                                             length_.begin());
    i = std::clamp<std::size_t>(i, 1, path_.size() - 1);
    const double edge = length_[i] - length_[i - 1];
    return {i - 1, edge > 0 ? std::clamp((s - length_[i - 1]) / edge, 0.0, 1.0) : 0.0};
  }
  Vector point(const Place& p) const {
    return path_[p.node] + p.fraction * (path_[p.node + 1] - path_[p.node]);
  }

 private:
  const std::vector<Vector>& path_;
  std::vector<double> length_;
};

bool free(SearchSpace& space, const std::vector<Vector>& line) {
  for (std::size_t i = 1; i < line.size(); ++i)
    if (!space.motion_free(line[i - 1], line[i])) return false;
  return true;
}

/// Replaces the path between two places by `inner` if that reduces the price, is within the bounds
/// and free, checked in this order.
bool replace(SearchSpace& space, std::vector<Vector>& path, const Line& line, const Place& from,
             const Place& to, const std::vector<Vector>& inner) {
  std::vector<Vector> before = {line.point(from)}, after = {line.point(from)};
  for (std::size_t i = from.node + 1; i <= to.node; ++i) before.push_back(path[i]);
  before.push_back(line.point(to));
  for (const Vector& q : inner) after.push_back(q);
  after.push_back(line.point(to));
  if (space.costs().price(after) >= space.costs().price(before) - kMinGain) return false;
  if (!std::all_of(inner.begin(), inner.end(), [&](const Vector& q) { return space.inside(q); }))
    return false;
  if (!free(space, after)) return false;
  std::vector<Vector> joined(path.begin(), path.begin() + static_cast<long>(from.node) + 1);
  const auto add = [&joined](const Vector& q) {
    if ((q - joined.back()).norm() > 1e-6) joined.push_back(q);
  };
  for (const Vector& q : after) add(q);
  for (std::size_t i = to.node + 1; i < path.size(); ++i) add(path[i]);
  joined.back() = path.back();
  path = std::move(joined);
  return true;
}

}  // namespace

void smooth(SearchSpace& space, std::vector<Vector>& path, Random& random) {
  const Settings& settings = space.settings();
  const bool people = space.costs().concerns_people();
  int idle_rounds = 0;
  const auto& smooth_on = space.hooks().smooth_on;
  const auto continues = [&](int round) {
    return smooth_on ? smooth_on()
                     : round < settings.smoothing_rounds && idle_rounds < settings.max_idle_rounds;
  };
  for (int round = 0; continues(round) && !space.exhausted(); ++round) {
    const Line line(path);
    if (path.size() < 2 || line.length() < 1e-9) return;
    bool gained = false;
    if (!people || round % (settings.perturbations + 1) == 0) {
      double a = random.between(0, line.length()), b = random.between(0, line.length());
      if (a > b) std::swap(a, b);
      const Place from = line.at(a), to = line.at(b);
      gained = from.node != to.node && replace(space, path, line, from, to, {});
    } else {
      double s = random.between(0, line.length());
      const double other = random.between(0, line.length());
      if (space.costs().of(line.point(line.at(other))) > space.costs().of(line.point(line.at(s))))
        s = other;
      const double half = random.between(0.2, 1.0) * settings.max_edge;
      const Place from = line.at(std::max(0.0, s - half)),
                  to = line.at(std::min(line.length(), s + half));
      const Vector center = line.point(line.at(s)),
                   toward = random.within(space.lower(), space.upper()) - center;
      const double far = std::min(toward.norm(), random.between(0.1, 1.0) * half);
      gained = toward.norm() > 1e-9 &&
               replace(space, path, line, from, to,
                       {space.upright().restore(center + toward * (far / toward.norm()))});
    }
    idle_rounds = gained ? 0 : idle_rounds + 1;
  }
}

void prune(SearchSpace& space, std::vector<Vector>& path) {
  for (std::size_t i = 1; i + 1 < path.size() && !space.exhausted();) {
    const double before =
        space.costs().price(path[i - 1], path[i]) + space.costs().price(path[i], path[i + 1]);
    if (space.costs().price(path[i - 1], path[i + 1]) <=
            before * (1 + space.settings().max_prune_loss) &&
        space.motion_free(path[i - 1], path[i + 1])) {
      path.erase(path.begin() + static_cast<long>(i));
      if (i > 1) --i;
    } else {
      ++i;
    }
  }
}

}  // namespace handsel::path_planner
