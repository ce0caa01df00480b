// SPDX-License-Identifier: Apache-2.0
// A flood of objects, people, goals and requests under ever-new names against SPARK, the supervisor
// and two planners in one process: the nearest are kept, the rest is counted, memory is constant,
// and a person's goal is still carried out.
#include <gtest/gtest.h>
#include <malloc.h>

#include <fstream>
#include <map>

#include "common/bus/local_bus.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"
#include "common/model/human/human_body.hpp"
#include "components/path_planner/node.hpp"
#include "components/spark/node.hpp"
#include "components/supervisor/node.hpp"
#include "components/trajectory_planner/node.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::flood_test {
namespace {

using std::chrono::milliseconds;

constexpr int kObjects = 1000, kPeople = 200, kBoxes = 300;
constexpr std::uint64_t kRequests = 10000;  // of each kind
constexpr double kFlood = 4;                // duration of the flood [s]

/// give_mug with many more boxes, farther away than the arm reaches.
std::filesystem::path crowded_place(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "crowded.txtpb";
  std::ofstream out(file);
  out << std::ifstream(std::filesystem::path(HANDSEL_SOURCE_DIR) / "sim/scenarios/give_mug.txtpb")
             .rdbuf();
  for (int i = 0; i < kBoxes; ++i)
    out << "boxes { id: \"shelf" << i << "\" pose { xyz { x: " << -4.0 - 0.5 * (i % 20)
        << " y: " << -4.0 + 0.5 * (i / 20) << " z: 0.5 } } size { x: 0.3 y: 0.3 z: 1 } }\n";
  return file;
}

double heap_in_use() { return static_cast<double>(mallinfo2().uordblks); }

/// Returns a configuration with the arm near its rest configuration.
Vector moved(const RobotModel& robot) {
  Vector out = RobotModel::part(robot.rest_configuration(), robot.require_group("arm"));
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] += out[i] > 0 ? -0.1 : 0.1;
  return out;
}

/// Everything that floods a system, from one stranger.
class Stranger {
 public:
  Stranger(Bus& bus, const RobotModel& robot) : bus_(bus), robot_(robot) {
    things_out_ = bus.advertise<ObjectObservation>();
    people_out_ = bus.advertise<HumanObservation>();
    goals_out_ = bus.advertise<TaskGoal>();
    paths_out_ = bus.advertise<PathRequest>();
    trajectories_out_ = bus.advertise<TrajectoryRequest>();
    bus.every(milliseconds(100), [this](TimePoint) { observe(); });
    bus.every(milliseconds(20), [this](TimePoint) { ask(); });
  }
  void stop_asking() { asks_ = false; }
  void keep_names() { new_names_ = false; }
  std::uint64_t requests() const { return number_; }
  std::uint64_t names() const { return generation_ * (kObjects + kPeople); }
  bool all_sent() const { return all_sent_; }

 private:
  void observe() {
    if (new_names_) ++generation_;
    const std::string generation = "_" + std::to_string(generation_);
    ObjectObservation things;
    things.source = "stranger";
    for (int i = 0; i < kObjects; ++i) {
      const Vector3 where(-5.0 - 0.2 * (i % 25), 4.0 + 0.2 * (i / 25), 0.8);
      things.objects.push_back({"thing" + std::to_string(i) + generation,
                                "",
                                make_pose(where),
                                0.9,
                                {},
                                {PrimitiveKind::box, {0.05, 0.05, 0.05}}});
    }
    HumanObservation people;
    people.source = "stranger";
    for (int i = 0; i < kPeople; ++i) {
      ObservedPerson person;
      person.body = "passer" + std::to_string(i) + generation;
      const Vector3 feet(-9.0 - 0.9 * (i % 14), -6 + 0.9 * (i / 14) + 1e-3 * (samples_ % 3), 0);
      for (const BodyJoint& joint : standing_body(feet, 0, 1.7))
        person.joints.push_back({joint.name, joint.position, 1});
      people.people.push_back(std::move(person));
    }
    ++samples_;
    all_sent_ = things_out_->publish(things) && people_out_->publish(people) && all_sent_;
  }
  void ask() {
    for (int i = 0; asks_ && i < 51 && number_ < kRequests; ++i) {
      ++number_;
      TaskGoal goal;
      goal.id = 1'000'000 + number_;
      goal.kind = TaskKind::give;
      goal.object = "thing" + std::to_string(number_);
      goal.human = "passer" + std::to_string(number_);
      goals_out_->publish(goal);
      PathRequest path;
      path.id = {500'000 + number_, 1};
      path.group = "arm";
      path.start = robot_.rest_configuration();
      path.goals = {moved(robot_)};
      path.time_limit = 1;
      paths_out_->publish(path);
      TrajectoryRequest trajectory;
      trajectory.id = path.id;
      trajectory.group = "arm";
      trajectory.start = path.start;
      trajectory.nodes = {RobotModel::part(path.start, robot_.require_group("arm")),
                          path.goals.front()};
      trajectories_out_->publish(trajectory);
    }
  }

  Bus& bus_;
  const RobotModel& robot_;
  std::unique_ptr<Publisher<ObjectObservation>> things_out_;
  std::unique_ptr<Publisher<HumanObservation>> people_out_;
  std::unique_ptr<Publisher<TaskGoal>> goals_out_;
  std::unique_ptr<Publisher<PathRequest>> paths_out_;
  std::unique_ptr<Publisher<TrajectoryRequest>> trajectories_out_;
  std::uint64_t number_{0}, generation_{0}, samples_{0};
  bool asks_{true}, new_names_{true}, all_sent_{true};
};

/// The robot at rest, a mug on the table and anna before it, as a simulator would publish them.
class Room {
 public:
  Room(Bus& bus, const NodeContext& context) : robot_(*context.robot) {
    double bottom = 0;
    for (const Vector3& v : context.objects("mug")->mesh.vertices) bottom = std::min(bottom, v.z());
    mug_ = make_pose({0.68, -0.42, 0.72 - bottom});
    state_out_ = bus.advertise<RobotState>();
    people_out_ = bus.advertise<HumanObservation>();
    things_out_ = bus.advertise<ObjectObservation>();
    bus.every(milliseconds(10), [this](TimePoint) { state(); });
    bus.every(milliseconds(33), [this](TimePoint) { observe(); });
  }

