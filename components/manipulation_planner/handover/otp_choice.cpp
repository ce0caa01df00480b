// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/handover/otp_choice.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "common/cost/person_frame.hpp"
#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {
namespace {

const Vector3& trunk_of(const Person& person) {
  return person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
}

ReceiverTarget target_of(const Person& person, const ReceiverHands& hands) {
  const Vector3 facing = torso_axes(person).col(0).cwiseProduct(Vector3(1, 1, 0));
  return {person.id, trunk_of(person), facing.stableNormalized(), hands};
}

/// Looks at the hands of the receiver again.
const ReceiverHands& look_at_hands(Parts& parts, const Person& receiver) {
  parts.receiver_hands =
      hands_of(receiver, parts.now.scene(), T_world_platform(parts.now).translation(),
               parts.settings, &parts.receiver_hands);
  return parts.receiver_hands;
}

/// Returns whether the receiver has gone away, turned, or changed hands.
bool has_changed(const ReceiverTarget& before, const ReceiverTarget& now,
                 const settings::ManipulationPlannerSettings& settings) {
  return (now.p_world_torso - before.p_world_torso).norm() >= settings.follow_step ||
         std::acos(std::clamp(now.facing.dot(before.facing), -1.0, 1.0)) >= settings.follow_turn ||
         now.hands != before.hands;
}

bool is_goal_of(const MotionSpec& motion, const Vector& q,
                const settings::ManipulationPlannerSettings& settings) {
  return std::any_of(motion.goals.begin(), motion.goals.end(), [&](const Vector& goal) {
    return (goal - q).lpNorm<Eigen::Infinity>() < settings.otp_same_goal;
  });
}

}  // namespace

Routine<OtpChoice> choose_otp(Parts& parts, const std::string& receiver, const Pose* T_world_object,
                              std::optional<OtpShift> shift) {
  auto choice = std::make_shared<OtpChoice>();
  const Person* person = parts.now.person(receiver);
  if (person == nullptr) {
    choice->outcome = Outcome::out_of_sight("person " + receiver);
    co_return *choice;
  }
  const std::optional<Pose> T_present =
      T_world_object != nullptr ? std::optional<Pose>(*T_world_object) : std::nullopt;
  const auto& grasp = parts.held.grasp();
  const std::function<void()> job =
      [choice, T_present, shift, robot = parts.arm.shared_robot(), arm = parts.arm.group(),
       scene = parts.now.scene(), layers = parts.now.layers(), who = *person,
       q = parts.now.set_point(), T_tool_object = parts.held.attachment().T_tool_object,
       T_now = parts.held.T_world_object(),
       barred = grasp ? barred_directions(*grasp) : std::vector<Vector3>{},
       partners = grasp ? grasp->partners : std::vector<PartnerGrasp>{},
       hands = look_at_hands(parts, *person), settings = parts.settings,
       back = grasp ? std::optional<Vector3>(parts.arm.direction_back(*grasp)) : std::nullopt,
       p_robot = Vector3(T_world_platform(parts.now).translation()),
       vain_offers = parts.held.vain_offers()] {
        const OtpQuery query{scene,    who,   layers, T_now,   T_tool_object, barred,
                             partners, hands, back,   p_robot, vain_offers};
        if (T_present && shift)
          choice->search = shifted_otp(*robot, arm, query, {*T_present, shift->p_wanted},
                                       RobotModel::with(q, arm, shift->arm_joints), settings);
        else
          choice->search = find_otp(*robot, arm, query, q, settings);
        if (T_present) choice->present_cost = otp_cost(query, *T_present, settings);
      };
  choice->outcome = co_await parts.worker.run(job);
  co_return *choice;
}

namespace {

void show(const std::optional<PartnerPose>& partner, ActionStatus& action) {
  action.has_partner = partner.has_value();
  action.partner_side = partner ? partner->side : Side::right;
  action.T_world_partner_wrist = partner ? partner->T_world_wrist : Pose::Identity();
  action.partner_strain = partner ? partner->strain : 0.0;
}

/// Returns the easiest grasp of the receiver for what the hand holds, at a pose of it; nullopt:
/// none is known, or none fits.
std::optional<PartnerPose> partner_at(const Parts& parts, const Person& receiver,
                                      const Pose& T_world_object) {
  const auto& grasp = parts.held.grasp();
  if (!grasp) return std::nullopt;
  return easiest_partner(taking_arms(receiver, parts.receiver_hands, parts.settings),
                         grasp->partners, T_world_object);
}

/// Returns the pose of what is held where the arm has a configuration.
Pose T_world_held_at(const Parts& parts, const Vector& arm_joints) {
  const Vector q = RobotModel::with(parts.arm.configuration(), parts.arm.group(), arm_joints);
  return parts.now.T_world_base() * parts.arm.robot().link_pose(q, parts.arm.palm()) *
         parts.held.attachment().T_tool_object;
}

}  // namespace

