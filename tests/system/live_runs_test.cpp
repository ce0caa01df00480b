// SPDX-License-Identifier: Apache-2.0
// Online replanning in lock-step: the arm moves when a person walks up and reaches into its path.
// The whole system, checked on the simulator's ground truth by an independent exact collision
// check. HANDSEL_RUNS: number of runs (seeds 1 ...), HANDSEL_FIRST: the first seed,
// HANDSEL_LIVE_PERIOD: another live_period (0: without replanning; its expectations then fail).
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include <nlohmann/json.hpp>

#include "common/config/resources.hpp"
#include "common/messages/robot.hpp"
#include "common/trajectory/path/broken_line.hpp"
#include "components/path_planner/live_path.hpp"
#include "components/path_planner/search/random.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::live_runs_test {
namespace {

using Json = nlohmann::json;
using path_planner::Random;

// Min distance to the robot at which the person stops [m].
constexpr double kMinApproach = 0.12;
constexpr double kLimit = 45;  // max duration of a run [s]

/// A person who walks up, reaches out once, withdraws and leaves; waits where the robot is too
/// near.
class Visitor {
 public:
  /// `p_path`: point on the path of the robot's hand near which the person reaches [m].
  Visitor(Random& random, const Vector3& p_path)
      : from_(random.between(2.4, 3.2), random.between(-0.3, 1.2), 0),
        to_(random.between(1.1, 1.4), random.between(0.0, 0.6), 0),
        target_(p_path + 0.1 * Vector3(random.normal(), random.normal(), random.normal())),
        pace_(random.between(0.7, 1.2)),
        hand_speed_(random.between(0.5, 1.0)),
        waits_(random.between(0.0, 0.4)),
        holds_(random.between(1.0, 2.5)) {}

  /// Advances by dt [s] unless `too_near` refuses the new body.
  template <class TooNear>
  void step(double dt, TooNear&& too_near) {
    Visitor next = *this;
    next.advance(dt);
    if (too_near(next.body())) {
      if (phase_ != Phase::reaching) return;
      phase_ = Phase::holding;  // does not reach the target: withdraws after a while
      return;
    }
    *this = next;
  }
  std::vector<BodyJoint> body() const {
    const Vector3 walk = to_ - from_, feet = from_ + walked_ * walk;
    std::vector<BodyJoint> joints = standing_body(feet, std::atan2(-feet.y(), -feet.x()), 1.72);
    const auto at = [&](const char* name) -> Vector3& {
      return std::find_if(joints.begin(), joints.end(),
                          [&](const BodyJoint& j) { return j.name == name; })
          ->position;
    };
    const Vector3 shoulder = at("r_shoulder"), hanging = at("r_hand");
    const double upper = (at("r_elbow") - shoulder).norm(),
                 fore = (at("r_hand") - at("r_elbow")).norm();
    Vector3 target = target_ - shoulder;
    target *= std::min(1.0, 0.97 * (upper + fore) / target.norm());
    const Vector3 hand = hanging + reached_ * (shoulder + target - hanging),
                  along = hand - shoulder;
    const double d = std::clamp(along.norm(), 0.05, 0.999 * (upper + fore)),
                 a = (upper * upper - fore * fore + d * d) / (2 * d);
    Vector3 down = Vector3(0, 0, -1) + along * along.z() / along.squaredNorm();
    if (down.norm() < 1e-3) down = along.unitOrthogonal();
    const Vector3 elbow = shoulder + along.normalized() * a +
                          down.normalized() * std::sqrt(std::max(0.0, upper * upper - a * a));
    const double palm = (at("r_hand") - at("r_wrist")).norm();
    at("r_elbow") = elbow;
    at("r_hand") = hand;
    at("r_wrist") = hand + (elbow - hand).normalized() * palm;
    return joints;
  }

