// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/cartesian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/srs_arm.hpp"
#include "components/path_planner/cartesian_space.hpp"
#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/search_space.hpp"
#include "components/path_planner/search/transition_test.hpp"

namespace handsel::path_planner {
namespace {

constexpr double kSameConfiguration = 1e-4;  // max difference of equal configurations [rad]
constexpr double kVerifyStep = 0.001;        // step of the check of the returned path [rad]
constexpr double kJointSample = 0.05;        // step of the samples of a joint-space path [rad]
constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct TreeNode {
  CartesianNode at;
  int parent{-1};
  double cost{};
};
using Tree = std::vector<TreeNode>;

int nearest(const CartesianSpace& space, const Tree& tree, const CartesianNode& to) {
  int best = 0;
  double min_distance = kInfinite;
  for (int i = 0; i < static_cast<int>(tree.size()); ++i) {
    const double d = space.distance(tree[static_cast<std::size_t>(i)].at, to);
    if (d >= min_distance) continue;
    min_distance = d;
    best = i;
  }
  return best;
}

std::vector<CartesianNode> branch(const Tree& tree, int leaf) {
  std::vector<CartesianNode> out;
  for (int i = leaf; i >= 0; i = tree[static_cast<std::size_t>(i)].parent)
    out.push_back(tree[static_cast<std::size_t>(i)].at);
  return out;
}

class Search {
 public:
  Search(CartesianSpace& space, const CartesianProblem& problem, Random& random, double reach,
         const Vector3& center)
      : space_(space),
        random_(random),
        accepts_({space.settings().initial_temperature, space.settings().temperature_factor,
                  space.settings().max_refusals},
                 random_),
        problem_(problem),
        reach_(reach),
        center_(center) {}

  std::vector<CartesianNode> run(const CartesianNode& start,
                                 const std::vector<CartesianNode>& goals) {
    Tree trees[2];
    trees[0].push_back({start, -1, space_.cost(start.q)});
    for (const CartesianNode& goal : goals) trees[1].push_back({goal, -1, space_.cost(goal.q)});
    for (const CartesianNode& goal : goals)
      if (CartesianNode end; space_.follow(start, goal, 1.0, end) == 1.0 && same(end, goal) &&
                             !space_.concerns_people())
        return {start, goal};
    for (int round = 0; !space_.exhausted(); ++round) {
      space_.charge(1);
      const int grows = round % 2;
      Tree &tree = trees[grows], &other = trees[1 - grows];
      const CartesianNode target =
          random_.unit() < space_.settings().goal_bias
              ? other[static_cast<std::size_t>(random_.unit() * static_cast<double>(other.size()))]
                    .at
              : sample();
      const int added = extend(tree, nearest(space_, tree, target), target);
      if (added < 0) continue;
      const CartesianNode added_node = tree[static_cast<std::size_t>(added)].at;
      // Extends the other tree toward the new node as far as possible.
      int at = nearest(space_, other, added_node);
      while (at >= 0 && !space_.exhausted()) {
        const int next = extend(other, at, added_node);
        if (next < 0) break;
        at = next;
        if (space_.distance(other[static_cast<std::size_t>(at)].at, added_node) > 1e-6) continue;
        if (!same(other[static_cast<std::size_t>(at)].at, added_node))
          break;  // the same pose on another branch
        std::vector<CartesianNode> path = branch(trees[0], grows == 0 ? added : at);
        std::reverse(path.begin(), path.end());
        const std::vector<CartesianNode> rest = branch(trees[1], grows == 0 ? at : added);
        path.insert(path.end(), rest.begin() + 1, rest.end());
        return path;
      }
    }
    return {};
  }

 private:
  static bool same(const CartesianNode& a, const CartesianNode& b) {
    return (a.q - b.q).lpNorm<Eigen::Infinity>() < kSameConfiguration;
  }

  CartesianNode sample() {
    CartesianNode out;
    Vector3 p;
    do {
      p = Vector3(random_.between(-1, 1), random_.between(-1, 1), random_.between(-1, 1));
    } while (p.norm() > 1);
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(random_.normal(), random_.normal(), random_.normal(), random_.normal())
            .normalized();
    out.T_root_tool = make_pose(center_ + reach_ * p, turn);
    out.elbow = random_.between(-M_PI, M_PI);
    out.q = problem_.start;
    for (std::size_t i = 0; i < problem_.also.size(); ++i)
      out.q[problem_.also[i]] +=
          random_.unit() *
          (problem_.also_goal[static_cast<Eigen::Index>(i)] - out.q[problem_.also[i]]);
    return out;
  }

