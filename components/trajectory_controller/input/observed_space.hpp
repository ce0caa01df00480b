// SPDX-License-Identifier: Apache-2.0
// What live sources of people observe: the union of their boxes. Pure, no heap after construction,
// noexcept.
#pragma once

#include <array>
#include <vector>

#include "common/messages/world.hpp"

namespace handsel::trajectory_controller {

/// Axis-aligned, world [m].
struct Box {
  Vector3 low{Vector3::Zero()}, high{Vector3::Zero()};  ///< opposite corners, low <= high
};

/// Only the boxes count: what a robot, furniture or a body hides from a source inside its box
/// counts as observed.
class ObservedSpace {
 public:
  /// `max_age`: a view that is older does not count [s].
  explicit ObservedSpace(double max_age) : max_age_(max_age) {}

  /// Takes in the live views; beyond kMaxViews the rest is left out.
  void set(const std::vector<SourceView>& views) noexcept;
  /// Whether any view counts. `since`: the time that has passed since the views had their ages [s].
  bool any(double since) const noexcept;
  /// Whether one view contains the whole box.
  bool one_contains(const Box& box, double since) const noexcept;
  /// Whether the views together contain the whole box; false as well when that is too much work to
  /// find out.
  bool contains(const Box& box, double since) const noexcept;

 private:
  static constexpr std::size_t kMaxViews = 16;  // as many as HumanState holds
  static constexpr int kMaxPieces = 256;        // of a box, cut along the sides of the views
  struct View {
    Box box;
    double age{};  // [s]
  };

  bool counts(const View& view, double since) const noexcept {
    return view.age + since <= max_age_;
  }
  bool contains(Box box, std::size_t from, double since, int& pieces) const noexcept;

  double max_age_;
  std::array<View, kMaxViews> views_;
  std::size_t count_{};
};

}  // namespace handsel::trajectory_controller
