// Two hundred exchanges: pulls of 2 to 20 N, bumps, tremor and false starts. The object never falls, and the robot's hand never lets go
// of it unless a person carries it.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <random>
#include <vector>

#include "common/trajectory/edit.hpp"
#include "components/trajectory_controller/hand_executor.hpp"

namespace handsel::trajectory_controller {
namespace {

constexpr double kDt = 0.001, kGravity = 9.81;
constexpr int kFingers = 4;

KinematicLimits limits(double v, double a, double j) {
  return {Eigen::VectorXd::Constant(kFingers, v), Eigen::VectorXd::Constant(kFingers, a), Eigen::VectorXd::Constant(kFingers, j)};
}

/// What a person does to the object for a while.
struct Touch {
  double from{}, until{};          // [s]
  double ramp{0.0};                // [s] to the full force
  Vector3 force{Vector3::Zero()};  // [N]
  double tremor{}, frequency{};    // [N], [Hz] sideways
  bool carrying{};                 // the person's hand holds the object meanwhile
};

/// Fingers that press with a spring, friction that holds the object, and a person. While friction does not bear the object's weight and
/// what the person does to it, it slides; after the length of a fingertip it is out: with the person who carries it, or it falls.
class Exchange {
 public:
  Exchange(std::uint64_t seed, double mass)
      : random_(seed),
        mass_(mass),
        hand_(HandSettings{}, {0, 1, 2, 3}, std::vector<double>(4, -0.2), std::vector<double>(4, 1.4), limits(2.85, 14.2, 107),
              limits(3.14, 15.7, 118)) {
    out_ = rest_state(Vector::Zero(kFingers));
    robot_.position = robot_.velocity = robot_.effort = Vector::Zero(kFingers);
    hand_.reset(robot_.position);
    hand_.accept(command(HandAction::grasp, 0.6, 1.0));
    for (int k = 0; k < 3000; ++k) step({});
    held_ = hand_.state() == HandState::grasped;
    hand_.accept(command(HandAction::release_on_pull, 0.0, kThreshold));
    for (int k = 0; k < 500; ++k) step({});
    time_ = 0.0;
  }
  static constexpr double kThreshold = 1.5;  // [N]

  void step(const std::vector<Touch>& touches) {
    Vector3 push = Vector3::Zero();
    bool carrying = false;
    for (const Touch& t : touches) {
      if (time_ < t.from || time_ >= t.until) continue;
      const double rise = t.ramp > 0.0 ? std::min(1.0, (time_ - t.from) / t.ramp) : 1.0;
      push += rise * t.force + t.tremor * std::sin(2.0 * M_PI * t.frequency * (time_ - t.from)) * Vector3::UnitY();
      carrying = carrying || t.carrying;
    }
    double press = 0.0;
    for (int i = 0; i < kFingers; ++i) {
      const double contact = with_robot_ ? 0.5 + 0.02 * i : 10.0, before = robot_.position[i];
      robot_.position[i] = std::min(out_.position[i], contact);
      robot_.velocity[i] = (robot_.position[i] - before) / kDt;
      robot_.effort[i] = 5.0 * (out_.position[i] - robot_.position[i]);
      press += kStiffness * (out_.position[i] - robot_.position[i]);
    }
    std::normal_distribution<double> noise(0.0, 0.1);
    const Vector3 load = push - mass_ * kGravity * Vector3::UnitZ();
    const double bears = kFriction * press, wants = load.norm();
    if (held_ && with_robot_) {
      sliding_ = std::max(0.0, sliding_ + kDt * (wants - bears) / mass_);
      slid_ += kDt * sliding_;
      if (slid_ > kPad) {
        with_robot_ = false;
        (carrying ? handed_over_ : dropped_) = true;
        free_at_ = time_;
      }
    }
    const Vector3 felt = with_robot_ ? Vector3(load * (sliding_ > 0.0 ? std::min(1.0, bears / wants) : 1.0)) : Vector3(Vector3::Zero());
    HandInputs in;
    in.robot = &robot_;
    in.new_state = ++ticks_ % 2 == 0;
    in.force = felt + Vector3(noise(random_), noise(random_), noise(random_));
    in.toward = Vector3::UnitX();
    in.person_distance = 0.05;
    in.may_move = true;
    robot_.payload = with_robot_ ? mass_ : 0.0;
    hand_.step(in, kDt, now_, out_);
    const bool opened = held_ && with_robot_ && !carrying && hand_.state() == HandState::released;
    released_to_nobody_ = released_to_nobody_ || opened;
    now_ += from_seconds(kDt);
    time_ += kDt;
  }
  HandCommand command(HandAction action, double position, double pull) const {
    HandCommand c;
    c.action = action;
    c.position = Vector::Constant(kFingers, position);
    c.pull_force = pull;
    return c;
  }

