// SPDX-License-Identifier: Apache-2.0
// A mesh as cells of a grid: what is solid, and what stays in it when it is filled from above. Own
// method: the surface as dense samples, the inside as what a flood from outside does not reach.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel {

/// Samples of a surface and the solid cells of its volume.
struct VoxelGrid {
  Vector3 origin{Vector3::Zero()};    ///< lower corner of the cell (0, 0, 0), frame of the mesh [m]
  double cell{};                      ///< edge of a cell [m]
  std::array<int, 3> size{};          ///< cells along x, y, z; one empty cell lies at each end
  std::vector<std::uint8_t> solid;    ///< by index(): 1 on the surface or inside, else 0
  std::vector<std::uint8_t> surface;  ///< by index(): 1 where a sample lies, else 0
  std::vector<Vector3> samples;     ///< points of the surface, nearer to each other than a cell [m]
  std::vector<int> cell_of_sample;  ///< index() of the cell of each sample

  /// Returns the index of a cell by its place along x, y and z.
  int index(int x, int y, int z) const { return (z * size[1] + y) * size[0] + x; }
  /// Returns the place of a cell along x, y and z.
  std::array<int, 3> cell_at(int index) const {
    return {index % size[0], index / size[0] % size[1], index / (size[0] * size[1])};
  }
  /// Returns the middle of a cell, frame of the mesh [m].
  Vector3 centre(int index) const {
    const auto [x, y, z] = cell_at(index);
    return origin + cell * Vector3(x + 0.5, y + 0.5, z + 0.5);
  }
  double cell_volume() const { return cell * cell * cell; }  ///< [m^3]
};

/// Returns the grid with `resolution` cells along the longest side of the mesh, which has triangles
/// and a size above 0. An open surface has no inside.
VoxelGrid voxelize(const TriangleMesh& mesh, int resolution);

/// Returns the empty cells, by index(), that hold water poured over the solid with z up.
std::vector<int> cavity_of(const VoxelGrid& grid);

}  // namespace handsel
