// SPDX-License-Identifier: Apache-2.0
// States per second of the SIMD check against FCL's broad-phase manager, and capsule distances
// against FCL's, in one run. Medians of rounds that alternate between the two. Needs the reference
// data (HANDSEL_DATA). Usage: bench_collision [rounds]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <random>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "common/collision/batch_world.hpp"
#include "common/collision/simd_capsules.hpp"
#include "tests/support/panda_problems.hpp"

namespace handsel {
namespace {

using Clock = std::chrono::steady_clock;
constexpr unsigned kSeed = 7;
constexpr int kLines = 60, kStatesOnLine = 32;

double seconds(const std::function<void()>& work) {
  const Clock::time_point begin = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::shared_ptr<fcl::CollisionGeometryd> bvh(const TriangleMesh& mesh) {
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  model->beginModel();
  model->addSubModel(mesh.vertices, triangles);
  model->endModel();
  return model;
}

TriangleMesh box_mesh(const Vector3& half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(half));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Robot links as FCL meshes, obstacles in a manager; pairs of links that can touch one by one.
class FclManager {
 public:
  explicit FclManager(const RobotModel& robot) : robot_(robot) {
    for (std::size_t i = 0; i < robot.links().size(); ++i)
      for (const PlacedShape& placed : robot.links()[i].collision) {
        links_.push_back(
            {static_cast<int>(i), placed.T_parent_shape,
             std::make_unique<fcl::CollisionObjectd>(bvh(*std::get<MeshPtr>(placed.shape)))});
      }
    for (std::size_t i = 0; i < links_.size(); ++i)
      for (std::size_t j = i + 1; j < links_.size(); ++j)
        if (links_[i].link != links_[j].link &&
            !robot.pair_disabled(links_[i].link, links_[j].link))
          pairs_.emplace_back(i, j);
  }
  void set_obstacles(const std::vector<Obstacle>& obstacles) {
    manager_.clear();
    things_.clear();
    for (const Obstacle& obstacle : obstacles) {
      std::shared_ptr<fcl::CollisionGeometryd> shape;
      if (const auto* box = std::get_if<Box>(&obstacle.placed.shape))
        shape = bvh(box_mesh(0.5 * box->size));  // FCL is several times slower on its own box
      else if (const auto* cylinder = std::get_if<Cylinder>(&obstacle.placed.shape))
        shape = std::make_shared<fcl::Cylinderd>(cylinder->radius, cylinder->length);
      things_.push_back(
          std::make_unique<fcl::CollisionObjectd>(shape, obstacle.placed.T_parent_shape));
      manager_.registerObject(things_.back().get());
    }
    manager_.setup();
  }
  bool free(const Vector& q) {
    robot_.forward(q, T_root_link_);
    bool touches = false;
    for (Link& link : links_) {
      link.object->setTransform(T_root_link_[static_cast<std::size_t>(link.link)] *
                                link.T_link_shape);
      link.object->computeAABB();
    }
    for (Link& link : links_) {
      if (link.link == 0) continue;
      manager_.collide(link.object.get(), &touches,
                       [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* out) {
                         fcl::CollisionRequestd request;
                         fcl::CollisionResultd result;
                         return *static_cast<bool*>(out) = fcl::collide(a, b, request, result) > 0;
                       });
      if (touches) return false;
    }
    for (const auto& [i, j] : pairs_) {
      if (!links_[i].object->getAABB().overlap(links_[j].object->getAABB())) continue;
      fcl::CollisionRequestd request;
      fcl::CollisionResultd result;
      if (fcl::collide(links_[i].object.get(), links_[j].object.get(), request, result) > 0)
        return false;
    }
    return true;
  }

 private:
  struct Link {
    int link;
    Pose T_link_shape;
    std::unique_ptr<fcl::CollisionObjectd> object;
  };
  const RobotModel& robot_;
  std::vector<Link> links_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> things_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
  std::vector<Pose> T_root_link_;
};

void fold(const RobotModel& robot, const Vector& q, BatchWorld& wide) {
  std::vector<BatchWorld::Body> bodies;
  for (std::size_t i = 0; i < robot.links().size(); ++i)
    for (const PlacedShape& placed : robot.links()[i].collision)
      bodies.push_back({static_cast<int>(i),
                        std::make_shared<const SphereCover>(cover_shape(placed.shape)),
                        placed.shape, placed.T_parent_shape, kArmPart});
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j)
      if (bodies[i].link != bodies[j].link && !robot.pair_disabled(bodies[i].link, bodies[j].link))
        pairs.emplace_back(static_cast<int>(i), static_cast<int>(j));
  wide.set_robot(bodies, pairs, test::panda_arm(robot), q);
}

void state_rates(int rounds) {
  const RobotModel robot = test::load_panda();
  const auto problems = test::panda_problems(robot);
  const std::vector<int> arm = test::panda_arm(robot);
  BatchWorld wide(robot);
  const double made = seconds([&] { fold(robot, problems[0].start, wide); });
  FclManager fcl(robot);
  CollisionWorld both(robot, nullptr);
  both.set_moving_axes(arm);
  std::printf("panda: %d spheres in trees, made in %.2f s; registers: %s\n", wide.spheres(), made,
              detail::simd_kernels().name);
  std::printf("states on lines of %d, 0.02 rad apart, in seven scenes; million states a second\n",
              kStatesOnLine);
  std::printf("%-24s %7s %9s %9s %9s %8s %9s %11s\n", "scene", "free", "wide", "unclear", "FCL",
              "ratio", "with FCL", "(left to it)");
  std::map<std::string, const test::PandaProblem*> scenes;
  for (const auto& problem : problems) scenes.emplace(problem.set, &problem);
  std::mt19937 random(kSeed);
  double wide_time = 0, fcl_time = 0, states_in_all = 0;
  for (const auto& [name, problem] : scenes) {
    fcl.set_obstacles(problem->obstacles);
    both.set_obstacles(problem->obstacles);
    std::vector<BatchWorld::Solid> solids;
    for (const Obstacle& o : problem->obstacles)
      solids.push_back({o.placed.shape, nullptr, o.placed.T_parent_shape});
    wide.set_solids(solids, Pose::Identity());
    std::vector<std::pair<Vector, Vector>> lines;
    std::normal_distribution<double> normal;
    while (static_cast<int>(lines.size()) < kLines) {
      Vector from = problem->start, offset = Vector::Zero(robot.dof());
      for (int i : arm) {
        const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
        from[i] = std::uniform_real_distribution<double>(axis.lower, axis.upper)(random);
        offset[i] = normal(random);
      }
      if (fcl.free(from))
        lines.emplace_back(
            from, from + offset * (0.02 * (kStatesOnLine - 1) / offset.cwiseAbs().maxCoeff()));
    }
    std::vector<double> at(kStatesOnLine);
    for (int i = 0; i < kStatesOnLine; ++i)
      at[static_cast<std::size_t>(i)] = static_cast<double>(i) / (kStatesOnLine - 1);
    const int states = kLines * kStatesOnLine;
    int unclear = 0, free = 0;
    constexpr int kRepeats = 20;
    std::vector<double> a, b, c;
    double left = 0;
    for (int round = 0; round < rounds; ++round) {
      unclear = free = 0;
      a.push_back(seconds([&] {
                    for (int repeat = 0; repeat < kRepeats; ++repeat)
                      for (const auto& [from, to] : lines)
                        for (int i = 0; i < kStatesOnLine; i += BatchWorld::kStates)
                          unclear += __builtin_popcount(
                              wide.unclear_on_line(from, to, at.data() + i, BatchWorld::kStates));
                  }) /
                  kRepeats);
      b.push_back(seconds([&] {
        for (const auto& [from, to] : lines)
          for (double t : at) free += fcl.free(from + t * (to - from));
      }));
      const std::uint64_t checks = both.checks(), exact = both.exact_checks();
      const double time = seconds([&] {
        for (const auto& [from, to] : lines) both.check_motion(from, to, 0.02);
      });
      c.push_back(time / static_cast<double>(both.checks() - checks));
      left = static_cast<double>(both.exact_checks() - exact) /
             static_cast<double>(both.checks() - checks);
    }
    wide_time += median(a);
    fcl_time += median(b);
    states_in_all += states;
    std::printf("%-24s %6.1f%% %9.2f %8.1f%% %9.3f %7.1fx %9.2f %10.1f%%\n", name.c_str(),
                100.0 * free / states, 1e-6 * states / median(a),
                100.0 * unclear / states / kRepeats, 1e-6 * states / median(b),
                median(b) / median(a), 1e-6 / median(c), 100 * left);
  }
  std::printf("%-24s %7s %9.2f %9s %9.3f %7.1fx\n", "all", "", 1e-6 * states_in_all / wide_time, "",
              1e-6 * states_in_all / fcl_time, fcl_time / wide_time);
}

void capsule_distances(int rounds) {
  constexpr int kRobot = 7, kPerson = 12, kCases = 2000;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1), size(0.04, 0.14);
  struct Case {
    std::vector<detail::SimdCapsule> robot;
    detail::SimdCapsules person;
    std::vector<fcl::Transform3d> T_robot, T_person;
  };
  std::vector<Case> cases(kCases);
  std::vector<std::unique_ptr<fcl::Capsuled>> shapes;
  std::vector<double> radius(kRobot + kPerson), length(kRobot + kPerson);
  for (std::size_t i = 0; i < radius.size(); ++i) {
    radius[i] = size(random);
    length[i] = 0.1 + 2.5 * size(random);
    shapes.push_back(std::make_unique<fcl::Capsuled>(radius[i], length[i]));
  }
  for (Case& one : cases) {
    const auto make = [&](std::size_t i, const Vector3& around,
                          std::vector<fcl::Transform3d>& poses) {
      const Vector3 middle = around + 0.5 * Vector3(unit(random), unit(random), unit(random)),
                    axis = Vector3(unit(random), unit(random), unit(random)).normalized();
      poses.push_back(
          make_pose(middle, Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis)));
      return simd_capsule(middle - 0.5 * length[i] * axis, middle + 0.5 * length[i] * axis,
                          radius[i]);
    };
    for (std::size_t i = 0; i < kRobot; ++i)
      one.robot.push_back(make(i, Vector3(0, 0, 0.8), one.T_robot));
    one.person = no_capsules();
    for (std::size_t i = 0; i < kPerson; ++i)
      put_capsule(make(kRobot + i, Vector3(1.3, 0, 0.9), one.T_person), static_cast<int>(i),
                  one.person);
  }
  std::vector<double> a, b;
  double worst = 0;
  alignas(64) float distance[16 * kRobot];
  const auto nearest = [&](const Case& one) {
    return detail::simd_kernels().distances(one.robot.data(), kRobot, one.person, 0.0f, distance);
  };
  const auto nearest_fcl = [&](const Case& one) {
    double min_distance = 1e9;
    fcl::DistanceRequestd request;
    for (std::size_t i = 0; i < kRobot; ++i)
      for (std::size_t k = 0; k < kPerson; ++k) {
        fcl::DistanceResultd result;
        min_distance = std::min(
            min_distance, fcl::distance(shapes[i].get(), one.T_robot[i], shapes[kRobot + k].get(),
                                        one.T_person[k], request, result));
      }
    return min_distance;
  };
  float sink = 0;
  for (int round = 0; round < rounds; ++round) {
    a.push_back(seconds([&] {
                  for (int repeat = 0; repeat < 20; ++repeat)
                    for (const Case& one : cases) sink += nearest(one);
                }) /
                (20.0 * kCases));
    b.push_back(seconds([&] {
                  for (const Case& one : cases) sink += static_cast<float>(nearest_fcl(one));
                }) /
                kCases);
  }
  for (const Case& one : cases)
    if (const double d = nearest_fcl(one); d > 0.001)
      worst = std::max(worst, std::abs(d - nearest(one)));
  std::printf("%d capsule pairs: %.0f ns, FCL %.2f us, ratio %.1f; largest difference %.1e m%s\n",
              kRobot * kPerson, 1e9 * median(a), 1e6 * median(b), median(b) / median(a), worst,
              sink == 1.5f ? " " : "");
}

}  // namespace
}  // namespace handsel

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  handsel::capsule_distances(rounds);
  if (!handsel::test::reference_data("problems/panda")) {
    std::printf("HANDSEL_DATA names no folder with problems/panda: no state rates\n");
    return 0;
  }
  handsel::state_rates(rounds);
  return 0;
}
