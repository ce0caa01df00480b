// SPDX-License-Identifier: Apache-2.0
// Twenty transfers of the project's robot and objects to a person in four places, each checked by
// the models' kinematics, FCL and a reconstruction of the person's arm from its joints.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/collision/collision_world.hpp"
#include "common/model/human/human_body.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "tests/support/grasp_lists.hpp"

namespace handsel::grasp_planner::transfer_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Stage {
  std::shared_ptr<const RobotModel> robot = std::make_shared<const RobotModel>(
      RobotModel::load(deploy_folder() / "robots/jido/jido.txtpb"));
  static settings::GraspPlannerSettings person_first() {
    settings::GraspPlannerSettings s;
    s.rank_transfer = 3;
    return s;
  }
  GraspChooser chooser{robot, hand_kit("sah"),
                       [](const std::string& name) { return object_model(name); }, person_first()};
};

const Stage& stage() {
  static const Stage s;
  return s;
}

Scene scene_with(const std::string& object) {
  Scene s;
  s.robot_known = true;
  s.robot_position = stage().robot->rest_configuration();
  s.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
  s.objects.push_back({"thing", object,
                       make_pose({0.68, -0.42, 0.72 + object_model(object)->height_above_support}),
                       Holder::surface, "table", 0});
  return s;
}

HumanState somebody(int place) {
  const Vector3 feet[] = {{1.35, 0.3, 0}, {1.2, 0.55, 0}, {1.45, 0.05, 0}, {0.9, 0.75, 0}};
  const double stature[] = {1.75, 1.62, 1.84, 1.7};
  HumanState people;
  Person anna;
  anna.id = "anna";
  const Vector3 to_robot = -feet[place];
  anna.stature = stature[place];
  anna.joints = standing_body(feet[place], std::atan2(to_robot.y(), to_robot.x()), anna.stature);
  people.people.push_back(anna);
  return people;
}

using Solids = std::vector<std::pair<Shape, Pose>>;

Solids solids_of(const RobotModel& model, const Vector& q, const Pose& T_world_root,
                 const std::function<bool(int)>& wanted) {
  std::vector<Pose> T;
  model.forward(q, T);
  Solids out;
  for (std::size_t l = 0; l < T.size(); ++l) {
    if (!wanted(static_cast<int>(l))) continue;
    for (const PlacedShape& s : model.links()[l].collision)
      out.emplace_back(s.shape, T_world_root * T[l] * s.T_parent_shape);
  }
  return out;
}

double distance(const Solids& a, const Solids& b) {
  double least = 10;
  for (const auto& [s, T] : a) {
    for (const auto& [t, U] : b) least = std::min(least, shape_distance(s, T, t, U).distance);
  }
  return least;
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
}

// The ball has no upright direction; two hands on the mug leave few poses.
double max_tilt(const std::string& object) {
  return (object == "ball" ? 90 : object == "mug" ? 30 : 0) * kDegree;
}

