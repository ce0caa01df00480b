// SPDX-License-Identifier: Apache-2.0
// The facts of simulated handovers against the simulator's ground truth, in lock-step.
// HANDSEL_RUNS: number of seeds (3).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "common/config/resources.hpp"
#include "common/messages/names.hpp"
#include "common/model/human/human_body.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"

namespace handsel::facts_truth_test {
namespace {

constexpr double kAgree = 0.2;         // max difference of times [s]
constexpr double kRounding = 1e-9;     // rounding error of multiples of 20 ms [s]
constexpr double kOffTheTable = 0.01;  // min height above the table of a lifted object [m]

struct Steps {
  std::optional<double> lifted, reaches, taken, released;  // [s]
};

/// Records the true events, from the true body and the true holder of the object.
class Truth {
 public:
  void see(const GroundTruth& ground_truth) {
    const double t = ground_truth.sim_time;
    if (ground_truth.carrier == "robot" && ground_truth.lifted > kOffTheTable && !steps.lifted)
      steps.lifted = t;
    if (ground_truth.carrier == "both" && !steps.taken) steps.taken = t;
    if (ground_truth.carrier == "human" && steps.lifted && !steps.released) steps.released = t;
    const auto place = [&](const char* joint) {
      return ground_truth.person.at(static_cast<std::size_t>(body_joint_index(joint))).position;
    };
    if (ground_truth.person.size() == kBodyJoints.size() && t > last_) {
      const Vector3 object = ground_truth.T_world_object.translation();
      for (const char* hand : {"l_hand", "r_hand"}) {
        const Vector3 from_torso = place(hand) - place("torso");
        const Vector3 velocity = last_ > 0 ? Vector3((from_torso - before_[hand]) / (t - last_))
                                           : Vector3(Vector3::Zero());
        before_[hand] = from_torso;
        const double toward = velocity.dot((object - place(hand)).normalized());
        if (toward > 0.12 && steps.lifted && !steps.reaches) steps.reaches = t;
      }
      last_ = t;
    }
  }
  Steps steps;

 private:
  double last_{-1};
  std::map<std::string, Vector3> before_;
};

/// Records the facts of SPARK.
class Told {
 public:
  void hear(const Facts& facts, double t, const std::string& object) {
    std::map<std::string, int> now;
    for (const Fact& fact : facts.facts) {
      const bool of_object = fact.subject == object || fact.object == object;
      if (of_object &&
          ++now[std::string(name(fact.kind)) + " " + fact.subject + " " + fact.object] > 1)
        ++doubled;
      if (!of_object) continue;
      if (fact.kind == FactKind::held_by_robot && !steps.lifted) steps.lifted = t;
      if (fact.kind == FactKind::reaching && steps.lifted && !steps.reaches) steps.reaches = t;
      if (fact.kind == FactKind::released && fact.object == kRobotName && !steps.released)
        steps.released = t;
    }
    for (const auto& [fact, count] : now)
      if (!before_.count(fact)) ++begun[fact];
    before_ = now;
  }
  Steps steps;
  std::map<std::string, int> begun;  // number of begins of each fact
  int doubled{};

