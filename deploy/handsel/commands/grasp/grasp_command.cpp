// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/commands/grasp/grasp_command.hpp"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include <Eigen/Eigenvalues>

#include "common/geometry/placement.hpp"
#include "components/grasp_planner/list/epsilon.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/json_lines.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/grasp/grasp_pair_command.hpp"
#include "deploy/handsel/commands/grasp/grasp_show_command.hpp"
#include "deploy/handsel/offline/grasp_input.hpp"
#include "deploy/handsel/offline/grasp_table.hpp"

namespace handsel {
namespace {

using nlohmann::json;
using namespace command;
using namespace grasp_planner;

json numbers(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

// ---- score

std::vector<Vector3> triples(const json& item, const char* name) {
  const json& list = field(item, name);
  if (!list.is_array() || list.empty())
    throw LineError(std::string("\"") + name + "\" must be a list of points, at least one");
  std::vector<Vector3> out;
  for (const json& p : list) out.push_back(vector3(json{{name, p}}, name));
  return out;
}

WrenchMatrix wrenches_of(const json& item) {
  if (item.is_object() && item.contains("wrenches")) {
    const json& list = item["wrenches"];
    if (!list.is_array() || list.empty())
      throw LineError("\"wrenches\" must be a list of wrenches, at least one");
    WrenchMatrix w;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Vector v = vector_of(json{{"wrenches", list[i]}}, "wrenches");
      if (i == 0) w.resize(v.size(), static_cast<Eigen::Index>(list.size()));
      if (v.size() != w.rows())
        throw LineError("wrench " + std::to_string(i) + " has another dimension than the first");
      w.col(static_cast<Eigen::Index>(i)) = v;
    }
    return w;
  }
  const std::vector<Vector3> points = triples(item, "points"),
                             normals = triples(item, "inward_normals");
  if (points.size() != normals.size())
    throw LineError("\"points\" and \"inward_normals\" must be equally long");
  const double mu = number(item, "mu"), edges = number(item, "edges");
  if (mu < 0) throw LineError("\"mu\" must not be negative");
  if (edges < 3 || edges > 1000 || edges != std::floor(edges))
    throw LineError("\"edges\" must be a whole number from 3 to 1000");
  std::vector<PointContact> contacts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(normals[i].norm() > 1e-9))
      throw LineError("inward normal " + std::to_string(i) + " is zero");
    contacts.push_back({points[i], normals[i].normalized(), mu});
  }
  const Vector3 com = item.contains("com") ? vector3(item, "com") : Vector3::Zero().eval();
  const double scale = item.contains("torque_scale") ? positive(item, "torque_scale") : 1.0;
  return contact_wrenches(contacts, static_cast<int>(edges), com, scale);
}

json score(const json& item) {
  const WrenchMatrix w = wrenches_of(item);
  if (w.rows() > kMaxWrenchDimension)
    throw LineError("wrenches may have at most " + std::to_string(kMaxWrenchDimension) +
                    " dimensions");
  return {{"force_closure", force_closure(w)}, {"epsilon", epsilon(w)}};
}

// ---- list

json line_of(const ListedGrasp& listed, const HandModel& hand) {
  const Grasp& g = listed.grasp;
  const Eigen::Quaterniond q(g.T_object_hand.linear());
  json joints = json::object(), open = json::object(), contacts = json::array();
  for (std::size_t i = 0; i < hand.model().axes().size(); ++i) {
    joints[hand.model().axes()[i].name] = g.hand_joints[static_cast<Eigen::Index>(i)];
    open[hand.model().axes()[i].name] = g.pregrasp_joints[static_cast<Eigen::Index>(i)];
  }
  for (const Contact& c : g.contacts) {
    contacts.push_back({{"finger", hand.fingers()[c.finger].name},
                        {"p", numbers(c.position)},
                        {"n", numbers(c.normal)},
                        {"triangle", c.triangle},
                        {"barycentric", numbers(c.barycentric)},
                        {"curvature", c.curvature},
                        {"mu", c.friction}});
  }
  return {{"id", g.id},
          {"T_object_hand",
           {{"p", numbers(g.T_object_hand.translation())}, {"q", {q.x(), q.y(), q.z(), q.w()}}}},
          {"joints", joints},
          {"pregrasp", open},
          {"contacts", contacts},
          {"epsilon", g.epsilon},
          {"margin", g.margin},
          {"scores",
           {{"stability", listed.scores.stability},
            {"centre", listed.scores.centre},
            {"force", listed.scores.force},
            {"curvature", listed.scores.curvature}}},
          {"room", listed.room},
          {"quality", g.quality}};
}

int list(const ListOptions& o) {
  const Listed listed = list_with(o.hand, o);
  const bool table = !json_wanted(o.as_json);
  if (table) {
    std::printf("%8s %8s %8s %10s %7s %7s %9s %6s\n", "id", "quality", "epsilon", "stability",
                "centre", "force", "curvature", "room");
  }
  for (const ListedGrasp& g : listed.list.grasps) {
    if (table) {
      std::printf("%8llu %8.3f %8.4f %10.3f %7.3f %7.3f %9.3f %6.2f\n",
                  static_cast<unsigned long long>(g.grasp.id), g.grasp.quality, g.grasp.epsilon,
                  g.scores.stability, g.scores.centre, g.scores.force, g.scores.curvature, g.room);
    } else {
      std::cout << line_of(g, listed.hand_geometry->hand).dump() << '\n';
    }
  }
  return listed.list.grasps.empty() ? 1 : 0;
}

// ---- placements

