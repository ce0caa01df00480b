// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/regrasp/two_hands.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "components/grasp_planner/pair/carried_motion.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kPathStep = 0.03;  // [m] between two poses of the carried object

/// Returns the path of the object: up by `lift` [m], straight across and down, or to a goal in the
/// air straight after the lift.
std::vector<Pose> carried_over(const TwoHandTask& task, double lift) {
  const auto raised = [&](Pose T) {
    T.translation().z() += lift;
    return T;
  };
  const Pose &T_start = task.T_world_start, &T_goal = task.T_world_goal;
  if (task.in_air) return path_of_object({T_start, raised(T_start), T_goal}, kPathStep);
  return path_of_object({T_start, raised(T_start), raised(T_goal), T_goal}, kPathStep);
}

/// One object carried by both hands from one place to another.
class TwoHandSearch {
 public:
  TwoHandSearch(StepCheck& check, const TwoHandTask& task);
  RegraspPlan run(const std::function<bool()>& cancelled);

 private:
  bool find_grasps(std::size_t a);
  DoubleList list_pairs(const std::function<bool()>& cancelled) const;
  std::vector<LoadShare> shares_of(const DoubleGrasp& pair) const;
  std::optional<std::pair<Vector, Vector>> both_along(const DoubleGrasp& pair, std::string& why);
  std::optional<std::vector<RegraspStep>> check_pair(const DoubleGrasp& pair, std::string& why);

  StepCheck& check_;
  GripLoad load_;
  std::vector<Pose> T_world_path_;  // of the object
  // By arm: grasps that bear half of the load and with which the arm follows the path, their
  // indices in the list of the arm, and the motions of the arm by index.
  std::array<GraspList, 2> reached_;
  std::array<std::vector<std::size_t>, 2> index_;
  std::array<std::map<std::size_t, std::vector<CarriedMotion>>, 2> paths_;
  std::array<HandSide, 2> sides_;
  RegraspPlan out_;
};

TwoHandSearch::TwoHandSearch(StepCheck& check, const TwoHandTask& task)
    : check_(check),
      load_(
          carried_load(check.object().mass(), task.T_world_start.linear(), check.settings().grip)),
      T_world_path_(carried_over(task, check.settings().lift)) {}

/// Finds the grasps of one arm. Returns false, and gives the reason in the plan, when there are
/// none.
bool TwoHandSearch::find_grasps(std::size_t a) {
  const RegraspArm& arm = check_.arms()[a];
  std::size_t firm = 0;
  for (std::size_t n = 0; n < arm.list->grasps.size(); ++n) {
    const Grasp& g = arm.list->grasps[n].grasp;
    if (bear_part({arm.hand_geometry, &g}, 0.5, load_, check_.settings().grip).margin <= 0)
      continue;
    ++firm;
    std::vector<Pose> T_root_tip;
    for (const Pose& T : T_world_path_)
      T_root_tip.push_back(check_.T_root_world() * T * g.T_object_hand);
    std::vector<CarriedMotion> found = carried_motions(
        check_.robot(), *arm.arm.arm, check_.robot().rest_configuration(), T_root_tip);
    if (found.empty()) continue;
    reached_[a].grasps.push_back(arm.list->grasps[n]);
    index_[a].push_back(n);
    sides_[a].rest_score.push_back(std::min(1.0, found.front().room));
    paths_[a][n] = std::move(found);
  }
  sides_[a].hand_geometry = arm.hand_geometry;
  sides_[a].list = &reached_[a];
  if (!index_[a].empty()) return true;
  const std::string all =
      "by none of " + std::to_string(firm > 0 ? firm : arm.list->grasps.size()) + " grasps ";
  out_.reason = firm > 0 ? all + "that bear half of it does " + arm.arm.name +
                               " follow it from its start to its goal"
                         : all + "do the fingers of " + arm.arm.name + " bear half of it";
  return false;
}

