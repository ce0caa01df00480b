// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "common/collision/batch_world.hpp"
#include "common/collision/collision_shape.hpp"
#include "common/collision/collision_world.hpp"
#include "common/collision/sphere_cover.hpp"
#include "common/model/robot_capsules.hpp"
#include "tests/support/panda_problems.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/standing_person.hpp"

namespace handsel::batch_collision_test {
namespace {

using test::person_at;

constexpr unsigned kSeed = 75001;

/// Returns the number of states for both checks; HANDSEL_WIDE_STATES=1000000 for the long run.
int states_wanted() {
  const char* text = std::getenv("HANDSEL_WIDE_STATES");
  return text == nullptr ? 9000 : std::atoi(text);
}

RobotModel load_jido() {
  return RobotModel::load(std::string(HANDSEL_SOURCE_DIR) + "/deploy/robots/jido/jido.txtpb");
}

std::vector<const detail::SimdKernels*> kernels() {
  std::vector<const detail::SimdKernels*> out = {&detail::kSimdKernelsBase};
  if (&detail::simd_kernels() != out[0]) out.push_back(&detail::simd_kernels());
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
      &detail::simd_kernels() != &detail::kSimdKernelsAvx2)
    out.push_back(&detail::kSimdKernelsAvx2);
#endif
  return out;
}

/// Returns whether the point is inside every sphere of a branch from the root to a leaf.
bool held(const SphereCover& cover, const Vector3& p, std::size_t index = 0) {
  const CoverNode& node = cover.nodes[index];
  if ((p - node.center).norm() > node.radius) return false;
  if (node.children == 0) return true;
  for (int c = 0; c < node.children; ++c)
    if (held(cover, p, static_cast<std::size_t>(node.first_child + c))) return true;
  return false;
}

Vector random_state(const RobotModel& robot, const std::vector<int>& axes, Vector q,
                    std::mt19937& random) {
  for (int i : axes) {
    const Axis& axis = robot.axes()[static_cast<std::size_t>(i)];
    q[i] = std::uniform_real_distribution<double>(std::max(axis.lower, -3.1),
                                                  std::min(axis.upper, 3.1))(random);
  }
  return q;
}

TEST(SphereCover, every_point_of_a_solid_is_inside_a_leaf_and_all_spheres_above_it) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> size(0.02, 0.4), unit(-1, 1);
  std::printf("seed %u\n", kSeed);
  for (int k = 0; k < 12; ++k) {
    const Vector3 half = 0.5 * Vector3(size(random), size(random), size(random));
    const double radius = 0.5 * size(random), length = size(random);
    const SphereCover box = cover_shape(Box{2 * half}),
                      cylinder = cover_shape(Cylinder{radius, length}),
                      capsule = cover_shape(Capsule{radius, length}),
                      sphere = cover_shape(Sphere{radius});
    for (int i = 0; i < 3000; ++i) {
      Vector3 u(unit(random), unit(random), unit(random));
      if (i % 3 == 0) u[i / 3 % 3] = u[i / 3 % 3] < 0 ? -1 : 1;  // on a face
      ASSERT_TRUE(held(box, half.cwiseProduct(u)));
      const double angle = M_PI * u.x(),
                   r = i % 3 == 0 ? radius : radius * std::sqrt(std::abs(u.y()));
      const Vector3 disc(r * std::cos(angle), r * std::sin(angle), 0);
      ASSERT_TRUE(held(cylinder, disc + Vector3(0, 0, 0.5 * length * u.z())));
      ASSERT_TRUE(held(capsule, disc + Vector3(0, 0, 0.5 * length * u.z())));
      ASSERT_TRUE(held(
          capsule, Vector3(0, 0, std::copysign(0.5 * length, u.z())) + radius * u.normalized()));
      ASSERT_TRUE(held(sphere, radius * u.normalized()));
    }
  }
}

