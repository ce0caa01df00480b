// The comfort of a person's arm over a grid of points around the shoulders, validated against the environment (chapter section 4.1.2).
// Pure.
#pragma once

#include <string>
#include <vector>

#include "common/messages/world.hpp"
#include "components/costmap/comfort_volume.hpp"

namespace handsel::costmap {

struct MapSettings {
  double resolution{0.05};  ///< edge of a cell [m]
  double reach{0.9};        ///< half edge of the grid around the middle of the shoulders [m]
  double clearance{0.04};   ///< points nearer than this to a box are no place to exchange [m]
};

/// Makes maps of one person after another; keeps the volume of the arm's comfort while the arm stays as long as it is.
class MapMaker {
 public:
  explicit MapMaker(const MapSettings& settings) : settings_(settings) {}
  /// Values as in Costmap: 255 out of reach, inside, near or under a box that is lower than the shoulders, or where a box stands between
  /// both shoulders and the point; else comfort cost * 254. The grid is aligned with the world, its cells lie on multiples of the
  /// resolution.
  Costmap make(const Person& person, const std::vector<SceneBox>& boxes);

 private:
  MapSettings settings_;
  ComfortVolume left_, right_;
};

/// Where the person was when a map was made: tells when it has to be made anew.
class Watch {
 public:
  Watch(double moved, double turned) : moved_(moved), turned_(turned) {}
  /// True when the person is another, moved or turned, or the scene's boxes changed since the last time it returned true.
  bool changed(const Person& person, const std::vector<SceneBox>& boxes);

 private:
  double moved_, turned_;
  std::string person_;
  std::vector<Vector3> joints_;
  Vector3 forward_{Vector3::UnitX()};
  std::vector<SceneBox> boxes_;
};

/// The person whose shoulders are nearest to a point, or nullptr.
const Person* nearest_person(const HumanState& people, const Vector3& point);

}  // namespace handsel::costmap
