// SPDX-License-Identifier: Apache-2.0
// Commissioning on hardware with both example drivers as processes: dry run, walls, override,
// emergency stop, user stop, brake; and the specifics of each kind. A scripted emulation of the
// maker's controller is behind each driver; the trajectory controller is the real one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/processes/first_day.hpp"
#include "tests/support/processes/stall_watch.hpp"
#include "tests/support/small_robot.hpp"

namespace handsel::first_day_test {
namespace {

using test::FirstDay;
using test::FirstDayPlan;
using test::in_real_time;
using testing::HasSubstr;

constexpr double kAway = -0.3;  // target of the motions [rad]; the wall is on the other side

FirstDayPlan position_arm() {
  return {HANDSEL_BINARIES, "position_arm", "jido", "", 0, HANDSEL_TEST_DOMAIN, false};
}
FirstDayPlan reflex_arm() {
  test::small_robot();
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("handsel_small_robot_" + std::to_string(::getpid())) / "small.txtpb")
                               .string();
  return {HANDSEL_BINARIES,
          "reflex_arm",
          file,
          "gripper { axis: \"finger_a_joint\" open: 0 closed: 1.2 open_width: 0.08 closed_width: 0 "
          "speed: 0.1 stiffness: 400 min_force: 5 "
          "max_force: 40 }\n",
          0,
          HANDSEL_TEST_DOMAIN,
          false};
}

template <FirstDayPlan (*plan)()>
struct Arm {
  static FirstDayPlan make() { return plan(); }
};

template <class A>
class FirstDayOf : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    day_ = std::make_unique<FirstDay>(A::make());
  }
  static void TearDownTestSuite() { day_.reset(); }
  template <class Story>
  static void tell(const Story& story) {
    in_real_time([&] { story(*day_); },
                 [] {
                   day_.reset();
                   day_ = std::make_unique<FirstDay>(A::make());
                 });
  }

  /// Stops by `event` in the middle of a motion: the robot rests; a new permission alone has no
  /// effect, but an act of a person and a new permission after it have.
  static void stopped_by(FirstDay& day, const std::string& event, DriveMode mode,
                         const std::string& said) {
    day.play("moving 0.2 " + event + " on\nstanding 0.3 " + event + " off\n");
    ASSERT_TRUE(day.ready()) << day.where();
    day.move_to(kAway);
    ASSERT_TRUE(day.wait([&] { return day.happened(event + " on"); })) << day.where();
    const TimePoint at = day.now();
    ASSERT_TRUE(day.wait([&] {
      return day.robot_state().mode == mode && day.status().mode == Mode::stop &&
             day.has(Cause::drive_not_enabled) && day.trouble().find(said) != std::string::npos;
    })) << day.where();
    EXPECT_LT(to_seconds(day.now() - at), 1.0) << "shown with its cause within a second";
    EXPECT_THAT(day.status().reason, HasSubstr("drive_not_enabled"));
    const double there = day.angle();
    EXPECT_LT(there, -0.01) << "in the middle of a motion";
    EXPECT_GT(there, kAway + 0.02);
    const auto stands = [&] {
      return day.speed() == 0.0 && std::abs(day.angle() - there) < 1e-6 &&
             day.status().mode >= Mode::hold;
    };

    ASSERT_TRUE(day.wait([&] {
      return stands() && day.happened(event + " off") &&
             day.trouble().find("acknowledge") != std::string::npos;
    })) << day.where();
    EXPECT_EQ(day.robot_state().mode, DriveMode::braked);
    day.give_go(false);
    EXPECT_TRUE(
        day.stays([&] { return stands() && day.robot_state().mode == DriveMode::braked; }, 100))
        << day.where();

    day.give_go(true);
    ASSERT_TRUE(day.wait([&] {
      return day.robot_state().mode == DriveMode::enabled && day.status().mode == Mode::hold;
    })) << day.where();
    const auto waits = [&] {
      return std::abs(day.angle() - there) < 0.005 && day.status().mode == Mode::hold;
    };
    EXPECT_TRUE(day.stays(waits, 100)) << "nobody has given a new permission: " << day.where();
    day.give_go(false);
    ASSERT_TRUE(day.wait([&] { return day.status().mode < Mode::hold; })) << day.where();
    go_back(day);
  }
  /// Moves to the rest configuration, then expects no error of the maker's controller.
  static void go_back(FirstDay& day) {
    day.move_to(0.0);
    ASSERT_TRUE(day.wait([&] { return day.arrived() && std::abs(day.angle()) < 0.005; }))
        << day.where();
    EXPECT_THAT(day.account(), HasSubstr("violations 0")) << day.where();
  }
  static std::unique_ptr<FirstDay> day_;
};
template <class A>
std::unique_ptr<FirstDay> FirstDayOf<A>::day_;

