// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/choice/visibility.hpp"

#include <algorithm>

#include "common/geometry/line_of_sight.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr std::size_t kMaxSightPoints = 240;  // surface points sampled
constexpr double kSightOffset = 0.001;      // [m] of the start of a line of sight from the surface
constexpr double kSightThickness = 0.0001;  // [m] a surface nearer to a line of sight hides

}  // namespace

double visible_fraction(const Graspable& object, const HandShape::PlacedHand& hand,
                        const Vector3& p_object_eye) {
  std::vector<SightCapsule> capsules;
  std::vector<SightBox> boxes;
  for (const HandShape::Placed& s : hand.solids) {
    if (s.capsule) {
      capsules.push_back({s.a, s.b, s.radius});
    } else {
      boxes.push_back(
          {s.T_frame_shape * Eigen::Translation3d(s.shape->box_center()), 2 * s.shape->box_half()});
    }
  }
  const double size = object.box().diagonal().norm();
  const std::size_t stride =
      std::max<std::size_t>(1, (object.points().size() + kMaxSightPoints - 1) / kMaxSightPoints);
  std::size_t facing = 0, seen = 0;
  for (std::size_t i = 0; i < object.points().size(); i += stride) {
    const SurfacePoint& point = object.points()[i];
    const Vector3 to_eye = p_object_eye - point.position;
    const double far = to_eye.norm();
    if (!(to_eye.dot(point.normal) > 0)) continue;
    const Vector3 from = point.position + kSightOffset * point.normal;
    if (object.triangles().nearer_than(from, from + std::min(1.0, size / far) * to_eye,
                                       kSightThickness))
      continue;
    ++facing;
    const auto hidden = [&](const auto& solid) { return hides(solid, p_object_eye, from); };
    if (std::none_of(capsules.begin(), capsules.end(), hidden) &&
        std::none_of(boxes.begin(), boxes.end(), hidden))
      ++seen;
  }
  return facing == 0 ? 0.0 : static_cast<double>(seen) / static_cast<double>(facing);
}

}  // namespace handsel::grasp_planner
