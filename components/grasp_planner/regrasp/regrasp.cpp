#include "components/grasp_planner/regrasp/regrasp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <queue>
#include <set>
#include <tuple>

#include "components/grasp_planner/list/so3_grid.hpp"
#include "components/grasp_planner/pair/carried_way.hpp"
#include "components/grasp_planner/pair/retreat.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kQualityShare = 0.01;    // of a step: grasps decide between sequences of equal length
constexpr double kWeakShare = 0.05;       // likewise that a squeeze does not hold whichever way the load pulls
constexpr double kWeakest = 10;           // below a margin of less than this all are alike [N]
constexpr double kLargestApproach = 0.9;  // [rad] an arm axis moves less on a straight way
constexpr double kWayStep = 0.03;         // [m] between the poses at which what two hands carry is looked at
constexpr std::size_t kWaysTried = 5;     // of each arm
constexpr double kMotionStep = 0.04;      // [rad]
constexpr double kWayClearance = 0.005;   // [m] between an opened hand and the object

using Steps = std::vector<std::vector<Pose>>;

/// A node of the search: the object held, or standing in one of the task's places.
struct Node {
  int arm{-1};
  std::size_t index{};  // of the grasp, or of the place
  auto operator<=>(const Node&) const = default;
};

struct Judged {
  std::optional<RegraspStep> step;
  std::string reason;
};

}  // namespace

const char* name(RegraspStepKind kind) {
  switch (kind) {
    case RegraspStepKind::pick:
      return "pick";
    case RegraspStepKind::pass:
      return "pass";
    case RegraspStepKind::place:
      return "place";
    case RegraspStepKind::join:
      return "join";
  }
  return "unknown";
}

struct RegraspPlanner::Impl {
  Impl(const RobotModel& r, std::vector<RegraspArm> a, const Graspable& o, ObjectLibrary library, const Scene& s, const std::string& id,
       const RegraspSettings& t)
      : robot(r), arms(std::move(a)), object(o), settings(t), T_root_world(s.T_world_base.inverse()), world(r, std::move(library)) {
    if (arms.empty() || arms.size() > 2) throw ConfigError("a regrasp needs one or two arms, not " + std::to_string(arms.size()));
    Scene around = s;
    std::erase_if(around.objects, [&](const SceneObject& x) { return x.id == id; });
    world.set_base(s.T_world_base);
    world.set_scene(around);
    boxes = s.boxes;
    T_world_base = s.T_world_base;
    hand_of.assign(robot.links().size(), -1);
    for (std::size_t l = 0; l < robot.links().size(); ++l) {
      const int joint = robot.links()[l].parent_joint;
      if (joint >= 0) hand_of[l] = hand_of[static_cast<std::size_t>(robot.joints()[static_cast<std::size_t>(joint)].parent)];
      for (std::size_t k = 0; k < arms.size(); ++k)
        if (static_cast<int>(l) == arms[k].arm.palm) hand_of[l] = static_cast<int>(k);
      for (const PlacedShape& p : robot.links()[l].collision)
        shapes.push_back({static_cast<int>(l), CollisionShape::make(p.shape), p.T_parent_shape});
    }
    ways.reserve(arms.size());
    for (const RegraspArm& x : arms) ways.push_back(retreat_directions(x.kit->hand));
  }

  const Grasp& grasp(int arm, std::size_t i) const { return arms[static_cast<std::size_t>(arm)].list->grasps[i].grasp; }

  Vector with(const Vector& q, int arm, const Vector& arm_q, const Vector& hand_q) const {
    const Manipulator& m = arms[static_cast<std::size_t>(arm)].arm;
    return RobotModel::with(RobotModel::with(q, *m.arm, arm_q), *m.fingers, hand_q);
  }

  std::optional<Vector> reach(int arm, const Pose& T_world_hand, const Vector& seed, int restarts) const {
    IkOptions options;
    options.max_iterations = 80;
    options.restarts = restarts;
    return robot.inverse(*arms[static_cast<std::size_t>(arm)].arm.arm, T_root_world * T_world_hand, seed, options);
  }

