#include "components/path_planner/cartesian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/model/srs_arm.hpp"
#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/search_space.hpp"
#include "components/path_planner/search/transition_test.hpp"

namespace handsel::path_planner {
namespace {

constexpr double kNearPi = 0.02;       // displacements this near to a turn by pi have no local path [rad]
constexpr double kSamePosture = 1e-4;  // [rad]
constexpr double kMotionStep = 0.005;  // states between two samples are judged this close [rad]
constexpr double kVerifyStep = 0.001;  // and on what is returned [rad]
constexpr int kAttempts = 3;           // the fine check may refuse what the coarse one let pass
constexpr int kBends = 24;             // postures tried on another branch
constexpr double kBendAway = 1.0;      // the last of them is up to this far from the start's, shoulder, elbow and wrist bent over [rad]
constexpr double kLeastBend = 0.2;     // [rad]
constexpr double kJointSample = 0.05;  // of a path of the joints [rad]
constexpr int kHalvings = 4;           // of a step before what the joints do is called a jump
constexpr double kInfinite = std::numeric_limits<double>::infinity();

double wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

class Space : public Budget {
 public:
  Space(const RobotModel& robot, CollisionWorld& world, const HumanCost& cost, const CartesianProblem& problem,
        const CartesianSettings& settings, const Hooks& hooks, const ik::Chain& chain, const ik::SrsArm& arm)
      : Budget(world, problem.budget, hooks),
        arm_group_(robot.require_group("arm")),
        world_(world),
        cost_(cost),
        problem_(problem),
        settings_(settings),
        chain_(chain),
        arm_(arm) {}

  const CartesianSettings& settings() const { return settings_; }
  bool concerns_people() const { return cost_.concerned(); }
  double cost(const Vector& q) const { return cost_.concerned() ? cost_(q) : 0.0; }
  bool free(const Vector& q) { return world_.is_free(q); }

  CartesianNode node_of(const Vector& q) const {
    ik::Axes joints = RobotModel::part(q, arm_group_);
    return {chain_.forward(joints, nullptr), arm_.elbow_angle(joints), q};
  }

  /// How many of shoulder, elbow and wrist are bent the other way: no way in active variables leads from one branch to another.
  int bends(const Vector& a, const Vector& b) const {
    constexpr double kStretched = 1e-3;
    int other = 0;
    for (const std::size_t middle : {1, 3, 5}) {
      const double x = a[arm_group_.axes[middle]], y = b[arm_group_.axes[middle]];
      other += x * y < 0 && std::min(std::abs(x), std::abs(y)) > kStretched;
    }
    return other;
  }
  bool same_branch(const Vector& a, const Vector& b) const { return bends(a, b) == 0; }

  /// Postures at a pose with this elbow angle, inside the limits; the other axes as in `all`.
  std::vector<Vector> postures(const Pose& T, double elbow, const Vector& all) {
    charge(1);
    std::vector<Vector> out;
    for (const ik::Axes& q : arm_.branches(T, elbow))
      if (const auto inside = arm_.turned_inside(q, 0.5 * (chain_.lower() + chain_.upper())))
        out.push_back(RobotModel::with(all, arm_group_, *inside));
    return out;
  }

  double distance(const CartesianNode& a, const CartesianNode& b) const {
    const double turn = Eigen::Quaterniond(a.T_root_tool.linear()).angularDistance(Eigen::Quaterniond(b.T_root_tool.linear()));
    const double elbow = settings_.elbow * wrapped(b.elbow - a.elbow);
    double sum = settings_.metre * settings_.metre * (a.T_root_tool.translation() - b.T_root_tool.translation()).squaredNorm() +
                 turn * turn + elbow * elbow;
    for (int axis : problem_.also) sum += (a.q[axis] - b.q[axis]) * (a.q[axis] - b.q[axis]);
    return std::sqrt(sum);
  }

  /// At a share of the local path: the displacement of the tool, one axis and an angle, and the angle of the elbow.
  struct Local {
    Vector3 move, turn_axis;
    double turn{}, elbow{};
  };
  std::optional<Local> local(const CartesianNode& a, const CartesianNode& b) const {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(a.T_root_tool.linear().transpose() * b.T_root_tool.linear()));
    if (turn.angle() > M_PI - kNearPi) return std::nullopt;
    return Local{b.T_root_tool.translation() - a.T_root_tool.translation(), turn.axis(), turn.angle(), wrapped(b.elbow - a.elbow)};
  }

