// SPDX-License-Identifier: Apache-2.0
// The cost map against the analytic costs that it samples, on random people, furniture and points;
// the bounds are those of docs/costs.md.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "common/cost/cost_grid.hpp"
#include "common/cost/reach_check.hpp"
#include "components/costmap/layers.hpp"

namespace handsel::costmap::cost_grid_property_test {
namespace {

constexpr double kQuantum = 0.5 / 254;
// Distance to the eyes below which the angle of sight varies within a cell [m].
constexpr double kNearEyes = 0.15;

unsigned seed() {
  const char* given = std::getenv("HANDSEL_SEED");
  const unsigned value = given ? static_cast<unsigned>(std::atoi(given)) : 4711;
  std::printf("seed %u\n", value);
  return value;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vector3 direction() {
    std::normal_distribution<double> normal;
    return Vector3(normal(random_), normal(random_), normal(random_)).normalized();
  }
  Person person(double stature) {
    Person person;
    person.id = "anna";
    const Vector3 feet(uniform(-2, 2), uniform(-2, 2), 0);
    const double yaw = uniform(-3.14, 3.14);
    person.joints =
        uniform(0, 1) < 0.5 ? standing_body(feet, yaw, stature) : sitting_body(feet, yaw, stature);
    if (uniform(0, 1) < 0.7) {
      person.gaze_known = true;
      person.gaze_origin = find_joint(person, "head")->position;
      person.gaze_direction = direction();
    }
    return person;
  }
  Vector3 within(const Costmap& map) {
    const double edge = map.resolution * (map.nx - 1);
    return map.origin + Vector3(uniform(0, edge), uniform(0, edge), uniform(0, edge));
  }

 private:
  std::mt19937 random_;
};

/// Returns min and max over the points within a cell of p.
template <class F>
std::pair<double, double> around(const Vector3& p, double cell, F&& f) {
  std::pair<double, double> range{1, 0};
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k) {
        const double value = f(p + 0.5 * cell * Vector3(i, j, k));
        range = {std::min(range.first, value), std::max(range.second, value)};
      }
  return range;
}

TEST(CostGrid, safety_and_visibility_are_within_the_stated_error) {
  Draw draw(seed());
  double safety_error = 0, visibility_error = 0;
  for (int k = 0; k < 8; ++k) {
    MapSettings settings;
    settings.cost.safety_radius = draw.uniform(0.8, 1.3);
    MapMaker maker(settings);
    const Person person = draw.person(draw.uniform(1.5, 1.95));
    const Layers& layers = maker.make(person, {});
    const CostGrid safety(layers[0]), visibility(layers[1]);
    const SimplifiedBody body = simplified_body(person);
    const std::optional<Sight> sight = sight_of(person);
    for (int i = 0; i < 4000; ++i) {
      const Vector3 p = draw.within(layers[0]);
      const double exact =
          safety_cost(simplified_distance(body, p, p, 0), settings.cost.safety_radius);
      safety_error = std::max(safety_error, std::abs(safety.value(p).cost - exact));
      if ((p - sight->eyes).norm() > kNearEyes)
        visibility_error =
            std::max(visibility_error,
                     std::abs(visibility.value(p).cost -
                              visibility_cost(*sight, p, settings.cost.visibility_cutoff)));
    }
  }
  std::printf("largest error: safety %.4f, visibility %.4f\n", safety_error, visibility_error);
  EXPECT_LE(safety_error, 0.025);
  EXPECT_LE(visibility_error, 0.025);
}

TEST(CostGrid, arm_comfort_is_within_the_stated_error) {
  Draw draw(seed() + 1);
  double sum = 0, beyond = 0;
  int reachable = 0, rough = 0, points = 0, unlike = 0;
  for (const double stature : {1.55, 1.75, 1.9}) {
    MapMaker maker({});
    for (int k = 0; k < 3; ++k) {
      const Person person = draw.person(stature);
      const CostGrid comfort(maker.make(person, {})[2]);
      const std::vector<PlacedArm> arms = placed_arms(person);
      const auto exact_at = [&](const Vector3& p) { return arm_comfort_cost(nullptr, arms, p); };
      for (int i = 0; i < 800; ++i) {
        const Vector3 p = arms[static_cast<std::size_t>(i % 2)].shoulder +
                          draw.uniform(0, 0.75) * draw.direction();
        const GridValue value = comfort.value(p);
        ASSERT_TRUE(value.inside);
        const double exact = exact_at(p);
        ++points;
        unlike += value.forbidden != (exact >= 1);
        const auto [lowest, highest] = around(p, comfort.resolution(), exact_at);
        if (value.forbidden) {
          ASSERT_EQ(highest, 1.0) << "refused although all around is within reach";
          continue;
        }
        ASSERT_LT(lowest, 1.0) << "nothing around is within reach";
        beyond = std::max({beyond, lowest - value.cost, highest < 1 ? value.cost - highest : 0});
        if (exact >= 1) continue;
        ++reachable;
        sum += std::abs(value.cost - exact);
        rough += std::abs(value.cost - exact) > 0.05;
      }
    }
  }
  std::printf(
      "arm comfort: mean error %.4f, above 0.05 at %.2f %%, beyond the values within a cell by "
      "%.4f; reach judged otherwise %.2f %%\n",
      sum / reachable, 100.0 * rough / reachable, beyond, 100.0 * unlike / points);
  EXPECT_GT(reachable, 2000);
  EXPECT_LE(sum / reachable, 0.008);
  EXPECT_LE(rough, reachable / 50);
  EXPECT_LE(beyond, 0.01);
  EXPECT_LE(unlike, points / 20);
}

TEST(CostGrid, what_furniture_blocks_is_out_of_reach_and_the_sum_is_the_weighted_one) {
  Draw draw(seed() + 2);
  MapMaker maker({});
  for (int k = 0; k < 4; ++k) {
    const Person person = draw.person(1.75);
    const Vector3 front = find_joint(person, "torso")->position + 0.45 * torso_axes(person).col(0);
    const std::vector<SceneBox> boxes = {
        {"table", make_pose(front), {0.5, 0.7, 0.04}, true},
        {"block",
         make_pose(front + Vector3(0, 0, 0.5), {0.9, 0.1, 0.3, 0.3}),
         {0.2, 0.2, 0.2},
         false}};
    const Layers& layers = maker.make(person, boxes);
    const ReachCheck furniture(person, boxes);
    int blocked = 0;
    for (std::size_t i = 0; i < layers[2].values.size(); i += 7) {
      const double x = static_cast<double>(i % layers[2].nx),
                   y = static_cast<double>(i / layers[2].nx % layers[2].ny),
                   z = static_cast<double>(i / layers[2].nx / layers[2].ny);
      const std::uint8_t comfort = layers[2].values[i];
      if (furniture.blocked_by(layers[2].origin + layers[2].resolution * Vector3(x, y, z)) !=
          nullptr) {
        ASSERT_EQ(comfort, 255);
        ++blocked;
      }
      CostParts parts;
      parts.safety = layers[0].values[i] / 254.0;
      parts.visibility = layers[1].values[i] / 254.0;
      parts.comfort = std::min<int>(comfort, 254) / 254.0;
      ASSERT_NEAR(layers[3].values[i] / 254.0, weighted_cost(parts, {}), 2.1 * kQuantum);
    }
    EXPECT_GT(blocked, 100);
  }
}

TEST(CostGrid, the_gradient_is_the_slope_of_the_value_and_points_away_from_the_body) {
  Draw draw(seed() + 3);
  MapMaker maker({});
  const Person person = draw.person(1.75);
  const Layers& layers = maker.make(person, {});
  int uphill = 0, checked = 0;
  for (const std::size_t layer : {0, 2, 3}) {
    const CostGrid grid(layers[layer]);
    for (int i = 0; i < 3000; ++i) {
      const Vector3 p = draw.within(layers[layer]);
      const Vector3 cell = (p - layers[layer].origin) / layers[layer].resolution;
      const Vector3 place = cell - Vector3(cell.array().floor());
      if (place.minCoeff() < 0.05 || place.maxCoeff() > 0.95) continue;
      const GridValue at = grid.at(p);
      ASSERT_DOUBLE_EQ(at.cost, grid.value(p).cost);
      ASSERT_EQ(at.forbidden, grid.value(p).forbidden);
      constexpr double kStep = 1e-6;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3 d = kStep * Vector3::Unit(axis);
        const double slope = (grid.value(p + d).cost - grid.value(p - d).cost) / (2 * kStep);
        ASSERT_NEAR(at.gradient[axis], slope, 1e-4 * (1 + std::abs(slope))) << "layer " << layer;
      }
      if (layer != 0) continue;
      const SimplifiedBody body = simplified_body(person);
      const double d0 = simplified_distance(body, p, p, 0);
      if (d0 < 0.1 || d0 > 0.7) continue;
      ++checked;
      const Vector3 q = p + 0.05 * at.gradient.normalized();
      uphill += simplified_distance(body, q, q, 0) < d0;
    }
  }
  EXPECT_GT(checked, 300);
  EXPECT_GE(uphill, checked * 99 / 100);
}

