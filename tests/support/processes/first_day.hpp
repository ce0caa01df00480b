// SPDX-License-Identifier: Apache-2.0
// Commissioning of a real robot: a driver process with a scripted emulation of the maker's
// controller, the controller process and all other senders, over DDS. No step waits for a time:
// every step waits for the expected observation.
#pragma once

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/dds/dds_bus.hpp"
#include "common/config/resources.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/model/robot_capsules.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "deploy/drivers/maker_udp.hpp"
#include "tests/support/processes/background.hpp"
#include "tests/support/processes/live_view.hpp"
#include "tests/support/processes/stall_watch.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test {

struct FirstDayPlan {
  std::string binaries;  ///< folder of the processes
  std::string arm;       ///< "position_arm" or "reflex_arm": driver, settings and fake
  std::string robot;     ///< name or file of its description
  std::string gripper;   ///< settings text of a gripper, or empty
  int axis{};            ///< of the group "arm": the stories turn this one
  std::uint32_t domain{};
  bool dry_run{};
};

class FirstDay {
 public:
  static constexpr double kFar = 0.6;  ///< goal beyond the wall [rad]

  explicit FirstDay(const FirstDayPlan& plan)
      : plan_(plan),
        robot_(RobotModel::load(robot_description(plan.robot))),
        arm_(robot_.require_group("arm")),
        capsules_(robot_capsules(robot_)),
        bus_({.component = "first_day spark supervisor manipulation_planner",
              .domain = plan.domain,
              .realtime = true,
              .health = false}) {
    place_wall();
    for (const auto& file : std::filesystem::directory_iterator(resource("config")))
      std::filesystem::copy(file, folder_.path());
    std::ofstream(folder_.path() / "trajectory_controller.txtpb", std::ios::app)
        << "walls { nx: " << -toward_wall_.x() << " ny: " << -toward_wall_.y()
        << " nz: " << -toward_wall_.z() << " offset: " << -wall_ << " }\n";
    port_ = drivers::UdpPort(0).port();
    const std::string common =
        "common { port: " + std::to_string(port_) +
        " group: \"arm\" dry_run: " + (plan.dry_run ? "true" : "false") +
        " max_setpoint_gap: 0.02 min_stop: 0.5 wire_jitter: 0.02 fade_fraction: 0.1 }\n";
    folder_.write("position_arm.txtpb", common + "cycle: 0.005\n");
    folder_.write(
        "reflex_arm.txtpb",
        common + "joint_deceleration: 3 limit_ratio: 0.95 lost_cycles: 20\n" + plan.gripper);
    go_.epoch = go_.state_revision = 1;
    go_.allowed = true;
    people_.covered = true;
    people_.views = {live_view()};
    forecast_.time_to_collision = 1e9;
    speak();
    driver_ = start("handsel_" + plan.arm);
    controller_ = start("handsel_trajectory_controller");
  }

  /// Starts the emulated controller of the maker with a script of events.
  void play(const std::string& script) {
    fake_.reset();
    go_.override_factor = 1.0;
    wait([&] {
      return states_ == 0 ||
             (robot_state_.mode != DriveMode::enabled && status_.mode >= Mode::hold);
    });
    fake_ = std::make_unique<Background>(
        std::vector<std::string>{plan_.binaries + "/handsel_fake_arm", plan_.arm, "--robot",
                                 plan_.robot, "--port", std::to_string(port_), "--realtime",
                                 "--script", folder_.write("script.txt", script).string()});
  }
  /// Ends the emulated controller; returns its report of the received commands.
  std::string account() {
    fake_->interrupt();
    return fake_->printed();
  }
  bool happened(const std::string& event) const {
    return fake_->printed().find(event) != std::string::npos;
  }

