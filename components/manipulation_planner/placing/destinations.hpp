// SPDX-License-Identifier: Apache-2.0
// Where what is taken by a grasp can be put down: found before the grasp, used by the action that
// places the object. Pure.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel::manipulation_planner {

/// Where what is taken by a grasp can be put down.
struct Destination {
  std::uint64_t grasp{};  ///< id of the grasp
  std::string object;     ///< scene object id
  std::string surface;    ///< id of the box that it stands on
  Pose T_world_object;    ///< of the object at its place
  Vector arm_at;          ///< arm axes that put the object there [rad]
};

class Destinations {
 public:
  /// Forgets all.
  void clear() { all_.clear(); }
  /// Adds one.
  void add(const Destination& destination) { all_.push_back(destination); }
  /// Returns whether there is one for a grasp.
  bool has(std::uint64_t grasp) const {
    return std::any_of(all_.begin(), all_.end(),
                       [&](const Destination& d) { return d.grasp == grasp; });
  }
  /// Returns the first one of a grasp, an object and a surface; nullopt: none.
  std::optional<Destination> find(std::uint64_t grasp, const std::string& object,
                                  const std::string& surface) const {
    const auto found = std::find_if(all_.begin(), all_.end(), [&](const Destination& d) {
      return d.grasp == grasp && d.object == object && d.surface == surface;
    });
    return found == all_.end() ? std::nullopt : std::optional<Destination>(*found);
  }

 private:
  std::vector<Destination> all_;
};

}  // namespace handsel::manipulation_planner
