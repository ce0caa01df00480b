// Planning in the Cartesian space (chapter section 4.6.1). Active: where the tool is, how it is
// turned, the angle of the elbow about the line from shoulder to wrist (the redundancy of an arm of
// seven axes), and other axes if asked for (hand, head). Passive: the arm's joints, by closed-form
// inverse kinematics on the branch they are on, along every local path. Pure.
#pragma once

#include "components/path_planner/path_planner.hpp"

namespace handsel::path_planner {

struct CartesianProblem {
  Vector start;  ///< all axes of the robot [rad]
  /// Of the tool, robot root frame; the elbow may end anywhere.
  Pose T_root_goal{Pose::Identity()};
  std::vector<int> also;  ///< further active axes (hand, head)
  Vector also_goal;       ///< of those [rad]
  std::uint64_t seed{1};  ///< of the random samples; the same gives the same result
  /// States that may be checked; each solution of the inverse kinematics counts as one, too.
  std::uint64_t budget{100000};
};

struct CartesianSettings {
  double metre{3.0};  ///< that many radians count as much as a metre [rad/m]
  double elbow{0.5};  ///< weight of a radian of the elbow angle
  double range{0.6};  ///< longest edge of the tree, in that measure
  /// The inverse kinematics is solved this often along a local path, in that measure.
  double step{0.04};
  /// No joint moves farther between two samples, however close they are; farther is a jump,
  /// refused [rad].
  double largest_step{0.1};
  double goal_bias{0.1};             ///< fraction of the samples that are goals
  int goal_elbows{48};               ///< elbow angles tried at the goal
  int shortcuts{60};                 ///< tried on what was found
  double initial_temperature{0.02};  ///< of the transition test, where people are concerned (T-RRT)
};

/// A configuration in active variables, with the passive ones that belong to it.
struct CartesianNode {
  Pose T_root_tool{Pose::Identity()};  ///< pose of the tool, frame of the root link
  double elbow{};                      ///< on its circle, 0 = farthest along axis 1 [rad]
  Vector q;                            ///< all axes
};

struct CartesianResult {
  bool solved{};                     ///< the path ends at the goal
  bool cancelled{};                  ///< ended by its cancel hook before the budget was used up
  std::string reason;                ///< why not, one sentence
  std::vector<CartesianNode> nodes;  ///< of the path, the start first
  /// All axes, along the local paths; neighbours differ by at most largest_step in every joint.
  std::vector<Vector> samples;
  /// This many motions of the samples, the first, are of the joints: they bend the arm as it is
  /// bent at the goal.
  std::size_t in_joints{};
  double cost{};           ///< integral of the human-aware cost along the samples [rad]
  double work{};           ///< sum of the rises of that cost
  double length{};         ///< of the samples, joint space [rad]
  std::uint64_t checks{};  ///< states checked, and solutions of the inverse kinematics
};

/// Goals on the branch of the start come first; where none is reached, the arm changes to another
/// branch in joint space before. Two trees, RRT-Connect where no person is present, with the
/// transition test of T-RRT where a person is. The arm must be one of shoulder, elbow and wrist
/// (ik::SrsArm). The path from one orientation to another is their displacement: one axis and an
/// angle up to pi; at pi, where the axis is not defined, there is no local path.
CartesianResult plan_cartesian(const RobotModel& robot, CollisionWorld& world, HumanCost& cost,
                               const CartesianProblem& problem, const CartesianSettings& settings,
                               const Hooks& hooks = {});

/// Returns the same as a path of these axes.
Result in_joints(const CartesianResult& found, const std::vector<int>& axes);

}  // namespace handsel::path_planner
