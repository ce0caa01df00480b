// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/pair/double_grasp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "components/grasp_planner/list/so3_grid.hpp"
#include "components/grasp_planner/pair/retreat.hpp"

namespace handsel::grasp_planner {
namespace {

using Steps = std::vector<std::vector<Pose>>;

// One grasp of a list with its hand placed, for tests against many grasps of the other hand.
struct Placed {
  HandShape::PlacedHand closed;
  Steps T_open;
  std::vector<HandShape::PlacedHand>
      retreating;                      // opened, from the grasp to the end of the retreat
  Vector3 direction{Vector3::Zero()};  // unit, of the retreat, hand frame
  bool reached{true};
};

class Side {
 public:
  Side(const HandSide& side, const DoubleSettings& settings) : side_(side), settings_(settings) {
    taken_ = taken_grasps(*side.list, settings.max_of_each, settings.taken,
                          settings.p_object_middle, side.also);
    const std::size_t count = taken_.size();
    placed_.resize(count);
    directions_ = retreat_directions(side.hand_geometry->hand);
    Steps T_closed;
    for (std::size_t i = 0; i < count; ++i) {
      side.hand_geometry->forward(grasp(i).hand_joints, T_closed);
      placed_[i].closed = side.hand_geometry->shape.placed(T_closed, grasp(i).T_object_hand);
      placed_[i].reached = side.rest_score.empty() || side.rest_score[taken_[i]] >= 0;
    }
    tried_.assign(count, false);
  }

  std::size_t size() const { return placed_.size(); }
  std::size_t index(std::size_t i) const { return taken_[i]; }  // into the list
  const Grasp& grasp(std::size_t i) const { return side_.list->grasps[taken_[i]].grasp; }
  Vector3 wrist(std::size_t i) const { return grasp(i).T_object_hand.linear().col(2); }
  double rest_score(std::size_t i) const {
    return side_.rest_score.empty() ? 0.0 : side_.rest_score[taken_[i]];
  }
  const Placed& operator[](std::size_t i) const { return placed_[i]; }

  // Returns whether hand i, opened, can retreat clear of the object and the other hand.
  bool leaves(std::size_t i, const HandShape::PlacedHand& other) {
    if (!tried_[i]) prepare(i);
    const Placed& p = placed_[i];
    return !p.retreating.empty() &&
           std::none_of(p.retreating.begin(), p.retreating.end(),
                        [&](const HandShape::PlacedHand& hand) {
                          return HandShape::hands_touch(hand, other, settings_.retreat_clearance);
                        });
  }

 private:
  void prepare(std::size_t i) {
    tried_[i] = true;
    Placed& p = placed_[i];
    side_.hand_geometry->forward(grasp(i).pregrasp_joints, p.T_open);
    const auto direction =
        std::find_if(directions_.begin(), directions_.end(), [&](const Vector3& w) {
          return retreat_free(*side_.hand_geometry, p.T_open, *settings_.passed,
                              grasp(i).T_object_hand,
                              {w, settings_.stand_off, settings_.retreat_clearance});
        });
    if (direction == directions_.end()) return;
    p.direction = *direction;
    const int poses = static_cast<int>(std::ceil(settings_.stand_off / (2 * kSweepStep) + 0.5));
    for (int k = 0; k < poses; ++k) {
      Pose T = grasp(i).T_object_hand;
      T.translate(Vector3(2 * k * kSweepStep * *direction));
      p.retreating.push_back(side_.hand_geometry->shape.placed(p.T_open, T));
    }
  }

  const HandSide& side_;
  const DoubleSettings& settings_;
  std::vector<std::size_t> taken_;
  std::vector<Placed> placed_;
  std::vector<bool> tried_;
  std::vector<Vector3> directions_;
};

// Maps the values of all double grasps to [0, 1] and adds them to the scores.
template <class Value>
void add_normalised(std::vector<DoubleGrasp>& grasps, const Value& value) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const DoubleGrasp& g : grasps) {
    low = std::min(low, value(g));
    high = std::max(high, value(g));
  }
  if (!(high > low)) return;
  for (DoubleGrasp& g : grasps) g.score += (value(g) - low) / (high - low);
}

}  // namespace

