// The cost map of one person: safety, visibility, the arm's comfort validated against the
// furniture, and their weighted sum over one grid (chapter section 4.1.2). Pure.
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
  double reach{1.0};         ///< half edge of the grid around the middle of the shoulders [m]
  double clearance{0.04};    ///< points nearer than this to a box are no place for a handover [m]
  CostSettings cost;         ///< of the human-aware cost functions, with the weights of the layers
};

using Layers = std::array<Costmap, std::size(kOwnLayers)>;  ///< in the order of kOwnLayers

/// Makes the layers of one person after another; keeps the volumes of arms by their lengths.
class MapMaker {
 public:
  explicit MapMaker(const MapSettings& settings) : settings_(settings) {}
  /// Values as in Costmap. "arm_comfort" is 255 out of reach and where a ReachCheck says that
  /// furniture blocks the arm; "total" counts such points as cost 1 of the arm; the other two are
  /// never 255. The grid is aligned with the world, its points lie on multiples of the resolution.
  /// Valid until the next call.
  const Layers& make(const Person& person, const std::vector<SceneBox>& boxes);

 private:
  const ComfortVolume& volume_of(const ArmSize& arm);
  void fill_comfort(const Person& person, const std::vector<SceneBox>& boxes, Costmap& map);
  void fill_others(const Person& person);

  MapSettings settings_;
  std::list<ComfortVolume> volumes_;  // the last asked for first
  Layers layers_;
};

/// Where the person was when a map was made: tells when it has to be made anew.
class Watch {
 public:
  Watch(double moved, double turned) : moved_(moved), turned_(turned) {}
  /// True when the person is another, moved, turned or turned the gaze, or the scene's boxes
  /// changed since the last time it returned true.
  bool changed(const Person& person, const std::vector<SceneBox>& boxes);

 private:
  double moved_, turned_;
  std::string person_;
  std::vector<Vector3> joints_;
  std::array<Vector3, 2> directions_{Vector3::UnitX(), Vector3::UnitX()};  // torso, gaze
  std::vector<SceneBox> boxes_;
};

/// The person whose shoulders are nearest to a point, or nullptr.
const Person* nearest_person(const HumanState& people, const Vector3& point);

}  // namespace handsel::costmap
