// SPDX-License-Identifier: Apache-2.0
// Executes one planned grasp in the emulated world: straight approach, the controller's hand
// closing, lift, tilt, shake.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"
#include "sim/world.hpp"
#include "tests/support/fingers.hpp"

namespace handsel::test {

inline const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";
inline constexpr double kDt = 0.001;
inline constexpr double kShake = 0.02;  // amplitude of the shake to either side [m]
inline const Vector3 kTable(0.85, -0.62, 0.36), kTableSize(0.7, 0.7, 0.72);

/// Models read so far; one that is not among the project's own is put in by its name.
inline std::map<std::string, ObjectModel>& models() {
  static std::map<std::string, ObjectModel> read;
  return read;
}

inline const ObjectModel* library(const std::string& name) {
  const auto [at, fresh] = models().try_emplace(name);
  if (fresh) at->second = ObjectModel::load(kDeploy / "objects" / name / (name + ".txtpb"));
  return &at->second;
}

struct HoldOutcome {
  double knocked{};     ///< motion of the object during the approach [m]
  double lifted{};      ///< [m]
  std::string lost;     ///< stage of the loss; empty: held to the end
  double slip{};        ///< max motion of the object in the hand since the lift [m]
  double turn{};        ///< max rotation of the object in the hand since the lift [rad]
  double pressure{};    ///< normal force of the hand after closing [N]
  double constraint{};  ///< fraction of the time with the grasp constraint
  std::string hold;     ///< ground truth of the hold after the lift: "contact" or "constraint"
  double real_time{};   ///< simulated seconds per second of the processor, object in hand
  bool held() const { return lost.empty(); }
};

enum class Handling { lift, lift_tilt_shake };

/// One grasp from the stand-off to the lift.
class Execution {
 public:
  Execution(const RobotModel& robot, const std::string& model, double x, double y, double yaw,
            const Grasp& grasp,
            const sim::SimSettings& settings = sim::load_settings(kDeploy / "config"))
      : robot_(robot),
        arm_(robot.require_group("arm")),
        hand_(robot.require_group("hand")),
        grasp_(grasp),
        world_(robot, library_, scenario(model, x, y, yaw), unchecked(settings), 1) {
    command_.robot = robot.name();
    command_.position = opened(grasp.approach_joints);
    command_.velocity = command_.acceleration = command_.effort = Vector::Zero(robot.dof());
  }

  HoldOutcome run(Handling handling = Handling::lift) {
    wait(0.2);
    const Pose start = world_.T_world_object("it");
    move_arm(grasp_.arm_joints, 1.5);
    wait(0.1);
    out_.knocked = (world_.T_world_object("it").translation() - start.translation()).norm();
    close();
    out_.pressure = world_.robot_pressure();
    if (!world_.robot_grips()) {
      out_.lost = "closing";
      return out_;
    }
    T_tool_object_ = in_tool();
    const std::clock_t began = std::clock();
    const double from = world_.time();
    stage_ = "lift";
    Pose T = robot_.link_pose(RobotModel::with(command_.position, arm_, grasp_.arm_joints),
                              robot_.tool_link());
    T.translation().z() += 0.12;
    if (!go(T, 2.0)) {
      out_.lost = "no way up";
      return out_;
    }
    wait(1.0);
    out_.lifted = (world_.T_world_object("it").translation() - start.translation()).z();
    GroundTruth ground_truth;
    world_.ground_truth(ground_truth);
    out_.hold = ground_truth.hold;
    if (handling == Handling::lift_tilt_shake && out_.held()) {
      stage_ = "tilt";
      if (!tilt(T)) out_.lost = "no way to tilt";
      wait(1.0);
      stage_ = "shake";
      for (int axis = 0; axis < 3; ++axis) shake(Vector3::Unit(axis));
    }
    out_.real_time =
        (world_.time() - from) / (static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
    out_.constraint = world_.constraint_fraction();
    return out_;
  }

 private:
  static void set(config::Vec3* v, const Vector3& to) {
    v->set_x(to.x());
    v->set_y(to.y());
    v->set_z(to.z());
  }

  /// Returns the settings with a robot side that follows any set-point: the paths here are
  /// interpolated without accelerations.
  static sim::SimSettings unchecked(sim::SimSettings settings) {
    settings.robot_side.period = 0.0;
    return settings;
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
    for (int i = 0; i < robot_.dof(); ++i)
      (*s.mutable_start())[robot_.axes()[static_cast<std::size_t>(i)].name] = q[i];
    return s;
  }

  Vector opened(const Vector& arm_q) const {
    return RobotModel::with(RobotModel::with(robot_.rest_configuration(), arm_, arm_q), hand_,
                            grasp_.pregrasp_joints);
  }

  void tick() {
    if (fingers_) {
      trajectory_controller::HandInputs in;
      in.robot = &state_;
      in.payload = state_.payload;
      in.new_state = in.may_move = true;
      in.person_distance = std::numeric_limits<double>::infinity();
      fingers_->step(in, kDt, TimePoint{} + from_seconds(world_.time()), fingers_out_);
      for (const int& a : hand_.axes) {
        command_.position[a] = fingers_out_.position[a];
        command_.velocity[a] = fingers_out_.velocity[a];
        command_.effort[a] = fingers_->effort(static_cast<int>(&a - hand_.axes.data()));
      }
    }
    ++command_.sequence;
    world_.command(command_);
    world_.step();
    RobotState reported;
    if (world_.robot_state(reported) && reported.position.size() > 0) state_ = reported;
    if (stage_.empty() || !out_.held()) return;
    const Pose off = T_tool_object_.inverse() * in_tool();
    out_.slip = std::max(out_.slip, off.translation().norm());
    out_.turn = std::max(out_.turn, Eigen::AngleAxisd(off.linear()).angle());
    if (!world_.robot_grips()) out_.lost = stage_;
  }

  Pose in_tool() const {
    return robot_.link_pose(state_.position, robot_.tool_link()).inverse() *
           world_.T_world_object("it");
  }

  bool go(const Pose& T, double duration) {
    const auto q = robot_.inverse(arm_, T, command_.position);
    if (q) move_arm(*q, duration);
    return q.has_value();
  }

  /// Tilts by 90 degrees about a horizontal axis through the object, clear of the table, on the
  /// shortest motion of the arm.
  bool tilt(const Pose& T_world_tool) {
    std::optional<Vector> best;
    double least = 2.5;
    for (const double height : {0.0, 0.1, 0.2}) {
      for (int k = 0; k < 8; ++k) {
        const Vector3 axis(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4), 0);
        const Pose about = Eigen::Translation3d(world_.T_world_object("it").translation()) *
                           Eigen::AngleAxisd(M_PI / 2, axis) *
                           Eigen::Translation3d(-world_.T_world_object("it").translation()) *
                           T_world_tool;
        for (const double inward : {0.0, 0.1, 0.2}) {
          Pose T = about;
          T.translation() += Vector3(-inward, inward, 0.1 + height);
          const auto q = robot_.inverse(arm_, T, command_.position);
          if (!q || !can_shake(*q)) continue;
          const double way = (*q - RobotModel::part(command_.position, arm_)).cwiseAbs().maxCoeff();
          if (way < least) least = way, best = q;
        }
      }
    }
    if (!best) return false;
    move_arm(*best, 1.0 + 1.2 * least);
    return true;
  }

