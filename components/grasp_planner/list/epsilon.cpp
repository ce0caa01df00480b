// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list/epsilon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "common/base/errors.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kInconsistent = std::numeric_limits<double>::quiet_NaN();

std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

template <int D>
class Hull {
 public:
  using Point = std::array<double, D>;

  explicit Hull(std::vector<Point> points) : points_(std::move(points)) {
    for (std::size_t i = 0; i < points_.size(); ++i) key_.push_back(mix(i));
  }

  // Returns the signed distance of the nearest hull facet; 0 when flat, not positive when the
  // origin is not inside; NaN when rounding broke the topology.
  double nearest() {
    if (!start()) return 0.0;
    while (true) {
      while (!queue_.empty() && !facets_[queue_.top().second].alive) queue_.pop();
      if (queue_.empty()) return kInconsistent;
      const std::size_t f = queue_.top().second;
      std::uint16_t far = 0;
      double reach = -std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const double h = dot(facets_[f].normal, points_[i]);
        if (h > reach) {
          reach = h;
          far = static_cast<std::uint16_t>(i);
        }
      }
      if (reach <= facets_[f].offset + kTolerance) return facets_[f].offset;
      if (reach <= 0.0) return reach;
      if (!add(f, far)) return kInconsistent;
    }
  }

 private:
  static constexpr double kTolerance = 1e-12;
  static constexpr double kRounding = 2e-14;

  struct Facet {
    std::array<std::uint16_t, D> vertices{};
    std::array<std::uint32_t, D> neighbours{};  // across the ridge without vertices[k]
    Point normal{};
    double offset{};
    bool alive{true};
    std::uint32_t seen{};
  };
  struct Ridge {
    std::uint64_t key;
    std::uint32_t facet;
    std::uint32_t slot;
  };

  static double dot(const Point& a, const Point& b) {
    double s = 0;
    for (int i = 0; i < D; ++i)
      s += a[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(i)];
    return s;
  }

  // Sets the unit normal of the hyperplane through the facet's vertices, away from the inner point;
  // false when the vertices span no hyperplane.
  bool plane(Facet& f) const {
    std::array<Point, D> m{};
    const Point& origin = points_[f.vertices[0]];
    for (std::size_t r = 0; r + 1 < D; ++r) {
      for (std::size_t c = 0; c < D; ++c) m[r][c] = points_[f.vertices[r + 1]][c] - origin[c];
    }
    std::array<std::size_t, D> column{};
    for (std::size_t c = 0; c < D; ++c) column[c] = c;
    for (std::size_t k = 0; k + 1 < D; ++k) {
      std::size_t pr = k, pc = k;
      double best = 0;
      for (std::size_t r = k; r + 1 < D; ++r) {
        for (std::size_t c = k; c < D; ++c) {
          const double v = std::abs(m[r][column[c]]);
          if (v > best) {
            best = v;
            pr = r;
            pc = c;
          }
        }
      }
      if (best < 1e-14) return false;
      std::swap(m[k], m[pr]);
      std::swap(column[k], column[pc]);
      const double inverse = 1.0 / m[k][column[k]];
      for (std::size_t r = k + 1; r + 1 < D; ++r) {
        const double factor = m[r][column[k]] * inverse;
        if (factor == 0.0) continue;
        for (std::size_t c = k; c < D; ++c) m[r][column[c]] -= factor * m[k][column[c]];
      }
    }
    Point n{};
    n[column[D - 1]] = 1.0;
    for (std::size_t k = D - 1; k-- > 0;) {
      double s = 0;
      for (std::size_t c = k + 1; c < D; ++c) s += m[k][column[c]] * n[column[c]];
      n[column[k]] = -s / m[k][column[k]];
    }
    double length = 0;
    for (const double v : n) length += v * v;
    length = std::sqrt(length);
    for (double& v : n) v /= length;
    f.offset = 0;
    for (const std::uint16_t v : f.vertices) f.offset += dot(n, points_[v]);
    f.offset /= D;
    const double inner = dot(n, inner_);
    f.normal = n;
    if (inner > f.offset) {
      for (double& v : f.normal) v = -v;
      f.offset = -f.offset;
    }
    return std::isfinite(f.offset);
  }

  // Sets the hyperplane through `point` and the ridge between a facet that sees the point and one
  // that does not, as a combination of the two facets' planes. Falls back to the vertices when
  // rounding errors are large.
  bool cone_plane(const Facet& seeing, const Facet& blind, const Point& point, Facet& f) const {
    const double above = dot(seeing.normal, point) - seeing.offset,
                 below = blind.offset - dot(blind.normal, point);
    double length = 0;
    for (std::size_t c = 0; c < D; ++c) {
      f.normal[c] = above * blind.normal[c] + std::max(0.0, below) * seeing.normal[c];
      length += f.normal[c] * f.normal[c];
    }
    length = std::sqrt(length);
    if (!(length > 1e-9 * above)) return plane(f);
    f.offset = 0;
    for (double& v : f.normal) v /= length;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::uint16_t v : f.vertices) {
      const double h = dot(f.normal, points_[v]);
      low = std::min(low, h);
      high = std::max(high, h);
    }
    f.offset = 0.5 * (low + high);
    return high - low < kRounding || plane(f);
  }

  // Builds a simplex of D + 1 points, each at the max distance from the span of those before.
  bool start() {
    if (points_.size() < D + 1) return false;
    std::vector<Point> rest = points_;
    std::array<std::uint16_t, D + 1> simplex{};
    std::size_t first = 0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      if (dot(points_[i], points_[i]) > dot(points_[first], points_[first])) first = i;
    }
    simplex[0] = static_cast<std::uint16_t>(first);
    for (Point& p : rest) {
      for (std::size_t c = 0; c < D; ++c) p[c] -= points_[first][c];
    }
    for (std::size_t k = 1; k <= D; ++k) {
      std::size_t best = 0;
      double far = 0;
      for (std::size_t i = 0; i < rest.size(); ++i) {
        const double h = dot(rest[i], rest[i]);
        if (h > far) {
          far = h;
          best = i;
        }
      }
      if (far < 1e-18) return false;
      simplex[k] = static_cast<std::uint16_t>(best);
      Point axis = rest[best];
      const double length = std::sqrt(far);
      for (double& v : axis) v /= length;
      for (Point& p : rest) {
        const double along = dot(p, axis);
        for (std::size_t c = 0; c < D; ++c) p[c] -= along * axis[c];
      }
    }
    inner_ = Point{};
    for (const std::uint16_t v : simplex) {
      for (std::size_t c = 0; c < D; ++c) inner_[c] += points_[v][c] / (D + 1);
    }
    for (std::size_t omitted = 0; omitted <= D; ++omitted) {
      Facet f;
      std::size_t k = 0;
      for (std::size_t v = 0; v <= D; ++v) {
        if (v == omitted) continue;
        f.vertices[k] = simplex[v];
        f.neighbours[k] = static_cast<std::uint32_t>(v);
        ++k;
      }
      if (!plane(f)) return false;
      push(f);
    }
    return true;
  }

  void push(const Facet& f) {
    facets_.push_back(f);
    queue_.emplace(f.offset, facets_.size() - 1);
  }

  // Replaces the facets that `point` sees, starting from `first`, by the cone from their horizon to
  // it.
  bool add(std::size_t first, std::uint16_t point) {
    ++mark_;
    visible_.assign(1, static_cast<std::uint32_t>(first));
    facets_[first].seen = mark_;
    ridges_.clear();
    const std::size_t born = facets_.size();
    for (std::size_t i = 0; i < visible_.size(); ++i) {
      const std::uint32_t f = visible_[i];
      for (std::size_t k = 0; k < D; ++k) {
        const std::uint32_t other = facets_[f].neighbours[k];
        if (facets_[other].seen == mark_) continue;
        if (dot(facets_[other].normal, points_[point]) > facets_[other].offset + kTolerance) {
          facets_[other].seen = mark_;
          visible_.push_back(other);
        }
      }
    }
    for (const std::uint32_t f : visible_) {
      for (std::size_t k = 0; k < D; ++k) {
        const std::uint32_t other = facets_[f].neighbours[k];
        if (facets_[other].seen == mark_) continue;
        Facet cone;
        cone.vertices = facets_[f].vertices;
        cone.vertices[k] = point;
        cone.neighbours[k] = other;
        if (!cone_plane(facets_[f], facets_[other], points_[point], cone)) return false;
        const auto id = static_cast<std::uint32_t>(facets_.size());
        bool linked = false;
        for (std::size_t j = 0; j < D; ++j) {
          if (facets_[other].neighbours[j] == f) {
            facets_[other].neighbours[j] = id;
            linked = true;
            break;
          }
        }
        if (!linked) return false;
        std::uint64_t all = 0;
        for (const std::uint16_t v : cone.vertices) all ^= key_[v];
        for (std::size_t j = 0; j < D; ++j) {
          if (j != k)
            ridges_.push_back({all ^ key_[cone.vertices[j]], id, static_cast<std::uint32_t>(j)});
        }
        push(cone);
      }
    }
    if (facets_.size() == born) return false;
    for (const std::uint32_t f : visible_) facets_[f].alive = false;
    return link();
  }

  // Joins the new facets along the ridges they share: an open hash table of the ridges still alone.
  bool link() {
    std::size_t capacity = 16;
    while (capacity < 2 * ridges_.size()) capacity *= 2;
    table_.assign(capacity, -1);
    std::size_t joined = 0;
    for (std::size_t i = 0; i < ridges_.size(); ++i) {
      std::size_t at = ridges_[i].key & (capacity - 1);
      while (table_[at] >= 0 && ridges_[static_cast<std::size_t>(table_[at])].key != ridges_[i].key)
        at = (at + 1) & (capacity - 1);
      if (table_[at] < 0) {
        table_[at] = static_cast<std::int32_t>(i);
        continue;
      }
      const Ridge& a = ridges_[static_cast<std::size_t>(table_[at])];
      const Ridge& b = ridges_[i];
      facets_[a.facet].neighbours[a.slot] = b.facet;
      facets_[b.facet].neighbours[b.slot] = a.facet;
      ++joined;
    }
    return 2 * joined == ridges_.size();
  }

  std::vector<Point> points_;
  std::vector<std::uint64_t> key_;
  Point inner_{};
  std::vector<Facet> facets_;
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::uint32_t mark_{};
  std::vector<std::uint32_t> visible_;
  std::vector<Ridge> ridges_;
  std::vector<std::int32_t> table_;
};