// Checks the hand's orientation against the reported angles of the arm's joints, and each angle
// against the comfort limits.
void expect_comfort(const Person& person, const TransferPose& t, const Pose& T_world_wrist) {
  const auto joint = [&](const char* name) {
    return person.joints[static_cast<std::size_t>(body_joint_index(name))].position;
  };
  const Vector3 shoulder = joint("r_shoulder"), elbow = t.wrist.elbow,
                wrist = T_world_wrist.translation();
  EXPECT_NEAR((elbow - shoulder).norm(), (joint("r_elbow") - shoulder).norm(), 1e-6);
  EXPECT_NEAR((wrist - elbow).norm(), (joint("r_wrist") - joint("r_elbow")).norm(), 1e-6);
  Eigen::Matrix3d
      R;  // neutral: fingers along the forearm, thumb in the plane of the arm, toward the shoulder
  R.col(2) = (wrist - elbow).normalized();
  R.col(0) = (shoulder - elbow).cross(R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  R = R * Eigen::AngleAxisd(-t.wrist.pronation, Vector3::UnitZ()) *
      Eigen::AngleAxisd(-t.wrist.radial, Vector3::UnitX()) *
      Eigen::AngleAxisd(t.wrist.flexion, Vector3::UnitY());
  EXPECT_LT((R - T_world_wrist.linear()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_GT(t.wrist.flexion, -42.1 * kDegree);
  EXPECT_LT(t.wrist.flexion, 48.1 * kDegree);
  EXPECT_GT(t.wrist.radial, -18.1 * kDegree);
  EXPECT_LT(t.wrist.radial, 12.1 * kDegree);
  EXPECT_LT(std::abs(t.wrist.pronation), 48.1 * kDegree);
  EXPECT_LT(angle_between(elbow - shoulder, -Vector3::UnitZ()), 60.1 * kDegree);
}

void expect_transfer(const std::string& object, int place) {
  SCOPED_TRACE(object + " to the person in place " + std::to_string(place));
  const HandOnObject &robot_hand = hand_on_object("sah", object, 60, 144),
                     &human_hand = hand_on_object("human_right", object, 60, 144);
  static std::map<std::string, std::shared_ptr<const TransferTable>> tables;
  auto& table = tables[object];
  if (!table) {
    TransferSettings settings;
    settings.max_tilt = max_tilt(object);
    table = std::make_shared<const TransferTable>(
        HandSide{robot_hand.hand_geometry.get(), &robot_hand.list, {}},
        HandSide{human_hand.hand_geometry.get(), &human_hand.list, {}}, *robot_hand.object,
        settings);
  }
  const RobotModel& robot = *stage().robot;
  const Scene scene = scene_with(object);
  const HumanState people = somebody(place);
  GraspRequest request;
  request.object = "thing";
  request.start = robot.rest_configuration();
  request.for_human = "anna";
  request.max_grasps = 8;
  const Choice choice = stage().chooser.choose(
      {request, robot_hand.list, *robot_hand.object, scene, people, {}, table.get()});
  ASSERT_FALSE(choice.grasps.empty()) << choice.why_none(robot_hand.list);
  ASSERT_EQ(choice.transfers.size(), choice.grasps.size());
  const auto best = std::find_if(choice.transfers.begin(), choice.transfers.end(),
                                 [](const auto& t) { return t.has_value(); });
  ASSERT_NE(best, choice.transfers.end());
  const Grasp& g = choice.grasps[static_cast<std::size_t>(best - choice.transfers.begin())];
  const TransferPose& t = **best;

  const Group &arm = robot.require_group("arm"), &hand = robot.require_group("hand");
  const Vector q =
      RobotModel::with(RobotModel::with(request.start, arm, t.arm_joints), hand, g.hand_joints);
  const Pose T_world_robot_hand = robot.link_pose(q, robot.tool_link()),
             wanted = t.T_world_object * g.T_object_hand;
  EXPECT_LT((T_world_robot_hand.translation() - wanted.translation()).norm(), 1e-4);
  EXPECT_LT(
      Eigen::AngleAxisd(Eigen::Matrix3d(T_world_robot_hand.linear().transpose() * wanted.linear()))
          .angle(),
      1e-3);

  const Grasp& taken = human_hand.list.grasps[t.partner.human].grasp;
  const Pose T_world_wrist = t.T_world_object * taken.T_object_hand;
  EXPECT_GT(angle_between(T_world_robot_hand.linear().col(2), T_world_wrist.linear().col(2)),
            120 * kDegree);

  const RobotModel& human = human_hand.hand_geometry->hand.model();
  std::vector<bool> carried(robot.links().size(), false);  // the palm and all links beyond it
  for (std::size_t l = 0; l < robot.links().size(); ++l) {
    const int j = robot.links()[l].parent_joint;
    carried[l] =
        static_cast<int>(l) == robot.tool_link() ||
        (j >= 0 &&
         carried[static_cast<std::size_t>(robot.joints()[static_cast<std::size_t>(j)].parent)]);
  }
  const auto all = [](int) { return true; };
  const Solids robot_hand_solids = solids_of(
      robot, q, Pose::Identity(), [&](int l) { return carried[static_cast<std::size_t>(l)]; });
  const Solids robot_arm_solids = solids_of(
      robot, q, Pose::Identity(), [&](int l) { return !carried[static_cast<std::size_t>(l)]; });
  const Solids palm =
      solids_of(human, taken.hand_joints, T_world_wrist, [](int l) { return l == 0; });
  EXPECT_GE(distance(palm, robot_hand_solids), 0.01 - 1e-4);
  EXPECT_GT(distance(solids_of(human, taken.hand_joints, T_world_wrist, all), robot_arm_solids), 0);
  EXPECT_EQ(human.links()[0].collision.size(), 2U);

  expect_comfort(people.people[0], t, T_world_wrist);
  // The hand points from the person to the object.
  const Vector3 chest =
      people.people[0].joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  Vector3 way = t.T_world_object * robot_hand.object->box().center() - chest;
  way.z() = 0;
  EXPECT_LT(angle_between(T_world_wrist.linear().col(2), way), 60.5 * kDegree);
  EXPECT_GT(t.T_world_object.linear()(2, 2), std::cos(max_tilt(object)) - 1e-6)
      << "the object is tilted";
  std::printf(
      "%-7s place %d: wrists %3.0f deg, palm %4.1f cm off, wrist strain %.2f, aim %2.0f deg, tilt "
      "%2.0f deg\n",
      object.c_str(), place,
      angle_between(T_world_robot_hand.linear().col(2), T_world_wrist.linear().col(2)) / kDegree,
      100 * distance(palm, robot_hand_solids), t.wrist.strain, t.aim / kDegree, t.tilt / kDegree);
}

bool whole() {
  const char* asked = std::getenv("HANDSEL_TRANSFERS");
  return asked != nullptr && std::string(asked) == "all";
}

TEST(Transfers, leave_the_person_room_and_a_comfortable_wrist) {
  if (!whole()) {
    expect_transfer("mug", 0);
    expect_transfer("bottle", 1);
    return;
  }
  for (const char* object : {"mug", "bottle", "box", "can", "ball"}) {
    for (int place = 0; place < 4; ++place) expect_transfer(object, place);
  }
}

}  // namespace
}  // namespace handsel::grasp_planner::transfer_test