TEST(CostGrid, ends_at_its_edges_and_forbids_where_most_neighbours_are_forbidden) {
  Costmap map;
  map.layer = "test";
  map.origin = {1, 2, 3};
  map.resolution = 0.5;
  map.nx = map.ny = map.nz = 2;
  map.values = {0, 254, 0, 254, 0, 254, 0, 255};
  ASSERT_EQ(CostGrid::fault(map), "");
  const CostGrid grid(map);
  EXPECT_TRUE(grid.forbids());
  EXPECT_DOUBLE_EQ(grid.at({1, 2, 3}).cost, 0);
  EXPECT_DOUBLE_EQ(grid.at({1.5, 2, 3}).cost, 1);
  EXPECT_NEAR(grid.at({1.25, 2, 3}).cost, 0.5, 1e-12);
  EXPECT_NEAR(grid.at({1.25, 2, 3}).gradient.x(), 2.0, 1e-12);
  EXPECT_TRUE(grid.at({1.5, 2.5, 3.5}).forbidden);
  EXPECT_FALSE(grid.at({1.25, 2.25, 3.25}).forbidden);
  for (const Vector3& outside :
       {Vector3(0.99, 2.2, 3.2), Vector3(1.51, 2.2, 3.2), Vector3(1.2, 2.2, NAN)}) {
    EXPECT_FALSE(grid.at(outside).inside);
    EXPECT_EQ(grid.at(outside).cost, 0);
    EXPECT_FALSE(grid.at(outside).forbidden);
  }
}

}  // namespace
}  // namespace handsel::costmap::cost_grid_property_test
