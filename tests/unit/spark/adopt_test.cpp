// SPDX-License-Identifier: Apache-2.0
// A restarted SPARK adopts the lost people of the previous process.
#include <gtest/gtest.h>

#include "common/config/resources.hpp"
#include "common/model/human/human_body.hpp"
#include "components/spark/people/people_tracker.hpp"

namespace handsel::spark::adopt_test {
namespace {

const Coverage kRoom{{-4, -4, -0.5}, {4, 4, 2.6}};
const Coverage kReach{{-1, -1, 0.1}, {1, 1, 1.9}};

TimePoint at(double t) { return TimePoint(from_seconds(t)); }

settings::SparkSettings settings() {
  auto s =
      settings::read_spark_settings(std::string(HANDSEL_SOURCE_DIR) + "/deploy/config/spark.txtpb");
  return s;
}

Person lost(const std::string& id, double x, double y, double age) {
  Person person;
  person.id = id;
  person.stature = 1.75;
  person.joints = standing_body({x, y, 0}, 0.0, 1.75);
  person.age = age;
  return person;
}

void look(PeopleTracker& tracker, const std::string& body, double x, double y, double from,
          double to) {
  for (double t = from; t < to; t += 0.033) {
    HumanObservation observation;
    observation.source = "camera";
    observation.coverage = kRoom;
    if (!body.empty()) {
      observation.people.push_back({body, {}, false});
      for (const auto& joint : standing_body({x + 1e-5 * t, y, 0}, 0.0, 1.75))
        observation.people[0].joints.push_back({joint.name, joint.position, 1.0});
    }
    tracker.observe(observation, at(t));
  }
}

TEST(Adopt, a_lost_person_grows_from_when_they_were_last_seen) {
  PeopleTracker tracker(settings());
  tracker.adopt({lost("anna", 1.5, 0, 4.0)}, at(10), at(9));
  const HumanState state = tracker.state(at(11), kReach);
  ASSERT_EQ(state.people.size(), 1u);
  EXPECT_EQ(state.people[0].id, "anna");
  EXPECT_NEAR(state.people[0].age, 5.0, 1e-6);
  EXPECT_NEAR(state.people[0].inflation, 5.0 * 1.6, 1e-6);
}

TEST(Adopt, each_is_adopted_once_and_whom_this_process_has_seen_itself_is_not) {
  PeopleTracker tracker(settings());
  tracker.adopt({lost("anna", 1.5, 0, 4.0)}, at(10), at(9));
  EXPECT_EQ(tracker.clear("anna", at(10)), 1u);
  tracker.adopt({lost("anna", 1.5, 0, 5.0)}, at(11), at(9));
  EXPECT_TRUE(tracker.state(at(11), kReach).people.empty())
      << "told once more before the supervisor knew that she was cleared";
  tracker.adopt({lost("bert", 1.5, 0, 1.0)}, at(12), at(9));
  EXPECT_TRUE(tracker.state(at(12), kReach).people.empty())
      << "last seen after this process began: it knows";
  Person half = lost("carl", 0, 0, 9.0);
  half.joints.pop_back();
  tracker.adopt({half}, at(12), at(9));
  EXPECT_TRUE(tracker.state(at(12), kReach).people.empty()) << "no body";
}

TEST(Adopt, who_stands_there_seen_is_the_same_person_whatever_the_order) {
  for (const bool first_seen : {true, false}) {
    PeopleTracker tracker(settings());
    if (first_seen) look(tracker, "7", 1.5, 0.05, 9.5, 10.0);
    tracker.adopt({lost("anna", 1.5, 0, 1.2)}, at(10), at(9));
    look(tracker, "7", 1.5, 0.05, 10.0, 10.5);
    const HumanState state = tracker.state(at(10.5), kReach);
    ASSERT_EQ(state.people.size(), 1u) << first_seen;
    EXPECT_EQ(state.people[0].id, "anna");
    EXPECT_LT(state.people[0].age, 0.1);
  }
}

TEST(Adopt, another_person_with_the_same_name_far_away_is_another) {
  PeopleTracker tracker(settings());
  look(tracker, "anna", -2.5, -2.5, 9.5, 10.0);
  tracker.adopt({lost("anna", 1.5, 1.5, 1.0)}, at(10), at(9.9));
  const HumanState state = tracker.state(at(10), kReach);
  ASSERT_EQ(state.people.size(), 2u);
  EXPECT_NE(state.people[0].id, state.people[1].id);
}

TEST(Adopt, who_was_lost_at_the_edge_is_confined_to_it_once_the_source_has_looked_for_a_while) {
  PeopleTracker tracker(settings());
  tracker.adopt({lost("anna", 3.8, 0, 60.0)}, at(10), at(9));
  look(tracker, "", 0, 0, 10.0, 10.3);
  EXPECT_GT(tracker.state(at(10.3), kReach).people.at(0).inflation, 90.0);
  look(tracker, "", 0, 0, 10.3, 12.0);
  EXPECT_LT(tracker.state(at(12), kReach).people.at(0).inflation, 0.7);
}

}  // namespace
}  // namespace handsel::spark::adopt_test
