// SPDX-License-Identifier: Apache-2.0
// Latency from an observation on the wire to the Scene and HumanState that contain it, over DDS,
// with SPARK as its own process. Prints the figures; the assertions also hold on a busy machine.
// HANDSEL_RUNS: number of observations (100).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "common/bus/dds/dds_bus.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "tests/support/processes/background.hpp"

namespace handsel::spark_latency_test {
namespace {

constexpr Duration kEvery = std::chrono::milliseconds(20);
constexpr double kStep = 0.02;  // motion between two observations [m]

struct Delays {
  std::vector<double> milliseconds;
  double share(double q) {
    std::sort(milliseconds.begin(), milliseconds.end());
    return milliseconds.at(
        static_cast<std::size_t>(q * static_cast<double>(milliseconds.size() - 1)));
  }
  void print(const char* what) {
    std::printf("%-12s p50 %.2f ms, p99 %.2f ms, largest %.2f ms of %zu\n", what, share(0.5),
                share(0.99), share(1), milliseconds.size());
    const double edges[] = {0.25, 0.5, 1, 2, 5, 10, 20, 1e9};
    double low = 0;
    for (const double edge : edges) {
      const auto in = std::count_if(milliseconds.begin(), milliseconds.end(),
                                    [&](double d) { return d >= low && d < edge; });
      if (in > 0) std::printf("  %5.2f to %5.2f ms %5td\n", low, std::min(edge, 99.0), in);
      low = edge;
    }
  }
};

TEST(SparkLatency, an_observation_is_in_the_scene_at_once) {
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int runs = asked ? std::atoi(asked) : 100;
  const std::uint32_t domain = 100 + static_cast<std::uint32_t>(getpid()) % 100;
  use_default_dds_configuration();
  test::Background spark({HANDSEL_SPARK, "--domain", std::to_string(domain), "--robot", "jido"});
  DdsBus bus({.component = "sim", .domain = domain, .health = false});
  auto things = bus.advertise<ObjectObservation>();
  auto people = bus.advertise<HumanObservation>();
  double mug = 0, anna = 0;
  TimePoint sent{};
  Delays scenes, states;
  bool scene_there = false, state_there = false;
  bus.subscribe<Scene>([&](const Scene& scene, const Receipt& receipt) {
    for (const SceneObject& object : scene.objects)
      if (!scene_there && std::abs(object.T_world_object.translation().x() - mug) < kStep / 4) {
        scene_there = true;
        scenes.milliseconds.push_back(1e3 * to_seconds(receipt.arrival - sent));
      }
  });
  bus.subscribe<HumanState>([&](const HumanState& state, const Receipt& receipt) {
    for (const Person& person : state.people)
      if (!state_there && std::abs(person.joints.at(2).position.x() - anna) < kStep / 4) {
        state_there = true;
        states.milliseconds.push_back(1e3 * to_seconds(receipt.arrival - sent));
      }
  });
  const auto observe = [&](int i) {
    mug = 0.5 + kStep * (i % 10);
    ObjectObservation thing;
    thing.source = "tracker";
    thing.objects = {
        {"crate", "", make_pose({mug, 0, 0.8}), 0.9, {}, {PrimitiveKind::box, {0.1, 0.1, 0.1}}}};
    HumanObservation body;
    body.source = "camera";
    body.coverage = {{-4, -4, -1}, {4, 4, 3}};
    body.people.push_back({"1", {}, false});
    for (const BodyJoint& joint : standing_body({2 + kStep * (i % 10), 0, 0}, M_PI, 1.75))
      body.people[0].joints.push_back({joint.name, joint.position, 1.0});
    anna = body.people[0].joints.at(2).position.x();
    scene_there = state_there = false;
    sent = bus.now();
    things->publish(thing);
    people->publish(body);
  };
  ASSERT_TRUE(bus.run_until([&] { return things->readers() > 0 && people->readers() > 0; },
                            std::chrono::seconds(20)))
      << spark.said();
  int n = 0;
  ASSERT_TRUE(bus.run_until(
      [&, next = bus.now()]() mutable {  // until both topics are connected
        if (bus.now() >= next) observe(n++), next = bus.now() + kEvery;
        return !scenes.milliseconds.empty() && !states.milliseconds.empty();
      },
      std::chrono::seconds(10)))
      << spark.said();
  scenes.milliseconds.clear();
  states.milliseconds.clear();
  for (int i = 0; i < runs; ++i) {
    observe(n++);
    const TimePoint next = bus.now() + kEvery;
    bus.run_until([&] { return bus.now() >= next; }, kEvery);
    bus.run_until([&] { return scene_there && state_there; }, std::chrono::seconds(1));
  }
  ASSERT_GE(scenes.milliseconds.size(), static_cast<std::size_t>(runs) * 9 / 10);
  ASSERT_GE(states.milliseconds.size(), static_cast<std::size_t>(runs) * 9 / 10);
  scenes.print("Scene");
  states.print("HumanState");
  EXPECT_LT(scenes.share(0.5), 50) << "not at the period of the scene";
  EXPECT_LT(states.share(0.5), 50);
}

}  // namespace
}  // namespace handsel::spark_latency_test
