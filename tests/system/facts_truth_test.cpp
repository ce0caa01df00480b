// The facts of simulated handovers beside the simulator's truth, in lock-step. HANDSEL_RUNS: how many seeds (3).
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <optional>

#include "common/config/resources.hpp"
#include "common/messages/names.hpp"
#include "common/model/human_body.hpp"
#include "deploy/handsel/lockstep_system.hpp"
#include "deploy/handsel/performer.hpp"
#include "deploy/handsel/system.hpp"

namespace handsel {
namespace {

constexpr double kAgree = 0.2;         // [s]
constexpr double kOffTheTable = 0.01;  // [m]

struct Steps {
  std::optional<double> lifted, reaches, taken, released;  // [s]
};

/// What truly happened, from the true body and from who truly carries the object.
class Truth {
 public:
  void see(const GroundTruth& truth) {
    const double t = truth.sim_time;
    if (truth.carrier == "robot" && truth.lifted > kOffTheTable && !steps.lifted) steps.lifted = t;
    if (truth.carrier == "both" && !steps.taken) steps.taken = t;
    if (truth.carrier == "human" && steps.lifted && !steps.released) steps.released = t;
    const auto place = [&](const char* joint) { return truth.person.at(static_cast<std::size_t>(body_joint_index(joint))).position; };
    if (truth.person.size() == kBodyJoints.size() && t > last_) {
      const Vector3 object = truth.T_world_object.translation();
      for (const char* hand : {"l_hand", "r_hand"}) {
        const Vector3 from_torso = place(hand) - place("torso");
        const Vector3 velocity = last_ > 0 ? Vector3((from_torso - before_[hand]) / (t - last_)) : Vector3(Vector3::Zero());
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

/// What SPARK said.
class Told {
 public:
  void hear(const Facts& facts, double t, const std::string& object) {
    std::map<std::string, int> now;
    for (const Fact& fact : facts.facts) {
      const bool of_object = fact.subject == object || fact.object == object;
      if (of_object && ++now[std::string(name(fact.kind)) + " " + fact.subject + " " + fact.object] > 1) ++doubled;
      if (!of_object) continue;
      if (fact.kind == FactKind::held_by_robot && !steps.lifted) steps.lifted = t;
      if (fact.kind == FactKind::reaching && steps.lifted && !steps.reaches) steps.reaches = t;
      if (fact.kind == FactKind::released && fact.object == kRobotName && !steps.released) steps.released = t;
    }
    for (const auto& [fact, count] : now)
      if (!before_.count(fact)) ++begun[fact];
    before_ = now;
  }
  Steps steps;
  std::map<std::string, int> begun;  // how often each fact began
  int doubled{};

 private:
  std::map<std::string, int> before_;
};

TEST(SimulatedHandovers, FactsAgreeWithTheTruth) {
  const char* asked = std::getenv("HANDSEL_RUNS");
  const int runs = asked ? std::atoi(asked) : 3;
  int handed_over = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    config::Scenario scenario;
    load_text_proto(scenario_file("give_mug"), scenario);
    LockstepSystem system("give_mug", "", static_cast<std::uint64_t>(seed));
    Truth truth;
    Told told;
    double sim_time = 0;
    std::string object;
    system.seat().subscribe<GroundTruth>([&](const GroundTruth& sample, const Receipt&) {
      truth.see(sample);
      sim_time = sample.sim_time;
      object = sample.object;
    });
    system.seat().subscribe<Facts>([&](const Facts& facts, const Receipt&) { told.hear(facts, sim_time, object); });
    bool ready = false;
    Performer performer(system.seat(), system.observer(), scenario, 0,
                        [&] { return ready = ready || not_ready(system.snapshot(), false).empty(); });
    system.network().run_until([&] { return performer.finished(); }, system.now() + std::chrono::minutes(3));
    ASSERT_TRUE(performer.finished());
    if (!performer.succeeded()) continue;
    ++handed_over;

    const auto compare = [&](const char* what, const std::optional<double>& is, const std::optional<double>& said) {
      ASSERT_TRUE(is) << what << " did not happen";
      ASSERT_TRUE(said) << what << " was not told";
      EXPECT_NEAR(*said, *is, kAgree) << what;
      std::printf("seed %2d  %-8s true %.2f s, told %.2f s\n", seed, what, *is, *said);
    };
    compare("lifted", truth.steps.lifted, told.steps.lifted);
    compare("reaches", truth.steps.reaches, told.steps.reaches);
    compare("released", truth.steps.released, told.steps.released);
    EXPECT_EQ(told.doubled, 0);
    EXPECT_EQ(told.begun["held_by_robot " + object + " "], 1) << "flicker";
    EXPECT_EQ(told.begun["held_by_human " + object + " anna"], 1) << "flicker";
    EXPECT_EQ(told.begun["released " + object + " robot"], 1) << "a false release, or flicker";
  }
  EXPECT_GE(handed_over, runs * 9 / 10) << "too few handovers to judge facts by";
}

}  // namespace
}  // namespace handsel