  /// Adds one edge of at most `range`, shorter if blocked; returns the new node; -1: none.
  int extend(Tree& tree, int near, const CartesianNode& target) {
    const CartesianNode from = tree[static_cast<std::size_t>(near)].at;
    const double far = space_.distance(from, target);
    if (far < 1e-9) return -1;
    CartesianNode at;
    const double part = std::min(1.0, space_.settings().range / far);
    const double reached = space_.follow(from, target, part, at);
    if (reached * far < 2 * space_.settings().step && reached < 1.0) return -1;
    const double cost = space_.cost(at.q);
    if (space_.concerns_people() && !accepts_(tree[static_cast<std::size_t>(near)].cost, cost))
      return -1;
    tree.push_back({at, near, cost});
    return static_cast<int>(tree.size()) - 1;
  }

  CartesianSpace& space_;
  Random& random_;
  TransitionTest accepts_;
  const CartesianProblem& problem_;
  double reach_;
  Vector3 center_;
};

double integral(const CartesianSpace& space, const std::vector<Vector>& samples) {
  double sum = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    sum += space.cost(0.5 * (samples[i - 1] + samples[i])) * (samples[i] - samples[i - 1]).norm();
  return sum;
}

/// Returns the samples along the path segments; empty if they do not reach the nodes.
std::vector<Vector> samples_of(CartesianSpace& space, const std::vector<CartesianNode>& nodes) {
  std::vector<Vector> out = {nodes.front().q};
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    CartesianNode end;
    if (space.follow(nodes[i - 1], nodes[i], 1.0, end, &out) < 1.0 ||
        (end.q - nodes[i].q).lpNorm<Eigen::Infinity>() > kSameConfiguration)
      return {};
  }
  return out;
}

void shorten(CartesianSpace& space, std::vector<CartesianNode>& nodes, Random& random) {
  for (int k = 0; k < space.settings().shortcuts && nodes.size() > 2 && !space.exhausted(); ++k) {
    std::size_t a = static_cast<std::size_t>(random.unit() * static_cast<double>(nodes.size())),
                b = static_cast<std::size_t>(random.unit() * static_cast<double>(nodes.size()));
    if (a > b) std::swap(a, b);
    if (b - a < 2) continue;
    const std::vector<CartesianNode> direct = {nodes[a], nodes[b]};
    const std::vector<Vector> samples = samples_of(space, direct);
    if (samples.empty()) continue;
    if (space.concerns_people() &&
        integral(space, samples) >=
            integral(space, samples_of(space, {nodes.begin() + static_cast<long>(a),
                                               nodes.begin() + static_cast<long>(b) + 1})))
      continue;
    nodes.erase(nodes.begin() + static_cast<long>(a) + 1, nodes.begin() + static_cast<long>(b));
  }
}

bool verified(CollisionWorld& world, const std::vector<Vector>& samples) {
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (!world.check_motion(samples[i - 1], samples[i], kVerifyStep).free) return false;
  return !samples.empty();
}

/// Returns samples of a joint-space path from the start to a configuration on the branch of `like`,
/// because no path segment passes a stretched shoulder, elbow or wrist; empty if none was found.
std::vector<Vector> other_branch(const PlanningModels& models, const CartesianProblem& cartesian,
                                 const CartesianSettings& settings, const Vector& like,
                                 Random& random, const Hooks& hooks) {
  const Group& arm = models.robot.require_group("arm");
  Problem problem;
  problem.axes = arm.axes;
  problem.start = cartesian.start;
  problem.seed = random.bits();
  problem.budget = std::max<std::uint64_t>(1, cartesian.budget);
  for (int k = 0; k < settings.branch_goals; ++k) {
    Vector q = RobotModel::part(cartesian.start, arm);
    const double offset = settings.max_branch_offset * k / settings.branch_goals;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Axis& axis =
          models.robot.axes()[static_cast<std::size_t>(arm.axes[static_cast<std::size_t>(i)])];
      const double q_like = like[arm.axes[static_cast<std::size_t>(i)]];
      const bool middle = i == 1 || i == 3 || i == 5;
      if (middle && q[i] * q_like < 0)
        q[i] = std::copysign(std::max(settings.min_bend, std::abs(q[i])), q_like);
      const double moved = q[i] + offset * random.between(-1, 1);
      q[i] = middle && moved * q_like < 0 ? q[i] : std::clamp(moved, axis.lower, axis.upper);
    }
    problem.goals.push_back(q);
  }
  Hooks quiet;
  quiet.cancelled = hooks.cancelled;
  const Result found = plan(models.robot, models.world, models.cost, problem, {}, quiet);
  std::vector<Vector> samples;
  for (std::size_t i = 1; i < found.path.size(); ++i) {
    const Vector along = found.path[i] - found.path[i - 1];
    const int pieces =
        std::max(1, static_cast<int>(std::ceil(along.lpNorm<Eigen::Infinity>() / kJointSample)));
    for (int piece = i == 1 ? 0 : 1; piece <= pieces; ++piece)
      samples.push_back(RobotModel::with(
          cartesian.start, arm, found.path[i - 1] + (static_cast<double>(piece) / pieces) * along));
  }
  return samples;
}