  /// Waits until `done`; ends early, without success, once the processes hold after a stall of the
  /// machine, because the awaited event then cannot occur.
  template <class Done>
  bool wait(const Done& done, double seconds = 10.0) {
    bool success = false;
    bus_.run_until([&] { return (success = done()) || held_by_machine(); }, from_seconds(seconds));
    return success;
  }
  /// `holds` for so many samples of the robot's state.
  template <class Holds>
  bool stays(const Holds& holds, int samples) {
    bool all = true;
    const std::uint64_t until = states_ + static_cast<std::uint64_t>(samples);
    wait([&] {
      all = all && holds();
      return !all || states_ >= until;
    });
    return all && states_ >= until;
  }
  /// Permissions, also a person's where the driver waits for one, until nothing holds the robot
  /// back.
  bool ready() {
    return wait(
        [&] {
          if (status_.mode < Mode::hold && robot_state_.mode == DriveMode::enabled) return true;
          if (to_seconds(bus_.now() - asked_) < 0.2) return false;
          asked_ = bus_.now();
          if (trouble_.find("acknowledge") != std::string::npos)
            give_go(true);
          else if (status_.causes == (1U << static_cast<unsigned>(Cause::no_go)) ||
                   status_.causes == (1U << static_cast<unsigned>(Cause::awaits_person)))
            give_go(false);
          return false;
        },
        20.0);
  }
  void give_go(bool acknowledge) {
    go_.state_revision = ++go_.epoch;  // each follows an act of a person
    go_.acknowledge = acknowledge;
    go_out_->publish(go_);
  }
  void override_speed(double factor) {
    go_.override_factor = factor;
    go_out_->publish(go_);
  }
  /// Plans and sends a motion to this angle from the rest configuration [rad].
  Trajectory move_to(double angle) {
    Vector goal = gathered(robot_.rest_configuration());
    goal[plan_.axis] += angle;
    const KinematicLimits& l = robot_.comfort_limits();
    TrajectoryCommand c;
    c.robot = robot_.name();
    c.id = ++id_;
    c.epoch = status_.epoch;
    c.axes.assign(arm_.axes.begin(), arm_.axes.end());
    c.trajectory = solve(rest_state(gathered(active_.position)), rest_state(goal),
                         {gathered(l.velocity), gathered(l.acceleration), gathered(l.jerk)})
                       .trajectory;
    command_out_->publish(c);
    return c.trajectory;
  }
  void cancel() {
    TrajectoryCommand c;
    c.robot = robot_.name();
    c.id = ++id_;
    c.epoch = status_.epoch;
    command_out_->publish(c);
  }
  void hand(HandAction action, double position) {
    HandCommand c;
    c.robot = robot_.name();
    c.id = ++hand_id_;
    c.epoch = status_.epoch;
    c.action = action;
    c.position = Vector::Zero(static_cast<Eigen::Index>(robot_.require_group("hand").axes.size()));
    c.position[0] = position;
    hand_out_->publish(c);
  }
  bool standing() const { return active_.trajectory == 0 && active_.velocity.isZero(0.0); }
  bool arrived() const {
    return status_.trajectory == id_ && status_.motion == MotionState::finished;
  }
  bool hand_done(HandState state) const {
    return status_.hand_command == hand_id_ && status_.hand == state;
  }
  bool held_by_machine() const {
    return (has(Cause::cycle_late) || has(Cause::robot_state_silent)) && StallWatch::was_away();
  }
  bool has(Cause cause) const {
    return (status_.causes & (1U << static_cast<unsigned>(cause))) != 0;
  }
  double angle() const {
    return angle_of(robot_state_);
  }  ///< measured, from the rest configuration [rad]
  double speed() const { return gathered(robot_state_.velocity).cwiseAbs().maxCoeff(); }
  double wall_room() const { return wall_ - reach(robot_state_.position); }
  double fastest{};   ///< of any arm axis as measured, since it was last set to 0 [rad/s]
  double min_room{};  ///< between moving links and the wall, since it was last set [m]

  const RobotState& robot_state() const { return robot_state_; }
  const ExecutionStatus& status() const { return status_; }
  const std::string& trouble() const { return trouble_; }  ///< of the driver, from its health
  TimePoint now() const { return bus_.now(); }
  std::string where() const {
    return std::string(name(status_.mode)) + ", " + status_.reason + "; drive " +
           std::to_string(static_cast<int>(robot_state_.mode)) + ", " + trouble_ + "; at " +
           std::to_string(angle()) + " rad; fake: " + (fake_ ? fake_->printed() : "") +
           "; driver: " + driver_->said() + controller_->said() +
           "; before that, newest last:" + history_;
  }

