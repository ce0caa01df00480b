// SPDX-License-Identifier: Apache-2.0
// Paths of a platform past two people in a furnished room, planned with the path planner's shipped
// settings, against OMPL's BiTRRT on the same problems; then one person steps into the path during
// the base motion. One process, alternating; thread time. Usage:
// bench_navigation [rooms]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "common/config/located.hpp"
#include "common/config/resources.hpp"
#include "common/cost/cost_settings.hpp"
#include "common/model/platform.hpp"
#include "components/path_planner/load.hpp"
#include "components/path_planner/solver.hpp"
#include "tests/support/processes/thread_times.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::path_planner {
namespace {

using test::seconds;
using test::Times;

constexpr unsigned kSeed = 31;
constexpr double kTimeLimit = 5;              // max time of a request [s]
constexpr std::uint64_t kLiveBudget = 10000;  // max checks of a replanning request, as shipped

struct Room {
  Scene scene;
  HumanState people;
  PathRequest request;
};

/// Returns a room of 6 m by 4 m with two pieces of furniture and two people between the platform
/// and its goal; they talk to each other in every second room.
Room random_room(std::mt19937_64& random, const RobotModel& robot, int number) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  Room room;
  room.scene.robot_known = true;
  room.scene.robot_position = robot.rest_configuration();
  room.scene.boxes = {
      {"table", make_pose({between(1.5, 3.5), between(1.2, 2.0), 0.36}), {1.2, 0.7, 0.72}, true},
      {"sideboard",
       make_pose({between(1.5, 3.5), between(-2.0, -1.2), 0.45}),
       {0.9, 0.4, 0.9},
       true}};
  const Vector3 first(between(1.3, 2.7), between(-0.9, 0.9), 0),
      second(between(1.3, 2.7), between(-0.9, 0.9), 0);
  const Vector3 line = second - first;
  const double talk = std::atan2(line.y(), line.x());
  for (const bool is_first : {true, false}) {
    Person person;
    person.id = is_first ? "anna" : "ben";
    const double yaw = number % 2 == 0 ? talk + (is_first ? 0 : M_PI) : between(-M_PI, M_PI);
    person.joints = standing_body(is_first ? first : second, yaw, between(1.6, 1.85));
    room.people.people.push_back(person);
  }
  Vector q = robot.rest_configuration();
  q.tail<3>() = Vector3(0, between(-0.5, 0.5), between(-M_PI, M_PI));
  room.scene.robot_position = q;
  room.request.id = {1, static_cast<std::uint64_t>(number) + 1};
  room.request.group = kPlatformGroup;
  room.request.start = q;
  room.request.goals = {Vector3(4, between(-0.5, 0.5), between(-M_PI, M_PI))};
  room.request.time_limit = kTimeLimit;
  room.request.seed = static_cast<std::uint64_t>(number) + 1;
  return room;
}

/// Lets the first person step into the middle of a path of which a fifth of the first edge has been
/// driven; the request continues along it.
void step_into(const std::vector<Vector>& path, const RobotModel& robot, Room& room) {
  const std::size_t edge = path.size() / 2;
  const Vector middle = 0.5 * (path[edge - 1] + path[edge]);
  room.people.people[0].joints = standing_body({middle.x(), middle.y(), 0}, 0, 1.75);
  room.request.running = path;
  const Vector now = path[0] + 0.2 * (path[1] - path[0]);
  room.request.start = with_platform_at(robot, room.request.start, now.head<3>());
}

int run(int rooms) {
  const auto description = robot_description("jido_mobile");
  const auto robot = std::make_shared<const RobotModel>(RobotModel::load(description));
  const auto file = settings::read_path_planner_settings(resource("config/path_planner.txtpb"));
  const auto objects = [](const std::string&) -> const ObjectModel* { return nullptr; };
  Solver solver(robot, mobile_of(*robot, description), objects,
                load_cost_settings(resource("config")), solver_settings(file));
  std::mt19937_64 random(kSeed);
  Times ours, peer, live;
  int outcomes[5] = {};
  double cost[2] = {}, length[2] = {};
  int solved[2] = {};
  for (int i = 0; i < rooms; ++i) {
    Room room = random_room(random, *robot, i);
    const auto scene = std::make_shared<Scene>(room.scene);
    if (const std::string why = solver.complete(room.request, scene->T_world_base); !why.empty()) {
      std::printf("%s\n", why.c_str());
      return 1;
    }
    bool both = true;
    Result results[2];
    for (const bool stock : {false, true}) {
      PlanningTask task = solver.make_task(room.request, scene);
      task.people = std::make_shared<HumanState>(room.people);
      task.problem.budget = static_cast<std::uint64_t>(kTimeLimit / file.check_time);
      task.problem.stock = stock;
      if (stock) task.problem.planner = PlannerKind::bitrrt;
      const double took = seconds([&] { solver.solve(task, {}); });
      both = both && task.result.solved;
      solved[stock] += task.result.solved;
      results[stock] = task.result;
      (stock ? peer : ours).add(took);
    }
    if (results[0].solved) {
      step_into(results[0].path, *robot, room);
      PlanningTask task = solver.make_task(room.request, scene);
      task.people = std::make_shared<HumanState>(room.people);
      task.problem.budget = kLiveBudget;
      live.add(seconds([&] { solver.solve(task, {}); }));
      ++outcomes[static_cast<int>(task.outcome)];
    }
    for (int k = 0; k < 2 && both; ++k) {
      cost[k] += results[k].cost;
      length[k] += results[k].length;
    }
  }
  std::printf("%d rooms\n", rooms);
  ours.print("path planner");
  peer.print("OMPL's BiTRRT");
  std::printf("ratio of the medians %.2f\n", ours.at(0.5) / peer.at(0.5));
  std::printf("solved %d and %d; of what both solved: cost %.2f and %.2f, length %.1f and %.1f\n",
              solved[0], solved[1], cost[0], cost[1], length[0], length[1]);
  live.print("a person in the path");
  for (int k = 0; k < 5; ++k)
    std::printf("%s %d%s", name(static_cast<ReplanOutcome>(k)), outcomes[k], k < 4 ? ", " : "\n");
  return 0;
}

}  // namespace
}  // namespace handsel::path_planner

int main(int argc, char** argv) {
  return handsel::path_planner::run(argc > 1 ? std::atoi(argv[1]) : 50);
}
