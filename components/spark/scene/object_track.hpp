// SPDX-License-Identifier: Apache-2.0
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

/// The grasp of a robot hand at its last measurement of the load.
struct RobotGrip {
  Vector fingers;         ///< RobotPlacement::Hand::fingers
  Vector3 p_palm_object;  ///< position of the object in the palm frame [m]
};

/// An object with the stored results of the observations.
struct ObjectTrack {
  SceneObject object;        ///< estimate; `age` as of the last scene
  std::size_t robot_hand{};  ///< index of the last robot hand that held the object
  /// Pose in the palm frame of `robot_hand` at the newest sample, held or not.
  Pose T_palm_object{Pose::Identity()};
  std::optional<RobotGrip> robot_grip;    ///< grasp of that hand; nullopt: none so far
  TimePoint seen{};                       ///< capture of the newest sample
  int samples{};                          ///< number of averaged samples; 0: none
  Vector3 last_seen_at{Vector3::Zero()};  ///< position of the newest sample, world [m]
  std::vector<ObservedGrip> grips;        ///< of the newest sample, by people or the robot
  std::string source;                     ///< name of the selected source
  double spread{};                        ///< distance between the selected source and another [m]
  TimePoint spread_until{};               ///< end of `spread`
  double jump{};           ///< last jump, faster than a person can carry an object [m]
  TimePoint jump_until{};  ///< end of `jump`
  int hand{};              ///< joint of the holder's hand; valid while a person holds the object
  Vector3 p_hand_object{Vector3::Zero()};  ///< position relative to that joint, world axes [m]
  /// Capture time of the sample of `p_hand_object`.
  std::optional<TimePoint> hand_offset_time;
  double max_drift{};     ///< upper bound of the distance moved since the last observation [m]
  TimePoint evaluated{};  ///< time of the last update of `max_drift`
};

using ObjectTracks = std::map<std::string, ObjectTrack>;  ///< by id of the object

/// Selects the shape of `observed`: the model if the library has one, else the primitive if it has
/// a size. Returns whether a shape exists.
bool select_shape(ObservedObject& observed, const ObjectLibrary& library);
/// Swaps the ids of two objects of a kind that have exchanged places faster than a person can carry
/// them. `at`: capture time of the observation.
void correct_swapped_ids(std::vector<ObservedObject>& observed, const ObjectTracks& tracks,
                         TimePoint at, const settings::SparkSettings& settings);

/// Returns whether a sample is used: of the selected source, or of another, then selected, after
/// source_timeout. Else a distance above source_agreement is `spread` for doubt_time.
bool accept_source(ObjectTrack& track, const ObservedObject& observed, const std::string& source,
                   TimePoint seen, const settings::SparkSettings& settings);
/// Adds a sample that accept_source() accepts. After a jump the uncertainty is at least the length
/// of the jump for doubt_time.
void add_sample(ObjectTrack& track, const ObservedObject& observed, TimePoint seen,
                const settings::SparkSettings& settings);
/// Updates the uncertainty: drift while unseen, up to unseen_most and 0 in the robot's hand, plus
/// the inflation of a person who holds it, plus `spread`; at least `jump`.
void update_uncertainty(ObjectTrack& track, const HumanState& people, TimePoint now,
                        const settings::SparkSettings& settings);

}  // namespace handsel::spark
