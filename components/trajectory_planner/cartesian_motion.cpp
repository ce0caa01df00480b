#include "components/trajectory_planner/cartesian_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/model/platform.hpp"
#include "common/model/srs_arm.hpp"
#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/segment_table.hpp"

namespace handsel::trajectory_planner {
namespace {

constexpr double kNearPi = 0.02;  // displacements this near to a turn by pi have no axis [rad]
constexpr double kSame = 1e-9;    // nodes nearer are the same
constexpr double kProbe = 0.05;   // the way between elbow angles is tried this often [rad or 3 x m]
constexpr double kMetre = 3.0;    // [rad/m]
constexpr double kElbowMotion =
    0.3;  // cost of turning the elbow by a radian, where keeping off the limits is worth 1
constexpr int kTool = 6, kElbow = 7;  // active axes up to the tool's, up to the elbow's
constexpr int kTries =
    3;  // of an approximation that leaves the limits its samples keep; each ten times as close
constexpr double kRounding = 1e-7;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

Eigen::Matrix3d turned_by(const Vector3& r) {
  const double angle = r.norm();
  return angle < 1e-12 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                       : Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
}

Vector3 displacement(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(from.transpose() * to));
  return turn.angle() * turn.axis();
}

template <class... Values>
std::string text(const char* pattern, Values... values) {
  char out[240];
  std::snprintf(out, sizeof out, pattern, values...);
  return out;
}

std::string of_node(std::size_t node) { return "node " + std::to_string(node); }

}  // namespace

Pose CartesianTrajectory::pose_at(const Vector& active, std::size_t node) const {
  const Node& at = nodes_[node];
  Pose T = Pose::Identity();
  T.translation() = active.head<3>();
  T.linear() = at.T_root_tool.linear() * turned_by(active.segment<3>(3) - at.active.segment<3>(3));
  return T;
}

std::size_t CartesianTrajectory::node_at(double t) const {
  return static_cast<std::size_t>(std::upper_bound(middles_.begin(), middles_.end(), t) -
                                  middles_.begin());
}

Pose CartesianTrajectory::pose(double t) const {
  return pose_at(active_.at(t).position, node_at(t));
}

class CartesianPlanning {
 public:
  CartesianPlanning(const RobotModel& robot, const Group& arm, CollisionWorld& world,
                    const CartesianRequest& request, const CartesianSettings& settings)
      : robot_(robot), group_(arm), world_(world), request_(request), settings_(settings) {}

  CartesianMotion run() {
    if (!possible()) return std::move(motion_);
    find_nodes();
    choose_elbows();
    while (!timed() || !followed()) {
    }
    motion_.given = given_;
    if (motion_.reached == 0 && !motion_.reason.empty()) return std::move(motion_);
    approximated();
    motion_.solved = motion_.reason.empty();
    return std::move(motion_);
  }

 private:
  using Node = CartesianTrajectory::Node;

  bool refuse(const std::string& why) {
    if (motion_.reason.empty()) motion_.reason = why;
    return false;
  }

  /// The way ends before this node of the request.
  void end_before(std::size_t given, const std::string& why) {
    refuse(why);
    while (given_.size() > 1 && given_.back() >= given) {
      given_.pop_back();
      motion_.path.nodes_.pop_back();
      postures_.resize(std::min(postures_.size(), given_.size()));
    }
    motion_.reached = given_.back();
  }

