// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/object_maker.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "common/base/errors.hpp"
#include "common/config/setting.hpp"
#include "common/geometry/solid/convex_hull.hpp"
#include "common/geometry/solid/convex_parts.hpp"
#include "components/grasp_planner/object/surface.hpp"

namespace handsel {
namespace {

constexpr int kResolution = 48;                     // cells along the longest side
constexpr std::size_t kMaxTriangles = 20'000;       // max of one mesh, as twelve processes read it
constexpr double kMinSide = 0.005, kMaxSide = 1.5;  // longest side of objects that a hand lifts [m]
constexpr double kMinSideInMillimetres = 20;  // smaller meshes may be in centimetres or inches [mm]
constexpr double kConvex = 0.97;              // min fill of the hull by one part, ratio of volumes
constexpr double kMinCavity = 0.1;  // min volume of a container's cavity, ratio to the hull's
constexpr double kFullTilt = 0.35;  // as of the project's full mug [rad]
constexpr double kUprightCosine = 0.999;

struct Extent {
  Vector3 low, high;
  Vector3 size() const { return high - low; }
  Vector3 middle() const { return (low + high) / 2; }
};

Extent extent_of(const TriangleMesh& mesh) {
  Extent out{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vector3& v : mesh.vertices) {
    out.low = out.low.cwiseMin(v);
    out.high = out.high.cwiseMax(v);
  }
  return out;
}

/// Returns metres per unit of the file, estimated from the longest side.
double found_scale(double side, std::vector<std::string>& notes) {
  if (side >= kMinSide && side <= kMaxSide) return 1;
  if (side >= kMinSideInMillimetres && side <= 1000 * kMaxSide) {
    notes.push_back("the longest side is " + short_form(side) +
                    " units: taken as millimetres; --unit says otherwise");
    return 0.001;
  }
  throw ConfigError("the longest side is " + short_form(side) +
                    " units, which is the size of no object in metres or millimetres; give --unit "
                    "(mm, cm, in, m) or --scale (metres a unit)");
}

Eigen::Quaterniond upright_by(const Vector3& up) {
  return Eigen::Quaterniond::FromTwoVectors(up, Vector3::UnitZ());
}

const std::map<std::string, Vector3>& axes() {
  static const std::map<std::string, Vector3> all{
      {"x", Vector3::UnitX()},   {"y", Vector3::UnitY()},   {"z", Vector3::UnitZ()},
      {"-x", -Vector3::UnitX()}, {"-y", -Vector3::UnitY()}, {"-z", -Vector3::UnitZ()}};
  return all;
}

void turn(TriangleMesh& mesh, const Eigen::Quaterniond& by) {
  for (Vector3& v : mesh.vertices) v = by * v;
}

/// Returns mass properties of the solid cells, for surfaces with holes.
MassProperties mass_of_cells(const VoxelGrid& grid) {
  MassProperties out;
  std::vector<Vector3> centres;
  for (std::size_t i = 0; i < grid.solid.size(); ++i)
    if (grid.solid[i] != 0) centres.push_back(grid.centre(static_cast<int>(i)));
  const auto count = static_cast<double>(centres.size());
  out.volume = count * grid.cell_volume();
  for (const Vector3& c : centres) out.com += c / count;
  for (const Vector3& c : centres) {
    const Vector3 d = c - out.com;
    out.inertia_per_mass +=
        (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose()) / count;
  }
  return out;
}

double cavity_volume(const TriangleMesh& mesh) {
  const VoxelGrid grid = voxelize(mesh, kResolution);
  return static_cast<double>(cavity_of(grid).size()) * grid.cell_volume();
}

class Maker {
 public:
  Maker(TriangleMesh mesh, const ObjectWishes& wishes,
        const std::function<void(const std::string&)>& progress)
      : mesh_(std::move(mesh)), wishes_(wishes), progress_(progress) {}

  MadeObject make() {
    if (mesh_.triangles.empty() || mesh_.vertices.empty())
      throw ConfigError("the mesh has no faces; an object needs a surface");
    out_.scale = wishes_.scale > 0 ? wishes_.scale
                                   : found_scale(extent_of(mesh_).size().maxCoeff(), out_.notes);
    for (Vector3& v : mesh_.vertices) v *= out_.scale;
    require_size();
    say("mending the surface");
    mend_surface();
    set_upright();
    centre();
    say("finding what is solid");
    const VoxelGrid grid = voxelize(mesh_, kResolution);
    set_mass(grid);
    set_parts(grid);
    finish();
    return std::move(out_);
  }

 private:
  void say(const std::string& what) const {
    if (progress_) progress_(what);
  }
  void note(const std::string& sentence) { out_.notes.push_back(sentence); }

