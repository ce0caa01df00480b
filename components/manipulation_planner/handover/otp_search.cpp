// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/otp_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/cost/reach_check.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

struct Candidate {
  Pose T_world_object;
  double cost;
  std::optional<PartnerPose> partner{};
};

bool cheaper(const Candidate& a, const Candidate& b) { return a.cost < b.cost; }

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

/// Cost of places and poses of the object, for one person where they are now.
class OtpCosts {
 public:
  OtpCosts(const OtpQuery& query, const settings::ManipulationPlannerSettings& settings)
      : scene_(query.scene),
        person_(query.person),
        layers_(query.layers),
        settings_(settings),
        barred_(query.barred),
        partners_(query.partners),
        taking_arms_(taking_arms(query.person, query.hands, settings)),
        hands_(query.hands),
        vain_offers_(query.vain_offers),
        p_now_(query.T_world_object.translation()),
        object_in_hand_(query.T_tool_object.linear().transpose() *
                        query.T_tool_object.translation()),
        body_(simplified_body(query.person)),
        furniture_(query.person, query.scene.boxes),
        arms_(placed_arms(query.person)) {
    toward_robot_ = query.p_robot.value_or(query.scene.T_world_base.translation()) - torso();
    toward_robot_.z() = 0;
    apart_ = toward_robot_.norm() >= 1e-3;
    toward_robot_.normalize();
  }
  Vector3 torso() const {
    return person_.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  }
  const Vector3& toward_robot() const { return toward_robot_; }
  bool apart() const { return apart_; }  ///< false: they stand inside the robot's base

  enum class Place { good, blocked, out_of_reach, forbidden };
  /// Adds up what speaks against a place; `cost` only of a good one.
  Place of_place(const Vector3& p, double& cost) const {
    if (furniture_.blocked_by(p) != nullptr || inside_box(scene_, p, settings_.otp_furniture_gap))
      return Place::blocked;
    const double comfort = comfort_of_place(p);
    if (comfort >= 1) return Place::out_of_reach;
    const OutsideCost outside = layers_.outside_cost(p);
    if (outside.forbidden_by != nullptr) return Place::forbidden;
    cost =
        settings_.w_comfort * comfort +
        settings_.w_safety * safety_cost(distance_to_body(body_, p), settings_.otp_safety_range) +
        settings_.w_visibility * visibility_cost(person_, p, settings_.otp_visibility_range) +
        settings_.w_effort * (p - p_now_).norm() + outside.cost +
        settings_.w_preference * against_preference(p);
    return Place::good;
  }
  /// Cost of the arm that reaches the place: of the ready hand, where the other reaches too as
  /// much as the least comfortable place of that one; 1: no free hand gets there.
  double comfort_of_place(const Vector3& p) const {
    constexpr double kBarelyReached = 0.99;
    const double better = arm_comfort_cost(layers_.comfort_of(person_.id), arms_, p);
    if (better >= 1) return 1;
    if (hands_.left_free != hands_.right_free)
      return std::max(better,
                      arm_comfort_cost(person_, hands_.left_free ? Side::left : Side::right, p));
    if (!hands_.ready) return better;
    return std::clamp(arm_comfort_cost(person_, *hands_.ready, p), better, kBarelyReached);
  }
  /// Cost by the person's profile: the other side, another distance; 0 without a profile.
  double against_preference(const Vector3& p) const {
    const auto& people = settings_.people;
    const auto profile =
        std::find_if(people.begin(), people.end(),
                     [this](const settings::PersonProfile& one) { return one.id == person_.id; });
    if (profile == people.end()) return 0;
    double cost = 0;
    const auto joint = [this](const char* name) {
      return person_.joints[static_cast<std::size_t>(body_joint_index(name))].position;
    };
    if (profile->handed != settings::Handedness::either) {
      const Vector3 to_left = (joint("l_shoulder") - joint("r_shoulder")).stableNormalized();
      const double off =
          (p - torso())
              .dot(profile->handed == settings::Handedness::left ? Vector3(-to_left) : to_left);
      cost += std::clamp(off / settings_.preference_range, 0.0, 1.0);
    }
    if (profile->preferred_distance > 0)
      cost += std::min(1.0, std::abs((p - torso()).head<2>().norm() - profile->preferred_distance) /
                                settings_.preference_range);
    return cost;
  }
  /// Cost of how the hand holds the object toward the person; nullopt: they could not take it.
  std::optional<double> of_attitude(const Eigen::Matrix3d& R_world_object) const {
    const double facing = (R_world_object * object_in_hand_).normalized().dot(-toward_robot_);
    if (facing < settings_.otp_min_facing) return std::nullopt;
    double in_the_way = 0;
    for (const Vector3& normal : barred_)
      in_the_way = std::max(in_the_way, (R_world_object * normal).dot(-toward_robot_));
    if (in_the_way > settings_.otp_max_barred) return std::nullopt;
    return settings_.w_legibility * ((1 - facing) / 2 + in_the_way);
  }
  /// Cost of a pose near others in which the person did not take the object.
  double of_vain_offers(const Pose& T_world_object) const {
    const auto is_near = [&](const Pose& before) {
      const Eigen::Matrix3d R = before.linear().transpose() * T_world_object.linear();
      return (before.translation() - T_world_object.translation()).norm() <
                 settings_.vain_offer_range &&
             Eigen::AngleAxisd(R).angle() < settings_.vain_offer_turn;
    };
    return settings_.w_vain_offer *
           static_cast<double>(std::count_if(vain_offers_.begin(), vain_offers_.end(), is_near));
  }
  /// Returns whether grasps of the person count: some are known, of a body whose arm is known.
  bool has_partners() const {
    return !partners_.empty() && !taking_arms_.empty() && settings_.w_wrist > 0;
  }
  /// Returns the easiest grasp of the person for an object at a pose; nullopt: there is none.
  std::optional<PartnerPose> partner_at(const Pose& T_world_object) const {
    return easiest_partner(taking_arms_, partners_, T_world_object);
  }
  /// Cost of how the person has to hold wrist and arm.
  double of_partner(const std::optional<PartnerPose>& partner) const {
    if (!has_partners()) return 0;
    return settings_.w_wrist *
           (partner ? partner->strain + partner->hand_cost : settings_.no_partner_strain);
  }