  bool possible() {
    if (request_.start.size() != robot_.dof() || !request_.start.allFinite())
      return refuse(text("the start has %d axes, the robot %d",
                         static_cast<int>(request_.start.size()), robot_.dof()));
    if (request_.nodes.empty()) return refuse("there are no nodes");
    if (!(request_.speed_scale > 0 && request_.speed_scale <= 1))
      return refuse("the speed scale must be in (0, 1]");
    for (const int axis : request_.also)
      if (axis < 0 || axis >= robot_.dof() ||
          std::count(group_.axes.begin(), group_.axes.end(), axis) > 0)
        return refuse(
            "axis " + std::to_string(axis) + " cannot be active besides the arm" +
            (axis >= robot_.dof() ? ": the robot has " + std::to_string(robot_.dof()) : ""));
    for (std::size_t k = 0; k < request_.nodes.size(); ++k) {
      const CartesianWaypoint& node = request_.nodes[k];
      if (!node.T_root_tool.matrix().allFinite() || (node.elbow && !std::isfinite(*node.elbow)) ||
          !node.also.allFinite())
        return refuse(of_node(k + 1) + " has a number that is not finite");
      if (node.also.size() != static_cast<Eigen::Index>(request_.also.size()))
        return refuse(of_node(k + 1) + " gives " + std::to_string(node.also.size()) +
                      " further axes, the request names " + std::to_string(request_.also.size()));
    }
    if (const Group* platform = robot_.group(kPlatformGroup))
      for (std::size_t i = 0; i < platform_.size(); ++i) platform_[i] = further(platform->axes[i]);
    T_root_base_ = base_at(request_.start(request_.also));
    chain_.emplace(robot_, group_, request_.start);
    arm_ = ik::SrsArm::recognise(*chain_);
    if (!arm_) return refuse(ik::SrsArm::why_none(group_));
    motion_.axes = group_.axes;
    motion_.axes.insert(motion_.axes.end(), request_.also.begin(), request_.also.end());
    if (!join()) return false;
    world_.set_moving_axes(axes_that_move());
    if (const CollisionVerdict verdict = world_.check(request_.start); !verdict.free)
      return refuse("the start is in collision: " + verdict.first + " touches " + verdict.second);
    return true;
  }

  bool join() {
    if (!request_.joined) return true;
    for (const int axis : request_.joined->arm->axes)
      if (std::count(motion_.axes.begin(), motion_.axes.end(), axis) > 0)
        return refuse("the arm " + request_.joined->arm->name +
                      " cannot follow itself, nor axes that are active");
    joined_.emplace(robot_, *request_.joined, request_.start);
    if (std::string why =
            joined_->objection(chain_->forward(RobotModel::part(request_.start, group_), nullptr));
        !why.empty())
      return refuse(why);
    motion_.axes.insert(motion_.axes.end(), joined_->axes().begin(), joined_->axes().end());
    return true;
  }

  /// Those of the arm and the one that follows it, and further ones that some node has elsewhere.
  std::vector<int> axes_that_move() const {
    std::vector<int> axes = group_.axes;
    for (std::size_t i = 0; i < request_.also.size(); ++i)
      if (std::any_of(
              request_.nodes.begin(), request_.nodes.end(), [&](const CartesianWaypoint& node) {
                return node.also[static_cast<Eigen::Index>(i)] != request_.start[request_.also[i]];
              }))
        axes.push_back(request_.also[i]);
    if (joined_) axes.insert(axes.end(), joined_->axes().begin(), joined_->axes().end());
    return axes;
  }

  /// Its place among the further active axes; -1: it is none.
  int further(int axis) const {
    const auto found = std::find(request_.also.begin(), request_.also.end(), axis);
    return found == request_.also.end() ? -1 : static_cast<int>(found - request_.also.begin());
  }

  bool drives() const { return platform_[0] >= 0 || platform_[1] >= 0 || platform_[2] >= 0; }

  Pose base_at(const Vector& also) const {
    if (!drives()) return Pose::Identity();
    const std::vector<int>& axes = robot_.require_group(kPlatformGroup).axes;
    const auto at = [&](std::size_t i) {
      return platform_[i] < 0 ? request_.start[axes[i]] : also[platform_[i]];
    };
    return make_pose({at(0), at(1), 0},
                     Eigen::Quaterniond(Eigen::AngleAxisd(at(2), Vector3::UnitZ())));
  }

  /// The pose of the tool as the arm sees it, whose chain was made where the platform stood at the
  /// start.
  Pose for_arm(const Pose& T_root_tool, const Vector& also) const {
    return drives() ? T_root_base_ * base_at(also).inverse() * T_root_tool : T_root_tool;
  }