TEST(SphereCover, triangles_are_proved_inside_and_a_missing_sphere_is_found) {
  auto mesh = std::make_shared<TriangleMesh>();  // an open tent, thin and at an odd scale
  mesh->vertices = {{0, 0, 0}, {0.31, 0, 0.02}, {0.3, 0.2, 0}, {0, 0.2, 0.01}, {0.15, 0.1, 0.12}};
  mesh->triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}};
  SphereCover cover = cover_shape(MeshPtr(mesh));
  EXPECT_TRUE(covers(cover, *mesh));
  int needed = 0;
  for (CoverNode& node : cover.nodes) {
    if (node.children > 0) continue;
    const double radius = node.radius;
    node.radius = 0;
    needed += !covers(cover, *mesh, 1e-4);
    node.radius = radius;
  }
  EXPECT_GT(needed, cover.leaves() / 2);
  EXPECT_THROW(cover_shape(MeshPtr(std::make_shared<TriangleMesh>())), ConfigError);
}

TEST(SphereCover, every_triangle_of_the_reference_robots_is_inside_its_spheres) {
  if (!test::reference_data("robots/franka_panda")) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const std::filesystem::path robots = *test::reference_data("robots");
  for (const char* file : {"franka_panda/panda.urdf", "kuka_iiwa14/model.urdf"}) {
    const RobotModel robot = RobotModel::load_urdf(robots / file);
    int triangles = 0, leaves = 0;
    for (const Link& link : robot.links())
      for (const PlacedShape& placed : link.collision) {
        const auto* mesh = std::get_if<MeshPtr>(&placed.shape);
        if (mesh == nullptr) continue;
        const SphereCover cover = cover_shape(placed.shape);
        triangles += static_cast<int>((*mesh)->triangles.size());
        leaves += cover.leaves();
        EXPECT_TRUE(covers(cover, **mesh)) << file << " " << link.name;
      }
    std::printf("%s: %d triangles inside %d spheres\n", file, triangles, leaves);
    EXPECT_GT(triangles, 1000);
  }
}

class BothChecks {
 public:
  BothChecks(const RobotModel& robot, ObjectLibrary library, const std::vector<int>& axes)
      : robot_(robot), axes_(axes), exact_(robot, library), batch_(robot, library) {
    batch_.set_moving_axes(axes);
  }
  template <class F>
  void both(F&& f) {
    f(exact_);
    f(batch_);
  }
  /// Judges random states; a state the wide check clears must be free.
  void compare(int states, const Vector& rest, std::mt19937& random) {
    for (int i = 0; i < states; ++i) {
      const Vector q = random_state(robot_, axes_, rest, random);
      const std::uint64_t before = batch_.exact_checks();
      const bool cleared = batch_.is_free(q) && batch_.exact_checks() == before;
      const bool free = exact_.is_free(q);
      ++states_;
      free_ += free;
      cleared_ += cleared;
      ASSERT_TRUE(free || !cleared) << "cleared, but in collision: " << q.transpose();
      if (!free || i % 4 != 0) continue;
      const double clearance = exact_.distance_to_scene(q, 0.05);
      near_ += clearance < 0.05;
      refused_near_ += clearance < 0.05 && !cleared;
    }
  }
  void report(const char* name) const {
    std::printf(
        "%s: %d states, %.1f %% free, of these %.1f %% cleared without FCL; 0-5 cm clear of the "
        "scene: %d, %.1f %% left to FCL\n",
        name, states_, 100.0 * free_ / states_, 100.0 * cleared_ / std::max(1, free_), near_,
        100.0 * refused_near_ / std::max(1, near_));
  }
  int states_{}, free_{}, cleared_{}, near_{}, refused_near_{};
  const RobotModel& robot_;
  std::vector<int> axes_;
  CollisionWorld exact_, batch_;
};