 private:
  const Scene& scene_;
  const Person& person_;
  const LayersNow& layers_;
  const settings::ManipulationPlannerSettings& settings_;
  const std::vector<Vector3>& barred_;
  const std::vector<PartnerGrasp>& partners_;
  std::vector<TakingArm> taking_arms_;
  ReceiverHands hands_;
  const std::vector<Pose>& vain_offers_;
  Vector3 p_now_, object_in_hand_, toward_robot_;
  SimplifiedBody body_;
  ReachCheck furniture_;
  std::vector<PlacedArm> arms_;
  bool apart_{};
};

/// Returns the values from `min` to `max` in steps, each rounded to micrometres so that it does not
/// depend on how the steps add up [m].
std::vector<double> values_between(double min, double max, double step) {
  constexpr double kMicrometres = 1e6;  // in a metre
  const int steps = static_cast<int>(std::floor((max - min) / step + 1e-6));
  std::vector<double> values;
  for (int k = 0; k <= steps; ++k)
    values.push_back(std::round((min + k * step) * kMicrometres) / kMicrometres);
  return values;
}

/// Places and headings of the object before the person, the cheapest first, and how many places
/// were left out.
struct Candidates {
  std::vector<Candidate> all;
  int out_of_reach{}, blocked{}, forbidden{};
};

Candidates find_candidates(const OtpQuery& query, const OtpCosts& costs,
                           const settings::ManipulationPlannerSettings& settings) {
  Candidates found;
  const double shoulder_z =
      query.person.joints[static_cast<std::size_t>(body_joint_index("r_shoulder"))].position.z();
  const Vector3& toward_robot = costs.toward_robot();
  const Vector3 across(-toward_robot.y(), toward_robot.x(), 0);
  const auto add_headings = [&](const Vector3& p, double cost) {
    const int headings = static_cast<int>(settings.otp_headings);
    for (int k = 0; k < headings; ++k) {
      const double yaw = 2 * std::numbers::pi * k / headings;
      Pose T = query.T_world_object;
      T.linear() = Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * query.T_world_object.linear();
      T.translation() = p;
      if (const std::optional<double> attitude = costs.of_attitude(T.linear()))
        found.all.push_back({T, cost + *attitude + costs.of_vain_offers(T)});
    }
  };
  // Symmetric, and straight ahead among them, whatever the step.
  const double max_aside =
      std::floor(settings.otp_max_aside / settings.otp_aside_step + 1e-6) * settings.otp_aside_step;
  const std::vector<double> to_side =
      values_between(-max_aside, max_aside, settings.otp_aside_step);
  const std::vector<double> below_shoulder =
      values_between(settings.otp_min_below, settings.otp_max_below, settings.otp_below_step);
  for (const double ahead :
       values_between(settings.otp_min_ahead, settings.otp_max_ahead, settings.otp_ahead_step)) {
    for (const double aside : to_side) {
      for (const double below : below_shoulder) {
        Vector3 p = costs.torso() + ahead * toward_robot + aside * across;
        p.z() = shoulder_z - below;
        double cost = 0;
        const OtpCosts::Place place = costs.of_place(p, cost);
        found.blocked += place == OtpCosts::Place::blocked;
        found.out_of_reach += place == OtpCosts::Place::out_of_reach;
        found.forbidden += place == OtpCosts::Place::forbidden;
        if (place == OtpCosts::Place::good) add_headings(p, cost);
      }
    }
  }
  std::stable_sort(found.all.begin(), found.all.end(), cheaper);
  return found;
}

