// SPDX-License-Identifier: Apache-2.0
// Time from the publication of a person sample to the changed set-point, over DDS, with the
// controller as its own process; for comparison the lower bound of the machine: a UDP round trip of
// the same size and the wait for the next control tick. Usage: bench_reaction [reactions] [domain].
// Prints times, without limits.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/executor.hpp"
#include "common/config/resources.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/task.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/solve.hpp"
#include "tests/support/processes/live_view.hpp"

namespace handsel {
namespace {

double at(std::vector<double>& sorted, double fraction) {
  return sorted[std::min(sorted.size() - 1,
                         static_cast<std::size_t>(fraction * static_cast<double>(sorted.size())))];
}

void print(const char* what, std::vector<double> us) {
  if (us.empty()) return;
  std::sort(us.begin(), us.end());
  std::printf("%-34s %5zu  p50 %7.0f  p99 %7.0f  longest %7.0f us\n", what, us.size(), at(us, 0.5),
              at(us, 0.99), us.back());
}

double since(TimePoint t) { return 1e6 * to_seconds(monotonic_now() - t); }

void become_urgent() {
  sched_param priority{};
  priority.sched_priority = 40;
  sched_setscheduler(0, SCHED_FIFO, &priority);
}

/// Loopback UDP there and back, as many bytes as a sample of a person and a set-point.
std::vector<double> udp_trips(int count) {
  const int a = socket(AF_INET, SOCK_DGRAM, 0), b = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to_a{}, to_b{};
  to_a.sin_family = to_b.sin_family = AF_INET;
  to_a.sin_addr.s_addr = to_b.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof to_a;
  if (bind(a, reinterpret_cast<sockaddr*>(&to_a), size) != 0 ||
      bind(b, reinterpret_cast<sockaddr*>(&to_b), size) != 0)
    return {};
  getsockname(a, reinterpret_cast<sockaddr*>(&to_a), &size);
  getsockname(b, reinterpret_cast<sockaddr*>(&to_b), &size);
  std::vector<char> person(1600), set_point(640);
  std::thread echo([&] {
    become_urgent();
    std::vector<char> buffer(2000);
    for (int k = 0; k < count; ++k) {
      if (recv(b, buffer.data(), buffer.size(), 0) <= 0) return;
      sendto(b, set_point.data(), set_point.size(), 0, reinterpret_cast<sockaddr*>(&to_a),
             sizeof to_a);
    }
  });
  std::vector<double> out;
  std::vector<char> buffer(2000);
  const int pace = timerfd_create(CLOCK_MONOTONIC, 0);
  const itimerspec each{{0, 500'000}, {0, 500'000}};
  timerfd_settime(pace, 0, &each, nullptr);
  for (int k = 0; k < count; ++k) {
    std::uint64_t beats = 0;
    [[maybe_unused]] const auto waited = read(pace, &beats, sizeof beats);
    const TimePoint begin = monotonic_now();
    sendto(a, person.data(), person.size(), 0, reinterpret_cast<sockaddr*>(&to_b), sizeof to_b);
    if (recv(a, buffer.data(), buffer.size(), 0) <= 0) break;
    out.push_back(since(begin));
  }
  echo.join();
  close(pace);
  close(a);
  close(b);
  return out;
}

/// From a random moment to the next tick of a timer of one millisecond.
std::vector<double> tick_waits(int count, std::mt19937_64& random) {
  const int timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK);
  const itimerspec each{{0, 1'000'000}, {0, 1'000'000}};
  timerfd_settime(timer, 0, &each, nullptr);
  std::vector<double> out;
  std::uint64_t ticks = 0;
  for (int k = 0; k < count; ++k) {
    const TimePoint begin = monotonic_now();
    const Duration wait(std::uniform_int_distribution<int>(1'000'000, 2'000'000)(random));
    while (monotonic_now() < begin + wait) {
    }
    pollfd ready{timer, POLLIN, 0};
    [[maybe_unused]] const auto passed = read(timer, &ticks, sizeof ticks);
    const TimePoint asked = monotonic_now();
    if (poll(&ready, 1, 10) != 1) break;
    out.push_back(since(asked));
  }
  close(timer);
  return out;
}

class Probe {
 public:
  Probe(std::uint32_t domain, int wanted)
      : robot_(RobotModel::load(robot_description("jido"))),
        bus_({.component = "reaction_probe sim spark supervisor manipulation_planner",
              .domain = domain,
              .realtime = true,
              .health = false}),
        wanted_(wanted) {
    state_.robot = robot_.name();
    state_.position = robot_.rest_configuration();
    state_.velocity = state_.effort = Vector::Zero(robot_.dof());
    state_.mode = DriveMode::enabled;
    people_.covered = true;
    people_.views = {test::live_view()};
    go_.epoch = go_.state_revision = 1;
    go_.allowed = true;
    forecast_.time_to_collision = 1e9;
  }

