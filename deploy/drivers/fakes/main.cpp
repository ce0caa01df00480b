// SPDX-License-Identifier: Apache-2.0
// Simulated controller of an arm's maker: exchanges UDP with a driver at the arm's cycle, plays a
// script, and reports at its end what it was commanded and what it would have refused.
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <deque>

#include <CLI/CLI.hpp>

#include "common/base/errors.hpp"
#include "common/bus/executor.hpp"
#include "common/config/resources.hpp"
#include "deploy/drivers/fakes/fake_script.hpp"

namespace handsel::drivers {
namespace {

std::atomic<bool> asked_to_end{false};

void play(FakeArm& arm, FakeScript& script, int driver_port) {
  UdpPort port(0);
  std::deque<std::pair<TimePoint, std::string>> late;
  std::string datagram;
  Order order;
  TimePoint next = monotonic_now();
  while (!asked_to_end) {
    arm.cycle();
    if (const std::string said = script.step(arm, arm.period()); !said.empty()) {
      std::printf("%s\n", said.c_str());
      std::fflush(stdout);
    }
    const TimePoint now = monotonic_now();
    if (arm.events.drop > 0)
      --arm.events.drop;
    else
      late.emplace_back(now + from_seconds(script.delay()), arm.state());
    for (; !late.empty() && late.front().first <= now; late.pop_front())
      port.send_to(driver_port, late.front().second);
    next += from_seconds(arm.period());
    if (next < now) next = now;  // this machine was delayed: no burst of cycles afterwards
    for (Duration left = next - monotonic_now(); left > Duration::zero() && port.wait(left);
         left = next - monotonic_now())
      while (port.receive(datagram))
        if (decode(datagram, order)) arm.on(order);
  }
}

void report(const FakeAccount& a) {
  std::printf(
      "moved %d cycles, violations %d, sessions %d, grasps %d, gripper moves %d, load %.3f kg, "
      "grasp force %.1f N, fastest %.4f "
      "rad/s%s%s\n",
      a.commanded, a.violations, a.sessions, a.grasps, a.moves, a.load, a.grasp_force, a.fastest,
      a.last_violation.empty() ? "" : ", last violation: ", a.last_violation.c_str());
}

int run(int argc, char** argv) {
  std::string kind, robot = "jido", script;
  int port = 0;
  double cycle = 0.005, deceleration = 3.0;
  bool realtime = false;
  CLI::App app{"a maker's controller that is not there"};
  app.add_option("kind", kind, "position_arm or reflex_arm")
      ->required()
      ->check(CLI::IsMember({"position_arm", "reflex_arm"}));
  app.add_option(
         "--robot", robot,
         "robot description: name or file; its group \"arm\" stands in the rest configuration")
      ->capture_default_str();
  app.add_option("--port", port, "where the driver listens")
      ->required()
      ->check(CLI::Range(1, 65535));
  app.add_option("--script", script, "what happens to the arm");
  app.add_option("--cycle", cycle, "of a position_arm [s]")
      ->check(CLI::Range(0.001, 0.01))
      ->capture_default_str();
  app.add_option("--deceleration", deceleration,
                 "of a reflex_arm's velocity limit toward the ends [rad/s^2]")
      ->capture_default_str();
  app.add_flag("--realtime", realtime, "SCHED_FIFO where permitted");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const RobotModel model = RobotModel::load(robot_description(robot));
  const std::vector<int>& axes = model.require_group("arm").axes;
  FakeScript played(script.empty() ? std::vector<FakeLine>{} : load_fake_script(script));
  std::unique_ptr<FakeArm> arm;
  if (kind == "position_arm")
    arm = std::make_unique<FakeCyclicArm>(model, axes, cycle);
  else
    arm = std::make_unique<FakeReflexArm>(model, axes, deceleration);
  if (realtime) {
    sched_param urgent{};
    urgent.sched_priority = 60;
    if (sched_setscheduler(0, SCHED_FIFO, &urgent) != 0)
      std::fprintf(stderr, "handsel_fake_arm: SCHED_FIFO is not permitted\n");
  }
  std::printf("ready\n");
  std::fflush(stdout);
  play(*arm, played, port);
  report(arm->account);
  return 0;
}

}  // namespace
}  // namespace handsel::drivers

int main(int argc, char** argv) {
  for (int signal : {SIGTERM, SIGINT})
    std::signal(signal, [](int) { handsel::drivers::asked_to_end = true; });
  try {
    return handsel::drivers::run(argc, argv);
  } catch (const handsel::ConfigError& error) {
    std::fprintf(stderr, "handsel_fake_arm: %s\n", error.what());
    return 2;
  } catch (const handsel::MissingError& error) {
    std::fprintf(stderr, "handsel_fake_arm: %s\n", error.what());
    return 3;
  }
}