/// Adds the cost of the person's grasp to the first `count` poses and sorts those again; the others
/// are left out where some are known.
void add_partners(const OtpCosts& costs, std::size_t count, std::vector<Candidate>& poses) {
  if (!costs.has_partners()) return;
  poses.resize(std::min(count, poses.size()));
  for (Candidate& pose : poses) {
    pose.partner = costs.partner_at(pose.T_world_object);
    pose.cost += costs.of_partner(pose.partner);
  }
  std::stable_sort(poses.begin(), poses.end(), cheaper);
}

/// Returns whether the hand can retreat straight from a configuration of the arm to a pose, no axis
/// turning by more than `max_turn` [rad]. `q`: all axes in that configuration.
bool can_retreat(const RobotModel& robot, const Group& arm, const Vector& q,
                 const Pose& T_root_retreat, double max_turn) {
  IkOptions options;
  options.restarts = 0;
  const auto back = robot.inverse(arm, T_root_retreat, q, options);
  return back && (*back - RobotModel::part(q, arm)).cwiseAbs().maxCoeff() < max_turn;
}

/// A configuration that puts the object into a pose.
struct Reached {
  Vector joints;    ///< axes of the arm [rad]
  bool retreats{};  ///< the hand can retreat from there, or it is not known how
};

/// Returns how the arm puts the object into a pose; nullopt: not at all.
std::optional<Reached> reach(const RobotModel& robot, const Group& arm, const OtpQuery& query,
                             const Pose& T_world_object, const Vector& q,
                             const settings::ManipulationPlannerSettings& settings) {
  IkOptions options;
  options.restarts = 0;
  const Pose T_root_tip =
      query.scene.T_world_base.inverse() * T_world_object * query.T_tool_object.inverse();
  const auto joints = robot.inverse(arm, T_root_tip, q, options);
  if (!joints) return std::nullopt;
  Pose T_root_retreat = T_root_tip;
  if (query.back)
    T_root_retreat.translation() += settings.min_retreat * (T_root_tip.linear() * *query.back);
  return Reached{*joints, !query.back || can_retreat(robot, arm, RobotModel::with(q, arm, *joints),
                                                     T_root_retreat, settings.max_straight_turn)};
}

}  // namespace

std::vector<Vector3> barred_directions(const Grasp& grasp) {
  std::set<std::uint32_t> fingers;
  std::vector<Vector3> normals;
  for (const Contact& contact : grasp.contacts) {
    fingers.insert(contact.finger);
    normals.push_back(contact.normal);
  }
  return fingers.size() == 2 ? normals : std::vector<Vector3>{};
}

OtpSearch find_otp(const RobotModel& robot, const Group& arm, const OtpQuery& query,
                   const Vector& q, const settings::ManipulationPlannerSettings& settings) {
  OtpSearch out;
  const OtpCosts costs(query, settings);
  if (!costs.apart()) {
    out.reason = "person " + query.person.id + " stands inside the robot's base";
    return out;
  }
  Candidates candidates = find_candidates(query, costs, settings);
  add_partners(costs, settings.partner_poses, candidates.all);
  int unreachable = 0;
  std::vector<OtpPose> confined;  // the hand could not retreat
  for (const Candidate& candidate : candidates.all) {
    if (!out.poses.empty() && candidate.cost > out.poses.front().cost + settings.otp_extra_cost)
      break;
    const auto is_near = [&](const OtpPose& pose) {
      return (pose.T_world_object.translation() - candidate.T_world_object.translation()).norm() <
             settings.otp_apart;
    };
    if (std::any_of(out.poses.begin(), out.poses.end(), is_near)) continue;
    if (out.poses.size() >= settings.exchange_goals || out.tried >= settings.handover_tries) break;
    ++out.tried;
    std::optional<Reached> reached =
        reach(robot, arm, query, candidate.T_world_object, q, settings);
    if (!reached) {
      ++unreachable;
      continue;
    }
    (reached->retreats ? out.poses : confined)
        .push_back({candidate.T_world_object, std::move(reached->joints), candidate.cost,
                    candidate.partner});
  }
  if (out.poses.empty() && !confined.empty()) out.poses = {confined.front()};
  if (out.poses.empty())
    out.reason = "no exchange point with " + query.person.id + ": " +
                 std::to_string(candidates.out_of_reach) + " places beyond their reach, " +
                 std::to_string(candidates.blocked) + " in, under or behind furniture, " +
                 (candidates.forbidden > 0
                      ? std::to_string(candidates.forbidden) + " forbidden by a cost layer, "
                      : "") +
                 std::to_string(unreachable) + " of " + std::to_string(out.tried) +
                 " poses beyond the robot's reach";
  return out;
}

