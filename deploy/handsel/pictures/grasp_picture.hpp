// SPDX-License-Identifier: Apache-2.0
// Pictures of grasps: the figures of chapter section 3.2, and the pieces others are put together
// from. Frame of all: the object's.
#pragma once

#include "components/grasp_planner/list/grasp_list.hpp"
#include "deploy/handsel/pictures/canvas.hpp"

namespace handsel {

/// Thumb red, then green, blue, magenta, orange.
Colour finger_colour(std::size_t finger);

/// Draws the mesh of the object in grey.
void draw_object(Canvas& canvas, const grasp_planner::Graspable& object, double opacity = 1);
/// `q`: all axes of the hand. Fingertips in the colours of their fingers.
void draw_hand(Canvas& canvas, const grasp_planner::HandGeometry& hand_geometry, const Vector& q,
               const Pose& T_object_hand, Colour colour, double opacity = 1);
/// Contacts and their friction cones, opened outward, in the colours of their fingers.
void draw_contacts(Canvas& canvas, const Grasp& grasp);
/// Force ellipsoid of each finger in contact at its contact, the longest axis as long as a cone;
/// its main axis as a line, with the normal.
void draw_force_ellipsoids(Canvas& canvas, const grasp_planner::HandGeometry& hand_geometry,
                           const Grasp& grasp);
/// Red where the mean curvature is low, through green, to blue where it is high.
void draw_curvature(Canvas& canvas, const grasp_planner::Graspable& object, double radius);
/// Contact points of the surface; with the boxes of the tree over them at `depth` when that is not
/// negative.
void draw_points(Canvas& canvas, const grasp_planner::Graspable& object, int depth);
/// The cells a fingertip reaches, or the spheres inside them. Hand frame.
void draw_workspace(Canvas& canvas, const grasp_planner::FingerWorkspace& workspace, Colour colour,
                    bool spheres);
/// What each finger's workspace covers of the surface with the hand there, before any inverse
/// kinematics.
void draw_candidates(Canvas& canvas, const grasp_planner::HandGeometry& hand_geometry,
                     const grasp_planner::FingerWorkspaces& workspaces,
                     const grasp_planner::Graspable& object, const Pose& T_object_hand);

}  // namespace handsel