  /// From a along the local path to b, up to `far` of it; where it ends before, how far it came. Joints go on from a's on their branch;
  /// every step is free. Samples are added when asked for.
  double follow(const CartesianNode& a, const CartesianNode& b, double far, CartesianNode& at, std::vector<Vector>* samples = nullptr) {
    at = a;
    const std::optional<Local> way = local(a, b);
    if (!way) return 0.0;
    const int steps = std::max(1, static_cast<int>(std::ceil(far * distance(a, b) / settings_.step)));
    double reached = 0;
    for (int k = 1; k <= steps; ++k) {
      const double to = far * k / steps;
      if (!advance(a, b, *way, reached, to, at, samples, 0)) return reached;
      reached = to;
    }
    return reached;
  }

 private:
  bool advance(const CartesianNode& a, const CartesianNode& b, const Local& way, double from, double to, CartesianNode& at,
               std::vector<Vector>* samples, int halved) {
    CartesianNode next;
    next.T_root_tool.linear() = a.T_root_tool.linear() * Eigen::AngleAxisd(to * way.turn, way.turn_axis).toRotationMatrix();
    next.T_root_tool.translation() = a.T_root_tool.translation() + to * way.move;
    next.elbow = wrapped(a.elbow + to * way.elbow);
    const Vector now = RobotModel::part(at.q, arm_group_);
    charge(1);
    const std::optional<ik::Axes> best = arm_.nearest(next.T_root_tool, next.elbow, now);
    if (!best) return false;
    if ((*best - now).lpNorm<Eigen::Infinity>() > settings_.largest_step) {
      if (halved == kHalvings) return false;
      const double middle = 0.5 * (from + to);
      return advance(a, b, way, from, middle, at, samples, halved + 1) && advance(a, b, way, middle, to, at, samples, halved + 1);
    }
    next.q = RobotModel::with(at.q, arm_group_, *best);
    for (int axis : problem_.also) next.q[axis] = a.q[axis] + to * (b.q[axis] - a.q[axis]);
    if (!world_.check_motion(at.q, next.q, kMotionStep).free) return false;
    at = next;
    if (samples != nullptr) samples->push_back(at.q);
    return true;
  }

  const Group& arm_group_;
  CollisionWorld& world_;
  const HumanCost& cost_;
  const CartesianProblem& problem_;
  const CartesianSettings& settings_;
  const ik::Chain& chain_;
  const ik::SrsArm& arm_;
};

struct TreeNode {
  CartesianNode at;
  int parent{-1};
  double cost{};
};
using Tree = std::vector<TreeNode>;

int nearest(const Space& space, const Tree& tree, const CartesianNode& to) {
  int best = 0;
  double least = kInfinite;
  for (int i = 0; i < static_cast<int>(tree.size()); ++i) {
    const double d = space.distance(tree[static_cast<std::size_t>(i)].at, to);
    if (d >= least) continue;
    least = d;
    best = i;
  }
  return best;
}

std::vector<CartesianNode> branch(const Tree& tree, int leaf) {
  std::vector<CartesianNode> out;
  for (int i = leaf; i >= 0; i = tree[static_cast<std::size_t>(i)].parent) out.push_back(tree[static_cast<std::size_t>(i)].at);
  return out;
}

class Search {
 public:
  Search(Space& space, const CartesianProblem& problem, Random& random, double reach, const Vector3& center)
      : space_(space),
        random_(random),
        accepts_(space.settings().initial_temperature, random_),
        problem_(problem),
        reach_(reach),
        center_(center) {}