  /// The active values of the nodes, as far as legs between them exist; elbows left open are those
  /// of the start.
  void find_nodes() {
    const ik::Axes q = RobotModel::part(request_.start, group_);
    Node at;
    at.T_root_tool = chain_->forward(q, nullptr);
    at.active = Vector::Zero(kElbow + static_cast<Eigen::Index>(request_.also.size()));
    at.active.head<3>() = at.T_root_tool.translation();
    at.active[kTool] = arm_->elbow_angle(q);
    for (std::size_t i = 0; i < request_.also.size(); ++i)
      at.active[kElbow + static_cast<Eigen::Index>(i)] = request_.start[request_.also[i]];
    motion_.path.nodes_ = {at};
    given_ = {0};
    if (!upright(at.T_root_tool))
      return end_before(1, "at the start what is held leans over too far");
    for (std::size_t k = 1; k <= request_.nodes.size(); ++k) {
      const CartesianWaypoint& wanted = request_.nodes[k - 1];
      const Node& last = motion_.path.nodes_.back();
      const Vector3 turn = displacement(last.T_root_tool.linear(), wanted.T_root_tool.linear());
      if (turn.norm() > M_PI - kNearPi)
        return end_before(k, "the tool turns by half a turn from " + of_node(k - 1) + " to " +
                                 of_node(k) +
                                 ", about no axis in particular: a node between is needed");
      if (!upright(wanted.T_root_tool))
        return end_before(k, "at " + of_node(k) + " what is held leans over too far");
      Node next;
      next.T_root_tool = wanted.T_root_tool;
      next.active = last.active;
      next.active.head<3>() = wanted.T_root_tool.translation();
      next.active.segment<3>(3) += turn;
      if (wanted.elbow)
        next.active[kTool] += std::remainder(*wanted.elbow - last.active[kTool], 2 * M_PI);
      next.active.tail(wanted.also.size()) = wanted.also;
      for (std::size_t i = 0; i < request_.also.size(); ++i) {
        const Axis& axis = robot_.axes()[static_cast<std::size_t>(request_.also[i])];
        const double value = wanted.also[static_cast<Eigen::Index>(i)];
        if (!(value >= axis.lower && value <= axis.upper))
          return end_before(
              k, text("at node %zu axis %s at %.4f is outside its limits %.4f ... %.4f", k,
                      axis.name.c_str(), value, axis.lower, axis.upper));
      }
      motion_.reached = k;
      const bool settles_elbow =
          wanted.elbow && given_.back() > 0 && !request_.nodes[given_.back() - 1].elbow;
      if (!settles_elbow && (next.active - last.active).lpNorm<Eigen::Infinity>() <= kSame)
        continue;
      motion_.path.nodes_.push_back(next);
      given_.push_back(k);
    }
  }

  bool upright(const Pose& T) const {
    if (!request_.level) return true;
    const HeldLevel& level = *request_.level;
    const double c = (T.linear() * level.axis_tool.normalized()).dot(level.up_root.normalized());
    return std::acos(std::clamp(c, -1.0, 1.0)) <= level.bound;
  }

