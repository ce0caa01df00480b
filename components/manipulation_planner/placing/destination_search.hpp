// SPDX-License-Identifier: Apache-2.0
// Finds places for what is held, or will be: by a job, for the scene as it is now.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "components/manipulation_planner/motion/motion_end.hpp"
#include "components/manipulation_planner/placing/destinations.hpp"
#include "components/manipulation_planner/placing/place_search.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

struct Parts;

/// Which of some grasps serve for putting an object down, and where.
struct ServingGrasps {
  Outcome outcome;                        ///< whether the search ended
  std::map<std::size_t, Destination> at;  ///< by the place of the grasp in its list
  std::string objections;                 ///< why the others do not serve on the last surface
};

/// How much is searched.
struct DestinationLimits {
  std::size_t max_grasps{};  ///< grasps that serve, after which the search ends
  std::size_t max_places{};  ///< best places of a surface that are tried
};

/// Configurations to put down what is held.
struct FoundPlaces {
  Outcome outcome;                                   ///< whether the search ended
  std::vector<PlacingConfiguration> configurations;  ///< best first
  std::string objections;                            ///< why others do not serve, upright
  bool is_lying{};  ///< none stands upright: the object rests on another side
};

// References must outlive the routines.
/// Searches places of a surface for an object taken by one of these grasps. `surface` empty: any.
Routine<ServingGrasps> find_destinations(Parts& parts, const std::string& object,
                                         const std::string& surface,
                                         const std::vector<Grasp>& grasps,
                                         const DestinationLimits& limits);
/// Searches places on a surface where an object of the scene can stand, turned in several ways, in
/// reach of the arm `taker` but perhaps not of the arm in use. `T_world_object`: the object now.
/// Returns T_world_object at the places, the best first.
Routine<std::vector<Pose>> find_standing_places(Parts& parts, const SceneBox& surface,
                                                const std::string& taker, const std::string& object,
                                                const Pose& T_world_object);
/// Searches places on a surface for what is held; the one that was found before the grasp comes
/// first. `opening`: fingers after the release. `taker`: arm that is to reach the place well,
/// because it takes the object from there; empty: the arm in use.
Routine<FoundPlaces> find_places(Parts& parts, const SceneBox& surface, const Vector& opening,
                                 const std::string& taker = "");

}  // namespace handsel::manipulation_planner
