// SPDX-License-Identifier: Apache-2.0
// Hand predictions of SPARK against the true motion: recorded motions, observed at 30 Hz with
// noise. Baselines: a hand at rest, and a hand with the constant velocity that SPARK reports.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "common/config/resources.hpp"
#include "components/spark/people/people_tracker.hpp"
#include "sim/recordings/recording.hpp"
#include "tests/support/recorded_handover.hpp"

namespace handsel::spark::hand_prediction_test {
namespace {

namespace fs = std::filesystem;

constexpr double kNoise = 0.01;  // noise of a joint [m]
constexpr double kRate = 30;     // sample rate [Hz]
constexpr std::size_t kAheads = 5;

TimePoint at(double t) { return TimePoint(from_seconds(t)); }

/// Joint positions over time.
struct Motion {
  std::string name;
  double rate{};
  std::vector<std::map<std::string, Vector3>> frames;
  double duration() const { return static_cast<double>(frames.size() - 1) / rate; }
  Vector3 where(const std::string& joint, double t) const {
    const auto i = std::min(static_cast<std::size_t>(t * rate), frames.size() - 2);
    const double share = t * rate - static_cast<double>(i);
    return (1 - share) * frames[i].at(joint) + share * frames[i + 1].at(joint);
  }
};

/// Sums of squares by horizon.
struct Errors {
  std::array<double, kAheads> ours{}, stays{}, goes_on{}, radius{};
  std::array<int, kAheads> inside{}, count{};
  void add(const Errors& o) {
    for (std::size_t k = 0; k < kAheads; ++k) {
      ours[k] += o.ours[k], stays[k] += o.stays[k], goes_on[k] += o.goes_on[k],
          radius[k] += o.radius[k];
      inside[k] += o.inside[k], count[k] += o.count[k];
    }
  }
  double rms(const std::array<double, kAheads>& squares, std::size_t k) const {
    return std::sqrt(squares[k] / std::max(1, count[k]));
  }
  double share(std::size_t k) const {
    return static_cast<double>(inside[k]) / std::max(1, count[k]);
  }
  void print(const std::string& name) const {
    for (std::size_t k = 0; k < kAheads; ++k)
      if (count[k] > 0)
        std::printf(
            "%-16s %.1f s: %3.0f mm, stays %3.0f, goes on %3.0f; inside %5.1f %% of balls of %3.0f "
            "mm (%d)\n",
            name.c_str(), 0.1 * static_cast<double>(k + 1), 1e3 * rms(ours, k), 1e3 * rms(stays, k),
            1e3 * rms(goes_on, k), 100 * share(k), 1e3 * radius[k] / count[k], count[k]);
  }
};

Errors follow(const Motion& motion, unsigned seed) {
  auto settings =
      settings::read_spark_settings(fs::path(HANDSEL_SOURCE_DIR) / "deploy/config/spark.txtpb");
  PeopleTracker tracker(settings);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, kNoise);
  Errors out;
  for (int look = 0; look / kRate <= motion.duration(); ++look) {
    const double t = look / kRate;
    HumanObservation observation;
    observation.source = "camera";
    observation.coverage = {{-9, -9, -9}, {9, 9, 9}};
    observation.people.push_back({"1", {}, false});
    for (const auto& [joint, unused] : motion.frames.front())
      observation.people[0].joints.push_back(
          {joint, motion.where(joint, t) + Vector3(noise(random), noise(random), noise(random)),
           1.0});
    tracker.observe(observation, at(t));
    if (look < 8) continue;
    const HumanState state = tracker.state(at(t), {});
    for (const HandPrediction& hand : state.people.at(0).hands) {
      const BodyJoint& now =
          state.people[0].joints.at(static_cast<std::size_t>(body_joint_index(hand.joint)));
      for (std::size_t k = 0; k < hand.ahead.size(); ++k) {
        const HandAhead& ahead = hand.ahead[k];
        if (t + ahead.time > motion.duration()) continue;
        const Vector3 ground_truth = motion.where(hand.joint, t + ahead.time);
        const double error = (ahead.position - ground_truth).norm();
        out.ours[k] += error * error;
        out.stays[k] += (now.position - ground_truth).squaredNorm();
        out.goes_on[k] += (now.position + ahead.time * now.velocity - ground_truth).squaredNorm();
        out.radius[k] += ahead.uncertainty;
        out.inside[k] += error <= ahead.uncertainty;
        ++out.count[k];
      }
    }
  }
  return out;
}

std::vector<Motion> both_of(const test::RecordedHandover& recorded) {
  std::vector<Motion> out;
  for (const auto& [who, joints] : recorded.bodies) {
    Motion motion{who, 120, std::vector<std::map<std::string, Vector3>>(recorded.baton.size())};
    for (const auto& [joint, rows] : joints)
      for (std::size_t i = 0; i < motion.frames.size(); ++i)
        motion.frames[i][joint] = test::place(rows[i]);
    out.push_back(std::move(motion));
  }
  return out;
}

std::vector<Motion> other_motions(const fs::path& folder) {
  std::vector<Motion> out;
  for (const auto& file : fs::directory_iterator(folder)) {
    if (file.path().extension() != ".bvh") continue;
    try {
      const sim::Recording recording = sim::load_recording(file.path());
      if (recording.duration() < 2) continue;
      Motion motion{file.path().stem(), recording.rate, {}};
      for (const sim::BodyPoints& points : recording.frames) {
        motion.frames.emplace_back();
        for (std::size_t i = 0; i < points.size(); ++i)
          motion.frames.back()[kBodyJoints[i]] = points[i];
      }
      out.push_back(std::move(motion));
    } catch (const std::exception&) {  // one file contains a single pose
    }
  }
  return out;
}

TEST(HandPrediction, on_a_recorded_handover_it_beats_both_baselines) {
  const auto recorded = test::recorded_handover();
  if (!recorded) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const std::vector<Motion> motions = both_of(*recorded);
  ASSERT_EQ(motions.size(), 2u);
  Errors all;
  for (unsigned seed = 1; seed <= 3; ++seed)
    for (const Motion& motion : motions) all.add(follow(motion, seed));
  all.print("handover");
  for (std::size_t k = 1; k < kAheads; ++k) {
    EXPECT_LT(all.rms(all.ours, k), 0.95 * all.rms(all.stays, k)) << k;
    EXPECT_LT(all.rms(all.ours, k), 0.95 * all.rms(all.goes_on, k)) << k;
    EXPECT_GE(all.share(k), 0.95) << k;
  }
}

TEST(HandPrediction, on_recorded_walks_and_dances_the_balls_hold_the_hands) {
  const auto folder = test::reference_data("motion/bvh");
  if (!folder) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const std::vector<Motion> motions = other_motions(*folder);
  ASSERT_FALSE(motions.empty()) << "none of the recordings in " << *folder << " was read";
  Errors all;
  for (const Motion& motion : motions) {
    const Errors one = follow(motion, 1);
    one.print(motion.name);
    all.add(one);
  }
  all.print("all of them");
  for (std::size_t k = 0; k < kAheads; ++k) {
    EXPECT_GE(all.share(k), 0.95) << k;
    EXPECT_LT(all.rms(all.ours, k), all.rms(all.goes_on, k)) << k;
  }
}

/// Seeded minimum-jerk reaches of random length and duration, by an independent formula.
TEST(HandPrediction, on_random_reaches_it_beats_both_baselines_and_grows_with_time) {
  std::mt19937 random(20261121);
  std::printf("seed 20261121\n");
  std::uniform_real_distribution<double> unit(0, 1);
  Errors all;
  for (int run = 0; run < 20; ++run) {
    const double length = 0.2 + 0.4 * unit(random), time = 0.5 + 0.7 * unit(random),
                 start = 0.6 + unit(random);
    const Vector3 way =
        length * Vector3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5).normalized();
    Motion motion{"reach", 120, {}};
    for (int i = 0; i < 360; ++i) {
      const double s = std::clamp((i / 120.0 - start) / time, 0.0, 1.0),
                   bell = s * s * s * (10 - 15 * s + 6 * s * s);
      motion.frames.emplace_back();
      for (const BodyJoint& joint : standing_body({1, 0, 0}, 3, 1.75))
        motion.frames.back()[joint.name] = joint.position;
      motion.frames.back()["r_hand"] += bell * way;
      motion.frames.back()["r_wrist"] += bell * way;
    }
    all.add(follow(motion, static_cast<unsigned>(run)));
  }
  all.print("reaches");
  for (std::size_t k = 0; k < kAheads; ++k) {
    EXPECT_GE(all.share(k), 0.95) << k;
    if (k > 0) {
      EXPECT_LT(all.rms(all.ours, k), all.rms(all.goes_on, k)) << k;
      EXPECT_LT(all.rms(all.ours, k), all.rms(all.stays, k)) << k;
      EXPECT_GT(all.radius[k] / all.count[k], all.radius[k - 1] / all.count[k - 1]) << k;
    }
  }
}

