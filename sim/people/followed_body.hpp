// A body that is where samples from outside say. Pure: time comes in.
#pragma once

#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"
#include "sim/people/recording.hpp"

namespace handsel::sim {

/// Between samples it moves evenly from where it is to the newest one, within the time the last two
/// were apart: one period late, as any tracker's picture of a person is. The first sample places
/// it, and so does one that nobody could have moved to since the last: a tracker started anew. What
/// was not seen is fitted to what was (`fit_body`). Own method: needs neither period nor delay of
/// the tracker.
class FollowedBody {
 public:
  FollowedBody(const BodyPoints& start, double stature);

  /// Takes a sample at `now` [s]. Returns true when it placed the body.
  bool observe(const ObservedPerson& seen, double now);
  /// Writes the body points at `now` [s]; from the end of the motion on those of the newest sample.
  void sample(double now, BodyPoints& out) const;

 private:
  Person fitted_;
  BodyPoints from_, to_;
  double begun_{0}, lasts_{0};
  bool seen_{false};
};

}  // namespace handsel::sim