 private:
  enum class Phase { waiting, walking, reaching, holding, drawing_back, leaving, gone };
  void advance(double dt) {
    since_ += dt;
    const auto enter = [this](Phase phase) {
      phase_ = phase;
      since_ = 0;
    };
    const double length = (to_ - from_).norm(), reach = 0.7;
    switch (phase_) {
      case Phase::waiting:
        if (since_ > waits_) enter(Phase::walking);
        break;
      case Phase::walking:
        walked_ = std::min(1.0, walked_ + dt * pace_ / length);
        if (walked_ == 1.0) enter(Phase::reaching);
        break;
      case Phase::reaching:
        reached_ = std::min(1.0, reached_ + dt * hand_speed_ / reach);
        if (reached_ == 1.0) enter(Phase::holding);
        break;
      case Phase::holding:
        if (since_ > holds_) enter(Phase::drawing_back);
        break;
      case Phase::drawing_back:
        reached_ = std::max(0.0, reached_ - dt * hand_speed_ / reach);
        if (reached_ == 0.0) enter(Phase::leaving);
        break;
      case Phase::leaving:
        walked_ = std::max(0.0, walked_ - dt * pace_ / length);
        if (walked_ == 0.0) enter(Phase::gone);
        break;
      case Phase::gone:
        break;
    }
  }

  Vector3 from_, to_, target_;
  double pace_, hand_speed_, waits_, holds_;
  double walked_{0}, reached_{0}, since_{0};
  Phase phase_{Phase::waiting};
};

/// Exact check on ground truth: people and configuration of the simulator.
class Oracle {
 public:
  explicit Oracle(const NodeContext& context)
      : robot_(*context.robot), world_(robot_, context.objects) {
    Scene scene;
    scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
    world_.set_scene(scene);
  }
  CollisionVerdict touches(const std::vector<BodyJoint>& body, const RobotState& robot) {
    place(body, robot);
    return world_.check(robot.position);
  }
  double distance(const std::vector<BodyJoint>& body, const RobotState& robot) {
    place(body, robot);
    return world_.distance_to_people(robot.position);
  }

 private:
  void place(const std::vector<BodyJoint>& body, const RobotState& robot) {
    HumanState people;
    people.people.push_back({.id = "visitor", .joints = body});
    world_.set_base(robot.T_world_base);
    world_.set_people(people);
  }
  const RobotModel& robot_;
  CollisionWorld world_;
};

/// Compares the remaining old path with its replacement, for people and scene of that time, with
/// independent checks.
class Judge {
 public:
  explicit Judge(const NodeContext& context)
      : robot_(*context.robot),
        arm_(robot_.require_group("arm")),
        world_(robot_, context.objects),
        cost_(robot_, {}) {}

  /// Returns the integral cost of the remaining path for the present people [rad].
  double remaining(const PathRequest& request, const std::vector<Vector>& path,
                   const HumanState& people) {
    cost_.set_people(people);
    return integral(request.start, remainder(path, RobotModel::part(request.start, arm_), 0.5));
  }
  struct Change {
    bool was_blocked{}, rejoins{};
    double before{}, after{};  // integral cost of the path [rad]
  };
  Change compare(const PathRequest& request, const std::vector<Vector>& old,
                 const std::vector<Vector>& taken, const Scene& scene, const HumanState& people) {
    world_.set_scene(scene);
    world_.set_people(people);
    world_.set_attachment(request.attachment, request.allowed_contacts);
    cost_.set_people(people);
    cost_.set_base(scene.T_world_base);
    const std::vector<Vector> rest = remainder(old, RobotModel::part(request.start, arm_), 0.5);
    Change change;
    change.before = integral(request.start, rest);
    change.after = integral(request.start, taken);
    int samples = 0, near = 0;
    for (std::size_t i = 1; i < rest.size(); ++i) {
      change.was_blocked =
          change.was_blocked ||
          !world_.check_motion(all(request.start, rest[i - 1]), all(request.start, rest[i])).free;
      for (int k = 1; k <= 10; ++k, ++samples)
        near += distance(taken, rest[i - 1] + 0.1 * k * (rest[i] - rest[i - 1])) < 0.1;
    }
    change.rejoins = near * 4 > samples;
    return change;
  }

