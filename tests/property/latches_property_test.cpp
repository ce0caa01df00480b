// SPDX-License-Identifier: Apache-2.0
// Supervisor core and controller core over random events and restarts of either: no motion while a
// person's latch is set, and motion is permitted again after all latches are cleared.
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include "components/supervisor/safety/permission.hpp"
#include "components/supervisor/safety/safety_latches.hpp"
#include "components/supervisor/safety/state_file.hpp"
#include "components/trajectory_controller/supervise/go_gate.hpp"
#include "components/trajectory_controller/supervise/mode_machine.hpp"

namespace handsel::latches_property_test {
namespace {

using supervisor::DurableState;

constexpr Duration kStep = std::chrono::milliseconds(20);

/// The oracle: the state that people know, independent of any process.
struct Truth {
  bool paused{}, fault{}, stopped{};
  double override_factor{1.0};
  bool stands() const { return paused || fault || stopped; }
};

/// The supervisor, with a disk that is delayed and loses pending writes when the process is killed.
class SupervisorPart {
 public:
  explicit SupervisorPart(const settings::SupervisorSettings& settings) : settings_(settings) {
    start();
  }

  void start() {
    DurableState restored = supervisor::fresh_state(++clock_ * 1000, 1.0);
    if (!disk_.empty()) restored = std::get<DurableState>(supervisor::read_state(disk_, 1));
    latches_.emplace(restored);
    permission_.emplace(settings_);
    writing_.reset();
    stored_ = restored.safety.revision;
    if (disk_.empty()) disk_ = supervisor::write_state(restored, 1);
  }
  void kill() { latches_.reset(); }
  bool alive() const { return latches_.has_value(); }
  supervisor::SafetyLatches& latches() { return *latches_; }
  supervisor::Permission& permission() { return *permission_; }

  Go step(const ExecutionStatus& status, TimePoint now, bool disk_turns) {
    permission_->on(status, now);
    latches_->on(status, permission_->acknowledged());
    if (permission_->missed_stop(latches_->permitted_at_start())) latches_->on_missed_stop();
    if (writing_ && disk_turns) {
      disk_ = writing_->second;
      stored_ = writing_->first;
      writing_.reset();
    }
    const DurableState& state = latches_->state();
    if (!writing_ && stored_ != state.safety.revision)
      writing_.emplace(state.safety.revision, supervisor::write_state(state, 1));
    return permission_->step(
        {state.permission_revision, latches_->permits(), stored_ >= state.permission_revision,
         state.safety.override_factor, state.safety.reason},
        now);
  }
  /// Returns whether all decisions are on disk.
  bool settled() const { return !writing_ && stored_ == latches_->safety().revision; }

 private:
  settings::SupervisorSettings settings_;
  std::uint64_t clock_{}, stored_{};
  std::string disk_;
  std::optional<supervisor::SafetyLatches> latches_;
  std::optional<supervisor::Permission> permission_;
  std::optional<std::pair<std::uint64_t, std::string>> writing_;
};

/// The controller.
class ControllerPart {
 public:
  void start() {
    gate_ = {};
    modes_ = std::make_unique<trajectory_controller::ModeMachine>(
        trajectory_controller::TimeoutSettings{});
    go_.reset();
  }
  void receive(const Go& go, TimePoint now) {
    const auto refusal = gate_.receive(go);
    if (refusal == trajectory_controller::GoRefusal::older_epoch) return;
    received_ = now;
    if (refusal == trajectory_controller::GoRefusal::none) go_ = go;
  }
  ExecutionStatus step(DriveMode drive, bool fault, TimePoint now) {
    gate_.receive(drive);
    trajectory_controller::ModeInputs in;
    in.robot_age = in.human_age = in.forecast_age = in.attention_age = 0.001;
    in.go_age = go_ ? to_seconds(now - received_) : -1;
    in.at_rest = true;
    in.drive_enabled = drive == DriveMode::enabled;
    in.tracking_error = fault;
    in.go_epoch = go_ ? go_->epoch : 0;
    in.go_allowed = gate_.allowed();
    in.go_acknowledge = go_ && go_->acknowledge;
    in.first_go_epoch = gate_.first_epoch();
    in.awaits_person = gate_.awaits_person();
    const auto verdict = modes_->update(in);
    ExecutionStatus status;
    status.mode = verdict.mode;
    status.causes = verdict.causes;
    status.epoch = in.go_epoch;
    return status;
  }
  double factor() const { return go_ ? go_->override_factor : 0.0; }

 private:
  trajectory_controller::GoGate gate_;
  std::unique_ptr<trajectory_controller::ModeMachine> modes_;
  std::optional<Go> go_;
  TimePoint received_{};
};

class Latches {
 public:
  explicit Latches(std::uint64_t seed) : random_(seed), supervisor_(settings()) {
    controller_.start();
  }

