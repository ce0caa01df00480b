// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/grasp_input.hpp"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "common/config/resources.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/terminal.hpp"

namespace handsel {

using namespace grasp_planner;

namespace {

void report_mesh(const Graspable& object) {
  for (const std::string& s : sentences(object.findings()))
    std::fprintf(stderr, "mesh: %s\n", s.c_str());
}

/// Distributes the frames over the cores.
GraspList on_all_cores(const Listed& with, const GraspListSettings& settings) {
  const std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  const std::uint64_t frames = frame_count(*with.hand_geometry, *with.object, settings);
  std::atomic<std::uint64_t> next{0};
  std::vector<GraspList> parts(threads);
  const auto work = [&](std::size_t of) {
    GraspLister lister(with.hand_geometry, with.workspaces, with.object, settings);
    for (std::uint64_t first; (first = next.fetch_add(64)) < frames;) {
      lister.test(first, 64);
      if (of == 0 && progress_wanted())
        std::fprintf(stderr, "\r%3d %% of %llu frames", static_cast<int>(100 * first / frames),
                     static_cast<unsigned long long>(frames));
    }
    parts[of] = lister.list();
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < threads; ++k) others.emplace_back(work, k);
    work(0);
  }
  if (progress_wanted()) std::fprintf(stderr, "\r\033[K");
  return merged(std::move(parts));
}

}  // namespace

ObjectModel object_of(const ListOptions& o) {
  ObjectModel object;
  const std::filesystem::path path(o.object);
  const std::string kind = path.extension().string();
  if (kind.empty() || kind == ".txtpb") {
    object = ObjectModel::load(object_description(o.object));
    for (Vector3& v : object.mesh.vertices) v *= o.scale;
    if (o.scale != 1) object.parts.clear();
    object.com *= o.scale;
    return object;
  }
  object.name = path.stem().string();
  object.mesh = load_mesh(path, Vector3::Constant(o.scale));
  mend(object.mesh);
  object.com = mass_centre(object.mesh);
  object.friction = 0.5;
  return object;
}

std::shared_ptr<const HandGeometry> hand_geometry_of(const std::string& hand) {
  return std::make_shared<const HandGeometry>(HandModel::load(hand_description(hand)));
}

Listed prepared(const std::string& hand, const ListOptions& o, bool quiet) {
  Listed out;
  out.hand_geometry = hand_geometry_of(hand);
  out.object = std::make_shared<const Graspable>(object_of(o), out.hand_geometry->tip_radius(),
                                                 GraspListSettings{}.step_fraction, o.seed);
  if (!quiet) report_mesh(*out.object);
  return out;
}

Listed list_with(const std::string& hand, const ListOptions& o, bool quiet) {
  Listed out = prepared(hand, o, quiet);
  GraspListSettings settings;
  settings.positions = o.positions;
  settings.orientations = o.orientations;
  settings.friction = o.friction;
  settings.seed = o.seed;
  out.workspaces = std::make_shared<const FingerWorkspaces>(make_workspaces(*out.hand_geometry));
  const auto start = std::chrono::steady_clock::now();
  out.list = on_all_cores(out, settings);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (quiet) return out;
  std::fprintf(stderr, "%zu grasps of hand %s on %s from %llu frames in %.2f s (seed %llu)\n",
               out.list.grasps.size(), out.list.hand.c_str(), out.list.object.c_str(),
               static_cast<unsigned long long>(out.list.frames), out.seconds,
               static_cast<unsigned long long>(o.seed));
  for (const Refusal& r : out.list.refusals())
    std::fprintf(stderr, "  %s: %s\n", r.what.c_str(), r.reason.c_str());
  return out;
}

void add_list_options(CLI::App& command, ListOptions& o) {
  command.add_option("--hand", o.hand, "hand description: name or file")->capture_default_str();
  command
      .add_option("--object", o.object,
                  "mesh file (OBJ, STL, DAE), or an object description: name or file")
      ->required();
  command.add_option("--scale", o.scale, "factor on the object's size")
      ->check(kAboveZero)
      ->capture_default_str();
  command.add_option("--positions", o.positions, "grasp frames: positions in the object's box")
      ->check(kAboveZero)
      ->capture_default_str();
  command.add_option("--orientations", o.orientations, "and orientations at each")
      ->check(kAboveZero)
      ->capture_default_str();
  command.add_option("--mu", o.friction, "Coulomb friction; the object's when left out")
      ->check(kAboveZero);
  command.add_option("--seed", o.seed, "of the contact points")->capture_default_str();
  command.add_flag("--json", o.as_json, "JSON Lines also on a terminal");
}

}  // namespace handsel
