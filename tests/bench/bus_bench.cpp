// SPDX-License-Identifier: Apache-2.0
// Cost of the bus on this machine: `bench_bus trip` measures DDS round trips between two
// processes, `bench_bus load` replays the traffic of the table of topics with one process per
// component and prints the processor load of each.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "common/bus/dds/dds_bus.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/messages/world.hpp"

namespace handsel {
namespace {

constexpr std::uint32_t kDomain = 230;
constexpr const char* kComponents[] = {"sim",
                                       "trajectory_controller",
                                       "spark",
                                       "supervisor",
                                       "costmap",
                                       "collision_checker",
                                       "path_planner",
                                       "grasp_planner",
                                       "trajectory_planner",
                                       "manipulation_planner",
                                       "attention",
                                       "bridge"};

template <class M>
M example() {
  return M{};
}
template <>
RobotState example() {
  RobotState m;
  m.robot = "jido";
  m.position = m.velocity = m.effort = m.external_torque = Vector::Constant(22, 0.1);
  return m;
}
template <>
JointCommand example() {
  JointCommand m;
  m.robot = "jido";
  m.position = m.velocity = m.acceleration = Vector::Constant(22, 0.1);
  return m;
}
template <>
HumanState example() {
  HumanState m;
  Person person;
  person.id = "anna";
  person.joints.resize(20);
  for (BodyJoint& joint : person.joints) joint.name = "head";
  m.people.assign(2, person);
  return m;
}
template <>
ActiveTrajectory example() {
  ActiveTrajectory m;
  m.robot = "jido";
  m.position = m.velocity = m.acceleration = Vector::Constant(22, 0.1);
  m.axes = {0, 1, 2, 3, 4, 5, 6};
  AxisTrajectory axis;
  axis.segments.assign(60, Segment{0.05, 1.0});
  m.rest.axes.assign(7, axis);
  return m;
}
template <>
ExecutionStatus example() {
  ExecutionStatus m;
  m.robot = "jido";
  return m;
}

template <class M>
void play(Bus& bus, const std::string& component) {
  const TopicRow& row = TopicOf<M>::row;
  const bool reads = named_in(row.readers, component) || component == "bridge";
  const bool slow = row.rate > 100 && component != "trajectory_controller" && component != "sim";
  if (reads)
    bus.subscribe<M>([](const M&, const Receipt&) {},
                     {.period = slow ? Duration(std::chrono::milliseconds(20)) : Duration{}});
  if (!named_in(row.writers, component) || row.rate <= 0) return;
  std::shared_ptr<Publisher<M>> publisher = bus.advertise<M>();
  bus.every(from_seconds(1.0 / row.rate),
            [publisher, m = example<M>()](TimePoint) { publisher->publish(m); });
}

int node(const std::string& component, double seconds) {
  DdsBus bus({.component = component, .domain = kDomain});
  play<RobotState>(bus, component);
  play<JointCommand>(bus, component);
  play<HumanState>(bus, component);
  play<Scene>(bus, component);
  play<Facts>(bus, component);
  play<ActiveTrajectory>(bus, component);
  play<ExecutionStatus>(bus, component);
  play<TrajectoryForecast>(bus, component);
  play<Go>(bus, component);
  bus.set_ready();
  std::uint64_t commands = 0;
  TimePoint last{};
  Duration worst{};
  if (component == "sim")
    bus.subscribe<JointCommand>([&](const JointCommand&, const Receipt& r) {
      if (++commands > 1000) worst = std::max(worst, r.arrival - last);
      last = r.arrival;
    });
  bus.run_until([] { return false; }, std::chrono::seconds(2));
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  bus.run_until([] { return false; }, from_seconds(seconds));
  getrusage(RUSAGE_SELF, &after);
  const auto cpu = [](const rusage& r) {
    return static_cast<double>(r.ru_utime.tv_sec + r.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
  };
  std::printf("%-22s %5.1f %% of a core, %3ld MB, %5.0f switches/s", component.c_str(),
              100 * (cpu(after) - cpu(before)) / seconds, after.ru_maxrss / 1024,
              static_cast<double>(after.ru_nvcsw - before.ru_nvcsw) / seconds);
  if (component == "sim")
    std::printf(", %llu set-points, longest gap %.1f ms", static_cast<unsigned long long>(commands),
                to_seconds(worst) * 1e3);
  std::printf("\n");
  return 0;
}

int echo() {
  DdsBus bus({.component = "echo sim", .domain = kDomain, .health = false});
  auto publisher = bus.advertise<RobotState>();
  RobotState answer = example<RobotState>();
  bool done = false;
  bus.subscribe<JointCommand>([&](const JointCommand& m, const Receipt&) {
    answer.sequence = m.sequence;
    done = m.sequence == 0;
    publisher->publish(answer);
  });
  bus.run_until([&] { return done; }, std::chrono::seconds(60));
  return 0;
}

int trip() {
  DdsBus bus({.component = "trip trajectory_controller", .domain = kDomain, .health = false});
  auto publisher = bus.advertise<JointCommand>();
  JointCommand question = example<JointCommand>();
  std::uint64_t got = 0;
  const auto& status =
      bus.subscribe<RobotState>([&](const RobotState& m, const Receipt&) { got = m.sequence; });
  if (!bus.run_until([&] { return publisher->readers() == 1 && status.writers == 1; },
                     std::chrono::seconds(10)))
    return 1;
  std::vector<double> micros;
  for (std::uint64_t i = 1; i <= 20000; ++i) {
    question.sequence = i;
    const TimePoint start = bus.now();
    publisher->publish(question);
    if (!bus.run_until([&] { return got == i; }, std::chrono::milliseconds(100))) continue;
    micros.push_back(to_seconds(bus.now() - start) * 1e6);
  }
  question.sequence = 0;
  publisher->publish(question);
  std::sort(micros.begin(), micros.end());
  const auto at = [&](double fraction) {
    return micros[static_cast<std::size_t>(fraction * static_cast<double>(micros.size() - 1))];
  };
  std::printf(
      "round trip, 22 axes each way, conversions and executors included: median %.0f us, p99 %.0f "
      "us, p99.9 %.0f us, %zu of 20000\n",
      at(0.5), at(0.99), at(0.999), micros.size());
  return 0;
}

pid_t spawn(const char* self, std::vector<std::string> arguments) {
  const pid_t child = fork();
  if (child != 0) return child;
  std::vector<char*> argv{const_cast<char*>(self)};
  for (std::string& a : arguments) argv.push_back(a.data());
  argv.push_back(nullptr);
  execv("/proc/self/exe", argv.data());
  _exit(127);
}

}  // namespace
}  // namespace handsel

int main(int argc, char** argv) {
  using namespace handsel;
  setenv("CYCLONEDDS_URI", "file://" HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml", 0);
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "node" && argc == 4) return node(argv[2], std::stod(argv[3]));
  if (mode == "echo") return echo();
  if (mode == "trip") {
    const pid_t other = spawn(argv[0], {"echo"});
    const int result = trip();
    waitpid(other, nullptr, 0);
    return result;
  }
  if (mode == "load") {
    const std::string seconds = argc > 2 ? argv[2] : "5";
    std::vector<pid_t> children;
    for (const char* component : kComponents)
      children.push_back(spawn(argv[0], {"node", component, seconds}));
    for (const pid_t child : children) waitpid(child, nullptr, 0);
    return 0;
  }
  std::fprintf(stderr, "bench_bus trip | load [SECONDS]\n");
  return 2;
}
