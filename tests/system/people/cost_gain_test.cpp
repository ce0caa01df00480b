// SPDX-License-Identifier: Apache-2.0
// The attentional gain of the human-aware costs reaches the planners: near a person the same motion
// becomes slower and paths keep a larger clearance. The whole system in lock-step, twice with the
// same person, once with the gain 1.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>

#include "common/cost/cost_settings.hpp"
#include "common/cost/human_cost.hpp"
#include "common/trajectory/limits_check.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/edited_settings.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::cost_gain_test {
namespace {

constexpr const char* kScenario = R"(name: "beside"
robot: "jido"
people { id: "anna" x: 1.1 y: -0.25 yaw: 3.1416 stature: 1.72 behaviour: STILL }
human_sensors { source: "kinect" rate: 30 latency: 0.04 noise: 0 }
object_sensors { source: "object_tracker" rate: 30 latency: 0.04 noise: 0 }
)";

/// The system beside a near person at rest, with one gain.
class Beside {
 public:
  explicit Beside(const std::string& gain)
      : context_(system_context(folder_.write("beside.txtpb", kScenario).string(), "", 1,
                                edited(settings_, gain))),
        system_(context_),
        trajectories_(system_.bus().advertise<TrajectoryRequest>()),
        paths_(system_.bus().advertise<PathRequest>()) {
    Bus& seat = system_.bus();
    seat.subscribe<TrajectoryReply>(
        [this](const TrajectoryReply& m, const Receipt&) { trajectory_ = m; });
    seat.subscribe<PathReply>([this](const PathReply& m, const Receipt&) { path_ = m; });
    seat.subscribe<AttentionAdvice>(
        [this](const AttentionAdvice& m, const Receipt&) { gain_ = m.cost_gain; });
    seat.subscribe<Costmap>([this](const Costmap& m, const Receipt& r) {
      layers_.put(m, r.arrival - r.age, r.arrival);
    });
    seat.subscribe<Scene>([this](const Scene& m, const Receipt&) { scene_ = m; });
    seat.subscribe<HumanState>([this](const HumanState& m, const Receipt&) { people_ = m; });
    run([&] { return not_ready(system_.snapshot(), false).empty(); }, 10);
    run([] { return false; }, 1);
  }
  double gain() const { return gain_; }
  /// Returns the max velocity of a motion forward as a ratio to the comfort limits.
  double velocity_forward() {
    TrajectoryRequest request;
    request.id = {77, 1};
    request.group = "arm";
    request.start = robot().rest_configuration();
    request.nodes = {RobotModel::part(request.start, arm()), forward(0.9, 0.7)};
    trajectories_->publish(request);
    run([&] { return !trajectory_.axes.empty(); }, 10);
    EXPECT_TRUE(trajectory_.solved) << trajectory_.reason;
    double velocity = 0;
    for (std::size_t i = 0; i < trajectory_.axes.size(); ++i)
      velocity = std::max(velocity, extremes(trajectory_.trajectory.axes[i]).velocity /
                                        robot().comfort_limits().velocity[trajectory_.axes[i]]);
    return velocity;
  }
  /// Returns the integral of the human-aware cost along a path, without the gain, above the
  /// unavoidable cost of the cheaper end; nullopt: the goal is infeasible.
  std::optional<double> cost_of_path_forward(std::uint64_t seed) {
    PathRequest request;
    request.id = {78, seed};
    request.group = "arm";
    request.start = robot().rest_configuration();
    request.goals = {forward(-1.5 + 0.2 * static_cast<double>(seed), 0.5 - 0.1 * (seed % 6))};
    request.seed = seed;
    path_ = {};
    paths_->publish(request);
    run([&] { return path_.id.number == seed; }, 10);
    if (!path_.solved) return std::nullopt;
    HumanCost cost(robot(), load_cost_settings(context_.settings));
    cost.set_layers(layers_.at(system_.now()));
    cost.set_people(people_);
    cost.set_base(scene_.T_world_base);
    const auto cost_at = [&](const Vector& joints) {
      return cost(RobotModel::with(request.start, arm(), joints));
    };
    const double level = std::min(cost_at(path_.path.front()), cost_at(path_.path.back()));
    double sum = 0, length = 0;
    constexpr int kParts = 40;
    for (std::size_t i = 1; i < path_.path.size(); ++i) {
      const Vector step = (path_.path[i] - path_.path[i - 1]) / kParts;
      for (int k = 0; k < kParts; ++k)
        sum += std::max(0.0, cost_at(path_.path[i - 1] + (k + 0.5) * step) - level) * step.norm();
      length += kParts * step.norm();
    }
    length_ += length;
    return sum;
  }
  double length() const { return length_; }  ///< of all paths [rad]

 private:
  static std::filesystem::path edited(test::EditedSettings& settings, const std::string& gain) {
    settings.set("attention.txtpb", "near_cost_gain", gain);
    return settings.folder();
  }
  const RobotModel& robot() const { return *context_.robot; }
  const Group& arm() const { return robot().require_group("arm"); }
  Vector forward(double turned, double lowered) const {
    Vector to = RobotModel::part(robot().rest_configuration(), arm());
    to[0] += turned;
    to[1] += lowered;
    return to;
  }
  template <class Done>
  void run(const Done& done, double seconds) {
    system_.network().run_until(done, system_.now() + from_seconds(seconds));
  }

  test::TemporaryFolder folder_;
  test::EditedSettings settings_;
  NodeContext context_;
  LockstepSystem system_;
  std::unique_ptr<Publisher<TrajectoryRequest>> trajectories_;
  std::unique_ptr<Publisher<PathRequest>> paths_;
  TrajectoryReply trajectory_;
  PathReply path_;
  HumanState people_;
  Scene scene_;
  CostLayers layers_;
  double gain_{}, length_{};
};

TEST(CostGain, makes_the_same_motion_near_a_person_gentler) {
  Beside plain("1"), raised("3");
  EXPECT_EQ(plain.gain(), 1);
  EXPECT_GT(raised.gain(), 2) << "attention does not ask for more beside a person";
  const double before = plain.velocity_forward(), after = raised.velocity_forward();
  std::printf("velocity %.3f of the comfort limits, with the gain %.3f\n", before, after);
  EXPECT_LT(after, 0.97 * before);
}

TEST(CostGain, leads_paths_where_people_find_them_better) {
  Beside plain("1"), raised("8");
  double before = 0, after = 0;
  int paths = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const std::optional<double> one = plain.cost_of_path_forward(seed),
                                other = raised.cost_of_path_forward(seed);
    ASSERT_EQ(one.has_value(), other.has_value());
    if (!one) continue;
    ++paths;
    before += *one;
    after += *other;
  }
  EXPECT_GE(paths, 4);
  std::printf("cost %.4f over %.2f rad, with the gain %.4f over %.2f rad\n", before, plain.length(),
              after, raised.length());
  EXPECT_LT(after, 0.98 * before);
  EXPECT_GT(raised.length(), plain.length());
}

}  // namespace
}  // namespace handsel::cost_gain_test
