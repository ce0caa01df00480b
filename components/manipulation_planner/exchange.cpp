#include "components/manipulation_planner/exchange.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/cost/reach_check.hpp"
#include "common/model/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr int kHeadings = 24;
constexpr double kWorthwhile = 0.25;   // poses this much costlier than the best are not offered as alternatives
constexpr double kBarred = 0.5;        // cosine: a finger in the way of the person's pull
constexpr double kLeastFacing = -0.3;  // cosine: the hand may not come from the person's side

struct Place {
  Pose T_world_object;
  double cost;
};

bool inside_box(const Scene& scene, const Vector3& p, double margin) {
  return std::any_of(scene.boxes.begin(), scene.boxes.end(), [&](const SceneBox& box) {
    const Vector3 local = box.T_world_box.inverse() * p;
    return (local.array().abs() <= box.size.array() / 2 + margin).all();
  });
}

double distance_to_body(const SimplifiedBody& body, const Vector3& p) {
  const Vector3 low = body.axis_bottom, high = body.axis_bottom + Vector3(0, 0, body.height);
  const double z = std::clamp(p.z(), low.z(), high.z());
  const double to_axis = (p - Vector3(low.x(), low.y(), z)).norm() - body.radius;
  return std::min(to_axis, (p - body.head).norm() - body.head_radius);
}

}  // namespace

std::vector<Vector3> barred_ways(const Grasp& grasp) {
  std::set<std::uint32_t> fingers;
  std::vector<Vector3> normals;
  for (const Contact& contact : grasp.contacts) {
    fingers.insert(contact.finger);
    normals.push_back(contact.normal);
  }
  return fingers.size() == 2 ? normals : std::vector<Vector3>{};
}

ExchangeSearch find_exchange(const RobotModel& robot, const Scene& scene, const Person& person, const LayersNow& layers, const Vector& q,
                             const Pose& T_world_object_now, const Pose& T_tool_object, const config::ManipulationPlannerSettings& settings,
                             const std::vector<Vector3>& barred) {
  ExchangeSearch out;
  const Group& arm = robot.require_group("arm");
  const Vector3 torso = person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  const double shoulder_z = person.joints[static_cast<std::size_t>(body_joint_index("r_shoulder"))].position.z();
  Vector3 toward_robot = scene.T_world_base.translation() - torso;
  toward_robot.z() = 0;
  if (toward_robot.norm() < 1e-3) {
    out.reason = "person " + person.id + " stands inside the robot's base";
    return out;
  }
  toward_robot.normalize();
  const Vector3 across(-toward_robot.y(), toward_robot.x(), 0);
  const SimplifiedBody body = simplified_body(person);
  const Vector3 palm_to_object = T_tool_object.translation();
  const ReachCheck furniture(person, scene.boxes);
  const std::vector<PlacedArm> arms = placed_arms(person);

  std::vector<Place> places;
  int out_of_reach = 0, blocked = 0, forbidden = 0;
  for (const double ahead : {0.42, 0.5, 0.58, 0.66, 0.74, 0.82}) {
    for (const double aside : {-0.36, -0.24, -0.12, 0.0, 0.12, 0.24, 0.36}) {
      for (const double below : {0.05, 0.15, 0.25, 0.35, 0.45, 0.55}) {
        Vector3 p = torso + ahead * toward_robot + aside * across;
        p.z() = shoulder_z - below;
        if (furniture.blocked_by(p) != nullptr || inside_box(scene, p, 0.12)) {
          ++blocked;
          continue;
        }
        const double comfort = arm_comfort_cost(layers.comfort_of(person.id), arms, p);
        if (comfort >= 1) {
          ++out_of_reach;
          continue;
        }
        const OutsideCost outside = layers.outside_cost(p);
        if (outside.forbidden_by != nullptr) {
          ++forbidden;
          continue;
        }
        const double base_cost = settings.w_comfort() * comfort + settings.w_safety() * safety_cost(distance_to_body(body, p), 0.8) +
                                 settings.w_visibility() * visibility_cost(person, p, 3.0) +
                                 settings.w_effort() * (p - T_world_object_now.translation()).norm() + outside.cost;
        for (int k = 0; k < kHeadings; ++k) {
          const double yaw = 2 * std::numbers::pi * k / kHeadings;
          Pose T = T_world_object_now;
          T.linear() = Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * T_world_object_now.linear();
          T.translation() = p;
          const Vector3 reach = (T.linear() * T_tool_object.linear().transpose() * palm_to_object).normalized();
          const double facing = reach.dot(-toward_robot);
          if (facing < kLeastFacing) continue;
          double in_the_way = 0;
          for (const Vector3& normal : barred) in_the_way = std::max(in_the_way, (T.linear() * normal).dot(-toward_robot));
          if (in_the_way > kBarred) continue;
          places.push_back({T, base_cost + settings.w_legibility() * ((1 - facing) / 2 + in_the_way)});
        }
      }
    }
  }
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.cost < b.cost; });

  IkOptions options;
  options.restarts = 0;
  int unreachable = 0;
  for (const auto& place : places) {
    if (!out.poses.empty() && place.cost > out.poses.front().cost + kWorthwhile) break;
    const bool offered = std::any_of(out.poses.begin(), out.poses.end(), [&](const ExchangePose& pose) {
      return (pose.T_world_object.translation() - place.T_world_object.translation()).norm() < 0.05;
    });
    if (offered) continue;
    if (out.poses.size() >= settings.exchange_goals() || out.tried >= settings.exchange_tries()) break;
    ++out.tried;
    const Pose T_root_tip = scene.T_world_base.inverse() * place.T_world_object * T_tool_object.inverse();
    if (auto joints = robot.inverse(arm, T_root_tip, q, options))
      out.poses.push_back({place.T_world_object, std::move(*joints), place.cost});
    else
      ++unreachable;
  }
  if (out.poses.empty())
    out.reason = "no exchange point with " + person.id + ": " + std::to_string(out_of_reach) + " places beyond their reach, " +
                 std::to_string(blocked) + " in, under or behind furniture, " +
                 (forbidden > 0 ? std::to_string(forbidden) + " forbidden by a cost layer, " : "") + std::to_string(unreachable) + " of " +
                 std::to_string(out.tried) + " poses beyond the robot's reach";
  return out;
}

}  // namespace handsel::manipulation_planner
