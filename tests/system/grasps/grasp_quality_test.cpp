// SPDX-License-Identifier: Apache-2.0
// Correlation of the quality of a listed grasp with holding. The Schunk hand alone, in the emulated
// physics, by contact only: grasps of every decile of quality are closed on the object, lifted,
// tilted and shaken.
//
// The hand is fixed except for a lift of 12 cm; the load of the object is applied in the hand's
// frame: no weight while the hand closes (the object only resists motion, as on a table), then the
// weight downward, then tilted by 90 degrees to each side, then 3.2 m/s^2 along each axis.
// HANDSEL_RUNS: number of grasps of each decile.
#include <gtest/gtest.h>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>

#include "components/grasp_planner/regrasp/grasp_cache.hpp"
#include "sim/physics/object_body.hpp"
#include "sim/robot/hand_measure.hpp"
#include "sim/robot/robot_grasp.hpp"
#include "sim/scene/settings.hpp"
#include "tests/support/fingers.hpp"
#include "tests/support/motion_draw.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::grasp_quality_test {
namespace {

using namespace grasp_planner;

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";
constexpr double kDt = 0.001, kG = 9.81;
constexpr double kFallen = 0.04;  // max motion in the hand since the lift [m]

/// The hand on a vertical slide.
RobotModel hand_on_a_slide(const std::vector<Axis>& hand_axes) {
  const test::TemporaryFolder folder;
  std::ifstream in(kDeploy / "hands/sah/sah.urdf");
  std::string urdf{std::istreambuf_iterator<char>(in), {}};
  const std::string head = "<robot name=\"sah\">";
  urdf.insert(urdf.find(head) + head.size(),
              R"(<link name="base"><inertial><mass value="10"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="base"/><child link="palm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="2" effort="1000"/></joint>)");
  folder.write("rig.urdf", urdf);
  std::string names;
  for (const Axis& a : hand_axes) names += (names.empty() ? "\"" : ", \"") + a.name + "\"";
  const auto limits = [&](const std::string& kind, double factor) {
    std::ostringstream out;
    out << kind << " { joints: [" << names << "] velocity: " << 2.85 * factor
        << " acceleration: " << 14.2 * factor << " jerk: " << 107 * factor << " }\n"
        << kind << " { joints: \"slide\" velocity: " << factor << " acceleration: " << 20 * factor
        << " jerk: " << 200 * factor << " }\n";
    return out.str();
  };
  return RobotModel::load(folder.write("rig.txtpb",
                                       "name: \"rig\"\nurdf: \"rig.urdf\"\ngroups { name: \"arm\" "
                                       "joints: \"slide\" tip_link: \"palm\" }\n"
                                       "groups { name: \"hand\" joints: [" +
                                           names + "] }\ntool_link: \"palm\"\n" +
                                           limits("comfort", 1) + limits("guard", 1.5) +
                                           limits("stop", 1)));
}

class Rig {
 public:
  Rig(const RobotModel& robot, const ObjectModel& object, const Grasp& grasp,
      const sim::SimSettings& settings)
      : robot_(robot),
        hand_(robot.require_group("hand")),
        grasp_(grasp),
        settings_(settings),
        dispatcher_(&configuration_),
        dynamics_(&dispatcher_, &broadphase_, &solver_, &configuration_),
        measured_(robot.dof(), settings.wrench_filter, kDt) {
    dynamics_.setGravity(btVector3(0, 0, -kG));
    dynamics_.getSolverInfo().m_numIterations = settings.solver_iterations;
    dynamics_.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    q_ = RobotModel::with(Vector::Zero(robot.dof()), hand_, grasp.pregrasp_joints);
    const Pose base = make_pose(Vector3(0, 0, 1));
    body_ = std::make_unique<sim::RobotBody>(
        robot, base, q_, settings.servo, settings.pad,
        sim::BodyWorld{dynamics_, shapes_, sim::kRobot, sim::kObject});
    for (int i = 0; i < body_->bodies(); ++i) {
      if (body_->collider(i) == nullptr) continue;
      sim::own(*body_->collider(i), sim::Owner::robot, i);
      body_->collider(i)->setContactProcessingThreshold(0.001);
    }
    contact_ = std::make_unique<sim::RobotGrasp>(robot.tool_link(), *body_, settings.touch_force,
                                                 settings.grasp_time, settings.lose_time);
    object_ = std::make_unique<sim::ObjectBody>(
        sim::StartObject{"it", object.name, &object, base * grasp.T_object_hand.inverse()}, 0,
        shapes_, dynamics_);
    body_->read();
    object_->read();
    state_.position = q_;
    state_.velocity = state_.external_torque = Vector::Zero(robot.dof());
  }
  ~Rig() {
    object_.reset();
    body_.reset();
  }