  /// All of the robot but the hands named stays off the object.
  bool clear_of_object(const Vector& q, const Pose& T_world_object, int holding, int other = -1) {
    robot.forward(q, T_root_link);
    for (const auto& [link, shape, T_link_shape] : shapes) {
      const int hand = hand_of[static_cast<std::size_t>(link)];
      if (hand >= 0 && (hand == holding || hand == other)) continue;
      if (touch(*shape, T_world_base * T_root_link[static_cast<std::size_t>(link)] * T_link_shape, *object.shape(), T_world_object))
        return false;
    }
    return true;
  }

  bool object_in_furniture(const Pose& T_world_object) const {
    return std::any_of(boxes.begin(), boxes.end(), [&](const SceneBox& b) {
      return touch(*CollisionShape::make(Box{b.size}), b.T_world_box, *object.shape(), T_world_object);
    });
  }

  /// The hand, opened, from its stand-off along `way` to the grasp; the other axes as in `q`. The stand-off's axes.
  std::optional<Vector> straight(int arm, std::size_t i, const Pose& T_world_object, const Vector& q, const Vector& arm_q,
                                 const Vector3& way) {
    Pose T = T_world_object * grasp(arm, i).T_object_hand;
    T.translate(Vector3(settings.stand_off * way));
    const auto off = reach(arm, T, q, 0);
    if (!off || (*off - arm_q).cwiseAbs().maxCoeff() > kLargestApproach) return std::nullopt;
    const Vector opened = grasp(arm, i).pregrasp_joints, from = with(q, arm, *off, opened), to = with(q, arm, arm_q, opened);
    if (!world.check_motion(from, to, kMotionStep).free) return std::nullopt;
    // A straight line of the joints bends in space.
    for (const double share : {0.25, 0.5, 0.75, 0.9})
      if (!clear_of_object(from + share * (to - from), T_world_object, 1 - arm)) return std::nullopt;
    return from;
  }

  /// Taking the object up from where it stands, or, backwards, putting it down there.
  Judged judge_pick(int arm, std::size_t i, const Pose& T_world_object) {
    const Grasp& g = grasp(arm, i);
    const Pose T_world_hand = T_world_object * g.T_object_hand;
    const Vector& rest = robot.rest_posture();
    const auto arm_q = reach(arm, T_world_hand, rest, 2);
    if (!arm_q) return {{}, "no posture of the arm reaches it"};
    RegraspStep step;
    step.T_world_object = T_world_object;
    step.q = with(rest, arm, *arm_q, g.hand_joints);
    const Vector opened = with(rest, arm, *arm_q, g.pregrasp_joints);
    if (!world.is_free(step.q) || !world.is_free(opened) || !clear_of_object(step.q, T_world_object, arm))
      return {{}, "arm or hand would collide"};
    Pose T_lifted = T_world_hand;
    T_lifted.translation().z() += settings.lift;
    const auto lifted = reach(arm, T_lifted, step.q, 0);
    if (!lifted || (*lifted - *arm_q).cwiseAbs().maxCoeff() > kLargestApproach || !world.is_free(with(rest, arm, *lifted, g.hand_joints)))
      return {{}, "the arm could not lift it straight up"};
    if (auto off = stand_off(arm, i, T_world_object, opened, *arm_q)) {
      step.before = step.after = std::move(*off);
      return {std::move(step), ""};
    }
    return {{}, "no straight way to or from it is free"};
  }

  /// Where the hand, opened, stands off the object before it comes, or after it went; the other axes as in `q`.
  std::optional<Vector> stand_off(int arm, std::size_t i, const Pose& T_world_object, const Vector& q, const Vector& arm_q) {
    const Grasp& g = grasp(arm, i);
    Steps T_open;
    const HandKit& kit = *arms[static_cast<std::size_t>(arm)].kit;
    kit.forward(g.pregrasp_joints, T_open);
    std::vector<Vector3> all = ways[static_cast<std::size_t>(arm)];
    all.push_back((T_world_object * g.T_object_hand).linear().transpose() * Vector3::UnitZ());
    for (const Vector3& way : all) {
      if (!retreat_free(kit, T_open, object, g.T_object_hand,
                        {way, settings.stand_off, kWayClearance}))
        continue;
      if (auto off = straight(arm, i, T_world_object, q, arm_q, way)) return off;
    }
    return std::nullopt;
  }

