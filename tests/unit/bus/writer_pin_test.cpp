// SPDX-License-Identifier: Apache-2.0
// The rule that selects the pinned writer of a topic.
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "common/bus/writer_pin.hpp"

namespace handsel::writer_pin_test {
namespace {

const TopicRow& kSetPoints = TopicOf<JointCommand>::row;

TimePoint at(double seconds) { return TimePoint(from_seconds(seconds)); }

/// A process of this host.
struct Process {
  std::string components;
  std::shared_ptr<bool> ended = std::make_shared<bool>(false);
  WriterIdentity identity() const {
    return {
        .components = components, .name = components, .matches = true, .ended = [ended = ended] {
          return *ended;
        }};
  }
};

/// A process on another host.
WriterIdentity elsewhere(const std::string& components) {
  return {
      .components = components, .name = components + " elsewhere", .matches = true, .ended = {}};
}

TEST(WriterPin, a_writer_is_eligible_by_a_word_of_its_name) {
  EXPECT_TRUE(may_write(kSetPoints, "trajectory_controller"));
  EXPECT_TRUE(may_write(kSetPoints, "rehearsal trajectory_controller"));
  EXPECT_FALSE(may_write(kSetPoints, "trajectory_controllers"));
  EXPECT_FALSE(may_write(kSetPoints, "trajectory"));
  EXPECT_FALSE(may_write(kSetPoints, "spark"));
  EXPECT_FALSE(may_write(kSetPoints, ""));
  EXPECT_FALSE(may_write(kSetPoints, " "));
  EXPECT_TRUE(may_write(TopicOf<RobotState>::row, "driver"));
}

TEST(WriterPin, the_first_eligible_writer_stays_while_it_lives_however_silent) {
  WriterPin pin(kSetPoints);
  const Process first{"trajectory_controller"}, second{"trajectory_controller"};
  pin.appeared(1, first.identity(), at(0));
  pin.appeared(2, second.identity(), at(1));
  EXPECT_FALSE(pin.accepts(2, at(1)));
  EXPECT_TRUE(pin.accepts(1, at(2)));
  EXPECT_FALSE(pin.accepts(2, at(3600)));
  EXPECT_EQ(pin.second_writer(), "trajectory_controller");
  pin.left(2, at(3601));
  EXPECT_EQ(pin.second_writer(), "");
}

TEST(WriterPin, a_restarted_process_is_accepted_before_discovery_notices_the_death_of_the_old_one) {
  WriterPin pin(kSetPoints);
  const Process old{"trajectory_controller"}, fresh{"trajectory_controller"};
  pin.appeared(1, old.identity(), at(0));
  EXPECT_TRUE(pin.accepts(1, at(1)));
  *old.ended = true;
  pin.appeared(2, fresh.identity(), at(1.2));
  EXPECT_EQ(pin.pinned(), 2u);
  EXPECT_TRUE(pin.accepts(2, at(1.2)));
  EXPECT_EQ(pin.second_writer(), "") << "a dead process is no second writer";
  EXPECT_FALSE(pin.accepts(1, at(1.3))) << "nothing late of the dead one";
  pin.left(1, at(4));
  EXPECT_TRUE(pin.accepts(2, at(4)));
}

TEST(WriterPin, a_spare_follows_when_the_pinned_process_ends) {
  WriterPin pin(kSetPoints);
  const Process old{"trajectory_controller"}, spare{"trajectory_controller"};
  pin.appeared(1, old.identity(), at(0));
  pin.appeared(2, spare.identity(), at(0.1));
  EXPECT_FALSE(pin.accepts(2, at(1)));
  *old.ended = true;
  EXPECT_TRUE(pin.accepts(2, at(1.01)));
  EXPECT_EQ(pin.second_writer(), "");
}

TEST(WriterPin, a_spare_that_does_not_speak_follows_at_the_next_watch) {
  WriterPin pin(kSetPoints);
  const Process old{"trajectory_controller"}, spare{"trajectory_controller"};
  pin.appeared(1, old.identity(), at(0));
  pin.appeared(2, spare.identity(), at(0.1));
  *old.ended = true;
  pin.watch(at(1));
  EXPECT_EQ(pin.pinned(), 2u);
  EXPECT_EQ(pin.second_writer(), "");
}

TEST(WriterPin,
     of_a_process_elsewhere_only_a_later_one_of_the_same_component_follows_after_a_silence) {
  WriterPin pin(TopicOf<RobotState>::row);
  pin.appeared(1, elsewhere("driver"), at(0));
  EXPECT_TRUE(pin.accepts(1, at(0.4)));
  pin.appeared(2, elsewhere("driver"), at(0.5));
  EXPECT_TRUE(pin.accepts(1, at(1)));
  EXPECT_FALSE(pin.accepts(2, at(9))) << "it was there before the silence";
  pin.appeared(3, elsewhere("sim"), at(1.1));
  EXPECT_FALSE(pin.accepts(3, at(9))) << "another component";
  pin.appeared(4, elsewhere("driver"), at(1.1));
  EXPECT_FALSE(pin.accepts(4, at(1.29)));
  EXPECT_TRUE(pin.accepts(4, at(1.31)));
  EXPECT_FALSE(pin.accepts(1, at(1.4)));
}

TEST(WriterPin, of_a_topic_without_deadline_a_process_elsewhere_keeps_the_pin_until_it_is_gone) {
  WriterPin pin(TopicOf<HandCommand>::row);
  pin.appeared(1, elsewhere("manipulation_planner"), at(0));
  pin.appeared(2, elsewhere("manipulation_planner"), at(5));
  EXPECT_FALSE(pin.accepts(2, at(60)));
  pin.left(1, at(61));
  EXPECT_TRUE(pin.accepts(2, at(61)));
}

TEST(WriterPin, a_writer_that_cannot_match_is_named_and_never_pinned) {
  WriterPin pin(kSetPoints);
  WriterIdentity exclusive = elsewhere("trajectory_controller");
  exclusive.matches = false;
  pin.appeared(1, exclusive, at(0));
  EXPECT_EQ(pin.pinned(), 0u);
  EXPECT_EQ(pin.second_writer(), "trajectory_controller elsewhere");
  pin.appeared(2, Process{"trajectory_controller"}.identity(), at(1));
  EXPECT_TRUE(pin.accepts(2, at(1)));
}

TEST(WriterPin, names_the_first_of_several_and_counts_the_rest) {
  WriterPin pin(kSetPoints);
  pin.appeared(1, Process{"trajectory_controller"}.identity(), at(0));
  for (std::uint64_t i = 2; i < 5; ++i) pin.appeared(i, elsewhere("stranger"), at(1));
  EXPECT_EQ(pin.second_writer(), "stranger elsewhere and 2 more");
}

TEST(WriterPin, thousands_of_writers_take_no_more_room_and_do_not_displace_the_pinned_one) {
  WriterPin pin(kSetPoints);
  pin.appeared(1, Process{"trajectory_controller"}.identity(), at(0));
  for (std::uint64_t i = 2; i < 5000; ++i)
    pin.appeared(i, elsewhere("trajectory_controller"), at(1));
  EXPECT_EQ(pin.second_writer(), "trajectory_controller elsewhere and 62 more");
  EXPECT_TRUE(pin.accepts(1, at(2)));
  EXPECT_FALSE(pin.accepts(4999, at(2)));
}

/// For any history, samples of at most one writer are accepted at a time; that writer is eligible
/// and changes only after its predecessor has left or the process has ended.
TEST(WriterPin, at_most_one_living_writer_is_accepted_in_random_histories) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int history = 0; history < 200; ++history) {
    WriterPin pin(kSetPoints);
    std::map<std::uint64_t, Process> living;
    std::uint64_t next = 1, accepted = 0;
    for (int step = 0; step < 300; ++step) {
      const TimePoint now = at(0.01 * step);
      const unsigned draw = random() % 10;
      if (draw < 2) {
        living[next] = Process{random() % 3 == 0 ? "stranger" : "trajectory_controller"};
        pin.appeared(next, living[next].identity(), now);
        ++next;
      } else if (draw < 3 && !living.empty()) {
        auto it = std::next(living.begin(), static_cast<long>(random() % living.size()));
        if (random() % 2) {
          *it->second.ended = true;
        } else {
          pin.left(it->first, now);
          living.erase(it);
        }
      } else {
        pin.watch(now);
      }
      std::uint64_t passed = 0;
      for (const auto& [writer, process] : living) {
        if (*process.ended || !pin.accepts(writer, now)) continue;
        EXPECT_EQ(passed, 0u) << "both " << passed << " and " << writer;
        EXPECT_EQ(process.components, "trajectory_controller");
        passed = writer;
      }
      const bool changed =
          passed != 0 && accepted != 0 && passed != accepted && living.contains(accepted);
      EXPECT_TRUE(!changed || *living.at(accepted).ended) << "a living writer lost its place";
      if (passed != 0) accepted = passed;
    }
  }
}

}  // namespace
}  // namespace handsel::writer_pin_test
