// SPDX-License-Identifier: Apache-2.0
// A second writer on each topic with a pinned writer, in a running system over DDS, at rest and in
// motion: no axis moves because of that writer, the writer is named within a second, and no limit
// is exceeded. HANDSEL_RUNS: runs of each topic and kind (default: a selection, once).
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include <dds/dds.h>

#include "common/bus/dds/qos.hpp"
#include "common/config/resources.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_model.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/status.hpp"
#include "deploy/handsel/system/system.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel::second_writer_test {
namespace {

constexpr int kDomain = 206;
constexpr double kPlace = 0.01;           // max displacement of an axis at rest [rad]
constexpr double kNamed = 1.0;            // max time until the writer is named [s]
constexpr std::ptrdiff_t kFollowed = 50;  // the robot follows one of so many set-points
const Duration kTimeout = std::chrono::seconds(30);

std::uint64_t runs() {
  const char* value = std::getenv("HANDSEL_RUNS");
  return value == nullptr ? 0 : std::strtoull(value, nullptr, 10);
}

enum class Kind : std::uint8_t { same_qos, stronger, stranger };
const char* name(Kind kind) {
  return kind == Kind::same_qos   ? "of the same name and QoS"
         : kind == Kind::stronger ? "exclusive and stronger"
                                  : "of another name";
}

/// Last samples of the pinned writers, for second writers that imitate them.
struct Known {
  std::mutex mutex;
  JointCommand set_point;
  RobotState state;
  Go go;
  Scene scene;
  HumanState people;
  ActionStatus action;
};

template <class M>
M forged(Known& known, std::uint64_t count);

/// Each axis 1 rad away, numbered as if it continued.
template <>
JointCommand forged(Known& known, std::uint64_t count) {
  JointCommand m = known.set_point;
  m.sequence += count;
  for (Eigen::Index i = 0; i < m.position.size(); ++i) m.position[i] += 1.0;
  return m;
}
/// Returns full speed, regardless of the override.
template <>
Go forged(Known& known, std::uint64_t count) {
  Go m = known.go;
  m.epoch += 1 + count / 100;
  m.allowed = m.acknowledge = true;
  m.override_factor = 1.0;
  return m;
}
template <>
SafetyState forged(Known&, std::uint64_t count) {
  return {.revision = 1'000'000 + count};
}
/// The first arm axis by 1 rad.
template <>
TrajectoryCommand forged(Known& known, std::uint64_t count) {
  TrajectoryCommand m;
  m.id = 1'000'000'000'000 + count;
  m.epoch = known.go.epoch;
  m.robot = known.state.robot;
  m.axes = {0};
  AxisTrajectory axis;
  axis.start.position = known.state.position.size() > 0 ? known.state.position[0] : 0.0;
  for (const double jerk : {1.0, -1.0, -1.0, 1.0}) axis.segments.push_back({0.8, jerk});
  m.trajectory.axes = {axis};
  return m;
}
/// Opens the hand.
template <>
HandCommand forged(Known& known, std::uint64_t count) {
  HandCommand m;
  m.id = 1'000'000'000'000 + count;
  m.epoch = known.go.epoch;
  m.robot = known.state.robot;
  m.action = HandAction::release;
  return m;
}
/// Nobody is there.
template <>
HumanState forged(Known& known, std::uint64_t) {
  HumanState m = known.people;
  m.people.clear();
  m.covered = true;
  return m;
}
/// The robot is elsewhere.
template <>
RobotState forged(Known& known, std::uint64_t count) {
  RobotState m = known.state;
  m.sequence += count;
  for (Eigen::Index i = 0; i < m.position.size(); ++i) m.position[i] += 0.5;
  return m;
}
template <>
Scene forged(Known& known, std::uint64_t) {
  Scene m = known.scene;
  m.objects.clear();
  return m;
}
template <>
ActionStatus forged(Known& known, std::uint64_t) {
  ActionStatus m = known.action;
  m.state = ActionState::idle;
  return m;
}

/// A participant with a writer of its own that publishes from a thread until it is destroyed.
class SecondWriter {
 public:
  template <class M>
  static std::unique_ptr<SecondWriter> of(Known& known, Kind kind) {
    const MessageType& type = message_type<M>();
    auto make = [&known, &type](std::uint64_t count, void* wire) {
      M message;
      {
        const std::lock_guard lock(known.mutex);
        message = forged<M>(known, count);
      }
      message.stamp = 0;
      std::string why;
      timespec t{};
      clock_gettime(CLOCK_REALTIME, &t);
      return type.to_wire(&message, t.tv_sec * 1'000'000'000LL + t.tv_nsec, wire, why);
    };
    return std::unique_ptr<SecondWriter>(new SecondWriter(type, kind, make));
  }
  ~SecondWriter() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    ended_.notify_all();
    thread_.join();
    dds_delete(participant_);
  }
  SecondWriter(const SecondWriter&) = delete;
  SecondWriter& operator=(const SecondWriter&) = delete;
  std::uint64_t sent() const { return sent_; }

