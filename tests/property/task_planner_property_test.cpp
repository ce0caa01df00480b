// SPDX-License-Identifier: Apache-2.0
// Random worlds: a plan reaches its goal, has the min cost of all sequences of actions, and a
// supervised task ends after any event. HANDSEL_RUNS worlds of each kind.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <queue>
#include <random>
#include <sstream>

#include "tests/support/task_rig.hpp"

namespace handsel::supervisor::task_planner_property_test {
namespace {

int runs(int usual) {
  const char* text = std::getenv("HANDSEL_RUNS");
  return text != nullptr ? std::atoi(text) : usual;
}

const Domain& shipped() {
  static const Domain domain = load_domain(resource("config/tasks.txtpb"));
  return domain;
}

int between(std::mt19937& random, int low, int high) {
  return std::uniform_int_distribution(low, high)(random);
}

const std::map<std::string, int> kPlaces{
    {"stool", 1}, {"tray", 2}, {"shelf", 9}, {"table", 9}};  // capacity, see the sizes below

TaskWorld random_world(std::mt19937& random, int most_objects) {
  TaskWorld world;
  world.surfaces = {{"table", {0.7, 0.7, 0.7}}};
  if (between(random, 0, 2) != 0) world.surfaces["shelf"] = {0.7, 0.7, 0.7};
  if (between(random, 0, 1) != 0) world.surfaces["stool"] = {0.2, 0.2, 0.5};
  if (between(random, 0, 1) != 0) world.surfaces["tray"] = {0.2, 0.4, 0.5};
  const int n = between(random, 1, most_objects);
  for (int i = 0; i < n; ++i) {
    const std::string object = "thing" + std::to_string(i);
    world.on[object] =
        world.surfaces.contains("shelf") && between(random, 0, 3) == 0 ? "shelf" : "table";
    world.distance[object] = between(random, 0, 9) == 0 ? 1.5 : 0.3 + 0.05 * between(random, 0, 10);
  }
  if (between(random, 0, 3) == 0) {
    world.on.erase("thing0");
    world.held_by["thing0"] = kRobotName;
  }
  world.people = {{"anna", between(random, 0, 1) != 0}, {"bert", between(random, 0, 1) != 0}};
  return world;
}

struct Wanted {
  TaskKind kind;
  std::string object, human, surface;
  bool reached(const TaskWorld& world) const {
    if (kind == TaskKind::give)
      return world.held_by.contains(object) && world.held_by.at(object) == human;
    if (kind == TaskKind::place) return world.on.contains(object) && world.on.at(object) == surface;
    return world.in_hand().empty() && clear(world);
  }
  bool clear(const TaskWorld& world) const {
    return std::none_of(world.on.begin(), world.on.end(),
                        [&](const auto& entry) { return entry.second == surface; });
  }
  TaskGoal goal() const {
    TaskGoal out;
    out.id = 1;
    out.kind = kind;
    out.object = object;
    out.human = human;
    out.surface = surface;
    return out;
  }
};

Wanted random_goal(std::mt19937& random, const TaskWorld& world) {
  const auto objects = world.objects();
  auto object = objects.begin();
  std::advance(object, between(random, 0, static_cast<int>(objects.size()) - 1));
  auto surface = world.surfaces.begin();
  std::advance(surface, between(random, 0, static_cast<int>(world.surfaces.size()) - 1));
  switch (between(random, 0, 2)) {
    case 0:
      return {TaskKind::give, *object, "anna", ""};
    case 1:
      return {TaskKind::place, *object, "", surface->first};
    default:
      return {TaskKind::clear, "", "", "table"};
  }
}

/// Returns the min cost of all sequences of actions that reach the goal, by Dijkstra's search over
/// the places of all objects; negative: none.
double least_cost(const TaskWorld& start, const Wanted& wanted) {
  using Where = std::map<std::string, std::string>;  // "@robot", "@anna" or a surface
  Where from;
  for (const auto& [object, surface] : start.on) from[object] = surface;
  for (const auto& [object, who] : start.held_by) from[object] = "@" + who;
  std::map<Where, double> best{{from, 0}};
  using Entry = std::pair<double, Where>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  open.push({0, from});
  while (!open.empty()) {
    const auto [cost, here] = open.top();
    open.pop();
    if (cost > best[here]) continue;
    TaskWorld now;
    std::map<std::string, int> many;
    std::string hand;
    for (const auto& [object, where] : here) {
      if (where == "@robot") hand = object;
      if (where[0] == '@')
        now.held_by[object] = where.substr(1);
      else
        now.on[object] = where, ++many[where];
    }
    if (wanted.reached(now)) return cost;
    const auto go = [&, c = cost](const std::string& object, const std::string& where,
                                  double more) {
      Where next = here;
      next[object] = where;
      const auto [at, fresh] = best.try_emplace(next, c + more);
      if (!fresh && at->second <= c + more) return;
      at->second = c + more;
      open.push({c + more, next});
    };
    if (hand.empty()) {
      for (const auto& [object, where] : here)
        if (where[0] != '@' && start.away(object) < 1)
          go(object, "@robot", 8 + 2 * start.away(object));
      continue;
    }
    for (const auto& [surface, size] : start.surfaces)
      if (many[surface] < kPlaces.at(surface)) go(hand, surface, 6);
    for (const auto& [person, attentive] : start.people) go(hand, "@" + person, 6);
  }
  return -1;
}

TEST(TaskPlans, reach_their_goal_at_the_least_cost) {
  int solved = 0, unsolved = 0;
  for (int seed = 1; seed <= runs(300); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(static_cast<unsigned>(seed));
    const TaskWorld start = random_world(random, 4);
    const Wanted wanted = random_goal(random, start);
    const World world = make_world(start.facts(), start.scene(), {});
    const TaskQuery query = query_for(wanted.goal(), shipped(), world, start.scene());
    ASSERT_EQ(query.reason, "");
    const Plan plan = make_plan(shipped(), world, query.task, query.args, {}, {100000, 24});
    const bool whole = plan.found && left_out(plan).empty();
    // The domain does not hand objects to people to free the hand; the exhaustive search would, so
    // it runs without people.
    TaskWorld alone = start;
    if (wanted.kind != TaskKind::give) alone.people.clear();
    if (wanted.kind == TaskKind::give) alone.people.erase("bert");
    const double min_cost = least_cost(alone, wanted);
    if (wanted.kind == TaskKind::give && start.in_hand() == "thing0" && wanted.object != "thing0")
      continue;  // as above, for anna
    ASSERT_EQ(whole, min_cost >= 0) << plan.reason << left_out(plan);
    whole ? ++solved : ++unsolved;
    if (!whole) {
      EXPECT_FALSE((plan.reason + left_out(plan)).empty());
      continue;
    }
    EXPECT_TRUE(plan.proven);
    double cost = plan.cost;
    TaskWorld then = start;
    for (const auto& action : plan.actions) {
      ASSERT_TRUE(then.perform(action.kind, action.object, action.human, action.surface))
          << action.text();
      if (action.kind == ActionKind::go_to) cost -= 3;
    }
    EXPECT_TRUE(wanted.reached(then));
    EXPECT_NEAR(cost, min_cost, 1e-9);
  }
  EXPECT_GT(solved, runs(300) / 2);
  EXPECT_GT(unsolved, runs(300) / 30);
}

TEST(TaskPlans, supervised_end_whatever_happens) {
  int succeeded = 0, failed = 0;
  for (int seed = 1; seed <= runs(150); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(static_cast<unsigned>(seed));
    TaskRig rig;
    rig.world = random_world(random, 6);
    const Wanted wanted = random_goal(random, rig.world);
    rig.action_time = 0.4;
    const Failure kFailures[] = {{},
                                 {},
                                 {},
                                 {},
                                 {"the hand closed on nothing", ActionFailure::nothing_grasped},
                                 {"the path planner does not answer", ActionFailure::no_answer},
                                 {"no path is left"},
                                 {"anna did not take it", ActionFailure::not_taken}};
    rig.fails = [&](const ActionGoal&) { return kFailures[between(random, 0, 7)]; };
    rig.run(2.5);
    rig.supervisor.on(wanted.goal(), rig.now);
    bool over = false;
    for (int i = 0; i < 400 && !over; ++i) {
      rig.run(0.3);
      over = !rig.statuses.empty() && TaskRig::is_end(rig.last().state);
      if (over) break;
      const int event = between(random, 0, 19);
      const auto objects = rig.world.objects();
      auto object = objects.begin();
      std::advance(object, between(random, 0, static_cast<int>(objects.size()) - 1));
      if (event == 0 && rig.world.on.contains(*object)) {
        rig.world.on.erase(*object);
        rig.world.held_by[*object] = "bert";
      } else if (event == 1 && rig.world.held_by.contains(*object) &&
                 rig.world.held_by[*object] != kRobotName && *object != wanted.object) {
        rig.world.held_by.erase(*object);
        rig.world.on[*object] = "table";
      } else if (event == 2) {
        rig.action = {};  // the planner restarts
      }
      ASSERT_LE(rig.last().tree.size(), 128u);
      ASSERT_LE(rig.last().plan.size(), 64u);
      ASSERT_LE(rig.last().step, rig.last().plan.size());
    }
    ASSERT_TRUE(over) << rig.last().phase << " " << rig.last().reason;
    if (rig.last().state == TaskState::succeeded) {
      ++succeeded;
      const bool gone = !wanted.object.empty() && rig.world.held_by.contains(wanted.object);
      EXPECT_TRUE(wanted.reached(rig.world) || gone ||
                  (wanted.kind == TaskKind::clear && wanted.clear(rig.world)))
          << rig.last().reason;
    } else {
      ++failed;
      EXPECT_FALSE(rig.last().reason.empty());
      EXPECT_LE(rig.last().reason.size(), 256u);
    }
  }
  EXPECT_GT(succeeded, runs(150) / 5);
  EXPECT_GT(failed, 0);
}

TEST(TaskDomains, a_broken_one_is_refused_or_works) {
  std::ifstream in(resource("config/tasks.txtpb"));
  std::ostringstream whole;
  whole << in.rdbuf();
  const std::string text = whole.str();
  int refused = 0, loaded = 0;
  for (int seed = 1; seed <= runs(400); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(static_cast<unsigned>(seed));
    std::string bad = text;
    for (int k = between(random, 1, 2); k > 0; --k) {
      const auto at =
          static_cast<std::size_t>(between(random, 0, static_cast<int>(bad.size()) - 40));
      const auto from =
          static_cast<std::size_t>(between(random, 0, static_cast<int>(bad.size()) - 40));
      const auto n = static_cast<std::size_t>(between(random, 1, 8));
      switch (between(random, 0, 2)) {
        case 0:
          bad.erase(at, n);
          break;
        case 1:
          bad.insert(at, text.substr(from, n));
          break;
        default:
          bad.replace(at, n, text.substr(from, n));
      }
    }
    try {
      const Domain domain = parse_domain(bad, "bad.txtpb");
      ++loaded;
      TaskWorld world = random_world(random, 3);
      const World start = make_world(world.facts(), world.scene(), {});
      for (const char* task : {"clear", "give", "place"}) {
        const int index = domain.task(task);
        if (index < 0 || domain.tasks[static_cast<std::size_t>(index)].types.size() != 2) continue;
        const Plan plan =
            make_plan(domain, start, index,
                      {task == std::string("clear") ? "table" : "thing0", "-"}, {}, {2000, 24});
        EXPECT_TRUE(plan.found || !plan.reason.empty());
      }
    } catch (const ConfigError& e) {
      ++refused;
      EXPECT_TRUE(std::string(e.what()).starts_with("bad.txtpb:")) << e.what();
    }
  }
  EXPECT_GT(refused, runs(400) / 4);
  EXPECT_GT(loaded, runs(400) / 20);
}

}  // namespace
}  // namespace handsel::supervisor::task_planner_property_test