/// Returns the pairs of grasps that do not collide, the one with the largest margin first.
DoubleList TwoHandSearch::list_pairs(const std::function<bool()>& cancelled) const {
  DoubleSettings pairs;
  pairs.max_of_each = check_.settings().max_of_each;
  pairs.taken = Taken::spread;
  pairs.p_object_middle = check_.object().box().center();
  pairs.clearance = check_.settings().clearance;
  DoubleList doubles = list_double_grasps(sides_[0], sides_[1], pairs, cancelled);
  for (DoubleGrasp& d : doubles.grasps)
    d.first = index_[0][d.first], d.second = index_[1][d.second];
  for (DoubleGrasp& d : doubles.grasps) {
    const std::vector<LoadShare> shares = shares_of(d);
    d.score = std::min(shares[0].margin, shares[1].margin);
  }
  std::stable_sort(doubles.grasps.begin(), doubles.grasps.end(),
                   [](const DoubleGrasp& x, const DoubleGrasp& y) { return x.score > y.score; });
  return doubles;
}

std::vector<LoadShare> TwoHandSearch::shares_of(const DoubleGrasp& pair) const {
  return share_load({{check_.arms()[0].hand_geometry, &check_.grasp(0, pair.first)},
                     {check_.arms()[1].hand_geometry, &check_.grasp(1, pair.second)}},
                    check_.object().com(), load_, check_.settings().grip);
}

/// Returns the configurations at start and end of the path, on which both hands are closed on the
/// object and nothing collides.
std::optional<std::pair<Vector, Vector>> TwoHandSearch::both_along(const DoubleGrasp& pair,
                                                                   std::string& why) {
  const std::size_t i = pair.first, k = pair.second;
  const std::vector<CarriedMotion>&first = paths_[0].at(i), &second = paths_[1].at(k);
  why = "arms or hands would collide on the path";
  const auto at = [&](const CarriedMotion& x, const CarriedMotion& y, std::size_t n) {
    return check_.with(check_.with(check_.robot().rest_configuration(), 0, x.joints[n],
                                   check_.grasp(0, i).hand_joints),
                       1, y.joints[n], check_.grasp(1, k).hand_joints);
  };
  const std::size_t tried = check_.settings().motions_tried;  // of each arm
  for (std::size_t sum = 0; sum < 2 * tried - 1; ++sum) {
    for (std::size_t x = sum < tried ? 0 : sum - tried + 1; x <= std::min(sum, tried - 1); ++x) {
      if (x >= first.size() || sum - x >= second.size()) continue;
      const CarriedMotion &one = first[x], &other = second[sum - x];
      const auto free = [&](std::size_t n) {
        const Vector q = at(one, other, n);
        return check_.is_free(q) && check_.clear_of_object(q, T_world_path_[n], 0, 1);
      };
      bool whole = free(0) && free(T_world_path_.size() - 1);
      for (std::size_t n = 1; whole && n + 1 < T_world_path_.size(); ++n) whole = free(n);
      if (whole) return std::pair(at(one, other, 0), at(one, other, T_world_path_.size() - 1));
    }
  }
  return std::nullopt;
}