 private:
  SecondWriter(const MessageType& type, Kind kind, std::function<bool(std::uint64_t, void*)> make) {
    const TopicRow& row = type.row();
    const std::string_view writers = row.writers;
    const std::string component =
        kind == Kind::stranger ? "stranger" : std::string(writers.substr(0, writers.find(' ')));
    const Qos named(dds_create_qos(), &dds_delete_qos), of_topic = topic_qos(row),
                                                        offered = writer_qos(row);
    dds_qset_entity_name(named.get(), component.c_str());
    participant_ = dds_create_participant(kDomain, named.get(), nullptr);
    const dds_entity_t topic = dds_create_topic(
        participant_, static_cast<const dds_topic_descriptor_t*>(type.descriptor()), row.topic,
        of_topic.get(), nullptr);
    if (kind == Kind::stronger) {
      dds_qset_ownership(offered.get(), DDS_OWNERSHIP_EXCLUSIVE);
      dds_qset_ownership_strength(offered.get(), 1'000'000);
    }
    const dds_entity_t writer = dds_create_writer(participant_, topic, offered.get(), nullptr);
    EXPECT_GT(writer, 0) << dds_strretcode(-writer);
    const Duration period = from_seconds(row.rate > 0 ? std::max(0.001, 0.2 / row.rate) : 0.02);
    thread_ = std::thread([this, writer, period, make = std::move(make), sample = type.new_wire()] {
      std::unique_lock lock(mutex_);
      for (std::uint64_t count = 1; !ends_; ++count) {
        if (make(count, sample.get()) && dds_write(writer, sample.get()) == DDS_RETCODE_OK) ++sent_;
        ended_.wait_for(lock, period, [this] { return ends_; });
      }
    });
  }

