// SPDX-License-Identifier: Apache-2.0
// The states of a search tree on flat arrays.
#pragma once

#include <algorithm>
#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel::path_planner {

/// Stores states by axis in single precision for the nearest-state search, and as vectors in double
/// precision for all other use.
class Tree {
 public:
  explicit Tree(int axes) : columns_(64, axes), distances_(64) {}

  /// Returns the number of states.
  int size() const { return static_cast<int>(states_.size()); }
  const Vector& operator[](int i) const { return states_[static_cast<std::size_t>(i)]; }
  /// Returns the index of the parent of state `i`; -1 for a root.
  int parent(int i) const { return parents_[static_cast<std::size_t>(i)]; }

  /// Adds a state and returns its index. A root has parent -1.
  int add(const Vector& q, int parent) {
    const int i = size();
    if (i == columns_.rows()) {
      columns_.conservativeResize(Eigen::Index{2} * i, Eigen::NoChange);
      distances_.resize(Eigen::Index{2} * i);
    }
    columns_.row(i) = q.cast<float>().transpose();
    states_.push_back(q);
    parents_.push_back(parent);
    return i;
  }

  /// Returns the index of the state nearest to q, Euclidean in single precision. The tree must not
  /// be empty.
  int nearest(const Vector& q) {
    const int n = size();
    distances_.head(n) = (columns_.col(0).head(n) - static_cast<float>(q[0])).square();
    for (int axis = 1; axis < q.size(); ++axis)
      distances_.head(n) += (columns_.col(axis).head(n) - static_cast<float>(q[axis])).square();
    int best = 0;
    distances_.head(n).minCoeff(&best);
    return best;
  }

  /// Returns the index of the root of the branch of state `i`.
  int root_of(int i) const {
    while (parent(i) >= 0) i = parent(i);
    return i;
  }

  /// Returns the states from the root to state `i`.
  std::vector<Vector> branch(int i) const {
    std::vector<Vector> path;
    for (; i >= 0; i = parent(i)) path.push_back((*this)[i]);
    std::reverse(path.begin(), path.end());
    return path;
  }

 private:
  Eigen::ArrayXXf columns_;  // one row per state, column-major
  Eigen::ArrayXf distances_;
  std::vector<Vector> states_;
  std::vector<int> parents_;
};

/// From the root of `from_start` through a and b, the same state in both trees, to the root of
/// `from_goals`.
inline std::vector<Vector> joined(const Tree& from_start, int a, const Tree& from_goals, int b) {
  std::vector<Vector> path = from_start.branch(a), rest = from_goals.branch(b);
  path.insert(path.end(), rest.rbegin() + 1, rest.rend());
  return path;
}

}  // namespace handsel::path_planner
