// Where a person's hand will be in the next half second, and how sure that is. Pure.
#pragma once

#include <deque>

#include "common/messages/world.hpp"
#include "components/spark/people/fading_motion.hpp"

namespace handsel::spark {

/// The trunk continues as it moves, the hand moves relative to it and comes to rest. The ball is
/// meant to hold the hand in 95 of 100 cases: it grows with time and speed, and with what came
/// farther off lately than expected, for as long as memory lasts. Own method: that factor corrects
/// a filter whose model does not fit.
class HandPredictor {
 public:
  HandPredictor();
  /// Starts with a first sample, or one after a gap. `trunk`: mean of several of its joints.
  void reset(const Vector3& hand, const Vector3& trunk, double noise);
  /// `dt` > 0 [s] since the last sample, `noise` of a point [m]; world [m].
  void update(const Vector3& hand, const Vector3& trunk, double dt, double noise);

  struct Ball {
    Vector3 centre{Vector3::Zero()};  ///< world [m]
    double radius{};                  ///< [m]
  };
  /// `horizon` >= 0 after the last sample [s].
  Ball at(double horizon) const { return at(horizon, misses_); }

 private:
  struct Promise {
    double due;  // on clock_
    Ball ball;
  };
  Ball at(double horizon, double factor) const;

  FadingMotion hand_, trunk_;  // the hand's from the trunk
  double clock_{0};            // [s] since the reset
  double misses_{1};           // factor on the radius
  std::deque<Promise> promises_;
};

}  // namespace handsel::spark
