// SPDX-License-Identifier: Apache-2.0
// Time of one step of the attentional system in which every behaviour is active: the shipped
// settings, two people near, an arm in motion. Usage: bench_attention [rounds]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "common/bus/node_context.hpp"
#include "common/model/human/human_body.hpp"
#include "components/attention/settings.hpp"

namespace handsel::attention {
namespace {

using Clock = std::chrono::steady_clock;

int run(int rounds) {
  const NodeContext context = load_context("jido");
  AttentionSettings settings = load_settings(context.settings / "attention.txtpb");
  for (BehaviourSettings& b : settings.behaviours) {
    b.clock.rule = ClockLaw::fixed;
    b.clock.period = b.clock.p_max = b.clock.p_min = 1e-3;
  }
  const Body body(*context.robot, Vector3(0, 0, 0.1));
  HumanState people;
  for (const double y : {-0.3, 0.4}) {
    Person person;
    person.id = y < 0 ? "anna" : "ben";
    person.joints = standing_body(Vector3(0.9, y, 0), M_PI, 1.75);
    people.people.push_back(person);
  }
  Facts facts;
  Scene scene;
  SceneObject& mug = scene.objects.emplace_back();
  mug.id = "mug";
  mug.T_world_object = make_pose(Vector3(0.7, 0, 0.8));
  scene.boxes.push_back({"table", make_pose(Vector3(0.8, 0, 0.36)), Vector3(0.8, 0.8, 0.72), true});
  ActionStatus action;
  action.kind = ActionKind::place;
  action.state = ActionState::running;
  action.object = "mug";
  action.holding = true;
  ActiveTrajectory active;
  active.position = context.robot->rest_configuration();
  active.velocity = active.acceleration = Vector::Zero(active.position.size());
  active.trajectory = 1;
  const Group& arm = context.robot->require_group("arm");
  for (const int axis : arm.axes) {
    active.axes.push_back(static_cast<std::uint32_t>(axis));
    AxisTrajectory leg;
    leg.start = {active.position[axis], 0.1, 0.0};
    leg.segments = {{2.0, 0.0}};
    active.rest.axes.push_back(leg);
  }
  TrajectoryForecast forecast;
  forecast.trajectory = 1;
  forecast.clearance = 0.3;
  const World world{&people, &facts, &action, &active, &forecast, &scene};
  Attention attention(settings, body);
  std::vector<double> times;
  double sum = 0;
  for (int k = 0; k < rounds; ++k) {
    const Clock::time_point begin = Clock::now();
    attention.step(world, TimePoint(from_seconds(0.01 * k)));
    sum += attention.advice().speed_factor;
    times.push_back(1e6 * std::chrono::duration<double>(Clock::now() - begin).count());
  }
  std::sort(times.begin(), times.end());
  const AttentionState state = attention.state();
  for (const BehaviourState& b : state.behaviours)
    if (b.activations < static_cast<std::uint64_t>(rounds))
      return std::fprintf(stderr, "%s did not look each time\n", b.name.c_str()), 1;
  const auto at = [&](double fraction) {
    return times[static_cast<std::size_t>(fraction * static_cast<double>(times.size() - 1))];
  };
  std::printf("%s\n", nlohmann::json{{"name", "attention/step"},
                                     {"behaviours", state.behaviours.size()},
                                     {"least_us", times.front()},
                                     {"median_us", at(0.5)},
                                     {"p99_us", at(0.99)},
                                     {"aim_us", 50},
                                     {"mean_factor", sum / rounds}}
                          .dump()
                          .c_str());
  return 0;
}

}  // namespace
}  // namespace handsel::attention

int main(int argc, char** argv) {
  return handsel::attention::run(argc > 1 ? std::atoi(argv[1]) : 20000);
}
