// SPDX-License-Identifier: Apache-2.0
// The track of one person: the body merged from all sources, its motion and its size. Pure.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "components/spark/people/body_motion.hpp"
#include "components/spark/people/body_size.hpp"
#include "components/spark/people/hand_predictor.hpp"

namespace handsel::spark {

/// A person with the stored results of the observations.
struct Track {
  Person person;  ///< as of `seen`; age, inflation and hands are not set
  std::map<std::string, std::string> bodies;  ///< id of the body, by source
  TimePoint born{};                           ///< capture of the first observation
  TimePoint seen{};                           ///< instant of the body of `person`
  std::optional<TimePoint> gaze_seen;         ///< capture of the last gaze
  /// Capture of each joint's last observation.
  std::array<std::optional<TimePoint>, kBodyJoints.size()> joint_seen;
  BodyMotion motion;                                  ///< velocities of the joints
  BodySize size;                                      ///< stature from the observed joints
  std::array<HandPredictor, 2> hands;                 ///< left, right
  std::array<std::optional<TimePoint>, 2> hand_seen;  ///< last sample of each predictor
  std::array<Vector3, 2> palms;                       ///< normals of the palms, world: left, right
  std::array<std::optional<TimePoint>, 2> palm_seen;  ///< capture of the last knuckles of each
  double extra_inflation{};                           ///< inflation until `extra_until` [m]
  TimePoint extra_until{};                            ///< end of `extra_inflation`
  /// Since when sources observe the volume of a lost person empty.
  std::optional<TimePoint> empty_since;
  bool adopted{};  ///< from the safety state, not yet observed by this process
  /// Whether the person appeared at the field-of-view boundary and is not yet identified with a
  /// person who left.
  bool entered_at_boundary{};
  std::string left_by;   ///< source whose boundary the person crossed; empty: none
  TimePoint confined{};  ///< last time at which that source showed no return

  /// Returns the time since the last observation [s].
  double age(TimePoint now) const { return to_seconds(now - seen); }
};

/// Returns the horizontal distance between the joints of a body and the same joints of the track
/// [m], averaged by confidence; infinity: they share no joint.
double distance(const Track& track, const ObservedPerson& body);

/// Merges an observed body, captured at `seen`, into the track. `jump`: distance of the body from
/// the track [m]; a jump too long for a person inflates the track for some time.
void update(Track& track, const ObservedPerson& body, TimePoint seen, double jump,
            const settings::SparkSettings& settings);

/// Returns predictions of the track's hands. `person`: the track's person at `now`, whose inflation
/// enlarges the volumes.
std::vector<HandPrediction> hands_ahead(const Track& track, const Person& person, TimePoint now,
                                        const settings::SparkSettings& settings);

/// Returns the palms whose knuckles were observed within `palm_memory`.
std::vector<PalmDirection> palms_of(const Track& track, TimePoint now,
                                    const settings::SparkSettings& settings);

}  // namespace handsel::spark
