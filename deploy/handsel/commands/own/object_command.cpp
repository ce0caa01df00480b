// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <map>
#include <numbers>

#include "common/base/errors.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/offline/grasp_input.hpp"
#include "deploy/handsel/offline/object_writer.hpp"

namespace handsel {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::string mesh, name, out, unit;
  std::vector<std::string> hands;
  ObjectWishes wishes;
  bool replace{};
};

const std::map<std::string, double> kUnits{{"mm", 0.001}, {"cm", 0.01}, {"in", 0.0254}, {"m", 1}};

/// Reads a mesh in the unit of its file: the reader rejects meshes above 100 m, which a file in
/// millimetres may seem to be.
TriangleMesh mesh_in_own_unit(const fs::path& file) {
  constexpr double kSmaller = 1e-3;
  try {
    return load_mesh(file);
  } catch (const ConfigError&) {
    TriangleMesh mesh = load_mesh(file, Vector3::Constant(kSmaller));
    for (Vector3& v : mesh.vertices) v /= kSmaller;
    return mesh;
  }
}

fs::path description_of(const NewOptions& options, const std::string& name) {
  if (options.out.empty()) return fs::path(options.mesh).parent_path() / (name + ".txtpb");
  std::error_code error;
  if (fs::is_directory(options.out, error)) return fs::path(options.out) / (name + ".txtpb");
  if (!options.out.ends_with(".txtpb"))
    throw ConfigError("--out " + options.out + ": must be a folder, or a file that ends in .txtpb");
  return options.out;
}

void print_summary(const MadeObject& made, const std::string& name) {
  const ObjectModel& model = made.model;
  Vector3 low = model.mesh.vertices.front(), high = low;
  for (const Vector3& v : model.mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  const Vector3 size = high - low;
  std::size_t parts = model.parts.size(), walls = 0;
  for (const ObjectPart& part : model.parts) walls += part.walls.size();
  std::printf("%s: %.3f x %.3f x %.3f m, %zu triangles, %s\n", name.c_str(), size.x(), size.y(),
              size.z(), model.mesh.triangles.size(), made.closed ? "closed" : "open");
  std::printf("  mass %.3g kg, centre %.4f %.4f %.4f m, inertia %.3g %.3g %.3g kg m^2\n",
              model.mass, model.com.x(), model.com.y(), model.com.z(), made.inertia.x(),
              made.inertia.y(), made.inertia.z());
  std::printf("  %zu convex part%s, %zu of them walls of a hollow\n", parts - (walls > 0) + walls,
              parts - (walls > 0) + walls == 1 ? "" : "s", walls);
  if (made.cavity > 0)
    std::printf("  a container of %.3g l, open with z up\n", 1e3 * made.cavity);
  else
    std::printf("  no container\n");
  const std::size_t count = made.placements.size();
  std::printf("  stands in %zu %s", count, count == 1 ? "way" : "ways");
  for (const Placement& p : made.placements)
    if ((p.T_support_object.linear() * Vector3::UnitZ()).z() > 0.999)
      std::printf("; with z up it tips at %.1f deg", p.tipping * 180 / std::numbers::pi);
  std::printf("\n");
}

int make(NewOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto progress = [](const std::string& what) {
    if (progress_wanted()) std::fprintf(stderr, "\r\033[K%s", what.c_str());
  };
  if (!options.unit.empty()) options.wishes.scale = kUnits.at(options.unit);
  progress("reading " + options.mesh);
  TriangleMesh mesh = mesh_in_own_unit(options.mesh);
  MadeObject made;
  try {
    made = make_object(std::move(mesh), options.wishes, progress);
  } catch (const ConfigError& error) {
    progress("");
    throw ConfigError(options.mesh + ": " + error.what());
  }
  progress("");
  ObjectFiles files{.mesh = options.mesh, .replace = options.replace};
  files.name =
      object_name(options.name.empty() ? fs::path(options.mesh) : fs::path(options.name + ".x"));
  files.description = description_of(options, files.name);
  const std::vector<fs::path> written = write_object(made, files);
  ObjectModel::load(files.description);  // checks that the written description can be read
  for (const std::string& note : made.notes) std::fprintf(stderr, "note: %s\n", note.c_str());
  print_summary(made, files.name);
  std::printf("  written in %.1f s: %s and %zu more file%s\n",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
              files.description.c_str(), written.size() - 1, written.size() == 2 ? "" : "s");
  bool all = true;
  for (const std::string& hand : options.hands) {
    ListOptions list;
    list.object = files.description;
    const Listed found = list_with(hand, list, true);
    std::printf("  hand %s: %zu grasps\n", hand.c_str(), found.list.grasps.size());
    if (found.list.grasps.empty())
      for (const Refusal& r : found.list.refusals())
        std::printf("    %s: %s\n", r.what.c_str(), r.reason.c_str());
    all = all && !found.list.grasps.empty();
  }
  return all ? 0 : 1;
}

}  // namespace

void add_object_commands(CLI::App& app, int& exit_code) {
  CLI::App* object = app.add_subcommand("object", "creates descriptions of your own objects");
  object->require_subcommand(1);
  CLI::App* command = object->add_subcommand("new",
                                             "creates a description of an object from a mesh, "
                                             "beside the mesh; scenarios name the description");
  command->footer("example: handsel object new cup.stl --unit mm --mass 0.3 --hand sah");
  auto o = std::make_shared<NewOptions>();
  command->add_option("mesh", o->mesh, "mesh file: STL, OBJ, PLY or DAE")->required();
  command->add_option("--name", o->name, "name of the object (default: the file's)");
  auto* unit = command
                   ->add_option("--unit", o->unit,
                                "unit of length of the file (default: inferred from the size)")
                   ->check(CLI::IsMember({"mm", "cm", "in", "m"}));
  command->add_option("--scale", o->wishes.scale, "length of one unit of the file [m]")
      ->check(kAboveZero)
      ->excludes(unit);
  command
      ->add_option("--up", o->wishes.up, "axis of the file that points up when the object stands")
      ->check(CLI::IsMember({"auto", "x", "y", "z", "-x", "-y", "-z"}))
      ->capture_default_str();
  auto* density =
      command->add_option("--density", o->wishes.density, "density of the solid [kg/m^3]")
          ->check(kAboveZero)
          ->capture_default_str();
  command->add_option("--mass", o->wishes.mass, "mass [kg]")->check(kAboveZero)->excludes(density);
  command->add_option("--friction", o->wishes.friction, "coefficient of Coulomb friction")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command->add_flag("--full", o->wishes.full,
                    "the object is a filled container and is carried upright");
  command
      ->add_option("--hand", o->hands,
                   "also print the number of grasps of this hand; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_option("--out", o->out,
                      "folder or file of the description (default: beside the mesh)");
  command->add_flag("--replace", o->replace, "replace an existing description");
  command->callback([o, &exit_code] { exit_code = make(*o); });
}

}  // namespace handsel
