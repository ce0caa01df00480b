// SPDX-License-Identifier: Apache-2.0
#include "components/spark/scene/object_track.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/object_extent.hpp"
#include "components/spark/directed.hpp"

namespace handsel::spark {
namespace {

/// Averages the pose of an object at rest over several noisy samples. A moving object has its last
/// observed pose, as does an object in a person's hand, where averaging would hide slow motions.
Pose averaged(const Pose& estimate, const Pose& seen, int& samples,
              const settings::SparkSettings& settings) {
  const Eigen::AngleAxisd turn(estimate.linear().transpose() * seen.linear());
  if ((seen.translation() - estimate.translation()).norm() > settings.averaged_move ||
      std::abs(turn.angle()) > settings.averaged_turn) {
    samples = 1;
    return seen;
  }
  samples = std::min(samples + 1, static_cast<int>(settings.averaged_samples));
  Pose out = estimate;
  out.translation() += (seen.translation() - estimate.translation()) / samples;
  out.linear() =
      estimate.linear() * Eigen::AngleAxisd(turn.angle() / samples, turn.axis()).toRotationMatrix();
  return out;
}

/// Filters the velocity by a first-order filter over the samples; steps of the averaged position
/// would cause false velocities.
void update_velocity(ObjectTrack& track, const ObservedObject& observed, TimePoint seen,
                     const settings::SparkSettings& settings) {
  const Vector3 at = observed.T_world_object.translation();
  const double dt = to_seconds(seen - track.seen);
  if (track.samples == 0 || dt > settings.object_velocity_gap) {
    track.object.velocity.setZero();
  } else if (dt > 0) {
    track.object.velocity += -std::expm1(-dt / settings.object_velocity_time) *
                             ((at - track.last_seen_at) / dt - track.object.velocity);
  }
  track.last_seen_at = at;
  track.grips = observed.grips;
}

}  // namespace

bool select_shape(ObservedObject& observed, const ObjectLibrary& library) {
  const bool described =
      !observed.model.empty() && (!library || library(observed.model) != nullptr);
  if (described) {
    observed.primitive = {};
    return true;
  }
  if (!primitive_shape(observed.primitive)) return false;
  observed.model.clear();
  return true;
}

void correct_swapped_ids(std::vector<ObservedObject>& observed, const ObjectTracks& tracks,
                         TimePoint at, const settings::SparkSettings& settings) {
  for (std::size_t i = 0; i < observed.size(); ++i) {
    for (std::size_t k = i + 1; k < observed.size(); ++k) {
      const auto a = tracks.find(observed[i].id), b = tracks.find(observed[k].id);
      if (a == tracks.end() || b == tracks.end() || observed[i].model != observed[k].model)
        continue;
      if (observed[i].primitive.kind != observed[k].primitive.kind ||
          !observed[i].primitive.size.isApprox(observed[k].primitive.size, 0.1))
        continue;
      const auto apart = [&](const ObservedObject& sample, const ObjectTrack& track) {
        return (sample.T_world_object.translation() - track.last_seen_at).norm();
      };
      const double possible =
          settings.object_jump +
          settings.object_max_speed * to_seconds(at - std::min(a->second.seen, b->second.seen));
      const bool jumped =
          apart(observed[i], a->second) > possible && apart(observed[k], b->second) > possible;
      if (jumped && apart(observed[i], b->second) < possible &&
          apart(observed[k], a->second) < possible)
        std::swap(observed[i].id, observed[k].id);
    }
  }
}

bool accept_source(ObjectTrack& track, const ObservedObject& observed, const std::string& source,
                   TimePoint seen, const settings::SparkSettings& settings) {
  if (track.samples == 0 || track.source == source ||
      to_seconds(seen - track.seen) > settings.source_timeout) {
    track.source = source;
    return true;
  }
  const double between = std::abs(to_seconds(seen - track.seen)) * track.object.velocity.norm();
  const double apart =
      (observed.T_world_object.translation() - track.last_seen_at).norm() - between;
  const bool wider = apart > track.spread || seen > track.spread_until;
  if (apart > settings.source_agreement && wider) track.spread = apart;
  if (apart > settings.source_agreement)
    track.spread_until = seen + from_seconds(settings.doubt_time);
  return false;
}

void add_sample(ObjectTrack& track, const ObservedObject& observed, TimePoint seen,
                const settings::SparkSettings& settings) {
  const double distance = (observed.T_world_object.translation() - track.last_seen_at).norm();
  if (track.samples > 0 &&
      distance > settings.object_jump + settings.object_max_speed * to_seconds(seen - track.seen)) {
    track.jump = distance;
    track.jump_until = seen + from_seconds(settings.doubt_time);
  }
  update_velocity(track, observed, seen, settings);
  track.object.id = observed.id;
  track.object.model = observed.model;
  track.object.primitive = observed.primitive;
  if (track.object.holder == Holder::human) track.samples = 0;
  track.object.T_world_object =
      track.samples > 0
          ? averaged(track.object.T_world_object, observed.T_world_object, track.samples, settings)
          : observed.T_world_object;
  track.samples = std::max(track.samples, 1);
  track.seen = seen;
  track.max_drift = 0;
}

void update_uncertainty(ObjectTrack& track, const HumanState& people, TimePoint now,
                        const settings::SparkSettings& settings) {
  const double unseen = to_seconds(now - track.seen) - settings.unseen_after;
  const double since = std::clamp(to_seconds(now - track.evaluated), 0.0, std::max(0.0, unseen));
  track.evaluated = now;
  SceneObject& object = track.object;
  if (object.holder == Holder::robot) track.max_drift = 0;
  double speed = object.holder == Holder::robot ? 0 : settings.unseen_drift, with = 0;
  for (const Person& person : people.people) {
    if (object.holder == Holder::human && object.holder_id == person.id) with = person.inflation;
    for (const char* hand : {"l_hand", "r_hand"})
      if ((joint_of(person, hand).position - object.T_world_object.translation()).norm() <
              2 * settings.near_distance + person.inflation &&
          object.holder != Holder::robot)
        speed = settings.touched_drift;
  }
  track.max_drift = std::min(track.max_drift + since * speed, settings.unseen_most);
  object.uncertainty = track.max_drift + with;
  if (now < track.spread_until) object.uncertainty += track.spread;
  if (now < track.jump_until) object.uncertainty = std::max(object.uncertainty, track.jump);
}

}  // namespace handsel::spark
