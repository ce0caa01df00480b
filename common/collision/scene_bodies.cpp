// SPDX-License-Identifier: Apache-2.0
#include "common/collision/scene_bodies.hpp"

#include <algorithm>

#include "common/collision/enclosing.hpp"
#include "common/model/object_extent.hpp"

namespace handsel {
namespace {

constexpr double kSurePlace = 0.002;  // max uncertainty of an object that keeps its mesh [m]

}  // namespace

/// Returns a described object, or the primitive of an unknown one, enlarged by `margin` [m].
CollisionShapePtr SceneBodies::shape_of(const SceneObject& object, double margin) {
  if (CollisionShapePtr shape = mesh_of(object.model)) return shape;
  const std::optional<Shape> shape = primitive_shape(object.primitive, margin);
  return shape ? CollisionShape::make(*shape) : nullptr;
}

/// Returns the bounding box instead of a mesh with a margin; T becomes its pose.
CollisionShapePtr SceneBodies::shape_of(const SceneObject& object, double margin, Pose& T) {
  CollisionShapePtr shape = shape_of(object, margin);
  return shape && shape->is_mesh() && margin > kSurePlace ? widened(shape, margin, T) : shape;
}

std::vector<Vector3> corners_of(const SceneObject& object) {
  const Eigen::AlignedBox3d box = object_extent(nullptr, object.primitive);
  std::vector<Vector3> out;
  out.reserve(8);
  for (int i = 0; i < 8; ++i)
    out.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  return out;
}

CollisionShapePtr SceneBodies::mesh_of(const std::string& model_name) {
  auto found = meshes_.find(model_name);
  if (found != meshes_.end()) return found->second;
  const ObjectModel* model = library_ ? library_(model_name) : nullptr;
  CollisionShapePtr shape;
  if (model != nullptr && !model->mesh.triangles.empty())
    shape = CollisionShape::make(std::make_shared<const TriangleMesh>(model->mesh));
  meshes_.emplace(model_name, shape);
  return shape;
}

std::vector<SceneBody> SceneBodies::bodies(const Scene& scene, const std::string& attached,
                                           const std::set<std::string>& allowed,
                                           const std::vector<SceneBody>& before,
                                           std::vector<SceneBody>& in_peoples_hands) {
  std::vector<SceneBody> bodies_now;
  for (const SceneBox& box : scene.boxes) {
    SceneBody body;
    body.id = box.id;
    body.supports = box.supports;
    body.T_world_shape = box.T_world_box;
    const auto same = std::find_if(before.begin(), before.end(), [&](const SceneBody& b) {
      return !b.is_object && b.id == box.id && b.supports == box.supports &&
             std::get<Box>(b.shape->shape()).size == box.size;
    });
    if (same != before.end()) {
      body.shape = same->shape;
      body.lowered = same->lowered;
    } else {
      body.shape = CollisionShape::make(Box{box.size});
      if (box.supports && box.size.z() > kSupportSlack)
        body.lowered = CollisionShape::make(Box{box.size - Vector3(0, 0, kSupportSlack)});
    }
    if (body.lowered)
      body.T_world_lowered = box.T_world_box * Eigen::Translation3d(0, 0, -0.5 * kSupportSlack);
    body.allowed = allowed.count(box.id) > 0;
    bodies_now.push_back(std::move(body));
  }
  for (const SceneObject& object : scene.objects) {
    if (object.holder == Holder::robot || object.id == attached) continue;
    SceneBody body;
    body.id = object.id;
    body.is_object = true;
    body.T_world_shape = object.T_world_object;
    body.allowed = allowed.count(object.id) > 0;
    const ObjectModel* model =
        library_ && object.holder == Holder::human ? library_(object.model) : nullptr;
    for (const PlacedShape& part : model != nullptr ? model->parts : std::vector<ObjectPart>{}) {
      SceneBody solid = body;
      solid.T_world_shape = object.T_world_object * part.T_parent_shape;
      solid.shape = CollisionShape::make(part.shape);
      if (!body.allowed && object.uncertainty > kSurePlace)
        solid.shape = widened(solid.shape, object.uncertainty, solid.T_world_shape);
      in_peoples_hands.push_back(std::move(solid));
    }
    if (model != nullptr && !model->parts.empty()) continue;
    body.shape = body.allowed ? shape_of(object, 0)
                              : shape_of(object, object.uncertainty, body.T_world_shape);
    if (!body.shape) continue;
    (object.holder == Holder::human ? in_peoples_hands : bodies_now).push_back(std::move(body));
  }
  return bodies_now;
}

}  // namespace handsel