struct Names {
  template <class A>
  static std::string GetName(int) {
    return std::is_same_v<A, Arm<position_arm>> ? "position_arm" : "reflex_arm";
  }
};
using Arms = testing::Types<Arm<position_arm>, Arm<reflex_arm>>;
TYPED_TEST_SUITE(FirstDayOf, Arms, Names);

TYPED_TEST(FirstDayOf, dry_run_is_everything_but_the_output) {
  this->day_.reset();
  FirstDayPlan plan = TypeParam::make();
  plan.dry_run = true;
  in_real_time(
      [&] {
        FirstDay day(plan);
        day.play("");
        ASSERT_TRUE(day.ready()) << day.where();
        day.move_to(kAway);
        EXPECT_TRUE(day.wait([&] {
          return day.arrived() && std::abs(day.angle() - kAway) < 0.005;
        })) << day.where();
        EXPECT_GT(day.fastest, 0.1) << "the posture it would have is reported";
        EXPECT_THAT(day.account(), HasSubstr("moved 0 cycles, violations 0, sessions 0"))
            << "but the arm was told nothing";
      },
      [] {});
  this->day_ = std::make_unique<FirstDay>(TypeParam::make());
}

TYPED_TEST(FirstDayOf, walls_are_not_passed) {
  this->tell([](FirstDay& day) {
    day.play("");
    ASSERT_TRUE(day.ready()) << day.where();
    day.min_room = day.wall_room();
    ASSERT_GT(day.min_room, 0.05);
    day.move_to(FirstDay::kFar);
    ASSERT_TRUE(day.wait([&] { return day.angle() > 0.05 && day.has(Cause::wall); }))
        << day.where();
    EXPECT_EQ(day.status().mode, Mode::slow);
    ASSERT_TRUE(day.wait([&] { return day.angle() > 0.1 && day.speed() < 2e-3; })) << day.where();
    EXPECT_FALSE(day.arrived());
    EXPECT_GE(day.min_room, 0.0);
    day.cancel();
    ASSERT_TRUE(day.wait([&] {
      return day.status().motion == MotionState::stopped && day.standing();
    })) << day.where();
    TestFixture::go_back(day);
  });
}

TYPED_TEST(FirstDayOf, override_of_ten_percent_is_a_tenth_of_the_speed) {
  this->tell([](FirstDay& day) {
    day.play("");
    day.override_speed(0.1);
    ASSERT_TRUE(day.ready()) << day.where();
    day.fastest = 0.0;
    const Trajectory plan = day.move_to(kAway);
    double planned = 0.0;
    for (double t = 0.0; t < plan.duration(); t += 0.001)
      planned = std::max(planned, plan.at(t).velocity.cwiseAbs().maxCoeff());
    ASSERT_TRUE(day.wait([&] { return day.angle() < -0.02; })) << day.where();
    EXPECT_TRUE(day.has(Cause::override_slow)) << day.where();
    EXPECT_EQ(day.status().mode, Mode::slow);
    EXPECT_LT(day.fastest, 0.1 * planned + 0.01) << "planned: " << planned;
    EXPECT_GT(day.fastest, 0.01);
    day.override_speed(1.0);
    ASSERT_TRUE(day.wait([&] { return day.arrived(); })) << day.where();
    EXPECT_GT(day.fastest, 0.3 * planned) << "back at full speed";
    TestFixture::go_back(day);
  });
}

TYPED_TEST(FirstDayOf, emergency_stop) {
  this->tell([](FirstDay& day) {
    TestFixture::stopped_by(day, "emergency_stop", DriveMode::emergency_stop, "emergency stop");
  });
}
TYPED_TEST(FirstDayOf, user_stop) {
  this->tell([](FirstDay& day) {
    TestFixture::stopped_by(day, "user_stop", DriveMode::user_stop, "user stop");
  });
}
TYPED_TEST(FirstDayOf, braked_drives) {
  this->tell(
      [](FirstDay& day) { TestFixture::stopped_by(day, "brake", DriveMode::braked, "brakes"); });
}

}  // namespace
}  // namespace handsel::first_day_test
