// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/motion/retreat_planner.hpp"

#include <algorithm>
#include <limits>

#include "common/geometry/segments.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {

namespace {

constexpr double kDamping = 1e-3;   // of the least-squares solution
constexpr double kRounding = 1e-9;  // of the number of steps

struct Placed {
  Vector3 a, b;
};
Placed placed(const LinkCapsule& capsule, const std::vector<Pose>& T_root_link,
              const Pose& T_world_root) {
  const Pose T = T_world_root * T_root_link[static_cast<std::size_t>(capsule.link)];
  return {T * capsule.a, T * capsule.b};
}

}  // namespace

RetreatPlanner::RetreatPlanner(const RobotModel& robot, const Group& arm,
                               const settings::ManipulationPlannerSettings& settings)
    : robot_(robot), arm_(arm), settings_(settings), capsules_(robot_capsules(robot)) {}

bool RetreatPlanner::within_limits(const Vector& q) const {
  return std::all_of(arm_.axes.begin(), arm_.axes.end(), [&](int axis) {
    const Axis& limits = robot_.axes()[axis];
    return limits.lower >= limits.upper || (q[axis] > limits.lower && q[axis] < limits.upper);
  });
}

std::vector<Pose> RetreatPlanner::links(const Vector& q) const {
  std::vector<Pose> out;
  robot_.forward(q, out);
  return out;
}

bool RetreatPlanner::leads_away(const Vector& from, const Vector& to, const Pose& T_world_base,
                                const HumanState& people) const {
  const double farthest = (to - from).cwiseAbs().maxCoeff();
  if (farthest < 1e-9) return true;
  const std::vector<Pose> before = links(from),
                          after =
                              links(from + std::min(1.0, settings_.retreat_lookahead / farthest) *
                                               (to - from));
  Vector3 on_robot, on_person;
  for (const Person& person : people.people) {
    for (const BodyCapsule& part : body_capsules(person)) {
      for (const LinkCapsule& link : capsules_) {
        const Placed old = placed(link, before, T_world_base),
                     now = placed(link, after, T_world_base);
        const double moved = std::max((now.a - old.a).norm(), (now.b - old.b).norm());
        if (moved < 1e-6) continue;
        const double was = nearest_points(old.a, old.b, part.a, part.b, on_robot, on_person);
        if (std::sqrt(was) - link.radius - part.radius > settings_.retreat_range) continue;
        const double is = nearest_points(now.a, now.b, part.a, part.b, on_robot, on_person);
        if (std::sqrt(is) - std::sqrt(was) < settings_.retreat_ratio * moved) return false;
      }
    }
  }
  return true;
}

double RetreatPlanner::distance(const Vector& q, const Pose& T_world_base,
                                const Vector3& p_world) const {
  const std::vector<Pose> T_root_link = links(q);
  double min = std::numeric_limits<double>::infinity();
  Vector3 on_robot, on_point;
  for (const LinkCapsule& link : capsules_) {
    const Placed arm = placed(link, T_root_link, T_world_base);
    min = std::min(min,
                   std::sqrt(nearest_points(arm.a, arm.b, p_world, p_world, on_robot, on_point)) -
                       link.radius);
  }
  return min;
}

double RetreatPlanner::separation(const Vector& q, const Pose& T_world_base,
                                  const HumanState& people, const std::string& partner) const {
  SeparationExemption exempt;
  exempt.person = partner;
  return handsel::separation(capsules_, links(q), T_world_base, people, exempt).distance;
}

std::vector<Vector> RetreatPlanner::steps_away(const Vector& from, const Pose& T_world_base,
                                               const HumanState& people,
                                               double max_distance) const {
  struct Near {
    int link{};
    Vector3 in_link, at, away;
  };
  std::vector<Vector> out;
  const auto n = static_cast<Eigen::Index>(arm_.axes.size());
  Vector q = from;
  const int steps = static_cast<int>(std::ceil(max_distance / settings_.retreat_step - kRounding));
  for (int step = 0; step < steps; ++step) {
    const std::vector<Pose> T_root_link = links(q);
    std::vector<Near> near;
    for (const Person& person : people.people) {
      for (const BodyCapsule& part : body_capsules(person)) {
        for (const LinkCapsule& link : capsules_) {
          const Placed arm = placed(link, T_root_link, T_world_base);
          Vector3 on_robot, on_person;
          const double apart =
              std::sqrt(nearest_points(arm.a, arm.b, part.a, part.b, on_robot, on_person));
          if (apart < 1e-9 || apart - link.radius - part.radius > settings_.retreat_range) continue;
          const Pose T_world_link = T_world_base * T_root_link[static_cast<std::size_t>(link.link)];
          near.push_back({link.link, T_world_link.inverse() * on_robot, on_robot,
                          (on_robot - on_person) / apart});
        }
      }
    }
    if (near.empty()) break;
    Eigen::MatrixXd rates(static_cast<Eigen::Index>(near.size()),
                          n);  // of each distance, by each axis of the arm
    for (Eigen::Index i = 0; i < n; ++i) {
      constexpr double kSmall = 1e-5;
      Vector turned = q;
      turned[arm_.axes[static_cast<std::size_t>(i)]] += kSmall;
      const std::vector<Pose> T_root_turned = links(turned);
      for (Eigen::Index k = 0; k < rates.rows(); ++k) {
        const Near& one = near[static_cast<std::size_t>(k)];
        const Vector3 there =
            T_world_base * T_root_turned[static_cast<std::size_t>(one.link)] * one.in_link;
        rates(k, i) = (there - one.at).dot(one.away) / kSmall;
      }
    }
    const Eigen::MatrixXd normal = rates * rates.transpose() +
                                   kDamping * Eigen::MatrixXd::Identity(rates.rows(), rates.rows());
    const Vector change = rates.transpose() * normal.ldlt().solve(Vector::Constant(
                                                  rates.rows(), settings_.retreat_step));
    Vector next = q;
    for (Eigen::Index i = 0; i < n; ++i) next[arm_.axes[static_cast<std::size_t>(i)]] += change[i];
    if (change.cwiseAbs().maxCoeff() > settings_.retreat_max_turn || !within_limits(next) ||
        !leads_away(q, next, T_world_base, people))
      break;
    q = next;
    Vector arm(n);
    for (Eigen::Index i = 0; i < n; ++i) arm[i] = q[arm_.axes[static_cast<std::size_t>(i)]];
    out.push_back(std::move(arm));
  }
  return out;
}

std::vector<Vector3> retreat_directions(const Pose& T_world_tool, const Vector3& p_world_from,
                                        const Vector3& p_world_base) {
  const Vector3 p_tool = T_world_tool.translation();
  Vector3 level = p_tool - p_world_from;
  level.z() = 0;
  if (level.norm() < 1e-3) level = p_world_base - p_tool;
  level.z() = 0;
  level.normalize();
  const Vector3 up = Vector3::UnitZ(), aside = up.cross(level),
                hand_back = -T_world_tool.linear().col(2);
  return {hand_back,
          level,
          (level + up).normalized(),
          up,
          (level - up).normalized(),
          (level + aside).normalized(),
          (level - aside).normalized()};
}

}  // namespace handsel::manipulation_planner
