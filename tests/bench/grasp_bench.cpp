// SPDX-License-Identifier: Apache-2.0
// The grasp planner: stability against Qhull, lists of the Schunk hand on a mug of 10 000
// triangles, the order of the tests, lists from disk.
#include <benchmark/benchmark.h>

#include <atomic>
#include <filesystem>
#include <random>
#include <thread>

#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/list/epsilon.hpp"
#include "components/grasp_planner/list/frame_search.hpp"
#include "components/grasp_planner/list/so3_grid.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"
#include "tests/support/oracles/hull_oracle.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::grasp_planner {
namespace {

const std::filesystem::path kDeploy = std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";

/// Four contacts of a body, eight edges each; about half of the sets are closed.
const std::vector<WrenchMatrix>& sets() {
  static const std::vector<WrenchMatrix> made = [] {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::vector<WrenchMatrix> out;
    while (out.size() < 200) {
      std::vector<PointContact> contacts;
      for (int k = 0; k < 4; ++k) {
        const Vector3 p(normal(random), normal(random), normal(random)),
            any(normal(random), normal(random), normal(random));
        contacts.push_back({p, (0.7 * any - p).normalized(), 0.6});
      }
      out.push_back(contact_wrenches(contacts, 8, Vector3::Zero(), 1.0));
    }
    return out;
  }();
  return made;
}

template <class F>
void over_sets(benchmark::State& state, F&& f) {
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(f(sets()[i++ % sets().size()]));
}
void BM_force_closure(benchmark::State& state) {
  over_sets(state, [](const WrenchMatrix& w) { return force_closure(w); });
}
void BM_epsilon(benchmark::State& state) {
  over_sets(state, [](const WrenchMatrix& w) { return epsilon(w); });
}
void BM_closure_then_epsilon(benchmark::State& state) {
  over_sets(state, [](const WrenchMatrix& w) { return force_closure(w) ? epsilon(w) : 0.0; });
}
void BM_qhull_joggled(benchmark::State& state) {
  over_sets(state, [](const WrenchMatrix& w) { return test::hull_oracle(w, "QJ"); });
}
void BM_qhull_default(benchmark::State& state) {
  over_sets(state, [](const WrenchMatrix& w) { return test::hull_oracle(w, "Qt"); });
}
BENCHMARK(BM_force_closure)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_epsilon)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_closure_then_epsilon)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_qhull_joggled)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_qhull_default)->Unit(benchmark::kMicrosecond);

/// The project's mug, each triangle cut in four until there are about 10 000.
ObjectModel fine_mug() {
  ObjectModel mug = ObjectModel::load(kDeploy / "objects/mug/mug.txtpb");
  while (mug.mesh.triangles.size() < 9000) {
    TriangleMesh cut;
    for (const auto& t : mug.mesh.triangles) {
      const auto at = [&](std::size_t k) -> const Vector3& {
        return mug.mesh.vertices[static_cast<std::size_t>(t[k])];
      };
      const int n = static_cast<int>(cut.vertices.size());
      for (std::size_t k = 0; k < 3; ++k) cut.vertices.push_back(at(k));
      for (std::size_t k = 0; k < 3; ++k) cut.vertices.push_back(0.5 * (at(k) + at((k + 1) % 3)));
      cut.triangles.insert(
          cut.triangles.end(),
          {{n, n + 3, n + 5}, {n + 3, n + 1, n + 4}, {n + 5, n + 4, n + 2}, {n + 3, n + 4, n + 5}});
    }
    mug.mesh = std::move(cut);
  }
  mend(mug.mesh);
  return mug;
}

struct Setup {
  std::shared_ptr<const HandGeometry> hand_geometry =
      std::make_shared<const HandGeometry>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  std::shared_ptr<const FingerWorkspaces> workspaces =
      std::make_shared<const FingerWorkspaces>(make_workspaces(*hand_geometry));
  ObjectModel model = fine_mug();
  GraspListSettings settings = [] {
    GraspListSettings s;
    s.orientations = 2000;
    return s;
  }();
  std::shared_ptr<const Graspable> mug = std::make_shared<const Graspable>(
      model, hand_geometry->tip_radius(), settings.step_fraction, 1);
};
const Setup& setup() {
  static const Setup made;
  return made;
}

/// Until 1000 stable grasps are found, frames dealt out to the threads.
void BM_1000_grasps(benchmark::State& state) {
  const Setup& s = setup();
  std::uint64_t frames = 0;
  for (auto _ : state) {
    const auto threads = static_cast<std::size_t>(state.range(0));
    std::atomic<std::uint64_t> next{0}, found{0};
    std::vector<GraspList> parts(threads);
    const auto work = [&](std::size_t of) {
      GraspLister lister(s.hand_geometry, s.workspaces, s.mug, s.settings);
      for (std::size_t had = 0; found < 1000; had = lister.found()) {
        lister.test(next.fetch_add(32), 32);
        found += lister.found() - had;
      }
      parts[of] = lister.list();
    };
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < threads; ++k) others.emplace_back(work, k);
    work(0);
    others.clear();
    const GraspList all = merged(std::move(parts));
    if (all.grasps.size() < 1000) state.SkipWithError("fewer than 1000 grasps");
    frames = all.frames;
  }
  state.counters["frames"] = static_cast<double>(frames);
  state.counters["triangles"] = static_cast<double>(s.mug->mesh().triangles.size());
}
BENCHMARK(BM_1000_grasps)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->Iterations(1)
    ->Repetitions(3);