 private:
  Vector gathered(const Vector& robot) const { return drivers::gather(robot, arm_.axes); }
  double angle_of(const RobotState& s) const {
    const int axis = arm_.axes[static_cast<std::size_t>(plan_.axis)];
    return s.position.size() > axis ? s.position[axis] - robot_.rest_configuration()[axis] : 0.0;
  }
  void remember(const std::string& what) {
    constexpr std::size_t kLong = 2000;
    history_ += "\n  " + std::to_string(to_seconds(bus_.now() - begun_)) + " s  " + what;
    if (history_.size() > kLong) history_.erase(0, history_.find('\n', history_.size() - kLong));
  }
  std::unique_ptr<Background> start(const std::string& process) {
    return std::make_unique<Background>(std::vector<std::string>{
        plan_.binaries + "/" + process, "--robot", plan_.robot, "--config", folder_.path().string(),
        "--domain", std::to_string(plan_.domain), "--realtime"});
  }
  /// Returns how far the links moved by the axis extend toward the wall [m].
  double reach(const Vector& position) const {
    std::vector<Pose> links;
    robot_.forward(position, links);
    double furthest = -1e9;
    for (const LinkCapsule& c : capsules_) {
      if (!moved_[static_cast<std::size_t>(c.link)]) continue;
      const Pose& T = links[static_cast<std::size_t>(c.link)];
      furthest = std::max(
          {furthest, toward_wall_.dot(T * c.a) + c.radius, toward_wall_.dot(T * c.b) + c.radius});
    }
    return furthest;
  }
  void place_wall() {
    const Vector rest = robot_.rest_configuration();
    Vector far = rest;
    far[arm_.axes[static_cast<std::size_t>(plan_.axis)]] += kFar;
    std::vector<Pose> at_rest, at_far;
    robot_.forward(rest, at_rest);
    robot_.forward(far, at_far);
    moved_.resize(at_rest.size());
    for (std::size_t i = 0; i < at_rest.size(); ++i)
      moved_[i] = !at_rest[i].isApprox(at_far[i], 1e-9);
    const auto tip = static_cast<std::size_t>(arm_.tip);
    toward_wall_ = (at_far[tip].translation() - at_rest[tip].translation()).normalized();
    wall_ = reach(rest) + 0.6 * (reach(far) - reach(rest));
  }
  void speak() {
    people_out_ = bus_.advertise<HumanState>();
    go_out_ = bus_.advertise<Go>();
    advice_out_ = bus_.advertise<AttentionAdvice>();
    forecast_out_ = bus_.advertise<TrajectoryForecast>();
    command_out_ = bus_.advertise<TrajectoryCommand>();
    hand_out_ = bus_.advertise<HandCommand>();
    bus_.subscribe<RobotState>([this](const RobotState& m, const Receipt&) {
      if (m.mode != robot_state_.mode)
        remember("drive " + std::to_string(static_cast<int>(m.mode)));
      robot_state_ = m;
      ++states_;
      fastest = std::max(fastest, speed());
      if (states_ % 5 == 0) min_room = std::min(min_room, wall_room());
    });
    bus_.subscribe<ExecutionStatus>([this](const ExecutionStatus& m, const Receipt&) {
      if (m.mode != status_.mode || m.causes != status_.causes)
        remember(std::string(name(m.mode)) + " " + m.reason);
      status_ = m;
    });
    bus_.subscribe<ActiveTrajectory>(
        [this](const ActiveTrajectory& m, const Receipt&) { active_ = m; });
    bus_.subscribe<ComponentHealth>([this](const ComponentHealth& m, const Receipt&) {
      if (m.component != "driver") return;
      if (m.reason != trouble_) remember("driver says: " + m.reason);
      trouble_ = m.reason;
    });
    bus_.every(std::chrono::milliseconds(33), [this](TimePoint) { people_out_->publish(people_); });
    bus_.every(std::chrono::milliseconds(100), [this](TimePoint) { go_out_->publish(go_); });
    bus_.every(std::chrono::milliseconds(20), [this](TimePoint) {
      advice_out_->publish(advice_);
      forecast_out_->publish(forecast_);
    });
  }

  FirstDayPlan plan_;
  RobotModel robot_;
  Group arm_;
  std::vector<LinkCapsule> capsules_;
  DdsBus bus_;
  TemporaryFolder folder_;
  int port_{};
  std::unique_ptr<Background> driver_, controller_, fake_;
  std::vector<bool> moved_;
  Vector3 toward_wall_{Vector3::UnitX()};
  double wall_{};
  RobotState robot_state_;
  ExecutionStatus status_;
  ActiveTrajectory active_;
  HumanState people_;
  Go go_;
  AttentionAdvice advice_;
  TrajectoryForecast forecast_;
  std::string trouble_{"not heard of yet"}, history_;
  TimePoint begun_{bus_.now()};
  std::uint64_t id_{}, hand_id_{}, states_{};
  TimePoint asked_{};
  std::unique_ptr<Publisher<HumanState>> people_out_;
  std::unique_ptr<Publisher<Go>> go_out_;
  std::unique_ptr<Publisher<AttentionAdvice>> advice_out_;
  std::unique_ptr<Publisher<TrajectoryForecast>> forecast_out_;
  std::unique_ptr<Publisher<TrajectoryCommand>> command_out_;
  std::unique_ptr<Publisher<HandCommand>> hand_out_;
};

}  // namespace handsel::test