  void require_size() const {
    const Vector3 size = extent_of(mesh_).size();
    if (size.maxCoeff() < kMinSide || size.maxCoeff() > kMaxSide)
      throw ConfigError("the longest side is " + short_form(size.maxCoeff()) +
                        " m; what a hand lifts has " + short_form(kMinSide) + " to " +
                        short_form(kMaxSide) + " m: give another --unit or --scale");
    if (!(volume_of(convex_hull(mesh_.vertices)) > 0))
      throw ConfigError(
          "the mesh is flat: its vertices lie in one plane; an object needs a volume");
  }

  void mend_surface() {
    if (mesh_.triangles.size() > kMaxTriangles) {
      const std::size_t before = mesh_.triangles.size();
      mesh_ = simplified(mesh_, kMaxTriangles);
      note("simplified from " + std::to_string(before) + " to " +
           std::to_string(mesh_.triangles.size()) + " triangles");
      out_.moved = true;
    }
    const grasp_planner::MeshFindings findings = grasp_planner::mend(mesh_);
    for (const std::string& sentence : grasp_planner::sentences(findings)) note(sentence);
    out_.closed = findings.open_edges == 0 && mass_properties(mesh_).volume > 0;
  }

  void set_upright() {
    if (wishes_.up != "auto") {
      const Eigen::Quaterniond by = upright_by(axes().at(wishes_.up));
      return apply(by);
    }
    // A container, otherwise a stable placement, decides; z has precedence if both directions are
    // possible.
    const double hull = volume_of(convex_hull(mesh_.vertices));
    TriangleMesh with_y = mesh_;
    turn(with_y, upright_by(Vector3::UnitY()));
    const bool holds = cavity_volume(mesh_) > kMinCavity * hull;
    if (!holds && cavity_volume(with_y) > kMinCavity * hull)
      return turn_to("y", "it is a container that opens there");
    if (holds) return;
    const std::vector<Placement> stands = stable_placements(mesh_, centre_of_mass());
    for (const char* name : {"z", "y", "-z", "x", "-x", "-y"})
      if (std::any_of(stands.begin(), stands.end(), [&](const Placement& p) {
            return (p.T_support_object.linear() * axes().at(name)).z() > kUprightCosine;
          }))
        return std::string(name) == "z" ? void() : turn_to(name, "it does not stand with z up");
    if (stands.empty()) return note("the object does not stand: it rolls, or tips at once");
    note("the object stands with none of its axes up: turned onto its steadiest side");
    apply(Eigen::Quaterniond(stands.front().T_support_object.linear()));
  }

  void turn_to(const std::string& axis, const std::string& why) {
    note("turned so that " + axis + " of the file is up: " + why + "; --up says otherwise");
    apply(upright_by(axes().at(axis)));
  }

  void apply(const Eigen::Quaterniond& by) {
    if (by.angularDistance(Eigen::Quaterniond::Identity()) < 1e-9) return;
    turn(mesh_, by);
    out_.moved = true;
  }

  /// Moves the origin to the centre. Observations contain the pose of the origin: if that is far
  /// outside the object, a small error of orientation becomes a large error of position.
  void centre() {
    const Extent box = extent_of(mesh_);
    const Vector3 off = box.middle();
    if ((off.array().abs() < 0.75 * box.size().array()).all()) return;
    for (Vector3& v : mesh_.vertices) v -= off;
    note("the origin of the file is " + short_form(off.norm()) +
         " m from the middle of the object: moved there");
    out_.moved = true;
  }

  Vector3 centre_of_mass() const {
    return out_.closed ? mass_properties(mesh_).com : mass_of_cells(voxelize(mesh_, 24)).com;
  }

  void set_mass(const VoxelGrid& grid) {
    const MassProperties mass = out_.closed ? mass_properties(mesh_) : mass_of_cells(grid);
    if (!out_.closed)
      note("the surface is open: mass and inertia are those of cells of " +
           short_form(1e3 * grid.cell) + " mm along the surface");
    out_.volume = mass.volume;
    out_.model.com = mass.com;
    out_.model.mass = wishes_.mass > 0 ? wishes_.mass : wishes_.density * mass.volume;
    if (wishes_.mass <= 0)
      note("mass " + short_form(out_.model.mass) + " kg by a density of " +
           short_form(wishes_.density) + " kg/m^3; --mass or --density says otherwise");
    out_.inertia = (out_.model.mass * mass.inertia_per_mass.diagonal()).eval();
  }