Pose frame_of(std::uint64_t i) {
  static const auto positions = uniform_positions(setup().mug->box(), 60);
  static const auto orientations = so3_sequence(576);
  return make_pose(positions[i * 7 % positions.size()],
                   orientations[i * 13 % orientations.size()]) *
         setup().hand_geometry->hand.T_hand_grasp().inverse();
}

/// Contacts of all fingers in a frame as the planner finds them: trees first, then inverse
/// kinematics, then collision.
void BM_frame_trees_first(benchmark::State& state) {
  const Setup& s = setup();
  FrameSearch search(*s.hand_geometry, *s.workspaces, *s.mug, s.settings);
  GraspList counters;
  std::vector<std::uint32_t> points;
  std::uint64_t frame = 0;
  for (auto _ : state) {
    const Pose T = frame_of(frame++ % 300);
    for (int f = 0; f < 4; ++f) {
      search.candidates(f, T, points);
      benchmark::DoNotOptimize(search.contacts(f, T, points, counters));
    }
  }
}
/// The same in the naive order: for every contact point the finger's configuration is computed and
/// checked for collision; the remaining points are then tested against the finger's workspace.
void BM_frame_collision_first(benchmark::State& state) {
  const Setup& s = setup();
  std::vector<Pose> T_step;
  std::uint64_t frame = 0;
  for (auto _ : state) {
    const Pose T = frame_of(frame++ % 300), T_hand_object = T.inverse();
    if (s.hand_geometry->shape.palm_touches(*s.mug, T)) continue;
    for (int f = 0; f < 4; ++f) {
      const FingerChain& chain = s.hand_geometry->chains[static_cast<std::size_t>(f)];
      std::size_t found = 0;
      for (std::uint32_t i = 0;
           i < s.mug->points().size() && found < s.settings.contacts_per_finger; ++i) {
        const Vector3 p = T_hand_object * s.mug->tip_centre(i);
        Vector q = s.hand_geometry->hand.pregrasp();
        if (!chain.inverse(p, s.hand_geometry->hand.lower_contact(),
                           s.hand_geometry->hand.upper_contact(), q))
          continue;
        chain.forward(q, T_step);
        if (s.hand_geometry->shape.finger_touches(f, T_step, *s.mug, T, -s.settings.depth))
          continue;
        const auto& spheres = (*s.workspaces)[static_cast<std::size_t>(f)].spheres();
        found += std::any_of(spheres.begin(), spheres.end(), [&](const WorkspaceSphere& w) {
          return (w.centre - p).norm() <= w.radius;
        });
      }
    }
  }
}
BENCHMARK(BM_frame_trees_first)->Unit(benchmark::kMicrosecond)->Iterations(300);
BENCHMARK(BM_frame_collision_first)->Unit(benchmark::kMicrosecond)->Iterations(300);

/// A list of 1000 grasps as a planner gets it that was started anew.
void BM_list_from_disk(benchmark::State& state) {
  static const test::TemporaryFolder folder;
  const Setup& s = setup();
  GraspList list = list_grasps(s.hand_geometry, s.workspaces, s.mug, [] {
    GraspListSettings few;
    few.orientations = 24;
    return few;
  }());
  while (list.grasps.size() < 1000) list.grasps.push_back(list.grasps[list.grasps.size() % 50]);
  const GraspStore store(folder.path());
  store.save(list, 3);
  for (auto _ : state) benchmark::DoNotOptimize(store.load(list.hand, list.object, 3, list.frames));
}
BENCHMARK(BM_list_from_disk)->Unit(benchmark::kMillisecond);

/// Choice of the requested number of feasible grasps on a table, with arm configuration and
/// approach.
void BM_choose_from_list(benchmark::State& state) {
  const Setup& s = setup();
  static const auto robot =
      std::make_shared<const RobotModel>(RobotModel::load(kDeploy / "robots/jido/jido.txtpb"));
  static const ObjectModel mug = ObjectModel::load(kDeploy / "objects/mug/mug.txtpb");
  GraspCache cache(s.hand_geometry, {}, GraspStore(""));
  static const auto page = cache.page(mug);
  const GraspChooser chooser(robot, s.hand_geometry, [](const std::string&) { return &mug; }, {});
  Scene scene;
  scene.robot_known = true;
  scene.robot_position = robot->rest_configuration();
  scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
  scene.objects.push_back({"cup", "mug", make_pose({0.7, -0.4, 0.72 + mug.height_above_support}),
                           Holder::surface, "table", 0});
  GraspRequest request;
  request.object = "cup";
  request.start = robot->rest_configuration();
  request.max_grasps = static_cast<std::uint32_t>(state.range(0));
  std::size_t chosen = 0;
  for (auto _ : state)
    chosen = chooser.choose({request, page->list, *page->object, scene, {}}).grasps.size();
  state.counters["list"] = static_cast<double>(page->list.grasps.size());
  state.counters["chosen"] = static_cast<double>(chosen);
}
BENCHMARK(BM_choose_from_list)->Arg(1)->Arg(10)->Unit(benchmark::kMillisecond);

void BM_object_made_ready(benchmark::State& state) {
  const Setup& s = setup();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        Graspable(s.model, s.hand_geometry->tip_radius(), s.settings.step_fraction, 1));
}
BENCHMARK(BM_object_made_ready)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace handsel::grasp_planner