 private:
  std::map<std::string, int> before_;
};

/// Hands as SPARK expected them, beside where they went.
class Expected {
 public:
  void hear(const HumanState& people, double t) {
    for (const Person& person : people.people)
      for (const HandPrediction& hand : person.hands) {
        const auto joint = static_cast<std::size_t>(body_joint_index(hand.joint));
        for (const HandAhead& ahead : hand.ahead)
          open_.push_back({t + ahead.time, joint, ahead, person.joints.at(joint)});
      }
  }
  void see(const GroundTruth& ground_truth) {
    const double t = ground_truth.sim_time;
    if (ground_truth.person.size() != kBodyJoints.size()) return;
    std::erase_if(open_, [&](const Open& one) {
      if (one.due > t) return false;
      if (one.due < before_ || last_.size() != ground_truth.person.size()) return true;
      const double share = (one.due - before_) / std::max(1e-9, t - before_);
      const Vector3 is =
          (1 - share) * last_[one.joint].position + share * ground_truth.person[one.joint].position;
      const double error = (one.ahead.position - is).norm();
      Sum& sum = sums_[static_cast<int>(std::lround(10 * one.ahead.time))];
      ++sum.count;
      sum.inside += error <= one.ahead.uncertainty;
      sum.ours += error * error;
      sum.stays += (one.now.position - is).squaredNorm();
      sum.goes_on += (one.now.position + one.ahead.time * one.now.velocity - is).squaredNorm();
      return true;
    });
    last_ = ground_truth.person;
    before_ = t;
  }
  void judge() const {
    ASSERT_FALSE(sums_.empty());
    for (const auto& [tenths, sum] : sums_) {
      const auto rms = [&](double squares) { return 1e3 * std::sqrt(squares / sum.count); };
      std::printf(
          "hands %.1f s ahead: %.0f mm, stays %.0f, goes on %.0f; in the ball %.1f %% of %d\n",
          0.1 * tenths, rms(sum.ours), rms(sum.stays), rms(sum.goes_on),
          100.0 * sum.inside / sum.count, sum.count);
      EXPECT_GE(sum.inside, 0.95 * sum.count) << tenths;
      EXPECT_LT(sum.ours, sum.stays) << tenths;
      EXPECT_LT(sum.ours, 1.1 * sum.goes_on) << tenths;
    }
  }

 private:
  struct Open {
    double due;
    std::size_t joint;
    HandAhead ahead;
    BodyJoint now;
  };
  struct Sum {
    int count{}, inside{};
    double ours{}, stays{}, goes_on{};
  };
  std::vector<Open> open_;
  std::vector<BodyJoint> last_;
  double before_{1e9};
  std::map<int, Sum> sums_;
};

TEST(SimulatedHandovers, facts_agree_with_the_truth) {
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int runs = asked ? std::atoi(asked) : 3;
  int handed_over = 0;
  Expected hands;
  for (int seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    config::Scenario scenario;
    load_text_proto(scenario_file("give_mug"), scenario);
    LockstepSystem system("give_mug", "", static_cast<std::uint64_t>(seed));
    Truth ground_truth;
    Told told;
    double sim_time = 0;
    TimePoint sim_at{};
    std::string object;
    system.bus().subscribe<GroundTruth>([&](const GroundTruth& sample, const Receipt&) {
      ground_truth.see(sample);
      sim_time = sample.sim_time;
      sim_at = system.now();
      hands.see(sample);
      object = sample.object;
    });
    system.bus().subscribe<Facts>(
        [&](const Facts& facts, const Receipt&) { told.hear(facts, sim_time, object); });
    system.bus().subscribe<HumanState>([&](const HumanState& people, const Receipt&) {
      hands.hear(people, sim_time + to_seconds(system.now() - sim_at));
    });
    bool ready = false;
    Performer performer(system.bus(), system.observer(), scenario, 0, [&] {
      return ready = ready || not_ready(system.snapshot(), false).empty();
    });
    system.network().run_until([&] { return performer.finished(); },
                               system.now() + std::chrono::minutes(3));
    ASSERT_TRUE(performer.finished());
    if (!performer.succeeded()) continue;
    ++handed_over;

    const auto compare = [&](const char* what, const std::optional<double>& is,
                             const std::optional<double>& said) {
      ASSERT_TRUE(is) << what << " did not happen";
      ASSERT_TRUE(said) << what << " was not told";
      EXPECT_NEAR(*said, *is, kAgree + kRounding) << what;
      std::printf("seed %2d  %-8s true %.2f s, told %.2f s\n", seed, what, *is, *said);
    };
    compare("lifted", ground_truth.steps.lifted, told.steps.lifted);
    compare("reaches", ground_truth.steps.reaches, told.steps.reaches);
    compare("released", ground_truth.steps.released, told.steps.released);
    EXPECT_EQ(told.doubled, 0);
    EXPECT_EQ(told.begun["held_by_robot " + object + " "], 1) << "flicker";
    EXPECT_EQ(told.begun["held_by_human " + object + " anna"], 1) << "flicker";
    EXPECT_EQ(told.begun["released " + object + " robot"], 1) << "a false release, or flicker";
  }
  hands.judge();
  EXPECT_GE(handed_over, runs * 9 / 10) << "too few handovers to judge facts by";
}

}  // namespace
}  // namespace handsel::facts_truth_test