 private:
  Vector all(const Vector& start, const Vector& q) const {
    return RobotModel::with(start, arm_, q);
  }
  double integral(const Vector& start, const std::vector<Vector>& path) const {
    double sum = 0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Vector step = path[i] - path[i - 1];
      const int pieces = std::max(1, static_cast<int>(std::ceil(step.norm() / 0.02)));
      for (int k = 0; k < pieces; ++k)
        sum += cost_(all(start, path[i - 1] + step * ((k + 0.5) / pieces))) * step.norm() / pieces;
    }
    return sum;
  }
  static double distance(const std::vector<Vector>& path, const Vector& q) {
    double least = 1e9;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Vector edge = path[i] - path[i - 1];
      const double share =
          std::clamp((q - path[i - 1]).dot(edge) / std::max(1e-12, edge.squaredNorm()), 0.0, 1.0);
      least = std::min(least, (path[i - 1] + share * edge - q).norm());
    }
    return least;
  }
  const RobotModel& robot_;
  const Group& arm_;
  CollisionWorld world_;
  HumanCost cost_;
};

/// Returns a scenario: an empty room with a table, the arm at `start`, an external person.
std::string scenario_text(const RobotModel& robot, const Vector& start) {
  std::string text = R"(name: "live_run" robot: "jido"
boxes { id: "table" pose { xyz { x: 0.85 y: -0.62 z: 0.36 } } size { x: 0.7 y: 0.7 z: 0.72 }
    supports: true }
people { id: "visitor" x: 3.0 y: 0.4 yaw: 3.1416 stature: 1.72 behaviour: EXTERNAL
    external: "body_tracker" }
)";
  for (int axis : robot.require_group("arm").axes)
    text += "start { key: \"" + robot.axes()[axis].name +
            "\" value: " + std::to_string(start[axis]) + " }\n";
  return text + "timeout: 60\n";
}

Vector random_start(const NodeContext& context, Random& random) {
  const RobotModel& robot = *context.robot;
  const Group& arm = robot.require_group("arm");
  CollisionWorld world(robot, context.objects);
  Scene scene;
  scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.76}, true});
  world.set_scene(scene);
  while (true) {
    Vector q = robot.rest_configuration();
    for (int axis : arm.axes) {
      const double margin = 0.1;
      q[axis] =
          random.between(robot.axes()[axis].lower + margin, robot.axes()[axis].upper - margin);
    }
    const Vector3 tool = robot.link_pose(q, robot.tool_link()).translation();
    const bool far =
        (RobotModel::part(q, arm) - RobotModel::part(robot.rest_configuration(), arm)).norm() > 1.8;
    if (far && tool.x() > 0.2 && tool.z() > 0.8 && tool.z() < 1.6 && world.check(q).free) return q;
  }
}

/// The settings as shipped; HANDSEL_LIVE_PERIOD instead of their live_period.
std::filesystem::path settings(const std::string& folder) {
  const char* period = std::getenv("HANDSEL_LIVE_PERIOD");
  if (period == nullptr) return {};
  const std::filesystem::path copy =
      std::filesystem::path(folder) / ("config" + std::to_string(getpid()));
  if (std::filesystem::exists(copy)) return copy;
  std::filesystem::copy(resource("config"), copy, std::filesystem::copy_options::recursive);
  std::ofstream out(copy / "manipulation_planner.txtpb");
  std::ifstream in(resource("config/manipulation_planner.txtpb"));
  for (std::string line; std::getline(in, line);)
    if (line.rfind("live_period", 0) != 0) out << line << "\n";
  out << "live_period: " << period << "\n";
  return copy;
}

