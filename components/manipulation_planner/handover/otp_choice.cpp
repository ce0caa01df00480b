#include "components/manipulation_planner/handover/otp_choice.hpp"

#include <functional>
#include <memory>

#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kMinStep = 0.1;   // a receiver who moved less is where they were [m]
constexpr double kMinGain = 0.05;  // cost that another object transfer point must save

const Vector3& trunk_of(const Person& person) {
  return person.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
}

}  // namespace

Routine<OtpChoice> choose_otp(Parts& parts, const std::string& receiver,
                              const Pose* T_world_object) {
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
      [choice, T_present, robot = parts.arm.shared_robot(), arm = parts.arm.group(),
       scene = parts.now.scene(), layers = parts.now.layers(), who = *person,
       q = parts.now.set_point(), T_tool_object = parts.held.attachment().T_tool_object,
       T_now = parts.held.T_world_object(),
       barred = grasp ? barred_directions(*grasp) : std::vector<Vector3>{},
       partners = grasp ? grasp->partners : std::vector<PartnerGrasp>{},
       settings = parts.settings] {
        const OtpQuery query{scene, who, layers, T_now, T_tool_object, barred, partners};
        choice->search = find_otp(*robot, arm, query, q, settings);
        if (T_present) choice->present_cost = otp_cost(query, *T_present, settings);
      };
  choice->outcome = co_await parts.worker.run(job);
  co_return *choice;
}

void show(const OtpPose& pose, ActionStatus& action) {
  action.exchange_point = pose.T_world_object.translation();
  action.has_partner = pose.partner.has_value();
  action.T_world_partner_wrist = pose.partner ? pose.partner->T_world_wrist : Pose::Identity();
  action.partner_strain = pose.partner ? pose.partner->strain : 0.0;
}

void show_offered(const Parts& parts, const std::string& receiver, ActionStatus& action) {
  OtpPose offered;
  offered.T_world_object = parts.held.T_world_object();
  const Person* person = parts.now.person(receiver);
  const auto arm = person != nullptr ? human_arm(*person, Side::right) : std::nullopt;
  const auto& grasp = parts.held.grasp();
  if (arm && grasp)
    offered.partner = easiest_partner(*arm, grasp->partners, offered.T_world_object);
  show(offered, action);
}

void aim_at(const OtpSearch& search, const Person& receiver, MotionSpec& motion) {
  motion.goals.clear();
  for (const auto& pose : search.poses) motion.goals.push_back(pose.arm_joints);
  motion.receiver = ReceiverTarget{receiver.id, trunk_of(receiver)};
}

Routine<bool> follow_receiver(Parts& parts, MotionSpec& motion, const Vector& goal) {
  const std::string receiver = motion.receiver->person;
  const Person* person = parts.now.person(receiver);
  if (person == nullptr) co_return false;
  const Vector3 p_torso = trunk_of(*person);
  if ((p_torso - motion.receiver->p_world_torso).norm() < kMinStep) co_return false;
  const Vector q = RobotModel::with(parts.arm.configuration(), parts.arm.group(), goal);
  const Pose T_world_object = parts.now.T_world_base() *
                              parts.arm.robot().link_pose(q, parts.arm.palm()) *
                              parts.held.attachment().T_tool_object;
  OtpChoice choice = co_await choose_otp(parts, receiver, &T_world_object);
  person = parts.now.person(receiver);
  if (!choice.outcome.good || person == nullptr) co_return false;
  if (choice.search.poses.empty()) co_return !choice.present_cost;
  if (choice.present_cost && *choice.present_cost <= choice.search.poses.front().cost + kMinGain) {
    motion.receiver->p_world_torso = p_torso;
    co_return false;
  }
  aim_at(choice.search, *person, motion);
  motion.receiver->p_world_torso = p_torso;
  show(choice.search.poses.front(), parts.action);
  co_return true;
}

}  // namespace handsel::manipulation_planner
