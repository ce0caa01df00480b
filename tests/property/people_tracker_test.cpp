// SPDX-License-Identifier: Apache-2.0
// People observed by faulty sources. The oracle knows only the true bodies and the raw
// observations: SPARK must hold every present person's volume occupied, and every place where a
// source observed a person until it is ruled out. Seeds are printed.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <random>

#include "common/config/resources.hpp"
#include "components/spark/people/people_tracker.hpp"

namespace handsel::spark::people_tracker_test {
namespace {

constexpr double kWalk = 1.6;     // max walking speed [m/s]
constexpr double kRun = 2.2;      // max speed of leaving a place [m/s]
constexpr double kNoise = 0.015;  // noise of joints [m]
constexpr double kSlack = 0.12;   // noise, outliers and lag of a filter [m]
constexpr double kHold = 0.3;     // min time for which an observed place stays occupied [s]

TimePoint at(double t) { return TimePoint(from_seconds(t)); }

/// Walks to places of its own choice, faces where it walks, swings its arms.
struct TruePerson {
  Vector3 feet;
  double yaw{}, swing{};
  Vector3 goal;
  std::vector<BodyJoint> body;

  void walk(double dt, std::mt19937& random, const Coverage& room) {
    std::uniform_real_distribution<double> unit(0, 1);
    if ((goal - feet).norm() < 0.1)
      goal = room.low + (room.high - room.low).cwiseProduct(Vector3(unit(random), unit(random), 0)),
      goal.z() = 0;
    const Vector3 direction = (goal - feet).normalized();
    feet += std::min(1.2 * dt, (goal - feet).norm()) * direction;
    yaw += std::clamp(std::remainder(std::atan2(direction.y(), direction.x()) - yaw, 2 * M_PI),
                      -2.5 * dt, 2.5 * dt);
    swing += dt;
    body = standing_body(feet, yaw, 1.7);
    const Vector3 forth = 0.15 * std::sin(4 * swing) * direction;
    for (BodyJoint& joint : body) {
      if (joint.name == "r_hand" || joint.name == "r_wrist") joint.position += forth;
      if (joint.name == "l_hand" || joint.name == "l_wrist") joint.position -= forth;
    }
  }
};

/// Injected faults of the sources in a run.
struct Trouble {
  double dropped{}, missed_joint{}, jumped{}, swapped{}, renamed{}, late{}, old{}, repeated{};
  std::vector<std::pair<double, double>> gaps{};
};

/// Returns the horizontal distance of a torso to the occupied volume, less its possible motion; the
/// age of the volume counts as in the guard.
double missing(const HumanState& state, const Vector3& torso, double moved) {
  double min_distance = 1e9;
  for (const Person& person : state.people) {
    const Vector3 there =
        person.joints.at(static_cast<std::size_t>(body_joint_index("torso"))).position - torso;
    min_distance = std::min(min_distance, std::hypot(there.x(), there.y()) - person.inflation -
                                              (person.inflation > 0 ? 0 : kWalk * person.age));
  }
  return min_distance - moved;
}

double missing_joint(const HumanState& state, const BodyJoint& joint) {
  double min_distance = 1e9;
  for (const Person& person : state.people) {
    const double d =
        (person.joints.at(static_cast<std::size_t>(body_joint_index(joint.name))).position -
         joint.position)
            .norm();
    min_distance = std::min(min_distance, d - person.inflation - 2.5 * person.age);
  }
  return min_distance;
}

struct Source {
  std::string name;
  Coverage coverage;
  double rate{}, latency{}, phase{};
  std::deque<std::pair<double, HumanObservation>> on_the_way;  // by time of arrival [s]
  double next{};
  int swap_until{};
};

void play(unsigned seed, const Trouble& trouble, int sources, bool whole_bodies) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> noise(0, kNoise);
  const auto happens = [&](double share) { return unit(random) < share; };
  auto settings = settings::read_spark_settings(std::filesystem::path(HANDSEL_SOURCE_DIR) /
                                                "deploy/config/spark.txtpb");
  PeopleTracker tracker(settings);