Json run(std::uint64_t seed, const std::string& folder) {
  Random random(seed);
  NodeContext context = system_context("give_mug", "", seed);
  const std::string file = folder + "/live_" + std::to_string(seed) + ".txtpb";
  const Vector start = random_start(context, random),
               rest_configuration = context.robot->rest_configuration();
  std::ofstream(file) << scenario_text(*context.robot, start);
  LockstepSystem system(system_context(file, "", seed, settings(folder)));
  Visitor visitor(random,
                  context.robot
                      ->link_pose(start + random.between(0.4, 0.9) * (rest_configuration - start),
                                  context.robot->tool_link())
                      .translation());
  Oracle oracle(context);
  Judge judge(context);

  Bus& seat = system.bus();
  const auto noise = [&random] {
    return Vector3(0.003 * Vector3(random.normal(), random.normal(), random.normal()));
  };
  auto goals = seat.advertise<TaskGoal>();
  auto body_out = seat.advertise<HumanObservation>();
  RobotState robot;
  Scene scene;
  HumanState people;
  std::optional<PathRequest> request;
  std::vector<double> remaining;  // cost of the remaining path, at each sample
  std::vector<Vector> path, offered;
  int looks = 0, taken = 0, cheaper = 0, repaired = 0, replanned = 0, stops = 0, touching = 0;
  double fell = 0, least_distance = 1e9, standing = 0, blocked_told = 0;
  std::string first_touch;
  HumanState people_then;
  bool first_command = true, live = false;
  seat.subscribe<RobotState>([&](const RobotState& s, const Receipt&) { robot = s; });
  seat.subscribe<Scene>([&](const Scene& s, const Receipt&) { scene = s; });
  seat.subscribe<HumanState>([&](const HumanState& s, const Receipt&) { people = s; });
  seat.subscribe<PathRequest>([&](const PathRequest& r, const Receipt&) {
    if (r.cancel) return;
    request = r;
    live = !r.running.empty();
    people_then = people;
    looks += live;
    if (live && !path.empty() && people.people.size() == 1)
      remaining.push_back(judge.remaining(r, path, people));
  });
  seat.subscribe<PathReply>([&](const PathReply& r, const Receipt&) {
    if (!request || !(r.id == request->id) || !r.solved) return;
    offered = r.path;
  });
  seat.subscribe<TrajectoryCommand>([&](const TrajectoryCommand& c, const Receipt&) {
    if (c.axes.empty() || offered.empty() || offered == path) return;
    if (!first_command && live) {
      const Judge::Change change = judge.compare(*request, path, offered, scene, people_then);
      ++taken;
      if (change.was_blocked) {
        ++(change.rejoins ? repaired : replanned);
      } else if (change.after < change.before) {
        ++cheaper;
        fell += 1 - change.after / change.before;
      }
    }
    first_command = false;
    path = offered;
  });
  seat.every(from_seconds(1.0 / 30), [&](TimePoint) {
    if (robot.position.size() > 0)
      visitor.step(1.0 / 30, [&](const std::vector<BodyJoint>& body) {
        const double d = oracle.distance(body, robot);
        return d < kMinApproach && d < oracle.distance(visitor.body(), robot);
      });
    HumanObservation seen;
    seen.source = "body_tracker";
    seen.coverage = {{-2, -3, 0}, {4, 3, 2.5}};
    ObservedPerson person;
    person.body = "visitor";
    for (const BodyJoint& joint : visitor.body())
      person.joints.push_back({joint.name, joint.position + noise(), 1.0});
    person.has_gaze = true;
    person.gaze_origin = person.joints.front().position;
    person.gaze_direction = Vector3(-1, 0, -0.2).normalized();
    seen.people.push_back(person);
    body_out->publish(seen);
  });
  seat.after(from_seconds(1.0),
             [&](TimePoint) { goals->publish({.id = 1, .kind = TaskKind::go_to}); });
  TimePoint judged{};
  system.observer().on_sample([&](const Snapshot& s, TimePoint now) {
    if (!s.ground_truth.ever || s.ground_truth.arrival == judged || robot.position.size() == 0 ||
        s.ground_truth.sample.person.empty())
      return;
    judged = s.ground_truth.arrival;
    const CollisionVerdict verdict = oracle.touches(s.ground_truth.sample.person, robot);
    least_distance = std::min(least_distance, oracle.distance(s.ground_truth.sample.person, robot));
    if (!verdict.free && touching++ == 0) first_touch = verdict.first + " " + verdict.second;
    const bool held = s.active.ever && s.active.sample.trajectory != 0 &&
                      std::abs(s.active.sample.speed_factor) < 1e-3 &&
                      to_seconds(now.time_since_epoch()) > 1.5;
    if (held && (standing += 0.02) > 0.1 && standing - 0.02 <= 0.1) ++stops;
    if (!held) standing = 0;
    if (s.forecast.ever && s.forecast.sample.collides) blocked_told += 0.02;
  });
  const auto ended = [&] {
    const auto& tasks = system.snapshot().tasks;
    const auto task = tasks.find(1);
    return task != tasks.end() &&
           (task->second.state == TaskState::succeeded || task->second.state == TaskState::failed ||
            task->second.state == TaskState::cancelled);
  };
  system.network().run_until(ended, TimePoint(from_seconds(kLimit)));
  const auto& tasks = system.snapshot().tasks;
  const bool reached = tasks.count(1) != 0 && tasks.at(1).state == TaskState::succeeded;
  const GroundTruth& ground_truth = system.snapshot().ground_truth.sample;
  return {{"seed", seed},
          {"reached", reached},
          {"time", to_seconds(system.now().time_since_epoch())},
          {"reason", tasks.count(1) != 0 ? tasks.at(1).reason : "no task"},
          {"touching", touching},
          {"touched", first_touch},
          {"contact_force", ground_truth.contact_force},
          {"scene_collisions", ground_truth.self_or_scene_collisions},
          {"ssm_violations", ground_truth.ssm_violations},
          {"limit_violations", ground_truth.limit_violations},
          {"distance", least_distance},
          {"looks", looks},
          {"taken", taken},
          {"cheaper", cheaper},
          {"fell", fell},
          {"falls", remaining.size() > 1 && remaining.back() < remaining.front()},
          {"repaired", repaired},
          {"replanned", replanned},
          {"stops", stops},
          {"foreseen", blocked_told}};
}