TEST(WideCollision, never_clears_what_is_in_collision_among_the_panda_problems) {
  if (!test::reference_data("problems/panda")) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const RobotModel robot = test::load_panda();
  const auto problems = test::panda_problems(robot);
  BothChecks checks(robot, nullptr, test::panda_arm(robot));
  std::mt19937 random(kSeed);
  std::printf("seed %u\n", kSeed);
  const int scenes = 21;
  for (int k = 0; k < scenes; ++k) {
    const auto& problem = problems[problems.size() * static_cast<std::size_t>(k) / scenes];
    checks.both([&](CollisionWorld& world) { world.set_obstacles(problem.obstacles); });
    checks.compare(states_wanted() / scenes, problem.start, random);
  }
  checks.report("panda");
  EXPECT_GT(checks.free_, checks.states_ / 20);
  EXPECT_LT(checks.free_, checks.states_);
  EXPECT_GT(checks.cleared_, checks.free_ / 2);
}

TEST(WideCollision, refuses_none_of_the_goals_of_the_panda_problems) {
  if (!test::reference_data("problems/panda")) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const RobotModel robot = test::load_panda();
  CollisionWorld world(robot, nullptr);
  world.set_moving_axes(test::panda_arm(robot));
  int goals = 0, refused = 0;
  for (const auto& problem : test::panda_problems(robot)) {
    world.set_obstacles(problem.obstacles);
    for (const Vector& goal : problem.goals) {
      ++goals;
      refused += !world.is_free(goal);
    }
  }
  std::printf("%d goals, %d refused; %d cleared without FCL\n", goals, refused,
              goals - static_cast<int>(world.exact_checks()));
  EXPECT_GE(goals, 210);
  EXPECT_EQ(refused, 0);
}

TEST(WideCollision, never_clears_what_is_in_collision_of_the_iiwa) {
  const auto file = test::reference_data("robots/kuka_iiwa14/model.urdf");
  if (!file) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const RobotModel robot = RobotModel::load_urdf(*file);
  BothChecks checks(robot, nullptr, {0, 1, 2, 3, 4, 5, 6});
  std::mt19937 random(kSeed + 6);
  std::uniform_real_distribution<double> place(-1, 1), size(0.05, 0.5);
  std::printf("seed %u\n", kSeed + 6);
  const int scenes = 20;
  for (int k = 0; k < scenes; ++k) {
    std::vector<Obstacle> obstacles;
    for (int i = 0; i < 8; ++i) {
      const Vector3 at = Vector3(place(random), place(random), 0.6 * place(random)).normalized() *
                         (0.55 + 0.3 * place(random));
      const Pose T = make_pose(at + Vector3(0, 0, 0.4),
                               Eigen::Quaterniond(Eigen::AngleAxisd(
                                   3 * place(random), Vector3(place(random), 1, 0).normalized())));
      const Shape shape = i % 2 ? Shape(Box{{size(random), size(random), size(random)}})
                                : Shape(Cylinder{0.3 * size(random), size(random)});
      obstacles.push_back({"thing" + std::to_string(i), {shape, T}});
    }
    checks.both([&](CollisionWorld& world) { world.set_obstacles(obstacles); });
    checks.compare(states_wanted() / scenes, Vector::Zero(robot.dof()), random);
  }
  checks.report("iiwa");
  EXPECT_GT(checks.free_, checks.states_ / 20);
  EXPECT_LT(checks.free_, checks.states_);
  EXPECT_GT(checks.cleared_, checks.free_ / 2);
}