void show(const OtpPose& pose, ActionStatus& action) {
  action.exchange_point = pose.T_world_object.translation();
  show(pose.partner, action);
}

void show_offered(Parts& parts, const std::string& receiver) {
  OtpPose offered;
  offered.T_world_object = parts.held.T_world_object();
  const Person* person = parts.now.person(receiver);
  if (person != nullptr) {
    if (parts.settings.follow_receiver) look_at_hands(parts, *person);
    offered.partner = partner_at(parts, *person, offered.T_world_object);
  }
  // A person who has taken hold on the way uses the grasp that the handover is planned for.
  const bool is_planned = offered.partner || !parts.held.is_taken_by(receiver);
  if (is_planned)
    show(offered, parts.action);
  else
    parts.action.exchange_point = offered.T_world_object.translation();
}

void aim_at(const OtpSearch& search, const Person& receiver, const ReceiverHands& hands,
            MotionSpec& motion) {
  motion.goals.clear();
  for (const auto& pose : search.poses) motion.goals.push_back(pose.arm_joints);
  motion.receiver = target_of(receiver, hands);
}

Routine<bool> follow_receiver(Parts& parts, MotionSpec& motion, const Vector& goal) {
  const auto& settings = parts.settings;
  const std::string receiver = motion.receiver->person;
  const Person* person = parts.now.person(receiver);
  if (!settings.follow_receiver || person == nullptr) co_return false;
  const ReceiverTarget now = target_of(*person, look_at_hands(parts, *person));
  const bool is_astray = parts.arm.at_rest() && !is_goal_of(motion, goal, settings);
  if (!is_astray && !has_changed(*motion.receiver, now, settings)) co_return false;
  const Pose T_world_object = T_world_held_at(parts, goal);
  OtpChoice choice = co_await choose_otp(parts, receiver, &T_world_object);
  person = parts.now.person(receiver);
  if (!choice.outcome.good || person == nullptr) co_return false;
  if (choice.search.poses.empty()) co_return !choice.present_cost;
  const double distance =
      (T_world_object.translation() - parts.held.T_world_object().translation()).norm();
  const double gain =
      distance < settings.commit_distance ? settings.commit_gain : settings.follow_gain;
  if (choice.present_cost && *choice.present_cost <= choice.search.poses.front().cost + gain) {
    if (!is_goal_of(motion, goal, settings)) motion.goals = {goal};
    motion.receiver = now;
    show(partner_at(parts, *person, T_world_object), parts.action);
    co_return false;
  }
  aim_at(choice.search, *person, now.hands, motion);
  show(choice.search.poses.front(), parts.action);
  parts.shift.note_choice(parts.action.exchange_point, parts.now.time());
  co_return true;
}

Routine<bool> follow_shift(Parts& parts, MotionSpec& motion, const Vector& goal) {
  const std::string receiver = motion.receiver->person;
  const Person* person = parts.now.person(receiver);
  if (!parts.settings.follow_receiver || person == nullptr) co_return false;
  const Pose T_world_object = T_world_held_at(parts, goal);
  if ((T_world_object.translation() - parts.action.exchange_point).norm() >
      parts.settings.otp_same_point) {
    if (!is_goal_of(motion, goal, parts.settings))
      co_return false;  // it is still to be led to the shifted one
    // Of several poses found, the motion leads to another one than was reported.
    show({T_world_object, goal, 0, partner_at(parts, *person, T_world_object)}, parts.action);
    if (parts.shift.is_another_choice(T_world_object.translation()))
      parts.shift.note_choice(T_world_object.translation(), parts.now.time());
    co_return false;
  }
  const std::optional<Vector3> p_wanted =
      parts.shift.wanted(T_world_object.translation(), parts.now.time());
  if (!p_wanted) co_return false;
  const OtpShift shift{*p_wanted, goal};
  OtpChoice choice = co_await choose_otp(parts, receiver, &T_world_object, shift);
  person = parts.now.person(receiver);
  if (!choice.outcome.good || person == nullptr) co_return false;
  if (choice.search.poses.empty()) {
    parts.shift.note_refusal(*p_wanted);
    parts.refuse("shift of the exchange point", choice.search.reason);
    co_return false;
  }
  aim_at(choice.search, *person, parts.receiver_hands, motion);
  show(choice.search.poses.front(), parts.action);
  parts.shift.note_change(parts.action.exchange_point, parts.now.time());
  co_return true;
}

}  // namespace handsel::manipulation_planner