  std::vector<CartesianNode> run(const CartesianNode& start, const std::vector<CartesianNode>& goals) {
    Tree trees[2];
    trees[0].push_back({start, -1, space_.cost(start.q)});
    for (const CartesianNode& goal : goals) trees[1].push_back({goal, -1, space_.cost(goal.q)});
    for (const CartesianNode& goal : goals)
      if (CartesianNode end; space_.follow(start, goal, 1.0, end) == 1.0 && same(end, goal) && !space_.concerns_people())
        return {start, goal};
    for (int round = 0; !space_.exhausted(); ++round) {
      space_.charge(1);
      const int grows = round % 2;
      Tree &tree = trees[grows], &other = trees[1 - grows];
      const CartesianNode target = random_.unit() < space_.settings().goal_bias
                                       ? other[static_cast<std::size_t>(random_.unit() * static_cast<double>(other.size()))].at
                                       : sample();
      const int added = extend(tree, nearest(space_, tree, target), target);
      if (added < 0) continue;
      const CartesianNode fresh = tree[static_cast<std::size_t>(added)].at;
      // Toward it from the other tree, as far as it goes.
      int at = nearest(space_, other, fresh);
      while (at >= 0 && !space_.exhausted()) {
        const int next = extend(other, at, fresh);
        if (next < 0) break;
        at = next;
        if (space_.distance(other[static_cast<std::size_t>(at)].at, fresh) > 1e-6) continue;
        if (!same(other[static_cast<std::size_t>(at)].at, fresh)) break;  // the same pose on another branch
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
  static bool same(const CartesianNode& a, const CartesianNode& b) { return (a.q - b.q).lpNorm<Eigen::Infinity>() < kSamePosture; }

  CartesianNode sample() {
    CartesianNode out;
    Vector3 p;
    do {
      p = Vector3(random_.between(-1, 1), random_.between(-1, 1), random_.between(-1, 1));
    } while (p.norm() > 1);
    const Eigen::Quaterniond turn = Eigen::Quaterniond(random_.normal(), random_.normal(), random_.normal(), random_.normal()).normalized();
    out.T_root_tool = make_pose(center_ + reach_ * p, turn);
    out.elbow = random_.between(-M_PI, M_PI);
    out.q = problem_.start;
    for (std::size_t i = 0; i < problem_.also.size(); ++i)
      out.q[problem_.also[i]] += random_.unit() * (problem_.also_goal[static_cast<Eigen::Index>(i)] - out.q[problem_.also[i]]);
    return out;
  }

  /// One edge of at most `range`, shorter where it is blocked; -1: none.
  int extend(Tree& tree, int near, const CartesianNode& target) {
    const CartesianNode from = tree[static_cast<std::size_t>(near)].at;
    const double far = space_.distance(from, target);
    if (far < 1e-9) return -1;
    CartesianNode at;
    const double share = std::min(1.0, space_.settings().range / far), reached = space_.follow(from, target, share, at);
    if (reached * far < 2 * space_.settings().step && reached < 1.0) return -1;
    const double cost = space_.cost(at.q);
    if (space_.concerns_people() && !accepts_(tree[static_cast<std::size_t>(near)].cost, cost)) return -1;
    tree.push_back({at, near, cost});
    return static_cast<int>(tree.size()) - 1;
  }

  Space& space_;
  Random& random_;
  TransitionTest accepts_;
  const CartesianProblem& problem_;
  double reach_;
  Vector3 center_;
};

double integral(const Space& space, const std::vector<Vector>& samples) {
  double sum = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    sum += space.cost(0.5 * (samples[i - 1] + samples[i])) * (samples[i] - samples[i - 1]).norm();
  return sum;
}

/// The samples of the local paths; empty when they no longer meet their nodes.
std::vector<Vector> samples_of(Space& space, const std::vector<CartesianNode>& nodes) {
  std::vector<Vector> out = {nodes.front().q};
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    CartesianNode end;
    if (space.follow(nodes[i - 1], nodes[i], 1.0, end, &out) < 1.0 || (end.q - nodes[i].q).lpNorm<Eigen::Infinity>() > kSamePosture)
      return {};
  }
  return out;
}

void shorten(Space& space, std::vector<CartesianNode>& nodes, Random& random) {
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
            integral(space, samples_of(space, {nodes.begin() + static_cast<long>(a), nodes.begin() + static_cast<long>(b) + 1})))
      continue;
    nodes.erase(nodes.begin() + static_cast<long>(a) + 1, nodes.begin() + static_cast<long>(b));
  }
}

bool verified(CollisionWorld& world, const std::vector<Vector>& samples) {
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (!world.check_motion(samples[i - 1], samples[i], kVerifyStep).free) return false;
  return !samples.empty();
}

/// Samples of a path of the joints from the start to a posture bent as the goal asks: through a stretched shoulder, elbow or wrist no local
/// path leads. Empty when none was found.
std::vector<Vector> other_branch(const RobotModel& robot, CollisionWorld& world, HumanCost& cost, const CartesianProblem& cartesian,
                                 const Group& arm, const Vector& like, std::uint64_t budget, Random& random, const Hooks& hooks) {
  Problem problem;
  problem.axes = arm.axes;
  problem.start = cartesian.start;
  problem.seed = random.bits();
  problem.budget = std::max<std::uint64_t>(1, budget);
  for (int k = 0; k < kBends; ++k) {
    Vector q = RobotModel::part(cartesian.start, arm);
    const double away = kBendAway * k / kBends;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Axis& axis = robot.axes()[static_cast<std::size_t>(arm.axes[static_cast<std::size_t>(i)])];
      const double wanted = like[arm.axes[static_cast<std::size_t>(i)]];
      const bool middle = i == 1 || i == 3 || i == 5;
      if (middle && q[i] * wanted < 0) q[i] = std::copysign(std::max(kLeastBend, std::abs(q[i])), wanted);
      const double moved = q[i] + away * random.between(-1, 1);
      q[i] = middle && moved * wanted < 0 ? q[i] : std::clamp(moved, axis.lower, axis.upper);
    }
    problem.goals.push_back(q);
  }
  Hooks quiet;
  quiet.cancelled = hooks.cancelled;
  const Result found = plan(robot, world, cost, problem, {}, quiet);
  std::vector<Vector> samples;
  for (std::size_t i = 1; i < found.path.size(); ++i) {
    const Vector along = found.path[i] - found.path[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(along.lpNorm<Eigen::Infinity>() / kJointSample)));
    for (int piece = i == 1 ? 0 : 1; piece <= pieces; ++piece)
      samples.push_back(RobotModel::with(cartesian.start, arm, found.path[i - 1] + (static_cast<double>(piece) / pieces) * along));
  }
  return samples;
}

}  // namespace

