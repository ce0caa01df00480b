// SPDX-License-Identifier: Apache-2.0
// What the commands about grasps read, and the list they all begin with.
#pragma once

#include <CLI/CLI.hpp>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel {

struct ListOptions {
  std::string hand{"sah"}, object;  ///< name or file of a description; object: or a mesh file
  /// Factor on the object's size; Coulomb coefficient, 0: the object's.
  double scale{1}, friction{0};
  /// Number of positions of the hand in the object's box, and of orientations at each.
  std::uint32_t positions{grasp_planner::GraspListSettings{}.positions},
      orientations{grasp_planner::GraspListSettings{}.orientations};
  std::uint64_t seed{1};  ///< of the contact points
  bool as_json{};         ///< JSON Lines also on a terminal
};

/// Adds --hand, --object (required), --scale, --positions, --orientations, --mu, --seed, --json.
void add_list_options(CLI::App& command, ListOptions& options);

/// Loads the object, scaled: a mesh file, or the name or file of an object description. Throws as
/// load_mesh() and ObjectModel::load().
ObjectModel object_of(const ListOptions& options);

struct Listed {
  std::shared_ptr<const grasp_planner::HandGeometry> hand_geometry;   ///< model of the hand
  std::shared_ptr<const grasp_planner::FingerWorkspaces> workspaces;  ///< null from prepared()
  std::shared_ptr<const grasp_planner::Graspable> object;             ///< with its contact points
  grasp_planner::GraspList list;  ///< empty from prepared(); best grasp first
  double seconds{};               ///< that the list took
};
/// Loads a hand by the name or file of its description.
std::shared_ptr<const grasp_planner::HandGeometry> hand_geometry_of(const std::string& hand);
/// Hand and object without workspaces and list.
Listed prepared(const std::string& hand, const ListOptions& options, bool quiet = false);
/// Makes the list of a hand (name or file) on the options' object; findings, counts and time go to
/// stderr unless `quiet`.
Listed list_with(const std::string& hand, const ListOptions& options, bool quiet = false);

}  // namespace handsel