std::vector<TakingArm> taking_arms(const Person& person, const ReceiverHands& hands,
                                   const settings::ManipulationPlannerSettings& settings) {
  std::vector<TakingArm> arms;
  for (const Side side : {Side::right, Side::left}) {
    const std::optional<double> cost = hand_cost(hands, side, person.id, settings);
    const std::optional<HumanArm> arm = human_arm(person, side);
    if (cost && arm) arms.push_back({*arm, *cost});
  }
  return arms;
}

std::optional<PartnerPose> easiest_partner(const std::vector<TakingArm>& arms,
                                           const std::vector<PartnerGrasp>& partners,
                                           const Pose& T_world_object) {
  std::optional<PartnerPose> best;
  for (const TakingArm& taking : arms) {
    for (const PartnerGrasp& partner : partners) {
      if (partner.side != taking.arm.side) continue;
      const Pose T_world_wrist = T_world_object * partner.T_object_wrist;
      const auto wrist = wrist_posture(taking.arm, T_world_wrist);
      if (!wrist || wrist->strain > 1) continue;
      if (best && best->strain + best->hand_cost <= wrist->strain + taking.hand_cost) continue;
      best = PartnerPose{partner.id, partner.side, T_world_wrist, wrist->strain, taking.hand_cost};
    }
  }
  return best;
}

OtpSearch shifted_otp(const RobotModel& robot, const Group& arm, const OtpQuery& query,
                      const PoseShift& wanted, const Vector& q,
                      const settings::ManipulationPlannerSettings& settings) {
  constexpr double kRatios[] = {1.0, 0.75, 0.5, 0.25};
  constexpr int kMaxTurn = 4;  // steps of the headings of a search
  OtpSearch out;
  const OtpCosts costs(query, settings);
  const Pose& T_world_object = wanted.T_world_object;
  const Vector3 shift = wanted.p_wanted - T_world_object.translation();
  int no_place = 0, no_grasp = 0;
  for (const double ratio : kRatios) {
    if (ratio * shift.norm() < settings.min_shift) break;
    for (int k = 0; k <= 2 * kMaxTurn; ++k) {
      const int steps = (k % 2 == 0 ? 1 : -1) * ((k + 1) / 2);
      const double turn = steps * 2 * std::numbers::pi / static_cast<int>(settings.otp_headings);
      Pose T_shifted = T_world_object;
      T_shifted.translation() += ratio * shift;
      T_shifted.linear() = Eigen::AngleAxisd(turn, Vector3::UnitZ()) * T_world_object.linear();
      const std::optional<double> cost = otp_cost(query, T_shifted, settings);
      const std::optional<PartnerPose> partner = costs.partner_at(T_shifted);
      const bool is_of_ready_hand =
          partner && (!query.hands.ready || partner->side == *query.hands.ready);
      const bool is_graspable = is_of_ready_hand || !costs.has_partners();
      no_place += !cost;
      no_grasp += cost && !is_graspable;
      if (!cost || !is_graspable) continue;
      ++out.tried;
      std::optional<Reached> reached = reach(robot, arm, query, T_shifted, q, settings);
      if (!reached || !reached->retreats) continue;
      out.poses.push_back({T_shifted, std::move(reached->joints), *cost, partner});
      return out;
    }
  }
  out.reason = "no exchange point with " + query.person.id +
               " where attention wants one: " + std::to_string(no_place) + " poses are none, " +
               std::to_string(no_grasp) + " fit no grasp of theirs, " + std::to_string(out.tried) +
               " beyond the robot's reach";
  return out;
}

std::optional<double> otp_cost(const OtpQuery& query, const Pose& T_world_object,
                               const settings::ManipulationPlannerSettings& settings) {
  const OtpCosts costs(query, settings);
  double cost = 0;
  if (!costs.apart() || costs.of_place(T_world_object.translation(), cost) != OtpCosts::Place::good)
    return std::nullopt;
  const std::optional<double> attitude = costs.of_attitude(T_world_object.linear());
  if (!attitude) return std::nullopt;
  const double wrist =
      costs.has_partners() ? costs.of_partner(costs.partner_at(T_world_object)) : 0.0;
  return cost + *attitude + wrist + costs.of_vain_offers(T_world_object);
}

}  // namespace handsel::manipulation_planner
