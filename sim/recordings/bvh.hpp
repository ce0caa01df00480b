// SPDX-License-Identifier: Apache-2.0
// Reads BVH motion files: hierarchy, channels and frames. Pure: text in, positions out. Format
// after Meredith and Maddock, "Motion capture file formats explained".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/pose.hpp"

namespace handsel::sim {

enum class BvhChannel { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

struct BvhJoint {
  std::string name;  ///< without a prefix before ':'; for an end site the parent's name + "_End"
  int parent{-1};    ///< index into Bvh::joints; -1: the root
  Vector3 offset{Vector3::Zero()};   ///< from the parent, file units
  std::vector<BvhChannel> channels;  ///< rotations apply in this order, the first outermost
  int first_channel{};               ///< index in a frame
};

struct Bvh {
  std::vector<BvhJoint> joints;  ///< parents before children
  int channels{};                ///< number of values per frame
  double frame_time{};           ///< time between frames [s]
  std::vector<double> values;    ///< frames x channels: file units and degrees

  /// Returns the number of complete frames.
  std::size_t frames() const {
    return channels > 0 ? values.size() / static_cast<std::size_t>(channels) : 0;
  }
  int find(std::string_view joint) const;  ///< Returns the index of a joint; -1: none.
  /// Writes the world positions of all joints, in file units and axes.
  void positions(std::size_t frame, std::vector<Vector3>& out) const;
};

/// Reads a BVH file. Throws ConfigError "name:line: what is wrong, what would be right".
Bvh parse_bvh(std::string_view text, const std::string& name);

}  // namespace handsel::sim
