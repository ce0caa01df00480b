// SPDX-License-Identifier: Apache-2.0
#include "sim/node.hpp"

#include <algorithm>
#include <random>

#include "common/config/scenario.hpp"

namespace handsel::sim {

namespace {

// Max steps in one tick, below the gap that stops the robot; more delay slows the simulation.
constexpr std::uint64_t kMaxStepsPerTick = 5;

constexpr Duration kTickPeriod = std::chrono::milliseconds(2);          // with simulated time
constexpr Duration kGrantRepeatPeriod = std::chrono::milliseconds(20);  // while no step is made
// One set-point is applied per step; it is skipped if its successor is older than this.
constexpr Duration kMaxSetPointAge = std::chrono::milliseconds(5);
}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : context_(context),
      settings_(load_settings(context.settings)),
      bus_(bus),
      output_(bus, settings_) {
  if (context.scenario.empty()) throw ConfigError("the simulator needs --scenario");
  scenario_ = read_scenario(context.scenario, context.seed);
  restart();
  bus.subscribe<JointCommand>([this](const JointCommand& m, const Receipt& r) {
    if (m.robot != context_.robot->name())
      bus_.count_left_out("joint_command: for another robot", 1);
    else if (to_seconds(set_point_age_.of(m, r, keeper_)) > settings_.max_setpoint_age)
      bus_.count_left_out("joint_command: too old", 1);
    else if (keeper_)
      set_points_.push_back({m, r.writer});
    else
      world_->command(m, r.writer, to_seconds(r.arrival.time_since_epoch()));
  });
  if (context.sim_time) {
    keeper_.emplace(settings_);
    clock_out_ = bus.advertise<SimClock>();
    clock_.incarnation = (std::uint64_t{std::random_device{}()} << 32) | std::random_device{}();
    bus.subscribe<ClockReached>(
        [this](const ClockReached& m, const Receipt&) {
          processes_.add(m.incarnation);
          keeper_->answered(m.component, m.incarnation, m.sequence);
        },
        {.wakes = false});
  }
  if (world_->follows())
    bus.subscribe<HumanObservation>([this](const auto& m, const Receipt&) { world_->observe(m); });
  if (world_->listens())
    bus.subscribe<ActionStatus>([this](const auto& m, const Receipt&) { world_->announce(m); });
  bus.subscribe<SensorRequest>([this](const auto& m, const Receipt&) { world_->request(m); });
  bus.subscribe<SimControl>([this](const SimControl& m, const Receipt&) { on_control(m); });
  bus.every(keeper_ ? kTickPeriod : from_seconds(settings_.step),
            [this](TimePoint now) { tick(now); });
}

void Node::restart() {
  world_ = std::make_unique<SimWorld>(*context_.robot, context_.objects, scenario_, settings_,
                                      context_.seed);
  steps_ = 0;
  started_ = false;
  output_.reset();
}

void Node::on_control(const SimControl& control) {
  switch (control.action) {
    case SimAction::pause:
      paused_ = true;
      break;
    case SimAction::resume:
      paused_ = false;
      started_ = false;
      break;
    case SimAction::reset:
      restart();
      break;
    default:
      bus_.set_degraded(world_->control(control));
      break;
  }
}

Stamp Node::stamp_now() const {
  return keeper_ ? bus_.stamp_now() - (bus_.now() - keeper_->time()).count() : bus_.stamp_now();
}

void Node::announce(TimePoint now) {
  if (clock_.sequence == keeper_->grant_number() && now - announced_ < kGrantRepeatPeriod) return;
  const TimeGrant grant = keeper_->grant();
  clock_.stamp = bus_.stamp_now();
  clock_.sequence = keeper_->grant_number();
  clock_.granted_until = to_seconds(grant.until.time_since_epoch());
  clock_.waited = to_seconds(grant.waited);
  clock_out_->publish(clock_);
  announced_ = now;
}

void Node::step_when_granted(TimePoint now) {
  keeper_->turn(now);
  keeper_->leave_out_stopped([this](std::uint64_t process) { return processes_.runs(process); });
  announce(now);
  while (keeper_->may_step(paused_ || !set_points_.empty())) {
    if (keeper_->takes_setpoint() && !set_points_.empty()) {
      const Stamp oldest = stamp_now() - kMaxSetPointAge.count();
      while (set_points_.size() > 1 && set_points_[1].message.stamp < oldest)
        set_points_.pop_front();
      const SetPoint& next = set_points_.front();
      world_->command(next.message, next.writer, to_seconds(keeper_->time().time_since_epoch()));
      set_points_.pop_front();
    }
    if (!paused_) step_world();
    keeper_->stepped();
    announce(now);
  }
  factor_.update(now, world_->time());
}

void Node::tick(TimePoint now) {
  if (keeper_) return step_when_granted(now);
  if (paused_) return;
  if (!started_) {
    started_ = true;
    start_ = now;
    since_start_ = 0;
    factor_.restart(now, world_->time());
  }
  const std::uint64_t due = 1 + std::llround(to_seconds(now - start_) / settings_.step);
  if (due > since_start_ + kMaxStepsPerTick) {  // the delay is not made up for
    start_ = now - from_seconds(static_cast<double>(since_start_) * settings_.step);
    return;
  }
  while (since_start_ < due) {
    step_world();
    ++since_start_;
  }
  factor_.update(now, world_->time());
}

void Node::step_world() {
  world_->step();
  ++steps_;
  output_.publish(
      *world_, steps_, [this] { return stamp_now(); }, factor_.value());
}

}  // namespace handsel::sim