/// Returns why the problem is invalid, one sentence; empty: valid.
std::string contradiction(const RobotModel& robot, const CartesianProblem& problem) {
  if (problem.start.size() != robot.dof() || !problem.start.allFinite())
    return "the start is not a configuration of all axes";
  if (problem.also_goal.size() != static_cast<Eigen::Index>(problem.also.size()))
    return "the further axes and their goals do not match";
  if (!problem.T_root_goal.matrix().allFinite()) return "the goal pose is not finite";
  if (problem.budget == 0) return "the time limit is zero";
  const Group* group = robot.group("arm");
  if (group == nullptr) return "the robot has no group \"arm\"";
  for (std::size_t i = 0; i < problem.also.size(); ++i) {
    const int axis = problem.also[i];
    if (axis < 0 || axis >= robot.dof() ||
        std::count(group->axes.begin(), group->axes.end(), axis) > 0)
      return "axis " + std::to_string(axis) + " cannot be active besides the arm";
    const double goal = problem.also_goal[static_cast<Eigen::Index>(i)];
    const Axis& limits = robot.axes()[static_cast<std::size_t>(axis)];
    if (!(goal >= limits.lower && goal <= limits.upper))
      return "the goal of axis " + limits.name + " is outside its limits";
  }
  return {};
}

/// Plans one problem: groups the goals by branch, then searches branch by branch.
class CartesianPlanning {
 public:
  CartesianPlanning(CartesianSpace& space, const PlanningModels& models,
                    const CartesianProblem& problem, const Hooks& hooks, const Vector3& shoulder)
      : space_(space),
        models_(models),
        problem_(problem),
        hooks_(hooks),
        shoulder_(shoulder),
        random_(problem.seed) {
    moving_ = space.arm().group().axes;
    moving_.insert(moving_.end(), problem.also.begin(), problem.also.end());
  }

  CartesianResult run() {
    set_moving_axes();
    if (const CollisionVerdict verdict = models_.world.check(problem_.start); !verdict.free)
      return refuse("the start is in collision: " + verdict.first + " touches " + verdict.second);
    if (const std::string why = find_goals(); !why.empty()) return refuse(why);
    const bool sound = search_branches();
    result_.checks = space_.checks();
    if (!sound) {
      result_.nodes.clear();
      result_.samples.clear();
      result_.cancelled = space_.cancelled();
      return refuse(result_.cancelled
                        ? "cancelled"
                        : "no path within " + std::to_string(problem_.budget) + " checks");
    }
    result_.cost = integral(space_, result_.samples);
    for (std::size_t i = 1; i < result_.samples.size(); ++i)
      result_.work +=
          std::max(0.0, space_.cost(result_.samples[i]) - space_.cost(result_.samples[i - 1]));
    result_.length = path_length(result_.samples);
    result_.solved = true;
    return result_;
  }

 private:
  CartesianResult refuse(const std::string& why) {
    result_.reason = why;
    return result_;
  }

  void set_moving_axes() {
    models_.world.set_moving_axes(moving_);
    models_.cost.set_moving_axes(moving_);
  }

  /// Writes goals_; returns why there are none, one sentence; empty: goals exist.
  std::string find_goals() {
    const ArmKinematics& arm = space_.arm();
    Vector at_goal = problem_.start;
    for (std::size_t i = 0; i < problem_.also.size(); ++i)
      at_goal[problem_.also[i]] = problem_.also_goal[static_cast<Eigen::Index>(i)];
    bool reachable = false;
    CollisionVerdict touched;
    const int elbows = space_.settings().goal_elbows;
    for (int k = 0; k < elbows; ++k) {
      const double elbow = wrapped(2 * M_PI * k / elbows);
      for (const Vector& q : space_.configurations(problem_.T_root_goal, elbow, at_goal)) {
        reachable = true;
        const CollisionVerdict verdict = models_.world.check(q);
        if (!verdict.free) {
          if (touched.free) touched = verdict;
          continue;
        }
        std::size_t branch = 0;
        if (!arm.same_branch(problem_.start, q))
          for (branch = 1; branch < goals_.size() && !arm.same_branch(goals_[branch].front().q, q);)
            ++branch;
        if (branch == goals_.size()) goals_.emplace_back();
        goals_[branch].push_back({problem_.T_root_goal, elbow, q});
      }
    }
    if (!reachable) return "no configuration of the arm has the tool at the goal";
    if (goals_.size() == 1 && goals_[0].empty())
      return "every configuration at the goal is in collision, the first: " + touched.first +
             " touches " + touched.second;
    std::stable_sort(goals_.begin() + 1, goals_.end(), [&](const auto& a, const auto& b) {
      return arm.bends(problem_.start, a[0].q) < arm.bends(problem_.start, b[0].q);
    });
    return {};
  }