  dds_entity_t participant_{};
  std::mutex mutex_;
  std::condition_variable ended_;
  bool ends_{false};
  std::atomic<std::uint64_t> sent_{0};
  std::thread thread_;
};

using MakeWriter = std::function<std::unique_ptr<SecondWriter>(Known&, Kind)>;
struct Topic {
  const TopicRow* row;
  MakeWriter make;
};
template <class M>
Topic topic() {
  return {&TopicOf<M>::row,
          [](Known& known, Kind kind) { return SecondWriter::of<M>(known, kind); }};
}
std::vector<Topic> all_topics() {
  return {topic<JointCommand>(),      topic<Go>(),          topic<SafetyState>(),
          topic<TrajectoryCommand>(), topic<HandCommand>(), topic<HumanState>(),
          topic<RobotState>(),        topic<Scene>(),       topic<ActionStatus>()};
}

/// Effects of a second writer.
struct Effect {
  double off{};          ///< largest distance of an arm axis from the place it should have [rad]
  double named_after{};  ///< [s]; negative: never
  double cleared_after{};
  std::uint64_t violations{}, commanders{};
  std::string reason;
};

class SecondWriterTest : public testing::Test {
 protected:
  SecondWriterTest()
      : system_({.domain = kDomain, .scenario = "give_mug", .seed = 3, .web_port = 0}),
        session_(system_.session()) {
    const RobotModel robot = RobotModel::load(robot_description(robot_of(system_.options())));
    arm_ = robot.require_group("arm").axes;
    DdsBus& bus = session_.bus();
    bus.subscribe<JointCommand>([this](const JointCommand& m, const Receipt&) {
      keep(known_.set_point, m);
      if (watching_) set_points_.push_back({m.stamp, m.position});
    });
    bus.subscribe<Go>([this](const Go& m, const Receipt&) { keep(known_.go, m); });
    bus.subscribe<Scene>([this](const Scene& m, const Receipt&) { keep(known_.scene, m); });
    bus.subscribe<HumanState>(
        [this](const HumanState& m, const Receipt&) { keep(known_.people, m); });
    bus.subscribe<ActionStatus>(
        [this](const ActionStatus& m, const Receipt&) { keep(known_.action, m); });
    bus.subscribe<RobotState>([this](const RobotState& m, const Receipt&) {
      keep(known_.state, m);
      if (watching_) states_.push_back({m.stamp, m.position});
    });
  }
  void SetUp() override {
    ASSERT_TRUE(system_.wait_ready(kReadyTimeout).has_value());
    ASSERT_TRUE(session_.wait(kTimeout, [&] {
      return known_.set_point.position.size() > 0 && known_.go.allowed && at_rest();
    }));
  }
  template <class M>
  void keep(M& kept, const M& now) {
    const std::lock_guard lock(known_.mutex);
    kept = now;
  }
  double distance(const Vector& a, const Vector& b) const {
    double off = 0;
    for (const int axis : arm_) off = std::max(off, std::abs(a[axis] - b[axis]));
    return off;
  }
  /// Returns the largest distance of an arm axis from the place it should have [rad]: `place`, or
  /// without one the nearest of the last 50 set-points that were sent before the state.
  double largest_distance(const Vector* place) const {
    double largest = 0.0;
    for (const Sent& state : states_) {
      if (place != nullptr) {
        largest = std::max(largest, distance(state.position, *place));
        continue;
      }
      const auto later = [](Stamp stamp, const Sent& set_point) { return stamp < set_point.stamp; };
      const auto end = std::upper_bound(set_points_.begin(), set_points_.end(), state.stamp, later);
      if (end - set_points_.begin() < kFollowed) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (auto set_point = end - kFollowed; set_point != end; ++set_point)
        nearest = std::min(nearest, distance(state.position, set_point->position));
      largest = std::max(largest, nearest);
    }
    return largest;
  }
  bool at_rest() const {
    return session_.snapshot().ground_truth.ever &&
           !session_.snapshot().ground_truth.sample.robot_moving &&
           session_.snapshot().action.sample.state != ActionState::running;
  }
  /// First arm motion of a task: the mug is taken, or put back.
  void begin_motion() {
    TaskGoal goal;
    goal.id = session_.new_task_id();
    goal.kind = picks_ ? TaskKind::pick : TaskKind::place;
    goal.object = "mug";
    if (goal.kind == TaskKind::place) goal.surface = "table";
    picks_ = !picks_;
    ASSERT_TRUE(session_.send(goal));
    ASSERT_TRUE(session_.wait(kTimeout, [&] {
      const GroundTruth& ground_truth = session_.snapshot().ground_truth.sample;
      return ground_truth.robot_moving &&
             session_.snapshot().execution.sample.motion == MotionState::running;
    })) << session_.snapshot().task.sample.reason;
  }
  void end_motion() {
    EXPECT_TRUE(session_.wait(std::chrono::seconds(60), [&] {
      const TaskStatus& task = session_.snapshot().task.sample;
      return at_rest() && (task.state == TaskState::succeeded || task.state == TaskState::failed ||
                           task.state == TaskState::refused);
    })) << "the task does not end";
  }
  /// Name of the reader whose health names a second writer of the topic, or empty.
  std::string named_by(const TopicRow& row) const {
    for (const auto& [component, health] : session_.snapshot().health) {
      if (health.sample.reason.find("second_writer") == std::string::npos) continue;
      for (const TopicHealth& topic : health.sample.topics)
        if (topic.topic == row.topic && !topic.second_writer.empty()) return component;
    }
    return {};
  }
  bool has_reader(const TopicRow& row) const {
    for (const auto& [component, health] : session_.snapshot().health)
      for (const TopicHealth& topic : health.sample.topics)
        if (topic.topic == row.topic) return true;
    return false;
  }