  bool can_shake(const Vector& arm_q) const {
    const Vector q = RobotModel::with(command_.position, arm_, arm_q);
    const Pose T = robot_.link_pose(q, robot_.tool_link());
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {kShake, -kShake}) {
        if (!robot_.inverse(arm_, Eigen::Translation3d(way * Vector3::Unit(axis)) * T, q))
          return false;
      }
    }
    return true;
  }

  /// Two seconds at 2 Hz, 20 mm to either side: up to 3.2 m/s^2.
  void shake(const Vector3& along) {
    constexpr double kRate = 2 * M_PI * 2.0;
    const Vector middle = RobotModel::part(command_.position, arm_);
    const Pose T = robot_.link_pose(command_.position, robot_.tool_link());
    const auto there =
        robot_.inverse(arm_, Eigen::Translation3d(kShake * along) * T, command_.position);
    const auto back =
        robot_.inverse(arm_, Eigen::Translation3d(-kShake * along) * T, command_.position);
    if (!there || !back) {
      if (out_.held()) out_.lost = "no way to shake";
      return;
    }
    const Vector way = (*there - *back) / 2;
    const auto put = [&](double share, double speed) {
      for (std::size_t i = 0; i < arm_.axes.size(); ++i) {
        command_.position[arm_.axes[i]] =
            middle[static_cast<Eigen::Index>(i)] + share * way[static_cast<Eigen::Index>(i)];
        command_.velocity[arm_.axes[i]] = speed * way[static_cast<Eigen::Index>(i)];
      }
      tick();
    };
    for (double t = kDt; t <= 2.0; t += kDt) {
      const double fade = std::min({1.0, t / 0.25, (2.0 - t) / 0.25});
      put(fade * std::sin(kRate * t), fade * kRate * std::cos(kRate * t));
    }
    put(0, 0);
  }

  void wait(double seconds) {
    for (int k = 0; k < static_cast<int>(seconds / kDt); ++k) tick();
  }

  void move_arm(const Vector& to, double duration) {
    const Vector from = RobotModel::part(command_.position, arm_);
    const int steps = static_cast<int>(duration / kDt);
    for (int k = 1; k <= steps; ++k) {
      const double u = static_cast<double>(k) / steps,
                   share = u * u * u * (10 - 15 * u + 6 * u * u);
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
    fingers_ = test::fingers_of(robot_, hand_, command_.position);
    fingers_out_ = {command_.position, Vector::Zero(robot_.dof()), Vector::Zero(robot_.dof())};
    HandCommand closing;
    closing.action = HandAction::grasp;
    closing.position = grasp_.hand_joints;
    closing.effort = grasp_.hand_effort;
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
  HoldOutcome out_;
  std::string stage_;  // empty: before the lift
  Pose T_tool_object_{Pose::Identity()};
};

}  // namespace handsel::test
