// Grasps the planner chooses, carried out in the emulated world: straight approach, the controller's hand closing, lift. Contacts decide.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "components/grasp_planner/grasp_book.hpp"
#include "components/grasp_planner/grasp_choice.hpp"
#include "components/trajectory_controller/hand_executor.hpp"
#include "sim/world.hpp"

namespace handsel {
namespace {

using namespace grasp_planner;

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";
constexpr double kDt = 0.001;
const Vector3 kTable(0.85, -0.62, 0.36), kTableSize(0.7, 0.7, 0.72);

const ObjectModel* library(const std::string& name) {
  static std::map<std::string, ObjectModel> models;
  if (models.find(name) == models.end()) models[name] = ObjectModel::load(kDeploy / "objects" / name / (name + ".txtpb"));
  return &models[name];
}

struct Outcome {
  double knocked{};  // way of the object while the opened hand came [m]
  double lifted{};   // [m]
  bool held{};
};

/// One grasp from the stand-off to the lift.
class Execution {
 public:
  Execution(const RobotModel& robot, const std::string& model, double x, double y, double yaw, const Grasp& grasp)
      : robot_(robot),
        arm_(robot.require_group("arm")),
        hand_(robot.require_group("hand")),
        grasp_(grasp),
        world_(robot, library_, scenario(model, x, y, yaw), sim::load_settings(kDeploy / "config"), 1) {
    command_.robot = robot.name();
    command_.position = opened(grasp.approach_joints);
    command_.velocity = command_.acceleration = Vector::Zero(robot.dof());
  }

  Outcome run() {
    Outcome out;
    wait(0.2);
    const Pose start = world_.T_world_object("it");
    move_arm(grasp_.arm_joints, 1.5);
    wait(0.1);
    out.knocked = (world_.T_world_object("it").translation() - start.translation()).norm();
    close();
    Pose T = robot_.link_pose(RobotModel::with(command_.position, arm_, grasp_.arm_joints), robot_.tool_link());
    T.translation().z() += 0.12;
    const auto up = robot_.inverse(arm_, T, command_.position);
    if (!up) return out;
    move_arm(*up, 2.0);
    wait(1.0);
    out.lifted = (world_.T_world_object("it").translation() - start.translation()).z();
    out.held = world_.robot_grips();
    return out;
  }

 private:
  static void set(config::Vec3* v, const Vector3& to) {
    v->set_x(to.x());
    v->set_y(to.y());
    v->set_z(to.z());
  }

  config::Scenario scenario(const std::string& model, double x, double y, double yaw) const {
    config::Scenario s;
    s.set_name("grasp");
    s.set_robot(robot_.name());
    auto* table = s.add_boxes();
    table->set_id("table");
    table->set_supports(true);
    set(table->mutable_pose()->mutable_xyz(), kTable);
    set(table->mutable_size(), kTableSize);
    auto* it = s.add_objects();
    it->set_id("it");
    it->set_model(model);
    it->set_on("table");
    set(it->mutable_pose()->mutable_xyz(), {x, y, 0});
    it->mutable_pose()->mutable_rpy()->set_z(yaw);
    auto* task = s.add_tasks();
    task->set_kind("pick");
    task->set_object("it");
    const Vector q = opened(grasp_.approach_joints);
    for (int i = 0; i < robot_.dof(); ++i) (*s.mutable_start())[robot_.axes()[static_cast<std::size_t>(i)].name] = q[i];
    return s;
  }

  Vector opened(const Vector& arm_q) const {
    return RobotModel::with(RobotModel::with(robot_.rest_posture(), arm_, arm_q), hand_, grasp_.pregrasp_joints);
  }

  void tick() {
    if (fingers_) {
      trajectory_controller::HandInputs in;
      in.robot = &state_;
      in.new_state = in.may_move = true;
      in.person_distance = std::numeric_limits<double>::infinity();
      fingers_->step(in, kDt, TimePoint{} + from_seconds(world_.time()), fingers_out_);
      for (const int a : hand_.axes) {
        command_.position[a] = fingers_out_.position[a];
        command_.velocity[a] = fingers_out_.velocity[a];
      }
    }
    ++command_.sequence;
    world_.command(command_);
    world_.step();
    RobotState reported;
    if (world_.robot_state(reported) && reported.position.size() > 0) state_ = reported;
  }

