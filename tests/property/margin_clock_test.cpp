// SPDX-License-Identifier: Apache-2.0
// The adaptive clock by margin: between two activations no person within the assumed speeds uses up
// the margin. The oracle integrates the true distance in steps of 1 ms and computes its own bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <random>

#include "components/attention/adaptive_clock.hpp"

namespace handsel::attention::margin_clock_test {
namespace {

constexpr double kStep = 0.001;  // step of the integration [s]
constexpr double kTick = 0.01;   // period of the clock's evaluation [s]
constexpr double kPMin = 0.04, kPMax = 0.8;
constexpr double kSensorPeriod = 0.03;

/// How the distance between a person and the robot changes.
class Approach {
 public:
  Approach(std::mt19937& random, double person_speed, double robot_speed)
      : random_(random), person_speed_(person_speed), robot_speed_(robot_speed) {
    distance_ = draw(0.7, 4.0);
  }
  double distance() const { return distance_; }
  void advance() {
    left_ -= kStep;
    if (left_ <= 0) {
      left_ = draw(0.05, 1.5);
      // Often the max assumed speed, else a random speed below it, also away.
      closing_ = draw(0, 1) < 0.4
                     ? person_speed_ + robot_speed_
                     : draw(-person_speed_, person_speed_) + draw(-robot_speed_, robot_speed_);
    }
    distance_ = std::max(0.05, distance_ - closing_ * kStep);
  }

 private:
  double draw(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  std::mt19937& random_;
  double person_speed_, robot_speed_, distance_{}, closing_{}, left_{};
};

struct Watched {
  int activation_count{};     ///< activations of the clock
  double time{};              ///< of all approaches [s]
  int beyond{};               ///< activations whose period is not clamped to p_min
  double excess{-1};          ///< max distance below the guarantee of such an activation [m]
  double clamped_excess{-1};  ///< the same of the other activations [m]
  double tightest{1e9};       ///< min distance above the guarantee of any activation [m]
  int surprises{};            ///< exhausted margins without an activation at p_min
};

/// Samples random approaches with a clock; `margin`: assumption of the oracle.
Watched watch(const ClockSettings& clock_settings, const MarginSettings& margin, int approaches) {
  std::mt19937 random(20);
  Watched out;
  const double speed = margin.person_speed + margin.robot_speed;
  for (int k = 0; k < approaches; ++k) {
    Approach person(random, margin.person_speed, margin.robot_speed);
    AdaptiveClock clock(clock_settings, from_seconds(0.5 * kTick), "avoid");
    std::deque<double> past;  // distances, newest last
    double guaranteed = -1, min_distance = 1e9;
    bool clamped = true, looked = false;
    std::uniform_real_distribution<double> delay(margin.data_age - kSensorPeriod, margin.data_age);
    const int steps = static_cast<int>(8 / kStep);
    for (int i = 0; i < steps; ++i) {
      past.push_back(person.distance());
      if (past.size() > 400) past.pop_front();
      min_distance = std::min(min_distance, person.distance());
      const TimePoint now(from_seconds(100 + i * kStep));
      if (i % 10 == 0 && clock.due(now)) {
        if (looked) {
          const double above = min_distance - guaranteed;
          out.tightest = std::min(out.tightest, above);
          (clamped ? out.clamped_excess : out.excess) =
              std::max(clamped ? out.clamped_excess : out.excess, -above);
          out.surprises += !clamped && min_distance < margin.distance;
        }
        const auto age = std::min(past.size() - 1, static_cast<std::size_t>(delay(random) / kStep));
        const double seen = past[past.size() - 1 - age];
        clock.fire(seen, now);
        ++out.activation_count;
        // Remaining distance after `use` is spent, or p_min has passed, since the capture of the
        // data.
        clamped = clock.period() <= kPMin + 1e-9;
        guaranteed = clamped ? seen - speed * (kPMin + margin.data_age + 0.5 * kTick + kStep)
                             : seen - margin.use * (seen - margin.distance) - 1e-6;
        out.beyond += !clamped;
        min_distance = person.distance();
        looked = true;
      }
      person.advance();
    }
    out.time += steps * kStep;
  }
  return out;
}

TEST(MarginClock, nobody_uses_up_the_margin_between_two_looks) {
  for (const double use : {0.3, 0.8, 0.95}) {
    const MarginSettings margin{use, 0.6, 1.6, 0.4, 0.1};
    ClockSettings settings{ClockLaw::margin, kPMin, kPMax, 0.1, 3.0};
    settings.margin = margin;
    const Watched run = watch(settings, margin, 400);
    EXPECT_GT(run.beyond, 1000) << "the law was hardly tried";
    EXPECT_LE(run.excess, 0) << "use " << use << ": nearer than predicted [m]";
    EXPECT_LE(run.clamped_excess, 1e-9) << "use " << use;
    EXPECT_EQ(run.surprises, 0) << "use " << use;
    std::printf("use %.2f: %d looks, every %.3f s, tightest %.3f m above the guarantee\n", use,
                run.activation_count, run.time / run.activation_count, run.tightest);
  }
}

TEST(MarginClock, a_fixed_clock_with_as_many_looks_does_not_keep_it) {
  const MarginSettings margin{0.8, 0.6, 1.6, 0.4, 0.1};
  ClockSettings settings{ClockLaw::margin, kPMin, kPMax, 0.1, 3.0};
  settings.margin = margin;
  const Watched adaptive = watch(settings, margin, 200);
  ClockSettings fixed = settings;
  fixed.rule = ClockLaw::fixed;
  fixed.period = adaptive.time / adaptive.activation_count;
  const Watched run = watch(fixed, margin, 200);
  EXPECT_GT(run.surprises, 0);
  EXPECT_GT(run.excess, 0);
}

TEST(MarginClock, follows_its_formula_within_its_limits) {
  const MarginSettings margin{0.8, 0.6, 1.6, 0.4, 0.1};
  ClockSettings settings{ClockLaw::margin, kPMin, kPMax, 0.1, 3.0};
  settings.margin = margin;
  AdaptiveClock clock(settings, Duration(0), "avoid");
  const TimePoint now(from_seconds(1));
  const auto period = [&](double distance) {
    clock.fire(distance, now);
    return clock.period();
  };
  EXPECT_NEAR(period(1.6), 0.8 * 1.0 / 2.0 - 0.1, 1e-12);
  EXPECT_NEAR(period(0.9), kPMin, 1e-12);
  EXPECT_NEAR(period(0.0), kPMin, 1e-12);
  EXPECT_NEAR(period(9.0), kPMax, 1e-12);
  EXPECT_NEAR(period(std::numeric_limits<double>::infinity()), kPMax, 1e-12);
  settings.margin.use = 1.0;
  EXPECT_ANY_THROW(AdaptiveClock(settings, Duration(0), "avoid")) << "all of the margin";
}

}  // namespace
}  // namespace handsel::attention::margin_clock_test
