// SPDX-License-Identifier: Apache-2.0
// Predicts a person's hand over the next half second, with its uncertainty. Pure.
#pragma once

#include <deque>

#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "components/spark/people/fading_motion.hpp"

namespace handsel::spark {

/// The trunk continues its motion; the hand moves relative to the trunk and comes to rest. The
/// predicted sphere contains the hand with a nominal probability of 95 %: its radius grows with
/// time, speed and recent prediction errors. Own method: the error factor corrects a filter with an
/// inaccurate model.
class HandPredictor {
 public:
  using Settings = settings::SparkSettings::HandPrediction;
  /// Restarts with a first sample, or after a gap. `trunk`: mean of several trunk joints, world
  /// [m]; `noise`: standard deviation of a joint [m].
  void reset(const Vector3& hand, const Vector3& trunk, double noise, const Settings& settings);
  /// Takes a sample, world [m]. `dt`: time since the last sample, > 0 [s]; `noise`: standard
  /// deviation of a joint [m].
  void update(const Vector3& hand, const Vector3& trunk, double dt, double noise);

  struct Ball {
    Vector3 centre{Vector3::Zero()};  ///< world [m]
    double radius{};                  ///< [m]
  };
  /// Predicts the hand at `horizon` >= 0 after the last sample [s].
  Ball at(double horizon) const { return at(horizon, error_factor_); }

 private:
  struct Prediction {
    double due;  // predicted instant, by clock_ [s]
    Ball ball;
  };
  Ball at(double horizon, double factor) const;

  Settings settings_;
  FadingMotion hand_, trunk_;           // hand_: relative to the trunk
  double clock_{0};                     // time since the reset [s]
  double error_factor_{1};              // factor of the radius by recent errors
  std::deque<Prediction> predictions_;  // waiting for comparison
};

}  // namespace handsel::spark
