// SPDX-License-Identifier: Apache-2.0
#include "components/spark/place.hpp"

#include "common/geometry/pose.hpp"

namespace handsel::spark {
namespace {

/// Returns the floor, z = 0 in the world. Its top is slightly lower, so that standing bodies and
/// the robot's feet do not touch it.
SceneBox floor() {
  constexpr double kSize = 12.0;      // side length [m]
  constexpr double kThickness = 0.1;  // [m]
  constexpr double kBelow = 0.002;    // depth of the top below z = 0 [m]
  return {
      "floor", make_pose({0, 0, -kBelow - 0.5 * kThickness}), {kSize, kSize, kThickness}, false};
}

}  // namespace

std::vector<SceneBox> boxes_of(const config::Scenario& scenario) {
  std::vector<SceneBox> boxes{floor()};
  for (const auto& box : scenario.boxes()) {
    const auto& xyz = box.pose().xyz();
    const auto& rpy = box.pose().rpy();
    const Eigen::Quaterniond q = Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
                                 Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
                                 Eigen::AngleAxisd(rpy.x(), Vector3::UnitX());
    boxes.push_back({box.id(),
                     make_pose({xyz.x(), xyz.y(), xyz.z()}, q),
                     {box.size().x(), box.size().y(), box.size().z()},
                     box.supports()});
  }
  return boxes;
}

std::map<std::string, Vector3> viewpoints_of(const config::Scenario& scenario,
                                             const Calibration& calibration) {
  std::map<std::string, Vector3> eyes;
  for (const auto& [name, source] : calibration.sources())
    if (source.own_frame) eyes[name] = source.T_world_camera.translation();
  for (const auto& sensor : scenario.human_sensors()) {
    const auto& xyz = sensor.pose().xyz();
    if (sensor.occlusion()) eyes[sensor.source()] = {xyz.x(), xyz.y(), xyz.z()};
  }
  return eyes;
}

}  // namespace handsel::spark
