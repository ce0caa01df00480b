// Grasp lists on disk: Protobuf, versioned, named by the content they were made from. Safe against two writers and a kill.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "components/grasp_planner/grasp_list.hpp"

namespace handsel::grasp_planner {

/// Hash of everything a list depends on: hand, mesh and parts, settings, version of the method.
std::uint64_t list_key(const HandModel& hand, const ObjectModel& object, const GraspListSettings& settings);

/// $XDG_CACHE_HOME/handsel, else $HOME/.cache/handsel; empty when neither is set.
std::filesystem::path default_store();

class GraspStore {
 public:
  /// An empty folder: nothing is kept.
  explicit GraspStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// nullopt when there is none, or when it is damaged, of another version or made from something else: then it is made again.
  std::optional<GraspList> load(const std::string& hand, const std::string& object, std::uint64_t key) const;
  /// Written beside and renamed; false when the folder cannot be written to.
  bool save(const GraspList& list, std::uint64_t key) const;
  std::filesystem::path file(const std::string& hand, const std::string& object, std::uint64_t key) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace handsel::grasp_planner