  /// Both arms with their hands closed on the object along the way: postures at its start and at its end.
  std::optional<std::pair<Vector, Vector>> both_along(std::size_t i, std::size_t k, const std::vector<Pose>& T_world_way,
                                                      const std::vector<CarriedWay>& first, const std::vector<CarriedWay>& second,
                                                      std::string& why) {
    why = "arms or hands would collide on the way";
    const auto at = [&](const CarriedWay& x, const CarriedWay& y, std::size_t n) {
      return with(with(robot.rest_posture(), 0, x.joints[n], grasp(0, i).hand_joints), 1, y.joints[n], grasp(1, k).hand_joints);
    };
    for (std::size_t sum = 0; sum < 2 * kWaysTried - 1; ++sum) {
      for (std::size_t x = sum < kWaysTried ? 0 : sum - kWaysTried + 1; x <= std::min(sum, kWaysTried - 1); ++x) {
        if (x >= first.size() || sum - x >= second.size()) continue;
        const CarriedWay &one = first[x], &other = second[sum - x];
        const auto free = [&](std::size_t n) {
          const Vector q = at(one, other, n);
          return world.is_free(q) && clear_of_object(q, T_world_way[n], 0, 1);
        };
        bool whole = free(0) && free(T_world_way.size() - 1);
        for (std::size_t n = 1; whole && n + 1 < T_world_way.size(); ++n) whole = free(n);
        if (whole) return std::pair(at(one, other, 0), at(one, other, T_world_way.size() - 1));
      }
    }
    return std::nullopt;
  }

  /// Up, over and down.
  std::vector<Pose> carried_over(const Pose& T_start, const Pose& T_goal) const {
    const auto raised = [&](Pose T) {
      T.translation().z() += settings.lift;
      return T;
    };
    return way_of_object({T_start, raised(T_start), raised(T_goal), T_goal}, kWayStep);
  }