  /// 0 in the middle of every joint's range, growing steeply toward its ends.
  double near_limits(const ik::Axes& q) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double middle = 0.5 * (chain_->lower()[i] + chain_->upper()[i]),
                   half = 0.5 * (chain_->upper()[i] - chain_->lower()[i]);
      sum += std::pow((q[i] - middle) / half, 6);
    }
    return sum;
  }

  /// The posture at the end of a leg, on the branch of its beginning; nullopt where joints meet a
  /// limit or jump.
  std::optional<ik::Axes> along_leg(std::size_t leg, double elbow_from, double elbow_to,
                                    const ik::Axes& from,
                                    std::vector<SpeedAlong::SpeedSample>* samples = nullptr) const {
    const Node &a = motion_.path.nodes_[leg], &b = motion_.path.nodes_[leg + 1];
    const Vector step = b.active - a.active;
    const double far = std::max({kMetre * step.head<3>().norm(), step.segment<3>(3).norm(),
                                 std::abs(elbow_to - elbow_from)});
    const int parts = std::max(1, static_cast<int>(std::ceil(far / kProbe)));
    ik::Axes q = from;
    const auto look = [&](double factor) {
      if (samples == nullptr) return;
      samples->push_back(request_.people->at(whole(
          q, a.active.tail(a.active.size() - kElbow) + factor * step.tail(step.size() - kElbow))));
      samples->back().at = factor;
    };
    look(0);
    for (int k = 1; k <= parts; ++k) {
      const double factor = static_cast<double>(k) / parts;
      const Vector active = a.active + factor * step;
      const Pose T =
          for_arm(motion_.path.pose_at(active, leg), active.tail(active.size() - kElbow));
      const auto next = arm_->nearest(T, elbow_from + factor * (elbow_to - elbow_from), q);
      if (!next || (*next - q).lpNorm<Eigen::Infinity>() > 4 * settings_.largest_step)
        return std::nullopt;
      q = *next;
      look(factor);
    }
    return q;
  }

  /// Elbow angles of the nodes that leave it open: those that keep the joints off their limits with
  /// little motion of the elbow, and that a way leads to. Cheapest first; ways are only tried where
  /// they would be taken.
  void choose_elbows() {
    std::vector<Node>& nodes = motion_.path.nodes_;
    struct Option {
      double elbow{}, cost{kInfinite};
      ik::Axes q;
    };
    std::vector<Option> from{
        {nodes[0].active[kTool], 0.0, RobotModel::part(request_.start, group_)}};
    std::vector<std::vector<std::pair<double, int>>> chosen{{{from[0].elbow, -1}}};
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      const std::optional<double>& fixed = request_.nodes[given_[k] - 1].elbow;
      std::vector<Option> to;
      std::vector<std::pair<double, int>> ways;
      const int tries = fixed ? 1 : settings_.elbows;
      for (int i = 0; i < tries; ++i) {
        const double angle = fixed ? *fixed : nodes[0].active[kTool] + 2 * M_PI * i / tries;
        std::vector<std::pair<double, int>> order;
        for (std::size_t j = 0; j < from.size(); ++j)
          order.emplace_back(from[j].cost + kElbowMotion * std::abs(std::remainder(
                                                               angle - from[j].elbow, 2 * M_PI)),
                             static_cast<int>(j));
        std::sort(order.begin(), order.end());
        for (std::size_t j = 0; j < std::min<std::size_t>(3, order.size()); ++j) {
          const Option& before = from[static_cast<std::size_t>(order[j].second)];
          const double elbow = before.elbow + std::remainder(angle - before.elbow, 2 * M_PI);
          const std::optional<ik::Axes> q = along_leg(k - 1, before.elbow, elbow, before.q);
          if (!q) continue;
          to.push_back({elbow, order[j].first + near_limits(*q), *q});
          ways.emplace_back(elbow, order[j].second);
          break;
        }
      }
      if (to.empty()) {
        end_before(given_[k], why_no_way(k));
        break;
      }
      from = std::move(to);
      chosen.push_back(std::move(ways));
    }
    std::size_t best = 0;
    for (std::size_t i = 0; i < from.size(); ++i)
      if (from[i].cost < from[best].cost) best = i;
    for (std::size_t k = nodes.size() - 1; k > 0; --k) {
      nodes[k].active[kTool] = chosen[k][best].first;
      best = static_cast<std::size_t>(chosen[k][best].second);
    }
  }

  std::string why_no_way(std::size_t k) const {
    const Node& node = motion_.path.nodes_[k];
    const ik::Axes middle = 0.5 * (chain_->lower() + chain_->upper());
    bool reach = false, inside = false;
    for (int i = 0; i < settings_.elbows; ++i) {
      const double elbow = node.active[kTool] + 2 * M_PI * i / settings_.elbows;
      const std::vector<ik::Axes> found = arm_->branches(
          for_arm(node.T_root_tool, node.active.tail(node.active.size() - kElbow)), elbow);
      reach |= !found.empty();
      inside |= std::any_of(found.begin(), found.end(), [&](const ik::Axes& q) {
        return arm_->turned_inside(q, middle).has_value();
      });
    }
    const std::string name = of_node(given_[k]);
    if (!reach) return name + " is out of reach of the arm";
    if (!inside) return "no configuration inside the joint limits has the tool at " + name;
    return "no path leads to " + name +
           " without a joint limit or a change of branch (a stretched shoulder, elbow or wrist) "
           "between";
  }

  KinematicLimits active_limits() const {
    const Eigen::Index n = motion_.path.nodes_[0].active.size();
    KinematicLimits out{Vector(n), Vector(n), Vector(n)};
    const auto set = [&](Eigen::Index i, const RateBounds& bounds) {
      out.velocity[i] = request_.speed_scale * bounds.velocity;
      out.acceleration[i] = bounds.acceleration;
      out.jerk[i] = bounds.jerk;
    };
    for (Eigen::Index i = 0; i < 3; ++i) set(i, settings_.translation);
    for (Eigen::Index i = 3; i < kTool; ++i) set(i, settings_.rotation);
    set(kTool, settings_.elbow);
    const KinematicLimits& joints = robot_.comfort_limits();
    for (std::size_t i = 0; i < request_.also.size(); ++i) {
      const int axis = request_.also[i];
      set(kElbow + static_cast<Eigen::Index>(i),
          {joints.velocity[axis], joints.acceleration[axis], joints.jerk[axis]});
    }
    return out;
  }

  /// TR of the nodes left.
  bool timed() {
    CartesianTrajectory& path = motion_.path;
    postures_.clear();
    motion_.speeds.clear();
    motion_.cost = 0;
    ik::Axes q = RobotModel::part(request_.start, group_);
    postures_.push_back(q);
    for (std::size_t k = 1; k < path.nodes_.size(); ++k) {
      std::vector<SpeedAlong::SpeedSample> samples;
      const auto next =
          along_leg(k - 1, path.nodes_[k - 1].active[kTool], path.nodes_[k].active[kTool], q,
                    request_.people != nullptr ? &samples : nullptr);
      if (!next) {
        end_before(given_[k], why_no_way(k));
        return false;
      }
      postures_.push_back(q = *next);
      if (samples.empty()) continue;
      motion_.speeds.push_back(SpeedAlong::zones(samples));
      for (const SpeedAlong::SpeedSample& look : samples)
        motion_.cost = std::max(motion_.cost, std::clamp(look.cost, 0.0, 1.0));
    }
    std::vector<Vector> line;
    for (const Node& node : path.nodes_) line.push_back(node.active);
    const KinematicLimits limits = active_limits();
    SmoothSettings smoothing;
    smoothing.allowed_excess = settings_.allowed_excess;
    SmoothResult smoothed = smooth(
        line, limits, smoothing, [this](const Trajectory& corner) { return corner_free(corner); },
        motion_.speeds);
    if (!smoothed.ok()) {
      end_before(1, smoothed.reason);
      return true;
    }
    path.active_ = std::move(smoothed.trajectory);
    motion_.duration_ptp = smoothed.duration_ptp;
    motion_.corners = std::move(smoothed.corners);
    path.middles_.clear();
    double begin = 0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      for (const BlendReport& corner : motion_.corners)
        if (corner.node == static_cast<int>(k)) begin -= corner.saved;
      const double lasts = smoothed.segment_durations[k];
      path.middles_.push_back(begin + 0.5 * lasts);
      begin += lasts;
    }
    return true;
  }

  /// From a posture to one nearby, where the way there is continuous.
  bool advance(const Pose& T, double elbow, const Vector& also, ik::Axes& q) const {
    const auto next = arm_->nearest(for_arm(T, also), elbow, q);
    if (!next || (*next - q).lpNorm<Eigen::Infinity>() > settings_.largest_step) return false;
    q = *next;
    return true;
  }

  /// The first of these postures, one near the next, that touches something; their number where
  /// none does. Boxes of configurations around some of them, and what lies between, are looked at
  /// side by side; those that are not clear posture by posture.
  std::size_t first_touching(const std::vector<Vector>& postures) const {
    struct Run {
      std::size_t begin, end;
    };
    std::vector<Run> runs;
    std::vector<Vector> low, high;
    const auto check = [&]() -> std::optional<std::size_t> {
      const int count = static_cast<int>(runs.size());
      const std::uint32_t unclear =
          count > 0 ? world_.unclear_boxes(low.data(), high.data(), count) : 0;
      for (int i = 0; i < count; ++i) {
        const Run& run = runs[static_cast<std::size_t>(i)];
        if ((unclear >> i & 1) == 0) continue;
        for (const std::size_t k : {run.begin, run.end})
          if (!world_.is_free(postures[k])) return k;
      }
      runs.clear();
      low.clear();
      high.clear();
      return std::nullopt;
    };
    for (std::size_t begin = 0; begin < postures.size();) {
      Vector least = postures[begin], bound = least;
      std::size_t end = begin;
      while (end + 1 < postures.size()) {
        const Vector lower = least.cwiseMin(postures[end + 1]),
                     upper = bound.cwiseMax(postures[end + 1]);
        if (end > begin && (upper - lower).maxCoeff() > settings_.collision_step) break;
        least = lower;
        bound = upper;
        ++end;
      }
      runs.push_back({begin, end});
      low.push_back(least);
      high.push_back(bound);
      begin = end > begin && end + 1 < postures.size() ? end : postures.size();
      if (runs.size() < CollisionWorld::kMaxBoxes && begin < postures.size()) continue;
      if (const auto touching = check()) return *touching;
    }
    return postures.size();
  }

  Vector whole(const ik::Axes& q, const Vector& also) const {
    Vector all = RobotModel::with(request_.start, group_, q);
    for (std::size_t i = 0; i < request_.also.size(); ++i)
      all[request_.also[i]] = also[static_cast<Eigen::Index>(i)];
    if (joined_) all(joined_->axes()) = joined_->joints();
    return all;
  }

  /// A corner is followed from its node's posture both ways.
  bool corner_free(const Trajectory& corner) const {
    const std::size_t node = node_of(corner);
    if (node == 0 || joined_) return false;
    for (std::size_t i = 0; i < request_.also.size(); ++i) {
      const Axis& axis = robot_.axes()[static_cast<std::size_t>(request_.also[i])];
      const AxisExtremes e = extremes(corner.axes[kElbow + i]);
      if (e.lowest < axis.lower || e.highest > axis.upper) return false;
    }
    const double lasts = corner.duration();
    const Vector& at = motion_.path.nodes_[node].active;
    double middle = 0, least = kInfinite;
    const int parts = std::max(8, static_cast<int>(std::ceil(lasts / (8 * settings_.period))));
    for (int k = 0; k <= parts; ++k)
      if (const double d = (corner.at(lasts * k / parts).position - at).norm(); d < least) {
        least = d;
        middle = lasts * k / parts;
      }
    for (const double end : {0.0, lasts}) {
      ik::Axes q = postures_[node];
      std::vector<Vector> way;
      const int steps =
          std::max(1, static_cast<int>(std::ceil(std::abs(end - middle) / (4 * settings_.period))));
      for (int k = 0; k <= steps; ++k) {
        const Vector active = corner.at(middle + (end - middle) * k / steps).position;
        const Pose T = motion_.path.pose_at(active, node);
        const Vector also = active.tail(active.size() - kElbow);
        if (!upright(T) || !advance(T, active[kTool], also, q)) return false;
        way.push_back(whole(q, also));
      }
      if (first_touching(way) < way.size()) return false;
    }
    return true;
  }

  /// Whose corner it is: it begins on the leg before and ends on the leg after.
  std::size_t node_of(const Trajectory& corner) const {
    const std::vector<Node>& nodes = motion_.path.nodes_;
    const Vector begin = corner.at(0).position, end = corner.at(corner.duration()).position;
    const auto off = [&](const Vector& x, std::size_t leg) {
      const Vector along = nodes[leg + 1].active - nodes[leg].active;
      const double factor = std::clamp(
          (x - nodes[leg].active).dot(along) / std::max(along.squaredNorm(), 1e-18), 0.0, 1.0);
      return (x - nodes[leg].active - factor * along).norm();
    };
    std::size_t best = 0;
    double least = 1e-5;
    for (std::size_t k = 1; k + 1 < nodes.size(); ++k)
      if (const double d = off(begin, k - 1) + off(end, k); d < least) {
        least = d;
        best = k;
      }
    return best;
  }

  /// The joints at every period. Where that is not possible the way ends before the node ahead.
  bool followed() {
    motion_.samples.clear();
    times_.clear();
    const CartesianTrajectory& path = motion_.path;
    const double lasts = path.duration();
    if (path.nodes_.size() < 2) {
      motion_.samples = {request_.start(motion_.axes)};
      times_ = {0.0};
      return true;
    }
    const int steps = std::max(4, static_cast<int>(std::ceil(lasts / settings_.period - 1e-9)));
    ik::Axes q = RobotModel::part(request_.start, group_);
    if (joined_) joined_->restart();
    const SegmentTable table(path.active_);
    MotionState3 state = path.active_.at(0);
    int cursor = 0;
    std::vector<Vector> postures;
    const auto ahead = [&](double t) {
      const std::size_t node = path.node_at(t);
      return given_[std::min(path.nodes_.size() - 1,
                             path.middles_.empty() || node == 0 ? 1 : ahead_of(t, node))];
    };
    std::string why;
    for (int k = 0; k <= steps && why.empty(); ++k) {
      const double t = k == steps ? lasts : std::min(lasts, k * settings_.period);
      table.evaluate(t, cursor, state);
      const Pose T = path.pose_at(state.position, path.node_at(t));
      const Vector also = state.position.tail(state.position.size() - kElbow);
      times_.push_back(t);
      if (!upright(T)) {
        why = "on the path to " + of_node(ahead(t)) + " what is held leans over too far";
      } else if (!advance(T, state.position[kTool], also, q)) {
        why = why_stopped(ahead(t), T, state.position[kTool], also, q);
      } else if (std::string arm; joined_ && !joined_->follow(T, settings_.largest_step, arm)) {
        why = "on the path to " + of_node(ahead(t)) + " " + arm;
      } else {
        Vector sample(static_cast<Eigen::Index>(motion_.axes.size()));
        if (joined_)
          sample << q, also, joined_->joints();
        else
          sample << q, also;
        motion_.samples.push_back(std::move(sample));
        postures.push_back(whole(q, also));
      }
    }
    std::size_t last = times_.size() - 1;
    if (const std::size_t touching = first_touching(postures); touching < postures.size()) {
      last = touching;
      const CollisionVerdict verdict = world_.check(postures[touching]);
      why = "on the path to " + of_node(ahead(times_[last])) + " " + verdict.first + " touches " +
            verdict.second;
    }
    if (why.empty()) return true;
    end_before(ahead(times_[last]), why);
    return false;
  }

  std::size_t ahead_of(double t, std::size_t node) const {
    const Vector &at = motion_.path.nodes_[node].active,
                 &before = motion_.path.nodes_[node - 1].active;
    return (motion_.path.active_.at(t).position - at).dot(at - before) < 0 ? node : node + 1;
  }

  std::string why_stopped(std::size_t given, const Pose& T, double elbow, const Vector& also,
                          const ik::Axes& q) const {
    const std::string way = "on the path to " + of_node(given);
    const auto next = arm_->nearest(for_arm(T, also), elbow, q);
    if (!next)
      return way + (arm_->branches(for_arm(T, also), elbow).empty() ? " the arm does not reach"
                                                                    : " a joint meets its limit");
    Eigen::Index joint = 0;
    (*next - q).cwiseAbs().maxCoeff(&joint);
    return way + " joint " +
           robot_.axes()[static_cast<std::size_t>(group_.axes[static_cast<std::size_t>(joint)])]
               .name +
           " would jump: shoulder, elbow or wrist is stretched there";
  }

  void approximated() {
    const KinematicLimits& all = robot_.comfort_limits();
    const KinematicLimits limits{request_.speed_scale * all.velocity(motion_.axes),
                                 all.acceleration(motion_.axes), all.jerk(motion_.axes)};
    if (motion_.samples.size() < 2) return;
    Derived derived = differentiate(times_, motion_.samples);
    for (MotionState3* end : {&derived.samples.front(), &derived.samples.back()}) {
      end->velocity.setZero();
      end->acceleration.setZero();
    }
    derived.samples.front().position = motion_.samples.front();
    derived.samples.back().position = motion_.samples.back();
    ApproximationTolerance tolerance = settings_.tolerance;
    for (int tries = 0; tries < kTries; ++tries, tolerance.position *= 0.1) {
      motion_.executable = approximate_within(times_, derived.samples, tolerance, limits);
      if (!motion_.executable.approximation.ok() ||
          inside_limits(motion_.executable.approximation.trajectory))
        break;
    }
    if (!motion_.executable.approximation.ok()) refuse(motion_.executable.approximation.reason);
    if (joined_ && motion_.executable.approximation.ok()) measure_join();
  }

  void measure_join() {
    const Trajectory& run = motion_.executable.approximation.trajectory;
    const int samples =
        std::max(1, static_cast<int>(std::ceil(run.duration() / (4 * settings_.period))));
    for (int k = 0; k <= samples; ++k) {
      const Vector q = run.at(run.duration() * k / samples).position;
      const JoinError e = joined_->error(
          chain_->forward(q.head(static_cast<Eigen::Index>(group_.axes.size())), nullptr),
          q.tail(static_cast<Eigen::Index>(joined_->axes().size())));
      motion_.joined = {std::max(motion_.joined.apart, e.apart),
                        std::max(motion_.joined.turned, e.turned)};
    }
    if (motion_.joined.apart > settings_.max_apart.apart ||
        motion_.joined.turned > settings_.max_apart.turned)
      refuse(text("the hands would come %.2f mm and %.2f degrees apart on the path",
                  1e3 * motion_.joined.apart, motion_.joined.turned * 180 / M_PI));
  }

  bool inside_limits(const Trajectory& trajectory) const {
    for (std::size_t i = 0; i < motion_.axes.size(); ++i) {
      const Axis& axis = robot_.axes()[static_cast<std::size_t>(motion_.axes[i])];
      const AxisExtremes e = extremes(trajectory.axes[i]);
      if (e.lowest < axis.lower - kRounding || e.highest > axis.upper + kRounding) return false;
    }
    return true;
  }

  const RobotModel& robot_;
  const Group& group_;
  CollisionWorld& world_;
  const CartesianRequest& request_;
  const CartesianSettings& settings_;
  std::optional<ik::Chain> chain_;
  std::optional<ik::SrsArm> arm_;
  std::optional<ClosedChain> joined_;
  std::vector<std::size_t> given_;  // of each node, its number in the request; the start is 0
  std::vector<ik::Axes> postures_;  // at the nodes
  std::vector<double> times_;
  std::array<int, 3> platform_{-1, -1, -1};  // x, y, heading among the further axes
  Pose T_root_base_{Pose::Identity()};
  CartesianMotion motion_;
};

CartesianMotion plan_cartesian(const RobotModel& robot, const Group& arm, CollisionWorld& world,
                               const CartesianRequest& request, const CartesianSettings& settings) {
  return CartesianPlanning(robot, arm, world, request, settings).run();
}

}  // namespace handsel::trajectory_planner