int placements(const ListOptions& o) {
  const ObjectModel object = object_of(o);
  const MassProperties mass = mass_properties(object.mesh);
  const std::vector<Placement> found = stable_placements(object.mesh, object.com);
  std::fprintf(stderr, "%s: mass centre %.4f %.4f %.4f m", object.name.c_str(), object.com.x(),
               object.com.y(), object.com.z());
  if (mass.volume > 0) {
    const Vector3 principal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(mass.inertia_per_mass).eigenvalues();
    std::fprintf(stderr,
                 ", volume %.4g l, principal inertia %.3g %.3g %.3g m^2 a kg when filled evenly",
                 1e3 * mass.volume, principal[0], principal[1], principal[2]);
  }
  std::fprintf(stderr, "; %zu ways to stand\n", found.size());
  const bool text = !json_wanted(o.as_json);
  if (text)
    std::printf("%9s %9s %9s %9s  %s\n", "tips [deg]", "height", "margin", "area",
                "side that is down (object frame)");
  for (const Placement& p : found) {
    const Vector3 down = p.T_support_object.linear().transpose() * -Vector3::UnitZ();
    if (text) {
      std::printf("%10.1f %9.4f %9.4f %9.5f  %6.3f %6.3f %6.3f\n", p.tipping * 180 / M_PI, p.height,
                  p.margin, p.area, down.x(), down.y(), down.z());
    } else {
      const Eigen::Quaterniond q(p.T_support_object.linear());
      std::cout << json{{"T_support_object",
                         {{"p", numbers(p.T_support_object.translation())},
                          {"q", {q.x(), q.y(), q.z(), q.w()}}}},
                        {"down", numbers(down)},
                        {"tipping", p.tipping},
                        {"height", p.height},
                        {"margin", p.margin},
                        {"area", p.area}}
                       .dump()
                << '\n';
    }
  }
  return found.empty() ? 1 : 0;
}

struct TableOptions : ListOptions {
  std::vector<std::string> hands{"sah", "allegro", "barrett"}, objects;
  bool fit{};
};

int table(const TableOptions& o) {
  bool all = true;
  const bool text = !json_wanted(o.as_json);
  if (text) std::printf("%s\n", table_head().c_str());
  for (const std::string& object : o.objects) {
    for (const std::string& hand : o.hands) {
      ListOptions one = o;
      one.object = object;
      const TableRow r = table_row(hand, one, o.fit);
      all = all && r.grasps > 0;
      if (text) {
        std::printf("%s\n", table_line(r).c_str());
      } else {
        std::cout << json{{"object", r.object},       {"hand", r.hand},
                          {"scale", r.scale},         {"size", r.size},
                          {"triangles", r.triangles}, {"frames", r.frames},
                          {"grasps", r.grasps},       {"best", r.best},
                          {"seconds", r.seconds},     {"findings", r.findings},
                          {"reason", r.reason}}
                         .dump()
                  << '\n';
      }
    }
  }
  return all ? 0 : 1;
}

}  // namespace

void add_grasp_commands(CLI::App& app, int& exit_code) {
  CLI::App* grasp = app.add_subcommand("grasp", "computes grasps of a hand on an object");
  grasp->require_subcommand(1);

  CLI::App* scoring =
      grasp->add_subcommand("score",
                            "computes force closure and epsilon quality of sets of contacts; reads "
                            "one line of JSON for each set from stdin");
  scoring->footer(
      R"(Input line: {"points": [[3]...], "inward_normals": [[3]...], "mu", "edges", "com",
"torque_scale"} or {"wrenches": [[...]...]})");
  scoring->add_flag("--json")->description("has no effect: the output is always JSON Lines");
  scoring->callback([&exit_code] { exit_code = for_each_line(std::cin, std::cout, score); });

  CLI::App* listing = grasp->add_subcommand("list",
                                            "prints all grasps found, best first, and to stderr "
                                            "the numbers of rejected candidates with the reasons");
  auto o = std::make_shared<ListOptions>();
  add_list_options(*listing, *o);
  listing->callback([o, &exit_code] { exit_code = list(*o); });

  CLI::App* tabling = grasp->add_subcommand("table",
                                            "prints for each pair of hand and object the number of "
                                            "grasps, best quality, time and reasons of rejection");
  auto t = std::make_shared<TableOptions>();
  tabling->add_option("--hand", t->hands, "hand description: name or file; may be repeated")
      ->capture_default_str();
  tabling->add_option("--object", t->objects, "mesh file or object description; may be repeated")
      ->required();
  tabling->add_flag("--fit", t->fit, "scale objects that are too large or too small for the hand");
  tabling
      ->add_option("--positions", t->positions,
                   "number of positions of grasp frames in the object's box")
      ->check(kAboveZero)
      ->capture_default_str();
  tabling->add_option("--orientations", t->orientations, "number of orientations at each position")
      ->check(kAboveZero)
      ->capture_default_str();
  tabling->add_flag("--json", t->as_json, "print JSON Lines also on a terminal");
  tabling->callback([t, &exit_code] { exit_code = table(*t); });

  CLI::App* standing =
      grasp->add_subcommand("placements",
                            "prints the stable placements of an object, the one that is hardest to "
                            "tip over first, and its mass and inertia");
  auto s = std::make_shared<ListOptions>();
  standing->add_option("--object", s->object, "mesh file or object description")->required();
  standing->add_option("--scale", s->scale, "factor on the size of the mesh")->check(kAboveZero);
  standing->add_flag("--json", s->as_json, "print JSON Lines also on a terminal");
  standing->callback([s, &exit_code] { exit_code = placements(*s); });

  add_grasp_choose(*grasp, exit_code);
  add_grasp_pairs(*grasp, exit_code);
  add_grasp_show(*grasp, exit_code);
  add_grasp_prepare(*grasp, exit_code);
}

}  // namespace handsel