template <int D>
double epsilon_of(const WrenchMatrix& w, double scale) {
  // Rounding can break the hull of points that nearly share a facet. Only then is the hull built
  // again from points moved by a relative 1e-12 to 1e-10, below the promised 1e-9 of the distance.
  for (const double joggle : {0.0, 1e-12, 1e-11, 1e-10}) {
    std::vector<std::array<double, D>> points(static_cast<std::size_t>(w.cols()));
    for (Eigen::Index j = 0; j < w.cols(); ++j) {
      for (Eigen::Index i = 0; i < D; ++i) {
        const auto noise =
            static_cast<double>(mix(static_cast<std::uint64_t>(j * D + i)) >> 11) * 0x1p-53 - 0.5;
        points[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] =
            w(i, j) / scale + joggle * noise;
      }
    }
    const double d = Hull<D>(std::move(points)).nearest();
    if (!std::isnan(d)) return d > 1e-11 ? d * scale : 0.0;
  }
  return 0.0;
}

template <int D = 1>
double dispatch(const WrenchMatrix& w, double scale) {
  if constexpr (D > kMaxWrenchDimension) {
    return 0.0;
  } else {
    return w.rows() == D ? epsilon_of<D>(w, scale) : dispatch<D + 1>(w, scale);
  }
}

}  // namespace

double epsilon(const WrenchMatrix& wrenches) {
  if (wrenches.rows() < 1 || wrenches.rows() > kMaxWrenchDimension) {
    throw ConfigError("wrenches have dimension " + std::to_string(wrenches.rows()) +
                      "; it must be 1 to " + std::to_string(kMaxWrenchDimension));
  }
  if (wrenches.cols() > 65535)
    throw ConfigError(std::to_string(wrenches.cols()) + " wrenches are too many; at most 65535");
  const double scale = wrenches.cols() == 0 ? 0.0 : wrenches.cwiseAbs().maxCoeff();
  if (!(scale > 0.0) || !std::isfinite(scale)) return 0.0;
  return dispatch(wrenches, scale);
}

}  // namespace handsel::grasp_planner
