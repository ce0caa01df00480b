// SPDX-License-Identifier: Apache-2.0
// Incremental deterministic grid over all orientations (Yershova et al., chapter section 3.2.2):
// HEALPix on the sphere times the circle.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

namespace handsel::grasp_planner {

/// Number of orientations of the grid of a level: 72 * 8^level.
std::uint64_t so3_grid_size(int level);
/// Cell centre `index` of one level's grid, cells nested: the children of cell i of a level are
/// cells 8 i ... 8 i + 7 of the next.
Eigen::Quaterniond so3_grid_cell(int level, std::uint64_t index);
/// The first `count` orientations of the incremental sequence: level 0, then level 1, and so on;
/// within a level one child of every cell before the second child of any, so that every prefix
/// covers all orientations about evenly. A longer sequence begins with the shorter one.
std::vector<Eigen::Quaterniond> so3_sequence(std::uint64_t count);

}  // namespace handsel::grasp_planner
