// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/landscape.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "components/path_planner/search/search.hpp"
#include "components/path_planner/search/smoothing.hpp"
#include "components/path_planner/search/tree.hpp"
#include "deploy/handsel/pictures/png.hpp"

namespace handsel {
namespace {

using nlohmann::json;

constexpr double kCell = 0.02;  // cell size of the landscape
constexpr int kCells = 101, kLayers = 3;
constexpr double kScale = 300;  // [px/unit]

struct Hill {
  double x, y, height, width;
};
constexpr Hill kHills[] = {{0.0, 0.05, 0.9, 0.3},    {-0.55, 0.45, 0.7, 0.25},
                           {0.6, -0.45, 0.8, 0.25},  {0.45, 0.75, 0.45, 0.2},
                           {-0.6, -0.25, 0.4, 0.18}, {0.1, -0.8, 0.5, 0.22}};

double height_at(double x, double y) {
  double sum = 0.02;
  for (const Hill& hill : kHills)
    sum += hill.height * std::exp(-(std::pow(x - hill.x, 2) + std::pow(y - hill.y, 2)) /
                                  (hill.width * hill.width));
  return std::min(1.0, sum);
}

RobotModel gantry() {
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("handsel_landscape_" + std::to_string(getpid()) + ".urdf");
  std::ofstream(file)
      << R"(<robot name="gantry"><link name="floor"/><link name="carriage"/><link name="point">
<collision><geometry>
<sphere radius="0.001"/></geometry></collision></link>
<joint name="x" type="prismatic"><parent link="floor"/><child link="carriage"/>
<axis xyz="1 0 0"/><limit lower="-0.98" upper="0.98" effort="1" velocity="1"/></joint>
<joint name="y" type="prismatic"><parent link="carriage"/><child link="point"/>
<axis xyz="0 1 0"/><limit lower="-0.98" upper="0.98" effort="1" velocity="1"/></joint>
</robot>)";
  RobotModel robot = RobotModel::load_urdf(file);
  std::filesystem::remove(file);
  return robot;
}

Costmap landscape() {
  Costmap map;
  map.layer = "landscape";
  map.origin = Vector3(-1, -1, -kCell);
  map.resolution = kCell;
  map.nx = map.ny = kCells;
  map.nz = kLayers;
  for (int k = 0; k < kLayers; ++k)
    for (int j = 0; j < kCells; ++j)
      for (int i = 0; i < kCells; ++i)
        map.values.push_back(static_cast<std::uint8_t>(
            std::lround(254 * height_at(-1 + i * kCell, -1 + j * kCell))));
  return map;
}

json points(const std::vector<Vector>& path) {
  json out = json::array();
  for (const Vector& q : path) out.push_back({q[0], q[1]});
  return out;
}

class Drawing {
 public:
  Drawing()
      : picture_(static_cast<int>(2 * kScale), static_cast<int>(2 * kScale), {255, 255, 255}) {
    for (int y = 0; y < picture_.height(); ++y)
      for (int x = 0; x < picture_.width(); ++x) {
        const double cost = height_at(x / kScale - 1, 1 - y / kScale);
        const auto mix = [cost](int low, int high) {
          return static_cast<std::uint8_t>(low + cost * (high - low));
        };
        picture_.dot(x, y, {mix(247, 51), mix(251, 42), mix(242, 95)});
      }
  }
  void line(const Vector& a, const Vector& b, int thickness, Colour colour) {
    picture_.line((a[0] + 1) * kScale, (1 - a[1]) * kScale, (b[0] + 1) * kScale,
                  (1 - b[1]) * kScale, thickness, colour);
  }
  void path(const std::vector<Vector>& path, int thickness, Colour colour) {
    for (std::size_t i = 1; i < path.size(); ++i) line(path[i - 1], path[i], thickness, colour);
  }
  json tree(const path_planner::Tree& tree, Colour colour) {
    json out = json::array();
    for (int i = 0; i < tree.size(); ++i) {
      out.push_back({tree[i][0], tree[i][1], tree.parent(i)});
      if (tree.parent(i) >= 0) line(tree[tree.parent(i)], tree[i], 1, colour);
    }
    return out;
  }
  std::string png() const { return picture_.png(); }

 private:
  Picture picture_;
};

}  // namespace

LandscapeResult plan_on_landscape(PlannerKind planner, std::uint64_t seed) {
  const RobotModel robot = gantry();
  CollisionWorld world(robot, nullptr);
  HumanCost cost(robot, {});
  LayersNow layers;
  layers.outside.push_back(std::make_shared<CostGrid>(landscape()));
  cost.set_layers(layers);
  path_planner::Settings settings;
  settings.connect_range = settings.transition_range = 0.1;
  settings.cost_step = kCell;
  settings.max_edge = 0.3;
  settings.length_weight = 0.02;
  settings.smoothing_rounds = 600;
  settings.max_idle_rounds = 200;
  path_planner::Problem problem;
  problem.axes = {0, 1};
  problem.start = Eigen::Vector2d(-0.85, -0.75);
  problem.goals = {Eigen::Vector2d(0.85, 0.8)};
  problem.seed = seed;

  Drawing drawing;
  LandscapeResult result;
  result.answer["trees"] = json::array();
  path_planner::Hooks hooks;
  hooks.searched = [&](const path_planner::Tree& from_start, const path_planner::Tree* from_goals) {
    result.answer["trees"].push_back(drawing.tree(from_start, {40, 120, 60}));
    if (from_goals != nullptr)
      result.answer["trees"].push_back(drawing.tree(*from_goals, {30, 90, 170}));
  };
  path_planner::SearchSpace space(robot, world, cost, problem, settings, hooks);
  path_planner::Found found = path_planner::search(space, problem.goals, planner, true, seed);
  result.answer["solved"] = !found.path.empty();
  result.answer["raw"] = points(found.path);
  drawing.path(found.path, 2, {230, 140, 20});
  path_planner::Random random(seed);
  if (!found.path.empty()) path_planner::smooth(space, found.path, random);
  drawing.path(found.path, 4, {200, 20, 30});
  double integral = 0, work = 0;
  for (std::size_t i = 1; i < found.path.size(); ++i) {
    integral += space.costs().integral(found.path[i - 1], found.path[i]);
    work += space.costs().work(found.path[i - 1], found.path[i]);
  }
  result.answer["path"] = points(found.path);
  result.answer["cost"] = integral;
  result.answer["work"] = work;
  result.answer["length"] = path_planner::path_length(found.path);
  result.answer["nodes"] = found.nodes;
  result.png = drawing.png();
  return result;
}

}  // namespace handsel
