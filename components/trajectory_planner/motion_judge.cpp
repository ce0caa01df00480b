#include "components/trajectory_planner/motion_judge.hpp"

#include <algorithm>
#include <array>

#include "common/trajectory/limits_check.hpp"

namespace handsel::trajectory_planner {

MotionJudge::MotionJudge(CollisionWorld& world, const std::vector<int>& axes, const Vector& rest, double finest)
    : world_(world),
      axes_(axes),
      rest_(rest),
      finest_(finest),
      acceleration_(static_cast<Eigen::Index>(axes.size())),
      low_(CollisionWorld::kMostBoxes, rest),
      high_(CollisionWorld::kMostBoxes, rest) {
  world_.set_moving_axes(axes_);
}

/// Between its ends an axis is at most a t^2 / 8 off the line between them.
void MotionJudge::enclose(const SegmentTable& table, const Piece& piece, Vector& low, Vector& high) {
  const double lasts = piece.end - piece.begin;
  table.evaluate(piece.begin, cursor_, at_begin_);
  table.evaluate(piece.end, cursor_, at_end_);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double off = acceleration_[k] * lasts * lasts / 8;
    low[axes_[i]] = std::min(at_begin_.position[k], at_end_.position[k]) - off;
    high[axes_[i]] = std::max(at_begin_.position[k], at_end_.position[k]) + off;
  }
}

bool MotionJudge::free(const Trajectory& trajectory, const SegmentTable& table) {
  for (std::size_t i = 0; i < axes_.size(); ++i)
    acceleration_[static_cast<Eigen::Index>(i)] =
        rate_extremes(trajectory.axes[i].start, trajectory.axes[i].segments.data(), static_cast<int>(trajectory.axes[i].segments.size()))
            .acceleration;
  at_begin_ = at_end_ = trajectory.at(0);
  cursor_ = 0;
  open_.clear();
  const double part = table.duration() / CollisionWorld::kMostBoxes;
  for (int i = CollisionWorld::kMostBoxes; i > 0; --i) open_.push_back({(i - 1) * part, i * part});
  std::array<Piece, CollisionWorld::kMostBoxes> judged;
  while (!open_.empty()) {
    int count = 0;
    for (; count < CollisionWorld::kMostBoxes && !open_.empty(); ++count, open_.pop_back()) {
      const auto at = static_cast<std::size_t>(count);
      judged[at] = open_.back();
      enclose(table, judged[at], low_[at], high_[at]);
    }
    const std::uint32_t unclear = world_.unclear_boxes(low_.data(), high_.data(), count);
    for (int i = count - 1; i >= 0; --i) {
      if ((unclear >> i & 1) == 0) continue;
      const auto at = static_cast<std::size_t>(i);
      const double middle = 0.5 * (judged[at].begin + judged[at].end);
      if ((high_[at] - low_[at]).maxCoeff() > finest_) {
        open_.push_back({middle, judged[at].end});
        open_.push_back({judged[at].begin, middle});
      } else if (!world_.is_free(0.5 * (low_[at] + high_[at]))) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace handsel::trajectory_planner
