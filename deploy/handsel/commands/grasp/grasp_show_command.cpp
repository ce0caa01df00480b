// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/commands/grasp/grasp_show_command.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <numbers>

#include "common/base/errors.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/finite_options.hpp"
#include "deploy/handsel/offline/grasp_input.hpp"
#include "deploy/handsel/pictures/grasp_picture.hpp"

namespace handsel {
namespace {

using namespace grasp_planner;

constexpr Colour kHand = {150, 160, 175};

struct ShowOptions : ListOptions {
  std::string figure{"grasp"}, png;
  std::size_t rank{1};
  std::int64_t id{-1};
  int size{700}, depth{4}, finger{0};
  double azimuth{0}, elevation{20};
};

/// Returns the two viewing directions of a grasp, past the hand, that differ clearly.
std::vector<Vector3> sides(const ShowOptions& o, const Vector3& from) {
  std::vector<Vector3> out;
  const double start = from.head<2>().norm() > 1e-6 ? std::atan2(from.y(), from.x()) : 0.0,
               degree = std::numbers::pi / 180;
  for (const double turn : {70.0, -110.0}) {
    const double a = start + (o.azimuth + turn) * degree, e = o.elevation * degree;
    out.emplace_back(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
  }
  return out;
}

Eigen::AlignedBox3d with_hand(Eigen::AlignedBox3d box, const HandGeometry& hand_geometry,
                              const Grasp& grasp) {
  std::vector<std::vector<Pose>> T;
  hand_geometry.forward(grasp.hand_joints, T);
  for (const HandShape::Round& r : hand_geometry.shape.rounds(T)) {
    for (const Vector3& p : {r.a, r.b}) {
      const Vector3 q = grasp.T_object_hand * p;
      box.extend(Vector3(q.array() - r.radius));
      box.extend(Vector3(q.array() + r.radius));
    }
  }
  return box;
}

void say_colours(const HandModel& hand) {
  static constexpr const char* kNames[] = {"red", "green", "blue", "magenta", "orange"};
  for (std::size_t f = 0; f < hand.fingers().size(); ++f)
    std::fprintf(stderr, "%s%s %s", f ? ", " : "", kNames[f % 5], hand.fingers()[f].name.c_str());
  std::fprintf(stderr, "\n");
}

const ListedGrasp* chosen(const ShowOptions& o, const GraspList& list) {
  if (o.id < 0) return o.rank <= list.grasps.size() ? &list.grasps[o.rank - 1] : nullptr;
  for (const ListedGrasp& g : list.grasps) {
    if (g.grasp.id == static_cast<std::uint64_t>(o.id)) return &g;
  }
  return nullptr;
}

Picture of_grasp(const ShowOptions& o, const Listed& listed, const Grasp& g) {
  const Eigen::AlignedBox3d box = with_hand(listed.object->box(), *listed.hand_geometry, g);
  const std::vector<Vector3> eyes = sides(o, g.T_object_hand.translation() - box.center());
  return from_sides(box, eyes, o.size, [&](Canvas& canvas, std::size_t) {
    const bool ellipsoids = o.figure == "ellipsoids";
    draw_hand(canvas, *listed.hand_geometry, g.hand_joints, g.T_object_hand, kHand,
              o.figure == "grasp" ? 1 : 0.35);
    if (o.figure == "candidates") {
      draw_object(canvas, *listed.object);
      draw_candidates(canvas, *listed.hand_geometry, *listed.workspaces, *listed.object,
                      g.T_object_hand);
      return;
    }
    draw_object(canvas, *listed.object, ellipsoids ? 0.5 : 0.75);
    if (ellipsoids) {
      draw_force_ellipsoids(canvas, *listed.hand_geometry, g);
    } else {
      draw_contacts(canvas, g);
    }
  });
}

Picture of_object(const ShowOptions& o, const Listed& listed) {
  return from_sides(listed.object->box(), sides(o, Vector3::UnitX()), o.size,
                    [&](Canvas& canvas, std::size_t side) {
                      if (o.figure == "curvature")
                        return draw_curvature(canvas, *listed.object,
                                              listed.hand_geometry->tip_radius());
                      if (side == 0) draw_object(canvas, *listed.object);
                      draw_points(canvas, *listed.object, side == 0 ? -1 : o.depth);
                    });
}

Picture of_workspace(const ShowOptions& o, const HandGeometry& hand_geometry,
                     const FingerWorkspaces& workspaces) {
  if (o.finger < 0 || o.finger >= static_cast<int>(workspaces.size()))
    throw ConfigError("--finger " + std::to_string(o.finger) + ": hand " +
                      hand_geometry.hand.name() + " has fingers 0 to " +
                      std::to_string(workspaces.size() - 1));
  Grasp open;
  open.hand_joints = hand_geometry.hand.pregrasp();
  const FingerWorkspace& workspace = workspaces[static_cast<std::size_t>(o.finger)];
  Eigen::AlignedBox3d box = workspace.box();
  box = with_hand(box, hand_geometry, open);
  const Vector3 eye = sides(o, Vector3::UnitX()).front();
  return from_sides(box, {eye, eye}, o.size, [&](Canvas& canvas, std::size_t side) {
    draw_hand(canvas, hand_geometry, open.hand_joints, Pose::Identity(), kHand);
    draw_workspace(canvas, workspace, finger_colour(static_cast<std::size_t>(o.finger)), side == 1);
  });
}

int show(const ShowOptions& o) {
  const bool about_grasp =
      o.figure == "grasp" || o.figure == "ellipsoids" || o.figure == "candidates";
  Listed listed;
  Picture picture(1, 1, {});
  if (o.figure == "workspace") {
    listed.hand_geometry = hand_geometry_of(o.hand);
    picture = of_workspace(o, *listed.hand_geometry, make_workspaces(*listed.hand_geometry));
  } else if (!about_grasp) {
    listed = prepared(o.hand, o);
    picture = of_object(o, listed);
  } else {
    listed = list_with(o.hand, o);
    const ListedGrasp* g = chosen(o, listed.list);
    if (g == nullptr) {
      std::fprintf(stderr, "no such grasp: the list has %zu\n", listed.list.grasps.size());
      return 1;
    }
    std::fprintf(stderr, "grasp %llu, quality %.3f, epsilon %.4f, %zu contacts\n",
                 static_cast<unsigned long long>(g->grasp.id), g->grasp.quality, g->grasp.epsilon,
                 g->grasp.contacts.size());
    picture = of_grasp(o, listed, g->grasp);
  }
  if (about_grasp) say_colours(listed.hand_geometry->hand);
  std::ofstream file(o.png, std::ios::binary);
  if (!(file << picture.png()).flush()) throw ConfigError(o.png + ": cannot be written");
  return 0;
}

}  // namespace

void add_grasp_show(CLI::App& grasp, int& exit_code) {
  CLI::App* command = grasp.add_subcommand("show",
                                           "draws a grasp, the workspaces of its hand, or the "
                                           "features of the object that the planner uses");
  auto o = std::make_shared<ShowOptions>();
  add_list_options(*command, *o);
  command->add_option("--png", o->png, "file for the picture")->required();
  command
      ->add_option(
          "--figure", o->figure,
          "grasp: hand on object, contacts, friction cones; ellipsoids: force ellipsoids of the "
          "fingers, and contact normals; candidates: points in the fingers' workspaces; curvature: "
          "curvature of the surface, red low, blue high; points: contact points and the boxes of "
          "their tree; workspace: workspace of a finger, as grid and as spheres")
      ->check(
          CLI::IsMember({"grasp", "ellipsoids", "candidates", "curvature", "points", "workspace"}))
      ->capture_default_str();
  command->add_option("--rank", o->rank, "rank of the grasp; 1: the best")
      ->check(kAboveZero)
      ->capture_default_str();
  command->add_option("--id", o->id, "id of the grasp in the output of `grasp list`")
      ->check(kNotNegative);
  command->add_option("--finger", o->finger, "finger whose workspace is drawn; 0: the thumb")
      ->capture_default_str();
  command->add_option("--depth", o->depth, "depth of the boxes of the tree")
      ->check(CLI::Range(0, 12))
      ->capture_default_str();
  command->add_option("--size", o->size, "height of the picture [pixels]")
      ->check(CLI::Range(100, 2000))
      ->capture_default_str();
  command->add_option("--azimuth", o->azimuth, "azimuth of the view [deg]")
      ->check(CLI::Range(-360.0, 360.0))
      ->capture_default_str();
  command->add_option("--elevation", o->elevation, "elevation of the view [deg]")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  command->callback([o, &exit_code] { exit_code = show(*o); });
}

}  // namespace handsel
