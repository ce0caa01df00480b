// SPDX-License-Identifier: Apache-2.0
// Double grasps: two hands on one object at a time, of a robot or of a robot and a person (chapter
// section 3.2.8).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner {

/// One hand's side of a double grasp.
struct HandSide {
  const HandGeometry* hand_geometry{};  ///< geometry of the hand
  const GraspList* list{};              ///< grasps of the hand on the object
  /// Closeness of the arm to its rest configuration, per grasp of the list, best 1
  /// (rest_scores_of()); below 0: out of reach, excluded. Empty: not evaluated.
  std::vector<double> rest_score{};
  std::vector<std::size_t> also{};  ///< grasps that are always included
};

struct DoubleGrasp {
  std::size_t first{}, second{};  ///< indices into the two lists
  double quality{};               ///< the smaller of the two
  double rest_score{};            ///< the smaller of the two; 0 when not asked
  /// Angle between the wrists' directions, the z axes of the hands [rad]; pi: straight against each
  /// other.
  double opposition{};
  /// Retreat directions, unit, hand frames; 0 if not evaluated.
  Vector3 retreat_first{Vector3::Zero()}, retreat_second{Vector3::Zero()};
  double score{};  ///< sum of quality and nearness to rest, each normalised over the list
};

/// Which grasps of a list are paired: the best, or the best of every orientation and side of the
/// object in turn (own method: the best grasps are at the middle of the object and leave no room
/// for a second hand).
enum class Taken : std::uint8_t { best, spread };

/// Returns indices into the list, at most `count` and those of `also`. `p_object_middle`: of the
/// object's box.
std::vector<std::size_t> taken_grasps(const GraspList& list, std::size_t count, Taken taken,
                                      const Vector3& p_object_middle,
                                      const std::vector<std::size_t>& also = {});

struct DoubleSettings {
  std::size_t max_of_each{200};              ///< grasps taken from each list
  Taken taken{Taken::best};                  ///< how those are chosen
  Vector3 p_object_middle{Vector3::Zero()};  ///< for spread grasps
  double clearance{0.0};                     ///< between the hands [m]
  double palm_clearance{0.0};  ///< between either palm and the other hand, when more [m]
  double min_opposition{0.0};  ///< [rad] for a transfer: wrists opposed by at least this
  /// The object of a transfer: either hand, opened, must be able to approach and retreat straight
  /// over `stand_off`, clear of the object and the other hand. nullptr: not checked.
  const Graspable* passed{};
  double stand_off{0.09};           ///< [m]
  double retreat_clearance{0.002};  ///< clearance on that path [m]
};

struct DoubleList {
  std::vector<DoubleGrasp> grasps;  ///< best score first
  /// Pairs examined, and of these those left out: hands collide; wrists not opposed enough; no room
  /// to come or leave; an arm does not reach.
  std::uint64_t pairs{}, colliding{}, not_opposed{}, no_retreat{}, out_of_reach{};

  /// Counts per reason of the pairs without a double grasp.
  Refusals refusals() const;
};

/// Returns all pairs that do not collide. `cancelled` is asked for each grasp of `a`; if true, the
/// list is incomplete.
DoubleList list_double_grasps(const HandSide& a, const HandSide& b,
                              const DoubleSettings& settings = {},
                              const std::function<bool()>& cancelled = {});

/// Returns the nearness of an arm to its rest configuration, [0, 1]: one minus the mean fraction of
/// the ranges its axes are away from there.
double rest_score_of(const RobotModel& robot, const Group& arm, const Vector& arm_q);

/// For each grasp of a list the smaller rest_score_of() of reaching it with the object at its start
/// and at its goal; -1 when the arm does not reach one of them. `q_seed`: all axes.
std::vector<double> rest_scores_of(const RobotModel& robot, const Group& arm, const Vector& q_seed,
                                   const GraspList& list, const std::vector<Pose>& T_root_object);

}  // namespace handsel::grasp_planner
