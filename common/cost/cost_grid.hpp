// SPDX-License-Identifier: Apache-2.0
// One layer of a cost map, ready to be asked anywhere: trilinear, with its gradient. Pure.
#pragma once

#include <string>

#include "common/messages/world.hpp"

namespace handsel {

struct GridValue {
  /// [0, 1], of the neighbouring points that are not forbidden; 0 outside the grid, 1 where all
  /// are.
  double cost{};
  Vector3 gradient{Vector3::Zero()};  ///< of `cost` [1/m]
  bool inside{};                      ///< the point lies in the grid
  /// At least half of the neighbouring points, by their weights, are forbidden or out of reach.
  bool forbidden{};
};

class CostGrid {
 public:
  /// Returns why a map cannot be used, one sentence; empty when it can.
  static std::string fault(const Costmap& map);
  /// Of a map without fault.
  explicit CostGrid(Costmap map);

  /// Interpolates cost and gradient at a point of the world [m]; all zero outside the grid.
  GridValue at(const Vector3& p_world) const;
  /// The same without the gradient.
  GridValue value(const Vector3& p_world) const;
  bool forbids() const { return forbids_; }  ///< some point is forbidden
  /// Returns the name of the layer, as its writer calls it.
  const std::string& layer() const { return map_.layer; }
  /// Returns the id of the person the layer is about; empty when it is about none.
  const std::string& person() const { return map_.person; }
  /// Returns the factor of this layer in the sum of all outside layers.
  double weight() const { return map_.weight; }
  /// Returns the distance of neighbouring grid points [m].
  double resolution() const { return map_.resolution; }

 private:
  struct Cell;
  bool find(const Vector3& p_world, Cell& cell) const;
  Costmap map_;
  bool forbids_{};
};

}  // namespace handsel