CartesianResult plan_cartesian(const RobotModel& robot, CollisionWorld& world, HumanCost& cost, const CartesianProblem& problem,
                               const CartesianSettings& settings, const Hooks& hooks) {
  CartesianResult result;
  const auto refuse = [&result](const std::string& why) {
    result.reason = why;
    return result;
  };
  if (problem.start.size() != robot.dof() || !problem.start.allFinite()) return refuse("the start is not a posture of all axes");
  if (problem.also_goal.size() != static_cast<Eigen::Index>(problem.also.size()))
    return refuse("the further axes and their goals do not match");
  if (!problem.T_root_goal.matrix().allFinite()) return refuse("the goal pose is not finite");
  if (problem.budget == 0) return refuse("the time limit is zero");
  const Group* group = robot.group("arm");
  if (group == nullptr) return refuse("the robot has no group \"arm\"");
  for (std::size_t i = 0; i < problem.also.size(); ++i) {
    const int axis = problem.also[i];
    if (axis < 0 || axis >= robot.dof() || std::count(group->axes.begin(), group->axes.end(), axis) > 0)
      return refuse("axis " + std::to_string(axis) + " cannot be active besides the arm");
    const double goal = problem.also_goal[static_cast<Eigen::Index>(i)];
    if (!(goal >= robot.axes()[static_cast<std::size_t>(axis)].lower && goal <= robot.axes()[static_cast<std::size_t>(axis)].upper))
      return refuse("the goal of axis " + robot.axes()[static_cast<std::size_t>(axis)].name + " is outside its limits");
  }
  const ik::Chain chain(robot, *group, problem.start);
  const auto arm = ik::SrsArm::recognise(chain);
  if (!arm) return refuse(ik::SrsArm::why_none(*group));
  std::vector<int> moving = group->axes;
  moving.insert(moving.end(), problem.also.begin(), problem.also.end());
  world.set_moving_axes(moving);
  cost.set_moving_axes(moving);
  Space space(robot, world, cost, problem, settings, hooks, chain, *arm);

  if (const CollisionVerdict verdict = world.check(problem.start); !verdict.free)
    return refuse("the start is in collision: " + verdict.first + " touches " + verdict.second);
  Vector at_goal = problem.start;
  for (std::size_t i = 0; i < problem.also.size(); ++i) at_goal[problem.also[i]] = problem.also_goal[static_cast<Eigen::Index>(i)];
  std::vector<std::vector<CartesianNode>> goals(1);  // by branch, that of the start first
  bool reachable = false;
  CollisionVerdict touched;
  for (int k = 0; k < settings.goal_elbows; ++k) {
    const double elbow = wrapped(2 * M_PI * k / settings.goal_elbows);
    for (const Vector& q : space.postures(problem.T_root_goal, elbow, at_goal)) {
      reachable = true;
      const CollisionVerdict verdict = world.check(q);
      if (!verdict.free) {
        if (touched.free) touched = verdict;
        continue;
      }
      std::size_t branch = 0;
      if (!space.same_branch(problem.start, q))
        for (branch = 1; branch < goals.size() && !space.same_branch(goals[branch].front().q, q);) ++branch;
      if (branch == goals.size()) goals.emplace_back();
      goals[branch].push_back({problem.T_root_goal, elbow, q});
    }
  }
  if (!reachable) return refuse("no posture of the arm has the tool at the goal");
  if (goals.size() == 1 && goals[0].empty())
    return refuse("every posture at the goal is in collision, the first: " + touched.first + " touches " + touched.second);
  std::stable_sort(goals.begin() + 1, goals.end(),
                   [&](const auto& a, const auto& b) { return space.bends(problem.start, a[0].q) < space.bends(problem.start, b[0].q); });

  Random random(problem.seed);
  const Vector3 shoulder = chain.elements().front().T_before.translation();
  const auto lead = [&](const CartesianNode& start, const std::vector<CartesianNode>& ends) {
    const double reach =
        std::max((start.T_root_tool.translation() - shoulder).norm(), (problem.T_root_goal.translation() - shoulder).norm()) + 0.2;
    for (int attempt = 0; attempt < kAttempts && !space.exhausted(); ++attempt) {
      const std::vector<CartesianNode> found = Search(space, problem, random, reach, shoulder).run(start, ends);
      if (found.empty()) return false;
      result.nodes = found;
      shorten(space, result.nodes, random);
      for (const bool shortened : {true, false}) {
        if (!shortened) result.nodes = found;
        result.samples = samples_of(space, result.nodes);
        if (verified(world, result.samples)) return true;
      }
    }
    return false;
  };
  bool sound = false;
  for (std::size_t branch = 0; branch < goals.size() && !sound && !space.cancelled(); ++branch) {
    const double left = static_cast<double>(problem.budget - std::min(problem.budget, space.checks()));
    const auto parts = static_cast<double>(branch == 0 ? std::min<std::size_t>(2, goals.size()) : goals.size() - branch);
    const auto share = static_cast<std::uint64_t>(left / parts);
    if (goals[branch].empty()) continue;
    space.limit(space.checks() + share);
    if (branch == 0) {
      sound = lead(space.node_of(problem.start), goals[0]);
      continue;
    }
    const std::vector<Vector> bridge = other_branch(robot, world, cost, problem, *group, goals[branch].front().q, share / 3, random, hooks);
    world.set_moving_axes(moving);
    cost.set_moving_axes(moving);
    if (bridge.empty() || !lead(space.node_of(bridge.back()), goals[branch])) continue;
    sound = true;
    result.in_joints = bridge.size() - 1;
    result.nodes.insert(result.nodes.begin(), space.node_of(problem.start));
    result.samples.insert(result.samples.begin(), bridge.begin(), bridge.end() - 1);
  }
  result.checks = space.checks();
  if (!sound) {
    result.nodes.clear();
    result.samples.clear();
    result.cancelled = space.cancelled();
    return refuse(result.cancelled ? "cancelled" : "no path within " + std::to_string(problem.budget) + " checks");
  }
  result.cost = integral(space, result.samples);
  for (std::size_t i = 1; i < result.samples.size(); ++i)
    result.work += std::max(0.0, space.cost(result.samples[i]) - space.cost(result.samples[i - 1]));
  result.length = path_length(result.samples);
  result.solved = true;
  return result;
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
