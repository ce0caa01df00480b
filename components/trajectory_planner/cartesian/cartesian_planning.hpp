// The planning of one Cartesian motion, step by step: nodes, elbows, timing, joints at each period.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/trajectory_planner/cartesian/cartesian_arm.hpp"
#include "components/trajectory_planner/cartesian/path_check.hpp"
#include "components/trajectory_planner/cartesian_motion.hpp"

namespace handsel::trajectory_planner {

inline constexpr int kTool = 6, kElbow = 7;  ///< active axes up to those of the tool, of the elbow

/// Returns the text of a printf pattern, up to 239 characters.
template <class... Values>
std::string formatted(const char* pattern, Values... values) {
  char out[240];
  std::snprintf(out, sizeof out, pattern, values...);
  return out;
}

/// Returns a node of the request as in messages, e.g. "node 2"; 0 is the start.
inline std::string node_name(std::size_t node) { return "node " + std::to_string(node); }

class CartesianPlanning {
 public:
  /// Keeps references to all arguments.
  CartesianPlanning(const RobotModel& robot, const Group& arm, CollisionWorld& world,
                    const CartesianRequest& request, const CartesianSettings& settings)
      : robot_(robot), group_(arm), world_(world), request_(request), settings_(settings) {}

  /// Plans the motion, once.
  CartesianMotion run();

 private:
  using Node = CartesianTrajectory::Node;

  bool refuse(const std::string& why);
  /// The path ends before this node of the request.
  void end_before(std::size_t given, const std::string& why);
  bool possible();
  bool join();
  /// Those of the arm and the one that follows it, and further ones that some node has elsewhere.
  std::vector<int> axes_that_move() const;
  Vector whole(const ik::Axes& q, const Vector& also) const;

  /// The active values of the nodes, as far as path segments between them exist; elbows left open
  /// are those of the start.
  void find_nodes();
  /// The configuration at the end of a path segment, on the branch of its beginning; nullopt where
  /// joints meet a limit or jump. Writes samples of speed unless null.
  std::optional<ik::Axes> along_segment(std::size_t segment, double elbow_from, double elbow_to,
                                        const ik::Axes& from,
                                        std::vector<SpeedAlong::SpeedSample>* samples) const;
  /// Elbow angles of the nodes that leave it open: those that keep the joints clear of their limits
  /// with little motion of the elbow, and that a path leads to. Cheapest first; paths are only
  /// tried where they would be taken.
  void choose_elbows();
  std::string why_no_path(std::size_t k) const;

  KinematicLimits active_limits() const;
  /// TR of the nodes left.
  bool timed();
  /// A corner is followed from the configuration of its node to both ends.
  bool corner_free(const Trajectory& corner) const;
  /// The node of a corner: it begins on the path segment before and ends on the one after.
  std::size_t node_of(const Trajectory& corner) const;

  /// The joints at every period. Where that is not possible the path ends before the node ahead.
  bool followed();
  std::size_t ahead_of(double t, std::size_t node) const;
  std::string why_stopped(std::size_t given, const Pose& T, double elbow, const Vector& also,
                          const ik::Axes& q) const;
  void approximated();
  void measure_join();
  bool inside_limits(const Trajectory& trajectory) const;

  const RobotModel& robot_;
  const Group& group_;
  CollisionWorld& world_;
  const CartesianRequest& request_;
  const CartesianSettings& settings_;
  std::optional<CartesianArm> arm_;
  std::optional<ClosedChain> joined_;
  std::vector<std::size_t> given_;        // of each node, its number in the request; the start is 0
  std::vector<ik::Axes> configurations_;  // at the nodes
  std::vector<double> times_;
  CartesianMotion motion_;
};

}  // namespace handsel::trajectory_planner