/// In two processes, every other seed each.
std::vector<Json> run_all(int first, int count) {
  const test::TemporaryFolder folder;
  constexpr int kProcesses = 2;
  std::vector<pid_t> children;
  for (int k = 0; k < kProcesses; ++k) {
    const pid_t child = fork();
    if (child == 0) {
      try {
        std::ofstream out(folder.path() / ("lines" + std::to_string(k)));
        for (int i = k; i < count; i += kProcesses)
          out << run(static_cast<std::uint64_t>(first + i), folder.path().string()).dump()
              << std::endl;
      } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        _exit(1);
      }
      _exit(0);
    }
    children.push_back(child);
  }
  std::vector<Json> lines;
  for (int k = 0; k < kProcesses; ++k) {
    int status = 0;
    waitpid(children[static_cast<std::size_t>(k)], &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "a run crashed";
    std::ifstream in(folder.path() / ("lines" + std::to_string(k)));
    for (std::string line; std::getline(in, line);) lines.push_back(Json::parse(line));
  }
  return lines;
}

TEST(LiveRuns, nothing_is_touched_goals_are_reached_and_paths_get_cheaper) {
  const auto number = [](const char* name, int otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::atoi(text);
  };
  const int count = number("HANDSEL_RUNS", 4), first = number("HANDSEL_FIRST", 1);
  const std::vector<Json> lines = run_all(first, count);
  ASSERT_EQ(static_cast<int>(lines.size()), count);
  int reached = 0, cheaper = 0, falls = 0, repaired = 0, replanned = 0, stopped = 0, looked = 0,
      too_fast = 0;
  double fell = 0;
  for (const Json& line : lines) {
    std::printf("%s\n", line.dump().c_str());
    EXPECT_EQ(line["touching"], 0) << line.dump();
    EXPECT_EQ(line["contact_force"], 0.0) << line.dump();
    EXPECT_EQ(line["scene_collisions"], 0) << line.dump();
    EXPECT_EQ(line["limit_violations"], 0) << line.dump();
    reached += line["reached"].get<bool>();
    looked += line["looks"].get<int>() > 0;
    falls += line["falls"].get<bool>();
    cheaper += line["cheaper"].get<int>() > 0;
    repaired += line["repaired"].get<int>() > 0;
    replanned += line["replanned"].get<int>() > 0;
    stopped += line["stops"].get<int>() > 0;
    too_fast += line["ssm_violations"].get<int>() > 0;
    fell += line["fell"].get<double>();
  }
  std::printf(
      "%d runs, seeds %d ... %d: reached %d, cost of the rest falls %d, made cheaper %d, repaired "
      "%d, replanned %d, stopped %d\n",
      count, first, first + count - 1, reached, falls, cheaper, repaired, replanned, stopped);
  std::printf("steps above the speed and separation rule in %d runs\n", too_fast);
  std::printf("where it is made cheaper, the changes take %.0f %% off the rest on average\n",
              100 * fell / std::max(1, cheaper));
  EXPECT_GE(reached, count * 8 / 10);
  EXPECT_GE(falls, count * 9 / 10);
  EXPECT_GE(cheaper, count >= 20 ? count * 9 / 10 : 1);
  EXPECT_EQ(looked, count);
}

}  // namespace
}  // namespace handsel::live_runs_test
