// SPDX-License-Identifier: Apache-2.0
// The rules of every bus, tested on both implementations.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "common/bus/intake.hpp"
#include "common/bus/send_refusal.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/messages/world.hpp"
#include "tests/unit/bus/bus_stage.hpp"
#include "tests/unit/bus/voluntary_switches.hpp"

namespace handsel::bus_test {
namespace {

using test::DdsStage;
using test::LocalStage;
using test::Stage;

RobotState robot_state(std::uint64_t sequence) {
  RobotState state;
  state.robot = "jido";
  state.sequence = sequence;
  state.position = Vector::LinSpaced(22, -1, 1);
  state.velocity = Vector::Constant(22, 0.25);
  state.effort = Vector::Zero(22);
  return state;
}

JointCommand joint_command(std::uint64_t sequence) {
  JointCommand command;
  command.robot = "jido";
  command.sequence = sequence;
  command.position = command.velocity = command.acceleration = Vector::Zero(22);
  return command;
}

HandCommand hand_command(std::uint64_t id) {
  HandCommand command;
  command.robot = "jido";
  command.id = id;
  return command;
}

template <class StageType>
class BusRules : public testing::Test {
 protected:
  StageType stage;
  template <class M>
  bool matched(const std::unique_ptr<Publisher<M>>& publisher, const SubscriptionStatus& status,
               int writers = 1) {
    return stage.until([&] { return publisher->readers() >= 1 && status.writers == writers; });
  }
};
using Stages = testing::Types<LocalStage, DdsStage>;
TYPED_TEST_SUITE(BusRules, Stages);

TYPED_TEST(BusRules, carries_a_message_with_stamp_and_receipt) {
  Bus& a = this->stage.add("sim");
  Bus& b = this->stage.add("b");
  auto publisher = a.advertise<RobotState>();
  RobotState got;
  Receipt receipt;
  const auto& status =
      b.subscribe<RobotState>([&](const RobotState& m, const Receipt& r) { got = m, receipt = r; });
  EXPECT_EQ(b.lag<RobotState>(), Duration::max()) << "never seen counts as stale";
  ASSERT_TRUE(this->matched(publisher, status));
  ASSERT_TRUE(publisher->publish(robot_state(7)));
  ASSERT_TRUE(this->stage.until([&] { return status.received == 1; }));
  EXPECT_EQ(got.sequence, 7u);
  EXPECT_EQ(got.robot, "jido");
  EXPECT_EQ(got.position, robot_state(7).position);
  EXPECT_EQ(got.external_torque.size(), 0);
  EXPECT_GT(got.stamp, 0) << "a zero stamp is filled in";
  EXPECT_NE(receipt.writer, 0u);
  EXPECT_LE(receipt.arrival, b.now());
  EXPECT_LT(to_seconds(b.lag<RobotState>()), 5.0);
}

TYPED_TEST(BusRules, refuses_to_send_a_malformed_message_and_says_so_in_its_health) {
  Bus& a = this->stage.add("sim");
  Bus& b = this->stage.add("b");
  std::string reason;
  b.subscribe<ComponentHealth>([&](const ComponentHealth& m, const Receipt&) {
    if (m.component == "sim") reason = m.reason;
  });
  auto publisher = a.advertise<RobotState>();
  RobotState bad = robot_state(1);
  bad.velocity[3] = std::nan("");
  EXPECT_FALSE(publisher->publish(bad));
  EXPECT_TRUE(this->stage.until([&] {
    return reason.find("RobotState.velocity[3] is nan") != std::string::npos;
  })) << reason;
}

TEST(SendRefusal, is_shown_for_ten_seconds_and_logged_once) {
  SendRefusal refusal;
  const TimePoint begin{from_seconds(100.0)};
  EXPECT_EQ(refusal.text(begin), "");
  EXPECT_TRUE(refusal.note("it is nan", begin));
  EXPECT_FALSE(refusal.note("it is inf", begin + from_seconds(5.0)));
  EXPECT_EQ(refusal.text(begin + from_seconds(14.0)), "refused to send: it is inf");
  EXPECT_EQ(refusal.text(begin + from_seconds(16.0)), "")
      << "one bad message does not degrade a component for ever";
  EXPECT_TRUE(refusal.note("it is nan", begin + from_seconds(17.0)));
}

/// The health of a component in virtual time becomes ok again.
TEST(SendRefusal, leaves_the_health_of_its_component) {
  test::LocalStage stage;
  Bus &a = stage.add("sim"), &b = stage.add("b");
  HealthState health{};
  b.subscribe<ComponentHealth>([&](const ComponentHealth& m, const Receipt&) {
    if (m.component == "sim") health = m.state;
  });
  RobotState bad = robot_state(1);
  bad.velocity[3] = std::nan("");
  const auto publisher = a.advertise<RobotState>();
  EXPECT_FALSE(publisher->publish(bad));
  EXPECT_TRUE(stage.until([&] { return health == HealthState::degraded; }));
  EXPECT_TRUE(stage.until([&] { return health == HealthState::ok; }, 11.0));
}

TYPED_TEST(BusRules, state_keeps_the_last_sample_and_commands_the_last_eight) {
  Bus& a = this->stage.add("manipulation_planner");
  Bus& b = this->stage.add("b");
  auto facts = a.advertise<Facts>();
  auto hands = a.advertise<HandCommand>();
  std::vector<std::size_t> sizes;
  std::vector<std::uint64_t> ids;
  const auto& s1 =
      b.subscribe<Facts>([&](const Facts& m, const Receipt&) { sizes.push_back(m.facts.size()); });
  const auto& s2 =
      b.subscribe<HandCommand>([&](const HandCommand& m, const Receipt&) { ids.push_back(m.id); });
  ASSERT_TRUE(this->matched(facts, s1));
  ASSERT_TRUE(this->matched(hands, s2));
  this->stage.pause("b");
  for (std::uint64_t i = 1; i <= 12; ++i) {
    Facts message;
    Fact fact;
    fact.subject = "anna";
    message.facts.resize(i, fact);
    ASSERT_TRUE(facts->publish(message));
    ASSERT_TRUE(hands->publish(hand_command(i)));
  }
  this->stage.pass(0.1);
  this->stage.resume("b");
  ASSERT_TRUE(this->stage.until([&] { return !sizes.empty() && ids.size() >= 8; }));
  this->stage.pass(0.1);
  EXPECT_EQ(sizes, std::vector<std::size_t>{12});
  EXPECT_EQ(ids, (std::vector<std::uint64_t>{5, 6, 7, 8, 9, 10, 11, 12}));
}

TYPED_TEST(BusRules, what_does_not_wake_is_handed_over_before_the_next_callback) {
  Bus& a = this->stage.add("sim");
  Bus& b = this->stage.add("b");
  auto publisher = a.advertise<RobotState>();
  std::uint64_t sent = 0, received = 0;
  const auto& status = b.subscribe<RobotState>(
      [&](const RobotState& m, const Receipt&) { received = m.sequence; }, {.wakes = false});
  ASSERT_TRUE(this->matched(publisher, status));
  a.every(std::chrono::milliseconds(5),
          [&](TimePoint) { sent += publisher->publish(robot_state(sent + 1)); });
  std::vector<std::uint64_t> at_tick;
  b.every(std::chrono::milliseconds(20), [&](TimePoint) { at_tick.push_back(received); });
  ASSERT_TRUE(this->stage.until([&] { return at_tick.size() >= 10; }));
  EXPECT_GE(status.received, 20u);
  for (std::size_t i = 2; i < at_tick.size(); ++i) EXPECT_GT(at_tick[i], at_tick[i - 1]) << i;
}

TEST(DdsBus, sleeps_through_samples_that_do_not_wake) {
  const auto switches = [](bool wakes) {
    DdsStage stage;
    Bus& a = stage.add("sim");
    auto publisher = a.advertise<RobotState>();
    DdsBus b({.component = "b", .domain = 100 + static_cast<std::uint32_t>(getpid()) % 100});
    const auto& status =
        b.subscribe<RobotState>([](const RobotState&, const Receipt&) {}, {.wakes = wakes});
    std::atomic<bool> ended{false};
    a.every(std::chrono::milliseconds(2), [&](TimePoint) { publisher->publish(robot_state(1)); });
    std::thread writer([&] { stage.until([&] { return ended.load(); }, 20); });
    b.run_until([&] { return status.received > 3; }, std::chrono::seconds(5));
    const std::uint64_t received = status.received;
    const long before = test::voluntary_switches();
    b.run_until([] { return false; }, std::chrono::milliseconds(500));
    const long after = test::voluntary_switches();
    ended = true;
    writer.join();
    EXPECT_GT(status.received, received);
    return after - before;
  };
  const long slept = switches(false), woken = switches(true);
  EXPECT_LT(3 * slept, woken) << slept << " against " << woken << " in half a second";
}

TYPED_TEST(BusRules, late_joiner_gets_state_but_no_old_command) {
  Bus& a = this->stage.add("supervisor manipulation_planner");
  auto go = a.advertise<Go>();
  auto hands = a.advertise<HandCommand>();
  Go permission;
  permission.epoch = 3;
  ASSERT_TRUE(go->publish(permission));
  ASSERT_TRUE(hands->publish(hand_command(1)));
  this->stage.pass(0.05);
  Bus& b = this->stage.add("b");
  std::uint64_t epoch = 0;
  std::vector<std::uint64_t> ids;
  b.subscribe<Go>([&](const Go& m, const Receipt&) { epoch = m.epoch; });
  const auto& status =
      b.subscribe<HandCommand>([&](const HandCommand& m, const Receipt&) { ids.push_back(m.id); });
  EXPECT_TRUE(this->stage.until([&] { return epoch == 3; }));
  ASSERT_TRUE(this->matched(hands, status));
  ASSERT_TRUE(hands->publish(hand_command(2)));
  ASSERT_TRUE(this->stage.until([&] { return !ids.empty(); }));
  EXPECT_EQ(ids, std::vector<std::uint64_t>{2});
}

TYPED_TEST(BusRules, death_of_a_writer_is_seen_as_lost_writer_and_missed_deadline) {
  this->stage.add("a");
  Bus& b = this->stage.add("b");
  Bus& c = this->stage.add("sim");
  auto publisher = c.advertise<RobotState>();
  const auto& status = b.subscribe<RobotState>([](const RobotState&, const Receipt&) {});
  c.every(std::chrono::milliseconds(5), [&](TimePoint) { publisher->publish(robot_state(1)); });
  ASSERT_TRUE(this->stage.until([&] { return status.received > 20; }));
  const std::uint64_t misses = status.deadline_misses;
  this->stage.kill("sim");
  EXPECT_TRUE(this->stage.until([&] { return status.writers == 0 && status.writers_lost == 1; }));
  EXPECT_TRUE(this->stage.until([&] { return status.deadline_misses == misses + 1; }));
  EXPECT_GT(b.lag<RobotState>(), std::chrono::milliseconds(20));
}

TYPED_TEST(BusRules,
           the_first_writer_of_a_topic_stays_the_only_one_and_another_follows_when_it_is_gone) {
  Bus& b = this->stage.add("b");
  Bus& first = this->stage.add("trajectory_controller");
  auto one = first.advertise<JointCommand>();
  std::uint64_t from_first = 0, from_spare = 0;
  const auto& status = b.subscribe<JointCommand>([&](const JointCommand& m, const Receipt&) {
    ++(m.sequence == 1 ? from_first : from_spare);
  });
  ASSERT_TRUE(this->matched(one, status));
  Bus& spare = this->stage.add("trajectory_controller spare");
  auto two = spare.advertise<JointCommand>(10);
  ASSERT_TRUE(this->stage.until([&] { return status.writers == 2; }));
  spare.every(std::chrono::milliseconds(1), [&](TimePoint) { two->publish(joint_command(2)); });
  ASSERT_TRUE(this->stage.until([&] { return status.refused > 30; }));
  EXPECT_EQ(from_spare, 0u) << "the first one lives, also while it is silent";
  first.every(std::chrono::milliseconds(4), [&](TimePoint) { one->publish(joint_command(1)); });
  EXPECT_TRUE(this->stage.until([&] { return from_first > 30; }));
  EXPECT_EQ(from_spare, 0u);
  EXPECT_TRUE(this->stage.until([&] {
    return status.second_writer.rfind("trajectory_controller spare", 0) == 0;
  })) << status.second_writer;
  this->stage.kill("trajectory_controller");
  EXPECT_TRUE(this->stage.until([&] { return from_spare > 10; }));
  EXPECT_TRUE(this->stage.until([&] { return status.second_writer.empty(); }))
      << status.second_writer;
}

TYPED_TEST(BusRules, a_component_that_the_table_does_not_name_as_a_writer_is_refused_and_named) {
  Bus& b = this->stage.add("b");
  Bus& stranger = this->stage.add("stranger");
  auto theirs = stranger.advertise<JointCommand>();
  std::uint64_t accepted = 0;
  const auto& status = b.subscribe<JointCommand>([&](const JointCommand& m, const Receipt&) {
    EXPECT_EQ(m.sequence, 1u);
    ++accepted;
  });
  ComponentHealth health;
  Bus& observer = this->stage.add("observer");
  observer.subscribe<ComponentHealth>([&](const ComponentHealth& m, const Receipt&) {
    if (m.component == "b") health = m;
  });
  stranger.every(std::chrono::milliseconds(1),
                 [&](TimePoint) { theirs->publish(joint_command(9)); });
  ASSERT_TRUE(this->stage.until([&] { return status.refused > 20; }));
  EXPECT_EQ(accepted, 0u);
  EXPECT_TRUE(this->stage.until(
      [&] { return health.reason.rfind("second_writer: stranger", 0) == 0; }, 1.0))
      << health.reason;
  EXPECT_NE(health.reason.find("writes handsel/joint_command too"), std::string::npos)
      << health.reason;
  EXPECT_EQ(health.state, HealthState::degraded);
  ASSERT_EQ(health.topics.size(), 1u);
  EXPECT_GT(health.topics[0].refused, 0u);
  EXPECT_EQ(health.topics[0].second_writer.rfind("stranger", 0), 0u);
  Bus& rightful = this->stage.add("trajectory_controller");
  auto ours = rightful.advertise<JointCommand>();
  rightful.every(std::chrono::milliseconds(4), [&](TimePoint) { ours->publish(joint_command(1)); });
  EXPECT_TRUE(this->stage.until([&] { return accepted > 20; }))
      << "the stranger does not hide the rightful writer";
  this->stage.kill("stranger");
  EXPECT_TRUE(this->stage.until([&] { return health.reason.empty(); }, 1.0)) << health.reason;
  EXPECT_EQ(health.state, HealthState::ok);
}

TYPED_TEST(BusRules,
           a_second_writer_does_not_push_samples_of_the_first_out_of_a_waiting_readers_queue) {
  Bus& b = this->stage.add("b");
  Bus& first = this->stage.add("supervisor");
  auto ours = first.advertise<Go>();
  std::vector<std::uint64_t> epochs;
  const auto& status =
      b.subscribe<Go>([&](const Go& m, const Receipt&) { epochs.push_back(m.epoch); });
  ASSERT_TRUE(this->matched(ours, status));
  Bus& other = this->stage.add("supervisor twin");
  auto theirs = other.advertise<Go>();
  ASSERT_TRUE(
      this->stage.until([&] { return status.writers == 2 && !status.second_writer.empty(); }));
  this->stage.pause("b");
  Go go;
  go.epoch = 1;
  ASSERT_TRUE(ours->publish(go));
  go.epoch = 666;
  this->stage.pass(0.02);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(theirs->publish(go));
  this->stage.pass(0.05);
  this->stage.resume("b");
  ASSERT_TRUE(this->stage.until([&] { return !epochs.empty(); }));
  EXPECT_EQ(epochs, std::vector<std::uint64_t>{1});
}

TYPED_TEST(BusRules,
           the_ros2_lane_commands_a_trajectory_while_it_has_a_writer_and_is_no_second_one) {
  Bus& b = this->stage.add("b");
  Bus& planner = this->stage.add("manipulation_planner");
  Bus& lane = this->stage.add("ros2_lane");
  auto usual = planner.advertise<TrajectoryCommand>();
  std::uint64_t planned = 0, asked = 0;
  const auto& status = b.subscribe<TrajectoryCommand>(
      [&](const TrajectoryCommand& m, const Receipt&) { ++(m.id == 1 ? planned : asked); });
  ASSERT_TRUE(this->matched(usual, status));
  const auto command = [](std::uint64_t id) {
    TrajectoryCommand m;
    m.robot = "jido";
    m.id = id;
    m.axes = {0};
    m.trajectory.axes.resize(1);
    return m;
  };
  auto lent = lane.advertise<TrajectoryCommand>();
  ASSERT_TRUE(this->matched(lent, status, 2));
  ASSERT_TRUE(lent->publish(command(2)));
  EXPECT_TRUE(this->stage.until([&] { return asked == 1; }));
  EXPECT_EQ(status.second_writer, "");
  lent.reset();
  ASSERT_TRUE(this->stage.until([&] { return status.writers == 1; }));
  this->stage.pass(0.05);
  ASSERT_TRUE(usual->publish(command(1)));
  EXPECT_TRUE(this->stage.until([&] { return planned == 1; }));
}

TYPED_TEST(BusRules, polled_subscription_gets_the_newest_once_per_period) {
  Bus& a = this->stage.add("sim");
  Bus& b = this->stage.add("b");
  auto publisher = a.advertise<RobotState>();
  std::uint64_t sequence = 0, last = 0;
  const auto& status =
      b.subscribe<RobotState>([&](const RobotState& m, const Receipt&) { last = m.sequence; },
                              {.period = std::chrono::milliseconds(50)});
  ASSERT_TRUE(this->matched(publisher, status));
  a.every(std::chrono::milliseconds(2),
          [&](TimePoint) { publisher->publish(robot_state(++sequence)); });
  ASSERT_TRUE(this->stage.until([&] { return sequence > 200; }));
  EXPECT_GT(last, 100u);
  EXPECT_LT(status.received, sequence / 4);
  EXPECT_GT(status.received, 2u);
}

TYPED_TEST(BusRules, timers_keep_their_pace_and_count_their_cycles) {
  Bus& a = this->stage.add("a");
  TimePoint first{}, last{};
  const TimerStatus& timer = a.every(std::chrono::milliseconds(10), [&](TimePoint now) {
    if (first == TimePoint{}) first = now;
    last = now;
  });
  ASSERT_TRUE(this->stage.until([&] { return timer.cycles + timer.skipped >= 50; }));
  EXPECT_NEAR(to_seconds(last - first),
              0.01 * static_cast<double>(timer.cycles + timer.skipped - 1), 0.02);
  int once = 0;
  a.after(std::chrono::milliseconds(20), [&](TimePoint) { ++once; });
  this->stage.pass(0.1);
  EXPECT_EQ(once, 1);
}

TYPED_TEST(BusRules, jobs_run_in_turn_and_report_back_even_when_cancelled) {
  Bus& a = this->stage.add("a");
  std::vector<int> order;
  bool saw_cancel = false;
  a.run_job([](const CancelToken&) { return Duration(std::chrono::milliseconds(5)); },
            [&] { order.push_back(1); });
  CancelToken second = a.run_job(
      [&](const CancelToken& token) {
        saw_cancel = token.cancelled();
        return Duration(std::chrono::milliseconds(5));
      },
      [&] { order.push_back(2); });
  second.cancel();
  a.run_job([](const CancelToken&) { return Duration::zero(); }, [&] { order.push_back(3); });
  ASSERT_TRUE(this->stage.until([&] { return order.size() == 3; }));
  EXPECT_EQ(order, (std::vector<int>{1, 2, 3}));
}

TYPED_TEST(BusRules, health_tells_rates_ages_and_degradation) {
  Bus& a = this->stage.add("a");
  Bus& b = this->stage.add("spark");
  ComponentHealth health;
  b.subscribe<ComponentHealth>([&](const ComponentHealth& m, const Receipt&) {
    if (m.component == "a") health = m;
  });
  a.subscribe<HumanState>([](const HumanState&, const Receipt&) {});
  a.subscribe<Facts>([](const Facts&, const Receipt&) {});
  auto people = b.advertise<HumanState>();
  b.every(std::chrono::milliseconds(20), [&](TimePoint) { people->publish(HumanState{}); });
  a.set_degraded("waits for a person");
  ASSERT_TRUE(
      this->stage.until([&] { return health.topics.size() == 2 && health.topics[0].rate > 40; }));
  EXPECT_EQ(health.state, HealthState::degraded);
  EXPECT_EQ(health.reason, "waits for a person");
  EXPECT_EQ(health.topics[0].topic, "handsel/human_state");
  EXPECT_LT(health.topics[0].age, 1.0);
  EXPECT_LT(health.topics[1].age, 0.0) << "never seen";
}

TYPED_TEST(BusRules, requests_wait_for_a_busy_reader_without_blocking_the_writer) {
  Bus& a = this->stage.add("a");
  Bus& b = this->stage.add("b");
  auto requests = a.advertise<GraspRequest>();
  std::vector<std::uint64_t> numbers, sent;
  const auto& status = b.subscribe<GraspRequest>(
      [&](const GraspRequest& m, const Receipt&) { numbers.push_back(m.id.number); });
  ASSERT_TRUE(this->matched(requests, status));
  this->stage.pause("b");
  for (std::uint64_t i = 1; i <= 60; ++i) {
    GraspRequest request;
    request.object = "mug";
    request.id.number = i;
    ASSERT_TRUE(requests->publish(request));
    sent.push_back(i);
  }
  this->stage.pass(0.05);
  this->stage.resume("b");
  ASSERT_TRUE(this->stage.until([&] { return numbers.size() >= 60; }));
  EXPECT_EQ(numbers, sent);
}

class Ages : public testing::Test {
 protected:
  AgeEstimator estimator;
  Stamp clock_offset{1'700'000'000'000'000'000};
  /// A sample stamped at `sent` that arrives at `arrived` [s] of the receiver's time.
  double age(double sent, double arrived) {
    return to_seconds(estimator.update(clock_offset + from_seconds(sent).count(),
                                       TimePoint(from_seconds(arrived))));
  }
};

TEST_F(Ages, are_over_the_fastest_sample_so_far) {
  EXPECT_NEAR(age(0.0, 0.010), 0.0, 1e-9);
  EXPECT_NEAR(age(0.1, 0.105), 0.0, 1e-9);
  EXPECT_NEAR(age(0.2, 0.235), 0.030, 1e-3);
  EXPECT_NEAR(age(0.3, 1.305), 1.000, 2e-3) << "held back for a second";
  EXPECT_NEAR(age(0.3, 2.305), 2.000, 4e-3) << "frozen data grows old";
}

TEST_F(Ages, survive_a_step_of_the_writers_clock_either_way) {
  for (int i = 0; i < 100; ++i) age(0.01 * i, 0.01 * i + 0.002);
  clock_offset -= from_seconds(30).count();
  for (int i = 100; i < 200; ++i) EXPECT_LT(age(0.01 * i, 0.01 * i + 0.002), 0.001) << i;
  clock_offset += from_seconds(3600).count();
  for (int i = 200; i < 300; ++i) EXPECT_LT(age(0.01 * i, 0.01 * i + 0.002), 0.001) << i;
  EXPECT_NEAR(age(3.0, 3.052), 0.05, 1e-3) << "a late sample is still seen as late";
}

TEST_F(Ages, follow_clocks_that_drift_apart) {
  double worst = 0;
  for (int i = 0; i < 60000; ++i) worst = std::max(worst, age(0.01 * i, 0.01 * i * 1.0005));
  EXPECT_LT(worst, 1e-4) << "500 ppm over ten minutes";
}

TEST(LocalNetwork, same_seed_same_history) {
  const auto history = [](std::uint64_t seed) {
    LocalNetwork network(seed);
    Bus& a = network.add("sim");
    Bus& b = network.add("b");
    auto publisher = a.advertise<RobotState>();
    std::vector<std::int64_t> arrivals;
    b.subscribe<RobotState>([&](const RobotState&, const Receipt& r) {
      arrivals.push_back(r.arrival.time_since_epoch().count());
    });
    std::uint64_t sequence = 0;
    a.every(std::chrono::milliseconds(2),
            [&](TimePoint) { publisher->publish(robot_state(++sequence)); });
    network.run_until(TimePoint(std::chrono::seconds(1)));
    return arrivals;
  };
  EXPECT_EQ(history(5), history(5));
  EXPECT_NE(history(5), history(6));
  EXPECT_GT(history(5).size(), 490u);
}

}  // namespace
}  // namespace handsel::bus_test
