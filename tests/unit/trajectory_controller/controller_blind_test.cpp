// SPDX-License-Identifier: Apache-2.0
// No arm moves blind: the arm does not enter a space without a live source, and without any live
// source the arm stops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/controller_expectations.hpp"
#include "tests/support/processes/live_view.hpp"

namespace handsel::trajectory_controller::controller_blind_test {
namespace {

using test::ControllerBench;
using test::has;
using ::testing::HasSubstr;

constexpr double kPeriodOfSamples = 0.034;  // max period of HumanState on the bench [s]

/// Checks that no link leaves the union of the observed spaces, by independent forward kinematics.
class BlindBench : public ControllerBench {
 public:
  explicit BlindBench(const ControllerSettings& with = {})
      : ControllerBench(with), capsules_(robot_capsules(*robot)) {}
  /// Coordinate k of the links that move, radii included: the largest [m].
  double farthest(Eigen::Index k) {
    std::vector<Pose> links;
    robot->forward(core.set_point().position, links);
    double out = -1e9;
    for (const LinkCapsule& c : capsules_) {
      if (robot->links()[static_cast<std::size_t>(c.link)].name == "base") continue;
      const Pose& T = links[static_cast<std::size_t>(c.link)];
      out = std::max({out, (T * c.a)[k] + c.radius, (T * c.b)[k] + c.radius});
    }
    return out;
  }
  /// Runs and returns the max coordinate k of the links at any time [m].
  double run_watching(double seconds, Eigen::Index k) {
    double out = -1e9;
    for (int i = 0; i < static_cast<int>(seconds / settings.period + 0.5); ++i) {
      tick();
      out = std::max(out, farthest(k));
    }
    return out;
  }
  void new_go() {
    ++go.epoch;
    run(0.3);
  }