  void set_parts(const VoxelGrid& grid) {
    const std::vector<int> water = cavity_of(grid);
    const double held = static_cast<double>(water.size()) * grid.cell_volume();
    const double hull = volume_of(convex_hull(mesh_.vertices));
    const bool container = held > kMinCavity * hull;
    out_.cavity = container ? held : 0;
    ConvexPartsSettings settings;
    if (container) settings.max_parts = 24;
    if (out_.closed && out_.volume > kConvex * hull) settings.max_parts = 1;
    const std::vector<ConvexPart> parts = convex_parts(grid, settings, [&](int count) {
      say("cutting into convex parts, " + std::to_string(count) + " so far");
    });
    std::vector<Vector3> outline;
    ObjectPart hollow;
    for (const ConvexPart& part : parts) {
      const PlacedShape& shape = part.shape;
      if (container && touches(grid, part, water)) {
        hollow.walls.push_back(shape);
        outline.insert(outline.end(), part.hull.vertices.begin(), part.hull.vertices.end());
      } else {
        out_.model.parts.push_back({shape, {}});
      }
    }
    if (hollow.walls.empty()) return;
    static_cast<PlacedShape&>(hollow) = simplest_shape(convex_hull(outline), settings.max_points);
    out_.model.parts.insert(out_.model.parts.begin(), hollow);
  }

  /// Returns whether water stands within two cells of a part.
  static bool touches(const VoxelGrid& grid, const ConvexPart& part,
                      const std::vector<int>& water) {
    const std::set<int> cells(part.cells.begin(), part.cells.end());
    return std::any_of(water.begin(), water.end(), [&](int i) {
      const auto [x, y, z] = grid.cell_at(i);
      for (const auto& [dx, dy, dz] :
           {std::array{2, 0, 0}, std::array{-2, 0, 0}, std::array{0, 2, 0}, std::array{0, -2, 0},
            std::array{0, 0, -2}, std::array{1, 0, 0}, std::array{-1, 0, 0}, std::array{0, 1, 0},
            std::array{0, -1, 0}, std::array{0, 0, -1}}) {
        const int nx = x + dx, ny = y + dy, nz = z + dz;
        if (nx >= 0 && ny >= 0 && nz >= 0 && nx < grid.size[0] && ny < grid.size[1] &&
            cells.contains(grid.index(nx, ny, nz)))
          return true;
      }
      return false;
    });
  }

  void finish() {
    out_.model.friction = wishes_.friction;
    if (wishes_.full && out_.cavity <= 0)
      throw ConfigError("--full is for a container, and this object holds nothing with z up");
    out_.model.max_tilt = wishes_.full ? kFullTilt : 0;
    out_.placements = stable_placements(mesh_, out_.model.com);
    out_.model.height_above_support = -extent_of(mesh_).low.z();
    out_.model.mesh = std::move(mesh_);
  }

  TriangleMesh mesh_;
  const ObjectWishes& wishes_;
  const std::function<void(const std::string&)>& progress_;
  MadeObject out_;
};

}  // namespace

MadeObject make_object(TriangleMesh mesh, const ObjectWishes& wishes,
                       const std::function<void(const std::string&)>& progress) {
  return Maker(std::move(mesh), wishes, progress).make();
}

// Vertex clustering (Rossignac and Borrel 1993): the vertices of a cell become their mean.
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles) {
  constexpr double kFiner = 1.15;
  TriangleMesh out = mesh;
  const Extent box = extent_of(mesh);
  for (double cells = 400; out.triangles.size() > max_triangles && cells > 8; cells /= kFiner) {
    const double cell = box.size().maxCoeff() / cells;
    std::map<std::array<int, 3>, int> known;
    std::vector<int> place, counts;
    out = {};
    for (const Vector3& v : mesh.vertices) {
      const Vector3 at = (v - box.low) / cell;
      const auto [entry, is_new] = known.try_emplace(
          {static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z())},
          static_cast<int>(out.vertices.size()));
      if (is_new) out.vertices.push_back(Vector3::Zero()), counts.push_back(0);
      const auto i = static_cast<std::size_t>(entry->second);
      out.vertices[i] += v;
      ++counts[i];
      place.push_back(entry->second);
    }
    for (std::size_t i = 0; i < counts.size(); ++i) out.vertices[i] /= counts[i];
    std::set<std::array<int, 3>> unique;
    for (const auto& t : mesh.triangles) {
      const auto at = [&](std::size_t k) { return place[static_cast<std::size_t>(t[k])]; };
      const std::array<int, 3> corners{at(0), at(1), at(2)};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2])
        continue;
      std::array<int, 3> sorted = corners;
      std::sort(sorted.begin(), sorted.end());
      if (unique.insert(sorted).second) out.triangles.push_back(corners);
    }
  }
  return out;
}

}  // namespace handsel
