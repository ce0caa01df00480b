// SPDX-License-Identifier: Apache-2.0
// Live sources of people: the age of their samples, and repeated samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "components/spark/capture_age.hpp"
#include "components/spark/people/people_tracker.hpp"

namespace handsel::spark::spark_views_test {
namespace {

using ::testing::HasSubstr;

constexpr double kPeriod = 1.0 / 30;
constexpr Stamp kStart = 1'700'000'000'000'000'000;
const Coverage kRoom{{-4, -4, -0.5}, {4, 4, 2.6}}, kReach{{-1, -1, 0.1}, {1, 1, 1.9}};

TimePoint at(double t) { return TimePoint(from_seconds(t)); }
Stamp stamp_at(double t) { return kStart + from_seconds(t).count(); }

settings::SparkSettings shipped() {
  auto s =
      settings::read_spark_settings(std::string(HANDSEL_SOURCE_DIR) + "/deploy/config/spark.txtpb");
  return s;
}

TEST(CaptureAge, counts_a_constant_delay_in_full) {
  EXPECT_NEAR(capture_age(stamp_at(9.5), stamp_at(10), 0.0, 0.03, {0.002, {}}).age, 0.502, 1e-9);
}

TEST(CaptureAge, is_never_less_than_what_the_arrivals_show_nor_than_the_least_latency) {
  EXPECT_NEAR(capture_age(stamp_at(10), stamp_at(10), 0.4, 0.03, {0.002, {}}).age, 0.43, 1e-9)
      << "a clock that was set hides nothing";
  EXPECT_NEAR(capture_age(stamp_at(10), stamp_at(10), 0.0, 0.03, {0.002, {}}).age, 0.03, 1e-9);
}

TEST(CaptureAge, of_a_picture_without_a_stamp_is_known_only_if_a_latency_is_assumed) {
  EXPECT_THAT(capture_age(0, stamp_at(10), 0.0, 0.03, {0.002, {}}).unknown,
              HasSubstr("assumed_latency"));
  const CaptureAge assumed = capture_age(0, stamp_at(10), 0.0, 0.03, {0.002, 0.15});
  EXPECT_EQ(assumed.unknown, "");
  EXPECT_NEAR(assumed.age, 0.15, 1e-9);
}

TEST(CaptureAge, of_a_picture_from_the_future_is_unknown_beyond_the_error_of_the_clock) {
  EXPECT_EQ(capture_age(stamp_at(10.01), stamp_at(10), 0.0, 0.03, {0.02, {}}).unknown, "");
  EXPECT_THAT(capture_age(stamp_at(10.5), stamp_at(10), 0.0, 0.03, {0.02, {}}).unknown,
              HasSubstr("0.500 s in the future"));
}

TEST(CaptureAge, takes_the_clock_of_each_source_from_the_settings) {
  settings::SparkSettings s = shipped();
  settings::SourceClock& old = s.clocks.emplace_back();
  old.source = "old";
  old.assumed_latency = 0.2;
  EXPECT_EQ(clock_of(s, "camera").error, s.clock_error);
  EXPECT_FALSE(clock_of(s, "camera").assumed_latency);
  EXPECT_EQ(clock_of(s, "old").error, s.clock_error);
  EXPECT_EQ(clock_of(s, "old").assumed_latency, 0.2);
  old.clock_error = 0.5;
  EXPECT_EQ(clock_of(s, "old").error, 0.5);
}

/// A source at 30 Hz, as received by SPARK.
class Views : public testing::Test {
 protected:
  ObservedPerson anna(double x = 0.5) {
    ObservedPerson body;
    body.body = "anna";
    for (const auto& joint : standing_body({x, 0, 0}, 0.0, 1.75))
      body.joints.push_back({joint.name, joint.position, 1.0});
    return body;
  }
  /// One picture that arrives now.
  void see(std::vector<ObservedPerson> people, Stamp stamp) {
    HumanObservation picture;
    picture.source = "camera";
    picture.coverage = kRoom;
    picture.people = std::move(people);
    picture.stamp = stamp;
    const CaptureAge age =
        capture_age(stamp, stamp_at(now), 0.0, settings.min_latency, clock_of(settings, "camera"));
    if (age.unknown.empty())
      tracker.observe(picture, at(now - age.age), {}, nullptr, age.age);
    else
      tracker.refuse(picture, age.unknown, at(now));
  }
  void empty(double delay) { see({}, stamp_at(now - delay)); }
  /// So many seconds of new pictures.
  void look(double seconds, double delay, bool with_anna = false) {
    for (const double end = now + seconds; now < end; now += kPeriod)
      with_anna ? see({anna(0.5 + 0.001 * std::sin(40 * now))}, stamp_at(now - delay))
                : empty(delay);
  }
  HumanState state() { return tracker.state(at(now), kReach); }
  const SourceView view() {
    const HumanState all = state();
    EXPECT_EQ(all.views.size(), 1u);
    return all.views.empty() ? SourceView{} : all.views[0];
  }

