// SPDX-License-Identifier: Apache-2.0
// Motions from a running path onto another one: whether they are free of collision, and whether the
// other path is worth the switch. Pure; all data are values, for a job.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/collision/collision_world.hpp"
#include "common/cost/human_cost.hpp"
#include "common/trajectory/switch.hpp"
#include "components/manipulation_planner/motion/motion_spec.hpp"

namespace handsel::manipulation_planner {

/// Bounds of a switch.
struct SwitchBounds {
  double max_slower{};  ///< duration that a path may take longer, relative, per saved ratio of cost
  double min_saved{};   ///< ratio of the cost that a switch must save
  double reserve{};     ///< max ratio of the connecting motion to the comfort limits
  double step{};        ///< of the checks of the connecting motion [rad, max norm]
  double rest_step{};   ///< of the checks of what follows it [rad, max norm]
  double margin{};      ///< around furniture and what other axes turn [m]
};

/// A path that is offered while another one runs.
struct SwitchCandidate {
  std::optional<Trajectory> onto;  ///< onto it; nullopt: nothing leads there
  std::optional<Trajectory>
      along;            ///< the running one, timed for the people now; nullopt: it must be left
  bool is_worth{true};  ///< switching to it
  double speed{1};      ///< scale of the velocity limits that the connecting motion keeps
  double max_reach{};   ///< joined within this of the switch point, max norm [rad]
};

/// Where the running path is left.
struct SwitchPoint {
  double time{};      ///< on the time of what the controller runs [s]
  double offset{};    ///< of the running command's trajectory on that time [s]
  MotionState3 from;  ///< axes of the arm
  bool at_rest{};     ///< the arm
  double rest{};      ///< duration of what runs from there on, at full speed [s]
};

/// The scene that a switch is checked in.
struct PlanningSnapshot {
  Scene scene;                       ///< newest
  HumanState people;                 ///< newest
  LayersNow layers;                  ///< cost layers that are not stale
  Attachment attachment;             ///< what the hand holds
  std::vector<std::string> allowed;  ///< what may be touched
  Vector q;                          ///< axes that are not the arm's [rad, m]
  double cost_gain{1};               ///< factor of the saved cost, as attention has it
  std::optional<TiltBound> tilt{};   ///< of what is held
  int palm{-1};                      ///< link of the hand that holds it
};

class SwitchPlanner {
 public:
  /// Plans for the axes `arm`.
  SwitchPlanner(std::shared_ptr<const RobotModel> robot, Group arm, const SwitchBounds& bounds)
      : robot_(std::move(robot)), arm_(std::move(arm)), bounds_(bounds) {}

  /// Returns the motion from a state onto a trajectory.
  Switched join(const MotionState3& from, const Trajectory& to,
                const SwitchCandidate& candidate) const;
  /// Replaces the trajectories of the candidate by what the arm would really do, and compares them.
  /// `world`, `cost`: of the robot; their scene is replaced.
  void evaluate(SwitchCandidate& candidate, CollisionWorld& world, HumanCost& cost,
                const PlanningSnapshot& now, const SwitchPoint& point) const;

 private:
  std::optional<Trajectory> free_motion(CollisionWorld& world, const PlanningSnapshot& now,
                                        const MotionState3& from,
                                        const SwitchCandidate& candidate) const;
  bool is_free(CollisionWorld& world, const Switched& motion, const PlanningSnapshot& now) const;
  bool is_upright(const Vector& q, const PlanningSnapshot& now) const;
  double cost_along(const HumanCost& cost, const Trajectory& trajectory, const Vector& q_other,
                    double level) const;
  double cost_at(const HumanCost& cost, const Vector& joints, const Vector& q_other) const;
  bool is_within_limits(const Vector& joints) const;

  std::shared_ptr<const RobotModel> robot_;
  Group arm_;
  SwitchBounds bounds_;
};

/// Returns whether a motion onto a trajectory takes longer than from rest: it would go past where
/// it joins, and come back.
bool turns_back(const Switched& motion, const Trajectory& onto);

}  // namespace handsel::manipulation_planner
