// One object as followed over time: its place from several observations, and how sure that is.
// Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/collision/collision_world.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"

namespace handsel::spark {

/// Unseen for longer, nothing is known of the velocity of an object [s].
inline constexpr double kVelocityGap = 0.3;
/// What is held and unseen for longer moves with the hand [s].
inline constexpr double kMissed = 0.1;

/// An object with everything that is remembered of the observations.
struct ObjectTrack {
  SceneObject object;                      ///< estimate; its age is that of the last scene
  std::size_t by{};                        ///< robot hand that holds the object, or held it last
  Pose T_palm_object{Pose::Identity()};    ///< in the palm frame of that hand
  TimePoint seen{};                        ///< capture of the newest sample
  int samples{};                           ///< number that make up the estimate; 0: none
  Vector3 last_seen_at{Vector3::Zero()};   ///< of the newest sample, world [m]
  std::vector<ObservedGrip> grips;         ///< of the newest sample
  std::string source;                      ///< source that is believed
  double spread{};                         ///< distance at which another source sees the object [m]
  TimePoint spread_until{};                ///< end of `spread`
  double jump{};                           ///< faster than anybody carries [m]
  TimePoint jump_until{};                  ///< end of `jump`
  int hand{};                              ///< joint of the person who holds the object
  Vector3 p_hand_object{Vector3::Zero()};  ///< from that joint, world axes [m]
  std::optional<TimePoint> gripped;        ///< sample that `p_hand_object` is of
  double wandered{};                       ///< max distance moved since the object was seen [m]
  TimePoint evaluated{};                   ///< when `wandered` was computed
};

using ObjectTracks = std::map<std::string, ObjectTrack>;  ///< by id of the object

/// Returns whether the object is described or a primitive of a size; leaves model or primitive, of
/// which a described model counts more.
bool has_shape(ObservedObject& observed, const ObjectLibrary& library);
/// Exchanges the ids of two things of a kind that have changed places faster than anybody could
/// carry them. `at`: capture of the observation.
void unswap(std::vector<ObservedObject>& observed, const ObjectTracks& tracks, TimePoint at);

/// Returns whether a sample of this source counts: one source is believed at a time, so that an
/// object at rest does not move between two that differ. A source that differs adds to `spread` for
/// `doubt_time` [s].
bool believes(ObjectTrack& track, const ObservedObject& observed, const std::string& source,
              TimePoint seen, double doubt_time);
/// Takes a sample. `doubt_time`: for which a jump makes the place uncertain [s].
void add_sample(ObjectTrack& track, const ObservedObject& observed, TimePoint seen,
                double doubt_time);
/// Computes the uncertainty from the distance that the object may have moved unseen; with a person
/// no farther than that person may have gone.
void mislay(ObjectTrack& track, const HumanState& people, TimePoint now,
            const settings::SparkSettings& settings);

}  // namespace handsel::spark
