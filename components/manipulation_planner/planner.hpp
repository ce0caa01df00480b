// SPDX-License-Identifier: Apache-2.0
// The human-aware manipulation planner (MHP, chapter section 2.1): brings grasp, path and
// trajectory planner together to execute one action. Pure: messages come in, time comes in,
// messages are sent through the Outbox.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/messages/attention.hpp"
#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {

class ManipulationPlanner {
 public:
  /// `client` makes request ids unique over restarts; trajectory and hand command ids start above
  /// it.
  ManipulationPlanner(const settings::ManipulationPlannerSettings& settings,
                      std::shared_ptr<const RobotModel> robot, ObjectLibrary objects,
                      std::uint64_t client, const CostSettings& cost = {});

  /// Begins an action in place of the one that runs, or cancels the one with that id. A goal with
  /// the id of the last action changes nothing.
  void on(const ActionGoal& goal);
  /// Takes the newest scene; objects, boxes and base of the robot in the world frame.
  void on(const Scene& scene) { parts_.now.on(scene); }
  /// Takes the newest people, joints in the world frame.
  void on(const HumanState& people) { parts_.now.on(people); }
  /// Takes the facts that hold now; they replace all before.
  void on(const Facts& facts) { parts_.now.on(facts); }
  /// Takes a cost layer; `sent`: when its writer sent the layer.
  void on(const Costmap& layer, TimePoint sent, TimePoint now) { parts_.now.on(layer, sent, now); }
  /// Takes the advised period of replanning, the gain of the human-aware cost and the shift of the
  /// exchange point; all hold for a moment only.
  void on(const AttentionAdvice& advice, TimePoint now) {
    parts_.replanner.advise(advice.replan_period, advice.cost_gain, now);
    parts_.shift.advise(advice, now);
  }
  /// Takes the newest report of the controller: what holds the robot back, and the state of its
  /// command.
  void on(const ExecutionStatus& status) { parts_.now.on(status); }
  /// Takes what the controller runs, and its set-point: the joints as commanded.
  void on(const ActiveTrajectory& active) { parts_.now.on(active); }
  /// Takes a reply; ignored unless it answers the newest request.
  void on(const GraspReply& reply) { parts_.clients.grasp.on(reply); }
  /// Takes a reply; ignored unless it answers the newest request.
  void on(const RegraspReply& reply) { parts_.clients.regrasp.on(reply); }
  /// Takes a reply; ignored unless it answers the newest request.
  void on(const PathReply& reply) { parts_.clients.path.on(reply); }
  /// Takes a reply; ignored unless it answers the newest request or the comparison that was asked
  /// for.
  void on(const TrajectoryReply& reply);
  /// Counts one job of the outbox as ended; what it wrote may be read from now on.
  void job_done() { parts_.worker.job_done(); }

  /// Continues the action at `now` and adds to the outbox what is to be sent; called periodically,
  /// from one thread.
  void step(TimePoint now, Outbox& out);
  /// Returns the state of the action that runs or ran last, as of the last step().
  const ActionStatus& status() const { return parts_.action; }
  /// Returns what became of the checks of running paths since the start of the planner.
  const ReplanCounts& replan_counts() const { return parts_.replanner.counts(); }
  /// Returns which cost layer was left out and why, one sentence; empty: none was.
  std::string complaint(TimePoint now) { return parts_.now.complaint(now); }

 private:
  Routine<Outcome> run(ActionGoal goal);
  Routine<Outcome> find_hand(const ActionGoal& goal);
  void drop_action();
  void continue_action();
  void end_action(const Outcome& outcome);
  void lose_object();

  Parts parts_;
  Routine<Outcome> action_;
  ActionGoal goal_;
};

}  // namespace handsel::manipulation_planner
