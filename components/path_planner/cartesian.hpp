// SPDX-License-Identifier: Apache-2.0
// Plans paths in Cartesian space (chapter section 4.6.1). Active variables: position and
// orientation of the tool, the angle of the elbow about the line from shoulder to wrist (the
// redundancy of an arm of seven axes), and further axes on request (hand, head). Passive variables:
// the joints of the arm, by closed-form inverse kinematics on their present branch, along every
// path segment. Pure.
#pragma once

#include "components/path_planner/path_planner.hpp"

namespace handsel::path_planner {

struct CartesianProblem {
  Vector start;  ///< all axes of the robot [rad]
  /// Pose of the tool, robot root frame; the elbow angle at the goal is free.
  Pose T_root_goal{Pose::Identity()};
  std::vector<int> also;  ///< further active axes (hand, head)
  Vector also_goal;       ///< goal of the further axes [rad]
  std::uint64_t seed{1};  ///< seed of the random samples; the result depends on it alone
  /// Max number of checked states, solutions of the inverse kinematics and search steps; exhausted
  /// without a path: not solved, while shortening: the path so far.
  std::uint64_t budget{100000};
};

struct CartesianSettings {
  double metre{3.0};  ///< weight of the tool's translation in the distance of nodes [rad/m]
  double elbow{0.5};  ///< weight of the elbow angle in this distance
  double range{0.6};  ///< max length of an edge of the tree, in this distance [rad]
  /// Step of the inverse kinematics along a path segment, in this distance [rad].
  double step{0.04};
  /// Max motion of an arm joint between two samples [rad]; at a larger one the step is halved up to
  /// four times, then the segment is refused as a jump.
  double largest_step{0.1};
  double goal_bias{0.1};             ///< fraction of targets that are nodes of the other tree
  int goal_elbows{48};               ///< number of elbow angles tried at the goal
  int shortcuts{60};                 ///< number of shortcuts tried on a found path
  double initial_temperature{0.02};  ///< of the transition test near people (T-RRT)
  double temperature_factor{1.5};    ///< of a rise and a fall of the temperature
  int max_refusals{3};               ///< in a row, after which it rises
  int attempts{3};                   ///< max searches whose path may fail the fine check
  int branch_goals{24};              ///< configurations tried on another branch
  double max_branch_offset{1.0};     ///< max random offset of these from the start [rad]
  double min_bend{0.2};              ///< min bend of shoulder, elbow and wrist there [rad]
};

/// A configuration in active variables, with the corresponding passive variables.
struct CartesianNode {
  Pose T_root_tool{Pose::Identity()};  ///< pose of the tool, frame of the root link
  double elbow{};                      ///< angle on the elbow's circle, 0 = max along axis 1 [rad]
  Vector q;                            ///< configuration of all axes
};

struct CartesianResult {
  bool solved{};                     ///< the path ends at the goal
  bool cancelled{};                  ///< ended by the cancel hook before the budget was exhausted
  std::string reason;                ///< why there is no path, one sentence
  std::vector<CartesianNode> nodes;  ///< nodes of the path, the start first
  /// Configurations of all axes along the path; neighbours differ by at most largest_step per
  /// joint.
  std::vector<Vector> samples;
  /// Number of first segments of `samples` in joint space, which change to the branch of the goal.
  std::size_t in_joints{};
  double cost{};           ///< integral of the human-aware cost along the samples [rad]
  double work{};           ///< sum of the increases of this cost
  double length{};         ///< length of the samples in joint space [rad]
  std::uint64_t checks{};  ///< checked states and solutions of the inverse kinematics
};

/// Plans a path. Tries goals on the branch of the start first, then changes to other branches in
/// joint space. Grows two trees: RRT-Connect without people, with the transition test of T-RRT near
/// people. An arm that is no ik::SrsArm, wrong sizes, an axis goal beyond its limits or a start in
/// collision: not solved, with a reason. A path segment turns the
/// tool about one axis by an angle below pi; at pi the axis is undefined and there is no path
/// segment.
CartesianResult plan_cartesian(const RobotModel& robot, CollisionWorld& world, HumanCost& cost,
                               const CartesianProblem& problem, const CartesianSettings& settings,
                               const Hooks& hooks = {});

/// Returns the result as a path of these axes.
Result in_joints(const CartesianResult& found, const std::vector<int>& axes);

}  // namespace handsel::path_planner