ObjectModel slab() {
  ObjectModel object;
  object.name = "slab";
  const Vector3 half(0.05, 0.03, 0.08);
  for (int i = 0; i < 8; ++i)
    object.mesh.vertices.emplace_back(
        Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(half));
  object.mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                           {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return object;
}

TEST(WideCollision, agrees_on_jido_with_people_objects_and_something_in_the_hand) {
  const RobotModel robot = load_jido();
  const ObjectModel object = slab();
  BothChecks checks(
      robot, [&](const std::string& name) { return name == "slab" ? &object : nullptr; },
      robot.require_group("arm").axes);
  std::mt19937 random(kSeed + 1);
  std::uniform_real_distribution<double> place(-1, 1);
  std::printf("seed %u\n", kSeed + 1);
  for (int k = 0; k < 6; ++k) {
    Scene scene;
    scene.robot_known = true;
    scene.T_world_base =
        make_pose({3.0 * place(random), 2.0 * place(random), 0},
                  Eigen::Quaterniond(Eigen::AngleAxisd(3 * place(random), Vector3::UnitZ())));
    const auto at = [&](double x, double y, double z) {
      return Pose(scene.T_world_base * Eigen::Translation3d(x, y, z));
    };
    scene.boxes.push_back({"table", at(0.9, place(random), 0.35), {0.6, 1.2, 0.7}, true});
    scene.boxes.push_back({"wall", at(0, 1.3, 1), {400, 0.1, 400}, false});
    scene.objects.push_back(
        {"far", "slab", at(0.7, 0.3 * place(random), 0.785), Holder::nobody, "", 0.0});
    scene.objects.push_back({"held", "slab", Pose::Identity(), Holder::robot, "", 0.0});
    checks.both([&](CollisionWorld& world) {
      world.set_scene(scene);
      world.set_people(person_at(scene.T_world_base * Vector3(1.3, -0.5, 0)),
                       k % 2 ? PeopleParts::all : PeopleParts::without_forearms_and_hands);
      Attachment attachment;
      if (k >= 2) attachment.object = "held";
      attachment.T_tool_object = make_pose({0.0, 0.05, 0.12});
      world.set_attachment(attachment, k % 3 == 1 ? std::vector<std::string>{"far", "table"}
                                                  : std::vector<std::string>{"anna"});
    });
    checks.compare(states_wanted() / 12, robot.rest_configuration(), random);
  }
  checks.report("jido");
  EXPECT_GT(checks.free_, 0);
  EXPECT_LT(checks.free_, checks.states_);
  EXPECT_GT(checks.cleared_, checks.free_ / 3);
}

TEST(WideCollision, lines_have_the_same_verdicts_names_and_counts) {
  const RobotModel robot = load_jido();
  BothChecks checks(robot, nullptr, robot.require_group("arm").axes);
  std::mt19937 random(kSeed + 2);
  Scene scene;
  scene.boxes.push_back({"table", make_pose({0.8, 0.2, 0.35}), {0.6, 1.2, 0.7}, true});
  checks.both([&](CollisionWorld& world) {
    world.set_scene(scene);
    world.set_people(person_at({1.2, -0.6, 0}));
  });
  int free = 0, sure = 0;
  for (int k = 0; k < 60; ++k) {
    const Vector from = random_state(robot, checks.axes_, robot.rest_configuration(), random);
    Vector to = random_state(robot, checks.axes_, robot.rest_configuration(), random);
    if (k % 2 == 0) to = from + 0.3 * (to - from);
    const double step = k % 3 == 0 ? 0.005 : 0.02;
    const std::uint64_t before[2] = {checks.exact_.checks(), checks.batch_.checks()};
    const CollisionVerdict exact = checks.exact_.check_motion(from, to, step),
                           wide = checks.batch_.check_motion(from, to, step);
    EXPECT_EQ(exact.free, wide.free);
    EXPECT_EQ(exact.first, wide.first);
    EXPECT_EQ(exact.second, wide.second);
    EXPECT_EQ(checks.exact_.checks() - before[0], checks.batch_.checks() - before[1]);
    const bool surely = checks.batch_.surely_free(from, to);
    EXPECT_TRUE(exact.free || !surely);
    free += exact.free;
    sure += surely;
  }
  std::printf("%d of 60 lines free, %d shown free without steps, %llu of %llu states left to FCL\n",
              free, sure, static_cast<unsigned long long>(checks.batch_.exact_checks()),
              static_cast<unsigned long long>(checks.batch_.checks()));
  EXPECT_GT(free, 3);
  EXPECT_LT(free, 60);
  EXPECT_GT(sure, 0);
}

TEST(WideCollision, what_the_moving_axes_do_not_move_still_counts) {
  const RobotModel robot = test::planar_arm();
  BothChecks checks(robot, nullptr, {2});
  Scene scene;
  scene.boxes.push_back({"block", make_pose({0.2, 0.05, 0}), {0.1, 0.1, 0.1}, false});
  checks.both([&](CollisionWorld& world) { world.set_scene(scene); });
  Vector q = Vector::Zero(3);
  EXPECT_FALSE(checks.exact_.is_free(q));
  EXPECT_FALSE(checks.batch_.is_free(q));
  q[0] = -1.0;
  EXPECT_TRUE(checks.exact_.is_free(q));
  EXPECT_TRUE(checks.batch_.is_free(q));
  q[1] = 2.9;
  q[2] = 2.9;
  EXPECT_EQ(checks.batch_.is_free(q), checks.exact_.is_free(q));
}

TEST(WideCollision, what_other_axes_turn_is_kept_off_by_the_turning_margin) {
  constexpr double kMargin = 0.03;
  const RobotModel robot = load_jido();
  const Group &arm = robot.require_group("arm"), &head = robot.require_group("head");
  const auto turned_by = [&](int link, const Group& group) {
    for (int l = link; robot.links()[static_cast<std::size_t>(l)].parent_joint >= 0;) {
      const auto& joint = robot.joints()[static_cast<std::size_t>(
          robot.links()[static_cast<std::size_t>(l)].parent_joint)];
      if (std::count(group.axes.begin(), group.axes.end(), joint.dof) > 0) return true;
      l = joint.parent;
    }
    return false;
  };
  /// Of the arm's links (with the hand) to the head's.
  const auto gap = [&](const Vector& q) {
    std::vector<Pose> links;
    robot.forward(q, links);
    double least = 1e9;
    for (std::size_t a = 0; a < links.size(); ++a)
      for (std::size_t h = 0; h < links.size(); ++h) {
        if (!turned_by(static_cast<int>(a), arm) || !turned_by(static_cast<int>(h), head)) continue;
        if (robot.pair_disabled(static_cast<int>(a), static_cast<int>(h))) continue;
        for (const PlacedShape& x : robot.links()[a].collision)
          for (const PlacedShape& y : robot.links()[h].collision) {
            const ShapeDistance d = shape_distance(x.shape, links[a] * x.T_parent_shape, y.shape,
                                                   links[h] * y.T_parent_shape);
            least = std::min(least, d.collide ? 0.0 : d.distance);
          }
      }
    return least;
  };
  std::mt19937 random(kSeed);
  CollisionWorld plain(robot, nullptr), margin(robot, nullptr), exact(robot, nullptr);
  for (CollisionWorld* world : {&plain, &margin}) world->set_moving_axes(arm.axes);
  margin.set_turning_margin(kMargin);
  exact.set_turning_margin(kMargin);
  Vector rest = robot.rest_configuration();
  int near = 0, kept_off = 0;
  for (int k = 0; k < 60000 && near < 40; ++k) {
    if (k % 2000 == 0) rest = random_state(robot, head.axes, rest, random);
    const Vector q = random_state(robot, arm.axes, rest, random);
    const bool free = plain.is_free(q), free_with = margin.is_free(q);
    ASSERT_EQ(margin.check(q).free, free_with) << "seed " << kSeed << " state " << k;
    ASSERT_TRUE(free || !free_with);
    ASSERT_EQ(k % 100 == 0 ? exact.check(q).free : free, free) << "nothing is moved: no margin";
    if (!free || (free_with && k % 200 != 0)) continue;
    const double d = gap(q);
    ASSERT_GT(d, free_with ? kMargin : 0.0) << "seed " << kSeed << " state " << k;
    ASSERT_LT(d, free_with ? 1e9 : kMargin * std::sqrt(3.0) + 1e-6)
        << "seed " << kSeed << " state " << k;
    near += !free_with;
    kept_off += free_with;
  }
  std::printf(
      "%d states free but within the margin of the head, %d of those farther away looked at\n",
      near, kept_off);
  EXPECT_GE(near, 20);
}

TEST(WideCollision, distance_to_people_is_that_of_the_nearest_pair_with_its_points) {
  const RobotModel robot = load_jido();
  CollisionWorld world(robot, nullptr);
  const std::vector<LinkCapsule> capsules = robot_capsules(robot);
  std::mt19937 random(kSeed + 5);
  std::uniform_real_distribution<double> place(-2.5, 2.5);
  double worst = 0;
  for (int k = 0; k < 40; ++k) {
    HumanState people = person_at({place(random), place(random), 0});
    people.people.push_back(person_at({place(random), place(random), 0}).people[0]);
    people.people[1].id = "ben";
    const Pose T_world_base = make_pose({20 * place(random), place(random), 0});
    for (Person& person : people.people)
      for (BodyJoint& joint : person.joints) joint.position += T_world_base.translation();
    world.set_base(T_world_base);
    world.set_people(people);
    for (int i = 0; i < 25; ++i) {
      const Vector q =
          random_state(robot, robot.require_group("arm").axes, robot.rest_configuration(), random);
      std::vector<Pose> links;
      robot.forward(q, links);
      double least = std::numeric_limits<double>::infinity();
      for (const Person& person : people.people)
        for (const BodyCapsule& body : body_capsules(person))
          for (const LinkCapsule& capsule : capsules)
            least =
                std::min(least, segment_distance(T_world_base * (links[capsule.link] * capsule.a),
                                                 T_world_base * (links[capsule.link] * capsule.b),
                                                 body.a, body.b) -
                                    capsule.radius - body.radius);
      Vector3 on_robot, on_person;
      const double found = world.distance_to_people(q, &on_robot, &on_person);
      worst = std::max(worst, std::abs(found - least));
      if (found > 0) {
        EXPECT_NEAR((on_robot - on_person).norm(), found, 1e-6);
      }
    }
  }
  std::printf("seed %u: within %.1e m\n", kSeed + 5, worst);
  EXPECT_LT(worst, 1e-9);
}

class Lanes : public ::testing::Test {
 protected:
  Lanes() : batch_(robot_) {
    for (std::size_t i = 0; i < robot_.links().size(); ++i)
      for (const PlacedShape& placed : robot_.links()[i].collision)
        bodies_.push_back({static_cast<int>(i),
                           std::make_shared<const SphereCover>(cover_shape(placed.shape)),
                           placed.shape, placed.T_parent_shape, kArmPart});
  }
  RobotModel robot_{load_jido()};
  BatchWorld batch_;
  std::vector<BatchWorld::Body> bodies_;
};

TEST_F(Lanes, have_the_poses_of_the_model_at_every_width_and_clear_no_numbers_that_are_none) {
  std::mt19937 random(kSeed + 3);
  std::vector<int> axes(static_cast<std::size_t>(robot_.dof()));
  for (int i = 0; i < robot_.dof(); ++i) axes[static_cast<std::size_t>(i)] = i;
  batch_.set_robot(bodies_, {}, axes, robot_.rest_configuration());
  batch_.set_solids({}, Pose::Identity());
  double worst = 0;
  for (const detail::SimdKernels* kernel : kernels()) {
    batch_.set_kernels(*kernel);
    for (int block = 0; block < 20; ++block) {
      std::vector<Vector> states;
      for (int i = 0; i < BatchWorld::kStates; ++i)
        states.push_back(random_state(robot_, axes, robot_.rest_configuration(), random));
      EXPECT_EQ(batch_.unclear(states.data(), BatchWorld::kStates), 0u);
      for (int lane = BatchWorld::kStates - kernel->width; lane < BatchWorld::kStates; ++lane)
        for (std::size_t link = 0; link < robot_.links().size(); ++link) {
          const Pose T =
              robot_.link_pose(states[static_cast<std::size_t>(lane)], static_cast<int>(link));
          const Pose lanes = batch_.link_pose(static_cast<int>(link), lane);
          worst =
              std::max(worst, (T * Vector3(0.1, 0.1, 0.1) - lanes * Vector3(0.1, 0.1, 0.1)).norm());
        }
    }
  }
  std::printf("poses in single precision within %.1e m, %.1e m are added to the radii\n", worst,
              batch_.rounding());
  EXPECT_LT(worst, batch_.rounding() / 3);
  batch_.set_solids({{Sphere{0.05}, nullptr, make_pose({0.6, 0, 0.9})}}, Pose::Identity());
  Vector q = robot_.rest_configuration();
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e9}) {
    q[robot_.require_group("arm").axes[1]] = bad;
    EXPECT_NE(batch_.unclear(&q, 1), 0u);
  }
}

