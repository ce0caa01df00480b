// SPDX-License-Identifier: Apache-2.0
// Where an object can be put down on a surface, and how the arm gets it there. Own method. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/config/settings/manipulation_planner.hpp"
#include "common/messages/world.hpp"
#include "common/model/arm_reach.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::manipulation_planner {

/// What is put down is released this far above the surface [m].
inline constexpr double kAbovePlace = 0.004;

struct PlacingSettings {
  double gap{};                     ///< min distance from other things, for the hand [m]
  double min_gap{};                 ///< the same where no place has `gap`: the hand may fit [m]
  double max_gap{};                 ///< distance from other things beyond which none is better [m]
  double far_person{};              ///< distance from a person beyond which none is better [m]
  double edge{};                    ///< width at the edge of the surface that remains free [m]
  double grid{};                    ///< distance between places that are tried [m]
  double apart{};                   ///< min distance between places that are returned [m]
  double best_reach{};              ///< fraction of the arm's reach at which the arm works best
  double min_tipping{};             ///< tilt that an object laid on its side must withstand [rad]
  std::optional<ArmReach> reach{};  ///< of the arm that puts it down; left out: of the group "arm"
};

/// Returns the part of the settings that concerns places; `reach` is left out.
PlacingSettings placing_settings(const settings::ManipulationPlannerSettings& s);

/// How the hand moves at a place [m].
struct PlacingMotion {
  double from_above{};  ///< height from which the object is lowered
  double margin{};      ///< by which the hand must be able to be lower at the place
};

/// What places are searched in; what is referred to must outlive the search.
struct PlacingScene {
  const RobotModel& robot;       ///< that puts the object down
  const Scene& scene;            ///< furniture, objects and base of the robot
  const HumanState& people;      ///< joints in the world frame
  const ObjectLibrary& library;  ///< models of the objects
};

/// Returns free places for an object that stands upright there, T_world_object each, the best
/// first, at most `max_places`: where the arm reaches well, away from other things and from people.
/// The object is turned about the vertical by as much as the arm turns to get there from
/// `T_world_object`.
std::vector<Pose> free_places(const PlacingScene& in, const std::string& object,
                              const SceneBox& surface, const Pose& T_world_object,
                              std::size_t max_places, const PlacingSettings& settings);

/// Poses at which an object rests on a surface.
struct RestingPlaces {
  std::vector<Pose> T_world_object;  ///< the best first
  /// Point of the object whose vertical the object may turn about, in its frame [m].
  Vector3 p_object_turn{Vector3::Zero()};
};

/// Returns the other sides that the object can lie on at `upright_places` (as from free_places()),
/// the most stable side first, those that tip over below `min_tipping` [rad] left out. The mass
/// centre is above the point where the object's origin would stand.
RestingPlaces lying_places(const std::vector<Pose>& upright_places, const ObjectModel& model,
                           double min_tipping);

/// Configurations that put what the hand holds at a place: from above, then down to it.
struct PlacingConfiguration {
  Pose T_world_object{Pose::Identity()};  ///< at the place
  Vector arm_above, arm_at;               ///< arm axes [rad]
  bool opens{};  ///< the hand can open there without touching anything else
};

/// Puts what is held on a surface, somewhere.
class Putting {
 public:
  /// The references must outlive what is made; `world` knows scene and people; its attachment is
  /// changed. `places` as from free_places() or lying_places().
  Putting(CollisionWorld& world, const RobotModel& robot, const Group& arm,
          const Pose& T_world_base, RestingPlaces places, const PlacingMotion& motion);

  /// Adds a configuration of the arm [rad] near which others are searched, beside the present one
  /// and the one at rest: an arm does not find every configuration from everywhere.
  void search_near(const Vector& arm_joints) { seeds_.push_back(arm_joints); }
  /// Returns configurations for this place, its object turned about the vertical as is best for the
  /// arm, where the hand can open if possible; nullopt: the reason is counted for objections().
  /// `q`: all axes, the hand closed on the object; `opened`: all axes, after the release.
  std::optional<PlacingConfiguration> at(const Pose& place, const Vector& q, const Vector& opened,
                                         const Attachment& held);
  /// Returns configurations for the first `max_count` places where the object can be, those where
  /// the hand can open before the others.
  std::vector<PlacingConfiguration> anywhere(const Vector& q, const Vector& opened,
                                             const Attachment& held, std::size_t max_count);
  /// Returns the most frequent reasons so far, with their counts: "12 out of reach, 3 because link
  /// forearm would touch box table".
  std::string objections() const;

 private:
  std::optional<PlacingConfiguration> reach(const Pose& T_world_object, const Vector& q_seed,
                                            const Attachment& held);
  bool is_free(const Vector& q, const PlacingConfiguration& down);
  bool has_margin(const Vector& q, const PlacingConfiguration& down, const Attachment& held);

  CollisionWorld& world_;
  const RobotModel& robot_;
  const Group& arm_;
  Pose T_base_world_;
  RestingPlaces places_;
  PlacingMotion motion_;
  std::vector<Vector> seeds_;
  std::map<std::string, int> objections_;
};

}  // namespace handsel::manipulation_planner