 private:
  std::vector<LinkCapsule> capsules_;
};

const Vector kFar = ControllerBench::arm(1.5, 0.2, -0.3);  // rotation by 90 degrees to the left
constexpr double kEdge = 0.5;  // left boundary of the observed space [m]

SourceView view_up_to(double y) {
  SourceView view = test::live_view();
  view.high.y() = y;
  return view;
}

TEST(BlindController, stops_short_of_the_edge_along_its_path_and_goes_on_when_more_is_observed) {
  BlindBench b;
  b.people.views = {view_up_to(kEdge)};
  b.start();
  ASSERT_EQ(b.go_to(kFar, 1), "");
  const double reached = b.run_watching(8, 1);
  EXPECT_LT(reached, kEdge - b.settings.view.margin);
  EXPECT_GT(reached, kEdge - 0.35) << "it goes as far as it may";
  EXPECT_TRUE(b.at_rest()) << "and does not creep";
  EXPECT_EQ(b.core.speed_factor(), 0.0);
  EXPECT_EQ(b.core.mode(), Mode::slow) << "it stands on its path";
  EXPECT_TRUE(has(b, Cause::blind));
  EXPECT_THAT(b.core.status().reason, HasSubstr("blind: no live source observes where"));
  b.people.views = {test::live_view()};
  b.run(8);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
  EXPECT_EQ(b.core.unproven_set_points(), 0u);
  test::expect_smooth(b);
}

TEST(BlindController, what_nobody_reaches_need_not_be_observed) {
  constexpr double kTop = 1.0;  // top of the observed space, below parts of the arm [m]
  for (const double ceiling : {kTop, kTop + 0.5}) {
    ControllerSettings with;
    with.view.ceiling = ceiling;
    BlindBench b(with);
    b.people.views = {test::live_view()};
    b.people.views.front().high.z() = kTop;
    b.start();
    ASSERT_GT(b.farthest(2), kTop);
    b.go_to(kFar, 1);
    b.run(8);
    EXPECT_EQ(b.core.status().motion == MotionState::finished, ceiling == kTop);
    EXPECT_EQ(has(b, Cause::blind), ceiling > kTop);
  }
}

TEST(BlindController, views_that_meet_are_as_good_as_one) {
  BlindBench b;
  SourceView beyond = test::live_view();
  beyond.low.y() = kEdge;
  b.people.views = {view_up_to(kEdge), beyond};
  b.start();
  ASSERT_EQ(b.go_to(kFar, 1), "");
  b.run(8);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

TEST(BlindController, stops_as_fast_as_it_can_when_no_view_is_live_and_goes_on_when_one_is_back) {
  BlindBench b;
  b.start();
  ASSERT_EQ(b.go_to(kFar, 1), "");
  b.run(1.5);
  ASSERT_FALSE(b.at_rest());
  b.people.views[0].live = false;
  b.people.views[0].reason = "repeats itself for 0.3 s";
  b.run(kPeriodOfSamples);  // the controller receives the report
  const double fastest =
      b.robot->stop_limits().velocity[0] / b.robot->stop_limits().acceleration[0] +
      b.robot->stop_limits().acceleration[0] / b.robot->stop_limits().jerk[0];
  b.run(fastest + 0.05);
  EXPECT_TRUE(b.at_rest());
  EXPECT_EQ(b.core.mode(), Mode::hold);
  EXPECT_TRUE(has(b, Cause::blind));
  EXPECT_EQ(b.core.status().reason, "hold: blind: source camera repeats itself for 0.3 s");
  const Vector rested = b.core.set_point().position;
  b.new_go();
  b.run(2);
  EXPECT_EQ(b.core.set_point().position, rested) << "it rests as long as that lasts";
  b.people.views = {test::live_view()};
  b.run(0.1);
  EXPECT_EQ(b.core.status().causes, bit(Cause::no_go));
  b.new_go();
  b.run(8);
  EXPECT_EQ(b.core.status().motion, MotionState::finished) << "the path is not lost";
  test::expect_smooth(b);
}

TEST(BlindController, a_view_grows_old_with_the_message_and_without_it) {
  ControllerSettings settings;
  settings.timeouts.human_state = 10;  // excludes this timeout as the cause
  BlindBench b(settings);
  b.start();
  ASSERT_EQ(b.go_to(kFar, 1), "");
  b.run(1.0);
  b.human_speaks = false;
  b.run(0.2);
  EXPECT_FALSE(has(b, Cause::blind));
  b.run(0.1);
  EXPECT_TRUE(has(b, Cause::blind)) << "0.25 s after the capture";
  b.run(1.2);
  EXPECT_TRUE(b.at_rest());

  BlindBench late;
  late.start();
  late.people.views[0].age = 0.26;
  late.run(0.1);
  EXPECT_TRUE(has(late, Cause::blind)) << "also at rest";
  EXPECT_EQ(late.core.mode(), Mode::hold);
}

TEST(BlindController, at_rest_where_nobody_looks_it_holds) {
  BlindBench b;
  SourceView behind = test::live_view();
  behind.high.x() = 0.3;
  b.people.views = {behind};
  b.start();
  EXPECT_EQ(b.core.mode(), Mode::hold);
  EXPECT_TRUE(has(b, Cause::blind));
  b.new_go();
  EXPECT_EQ(b.core.mode(), Mode::hold);
}

TEST(BlindController, says_that_it_is_blind_though_a_command_was_refused) {
  BlindBench b;
  b.start();
  b.people.views.clear();
  b.run(0.1);
  TrajectoryCommand old = b.command(kFar, 1);
  old.epoch = b.go.epoch + 9;
  ASSERT_NE(b.send(old), "");
  EXPECT_THAT(b.core.status().reason,
              HasSubstr("blind: no source of people has been seen; trajectory 1:"));
}

TEST(BlindController, moves_without_a_view_only_where_none_is_required) {
  ControllerSettings settings;
  settings.view.require_view = false;
  BlindBench b(settings);
  b.people.views.clear();
  b.start();
  ASSERT_EQ(b.go_to(kFar, 1), "");
  b.run(8);
  EXPECT_EQ(b.core.status().motion, MotionState::finished);
}

TEST(BlindController, gives_way_to_a_push_though_blind) {
  BlindBench b;
  b.external_torque = Vector::Zero(b.robot->dof());
  b.start();
  b.people.views.clear();
  b.run(0.5);
  ASSERT_TRUE(has(b, Cause::blind));
  const Vector before = b.core.set_point().position;
  b.external_torque[0] = 25.0;
  b.run(0.5);
  EXPECT_GT(b.core.set_point().position[0] - before[0], 0.02);
}

TEST(BlindController, does_not_retreat_from_a_person_where_no_live_source_looks) {
  BlindBench b;
  b.people.people = {b.standing(1.5, 0.0)};
  b.start();
  b.people.views[0].live = false;
  b.advice.speed_factor = -1.0;
  b.run(0.1);
  const Vector before = b.core.set_point().position;
  b.run(2.0);
  EXPECT_EQ(b.core.set_point().position, before);
}

/// For any boundary of the observed space and any approach of the arm.
TEST(BlindController, never_crosses_the_edge) {
  std::mt19937 random(7);
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int stood = 0;
  for (int trial = 0; trial < 40; ++trial) {
    BlindBench b;
    const auto k = static_cast<Eigen::Index>(random() % 3);
    b.start();
    const double edge = b.farthest(k) + b.settings.view.margin + real(0.01, 0.4);
    SourceView view = test::live_view();
    view.high[k] = edge;
    b.people.views = {view};
    b.run(0.1);
    ASSERT_EQ(b.go_to(ControllerBench::arm(real(-2.5, 2.5), real(-1.5, 1.5), real(-2, 2)), 1), "");
    double reached = b.run_watching(real(0.2, 3), k);
    if (trial % 2 == 0) b.advice.speed_factor = real(0.1, 1.0);
    reached = std::max(reached, b.run_watching(6, k));
    EXPECT_LE(reached, edge) << trial;
    stood += has(b, Cause::blind);
    test::expect_smooth(b);
  }
  EXPECT_GT(stood, 5);
}

}  // namespace
}  // namespace handsel::trajectory_controller::controller_blind_test
