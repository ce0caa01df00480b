// SPDX-License-Identifier: Apache-2.0
// The latches of the supervisor, their text form and their file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <fstream>
#include <random>
#include <sstream>

#include "components/supervisor/safety/lost_people.hpp"
#include "components/supervisor/safety/safety_latches.hpp"
#include "components/supervisor/safety/state_store.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::supervisor::safety_latches_test {
namespace {

using testing::HasSubstr;

constexpr Stamp kSecond = 1'000'000'000;

TimePoint at(double seconds) { return TimePoint{from_seconds(seconds)}; }

RobotState robot(DriveMode mode) {
  RobotState state;
  state.mode = mode;
  return state;
}

ExecutionStatus fault(std::uint64_t epoch) {
  ExecutionStatus status;
  status.mode = Mode::fault;
  status.epoch = epoch;
  status.reason = "fault: tracking_error";
  return status;
}

Person person(const std::string& id, double age) {
  Person p;
  p.id = id;
  p.age = age;
  p.joints.push_back({"torso", {1, 2, 1.2}});
  return p;
}

HumanState shown(std::vector<Person> people) {
  HumanState state;
  state.people = std::move(people);
  return state;
}

TEST(SafetyLatches, a_pause_ends_by_a_person_only_and_every_change_has_a_new_revision) {
  SafetyLatches latches(fresh_state(7, 1.0));
  EXPECT_TRUE(latches.permits());
  EXPECT_EQ(latches.safety().revision, 7u);
  latches.pause();
  EXPECT_FALSE(latches.permits());
  EXPECT_EQ(latches.safety().revision, 8u);
  EXPECT_THAT(latches.safety().reason, HasSubstr("handsel task resume"));
  EXPECT_EQ(latches.acknowledge(), "");
  EXPECT_FALSE(latches.permits()) << "an acknowledgement ends no pause";
  EXPECT_EQ(latches.resume(), "");
  EXPECT_TRUE(latches.permits());
  EXPECT_EQ(latches.safety().reason, "");
  EXPECT_EQ(latches.state().permission_revision, latches.safety().revision);
}

TEST(SafetyLatches,
     a_fault_ends_by_acknowledgement_only_and_old_reports_of_it_do_not_bring_it_back) {
  SafetyLatches latches(fresh_state(1, 1.0));
  latches.on(fault(4), 0);
  EXPECT_TRUE(latches.safety().fault);
  EXPECT_THAT(latches.safety().reason, HasSubstr("tracking_error"));
  EXPECT_NE(latches.resume(), "");
  EXPECT_FALSE(latches.permits());
  EXPECT_EQ(latches.acknowledge(), "");
  EXPECT_TRUE(latches.permits());
  latches.on(fault(4), 5);
  EXPECT_TRUE(latches.permits()) << "reported before the Go of epoch 5, which acknowledged it";
  latches.on(fault(5), 5);
  EXPECT_FALSE(latches.permits()) << "its cause is still there";
}

TEST(SafetyLatches, a_stop_of_the_robot_is_latched_when_it_begins_and_want_of_set_points_is_not) {
  for (const DriveMode mode :
       {DriveMode::protective_stop, DriveMode::user_stop, DriveMode::emergency_stop}) {
    SafetyLatches latches(fresh_state(1, 1.0));
    latches.on(robot(DriveMode::enabled));
    latches.on(robot(mode));
    latches.on(robot(DriveMode::enabled));
    EXPECT_TRUE(latches.safety().awaits_person);
    EXPECT_EQ(latches.resume(), "");
    latches.on(robot(DriveMode::enabled));
    EXPECT_TRUE(latches.permits());
  }
  SafetyLatches latches(fresh_state(1, 1.0));
  for (const DriveMode mode : {DriveMode::off, DriveMode::braked, DriveMode::enabled})
    latches.on(robot(mode));
  EXPECT_TRUE(latches.permits());
}

TEST(SafetyLatches, nobody_resumes_while_the_stop_is_pressed) {
  SafetyLatches latches(fresh_state(1, 1.0));
  latches.on(robot(DriveMode::emergency_stop));
  EXPECT_THAT(latches.resume(), HasSubstr("emergency_stop"));
  EXPECT_THAT(latches.acknowledge(), HasSubstr("emergency_stop"));
  EXPECT_FALSE(latches.permits());
  latches.on(robot(DriveMode::protective_stop));
  EXPECT_EQ(latches.resume(), "") << "a drive that waits for a person in protective_stop is one";
  latches.on(robot(DriveMode::protective_stop));
  EXPECT_TRUE(latches.permits()) << "the same stop";
  latches.on(robot(DriveMode::user_stop));
  EXPECT_FALSE(latches.permits()) << "another one";
}

TEST(SafetyLatches, the_speed_override_is_kept_and_nan_is_zero) {
  SafetyLatches latches(fresh_state(1, 1.0));
  latches.set_override(0.1);
  EXPECT_EQ(latches.safety().override_factor, 0.1);
  EXPECT_TRUE(latches.permits());
  latches.set_override(std::nan(""));
  EXPECT_EQ(latches.safety().override_factor, 0.0);
}

TEST(SafetyLatches, people_lost_change_the_state_but_not_the_permission) {
  SafetyLatches latches(fresh_state(3, 1.0));
  latches.set_lost({person("anna", 2)}, kSecond);
  EXPECT_EQ(latches.safety().revision, 4u);
  EXPECT_EQ(latches.state().permission_revision, 3u);
  EXPECT_TRUE(latches.permits());
}

TEST(LostPeople, who_is_not_seen_is_lost_until_seen_gone_or_cleared) {
  LostPeople lost(1.0, 16, {}, at(0));
  lost.on(shown({person("anna", 0.0), person("bert", 1.5)}), at(1), 1);
  EXPECT_TRUE(lost.changed(at(1)));
  ASSERT_EQ(lost.people(at(1)).size(), 1u);
  EXPECT_EQ(lost.people(at(1))[0].id, "bert");
  EXPECT_DOUBLE_EQ(lost.people(at(3))[0].age, 3.5);
  EXPECT_FALSE(lost.changed(at(1.1)));
  lost.on(shown({person("anna", 0.0), person("bert", 0.0)}), at(1.2), 1);
  EXPECT_TRUE(lost.changed(at(1.2)));
  EXPECT_TRUE(lost.people(at(1.2)).empty());
  lost.on(shown({person("bert", 2.0)}), at(1.3), 1);
  lost.on(shown({}), at(1.4), 1);
  EXPECT_TRUE(lost.people(at(1.4)).empty()) << "seen to be gone";
  lost.on(shown({person("bert", 2.0)}), at(1.5), 1);
  lost.clear("carl");
  EXPECT_EQ(lost.people(at(1.5)).size(), 1u);
  lost.clear("");
  EXPECT_TRUE(lost.people(at(1.5)).empty());
}

TEST(LostPeople, while_spark_is_silent_everybody_grows_old) {
  LostPeople lost(1.0, 16, {}, at(0));
  lost.on(shown({person("anna", 0.0)}), at(1), 1);
  EXPECT_FALSE(lost.changed(at(1.9)));
  EXPECT_TRUE(lost.changed(at(2.1)));
  EXPECT_EQ(lost.people(at(2.1)).size(), 1u);
}

TEST(LostPeople, a_new_spark_removes_nobody_before_it_has_shown_them) {
  LostPeople lost(1.0, 16, {person("carl", 30)}, at(0));
  lost.on(shown({person("anna", 0.0)}), at(1), 1);
  EXPECT_EQ(lost.people(at(1)).size(), 1u) << "carl is remembered from before the start";
  lost.on(shown({}), at(1.5), 2);
  EXPECT_TRUE(lost.changed(at(1.5)));
  EXPECT_EQ(lost.people(at(1.5)).size(), 2u) << "anna was seen by the one that died";
  lost.on(shown({person("anna", 0.01), person("carl", 32)}), at(2), 2);
  EXPECT_EQ(lost.people(at(2)).size(), 1u);
  lost.on(shown({person("anna", 0.01)}), at(2.1), 2);
  EXPECT_TRUE(lost.people(at(2.1)).empty()) << "seen to be gone by the one that had taken him over";
}

TEST(LostPeople, a_spark_that_was_there_when_they_were_last_seen_knows_whether_they_are_gone) {
  LostPeople lost(1.0, 16, {person("old", 30), person("new", 3)}, at(100));
  lost.on_spark_started(at(90));
  lost.on(shown({}), at(101), 1);
  ASSERT_EQ(lost.people(at(101)).size(), 2u) << "a writer heard for the first time";
  lost.on_spark_started(at(90));
  lost.on(shown({}), at(101.1), 1);
  ASSERT_EQ(lost.people(at(101.1)).size(), 1u);
  EXPECT_EQ(lost.people(at(101.1))[0].id, "old")
      << "lost before that SPARK began: it has to take them over first";
}

TEST(LostPeople, the_ones_lost_last_are_kept_and_the_rest_counted) {
  LostPeople lost(1.0, 2, {}, at(0));
  lost.on(shown({person("a", 9), person("b", 2), person("c", 5)}), at(1), 1);
  ASSERT_EQ(lost.people(at(1)).size(), 2u);
  EXPECT_EQ(lost.people(at(1))[0].id, "b");
  EXPECT_EQ(lost.people(at(1))[1].id, "c");
  EXPECT_EQ(lost.left_out(), 1u);
}

DurableState full_state() {
  SafetyLatches latches(fresh_state(100, 1.0));
  latches.pause();
  latches.set_override(0.1);
  latches.on(fault(3), 0);
  latches.on(robot(DriveMode::user_stop));
  latches.set_lost({person("anna \"A\"\n", 12.5), person("bert", 3)}, 50 * kSecond);
  return latches.state();
}

TEST(StateFile, gives_back_what_was_written_with_ages_as_of_now) {
  const DurableState state = full_state();
  const auto read = read_state(write_state(state, 51 * kSecond), 61 * kSecond);
  ASSERT_TRUE(std::holds_alternative<DurableState>(read)) << std::get<StateDamage>(read).reason;
  const SafetyState& s = std::get<DurableState>(read).safety;
  EXPECT_EQ(s.revision, state.safety.revision);
  EXPECT_EQ(std::get<DurableState>(read).permission_revision, state.permission_revision);
  EXPECT_TRUE(s.paused && s.fault && s.awaits_person);
  EXPECT_EQ(s.override_factor, 0.1);
  EXPECT_EQ(s.reason, state.safety.reason);
  ASSERT_EQ(s.lost.size(), 2u);
  EXPECT_EQ(s.lost[0].id, "anna \"A\"\n");
  EXPECT_NEAR(s.lost[0].age, 12.5 + 11, 1e-6);
  EXPECT_EQ(s.lost[0].joints.at(0).position, Vector3(1, 2, 1.2));
  const auto back = read_state(write_state(state, 51 * kSecond), 1 * kSecond);
  EXPECT_NEAR(std::get<DurableState>(back).safety.lost[0].age, 13.5, 1e-6)
      << "a clock set back makes nobody younger";
}

TEST(StateFile, every_truncation_and_every_flipped_bit_is_refused) {
  const std::string text = write_state(full_state(), 51 * kSecond);
  for (std::size_t n = 0; n < text.size(); ++n)
    ASSERT_TRUE(std::holds_alternative<StateDamage>(read_state(text.substr(0, n), 51 * kSecond)))
        << n;
  for (std::size_t i = 0; i < text.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = text;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      ASSERT_TRUE(std::holds_alternative<StateDamage>(read_state(damaged, 51 * kSecond)))
          << i << " bit " << bit;
    }
}

class Store : public testing::Test {
 protected:
  static std::string content(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::stringstream out;
    out << in.rdbuf();
    return out.str();
  }
  test::TemporaryFolder folder_;
  const StateStore store_{folder_.path() / "state"};
  const DurableState fresh_ = fresh_state(500, 1.0);
};

TEST_F(Store, the_first_start_permits_and_a_restart_finds_what_was_saved) {
  EXPECT_TRUE(SafetyLatches(store_.restore(fresh_, kSecond)).permits());
  EXPECT_TRUE(std::filesystem::exists(store_.file()));
  SafetyLatches latches(store_.restore(fresh_, kSecond));
  latches.pause();
  latches.set_override(0.1);
  ASSERT_EQ(store_.save(latches.state(), kSecond), "");
  const DurableState restored = store_.restore(fresh_state(900, 1.0), 2 * kSecond);
  EXPECT_TRUE(restored.safety.paused);
  EXPECT_EQ(restored.safety.override_factor, 0.1);
  EXPECT_EQ(restored.safety.revision, latches.safety().revision);
  EXPECT_EQ(store_.forget(), "");
  EXPECT_FALSE(store_.restore(fresh_, kSecond).safety.paused);
}

TEST_F(Store, a_damaged_file_waits_for_a_person_and_names_the_file) {
  store_.restore(fresh_, kSecond);
  for (const std::string& text :
       {std::string(), std::string("handsel safety state 1 00000000\npaused: false\n"),
        std::string(2'000'000, 'x')}) {
    std::ofstream(store_.file(), std::ios::trunc) << text;
    const DurableState state = store_.restore(fresh_, kSecond);
    EXPECT_TRUE(state.safety.paused && state.safety.awaits_person);
    EXPECT_THAT(state.safety.reason, HasSubstr(store_.file().string()));
    EXPECT_GT(state.safety.revision, 0u);
    EXPECT_TRUE(store_.restore(fresh_, kSecond).safety.paused)
        << "and the next restart finds the wait";
    SafetyLatches latches(state);
    EXPECT_EQ(latches.resume(), "");
    EXPECT_TRUE(latches.permits());
  }
}

TEST_F(Store, a_folder_that_cannot_be_written_or_read_waits_for_a_person) {
  std::ofstream(folder_.path() / "file") << "not a folder";
  for (const auto& folder : {folder_.path() / "file", folder_.path() / "file/below",
                             std::filesystem::path("/proc/handsel")}) {
    const StateStore store(folder);
    const DurableState state = store.restore(fresh_, kSecond);
    EXPECT_TRUE(state.safety.paused && state.safety.awaits_person);
    EXPECT_THAT(state.safety.reason, HasSubstr(folder.string().substr(0, 20)));
    EXPECT_NE(store.save(fresh_, kSecond), "");
  }
  std::filesystem::create_directories(store_.file());  // a folder in place of the file
  EXPECT_TRUE(store_.restore(fresh_, kSecond).safety.paused);
}

TEST_F(Store, a_write_that_fails_leaves_the_state_before_it) {
  SafetyLatches latches(store_.restore(fresh_, kSecond));
  latches.pause();
  ASSERT_EQ(store_.save(latches.state(), kSecond), "");
  const std::string before = content(store_.file());
  std::filesystem::create_directories(
      folder_.path() / "state/safety_state.new");  // the temporary file cannot be opened
  latches.resume();
  EXPECT_NE(store_.save(latches.state(), kSecond), "");
  EXPECT_EQ(content(store_.file()), before);
  EXPECT_TRUE(store_.restore(fresh_, kSecond).safety.paused);
}

}  // namespace
}  // namespace handsel::supervisor::safety_latches_test