 private:
  void state() {
    RobotState state;
    state.robot = robot_.name();
    state.sequence = ++sequence_;
    state.position = robot_.rest_configuration();
    state.velocity = Vector::Zero(state.position.size());
    state.mode = DriveMode::enabled;
    state_out_->publish(state);
  }
  void observe() {
    HumanObservation people;
    people.source = "kinect";
    people.coverage = {{-3, -3, -0.5}, {3, 3, 2.5}};
    people.people.push_back({"anna", {}, false});
    for (const BodyJoint& joint :
         standing_body({1.4 + 1e-4 * (sequence_ % 3), -0.05, 0}, M_PI, 1.72))
      people.people[0].joints.push_back({joint.name, joint.position, 1});
    people_out_->publish(people);
    ObjectObservation things;
    things.source = "object_tracker";
    things.objects.push_back({"mug", "mug", mug_, 1, {}, {}});
    things_out_->publish(things);
  }

  const RobotModel& robot_;
  Pose mug_{Pose::Identity()};
  std::unique_ptr<Publisher<RobotState>> state_out_;
  std::unique_ptr<Publisher<HumanObservation>> people_out_;
  std::unique_ptr<Publisher<ObjectObservation>> things_out_;
  std::uint64_t sequence_{0};
};

class Flood : public ::testing::Test {
 protected:
  Flood() : network_(5) {
    setenv("HANDSEL_HOME", (std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy").c_str(), 1);
    context_ = load_context("jido", crowded_place(folder_.path()).string());
    spark_ = std::make_unique<spark::Node>(network_.add("spark"), context_);
    supervisor_ = std::make_unique<supervisor::Node>(network_.add("supervisor"), context_);
    path_planner_ = std::make_unique<path_planner::Node>(network_.add("path_planner"), context_);
    trajectory_planner_ =
        std::make_unique<trajectory_planner::Node>(network_.add("trajectory_planner"), context_);
    room_ = std::make_unique<Room>(network_.add("sim"), context_);
    Bus& seat = network_.add("handsel");
    goals_out_ = seat.advertise<TaskGoal>();
    paths_out_ = seat.advertise<PathRequest>();
    seat.subscribe<Scene>([this](const Scene& m, const Receipt&) { scene_ = m; });
    seat.subscribe<HumanState>([this](const HumanState& m, const Receipt&) { people_ = m; });
    seat.subscribe<Facts>([this](const Facts& m, const Receipt&) { facts_ = m; });
    seat.subscribe<Go>([this](const Go& m, const Receipt&) { go_ = m; });
    seat.subscribe<TaskStatus>([this](const TaskStatus& m, const Receipt&) {
      ++statuses_;
      if (m.id < 1'000'000) status_ = m;
    });
    seat.subscribe<PathReply>([this](const PathReply& m, const Receipt&) {
      if (m.id.client == kClient) reply_ = m;
    });
    seat.subscribe<ComponentHealth>([this](const ComponentHealth& m, const Receipt&) {
      health_[m.component] = m;
      if (m.reason.find("refused to send") != std::string::npos)
        refused_ = m.component + ": " + m.reason;
    });
    network_.run_for(milliseconds(500));
  }
  /// 0: not counted.
  std::uint64_t left_out(const std::string& component, const std::string& what) {
    for (const NamedCount& one : health_[component].left_out)
      if (one.name.starts_with(what)) return one.count;
    return 0;
  }
  template <class List>
  static bool has(const List& list, const std::string& id) {
    return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.id == id; });
  }
  void expect_the_nearest_and_the_counts();