TEST(HandPrediction, a_hand_out_of_sight_grows_and_a_lost_person_has_none) {
  auto settings =
      settings::read_spark_settings(fs::path(HANDSEL_SOURCE_DIR) / "deploy/config/spark.txtpb");
  PeopleTracker tracker(settings);
  double before = 0;
  for (int look = 0; look < 90; ++look) {
    HumanObservation observation;
    observation.source = "camera";
    observation.people.push_back({"1", {}, false});
    for (const BodyJoint& joint : standing_body({1, 0, 0}, 3, 1.75))
      if (look < 30 || joint.name.substr(0, 2) != "r_")
        observation.people[0].joints.push_back(
            {joint.name, joint.position + Vector3(0, 0, 1e-4 * (look % 2)), 1.0});
    tracker.observe(observation, at(look / kRate));
    const HumanState state = tracker.state(at(look / kRate), {});
    ASSERT_EQ(state.people.at(0).hands.size(), 2u) << look;
    const double now = state.people[0].hands[1].ahead.at(0).uncertainty;
    EXPECT_TRUE(look <= 30 || look >= 50 || now > before) << look;
    EXPECT_LT(now, 3.0) << "the arm is only so long";
    before = now;
  }
  EXPECT_TRUE(tracker.state(at(5), {}).people.at(0).hands.empty());
}

}  // namespace
}  // namespace handsel::spark::hand_prediction_test
