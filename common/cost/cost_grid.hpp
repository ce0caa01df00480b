// One layer of a cost map, ready to be asked anywhere: trilinear, with its gradient. Pure.
#pragma once

#include <string>

#include "common/messages/world.hpp"

namespace handsel {

struct GridValue {
  double cost{};                      ///< [0, 1], of the neighbouring points that are not forbidden; 0 outside the grid, 1 where all are
  Vector3 gradient{Vector3::Zero()};  ///< of `cost` [1/m]
  bool inside{};                      ///< the point lies in the grid
  bool forbidden{};                   ///< at least half of the neighbouring points, by their weights, are forbidden or out of reach
};

class CostGrid {
 public:
  /// Why a map cannot be used, one sentence; empty when it can.
  static std::string fault(const Costmap& map);
  /// Of a map without fault.
  explicit CostGrid(Costmap map);

  GridValue at(const Vector3& p_world) const;
  /// The same without the gradient.
  GridValue value(const Vector3& p_world) const;
  bool forbids() const { return forbids_; }  ///< some point is forbidden
  const std::string& layer() const { return map_.layer; }
  const std::string& person() const { return map_.person; }
  double weight() const { return map_.weight; }
  double resolution() const { return map_.resolution; }

 private:
  struct Cell;
  bool find(const Vector3& p_world, Cell& cell) const;
  Costmap map_;
  bool forbids_{};
};

}  // namespace handsel
