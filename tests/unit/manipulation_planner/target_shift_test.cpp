// SPDX-License-Identifier: Apache-2.0
// The attentional shift of the exchange point.
#include "components/manipulation_planner/handover/target_shift.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/manipulation_planner/manipulation_rig.hpp"

namespace handsel::manipulation_planner::target_shift_test {
namespace {

TimePoint at(double seconds) { return TimePoint(from_seconds(10.0 + seconds)); }

AttentionAdvice shift_by(const Vector3& shift) {
  AttentionAdvice advice;
  advice.has_target_shift = true;
  advice.target_shift = shift;
  return advice;
}

class TargetShiftTest : public testing::Test {
 protected:
  TargetShiftTest() { shift_.note_choice(p_chosen_, at(-5)); }
  settings::ManipulationPlannerSettings settings_ = rig::settings();
  TargetShift shift_{settings_};
  const Vector3 p_chosen_{0.9, 0.1, 1.0};
};

TEST_F(TargetShiftTest, moves_the_point_as_asked_for) {
  shift_.advise(shift_by({0, 0.1, 0.02}), at(0));
  const auto p = shift_.wanted(p_chosen_, at(0.1));
  ASSERT_TRUE(p);
  EXPECT_LT((*p - p_chosen_ - Vector3(0, 0.1, 0.02)).norm(), 1e-12);
}

TEST_F(TargetShiftTest, advice_that_is_stale_or_says_nothing_counts_no_more) {
  EXPECT_FALSE(shift_.wanted(p_chosen_, at(0)));
  shift_.advise(shift_by({0, 0.1, 0}), at(0));
  EXPECT_TRUE(shift_.wanted(p_chosen_, at(0.29)));
  EXPECT_FALSE(shift_.wanted(p_chosen_, at(0.31)));
  shift_.advise(shift_by({0, 0.1, 0}), at(1));
  shift_.advise(AttentionAdvice{}, at(1.02));
  EXPECT_FALSE(shift_.wanted(p_chosen_, at(1.03)));
}

TEST_F(TargetShiftTest, never_leads_farther_than_the_bound_from_the_chosen_point) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto draw = [&](double scale) {
    return Vector3(scale * Vector3(any(random), any(random), any(random)));
  };
  Vector3 p = p_chosen_;
  int changes = 0;
  for (int k = 0; k < 500; ++k) {
    shift_.advise(shift_by(draw(0.3)), at(k));
    const auto next = shift_.wanted(p, at(k + 0.1));
    if (!next) continue;
    p = *next;
    shift_.note_change(p, at(k + 0.1));
    EXPECT_TRUE(shift_.has_led_to(p));
    ++changes;
    ASSERT_LE((p - p_chosen_).norm(), settings_.max_shift + 1e-12);
  }
  EXPECT_GT(changes, 100);
}

TEST_F(TargetShiftTest, waits_until_attention_has_seen_the_changed_point) {
  shift_.note_change(p_chosen_, at(0));
  shift_.advise(shift_by({0, 0.1, 0}), at(settings_.shift_pause - 0.02));
  EXPECT_FALSE(shift_.wanted(p_chosen_, at(settings_.shift_pause - 0.01)));
  EXPECT_TRUE(shift_.wanted(p_chosen_, at(settings_.shift_pause + 0.01)));
}

TEST_F(TargetShiftTest, a_refused_point_is_not_asked_for_again_until_the_next_choice) {
  shift_.advise(shift_by({0, 0.1, 0}), at(0));
  shift_.note_refusal(*shift_.wanted(p_chosen_, at(0)));
  EXPECT_FALSE(shift_.wanted(p_chosen_, at(0.1)));
  shift_.advise(shift_by({0, -0.1, 0}), at(0.2));
  EXPECT_TRUE(shift_.wanted(p_chosen_, at(0.2))) << "that is another point";
  shift_.note_choice(p_chosen_, at(0.3));
  shift_.advise(shift_by({0, 0.1, 0}), at(1));
  EXPECT_TRUE(shift_.wanted(p_chosen_, at(1)));
}

TEST_F(TargetShiftTest, small_shifts_and_a_bound_of_zero_change_nothing) {
  shift_.advise(shift_by({0, 0.9 * settings_.min_shift, 0}), at(0));
  EXPECT_FALSE(shift_.wanted(p_chosen_, at(0)));
  settings_.max_shift = 0;
  TargetShift none(settings_);
  none.note_choice(p_chosen_, at(-5));
  none.advise(shift_by({0, 0.1, 0}), at(0));
  EXPECT_FALSE(none.wanted(p_chosen_, at(0)));
}

}  // namespace
}  // namespace handsel::manipulation_planner::target_shift_test