  void cycle() {
    now_ += kStep;
    act();
    status_ = controller_.step(drive_, std::exchange(fault_, false), now_);
    if (supervisor_.alive()) {
      RobotState robot;
      robot.mode = drive_;
      supervisor_.latches().on(robot);
      latched_go_ = supervisor_.step(status_, now_, !chance(3));
      controller_.receive(*latched_go_, now_);
    } else if (--down_ <= 0) {
      supervisor_.start();
    }
    check();
  }
  int moved() const { return moved_; }
  int blocked() const { return blocked_; }

  /// A person clears all latches; then motion must be possible within two seconds.
  void put_right() {
    drive_ = DriveMode::enabled;
    calm_ = true;
    for (int k = 0; k < 20; ++k) cycle();  // the supervisor restarts
    for (int k = 0; k < 100; ++k) {
      if (k == 0) person_acknowledges();
      if (k == 40) person_resumes();
      cycle();
    }
    calm_ = false;
    ASSERT_LT(status_.mode, Mode::hold)
        << "nothing stands, and yet it does not move: "
        << (supervisor_.alive() ? supervisor_.latches().safety().reason : "no supervisor");
    ASSERT_EQ(controller_.factor(), truth_.override_factor);
  }

 private:
  static settings::SupervisorSettings settings() {
    settings::SupervisorSettings s;
    s.resume_delay = 0.1;
    s.health_timeout = 0.3;
    return s;
  }
  bool chance(int one_in) { return random_() % static_cast<std::uint64_t>(one_in) == 0; }

  /// A person is answered after the state is on disk; an unanswered act may be lost.
  void person_pauses() {
    supervisor_.latches().pause();
    settle();
    truth_.paused = true;
  }
  void person_resumes() {
    if (supervisor_.latches().resume().empty()) {
      supervisor_.permission().acknowledge();
      truth_.paused = truth_.stopped = false;
    }
  }
  void person_acknowledges() {
    if (supervisor_.latches().acknowledge().empty()) {
      supervisor_.permission().acknowledge();
      truth_.fault = truth_.stopped = false;
    }
  }
  void settle() {
    for (int k = 0; k < 50 && !supervisor_.settled(); ++k)
      controller_.receive(supervisor_.step(status_, now_, true), now_);
  }
  void act() {
    if (calm_) return;
    if (supervisor_.alive()) {
      if (chance(60)) person_pauses();
      if (chance(60)) person_resumes();
      if (chance(60)) person_acknowledges();
      if (chance(80)) {
        truth_.override_factor = static_cast<double>(random_() % 11) / 10;
        supervisor_.latches().set_override(truth_.override_factor);
        settle();
      }
      if (chance(50)) {
        supervisor_.kill();
        down_ = 1 + static_cast<int>(random_() % 10);
      }
    }
    if (chance(100)) fault_ = true;
    const DriveMode before = drive_;
    if (drive_ == DriveMode::enabled && chance(80))
      drive_ = static_cast<DriveMode>(static_cast<int>(DriveMode::protective_stop) +
                                      static_cast<int>(random_() % 3));
    else if (drive_ != DriveMode::enabled && chance(10))
      drive_ = DriveMode::enabled;
    if (drive_ != before && drive_ != DriveMode::enabled) truth_.stopped = true;
    // The controller restarts only after its report has reached the supervisor: otherwise the event
    // would be lost with both processes.
    const bool is_reported = supervisor_.alive() && supervisor_.settled() &&
                             supervisor_.latches().safety().fault == truth_.fault &&
                             supervisor_.latches().safety().awaits_person == truth_.stopped;
    if (drive_ == DriveMode::enabled && !fault_ && is_reported && chance(70)) {
      controller_.start();
      if (latched_go_) controller_.receive(*latched_go_, now_);  // the last Go is transient local
    }
    if (fault_) truth_.fault = true;
  }
  void check() {
    const bool moves = status_.mode < Mode::hold;
    moved_ += moves;
    blocked_ += truth_.stands();
    ASSERT_FALSE(moves && truth_.stands())
        << "paused " << truth_.paused << " fault " << truth_.fault << " stopped " << truth_.stopped;
    ASSERT_FALSE(moves && controller_.factor() > truth_.override_factor + 1e-9);
  }

  std::mt19937_64 random_;
  SupervisorPart supervisor_;
  ControllerPart controller_;
  Truth truth_;
  TimePoint now_{from_seconds(100)};
  DriveMode drive_{DriveMode::enabled};
  bool fault_{}, calm_{};
  int down_{}, moved_{}, blocked_{};
  ExecutionStatus status_;
  std::optional<Go> latched_go_;
};

TEST(LatchesProperty, nothing_moves_while_a_latch_stands_whatever_restarts) {
  int moved = 0, blocked = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Latches world(seed);
    for (int part = 0; part < 20; ++part) {
      for (int k = 0; k < 500; ++k) {
        world.cycle();
        if (testing::Test::HasFatalFailure()) return;
      }
      world.put_right();
      if (testing::Test::HasFatalFailure()) return;
    }
    moved += world.moved();
    blocked += world.blocked();
  }
  std::printf("%d cycles in motion, %d while a latch stood\n", moved, blocked);
  EXPECT_GT(moved, 10000);
  EXPECT_GT(blocked, 10000);
}

}  // namespace
}  // namespace handsel::latches_property_test