  /// Empty: held to the end; else when it was lost.
  std::string run() {
    if (!close()) return "closing";
    T_hand_object_ = in_hand();
    const double lifted = slide_ + 0.12;
    for (double t = 0; t < 0.8; t += kDt) {
      const double u = t / 0.8;
      slide_ = lifted - 0.12 * (1 - u * u * u * (10 - 15 * u + 6 * u * u));
      tick(Vector3(0, 0, -kG) * std::min(1.0, t / 0.2));
    }
    if (fallen()) return "lift";
    Vector3 down(0, 0, -kG);
    for (const Vector3& way : {Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 1, 0),
                               Vector3(0, -1, 0), Vector3(0, 0, -1)}) {
      const Vector3 from = down;
      for (double t = 0; t < 0.4; t += kDt) {
        down = kG * (from + std::min(1.0, t / 0.2) * (kG * way - from)).normalized();
        tick(down);
      }
      if (fallen()) return "tilt";
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (double t = 0; t < 0.75; t += kDt)
        tick(down + 3.2 * std::sin(2 * M_PI * 4 * t) * Vector3::Unit(axis));
      if (fallen()) return "shake";
    }
    return "";
  }

 private:
  Pose in_hand() const {
    return body_->T_world_link(robot_.tool_link()).inverse() * object_->T_world_object();
  }
  bool fallen() const {
    return !(((T_hand_object_.inverse() * in_hand()).translation()).norm() < kFallen);
  }

  bool close() {
    fingers_ = test::fingers_of(robot_, hand_, q_);
    out_ = {q_, Vector::Zero(robot_.dof()), Vector::Zero(robot_.dof())};
    HandCommand closing;
    closing.action = HandAction::grasp;
    closing.position = grasp_.hand_joints;
    closing.effort = grasp_.hand_effort;
    EXPECT_EQ(fingers_->accept(closing), "");
    for (int k = 0; k < 3000 && (k < 50 || fingers_->state() == HandState::moving); ++k)
      tick(Vector3::Zero());
    for (int k = 0; k < 200; ++k) tick(Vector3::Zero());
    return contact_->pressure(touches_, 0) > 0.5;
  }

  /// Steps the physics. `weight`: force on the object per kg, world axes [N/kg].
  void tick(const Vector3& weight) {
    trajectory_controller::HandInputs in;
    in.robot = &state_;
    in.payload = state_.payload;
    in.new_state = in.may_move = true;
    in.person_distance = std::numeric_limits<double>::infinity();
    fingers_->step(in, kDt, TimePoint{} + from_seconds(++ticks_ * kDt), out_);
    Vector q = q_, qd = Vector::Zero(robot_.dof()), effort = Vector::Zero(robot_.dof());
    const int slide = robot_.require_group("arm").axes.front();
    q[slide] = slide_;
    qd[slide] = (slide_ - last_slide_) / kDt;
    last_slide_ = slide_;
    for (std::size_t i = 0; i < hand_.axes.size(); ++i) {
      q[hand_.axes[i]] = out_.position[hand_.axes[i]];
      qd[hand_.axes[i]] = out_.velocity[hand_.axes[i]];
      effort[hand_.axes[i]] = fingers_->effort(static_cast<int>(i));
    }
    body_->drive(q, qd, Vector::Zero(robot_.dof()), effort);
    const double mass = object_->model().mass;
    Wrench push{mass * (weight + Vector3(0, 0, kG)), Vector3::Zero()};
    if (weight.isZero()) {
      const sim::BodyState& s = object_->state();
      push.force -= std::min(1.0, mass * kG / (s.velocity.norm() * 100 + 1e-9)) * 100 * s.velocity;
      push.torque -= 0.1 * s.angular_velocity * mass;
    }
    object_->push(push);
    dynamics_.stepSimulation(kDt, 0);
    body_->read();
    object_->read();
    sim::gather(dispatcher_, kDt, 0.001, touches_);
    contact_->update(touches_, 0, object_->state().T_world_body.translation(), kDt);
    measured_.update(touches_, *body_, *contact_, body_->T_world_link(robot_.tool_link()), {},
                     Vector3::Zero());
    state_.position = body_->position();
    state_.velocity = body_->velocity();
    state_.effort = body_->effort();
    state_.external_torque = measured_.external_torque();
    state_.payload = measured_.payload();
  }