  static constexpr std::uint64_t kClient = 7;
  test::TemporaryFolder folder_;
  LocalNetwork network_;
  NodeContext context_;
  std::unique_ptr<spark::Node> spark_;
  std::unique_ptr<supervisor::Node> supervisor_;
  std::unique_ptr<path_planner::Node> path_planner_;
  std::unique_ptr<trajectory_planner::Node> trajectory_planner_;
  std::unique_ptr<Room> room_;
  std::unique_ptr<Publisher<TaskGoal>> goals_out_;
  std::unique_ptr<Publisher<PathRequest>> paths_out_;
  Scene scene_;
  HumanState people_;
  Facts facts_;
  Go go_;
  TaskStatus status_;
  PathReply reply_;
  std::map<std::string, ComponentHealth> health_;
  std::string refused_;
  std::uint64_t statuses_{0};
};

void Flood::expect_the_nearest_and_the_counts() {
  EXPECT_EQ(scene_.objects.size(), 64u);
  EXPECT_TRUE(has(scene_.objects, "mug"));
  EXPECT_EQ(scene_.boxes.size(), 64u);
  EXPECT_TRUE(has(scene_.boxes, "table"));
  EXPECT_TRUE(has(scene_.boxes, "floor"));
  EXPECT_GE(scene_.left_out, kBoxes - 64u);
  EXPECT_EQ(people_.people.size(), 16u);
  EXPECT_TRUE(has(people_.people, "anna"));
  EXPECT_GE(people_.left_out, kPeople - 16u);
  EXPECT_EQ(facts_.facts.size(), 256u);
  EXPECT_GT(facts_.left_out, 0u);
  for (const auto& [component, what] :
       {std::pair{"spark", "people:"}, std::pair{"spark", "bodies of an observation:"},
        std::pair{"spark", "objects:"}, std::pair{"spark", "objects remembered:"},
        std::pair{"spark", "boxes:"}, std::pair{"spark", "facts:"},
        std::pair{"supervisor", "task goals:"}, std::pair{"path_planner", "path requests:"},
        std::pair{"trajectory_planner", "trajectory requests:"}})
    EXPECT_GT(left_out(component, what), 0u) << component << ", " << what;
  EXPECT_EQ(refused_, "");
  for (const auto& [component, health] : health_)
    for (const TopicHealth& topic : health.topics)
      EXPECT_EQ(topic.rejected, 0u) << component << ", " << topic.topic;
}

TEST_F(Flood, the_nearest_stay_the_rest_is_counted_and_memory_is_flat) {
  Stranger stranger(network_.add("stranger"), *context_.robot);
  network_.run_for(from_seconds(kFlood / 2));
  const double before = heap_in_use();
  const std::uint64_t names = stranger.names(), requests = stranger.requests();
  network_.run_for(from_seconds(kFlood / 2));
  const double growth = heap_in_use() - before;
  std::printf("%llu names and %llu requests of each kind more: the heap grew by %.0f kB\n",
              static_cast<unsigned long long>(stranger.names() - names),
              static_cast<unsigned long long>(stranger.requests() - requests), growth / 1e3);
  EXPECT_EQ(stranger.requests(), kRequests);
  EXPECT_GE(stranger.names() - names, 20000u);
  EXPECT_LT(growth, 0.5e6) << "about 20 bytes a name";
  EXPECT_TRUE(stranger.all_sent());
  expect_the_nearest_and_the_counts();
}

TEST_F(Flood, a_person_pauses_in_the_flood_and_asks_for_work_after_it) {
  Stranger stranger(network_.add("stranger"), *context_.robot);
  network_.run_for(from_seconds(1));
  TaskGoal pause;
  pause.id = 1;
  pause.kind = TaskKind::pause;
  goals_out_->publish(pause);
  network_.run_for(milliseconds(300));
  EXPECT_EQ(status_.id, 1u);
  EXPECT_EQ(status_.state, TaskState::succeeded);
  EXPECT_FALSE(go_.allowed);
  EXPECT_NE(go_.reason.find("paused"), std::string::npos) << go_.reason;

  stranger.stop_asking();
  stranger.keep_names();
  network_.run_for(from_seconds(6));  // completes the admitted requests
  PathRequest request;
  request.id = {kClient, 1};
  request.group = "arm";
  request.start = context_.robot->rest_configuration();
  request.goals = {moved(*context_.robot)};
  request.time_limit = 5;
  paths_out_->publish(request);
  EXPECT_TRUE(network_.run_until([&] { return reply_.id.client == kClient; },
                                 network_.now() + std::chrono::seconds(10)));
  EXPECT_TRUE(reply_.solved) << reply_.reason;

  TaskGoal give;
  give.id = 2;
  give.kind = TaskKind::give;
  give.object = "mug";
  give.human = "anna";
  goals_out_->publish(give);
  network_.run_until([&] { return status_.id == 2; }, network_.now() + std::chrono::seconds(5));
  EXPECT_EQ(status_.id, 2u);
  EXPECT_LT(status_.state, TaskState::succeeded) << name(status_.state) << ": " << status_.reason;
}

}  // namespace
}  // namespace handsel::flood_test