  bool run() {
    state_out_ = bus_.advertise<RobotState>();
    people_out_ = bus_.advertise<HumanState>();
    go_out_ = bus_.advertise<Go>();
    advice_out_ = bus_.advertise<AttentionAdvice>();
    forecast_out_ = bus_.advertise<TrajectoryForecast>();
    command_out_ = bus_.advertise<TrajectoryCommand>();
    bus_.subscribe<JointCommand>(
        [this](const JointCommand& m, const Receipt& r) { on(m, r.arrival); });
    bus_.subscribe<ExecutionStatus>(
        [this](const ExecutionStatus& m, const Receipt&) { status_ = m; });
    bus_.every(std::chrono::milliseconds(2), [this](TimePoint) {
      ++state_.sequence;
      state_out_->publish(state_);
    });
    bus_.every(std::chrono::milliseconds(33), [this](TimePoint) { people_out_->publish(people_); });
    bus_.every(std::chrono::milliseconds(100), [this](TimePoint) { go_out_->publish(go_); });
    bus_.every(std::chrono::milliseconds(20), [this](TimePoint) {
      advice_out_->publish(advice_);
      forecast_out_->publish(forecast_);
      if (status_.motion != MotionState::running && status_.mode < Mode::hold && ++idle_ > 5)
        send();
      if (status_.mode >= Mode::hold && ++held_ % 25 == 0) ++go_.epoch;
    });
    return bus_.run_until([this] { return static_cast<int>(reactions_.size()) >= wanted_; },
                          std::chrono::seconds(20 + wanted_));
  }

  const std::vector<double>& reactions() const { return reactions_; }
  const std::vector<double>& gaps() const { return gaps_; }
  const ExecutionStatus& status() const { return status_; }