  /// Searches branch by branch, each with a part of the remaining checks.
  bool search_branches() {
    bool sound = false;
    for (std::size_t branch = 0; branch < goals_.size() && !sound && !space_.cancelled();
         ++branch) {
      const double left =
          static_cast<double>(problem_.budget - std::min(problem_.budget, space_.checks()));
      const auto parts = static_cast<double>(branch == 0 ? std::min<std::size_t>(2, goals_.size())
                                                         : goals_.size() - branch);
      const auto checks = static_cast<std::uint64_t>(left / parts);
      if (goals_[branch].empty()) continue;
      space_.limit(space_.checks() + checks);
      sound = branch == 0 ? search(space_.arm().node_of(problem_.start), goals_[0])
                          : change_branch(goals_[branch], checks);
    }
    return sound;
  }

  /// Changes to the branch of `ends` in joint space, then searches on this branch.
  bool change_branch(const std::vector<CartesianNode>& ends, std::uint64_t checks) {
    const ArmKinematics& arm = space_.arm();
    CartesianProblem to_branch = problem_;
    to_branch.budget = checks / 3;
    const std::vector<Vector> bridge =
        other_branch(models_, to_branch, space_.settings(), ends.front().q, random_, hooks_);
    set_moving_axes();
    if (bridge.empty() || !search(arm.node_of(bridge.back()), ends)) return false;
    result_.in_joints = bridge.size() - 1;
    result_.nodes.insert(result_.nodes.begin(), arm.node_of(problem_.start));
    result_.samples.insert(result_.samples.begin(), bridge.begin(), bridge.end() - 1);
    return true;
  }

  /// Writes nodes and samples of a path on one branch to the result.
  bool search(const CartesianNode& start, const std::vector<CartesianNode>& ends) {
    const double reach = std::max((start.T_root_tool.translation() - shoulder_).norm(),
                                  (problem_.T_root_goal.translation() - shoulder_).norm()) +
                         0.2;
    for (int attempt = 0; attempt < space_.settings().attempts && !space_.exhausted(); ++attempt) {
      const std::vector<CartesianNode> found =
          Search(space_, problem_, random_, reach, shoulder_).run(start, ends);
      if (found.empty()) return false;
      result_.nodes = found;
      shorten(space_, result_.nodes, random_);
      for (const bool shortened : {true, false}) {
        if (!shortened) result_.nodes = found;
        result_.samples = samples_of(space_, result_.nodes);
        if (verified(models_.world, result_.samples)) return true;
      }
    }
    return false;
  }

  CartesianSpace& space_;
  const PlanningModels& models_;
  const CartesianProblem& problem_;
  const Hooks& hooks_;
  Vector3 shoulder_;
  Random random_;
  std::vector<int> moving_;
  std::vector<std::vector<CartesianNode>> goals_{1};  // by branch, the branch of the start first
  CartesianResult result_;
};

}  // namespace

CartesianResult plan_cartesian(const RobotModel& robot, CollisionWorld& world, HumanCost& cost,
                               const CartesianProblem& problem, const CartesianSettings& settings,
                               const Hooks& hooks) {
  CartesianResult refused;
  refused.reason = contradiction(robot, problem);
  if (!refused.reason.empty()) return refused;
  const Group& group = robot.require_group("arm");
  const ik::Chain chain(robot, group, problem.start);
  const auto arm = ik::SrsArm::recognise(chain);
  if (!arm) {
    refused.reason = ik::SrsArm::why_none(group);
    return refused;
  }
  const PlanningModels models{robot, world, cost};
  const ArmKinematics kinematics(group, chain, *arm);
  CartesianSpace space(models, problem, settings, hooks, kinematics);
  const Vector3 shoulder = chain.elements().front().T_before.translation();
  return CartesianPlanning(space, models, problem, hooks, shoulder).run();
}

Result in_joints(const CartesianResult& found, const std::vector<int>& axes) {
  Result out;
  out.solved = found.solved;
  out.cancelled = found.cancelled;
  out.reason = found.reason;
  out.cost = found.cost;
  out.work = found.work;
  out.length = found.length;
  out.checks = found.checks;
  out.planner = "cartesian";
  for (const Vector& sample : found.samples) out.path.push_back(sample(axes));
  return out;
}

}  // namespace handsel::path_planner
