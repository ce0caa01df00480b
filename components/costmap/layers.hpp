// SPDX-License-Identifier: Apache-2.0
// Computes the cost map of one person: safety, visibility, arm comfort with regard to furniture,
// and their weighted sum over one grid (chapter section 4.1.2). Pure.
#pragma once

#include <array>
#include <list>
#include <string>
#include <vector>

#include "common/cost/human_cost.hpp"
#include "common/messages/world.hpp"
#include "components/costmap/comfort_volume.hpp"

namespace handsel::costmap {

/// Grid and cost functions of a cost map.
struct MapSettings {
  double resolution{0.025};  ///< edge of a cell [m]
  double reach{1.0};         ///< half edge of the grid around the midpoint of the shoulders [m]
  double clearance{0.04};    ///< min distance of an exchange point from a box [m]
  CostSettings cost;         ///< human-aware cost functions and weights of the layers
};

using Layers = std::array<Costmap, std::size(kOwnLayers)>;  ///< in the order of kOwnLayers

/// Computes the layers of one person at a time; caches the comfort volumes by arm lengths.
class MapMaker {
 public:
  explicit MapMaker(const MapSettings& settings) : settings_(settings) {}
  /// Returns the layers with values as in Costmap, valid until the next call. "arm_comfort" is 255
  /// out of reach and where furniture blocks the arm (ReachCheck); "total" counts these points as
  /// cost 1 of the arm; the other two are never 255. The grid is aligned with the world, with
  /// points at multiples of the resolution.
  const Layers& make(const Person& person, const std::vector<SceneBox>& boxes);

 private:
  const ComfortVolume& volume_of(const ArmSize& arm);
  void fill_comfort(const Person& person, const std::vector<SceneBox>& boxes, Costmap& map);
  void fill_others(const Person& person);

  MapSettings settings_;
  std::list<ComfortVolume> volumes_;  // most recently used first
  Layers layers_;
};

/// Detects changes of person and boxes that require a new map.
class Watch {
 public:
  Watch(double moved, double turned) : moved_(moved), turned_(turned) {}
  /// Returns whether the person is another, moved, turned or changed the gaze, or the scene's boxes
  /// changed since the last call that returned true.
  bool changed(const Person& person, const std::vector<SceneBox>& boxes);

 private:
  double moved_, turned_;
  std::string person_;
  std::vector<Vector3> joints_;
  std::array<Vector3, 2> directions_{Vector3::UnitX(), Vector3::UnitX()};  // torso, gaze
  std::vector<SceneBox> boxes_;
};

/// Returns the person whose shoulders are nearest to a point; nullptr: none.
const Person* nearest_person(const HumanState& people, const Vector3& point);

}  // namespace handsel::costmap
