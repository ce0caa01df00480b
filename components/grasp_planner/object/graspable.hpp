// SPDX-License-Identifier: Apache-2.0
// An object made ready for grasping: mended mesh, contact points, trees, exact collision form.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/collision/collision_shape.hpp"
#include "common/model/object_model.hpp"
#include "components/grasp_planner/object/point_tree.hpp"
#include "components/grasp_planner/object/surface.hpp"
#include "components/grasp_planner/object/triangle_tree.hpp"

namespace handsel::grasp_planner {

class Graspable {
 public:
  /// `tip_radius` [m] sets the sampling step (`step_fraction` of it) and the ball of the curvature.
  /// ConfigError when the mesh has no surface, or a size no hand can mean (below 5 mm or above 2
  /// m): it says what to scale.
  Graspable(const ObjectModel& object, double tip_radius, double step_fraction, std::uint64_t seed);

  /// Returns whether a place of the mesh is deep inside a part that is solid or filled: nothing
  /// touches it there. Inside a hollow part the pads of a gripper may.
  bool is_filled(const Vector3& position) const;
  /// Of the contact point nearest to `position` on the same side.
  double curvature_near(const Vector3& position, const Vector3& normal) const;
  /// Returns the name of the object model.
  const std::string& name() const { return name_; }
  /// Returns the mended mesh, object frame [m].
  const TriangleMesh& mesh() const { return *mesh_; }
  /// Returns the defects found and repaired in the mesh.
  const MeshFindings& findings() const { return findings_; }
  /// Contact points. Those more than 4 mm deep in one of the object's convex parts are left out:
  /// there its physical form is solid, or hollow and too narrow for a hand of several fingers.
  const std::vector<SurfacePoint>& points() const { return points_; }
  /// Over the places of a fingertip's centre when it touches: point + tip_radius * normal, same
  /// indices as points().
  const PointTree& tip_centres() const { return tip_centres_; }
  /// Returns the centre of a touching fingertip at contact point `i`, object frame [m].
  const Vector3& tip_centre(std::uint32_t i) const { return centres_[i]; }
  /// Returns the tree of the mended mesh for exact distances, object frame.
  const TriangleTree& triangles() const { return triangles_; }
  /// Returns the mended mesh as an exact collision shape, object frame.
  const CollisionShapePtr& shape() const { return shape_; }
  /// Returns the axis-aligned box around the mesh, object frame [m].
  const Eigen::AlignedBox3d& box() const { return triangles_.box(); }
  /// Returns the mass centre, object frame [m].
  const Vector3& com() const { return com_; }
  /// Largest distance of the surface from the mass centre [m].
  double radius() const { return radius_; }
  /// Returns the Coulomb coefficient of the surface.
  double friction() const { return friction_; }
  double mass() const { return mass_; }  ///< [kg]

 private:
  std::string name_;
  MeshPtr mesh_;
  MeshFindings findings_;
  std::vector<PlacedShape> filled_;  // parts without walls
  std::vector<SurfacePoint> points_;
  std::vector<Vector3> centres_;
  PointTree tip_centres_;
  TriangleTree triangles_;
  CollisionShapePtr shape_;
  Vector3 com_{Vector3::Zero()};
  double radius_{}, friction_{}, mass_{};
};

}  // namespace handsel::grasp_planner
