#include "sim/people/followed_body.hpp"

#include <algorithm>

#include "sim/people/person_parts.hpp"

namespace handsel::sim {
namespace {
constexpr double kShortest = 0.005,
                 kLongest =
                     0.1;  // [s] between samples; after a longer silence it catches up within this
constexpr double
    kJump = 0.5,
    kFastest = 5.0;  // waist, farther than this from one sample to the next [m], and faster [m/s]
}  // namespace

FollowedBody::FollowedBody(const BodyPoints& start, double stature) : from_(start), to_(start) {
  fitted_.stature = stature;
}

bool FollowedBody::observe(const ObservedPerson& seen, double now) {
  std::vector<BodyJoint> joints = fit_body(seen, seen_ ? &fitted_ : nullptr, fitted_.stature);
  if (joints.size() != to_.size()) return false;
  fitted_.joints = std::move(joints);
  BodyPoints here;
  sample(now, here);
  for (std::size_t i = 0; i < to_.size(); ++i) to_[i] = fitted_.joints[i].position;
  const double way = (to_[kWaist] - here[kWaist]).norm();
  const bool placed = !seen_ || way > std::max(kJump, kFastest * (now - begun_));
  from_ = placed ? to_ : here;
  lasts_ = placed ? kShortest : std::clamp(now - begun_, kShortest, kLongest);
  begun_ = now;
  seen_ = true;
  return placed;
}

void FollowedBody::sample(double now, BodyPoints& out) const {
  const double part = lasts_ > 0 ? std::clamp((now - begun_) / lasts_, 0.0, 1.0) : 1.0;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = (1 - part) * from_[i] + part * to_[i];
}

}  // namespace handsel::sim