 private:
  /// A slow sweep of the first axis: at cruise its acceleration is nothing, so that any change
  /// shows.
  void send() {
    idle_ = 0;
    const Group& arm = robot_.require_group("arm");
    Vector from = RobotModel::part(state_.position, arm),
           to = RobotModel::part(robot_.rest_configuration(), arm);
    to[0] += (++command_.id % 2) ? 0.6 : -0.3;
    command_.robot = robot_.name();
    command_.epoch = status_.epoch;
    command_.axes.assign(arm.axes.begin(), arm.axes.end());
    KinematicLimits slow{Vector::Constant(from.size(), 0.15), Vector::Constant(from.size(), 1.0),
                         Vector::Constant(from.size(), 5.0)};
    command_.trajectory = solve(rest_state(from), rest_state(to), slow).trajectory;
    command_out_->publish(command_);
  }
  void on(const JointCommand& m, TimePoint arrival) {
    state_.position = m.position;
    if (last_ != TimePoint{}) gaps_.push_back(1e6 * to_seconds(arrival - last_));
    last_ = arrival;
    const double pushed = m.acceleration.head(7).cwiseAbs().maxCoeff(),
                 speed = m.velocity.head(7).cwiseAbs().maxCoeff();
    if (waiting_ && pushed > 1e-9) {
      waiting_ = false;
      reactions_.push_back(1e6 * to_seconds(arrival - asked_));
      people_.people.clear();
      people_out_->publish(people_);
    }
    cruising_ = !waiting_ && pushed <= 1e-9 && speed > 0.14 ? cruising_ + 1 : 0;
    if (cruising_ < 60) return;
    cruising_ = 0;
    bus_.after(Duration(std::uniform_int_distribution<int>(0, 2'000'000)(random_)),
               [this, v = Vector(m.velocity)](TimePoint) { dart(v); });
  }
  /// A person runs in against the motion of the hand.
  void dart(const Vector& velocity) {
    if (waiting_ || state_.position.size() == 0) return;
    const Vector3 p = robot_.link_pose(state_.position, robot_.tool_link()).translation();
    Vector3 direction =
        robot_.link_pose(state_.position + 1e-3 * velocity, robot_.tool_link()).translation() - p;
    direction.z() = 0;
    direction.normalize();
    Person person;
    person.id = "anna";
    person.joints = standing_body(Vector3(p.x(), p.y(), 0) + 0.75 * direction, 0.0, 1.75);
    for (BodyJoint& joint : person.joints) joint.velocity = -2.0 * direction;
    people_.people = {person};
    waiting_ = true;
    asked_ = monotonic_now();
    people_out_->publish(people_);
  }

  RobotModel robot_;
  DdsBus bus_;
  int wanted_{}, idle_{}, held_{}, cruising_{};
  std::unique_ptr<Publisher<RobotState>> state_out_;
  std::unique_ptr<Publisher<HumanState>> people_out_;
  std::unique_ptr<Publisher<Go>> go_out_;
  std::unique_ptr<Publisher<AttentionAdvice>> advice_out_;
  std::unique_ptr<Publisher<TrajectoryForecast>> forecast_out_;
  std::unique_ptr<Publisher<TrajectoryCommand>> command_out_;
  RobotState state_;
  HumanState people_;
  Go go_;
  AttentionAdvice advice_;
  TrajectoryForecast forecast_;
  TrajectoryCommand command_;
  ExecutionStatus status_;
  std::mt19937_64 random_{7};
  bool waiting_{};
  TimePoint asked_{}, last_{};
  std::vector<double> reactions_, gaps_;
};

int measure(int wanted, std::uint32_t domain) {
  use_default_dds_configuration();
  const std::string number = std::to_string(domain);
  const pid_t child = fork();
  if (child == 0) {
    execl(HANDSEL_CONTROLLER, HANDSEL_CONTROLLER, "--realtime", "--domain", number.c_str(),
          nullptr);
    std::_Exit(127);
  }
  Probe probe(domain, wanted);
  const bool all = probe.run();
  kill(child, SIGTERM);
  waitpid(child, nullptr, 0);
  become_urgent();
  std::mt19937_64 random(3);
  print("person on the wire -> set-point", probe.reactions());
  print("floor: UDP there and back", udp_trips(wanted));
  print("floor: wait for a 1 kHz tick", tick_waits(wanted, random));
  print("between set-points", probe.gaps());
  std::vector<int> bins(12);
  for (double us : probe.reactions())
    ++bins[std::min<std::size_t>(11, static_cast<std::size_t>(us / 250.0))];
  for (std::size_t i = 0; i < bins.size(); ++i)
    std::printf("  %s%5zu us %s\n", i + 1 < bins.size() ? " " : ">", i * 250,
                std::string(static_cast<std::size_t>(bins[i]), '#').c_str());
  if (!all)
    std::printf("only %zu reactions: %s\n", probe.reactions().size(),
                probe.status().reason.c_str());
  return all ? 0 : 1;
}

}  // namespace
}  // namespace handsel

int main(int argc, char** argv) {
  const int wanted = argc > 1 ? std::atoi(argv[1]) : 100;
  return handsel::measure(wanted, static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 229));
}
