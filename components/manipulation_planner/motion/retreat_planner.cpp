#include "components/manipulation_planner/motion/retreat_planner.hpp"

#include <algorithm>
#include <limits>

#include "common/geometry/segments.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {

namespace {

constexpr double kNear = 0.12;       // where the guard lets nothing but going away pass, about [m]
constexpr double kAway = 0.6;        // of the way a link goes, more than the guard asks for
constexpr double kStep = 0.01;       // [m]
constexpr double kLookAhead = 0.02;  // of a motion, by its fastest axis [rad, m]
constexpr double kDamping = 1e-3;
constexpr double kMost = 0.1;  // that one axis turns for a step [rad, m]

struct Placed {
  Vector3 a, b;
};
Placed placed(const LinkCapsule& capsule, const std::vector<Pose>& T_root_link, const Pose& T_world_root) {
  const Pose T = T_world_root * T_root_link[static_cast<std::size_t>(capsule.link)];
  return {T * capsule.a, T * capsule.b};
}

}  // namespace

WayOut::WayOut(const RobotModel& robot, const Group& arm) : robot_(robot), arm_(arm), capsules_(robot_capsules(robot)) {}

bool WayOut::within_limits(const Vector& posture) const {
  return std::all_of(arm_.axes.begin(), arm_.axes.end(), [&](int axis) {
    const Axis& limits = robot_.axes()[axis];
    return limits.lower >= limits.upper || (posture[axis] > limits.lower && posture[axis] < limits.upper);
  });
}

std::vector<Pose> WayOut::links(const Vector& posture) const {
  std::vector<Pose> out;
  robot_.forward(posture, out);
  return out;
}

bool WayOut::leads_away(const Vector& from, const Vector& to, const Pose& T_world_base, const HumanState& people) const {
  const double farthest = (to - from).cwiseAbs().maxCoeff();
  if (farthest < 1e-9) return true;
  const std::vector<Pose> before = links(from), after = links(from + std::min(1.0, kLookAhead / farthest) * (to - from));
  Vector3 on_robot, on_person;
  for (const Person& person : people.people) {
    for (const BodyCapsule& part : body_capsules(person)) {
      for (const LinkCapsule& link : capsules_) {
        const Placed old = placed(link, before, T_world_base), now = placed(link, after, T_world_base);
        const double moved = std::max((now.a - old.a).norm(), (now.b - old.b).norm());
        if (moved < 1e-6) continue;
        const double was = nearest_points(old.a, old.b, part.a, part.b, on_robot, on_person);
        if (std::sqrt(was) - link.radius - part.radius > kNear) continue;
        const double is = nearest_points(now.a, now.b, part.a, part.b, on_robot, on_person);
        if (std::sqrt(is) - std::sqrt(was) < kAway * moved) return false;
      }
    }
  }
  return true;
}

double WayOut::distance(const Vector& posture, const Pose& T_world_base, const Vector3& p_world) const {
  const std::vector<Pose> T_root_link = links(posture);
  double least = std::numeric_limits<double>::infinity();
  Vector3 on_robot, on_point;
  for (const LinkCapsule& link : capsules_) {
    const Placed arm = placed(link, T_root_link, T_world_base);
    least = std::min(least, std::sqrt(nearest_points(arm.a, arm.b, p_world, p_world, on_robot, on_point)) - link.radius);
  }
  return least;
}

std::vector<Vector> WayOut::steps_away(const Vector& from, const Pose& T_world_base, const HumanState& people, double way) const {
  struct Near {
    int link{};
    Vector3 in_link, at, away;
  };
  std::vector<Vector> out;
  const auto n = static_cast<Eigen::Index>(arm_.axes.size());
  Vector posture = from;
  for (double gone = 0.0; gone < way; gone += kStep) {
    const std::vector<Pose> T_root_link = links(posture);
    std::vector<Near> near;
    for (const Person& person : people.people) {
      for (const BodyCapsule& part : body_capsules(person)) {
        for (const LinkCapsule& link : capsules_) {
          const Placed arm = placed(link, T_root_link, T_world_base);
          Vector3 on_robot, on_person;
          const double apart = std::sqrt(nearest_points(arm.a, arm.b, part.a, part.b, on_robot, on_person));
          if (apart < 1e-9 || apart - link.radius - part.radius > kNear) continue;
          const Pose T_world_link = T_world_base * T_root_link[static_cast<std::size_t>(link.link)];
          near.push_back({link.link, T_world_link.inverse() * on_robot, on_robot, (on_robot - on_person) / apart});
        }
      }
    }
    if (near.empty()) break;
    Eigen::MatrixXd rates(static_cast<Eigen::Index>(near.size()), n);  // of each distance, by each axis of the arm
    for (Eigen::Index i = 0; i < n; ++i) {
      constexpr double kSmall = 1e-5;
      Vector turned = posture;
      turned[arm_.axes[static_cast<std::size_t>(i)]] += kSmall;
      const std::vector<Pose> T_root_turned = links(turned);
      for (Eigen::Index k = 0; k < rates.rows(); ++k) {
        const Near& one = near[static_cast<std::size_t>(k)];
        const Vector3 there = T_world_base * T_root_turned[static_cast<std::size_t>(one.link)] * one.in_link;
        rates(k, i) = (there - one.at).dot(one.away) / kSmall;
      }
    }
    const Eigen::MatrixXd normal = rates * rates.transpose() + kDamping * Eigen::MatrixXd::Identity(rates.rows(), rates.rows());
    const Vector change = rates.transpose() * normal.ldlt().solve(Vector::Constant(rates.rows(), kStep));
    Vector next = posture;
    for (Eigen::Index i = 0; i < n; ++i) next[arm_.axes[static_cast<std::size_t>(i)]] += change[i];
    if (change.cwiseAbs().maxCoeff() > kMost || !within_limits(next) || !leads_away(posture, next, T_world_base, people)) break;
    posture = next;
    Vector arm(n);
    for (Eigen::Index i = 0; i < n; ++i) arm[i] = posture[arm_.axes[static_cast<std::size_t>(i)]];
    out.push_back(std::move(arm));
  }
  return out;
}

}  // namespace handsel::manipulation_planner
