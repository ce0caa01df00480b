// SPDX-License-Identifier: Apache-2.0
// What a policy uses in the place of the manipulation planner: commands to the trajectory
// controller, requests to the planners, and the status that announces what it does.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/task.hpp"
#include "common/model/robot_model.hpp"
#include "deploy/handsel/environment/observation.hpp"

namespace handsel::environment {

/// A motion that a policy wants planned.
struct MotionQuery {
  std::string group{"arm"};          ///< axes that move
  std::vector<Vector> goals;         ///< alternatives, group axes [rad]
  std::vector<std::string> allowed;  ///< objects and people that may be touched
  bool straight{};                   ///< only the straight line of the axes to the first goal
  double speed{1.0};                 ///< factor on the comfort velocity limits, (0, 1]
  /// Actuated axes of the hand during the motion, in their order [rad]; empty: as they are.
  Vector hand;
  double time_limit{3.0};  ///< budget of the path planner [s]
  /// Group axes from which the motion begins [rad]; empty: where they are.
  Vector from;
};

/// A planned motion.
struct MotionPlan {
  std::string reason;         ///< why there is none, one sentence; empty: there is one
  std::vector<Vector> path;   ///< waypoints, group axes [rad]
  TrajectoryCommand command;  ///< runs it
};

class PolicyLink {
 public:
  /// Adds the component manipulation_planner to the network. `seed`: of the planners. The
  /// references must outlive the link.
  PolicyLink(LocalNetwork& network, const View& view, std::shared_ptr<const RobotModel> robot,
             std::uint64_t seed);
  PolicyLink(const PolicyLink&) = delete;
  PolicyLink& operator=(const PolicyLink&) = delete;

  /// Returns grasps of an object, best first; advances the virtual time until the grasp planner has
  /// answered. Without grasps `reason` says why.
  GraspReply grasps(const std::string& object, const std::string& for_human,
                    const std::string& group, std::uint32_t max_grasps);
  /// Plans a motion; advances the virtual time until the planners have answered.
  MotionPlan plan(const MotionQuery& query);
  /// Returns the motion to a target of some axes in minimum time within the comfort limits times
  /// `speed`; nothing is checked for collisions. `reason` when there is none.
  MotionPlan direct(const std::string& group, const Vector& target, double speed) const;

  /// Sends the command of a plan.
  void run(MotionPlan plan);
  /// Ends the running motion with a jerk-limited stop.
  void stop();
  /// Sends a command to a hand.
  void hand(HandCommand command);
  /// Attaches an object to the hand, as it lies in the hand now; empty: nothing is held.
  void hold(const std::string& object);
  /// Announces an offer (`giving`) or a request to the person, whose forearm and hand are exempt
  /// from separation from now on; empty: the handover is over.
  void engage(const std::string& person, bool giving);

 private:
  template <class Reply>
  std::optional<Reply> await(std::optional<Reply>& slot, double timeout);
  TrajectoryCommand command_head(const std::vector<std::string>& allowed);
  void publish_status();
  const Group& group_of(const std::string& name) const;

  LocalNetwork& network_;
  const View& view_;
  std::shared_ptr<const RobotModel> robot_;
  std::uint64_t seed_, commands_{0}, requests_{0};
  Attachment attachment_;
  ActionStatus status_;
  std::unique_ptr<Publisher<GraspRequest>> grasp_out_;
  std::unique_ptr<Publisher<PathRequest>> path_out_;
  std::unique_ptr<Publisher<TrajectoryRequest>> timing_out_;
  std::unique_ptr<Publisher<TrajectoryCommand>> trajectory_out_;
  std::unique_ptr<Publisher<HandCommand>> hand_out_;
  std::unique_ptr<Publisher<ActionStatus>> status_out_;
  std::optional<GraspReply> grasp_reply_;
  std::optional<PathReply> path_reply_;
  std::optional<TrajectoryReply> timing_reply_;
};

}  // namespace handsel::environment