  settings::SparkSettings settings = shipped();
  PeopleTracker tracker{settings};
  double now{10.0};
};

TEST_F(Views, name_a_live_source_with_its_box_and_age) {
  EXPECT_TRUE(state().views.empty());
  look(1.0, 0.04);
  const SourceView v = view();
  EXPECT_EQ(v.source, "camera");
  EXPECT_TRUE(v.live);
  EXPECT_EQ(v.reason, "");
  EXPECT_EQ(v.low, kRoom.low);
  EXPECT_EQ(v.high, kRoom.high);
  EXPECT_NEAR(v.age, 0.04 + kPeriod + settings.clock_error, 1e-6);
  EXPECT_TRUE(state().covered);
}

TEST_F(Views, a_constant_delay_makes_a_source_late_and_people_as_old) {
  look(1.0, 0.5, true);
  EXPECT_FALSE(view().live);
  EXPECT_THAT(view().reason, HasSubstr("is late: its pictures are 0.50 s old"));
  ASSERT_EQ(state().people.size(), 1u);
  EXPECT_GE(state().people[0].age, 0.5);
  EXPECT_FALSE(state().covered);
}

TEST_F(Views, a_delay_that_grows_slowly_is_seen) {
  look(1.0, 0.04);
  for (double delay = 0.04; delay < 0.3; delay += 0.0005, now += kPeriod) empty(delay);
  EXPECT_FALSE(view().live);
  EXPECT_THAT(view().reason, HasSubstr("is late"));
}

TEST_F(Views, a_silent_source_is_not_live_and_no_fact_that_nobody_is_there) {
  look(1.0, 0.04);
  now += 0.2;
  EXPECT_FALSE(view().live) << view().age;
  EXPECT_THAT(view().reason, HasSubstr("is silent for 0."));
  EXPECT_FALSE(state().covered);
  EXPECT_THAT(tracker.trouble(at(now)), HasSubstr("source camera is silent"));
  look(0.1, 0.04);
  EXPECT_TRUE(view().live) << "it is back";
  EXPECT_TRUE(state().covered);
}

TEST_F(Views, an_empty_picture_whose_stamp_does_not_advance_is_repeated) {
  look(1.0, 0.04);
  const Stamp stamp = stamp_at(now);
  for (int i = 0; i < 15; ++i, now += kPeriod) see({}, stamp);
  EXPECT_FALSE(view().live);
  EXPECT_THAT(view().reason, HasSubstr("repeats itself"));
  EXPECT_FALSE(state().covered) << "nobody is there needs a live source that says so";
}

TEST_F(Views, an_empty_picture_with_a_new_stamp_each_time_is_live) {
  look(3.0, 0.04);
  EXPECT_TRUE(view().live);
}

TEST_F(Views, people_who_are_the_same_to_the_bit_are_repeated_though_the_stamps_are_new) {
  look(1.0, 0.04, true);
  for (int i = 0; i < 15; ++i, now += kPeriod) see({anna()}, stamp_at(now - 0.04));
  EXPECT_FALSE(view().live);
  EXPECT_THAT(view().reason, HasSubstr("repeats itself"));
  look(0.1, 0.04, true);
  EXPECT_TRUE(view().live);
}

TEST_F(Views, one_picture_twice_does_no_harm) {
  look(1.0, 0.04, true);
  see({anna()}, stamp_at(now - 0.04));
  see({anna()}, stamp_at(now - 0.04));
  EXPECT_TRUE(view().live);
}

TEST_F(Views, a_source_without_stamps_is_not_live_and_shows_nobody) {
  for (int i = 0; i < 15; ++i, now += kPeriod) see({anna()}, 0);
  EXPECT_FALSE(view().live);
  EXPECT_THAT(view().reason, HasSubstr("gives no capture stamps"));
  EXPECT_TRUE(state().people.empty());
}

TEST_F(Views, a_source_with_a_clock_ahead_is_not_live_until_it_is_right) {
  look(1.0, 0.04);
  for (int i = 0; i < 15; ++i, now += kPeriod) see({}, stamp_at(now + 3600));
  EXPECT_FALSE(view().live);
  EXPECT_THAT(view().reason, HasSubstr("3600.000 s in the future"));
  look(0.1, 0.04);
  EXPECT_TRUE(view().live);
}

TEST_F(Views, a_lost_person_is_not_seen_gone_by_a_source_that_is_not_live) {
  look(1.0, 0.04, true);
  const Stamp stamp = stamp_at(now);
  for (int i = 0; i < 20; ++i, now += kPeriod) see({}, stamp);
  EXPECT_EQ(state().people.size(), 1u);
  look(1.0, 0.04);
  EXPECT_TRUE(state().people.empty()) << "seen gone by a live one";
}

}  // namespace
}  // namespace handsel::spark::spark_views_test
