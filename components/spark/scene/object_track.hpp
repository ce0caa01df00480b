// Tracking of one object: pose from several observations, with its uncertainty. Pure.
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

/// After this time without observation the velocity of an object is unknown [s].
inline constexpr double kVelocityGap = 0.3;
/// An object that is held and has not been observed for this time is moved with the hand [s].
inline constexpr double kFollowHandAfter = 0.1;

/// How a hand of the robot had an object when it last felt the load.
struct RobotGrip {
  Vector fingers;         ///< RobotPlacement::Hand::fingers
  Vector3 p_palm_object;  ///< position of the object in the palm frame [m]
};

/// An object with everything that is remembered of the observations.
struct ObjectTrack {
  SceneObject object;        ///< estimate; its age is that of the last scene
  std::size_t robot_hand{};  ///< index of the robot hand that holds the object or held it last
  Pose T_palm_object{Pose::Identity()};   ///< in the palm frame of that hand
  std::optional<RobotGrip> robot_grip;    ///< of that hand; nullopt: it never had the object
  TimePoint seen{};                       ///< capture of the newest sample
  int samples{};                          ///< number that make up the estimate; 0: none
  Vector3 last_seen_at{Vector3::Zero()};  ///< of the newest sample, world [m]
  std::vector<ObservedGrip> grips;        ///< of the newest sample
  std::string source;                     ///< name of the trusted source
  double spread{};  ///< distance between the positions of the trusted source and another [m]
  TimePoint spread_until{};  ///< `spread` counts until then
  double jump{};  ///< last jump of the position, faster than anybody can carry an object [m]
  TimePoint jump_until{};  ///< `jump` counts until then
  int hand{};              ///< joint of the holder's hand; of use while a person holds the object
  Vector3 p_hand_object{Vector3::Zero()};  ///< position relative to that joint, world axes [m]
  std::optional<TimePoint>
      hand_offset_time;   ///< capture time of the sample that gave `p_hand_object`
  double wandered{};      ///< upper bound of the distance moved since the last observation [m]
  TimePoint evaluated{};  ///< when `wandered` was computed
};

using ObjectTracks = std::map<std::string, ObjectTrack>;  ///< by id of the object

/// Keeps one shape in `observed`: the model if the library knows it, else the primitive if it has a
/// size. Returns whether there was one.
bool select_shape(ObservedObject& observed, const ObjectLibrary& library);
/// Corrects the ids of two objects of a kind that seem to have changed places faster than anybody
/// could carry them: their ids are swapped back. `at`: capture time of the observation.
void correct_swapped_ids(std::vector<ObservedObject>& observed, const ObjectTracks& tracks,
                         TimePoint at);

/// Returns whether a sample is to be used. One source is trusted at a time, so that an object at
/// rest does not move between two that differ; the distance of another one counts as `spread` for
/// `doubt_time` [s].
bool accept_source(ObjectTrack& track, const ObservedObject& observed, const std::string& source,
                   TimePoint seen, double doubt_time);
/// Adds a sample to the estimate. `doubt_time`: how long a jump adds to the uncertainty [s].
void add_sample(ObjectTrack& track, const ObservedObject& observed, TimePoint seen,
                double doubt_time);
/// Computes the uncertainty of an object that is not observed from the distance it may have moved,
/// up to a limit of the settings. In the hand of a person the inflation of that person is added.
void update_uncertainty(ObjectTrack& track, const HumanState& people, TimePoint now,
                        const settings::SparkSettings& settings);

}  // namespace handsel::spark
