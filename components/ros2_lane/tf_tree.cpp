// SPDX-License-Identifier: Apache-2.0
#include "components/ros2_lane/tf_tree.hpp"

#include <algorithm>

namespace handsel::ros2_lane {
namespace {
constexpr std::size_t kMaxFrames = 4096;  // max number of frames
constexpr double kForgotten = 10;  // frames not received for longer may be replaced by new ones [s]
constexpr int kMaxDepth = 64;      // max number of frames up to the root
}  // namespace

bool TfTree::set(const ros2::Transform& transform, TimePoint arrival, bool is_static) {
  if (frames_.size() >= kMaxFrames && !frames_.contains(transform.child) && !evict_oldest(arrival))
    return false;
  frames_[transform.child] = {transform, arrival, is_static};
  return true;
}

/// Removes frames that are too old, at most once a second. Returns whether there is space.
bool TfTree::evict_oldest(TimePoint now) {
  if (swept_ && to_seconds(now - *swept_) < 1) return false;
  swept_ = now;
  std::erase_if(frames_, [&](const auto& entry) {
    return !entry.second.is_static && to_seconds(now - entry.second.arrival) > kForgotten;
  });
  return frames_.size() < kMaxFrames;
}

std::optional<TfTree::Place> TfTree::find(const std::string& frame, const std::string& root) const {
  Place place;
  place.arrival = TimePoint::max();
  std::string at = frame;
  for (int i = 0; i < kMaxDepth; ++i) {
    if (at == root) return place;
    const auto found = frames_.find(at);
    if (found == frames_.end()) return std::nullopt;
    const Frame& step = found->second;
    place.T_root_frame = step.transform.T_parent_child * place.T_root_frame;
    if (i == 0 && !step.is_static) place.stamp = step.transform.stamp;
    if (!step.is_static) place.arrival = std::min(place.arrival, step.arrival);
    at = step.transform.parent;
  }
  return std::nullopt;
}

}  // namespace handsel::ros2_lane
