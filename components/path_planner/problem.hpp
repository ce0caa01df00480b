// What the path planner is asked, and what it answers. Plain data.
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
  /// States along a motion are checked at least this close while searching [rad, max norm].
  double step{0.02};
  double verify_step{0.0002};         ///< and this close on the path that is returned [rad]
  double connect_range{0.7};          ///< longest edge of RRT and RRT-Connect [rad]
  double transition_range{0.3};       ///< longest edge of T-RRT and BiT-RRT [rad]
  double initial_temperature{0.002};  ///< of the transition test, in units of cost
  /// Of the budget for the first planner; the rest is for RRT-Connect when it finds nothing.
  double search_fraction{0.7};
  double cost_step{0.1};       ///< spacing of cost samples along a motion [rad]
  double length_weight{0.05};  ///< cost of a radian where no person is concerned
  int smoothing_rounds{120};   ///< shortcuts and perturbations tried
  int max_idle_rounds{40};     ///< stop smoothing after this many in a row without gain
  /// l_max: a perturbation replaces at most this much of the path to either side [rad].
  double max_edge{0.6};
};

/// What is held stays upright: an axis of the tool frame within an angle of up.
struct Upright {
  /// Axis in the tool frame that is to point up, of any length.
  Vector3 axis_tool{Vector3::UnitZ()};
  Vector3 up_root{Vector3::UnitZ()};  ///< up in the frame of the robot's root link
  double max_angle{};                 ///< [rad], in (0, pi)
  int link{-1};                       ///< whose frame the axis is in; -1: the tool of the robot
};

/// The platform is among the axes that are planned for: which they are (x, y, heading), and what
/// people think of it where it drives. What they think of the arm counts where axes of the arm are
/// planned for, too; the worse of the two.
struct PlatformMotion {
  std::array<int, 3> axes{};  ///< robot axes of x, y [m] and heading [rad]
  /// Of the platform in the world; never null, must outlive the problem.
  const NavigationCost* cost{};
};

/// One planning problem. Everything a result depends on is in here, in the collision world and in
/// the cost.
struct Problem {
  std::vector<int> axes;      ///< robot axes to plan for, in the order of `goals`
  Vector start;               ///< all axes of the robot [rad]
  std::vector<Vector> goals;  ///< alternatives, `axes` only [rad]
  /// Which search; automatic chooses by whether people are concerned.
  PlannerKind planner{PlannerKind::automatic};
  /// OMPL's planner of that name instead of the own one, for comparison; automatic: as without.
  bool stock{};
  std::uint64_t seed{1};             ///< of all random numbers; the same gives the same result
  std::uint64_t budget{100000};      ///< states that may be checked
  std::optional<Upright> upright{};  ///< holds everywhere on the path
  bool straight{};                   ///< only the line from start to goals[0], checked
  std::optional<PlatformMotion> platform_motion{};  ///< when axes of the platform are planned for
  std::optional<std::pair<Vector, Vector>> room{};  ///< `axes` stay within these, too
};

enum class Stage { search, smooth, verify };

class Tree;

/// What a caller observes while planning runs. Any may be empty.
struct Hooks {
  std::function<bool()> cancelled;     ///< asked between checks; true ends the plan
  std::function<void(Stage)> entered;  ///< a stage begins
  /// Smoothing continues as long as this says so, whatever the limits on its rounds in Settings
  /// are: any time that a caller has is used.
  std::function<bool()> smooth_on{};
  /// A search of this component has ended with these trees: from the start and, where it grew one,
  /// from the goals.
  std::function<void(const Tree& from_start, const Tree* from_goals)> searched{};
};

struct Result {
  bool solved{};       ///< the path ends at a goal and is free at the finest step
  bool cancelled{};    ///< ended by its cancel hook before the budget was used up
  std::string reason;  ///< why not, one sentence
  /// Id of the object, box or person the robot touches at the start; empty: none.
  std::string start_touches;
  std::size_t goal{};        ///< index of the goal reached
  std::vector<Vector> path;  ///< `axes` only; front() = start, back() = goals[goal]
  double cost{};             ///< integral of the human-aware cost along the path [rad]
  double work{};             ///< mechanical work: sum of the rises of the cost
  double length{};           ///< joint-space length, Euclidean [rad]
  std::uint64_t checks{};    ///< states checked
  std::string planner;       ///< that found it
};

}  // namespace handsel::path_planner