  void wait(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / kDt); ++k) tick();
  }

  void move_arm(const Vector& to, double duration) {
    const Vector from = RobotModel::part(command_.position, arm_);
    const int steps = static_cast<int>(duration / kDt);
    for (int k = 1; k <= steps; ++k) {
      const double u = static_cast<double>(k) / steps, share = u * u * u * (10 - 15 * u + 6 * u * u);
      const double speed = 30 * u * u * (1 - u) * (1 - u) / duration;
      for (std::size_t i = 0; i < arm_.axes.size(); ++i) {
        const auto e = static_cast<Eigen::Index>(i);
        command_.position[arm_.axes[i]] = from[e] + share * (to[e] - from[e]);
        command_.velocity[arm_.axes[i]] = speed * (to[e] - from[e]);
      }
      tick();
    }
  }

  void close() {
    std::vector<double> lower, upper;
    for (const int a : hand_.axes) {
      lower.push_back(robot_.axes()[static_cast<std::size_t>(a)].lower);
      upper.push_back(robot_.axes()[static_cast<std::size_t>(a)].upper);
    }
    fingers_ = std::make_unique<trajectory_controller::HandExecutor>(trajectory_controller::HandSettings{}, hand_.axes, lower, upper,
                                                                     robot_.comfort_limits(), robot_.stop_limits());
    fingers_->reset(command_.position);
    fingers_out_ = {command_.position, Vector::Zero(robot_.dof()), Vector::Zero(robot_.dof())};
    HandCommand closing;
    closing.action = HandAction::grasp;
    closing.position = grasp_.hand_joints;
    ASSERT_EQ(fingers_->accept(closing), "");
    for (int k = 0; k < 3000 && (k < 50 || fingers_->state() == HandState::moving); ++k) tick();
  }

  const RobotModel& robot_;
  const Group &arm_, &hand_;
  Grasp grasp_;
  ObjectLibrary library_{library};
  sim::SimWorld world_;
  JointCommand command_;
  RobotState state_;
  std::unique_ptr<trajectory_controller::HandExecutor> fingers_;
  MotionState3 fingers_out_;
};

class GraspHolds : public testing::TestWithParam<const char*> {};

TEST_P(GraspHolds, the_first_three_of_the_reply_lift_the_object) {
  const std::string model = GetParam();
  const auto robot = std::make_shared<const RobotModel>(RobotModel::load(kDeploy / "robots/jido/jido.txtpb"));
  const auto kit = std::make_shared<const HandKit>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  GraspBook book(kit, {}, GraspStore(""));
  const auto page = book.page(*library(model));
  const GraspChooser chooser(robot, kit, library, {});
  int tried = 0, held = 0;
  for (const double yaw : {0.0, 2.0}) {
    Scene scene;
    scene.robot_known = true;
    scene.robot_position = robot->rest_posture();
    scene.boxes.push_back({"table", make_pose(kTable), kTableSize, true});
    const Vector3 place(0.68, -0.42, 0.72 + library(model)->height_above_support);
    scene.objects.push_back(
        {"it", model, make_pose(place, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3::UnitZ()))), Holder::surface, "table", 0});
    GraspRequest request;
    request.object = "it";
    request.start = robot->rest_posture();
    request.max_grasps = 3;
    const Choice choice = chooser.choose(request, page->list, *page->object, scene, {});
    EXPECT_EQ(choice.grasps.size(), 3U) << choice.why_none(page->list);
    for (const Grasp& g : choice.grasps) {
      const Outcome o = Execution(*robot, model, place.x(), place.y(), yaw, g).run();
      ++tried;
      held += o.held && o.lifted > 0.1;
      EXPECT_LT(o.knocked, 0.002) << "grasp " << g.id << " moves the object on its way in";
      std::printf("%s yaw %.0f grasp %llu: epsilon %.3f, lifted %.3f m, %s\n", model.c_str(), yaw, static_cast<unsigned long long>(g.id),
                  g.epsilon, o.lifted, o.held ? "held" : "lost");
    }
  }
  EXPECT_GE(held, tried - 1);
}

INSTANTIATE_TEST_SUITE_P(Objects, GraspHolds, testing::Values("mug", "bottle", "box"));

}  // namespace
}  // namespace handsel