  bool held() const { return held_; }
  bool dropped() const { return dropped_; }
  bool handed_over() const { return handed_over_; }
  bool released_to_nobody() const { return released_to_nobody_; }
  double free_at() const { return free_at_; }
  double time() const { return time_; }
  std::uint64_t regrips() const { return hand_.regrips(); }

 private:
  static constexpr double kStiffness = 60.0, kFriction = 0.8;  // [N/rad] at the fingertip
  static constexpr double kPad = 0.02;                         // [m]

  std::mt19937_64 random_;
  double mass_;
  HandExecutor hand_;
  MotionState3 out_;
  RobotState robot_;
  bool with_robot_{true}, held_{}, dropped_{}, handed_over_{}, released_to_nobody_{};
  double free_at_{}, time_{}, sliding_{}, slid_{};
  long ticks_{};
  TimePoint now_{from_seconds(10)};
};

TEST(Release, two_hundred_exchanges_without_a_drop) {
  const std::uint64_t seed = 4711;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  std::mt19937_64 random(seed);
  const auto real = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const char* const kinds[] = {"pull", "bump", "tremor", "false start"};
  std::map<int, int> histogram;
  std::vector<double> latencies;
  std::uint64_t regrips = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int kind = trial % 4;
    Exchange exchange(seed + static_cast<std::uint64_t>(trial), real(0.15, 0.6));
    ASSERT_TRUE(exchange.held());
    std::vector<Touch> touches;
    double t = 0.2;
    if (kind == 1) {
      for (int k = 0; k < 3; ++k) {
        const Vector3 way = Vector3(real(-1, 1), real(-1, 1), real(-1, 1)).normalized();
        const double lasts = real(0.01, 0.08);
        touches.push_back({t, t + lasts, 0.0, real(5, 12) * way, 0.0, 0.0, false});
        t += lasts + real(0.15, 0.5);
      }
    } else if (kind == 2) {
      touches.push_back({t, t + 1.5, 0.0, Vector3::Zero(), real(1.0, 2.5) * Exchange::kThreshold, real(4.0, 9.0), true});
      t += 1.5;
    } else if (kind == 3) {
      for (int k = 0; k < 3; ++k) {
        const double lasts = real(0.02, 0.5);
        touches.push_back(
            {t, t + lasts, real(0.0, 0.1), real(2, 10) * Vector3(1, real(-0.2, 0.2), real(-0.2, 0.4)).normalized(), 0, 0, true});
        t += lasts + real(0.2, 0.6);
      }
    }
    const double quiet_until = t;
    const Vector3 way = Vector3(1.0, real(-0.3, 0.3), real(-0.2, 0.6)).normalized();
    const double pull = real(2.0, 20.0), ramp = real(0.02, 0.3);
    touches.push_back({t, t + 10.0, ramp, pull * way, 0.0, 0.0, true});
    while (exchange.time() < quiet_until && !exchange.handed_over() && !exchange.dropped()) exchange.step(touches);
    const bool early = exchange.handed_over();
    EXPECT_FALSE(exchange.dropped()) << "trial " << trial << " (" << kinds[kind] << ") dropped before the pull at " << exchange.free_at();
    EXPECT_FALSE(early && kind == 1) << "trial " << trial << ": a bump is no pull";
    while (exchange.time() < quiet_until + 3.0 && !exchange.handed_over() && !exchange.dropped()) exchange.step(touches);
    EXPECT_FALSE(exchange.dropped()) << "trial " << trial << " (" << kinds[kind] << ")";
    EXPECT_FALSE(exchange.released_to_nobody()) << "trial " << trial << " (" << kinds[kind] << ")";
    EXPECT_TRUE(exchange.handed_over()) << "trial " << trial << " (" << kinds[kind] << "): pulled with " << pull << " N in vain";
    regrips += exchange.regrips();
    if (early) continue;
    const double begins = quiet_until + ramp * Exchange::kThreshold / pull;
    latencies.push_back(exchange.free_at() - begins);
    ++histogram[static_cast<int>(latencies.back() / 0.025)];
  }
  std::sort(latencies.begin(), latencies.end());
  std::printf(
      "%zu pulls; from the threshold passed to the object free: p50 %.0f ms, p99 %.0f ms, longest %.0f ms; %llu times taken hold again\n",
      latencies.size(), 1e3 * latencies[latencies.size() / 2], 1e3 * latencies[latencies.size() * 99 / 100], 1e3 * latencies.back(),
      static_cast<unsigned long long>(regrips));
  for (const auto& [bin, count] : histogram)
    std::printf("  %4d ms %s\n", bin * 25, std::string(static_cast<std::size_t>(count), '#').c_str());
  EXPECT_GT(latencies.size(), 150u);
  EXPECT_GT(regrips, 0u) << "no false start came as far as opening: the trials test nothing";
}

}  // namespace
}  // namespace handsel::trajectory_controller
