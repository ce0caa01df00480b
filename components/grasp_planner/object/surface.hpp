// SPDX-License-Identifier: Apache-2.0
// The object's surface as contact points (chapter section 3.2.4): uniform samples that know their
// triangle, normal and curvature.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/shape.hpp"

namespace handsel::grasp_planner {

struct SurfacePoint {
  Vector3 position{Vector3::Zero()};     ///< frame of the mesh [m]
  Vector3 normal{Vector3::UnitZ()};      ///< of its triangle, outward
  std::uint32_t triangle{};              ///< index into the triangles of the mesh
  Vector3 barycentric{Vector3::Zero()};  ///< weights of the three corners of the triangle, sum 1
  double curvature{};                    ///< normalised mean curvature, [0, 1]
};

struct SurfaceSettings {
  double step{0.008};  ///< min distance of two samples on the same side [m]
  /// The curvature is averaged over a ball of this radius; the fingertip's [m].
  double curvature_radius{0.013};
  std::uint32_t max_points{20000};  ///< the step grows when more would be needed
  std::uint64_t seed{1};            ///< of the random samples; the same gives the same points
};

/// Uniform over the area, deterministic for a seed. Degenerate triangles carry no points.
std::vector<SurfacePoint> sample_surface(const TriangleMesh& mesh, const SurfaceSettings& settings);

/// Mean curvature |H| [1/m] averaged over a ball at each point, from the signed dihedral angles of
/// the mesh's edges (normal cycle). Own method in place of values interpolated from vertices:
/// independent of the triangulation. An open border counts as an edge that turns by 180 degrees.
/// `normals`: of the surface at the points; edges of the other side of a thin wall do not count.
std::vector<double> mean_curvature(const TriangleMesh& mesh, const std::vector<Vector3>& points,
                                   const std::vector<Vector3>& normals, double radius);

/// 0 flat ... 1 at least as sharp as a right-angled edge under the ball: min(1, 2 |H| radius).
double normalised_curvature(double mean_curvature, double radius);

/// Centre of the enclosed volume; of the area when the mesh encloses none (open, or inside out).
Vector3 mass_centre(const TriangleMesh& mesh);

struct MeshFindings {
  std::uint32_t components{};     ///< parts that no edge connects
  std::uint32_t open_edges{};     ///< borders of holes
  std::uint32_t crowded_edges{};  ///< shared by more than two triangles
  std::uint32_t turned{};         ///< triangles whose orientation was mended
  std::uint32_t welded{};         ///< vertices that were there more than once
  std::uint32_t dropped{};        ///< triangles without area, or there more than once
};
/// Returns the defects and repairs, a sentence each; none for a valid mesh.
std::vector<std::string> sentences(const MeshFindings& findings);
/// Welds equal vertices, drops vertices no triangle has, and triangles that are degenerate or
/// repeated; then orients it.
MeshFindings mend(TriangleMesh& mesh);
/// Makes the triangles' orientation consistent over each connected component, outward on the whole;
/// inner shells of cavities stay inward.
MeshFindings orient(TriangleMesh& mesh);

}  // namespace handsel::grasp_planner