std::vector<std::size_t> taken_grasps(const GraspList& list, std::size_t count, Taken taken,
                                      const Vector3& p_object_middle,
                                      const std::vector<std::size_t>& also) {
  std::vector<std::size_t> out;
  const auto add = [&out](std::size_t i) {
    if (std::find(out.begin(), out.end(), i) == out.end()) out.push_back(i);
  };
  if (taken == Taken::best || list.grasps.size() <= count) {
    for (std::size_t i = 0; i < std::min(count, list.grasps.size()); ++i) out.push_back(i);
    for (const std::size_t i : also) add(i);
    return out;
  }
  const std::vector<Eigen::Quaterniond> cells = so3_sequence(so3_grid_size(0));
  std::map<std::pair<std::size_t, int>, std::size_t>
      seen;  // grasps before in the same cell and octant
  struct Entry {
    bool is_weak;
    std::size_t before, index;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> order;  // grasps too weak to bear the object come last
  for (std::size_t i = 0; i < list.grasps.size(); ++i) {
    const Pose& T = list.grasps[i].grasp.T_object_hand;
    const Eigen::Quaterniond q(T.linear());
    std::size_t cell = 0;
    for (std::size_t c = 1; c < cells.size(); ++c) {
      if (std::abs(q.dot(cells[c])) > std::abs(q.dot(cells[cell]))) cell = c;
    }
    const Vector3 off = T.translation() - p_object_middle;
    const int octant = (off.x() > 0 ? 1 : 0) + (off.y() > 0 ? 2 : 0) + (off.z() > 0 ? 4 : 0);
    order.push_back({!list.bears(list.grasps[i].grasp), seen[{cell, octant}]++, i});
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < std::min(count, order.size()); ++i) out.push_back(order[i].index);
  for (const std::size_t i : also) add(i);
  return out;
}

Refusals DoubleList::refusals() const {
  Refusals out;
  const auto add = [&out](std::uint64_t count, const char* reason) {
    if (count > 0) out.push_back({std::to_string(count) + " pairs", reason});
  };
  add(out_of_reach, "an arm does not reach its grasp at the object's start or goal");
  add(not_opposed, "the wrists are not opposed enough");
  add(colliding, "the hands would collide");
  add(no_retreat, "one hand could not come or leave while the other holds the object");
  return out;
}

DoubleList list_double_grasps(const HandSide& a, const HandSide& b, const DoubleSettings& settings,
                              const std::function<bool()>& cancelled) {
  Side first(a, settings), second(b, settings);
  DoubleList out;
  const double max_cosine = std::cos(settings.min_opposition);
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (cancelled && cancelled()) break;
    const Vector3 wrist = first.wrist(i);
    for (std::size_t k = 0; k < second.size(); ++k) {
      ++out.pairs;
      if (!first[i].reached || !second[k].reached) {
        ++out.out_of_reach;
        continue;
      }
      const double cosine = std::clamp(wrist.dot(second.wrist(k)), -1.0, 1.0);
      if (cosine > max_cosine) {
        ++out.not_opposed;
        continue;
      }
      if (HandShape::hands_touch(first[i].closed, second[k].closed, settings.clearance,
                                 settings.palm_clearance)) {
        ++out.colliding;
        continue;
      }
      DoubleGrasp d{first.index(i), second.index(k)};
      if (settings.passed != nullptr) {
        if (!first.leaves(i, second[k].closed) || !second.leaves(k, first[i].closed)) {
          ++out.no_retreat;
          continue;
        }
        d.retreat_first = first[i].direction;
        d.retreat_second = second[k].direction;
      }
      d.opposition = std::acos(cosine);
      d.quality = std::min(first.grasp(i).quality, second.grasp(k).quality);
      d.rest_score = std::min(first.rest_score(i), second.rest_score(k));
      out.grasps.push_back(d);
    }
  }
  add_normalised(out.grasps, [](const DoubleGrasp& g) { return g.quality; });
  add_normalised(out.grasps, [](const DoubleGrasp& g) { return g.rest_score; });
  std::stable_sort(out.grasps.begin(), out.grasps.end(),
                   [](const DoubleGrasp& x, const DoubleGrasp& y) { return x.score > y.score; });
  return out;
}

double rest_score_of(const RobotModel& robot, const Group& arm, const Vector& arm_q) {
  double sum = 0;
  for (std::size_t i = 0; i < arm.axes.size(); ++i) {
    const Axis& axis = robot.axes()[static_cast<std::size_t>(arm.axes[i])];
    sum += std::abs(arm_q[static_cast<Eigen::Index>(i)] - robot.rest_configuration()[arm.axes[i]]) /
           (axis.upper - axis.lower);
  }
  return 1 - sum / static_cast<double>(arm.axes.size());
}

std::vector<double> rest_scores_of(const RobotModel& robot, const Group& arm, const Vector& q_seed,
                                   const GraspList& list, const std::vector<Pose>& T_root_object) {
  std::vector<double> out;
  IkOptions options;
  options.restarts = 1;
  for (const ListedGrasp& g : list.grasps) {
    double min_score = 1;
    for (const Pose& T : T_root_object) {
      const auto q = robot.inverse(arm, T * g.grasp.T_object_hand, q_seed, options);
      min_score = q ? std::min(min_score, rest_score_of(robot, arm, *q)) : -1;
      if (!q) break;
    }
    out.push_back(min_score);
  }
  return out;
}

}  // namespace handsel::grasp_planner