  const RobotModel& robot_;
  const Group& hand_;
  Grasp grasp_;
  sim::SimSettings settings_;
  sim::ShapeStore shapes_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld dynamics_;
  sim::HandMeasure measured_;
  std::unique_ptr<sim::RobotBody> body_;
  std::unique_ptr<sim::ObjectBody> object_;
  std::unique_ptr<sim::RobotGrasp> contact_;
  std::vector<sim::Touch> touches_;
  std::unique_ptr<trajectory_controller::HandExecutor> fingers_;
  MotionState3 out_;
  RobotState state_;
  Vector q_;
  Pose T_hand_object_{Pose::Identity()};
  double slide_{0}, last_slide_{0};
  int ticks_{0};
};

struct Tried {
  double quality, epsilon, margin;
  bool held;
};

/// Share of the pairs of one that held and one that fell in which the first has the higher figure.
double auc(const std::vector<Tried>& tried, double Tried::*figure) {
  double better = 0, pairs = 0;
  for (const Tried& a : tried) {
    for (const Tried& b : tried) {
      if (!a.held || b.held) continue;
      pairs += 1;
      better += a.*figure > b.*figure ? 1 : a.*figure == b.*figure ? 0.5 : 0;
    }
  }
  return pairs > 0 ? better / pairs : std::numeric_limits<double>::quiet_NaN();
}

TEST(GraspQuality, separates_what_holds_from_what_falls) {
  const int of_each = test::runs(10);
  const auto hand_geometry =
      std::make_shared<const HandGeometry>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  const RobotModel robot = hand_on_a_slide(hand_geometry->hand.model().axes());
  const sim::SimSettings settings = sim::load_settings(kDeploy / "config");
  GraspCache book(hand_geometry, {}, GraspStore(""));
  std::vector<Tried> all;
  std::printf("%-8s %6s %5s  %s\n", "object", "grasps", "held",
              "held of each decile of quality, the worst first");
  for (const char* name : {"mug", "bottle", "box", "can", "ball"}) {
    const ObjectModel object =
        ObjectModel::load(kDeploy / "objects" / name / (std::string(name) + ".txtpb"));
    const auto page = book.page(object);
    const std::size_t n = page->list.grasps.size();
    ASSERT_GE(n, 50U) << name;
    std::vector<Tried> of_object;
    std::string row;
    for (std::size_t decile = 0; decile < 10; ++decile) {
      int held = 0;
      for (int k = 0; k < of_each; ++k) {
        // The list begins with the best.
        const std::size_t rank =
            n - 1 -
            static_cast<std::size_t>((static_cast<double>(decile) + (k + 0.5) / of_each) *
                                     static_cast<double>(n) / 10);
        const Grasp& g = page->list.grasps[rank].grasp;
        const std::string lost = Rig(robot, object, g, settings).run();
        of_object.push_back({g.quality, g.epsilon, g.margin, lost.empty()});
        held += lost.empty();
      }
      row += std::to_string(held) + " ";
    }
    const auto held =
        std::count_if(of_object.begin(), of_object.end(), [](const Tried& t) { return t.held; });
    std::printf(
        "%-8s %6zu %5ld  %s  AUC of quality %.3f, epsilon %.3f, margin of the squeeze %.3f\n", name,
        of_object.size(), static_cast<long>(held), row.c_str(), auc(of_object, &Tried::quality),
        auc(of_object, &Tried::epsilon), auc(of_object, &Tried::margin));
    std::fflush(stdout);
    all.insert(all.end(), of_object.begin(), of_object.end());
  }
  const double whole = auc(all, &Tried::quality);
  std::printf("all: AUC of quality %.3f, epsilon %.3f, margin of the squeeze %.3f\n", whole,
              auc(all, &Tried::epsilon), auc(all, &Tried::margin));
  EXPECT_GE(whole, 0.7);
}

}  // namespace
}  // namespace handsel::grasp_quality_test