/// Returns the steps by which the pair takes the object along the path.
std::optional<std::vector<RegraspStep>> TwoHandSearch::check_pair(const DoubleGrasp& pair,
                                                                  std::string& why) {
  const std::size_t i = pair.first, k = pair.second;
  const Pose &T_start = T_world_path_.front(), &T_goal = T_world_path_.back();
  const auto ends = both_along(pair, why);
  if (!ends) return std::nullopt;
  const Vector &at_start = ends->first, &at_goal = ends->second;
  const auto opened = [&](const Vector& q, int arm, std::size_t n) {
    return RobotModel::with(q, *check_.arms()[static_cast<std::size_t>(arm)].arm.fingers,
                            check_.grasp(arm, n).pregrasp_joints);
  };
  const auto arm_of = [&](const Vector& q, int arm) {
    return RobotModel::part(q, *check_.arms()[static_cast<std::size_t>(arm)].arm.arm);
  };
  const auto off = [&](const Vector& q, const Pose& T, int arm, std::size_t n) {
    return check_.stand_off(arm, n, T, q, arm_of(q, arm));
  };
  RegraspStep first, second, down;
  const Manipulator& other = check_.arms()[1].arm;
  const Vector& rest = check_.robot().rest_configuration();
  const Vector alone = check_.with(at_start, 1, RobotModel::part(rest, *other.arm),
                                   RobotModel::part(rest, *other.fingers));
  const auto before_first = off(alone, T_start, 0, i);
  const auto before_second =
      before_first ? off(opened(at_start, 0, i), T_start, 1, k) : std::nullopt;
  const auto after_first = before_second ? off(opened(at_goal, 1, k), T_goal, 0, i) : std::nullopt;
  const auto after_second = after_first ? off(opened(at_goal, 0, i), T_goal, 1, k) : std::nullopt;
  if (!after_second) {
    why = "no straight path to or from it is free";
    return std::nullopt;
  }
  first.kind = RegraspStepKind::pick;
  first.to = 0;
  first.grasp_to = i;
  first.T_world_object = second.T_world_object = T_start;
  first.q = alone;
  first.before = *before_first;
  second.kind = RegraspStepKind::join;
  second.from = 0;
  second.to = 1;
  second.grasp_from = i;
  second.grasp_to = k;
  second.q = at_start;
  second.before = *before_second;
  down.kind = RegraspStepKind::place;
  down.from = 0;
  down.grasp_from = i;
  down.T_world_object = T_goal;
  down.q = at_goal;
  down.after = RobotModel::with(*after_first, *other.arm, arm_of(*after_second, 1));
  return std::vector<RegraspStep>{first, second, down};
}

RegraspPlan TwoHandSearch::run(const std::function<bool()>& cancelled) {
  for (std::size_t a = 0; a < 2; ++a)
    if (!find_grasps(a)) return std::move(out_);
  const DoubleList doubles = list_pairs(cancelled);
  out_.double_grasps = doubles.grasps.size();
  std::map<std::string, std::uint64_t> rejected;
  for (const DoubleGrasp& d : doubles.grasps) {
    const Vector3 between = check_.grasp(0, d.first).T_object_hand.translation() -
                            check_.grasp(1, d.second).T_object_hand.translation();
    if (between.norm() < check_.settings().min_apart) {
      ++rejected["the hands would be too near each other"];
      continue;
    }
    if (d.score <= 0) {
      ++rejected["the fingers would not bear it"];
      continue;
    }
    if (out_.checked >= check_.settings().max_pairs_tried || (cancelled && cancelled())) break;
    ++out_.checked;
    std::string why;
    auto steps = check_pair(d, why);
    if (steps) {
      out_.steps = std::move(*steps);
      out_.load_shares = shares_of(d);
      out_.solved = true;
      break;
    }
    ++rejected[why];
  }
  for (const auto& [what, times] : rejected)
    out_.rejected.push_back({std::to_string(times) + " pairs", what});
  for (Refusal& r : doubles.refusals()) out_.rejected.push_back(std::move(r));
  if (out_.solved) return std::move(out_);
  const auto most =
      std::max_element(rejected.begin(), rejected.end(),
                       [](const auto& x, const auto& y) { return x.second < y.second; });
  out_.reason = "no two grasps take it there together";
  if (most != rejected.end()) out_.reason += "; most often: " + most->first;
  return std::move(out_);
}

}  // namespace

RegraspPlan carry_together(StepCheck& check, const TwoHandTask& task,
                           const std::function<bool()>& cancelled) {
  if (check.arms().size() != 2)
    throw ConfigError("two hands at once need two arms, there is " +
                      std::to_string(check.arms().size()));
  return TwoHandSearch(check, task).run(cancelled);
}

}  // namespace handsel::grasp_planner
