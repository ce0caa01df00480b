// SPDX-License-Identifier: Apache-2.0
// Grasp lists on disk: Protobuf, versioned, named by the content they were made from. Safe against
// two writers and a kill.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner {

/// Hash of everything a frame depends on: hand, mesh and parts, settings, version of the method.
/// How many orientations are asked for does not count: more of them only extend a list.
std::uint64_t list_key(const HandModel& hand, const ObjectModel& object,
                       const GraspListSettings& settings);

/// $XDG_CACHE_HOME/handsel, else $HOME/.cache/handsel; empty when neither is set.
std::filesystem::path default_store();

class GraspStore {
 public:
  /// An empty folder: nothing is kept.
  explicit GraspStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The longest list of at most `max_frames` frames. nullopt when there is none, or when all are
  /// damaged, of another version or made from something else: then it is made again.
  std::optional<GraspList> load(const std::string& hand, const std::string& object,
                                std::uint64_t key, std::uint64_t max_frames) const;
  /// Written beside and renamed; false when the folder cannot be written to.
  bool save(const GraspList& list, std::uint64_t key) const;
  /// Returns the path of the file that holds a list of so many frames; characters that are neither
  /// letter nor digit are replaced by "_".
  std::filesystem::path file(const std::string& hand, const std::string& object, std::uint64_t key,
                             std::uint64_t frames) const;

 private:
  static std::string stem(const std::string& hand, const std::string& object, std::uint64_t key);
  static std::optional<GraspList> read(const std::filesystem::path& file, std::uint64_t key);
  std::filesystem::path folder_;
};

}  // namespace handsel::grasp_planner
