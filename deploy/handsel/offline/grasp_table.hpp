// SPDX-License-Identifier: Apache-2.0
// Hands against objects: how many grasps, how good, how long it took, and why the other frames gave
// none.
#pragma once

#include <string>
#include <vector>

#include "deploy/handsel/offline/grasp_input.hpp"

namespace handsel {

struct TableRow {
  std::string hand, object;  ///< as given; file name of the object without folder and extension
  double scale{1};           ///< what the object was multiplied by
  double size{};             ///< its largest extent then [m]
  std::size_t triangles{}, grasps{};  ///< of the object's mesh; found
  std::uint64_t frames{};             ///< grasp frames that were tested
  double best{};                      ///< quality
  double seconds{};                   ///< for the list
  std::string findings;               ///< of the mesh
  /// "Frames: most frequent reason" of those without grasp, also beside grasps; or the error.
  std::string reason;
};

/// Factor that makes an object of these extents one for this hand: 1 when its middle extent is
/// between 0.15 and 0.75 of the hand's opening, else what makes it half the opening.
double fitting_scale(const Vector3& extents, double opening);
/// Returns the distance between thumb and the most distant other fingertip, ready to enclose; of
/// two pads their widest gap [m].
double opening_of(const grasp_planner::HandGeometry& hand_geometry);

/// Lists the grasps of `hand` (name or file; `options.hand` is ignored) on `options.object`, with
/// `fit` scaled for the hand. Writes a ConfigError to `reason`; throws MissingError.
TableRow table_row(const std::string& hand, const ListOptions& options, bool fit);
/// Returns the line with the titles of the columns, without line feed.
std::string table_head();
/// Returns the row below table_head(); long names are cut.
std::string table_line(const TableRow& row);

}  // namespace handsel
