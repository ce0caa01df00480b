// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/people/moving_offer.hpp"

namespace handsel::sim::moving_offer_test {
namespace {

constexpr double kStep = 0.001;  // period [s]

MovingOfferSettings settings_of(std::uint64_t seed) {
  MovingOfferSettings s;
  s.duration = 8;
  s.start_low = Vector3(0.86, -0.3, 0.865), s.start_high = Vector3(1.06, 0.3, 1.065);
  s.next_low = Vector3(0.76, -0.5, 0.865), s.next_high = Vector3(1.16, 0.5, 1.465);
  s.spread = 0.2;
  s.min_speed = 0.1, s.max_speed = 0.2;
  s.min_turn_speed = 0.5, s.max_turn_speed = 1.0;
  s.max_turn = 0.9;
  s.waits_within = 0.1;
  s.seed = seed;
  return s;
}

ArmReach arm() { return {Vector3(1.44, 0.1, 1.4), -Vector3::UnitX(), 0.36, 0.6, 0.3, {}, 0}; }

MovingOffer made(std::uint64_t seed) { return {settings_of(seed), arm(), Vector3(1, 0, 1.1)}; }

double turn_of(const MovingOffer& offer) { return Eigen::AngleAxisd(offer.turn()).angle(); }

TEST(MovingOffer, keeps_its_speeds_in_reach_until_it_stays) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    MovingOffer offer = made(seed);
    const MovingOfferSettings s = settings_of(seed);
    EXPECT_TRUE((offer.position() - s.start_low).minCoeff() >= 0 &&
                (s.start_high - offer.position()).minCoeff() >= 0)
        << "seed " << seed;
    double length = 0, turned = 0;
    int outside = 0;
    for (int i = 0; i < 7990; ++i) {
      const Vector3 p = offer.position();
      const Eigen::Quaterniond turn = offer.turn();
      offer.step(kStep, false);
      const double moved = (offer.position() - p).norm() / kStep;
      ASSERT_LT(moved, s.max_speed * 1.1) << "seed " << seed;
      length += moved * kStep;
      turned += turn.angularDistance(offer.turn());
      outside += !arm().contains(offer.position());
      ASSERT_LT(turn_of(offer), s.max_turn + 0.01) << "seed " << seed;
    }
    EXPECT_GT(length, 0.98 * 0.1 * 7.99) << "seed " << seed;
    EXPECT_GT(turned, 0.98 * 0.5 * 7.99) << "seed " << seed;
    EXPECT_LT(turned, 1.01 * 1.0 * 7.99) << "seed " << seed;
    EXPECT_LT(outside, 400) << "seed " << seed << ": between the checks of a curve";
    EXPECT_FALSE(offer.is_over());
    for (int i = 0; i < 20; ++i) offer.step(kStep, false);
    EXPECT_TRUE(offer.is_over());
    const Vector3 p = offer.position();
    offer.step(kStep, false);
    EXPECT_EQ(offer.position(), p);
  }
}

TEST(MovingOffer, waits_while_fingers_are_near_and_goes_on_then) {
  MovingOffer waits = made(7), goes_on = made(7);
  for (int i = 0; i < 1000; ++i) waits.step(kStep, false), goes_on.step(kStep, false);
  const Vector3 p = waits.position();
  const Eigen::Quaterniond turn = waits.turn();
  for (int i = 0; i < 9000; ++i) waits.step(kStep, true);
  EXPECT_EQ(waits.position(), p);
  EXPECT_EQ(waits.turn().angularDistance(turn), 0);
  for (int i = 0; i < 1000; ++i) waits.step(kStep, false), goes_on.step(kStep, false);
  EXPECT_EQ(waits.position(), goes_on.position()) << "the time of the wait does not count";
}

TEST(MovingOffer, is_the_same_for_equal_seeds_only) {
  MovingOffer one = made(3), same = made(3), other = made(4);
  for (int i = 0; i < 3000; ++i)
    for (MovingOffer* offer : {&one, &same, &other}) offer->step(kStep, false);
  EXPECT_EQ(one.position(), same.position());
  EXPECT_GT((one.position() - other.position()).norm(), 0.01);
}

TEST(MovingOffer, begins_at_the_comfortable_place_where_no_start_is_in_reach) {
  ArmReach far = arm();
  far.p_shoulder.x() += 5;
  const MovingOffer offer(settings_of(1), far, Vector3(1, 0, 1.1));
  EXPECT_EQ(offer.position(), Vector3(1, 0, 1.1));
}

}  // namespace
}  // namespace handsel::sim::moving_offer_test
