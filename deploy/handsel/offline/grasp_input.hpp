// What the commands about grasps read, and the list they all begin with.
#pragma once

#include <CLI/CLI.hpp>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel {

struct ListOptions {
  std::string hand{"sah"}, object;
  double scale{1}, friction{0};
  std::uint32_t positions{grasp_planner::GraspListSettings{}.positions}, orientations{grasp_planner::GraspListSettings{}.orientations};
  std::uint64_t seed{1};
  bool as_json{};
};

void add_list_options(CLI::App& command, ListOptions& options);

/// A mesh file, or the name or file of an object description.
ObjectModel object_of(const ListOptions& options);

struct Listed {
  std::shared_ptr<const grasp_planner::HandKit> kit;
  std::shared_ptr<const grasp_planner::FingerWorkspaces> workspaces;
  std::shared_ptr<const grasp_planner::Graspable> object;
  grasp_planner::GraspList list;
  double seconds{};  ///< that the list took
};
std::shared_ptr<const grasp_planner::HandKit> kit_of(const std::string& hand);
/// Hand and object without workspaces and list.
Listed prepared(const std::string& hand, const ListOptions& options, bool quiet = false);
/// Makes the list of a hand (name or file) on the options' object; findings, counts and time go to stderr unless `quiet`.
Listed list_with(const std::string& hand, const ListOptions& options, bool quiet = false);

}  // namespace handsel