  const Coverage room{{-3, -3, -0.5}, {3, 3, 2.6}}, walked{{-2.3, -2.3, 0}, {2.3, 2.3, 0}},
      reach{{-1, -1, 0.1}, {1, 1, 1.9}};
  std::vector<Source> observers;
  for (int i = 0; i < sources; ++i) {  // each of two observes half of the room and a strip more
    Source source{"source" + std::to_string(i),
                  room,
                  15 + 15 * unit(random),
                  0.01 + 0.04 * unit(random),
                  0.03 * unit(random),
                  {},
                  0,
                  0};
    if (sources == 2)
      (i == 0 ? source.coverage.high : source.coverage.low).x() = i == 0 ? 0.4 : -0.4;
    source.next = source.phase;
    observers.push_back(source);
  }
  std::vector<TruePerson> people(1 + seed % 2);
  for (std::size_t i = 0; i < people.size(); ++i) {
    people[i].feet = people[i].goal = Vector3(i == 0 ? 1.5 : -1.5, 0.5, 0);
    people[i].walk(0.001, random, walked);
  }

  struct Raw {
    double arrival, measured;
    Vector3 torso;
  };
  std::deque<Raw> raw;
  bool seen_once = false;
  const double dt = 0.01;
  for (double t = 0; t < 12; t += dt) {
    for (TruePerson& person : people) {
      const Vector3 before = person.feet;
      person.walk(dt, random, walked);
      for (const TruePerson& other : people)  // people keep a distance from each other
        if (&other != &person && (other.feet - person.feet).head<2>().norm() < 0.9)
          person.feet = before;
      person.body = standing_body(person.feet, person.yaw, 1.7);
    }
    for (Source& source : observers) {
      if (t < source.next) continue;
      source.next += 1 / source.rate;
      const bool gap = std::any_of(trouble.gaps.begin(), trouble.gaps.end(),
                                   [&](const auto& g) { return t > g.first && t < g.second; });
      if (gap || happens(trouble.dropped)) continue;
      HumanObservation observation;
      observation.source = source.name;
      observation.stamp = static_cast<Stamp>(1e9 * t);
      observation.coverage = source.coverage;
      source.swap_until = happens(trouble.swapped) ? 5 : source.swap_until - 1;
      for (std::size_t i = 0; i < people.size(); ++i) {
        if (!contains(source.coverage, people[i].feet, 0)) continue;
        const std::size_t called = source.swap_until > 0 ? people.size() - 1 - i : i;
        ObservedPerson body{
            "b" + std::to_string(happens(trouble.renamed) ? 50 + random() % 50 : called),
            {},
            false};
        const bool jumps = t > 1 && happens(trouble.jumped);
        const double angle = 2 * M_PI * unit(random), far = jumps ? 0.2 + 2 * unit(random) : 0;
        for (const BodyJoint& joint : people[i].body) {
          if (!whole_bodies && happens(trouble.missed_joint) && joint.name != "torso") continue;
          body.joints.push_back({joint.name,
                                 joint.position +
                                     Vector3(noise(random), noise(random), noise(random)) +
                                     far * Vector3(std::cos(angle), std::sin(angle), 0),
                                 0.3 + 0.7 * unit(random)});
        }
        observation.people.push_back(std::move(body));
      }
      const double late = source.latency + (happens(trouble.late) ? 0.1 * unit(random) : 0);
      source.on_the_way.emplace_back(t + late, observation);
      if (happens(trouble.repeated)) source.on_the_way.emplace_back(t + late + 0.005, observation);
      std::sort(source.on_the_way.begin(), source.on_the_way.end(),
                [](const auto& a, const auto& b) { return a.first < b.first; });
    }
    for (Source& source : observers)
      for (; !source.on_the_way.empty() && source.on_the_way.front().first <= t;
           source.on_the_way.pop_front()) {
        const HumanObservation& observation = source.on_the_way.front().second;
        const double was = source.on_the_way.front().first -
                           source.latency;  // a late observation is assumed as old as the others
        tracker.observe(observation, at(was));
        if (happens(trouble.old)) {
          HumanObservation past = observation;
          for (ObservedPerson& person : past.people)
            for (ObservedJoint& joint : person.joints) joint.position.x() += 1;
          tracker.observe(past, at(was - 1));
        }
        for (const ObservedPerson& person : observation.people)
          for (const ObservedJoint& joint : person.joints)
            if (joint.name == "torso")
              raw.push_back({t, 1e-9 * static_cast<double>(observation.stamp), joint.position});
        seen_once = seen_once || !observation.people.empty();
      }
    while (!raw.empty() && raw.front().arrival < t - kHold) raw.pop_front();
    if (!seen_once || t < 0.5) continue;
    const HumanState state = tracker.state(at(t), reach);
    for (std::size_t i = 0; i < people.size(); ++i) {
      const Vector3 torso =
          people[i].body[static_cast<std::size_t>(body_joint_index("torso"))].position;
      // A wrong jump shorter than a person's motion between two samples cannot be detected.
      const double believed = trouble.jumped > 0 ? 0.15 * kRun : 0;
      ASSERT_LE(missing(state, torso, 0.1 * kWalk + believed), kSlack)
          << "person " << i << " is missing at " << t << " s";
      if (!whole_bodies || trouble.jumped > 0) continue;
      for (const BodyJoint& joint : people[i].body)
        ASSERT_LE(missing_joint(state, joint), 3 * kSlack)
            << joint.name << " of person " << i << " at " << t << " s";
    }
    for (const Raw& place : raw)
      ASSERT_LE(missing(state, place.torso, kRun * (t - place.measured)), kSlack)
          << "seen at " << place.arrival << " s, given up at " << t << " s";
  }
}

class Sources : public ::testing::Test {
 protected:
  void run(const Trouble& trouble, int sources = 1, bool whole_bodies = true) {
    const char* asked = std::getenv("HANDSEL_RUNS");
    const unsigned runs = asked ? static_cast<unsigned>(std::atoi(asked)) : 6;
    std::printf("seeds 1 to %u\n", runs);
    for (unsigned seed = 1; seed <= runs && !HasFatalFailure(); ++seed)
      play(seed, trouble, sources, whole_bodies);
  }
};

TEST_F(Sources, of_good_quality_keep_each_person) { run({}); }
TEST_F(Sources, that_drop_samples) { run({.dropped = 0.4}); }
TEST_F(Sources, that_fall_silent_for_a_while) { run({.gaps = {{2, 2.4}, {4, 5.5}, {8, 11}}}); }
TEST_F(Sources, that_jump) { run({.jumped = 0.05}); }
TEST_F(Sources, that_exchange_identities) { run({.swapped = 0.1}); }
TEST_F(Sources, that_rename_everybody) { run({.renamed = 0.5}); }
TEST_F(Sources, that_are_late) { run({.late = 0.3}); }
TEST_F(Sources, that_tell_of_the_past) { run({.old = 0.2}); }
TEST_F(Sources, that_repeat_themselves) { run({.repeated = 0.3}); }
TEST_F(Sources, that_see_any_part_of_a_body) { run({.missed_joint = 0.5}, 1, false); }
TEST_F(Sources, that_hand_people_over) { run({}, 2); }
TEST_F(Sources, that_hand_people_over_and_are_bad) {
  run({.dropped = 0.2,
       .missed_joint = 0.3,
       .jumped = 0.02,
       .swapped = 0.05,
       .renamed = 0.1,
       .late = 0.1,
       .old = 0.05,
       .repeated = 0.05,
       .gaps = {{3, 3.5}, {6, 8}}},
      2, false);
}

}  // namespace
}  // namespace handsel::spark::people_tracker_test
