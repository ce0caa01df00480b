// SPDX-License-Identifier: Apache-2.0
// What stands in a scene, as bodies that can be touched.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/collision/collision_shape.hpp"
#include "common/collision/collision_world.hpp"

namespace handsel {

struct SceneBody {
  std::string id;                    ///< of the box or object in the scene
  bool is_object{}, supports{};      ///< object instead of box; objects may stand on it
  CollisionShapePtr shape, lowered;  ///< lowered: for what the hand holds, see kSupportSlack
  Pose T_world_shape{Pose::Identity()}, T_world_lowered{Pose::Identity()};  ///< of the two shapes
  bool allowed{};  ///< contact with it is allowed
};

/// Returns the corners of the box around the primitive of an unknown object, its own frame [m].
std::vector<Vector3> corners_of(const SceneObject& object);

/// Makes the bodies, and keeps the meshes of described objects.
class SceneBodies {
 public:
  explicit SceneBodies(ObjectLibrary library) : library_(std::move(library)) {}

  /// Returns boxes, and objects not held; what people hold goes to `in_peoples_hands`, by
  /// its solid parts where they are described. What the robot holds, and `attached`, is left out.
  /// Shapes of boxes that are the same `before` are kept.
  std::vector<SceneBody> bodies(const Scene& scene, const std::string& attached,
                                const std::set<std::string>& allowed,
                                const std::vector<SceneBody>& before,
                                std::vector<SceneBody>& in_peoples_hands);
  /// Returns the mesh of a described object, or the primitive of an unknown one; null: neither.
  CollisionShapePtr shape_of(const SceneObject& object) { return shape_of(object, 0); }

 private:
  CollisionShapePtr shape_of(const SceneObject& object, double margin);
  CollisionShapePtr shape_of(const SceneObject& object, double margin, Pose& T);
  CollisionShapePtr mesh_of(const std::string& model);

  ObjectLibrary library_;
  std::map<std::string, CollisionShapePtr> meshes_;
};

}  // namespace handsel
