// SPDX-License-Identifier: Apache-2.0
// Plans one Cartesian motion in steps: waypoints, elbow angles, timing, joints at each period.
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

/// Numbers of active axes up to the tool, up to the elbow.
inline constexpr int kTool = 6, kElbow = 7;

/// Returns the text of a printf pattern, up to 239 characters.
template <class... Values>
std::string formatted(const char* pattern, Values... values) {
  char out[240];
  std::snprintf(out, sizeof out, pattern, values...);
  return out;
}

/// Returns the name of a waypoint of the request in messages, e.g. "node 2"; 0 is the start.
inline std::string node_name(std::size_t node) { return "node " + std::to_string(node); }

class CartesianPlanning {
 public:
  /// Keeps references to all arguments.
  CartesianPlanning(const RobotModel& robot, const Group& arm, CollisionWorld& world,
                    const CartesianRequest& request, const CartesianSettings& settings)
      : robot_(robot), group_(arm), world_(world), request_(request), settings_(settings) {}

  /// Plans the motion and moves it out: to be called once. A motion that ends before the last
  /// waypoint has `solved` false, a reason and the number `reached`.
  CartesianMotion run();

 private:
  using Node = CartesianTrajectory::Node;

  bool refuse(const std::string& why);
  /// Ends the path before this waypoint of the request.
  void end_before(std::size_t given, const std::string& why);
  bool possible();
  bool join();
  /// Returns the axes of the arm and the joined arm, and the further axes that move.
  std::vector<int> axes_that_move() const;
  Vector whole(const ik::Axes& q, const Vector& also) const;

  /// Computes the active values of the waypoints as long as path segments exist; open elbow angles
  /// are that of the start.
  void find_nodes();
  /// Returns the configuration at the end of a path segment, on the branch of its start; nullopt if
  /// joints reach a limit or jump. Writes speed samples unless null.
  std::optional<ik::Axes> along_segment(std::size_t segment, double elbow_from, double elbow_to,
                                        const ik::Axes& from,
                                        std::vector<SpeedAlong::SpeedSample>* samples) const;
  /// Selects open elbow angles with min cost: distance of the joints from their limits and motion
  /// of the elbow, among angles with a path. Tests paths only for the cheapest options.
  void choose_elbows();
  std::string why_no_path(std::size_t k) const;

  KinematicLimits active_limits() const;
  /// Computes TR of the remaining waypoints.
  bool timed();
  /// Returns whether a blend is free, from the configuration of its waypoint to both ends.
  bool corner_free(const Trajectory& corner) const;
  /// Returns the waypoint of a blend, which starts on the previous and ends on the next path
  /// segment.
  std::size_t node_of(const Trajectory& corner) const;

  /// Computes the joints at every period; if impossible, ends the path before the next waypoint.
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
  std::vector<std::size_t> given_;        // number of each waypoint in the request; the start is 0
  std::vector<ik::Axes> configurations_;  // at the waypoints
  std::vector<double> times_;
  CartesianMotion motion_;
};

}  // namespace handsel::trajectory_planner