  Effect disturb(const Topic& topic, Kind kind, bool in_motion) {
    if (in_motion) begin_motion();
    Effect effect;
    const std::uint64_t before = session_.snapshot().ground_truth.sample.limit_violations;
    const Vector place = known_.state.position;
    states_.clear();
    set_points_.clear();
    watching_ = true;
    const TimePoint begin = session_.bus().now();
    auto writer = topic.make(known_, kind);
    const bool named =
        session_.wait(from_seconds(3), [&] { return !named_by(*topic.row).empty(); });
    effect.named_after = named ? to_seconds(session_.bus().now() - begin) : -1;
    if (named) effect.reason = session_.snapshot().health.at(named_by(*topic.row)).sample.reason;
    session_.wait(from_seconds(0.7), [] { return false; });
    const SystemStatus status = make_status(session_.snapshot(), session_.bus().now());
    EXPECT_TRUE(std::any_of(status.troubles.begin(), status.troubles.end(),
                            [](const std::string& trouble) {
                              return trouble.find("second_writer") != std::string::npos;
                            }))
        << "handsel status does not show it";
    EXPECT_GT(writer->sent(), 0u);
    watching_ = false;
    writer.reset();
    const TimePoint gone = session_.bus().now();
    const bool cleared =
        session_.wait(from_seconds(3), [&] { return named_by(*topic.row).empty(); });
    effect.cleared_after = cleared ? to_seconds(session_.bus().now() - gone) : -1;
    if (in_motion) end_motion();
    EXPECT_GT(states_.size(), 20u);
    EXPECT_GT(set_points_.size(), 100u);
    effect.off = largest_distance(in_motion ? nullptr : &place);
    effect.violations = session_.snapshot().ground_truth.sample.limit_violations - before;
    effect.commanders = session_.snapshot().ground_truth.sample.commanders;
    return effect;
  }
  void expect_harmless(const Topic& topic, Kind kind, bool in_motion) {
    if (!has_reader(*topic.row)) {
      std::printf("%-24s has no reader in this system\n", topic.row->topic);
      return;
    }
    const Effect effect = disturb(topic, kind, in_motion);
    const std::string what = std::string(topic.row->topic) + ", a second writer " + name(kind) +
                             (in_motion ? ", in motion" : ", at rest");
    std::printf("%-75s off %.4f rad, named after %.2f s, cleared after %.2f s, %llu violations\n",
                what.c_str(), effect.off, effect.named_after, effect.cleared_after,
                static_cast<unsigned long long>(effect.violations));
    std::fflush(stdout);
    EXPECT_LE(effect.off, kPlace) << what;
    EXPECT_GE(effect.named_after, 0.0) << what << ": never named";
    EXPECT_LE(effect.named_after, kNamed) << what;
    EXPECT_NE(effect.reason.find("pid " + std::to_string(getpid())), std::string::npos)
        << what << ": " << effect.reason;
    EXPECT_NE(effect.reason.find(topic.row->topic), std::string::npos)
        << what << ": " << effect.reason;
    EXPECT_GE(effect.cleared_after, 0.0) << what << ": still named when gone";
    EXPECT_LE(effect.cleared_after, kNamed) << what;
    EXPECT_EQ(effect.violations, 0u) << what;
    EXPECT_EQ(effect.commanders, 1u) << what;
  }

  System system_;
  Session& session_;
  Known known_;
  std::vector<int> arm_;
  struct Sent {
    Stamp stamp;
    Vector position;
  };
  std::vector<Sent> states_, set_points_;  // accepted in the presence of a second writer
  bool watching_{false}, picks_{true};
};

TEST_F(SecondWriterTest, moves_nothing_and_is_named) {
  for (std::uint64_t run = 0; run < runs(); ++run) {
    for (const Topic& topic : all_topics()) {
      for (const Kind kind : {Kind::same_qos, Kind::stronger, Kind::stranger})
        expect_harmless(topic, kind, false);
      expect_harmless(topic, run % 2 == 0 ? Kind::same_qos : Kind::stronger, true);
    }
  }
  if (runs() > 0) return;
  expect_harmless(topic<JointCommand>(), Kind::same_qos, false);
  expect_harmless(topic<JointCommand>(), Kind::stronger, false);
  expect_harmless(topic<Go>(), Kind::same_qos, false);
  expect_harmless(topic<TrajectoryCommand>(), Kind::same_qos, false);
  expect_harmless(topic<TrajectoryCommand>(), Kind::stranger, false);
  expect_harmless(topic<JointCommand>(), Kind::same_qos, true);
  expect_harmless(topic<Go>(), Kind::stronger, true);
}

/// A controller that dies is replaced while its old writer is still in the transport's books, and
/// the new one is accepted.
TEST_F(SecondWriterTest, is_not_what_a_restarted_controller_is_taken_for) {
  const std::uint64_t before = session_.snapshot().ground_truth.sample.set_points;
  const std::uint64_t incarnation =
      session_.snapshot().health.at("trajectory_controller").sample.incarnation;
  ASSERT_GT(system_.launcher().pid("trajectory_controller"), 0);
  const TimePoint killed = session_.bus().now();
  ::kill(system_.launcher().pid("trajectory_controller"), SIGKILL);
  ASSERT_TRUE(session_.wait(kTimeout, [&] {
    const auto& health = session_.snapshot().health.at("trajectory_controller").sample;
    return health.incarnation != incarnation && health.state == HealthState::ok;
  }));
  const double ready = to_seconds(session_.bus().now() - killed);
  ASSERT_TRUE(session_.wait(kTimeout, [&] {
    const GroundTruth& ground_truth = session_.snapshot().ground_truth.sample;
    return ground_truth.commanders == 2 && ground_truth.set_points > before + 200 &&
           session_.snapshot().execution.sample.mode == Mode::normal;
  }));
  const double again = to_seconds(session_.bus().now() - killed);
  std::printf("controller ready %.2f s after kill -9, in mode normal after %.2f s\n", ready, again);
  EXPECT_LT(again, 2.5);
  EXPECT_EQ(session_.snapshot().health.at("sim").sample.reason, "");
  EXPECT_EQ(session_.snapshot().ground_truth.sample.limit_violations, 0u);
}

}  // namespace
}  // namespace handsel::second_writer_test
