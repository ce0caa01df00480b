// SPDX-License-Identifier: Apache-2.0
// A body that follows observations from outside. Pure: time is an argument.
#pragma once

#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"
#include "sim/people/person_settings.hpp"
#include "sim/recordings/recording.hpp"

namespace handsel::sim {

/// Moves the body at constant speed from its present position to the newest sample, within the
/// interval of the last two samples: one period late, like the output of any tracker. The first
/// sample places the body without a motion, and so does a sample too far away for a person's
/// motion: the tracker was restarted. Unobserved joints are fitted to the observed joints
/// (`fit_body`). Own method: needs neither period nor delay of the tracker.
class FollowedBody {
 public:
  FollowedBody(const BodyPoints& start, double stature, const PersonManners& manners);

  /// Takes a sample at `now` [s]. Returns true if the sample placed the body without a motion.
  bool observe(const ObservedPerson& seen, double now);
  /// Writes the body points at `now` [s]; after the end of the motion those of the newest sample.
  void sample(double now, BodyPoints& out) const;

 private:
  PersonManners manners_;
  Person fitted_;
  BodyPoints from_, to_;
  double motion_start_{0}, motion_duration_{0};
  bool has_sample_{false};
};

}  // namespace handsel::sim