TEST_F(Lanes, every_width_clears_the_same_states_but_for_rounding) {
  std::mt19937 random(kSeed + 4);
  const std::vector<int>& axes = robot_.require_group("arm").axes;
  batch_.set_robot(bodies_, {}, axes, robot_.rest_configuration());
  batch_.set_solids({{Cylinder{0.1, 0.5}, nullptr, make_pose({0.8, 0.2, 0.9})},
                     {Box{{0.5, 0.5, 0.1}}, nullptr, make_pose({0.9, -0.3, 0.6})}},
                    Pose::Identity());
  int different = 0, unclear = 0;
  for (int block = 0; block < 50; ++block) {
    std::vector<Vector> states;
    for (int i = 0; i < BatchWorld::kStates; ++i)
      states.push_back(random_state(robot_, axes, robot_.rest_configuration(), random));
    std::uint32_t first = 0;
    for (const detail::SimdKernels* kernel : kernels()) {
      batch_.set_kernels(*kernel);
      const std::uint32_t now = batch_.unclear(states.data(), BatchWorld::kStates);
      if (kernel == kernels()[0]) first = now;
      different += __builtin_popcount(now ^ first);
    }
    unclear += __builtin_popcount(first);
  }
  EXPECT_LE(different, 2);
  EXPECT_GT(unclear, 20);
  EXPECT_LT(unclear, 780);
}