  /// Two hands at once along the way, on which each arm by itself has these postures.
  std::optional<std::vector<RegraspStep>> judge_together(std::size_t i, std::size_t k, const std::vector<Pose>& T_world_way,
                                                         const std::vector<CarriedWay>& first_ways,
                                                         const std::vector<CarriedWay>& second_ways, std::string& why) {
    const Pose &T_start = T_world_way.front(), &T_goal = T_world_way.back();
    const auto ends = both_along(i, k, T_world_way, first_ways, second_ways, why);
    if (!ends) return std::nullopt;
    const Vector &at_start = ends->first, &at_goal = ends->second;
    const auto opened = [&](const Vector& q, int arm, std::size_t n) {
      return RobotModel::with(q, *arms[static_cast<std::size_t>(arm)].arm.fingers, grasp(arm, n).pregrasp_joints);
    };
    const auto arm_of = [&](const Vector& q, int arm) { return RobotModel::part(q, *arms[static_cast<std::size_t>(arm)].arm.arm); };
    const auto off = [&](const Vector& q, const Pose& T, int arm, std::size_t n) { return stand_off(arm, n, T, q, arm_of(q, arm)); };
    RegraspStep first, second, down;
    const Manipulator& other = arms[1].arm;
    const Vector& rest = robot.rest_posture();
    const Vector alone = with(at_start, 1, RobotModel::part(rest, *other.arm), RobotModel::part(rest, *other.fingers));
    const auto before_first = off(alone, T_start, 0, i);
    const auto before_second = before_first ? off(opened(at_start, 0, i), T_start, 1, k) : std::nullopt;
    const auto after_first = before_second ? off(opened(at_goal, 1, k), T_goal, 0, i) : std::nullopt;
    const auto after_second = after_first ? off(opened(at_goal, 0, i), T_goal, 1, k) : std::nullopt;
    if (!after_second) {
      why = "no straight way to or from it is free";
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

  /// The middle between the shoulders, and each shoulder: where the arms' first axes are.
  Vector3 shoulder(int arm) const {
    const Axis& first = robot.axes()[static_cast<std::size_t>(arms[static_cast<std::size_t>(arm)].arm.arm->axes.front())];
    return T_world_base * robot.link_pose(robot.rest_posture(), robot.joints()[static_cast<std::size_t>(first.joint)].child).translation();
  }

  struct Exchange {
    Pose T_world_object;
    double score;
  };

  /// Places between the arms and turns of the object, those first that let both hands point away from their shoulders and keep it upright.
  std::vector<Exchange> exchanges(int from, std::size_t i, int to, std::size_t k) const {
    static const std::vector<Eigen::Quaterniond> turns = so3_sequence(so3_grid_size(0));
    const Vector3 a = shoulder(from), b = shoulder(to), middle = 0.5 * (a + b), apart = b - a;
    Vector3 forward = T_world_base.linear().col(0);
    std::vector<Exchange> out;
    for (const double ahead : {0.35, 0.45, 0.55}) {
      for (const double aside : {-0.2, 0.0, 0.2}) {
        for (const double below : {0.2, 0.35, 0.5}) {
          const Vector3 place = middle + ahead * forward + aside * apart - below * Vector3::UnitZ();
          for (const Eigen::Quaterniond& turn : turns) {
            Exchange e{Pose::Identity(), 0};
            e.T_world_object.linear() = turn.toRotationMatrix();
            e.T_world_object.translation() = place - e.T_world_object.linear() * object.box().center();
            for (const auto& [arm, index, at] : {std::tuple(from, i, a), std::tuple(to, k, b)}) {
              const Pose T = e.T_world_object * grasp(arm, index).T_object_hand;
              e.score += T.linear().col(2).dot((place - at).normalized()) - 2.0 * std::max(0.0, (T.translation() - at).norm() - 0.75);
            }
            e.score += 0.3 * e.T_world_object.linear()(2, 2);
            out.push_back(e);
          }
        }
      }
    }
    std::stable_sort(out.begin(), out.end(), [](const Exchange& x, const Exchange& y) { return x.score > y.score; });
    if (out.size() > static_cast<std::size_t>(settings.exchange_tries)) out.resize(static_cast<std::size_t>(settings.exchange_tries));
    return out;
  }

  Judged judge_pass(int from, std::size_t i, int to, std::size_t k, const Vector3& way_from, const Vector3& way_to) {
    const Vector& rest = robot.rest_posture();
    const Grasp &g = grasp(from, i), &h = grasp(to, k);
    std::string reason = "no place in reach of both arms";
    for (const Exchange& e : exchanges(from, i, to, k)) {
      const auto q_from = reach(from, e.T_world_object * g.T_object_hand, rest, 0);
      if (!q_from) continue;
      const auto q_to = reach(to, e.T_world_object * h.T_object_hand, rest, 0);
      if (!q_to) continue;
      RegraspStep step;
      step.T_world_object = e.T_world_object;
      step.q = with(with(rest, from, *q_from, g.hand_joints), to, *q_to, h.hand_joints);
      if (!world.is_free(step.q) || !clear_of_object(step.q, e.T_world_object, from, to) || object_in_furniture(e.T_world_object)) {
        reason = "the arms would collide wherever both reach it";
        continue;
      }
      // It is brought there while the other arm rests, whose hand opens then.
      const Vector closed = with(rest, from, *q_from, g.hand_joints);
      const Vector opened = RobotModel::with(closed, *arms[static_cast<std::size_t>(to)].arm.fingers, h.pregrasp_joints);
      const auto clear = [&](const Vector& q) { return world.is_free(q) && clear_of_object(q, e.T_world_object, from); };
      if (!clear(closed) || !clear(opened)) {
        reason = "the other arm, at rest, would be in the way";
        continue;
      }
      auto before = straight(to, k, e.T_world_object, step.q, *q_to, way_to);
      auto after = before ? straight(from, i, e.T_world_object, step.q, *q_from, way_from) : std::nullopt;
      if (!after) {
        reason = "the hands could not come and go straight";
        continue;
      }
      step.before = std::move(*before);
      step.after = std::move(*after);
      if (!roomy(from, to, step)) {
        reason = "there would be no room for the least error";
        continue;
      }
      return {std::move(step), ""};
    }
    return {{}, reason};
  }

  /// The hand that comes gets there and keeps off the other even where the object lies in that a little otherwise than planned.
  bool roomy(int from, int to, const RegraspStep& step) {
    const Manipulator &mover = arms[static_cast<std::size_t>(to)].arm, &holder = arms[static_cast<std::size_t>(from)].arm;
    const auto arm_of = [](const Vector& q, const Manipulator& m) { return RobotModel::part(q, *m.arm); };
    // Where a hand is open the other is closed on the object.
    const Vector came = with(step.before, to, arm_of(step.q, mover), RobotModel::part(step.before, *mover.fingers));
    const Vector left = with(step.after, from, arm_of(step.q, holder), RobotModel::part(step.after, *holder.fingers));
    for (const Vector& q : {step.before, came, step.q, left, step.after}) {
      const Pose T_world_hand = T_world_base * robot.link_pose(q, mover.palm);
      for (int axis = 0; axis < 3; ++axis) {
        for (const double by : {-settings.slack, settings.slack}) {
          Pose T = T_world_hand;
          T.translation()[axis] += by;
          const auto off = reach(to, T, q, 0);
          if (!off || !world.is_free(RobotModel::with(q, *mover.arm, *off))) return false;
        }
      }
    }
    return true;
  }

  const RobotModel& robot;
  std::vector<RegraspArm> arms;
  const Graspable& object;
  RegraspSettings settings;
  Pose T_root_world, T_world_base;
  CollisionWorld world;
  std::vector<SceneBox> boxes;
  struct LinkShape {
    int link;
    CollisionShapePtr shape;
    Pose T_link_shape;
  };
  std::vector<LinkShape> shapes;
  std::vector<int> hand_of;  // per link: the arm whose hand it belongs to
  std::vector<std::vector<Vector3>> ways;
  std::vector<Pose> T_root_link;
  std::map<std::tuple<int, std::size_t, int, std::size_t>, Judged> passes;  // judged already, whatever the task
};

namespace {

/// One task: the graph of what may be possible, its edges judged only where the shortest way leads over them.
class Search {
 public:
  struct Edge {
    Node to;
    double cost;
    std::size_t pair;  // of a pass: index into pairs
  };
  std::map<Node, std::vector<Edge>> edges;

  /// `margin`: the least of the grasps that it leads from or to [N].
  void add(const Node& from, const Node& to, double quality, double margin, std::size_t pair = 0) {
    const double weak = std::clamp(-margin / kWeakest, 0.0, 1.0);
    edges[from].push_back({to, 1 + kQualityShare * (1 - quality) + kWeakShare * weak, pair});
  }
  void remove(const Node& from, const Node& to) {
    std::erase_if(edges[from], [&](const Edge& e) { return e.to == to; });
  }

  /// Nodes from `start` to the nearest for which `goal` holds; empty when there is none.
  template <class Goal>
  std::vector<Node> shortest(const Node& start, const Goal& goal) const {
    std::map<Node, std::pair<double, Node>> reached{{start, {0.0, start}}};
    std::set<std::pair<double, Node>> open{{0.0, start}};
    while (!open.empty()) {
      const auto [cost, node] = *open.begin();
      open.erase(open.begin());
      if (goal(node)) {
        std::vector<Node> path{node};
        while (path.back() != start) path.push_back(reached.at(path.back()).second);
        std::reverse(path.begin(), path.end());
        return path;
      }
      const auto from = edges.find(node);
      if (from == edges.end()) continue;
      for (const Edge& e : from->second) {
        const double total = cost + e.cost;
        const auto known = reached.find(e.to);
        if (known != reached.end() && known->second.first <= total) continue;
        if (known != reached.end()) open.erase({known->second.first, e.to});
        reached[e.to] = {total, node};
        open.insert({total, e.to});
      }
    }
    return {};
  }
};

}  // namespace

RegraspPlanner::RegraspPlanner(const RobotModel& robot, std::vector<RegraspArm> arms, const Graspable& object, ObjectLibrary library,
                               const Scene& scene, const std::string& object_id, const RegraspSettings& settings)
    : impl_(std::make_unique<Impl>(robot, std::move(arms), object, std::move(library), scene, object_id, settings)) {}
RegraspPlanner::~RegraspPlanner() = default;

RegraspPlan RegraspPlanner::plan_together(const Pose& T_world_start, const Pose& T_world_goal, const std::function<bool()>& cancelled) {
  Impl& impl = *impl_;
  if (impl.arms.size() != 2) throw ConfigError("two hands at once need two arms, there is " + std::to_string(impl.arms.size()));
  RegraspPlan out;
  const GripLoad load = carried_load(impl.object.mass(), T_world_start.linear(), impl.settings.grip);
  // Grasps that bear half of it and by which each arm follows it from where it stands to where it is to stand.
  const std::vector<Pose> way = impl.carried_over(T_world_start, T_world_goal);
  std::array<GraspList, 2> reached;
  std::array<std::vector<std::size_t>, 2> index;
  std::array<std::map<std::size_t, std::vector<CarriedWay>>, 2> ways;
  std::array<HandSide, 2> sides;
  for (std::size_t a = 0; a < 2; ++a) {
    const RegraspArm& arm = impl.arms[a];
    std::size_t firm = 0;
    for (std::size_t n = 0; n < arm.list->grasps.size(); ++n) {
      const Grasp& g = arm.list->grasps[n].grasp;
      if (bear_part({arm.kit, &g}, 0.5, load, impl.settings.grip).margin <= 0) continue;
      ++firm;
      std::vector<Pose> T_root_tip;
      for (const Pose& T : way) T_root_tip.push_back(impl.T_root_world * T * g.T_object_hand);
      std::vector<CarriedWay> found = carried_ways(impl.robot, *arm.arm.arm, impl.robot.rest_posture(), T_root_tip);
      if (found.empty()) continue;
      reached[a].grasps.push_back(arm.list->grasps[n]);
      index[a].push_back(n);
      sides[a].posture.push_back(std::min(1.0, found.front().room));
      ways[a][n] = std::move(found);
    }
    sides[a].kit = arm.kit;
    sides[a].list = &reached[a];
    if (!index[a].empty()) continue;
    const std::string all = "by none of " + std::to_string(firm > 0 ? firm : arm.list->grasps.size()) + " grasps ";
    out.reason = firm > 0 ? all + "that bear half of it does " + arm.arm.name + " follow it from its start to its goal"
                          : all + "do the fingers of " + arm.arm.name + " bear half of it";
    return out;
  }
  DoubleSettings pairs;
  pairs.most_of_each = impl.settings.most_of_each;
  pairs.taken = Taken::spread;
  pairs.p_object_middle = impl.object.box().center();
  pairs.clearance = impl.settings.clearance;
  DoubleList doubles = list_double_grasps(sides[0], sides[1], pairs);
  for (DoubleGrasp& d : doubles.grasps) d.first = index[0][d.first], d.second = index[1][d.second];
  const auto shares_of = [&](const DoubleGrasp& d) {
    return share_load({{impl.arms[0].kit, &impl.grasp(0, d.first)}, {impl.arms[1].kit, &impl.grasp(1, d.second)}}, impl.object.com(), load,
                      impl.settings.grip);
  };
  for (DoubleGrasp& d : doubles.grasps) {
    const std::vector<LoadShare> shares = shares_of(d);
    d.score = std::min(shares[0].margin, shares[1].margin);
  }
  std::stable_sort(doubles.grasps.begin(), doubles.grasps.end(),
                   [](const DoubleGrasp& x, const DoubleGrasp& y) { return x.score > y.score; });
  out.double_grasps = doubles.grasps.size();
  std::map<std::string, std::uint64_t> rejected;
  for (const DoubleGrasp& d : doubles.grasps) {
    const Vector3 between = impl.grasp(0, d.first).T_object_hand.translation() - impl.grasp(1, d.second).T_object_hand.translation();
    if (between.norm() < impl.settings.least_apart) {
      ++rejected["the hands would be too near each other"];
      continue;
    }
    if (d.score <= 0) {
      ++rejected["the fingers would not bear it"];
      continue;
    }
    if (out.judged >= impl.settings.most_pairs_tried || (cancelled && cancelled())) break;
    ++out.judged;
    std::string why;
    auto steps = impl.judge_together(d.first, d.second, way, ways[0].at(d.first), ways[1].at(d.second), why);
    if (steps) {
      out.steps = std::move(*steps);
      out.shares = shares_of(d);
      out.solved = true;
      break;
    }
    ++rejected[why];
  }
  for (const auto& [what, times] : rejected) out.rejected.push_back({std::to_string(times) + " pairs", what});
  for (Refusal& r : doubles.refusals()) out.rejected.push_back(std::move(r));
  if (out.solved) return out;
  const auto most = std::max_element(rejected.begin(), rejected.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
  out.reason = "no two grasps take it there together";
  if (most != rejected.end()) out.reason += "; most often: " + most->first;
  return out;
}

RegraspPlan RegraspPlanner::plan(const RegraspTask& task, const std::function<bool()>& cancelled) {
  Impl& impl = *impl_;
  const int count = static_cast<int>(impl.arms.size());
  for (const ObjectState* state : {&task.start, &task.goal}) {
    if (state->arm >= count) throw ConfigError("arm " + std::to_string(state->arm) + " is asked for; there are " + std::to_string(count));
    if (state->arm < 0 || !state->grasp) continue;
    const std::size_t listed = impl.arms[static_cast<std::size_t>(state->arm)].list->grasps.size();
    if (*state->grasp >= listed) {
      throw ConfigError("grasp " + std::to_string(*state->grasp) + " is asked for; the list has " + std::to_string(listed));
    }
  }
  if (task.start.arm >= 0 && !task.start.grasp) throw ConfigError("the start says which hand holds the object but not with which grasp");

  // Places: start and goal where it stands, and those between.
  std::vector<Pose> places;
  Node start{task.start.arm, task.start.grasp.value_or(0)};
  std::optional<Node> standing_goal;
  if (task.start.arm < 0) {
    start = {-1, places.size()};
    places.push_back(task.start.T_world_object);
  }
  if (task.goal.arm < 0) {
    standing_goal = Node{-1, places.size()};
    places.push_back(task.goal.T_world_object);
  }
  places.insert(places.end(), task.placements.begin(), task.placements.end());
  const auto reached_goal = [&](const Node& n) {
    return standing_goal ? n == *standing_goal : n.arm == task.goal.arm && (!task.goal.grasp || n.index == *task.goal.grasp);
  };

  // Grasps of each arm that may be used.
  Search search;
  std::vector<HandSide> sides;
  std::vector<std::vector<std::size_t>> taken;
  for (int a = 0; a < count; ++a) {
    const RegraspArm& arm = impl.arms[static_cast<std::size_t>(a)];
    HandSide side{arm.kit, arm.list, {}, {}};
    for (const ObjectState* state : {&task.start, &task.goal})
      if (state->arm == a && state->grasp) side.also.push_back(*state->grasp);
    taken.push_back(taken_grasps(*arm.list, impl.settings.most_of_each, Taken::spread, impl.object.box().center(), side.also));
    sides.push_back(std::move(side));
    for (const std::size_t i : taken.back()) {
      for (std::size_t p = 0; p < places.size(); ++p) {
        const Grasp& g = impl.grasp(a, i);
        search.add({-1, p}, {a, i}, g.quality, g.margin);
        search.add({a, i}, {-1, p}, g.quality, g.margin);
      }
    }
  }
  RegraspPlan out;
  DoubleList doubles;
  if (count == 2) {
    DoubleSettings pairs;
    pairs.most_of_each = impl.settings.most_of_each;
    pairs.taken = Taken::spread;
    pairs.p_object_middle = impl.object.box().center();
    pairs.clearance = impl.settings.clearance;
    pairs.passed = &impl.object;
    pairs.stand_off = impl.settings.stand_off;
    doubles = list_double_grasps(sides[0], sides[1], pairs);
    for (std::size_t n = 0; n < doubles.grasps.size(); ++n) {
      const DoubleGrasp& d = doubles.grasps[n];
      const double margin = std::min(impl.grasp(0, d.first).margin, impl.grasp(1, d.second).margin);
      search.add({0, d.first}, {1, d.second}, d.quality, margin, n);
      search.add({1, d.second}, {0, d.first}, d.quality, margin, n);
    }
  }
  out.double_grasps = doubles.grasps.size();

  std::map<std::string, std::uint64_t> rejected;
  std::map<std::tuple<int, std::size_t, std::size_t>, Judged> picks;
  const auto pick_of = [&](const Node& held, std::size_t place) -> const Judged& {
    const auto [it, fresh] = picks.try_emplace({held.arm, held.index, place});
    if (fresh) {
      ++out.judged;
      it->second = impl.judge_pick(held.arm, held.index, places[place]);
    }
    return it->second;
  };
  const auto judge = [&](const Node& from, const Node& to) -> Judged {
    if (from.arm >= 0 && to.arm >= 0) {
      const auto [it, fresh] = impl.passes.try_emplace({from.arm, from.index, to.arm, to.index});
      if (fresh) {
        ++out.judged;
        const std::vector<Search::Edge>& edges = search.edges[from];
        const DoubleGrasp& d =
            doubles.grasps[std::find_if(edges.begin(), edges.end(), [&](const Search::Edge& e) { return e.to == to; })->pair];
        const bool straight = from.arm == 0;
        it->second = impl.judge_pass(from.arm, from.index, to.arm, to.index, straight ? d.way_first : d.way_second,
                                     straight ? d.way_second : d.way_first);
      }
      Judged judged = it->second;
      if (judged.step) {
        judged.step->kind = RegraspStepKind::pass;
        std::tie(judged.step->from, judged.step->grasp_from, judged.step->to, judged.step->grasp_to) =
            std::tuple(from.arm, from.index, to.arm, to.index);
      }
      return judged;
    }
    const bool picking = from.arm < 0;
    Judged judged = picking ? pick_of(to, from.index) : pick_of(from, to.index);
    if (!judged.step) return judged;
    judged.step->kind = picking ? RegraspStepKind::pick : RegraspStepKind::place;
    (picking ? judged.step->to : judged.step->from) = picking ? to.arm : from.arm;
    (picking ? judged.step->grasp_to : judged.step->grasp_from) = picking ? to.index : from.index;
    (picking ? judged.step->after : judged.step->before).resize(0);
    return judged;
  };

  const auto finish = [&] {
    for (const auto& [what, times] : rejected) {
      const auto colon = what.find(": ");
      out.rejected.push_back({std::to_string(times) + " " + what.substr(0, colon), what.substr(colon + 2)});
    }
    return out;
  };
  while (true) {
    const std::vector<Node> path = search.shortest(start, reached_goal);
    if (path.empty()) {
      const auto most =
          std::max_element(rejected.begin(), rejected.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
      out.reason = "no sequence of grasps leads there";
      if (most != rejected.end()) out.reason += "; most often: " + std::to_string(most->second) + " " + most->first;
      return finish();
    }
    out.steps.clear();
    bool whole = true;
    for (std::size_t n = 0; whole && n + 1 < path.size(); ++n) {
      Judged judged = judge(path[n], path[n + 1]);
      whole = judged.step.has_value();
      if (whole) {
        out.steps.push_back(std::move(*judged.step));
        continue;
      }
      const bool passing = path[n].arm >= 0 && path[n + 1].arm >= 0;
      ++rejected[(passing ? "passes: " : path[n].arm < 0 ? "picks: " : "places: ") + judged.reason];
      search.remove(path[n], path[n + 1]);
    }
    if (whole) {
      out.solved = true;
      return finish();
    }
    out.steps.clear();
    if (out.judged >= impl.settings.most_steps_tried || (cancelled && cancelled())) {
      out.reason = cancelled && cancelled() ? "cancelled" : "the budget of " + std::to_string(out.judged) + " judged steps was used up";
      return finish();
    }
  }
}

}  // namespace handsel::grasp_planner
