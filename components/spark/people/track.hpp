// One person as followed over time: the body merged from all sources, its motion and its size.
// Pure.
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

/// A person with everything that is remembered of the observations.
struct Track {
  Person person;  ///< as of `seen`; age, inflation and hands are not set
  std::map<std::string, std::string> bodies;  ///< id of the body, by source
  TimePoint born{};                           ///< capture of the first observation
  TimePoint seen{};                           ///< time that the body of `person` stands for
  std::optional<TimePoint> gaze_seen;         ///< when the gaze was seen last
  std::array<std::optional<TimePoint>, kBodyJoints.size()> joint_seen;  ///< when each was seen last
  BodyMotion motion;                                  ///< velocities of the joints
  BodySize size;                                      ///< stature, from the joints seen
  std::array<HandPredictor, 2> hands;                 ///< left, right
  std::array<std::optional<TimePoint>, 2> hand_seen;  ///< last sample of each predictor
  double doubt{};                                     ///< inflation until `doubted_until` [m]
  TimePoint doubted_until{};                          ///< end of `doubt`
  std::optional<TimePoint> empty_since;  ///< since when the volume of a lost person is seen empty
  bool adopted{};  ///< from the safety state, and not seen by this process yet
  /// Appeared at the field-of-view boundary, and nobody who had left is known to be this person.
  bool came_in{};
  std::string left_by;   ///< source over whose boundary the person left; empty: none
  TimePoint confined{};  ///< when that source last showed that the person had not come back

  /// Time since the body was seen [s].
  double age(TimePoint now) const { return to_seconds(now - seen); }
};

/// Returns the horizontal distance between the joints of a body and the same joints of the track
/// [m], averaged by confidence; infinity: they share no joint.
double distance(const Track& track, const ObservedPerson& body);

/// Merges an observed body, captured at `seen`, into the track. `jump`: distance of the body from
/// the track [m]; one too far for a person inflates the track for some time.
void update(Track& track, const ObservedPerson& body, TimePoint seen, double jump,
            const settings::SparkSettings& settings);

/// Returns where the hands of the track will be. `person`: the person of the track as of `now`,
/// whose inflation widens the volumes.
std::vector<HandPrediction> hands_ahead(const Track& track, const Person& person, TimePoint now);

}  // namespace handsel::spark
