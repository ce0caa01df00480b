// SPDX-License-Identifier: Apache-2.0
// Problems, settings and results of the path planner. Plain data.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/cost/navigation_cost.hpp"
#include "common/messages/planning.hpp"

namespace handsel::path_planner {

struct Settings {
  /// Max step of checked states along a motion during the search [rad, max norm].
  double step{0.02};
  double verify_step{0.0002};           ///< max step on the returned path [rad]
  double connect_range{0.7};            ///< max edge length of RRT and RRT-Connect [rad]
  double transition_range{0.3};         ///< max edge length of T-RRT and BiT-RRT [rad]
  double initial_temperature{0.002};    ///< of the transition test [unit of cost]
  double temperature_factor{1.5};       ///< of a rise and a fall of the temperature
  int max_refusals{3};                  ///< in a row, after which it rises
  double goal_bias{0.1};                ///< fraction of samples of T-RRT that are goals
  double max_refinement_fraction{0.1};  ///< max fraction of refining states in the tree of T-RRT
  /// Fraction of the budget for the first planner; the rest is for RRT-Connect if it fails.
  double search_fraction{0.7};
  double cost_step{0.1};        ///< spacing of cost samples along a motion [rad]
  double length_weight{0.05};   ///< price of a radian without human-aware cost
  int smoothing_rounds{120};    ///< max number of shortcuts and perturbations
  int max_idle_rounds{40};      ///< max number of successive ones without gain
  int perturbations{3};         ///< per shortcut, with human-aware cost
  double max_prune_loss{0.02};  ///< max relative increase of the price by a removed waypoint
  /// Max number of searches for one path: the first with the batch check only, from the third on
  /// with a fine step, because the fine check may refuse a path that the coarse check accepted.
  int max_attempts{4};
  double fine_step_ratio{0.1};             ///< fine step divided by `step`
  std::uint64_t first_tree_checks{40000};  ///< checks before the first restart of a search
  double first_budget_fraction{0.3};       ///< fraction of the budget for the first of them
  double near_ends{0.3};  ///< distance from start or goals at which it checks exactly [rad]
  /// l_max: max length replaced by a perturbation on each side [rad].
  double max_edge{0.6};
};

/// Bound on the tilt of the held object: angle of an axis of the tool frame from up.
struct Upright {
  /// Axis in the tool frame that points up, of any length.
  Vector3 axis_tool{Vector3::UnitZ()};
  Vector3 up_root{Vector3::UnitZ()};  ///< up in the frame of the robot's root link
  double max_angle{};                 ///< max angle from up [rad], in (0, pi)
  int link{-1};                       ///< link of the axis; -1: the tool of the robot
};

/// Axes of a planned platform (x, y, heading) and its human-aware cost. If axes of the arm are
/// planned as well, the larger of both costs counts.
struct PlatformMotion {
  std::array<int, 3> axes{};  ///< robot axes of x, y [m] and heading [rad]
  /// Cost of the platform in the world; never null, must outlive the problem.
  const NavigationCost* cost{};
};

/// One planning problem. A result depends only on the problem, the collision world and the cost.
struct Problem {
  std::vector<int> axes;      ///< robot axes to plan for, in the order of `goals`
  Vector start;               ///< all axes of the robot [rad]
  std::vector<Vector> goals;  ///< alternative goals, `axes` only [rad]
  /// Search method; automatic: depends on the presence of people.
  PlannerKind planner{PlannerKind::automatic};
  /// Whether OMPL's planner of that name replaces the own one, for comparison; no effect with
  /// automatic.
  bool stock{};
  std::uint64_t seed{1};             ///< seed of all random numbers
  std::uint64_t budget{100000};      ///< max number of checked states
  std::optional<Upright> upright{};  ///< bound on the whole path
  bool straight{};                   ///< only the checked line from start to goals[0]
  std::optional<PlatformMotion> platform_motion{};  ///< nullopt: no axes of a platform
  std::optional<std::pair<Vector, Vector>> room{};  ///< further bounds of `axes`
};

enum class Stage { search, smooth, verify };

class Tree;

/// Callbacks during planning; each may be empty.
struct Hooks {
  std::function<bool()> cancelled;     ///< called between checks; true ends planning
  std::function<void(Stage)> entered;  ///< called at the begin of a stage
  /// Smoothing continues while this returns true, regardless of the limits on rounds in Settings,
  /// so that all available time is used.
  std::function<bool()> smooth_on{};
  /// Called at the end of a search of this component with its trees: from the start and, if there
  /// is one, from the goals.
  std::function<void(const Tree& from_start, const Tree* from_goals)> searched{};
};

struct Result {
  bool solved{};       ///< the path ends at a goal and passes the fine check
  bool cancelled{};    ///< ended by the cancel hook before the budget was exhausted
  std::string reason;  ///< why there is no path, one sentence
  /// Id of the object, box or person that the robot touches at the start; empty: none.
  std::string start_touches;
  std::size_t goal{};        ///< index of the reached goal
  std::vector<Vector> path;  ///< `axes` only; front() = start, back() = goals[goal]
  double cost{};             ///< integral of the human-aware cost along the path [rad]
  double work{};             ///< mechanical work: sum of the increases of the cost
  double length{};           ///< joint-space length, Euclidean [rad]
  std::uint64_t checks{};    ///< number of checked states
  std::string planner;       ///< planner that found the path
};

}  // namespace handsel::path_planner
