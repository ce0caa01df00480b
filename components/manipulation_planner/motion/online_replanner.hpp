// SPDX-License-Identifier: Apache-2.0
// Online replanning: a running motion is checked again and again for a better path for the people
// as they are now, and for a path around what came into it (chapter sections 2.1 and 4.1.1). The
// path planner keeps what lies before the switch point; the controller is given its time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/base/advised_period.hpp"
#include "common/config/settings/manipulation_planner.hpp"
#include "common/cost/human_cost.hpp"
#include "components/manipulation_planner/motion/motion_spec.hpp"
#include "components/manipulation_planner/motion/switch_planner.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

struct Parts;

/// What became of the checks of running paths.
struct ReplanCounts {
  std::uint64_t checks{};     ///< paths asked for
  std::uint64_t unchanged{};  ///< came back as they were
  std::uint64_t slower{};     ///< cheaper, but longer
  std::uint64_t switched{};   ///< switched to
  std::uint64_t refused{};    ///< refused before the switch
  std::uint64_t retimed{};    ///< unchanged, but timed anew
};

class OnlineReplanner {
 public:
  /// `parts` must outlive what is made; it is used only when a motion runs.
  OnlineReplanner(Parts& parts, const settings::ManipulationPlannerSettings& settings,
                  std::shared_ptr<HumanCost> cost)
      : parts_(parts),
        period_(settings.live_period, settings.live_max_period, 0.0),
        cost_(std::move(cost)) {}

  /// Takes the advised period [s] and gain of the saved cost; both hold for a moment only.
  void advise(double period, double cost_gain, TimePoint now);
  /// Returns the period of checks in force [s].
  double period(TimePoint now) const { return period_.period(now); }
  /// Returns the counts since the start.
  const ReplanCounts& counts() const { return counts_; }

  /// Checks the running motion once and switches to another path or timing where that is better;
  /// `running` is what runs afterwards. A failure changes nothing. The references must outlive the
  /// routine.
  Routine<Outcome> check(RunningMotion& running, const MotionSpec& motion);

 private:
  Outcome find_switch_point(const RunningMotion& running, const MotionSpec& motion,
                            SwitchPoint& point) const;
  Routine<Outcome> plan(RunningMotion& running, const MotionSpec& motion, const SwitchPoint& point,
                        const Vector& start);
  Routine<Outcome> retime(RunningMotion& running, const MotionSpec& motion,
                          const SwitchPoint& point, const std::vector<Vector>& waypoints);
  Routine<Outcome> switch_to_candidate(RunningMotion& running, const MotionSpec& motion,
                                       const SwitchPoint& point,
                                       const std::shared_ptr<SwitchCandidate>& candidate,
                                       const RunningMotion& next);
  bool is_over(const RunningMotion& running) const;
  bool is_at_rest(const MotionSpec& motion) const;
  bool is_too_late(const MotionSpec& motion, const SwitchPoint& point) const;
  SwitchPlanner switch_planner(const MotionSpec& motion) const;
  PlanningSnapshot snapshot(const MotionSpec& motion, const SwitchPoint& point) const;

  Parts& parts_;
  AdvisedPeriod period_;
  double cost_gain_{1};
  std::shared_ptr<HumanCost> cost_;
  ReplanCounts counts_;
};

}  // namespace handsel::manipulation_planner