TEST_F(Lanes, a_line_is_clear_for_who_asks_for_any_unclear_state_exactly_when_all_its_states_are) {
  std::mt19937 random(kSeed + 6);
  const std::vector<int>& axes = robot_.require_group("arm").axes;
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < static_cast<int>(bodies_.size()); ++a)
    for (int b = a + 6; b < static_cast<int>(bodies_.size()); ++b) pairs.emplace_back(a, b);
  batch_.set_robot(bodies_, pairs, axes, robot_.rest_configuration());
  batch_.set_solids({{Box{{0.5, 0.5, 0.1}}, nullptr, make_pose({0.9, -0.3, 0.6})}},
                    Pose::Identity());
  std::array<double, BatchWorld::kStates> at{};
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = static_cast<double>(i) / (at.size() - 1.0);
  int clear = 0, partly = 0;
  for (int line = 0; line < 400; ++line) {
    const Vector from = random_state(robot_, axes, robot_.rest_configuration(), random),
                 to =
                     from +
                     0.2 * (random_state(robot_, axes, robot_.rest_configuration(), random) - from);
    for (const detail::SimdKernels* kernel : kernels()) {
      batch_.set_kernels(*kernel);
      const std::uint32_t all = batch_.unclear_on_line(from, to, at.data(), BatchWorld::kStates),
                          any = batch_.unclear_on_line(from, to, at.data(), BatchWorld::kStates,
                                                       true);
      EXPECT_EQ(any != 0, all != 0) << kernel->name << ", line " << line;
      EXPECT_EQ(any & ~all, 0u) << kernel->name << ", line " << line;
      clear += all == 0;
      partly += all != 0 && all != 0xffffu;
    }
  }
  EXPECT_GT(clear, 20);
  EXPECT_GT(partly, 20);
}

}  // namespace
}  // namespace handsel::batch_collision_test
