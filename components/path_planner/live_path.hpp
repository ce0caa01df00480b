// SPDX-License-Identifier: Apache-2.0
// Online replanning (chapter section 4.1.1, path perturbation on a running path): reduces the
// present cost of the running path, repairs blocked parts, and plans a new path if the repair
// fails. Pure.
#pragma once

#include <vector>

#include "components/path_planner/path_planner.hpp"

namespace handsel::path_planner {

enum class ReplanOutcome {
  kept,       ///< free, and no cheaper path was found
  improved,   ///< free, and cheaper than before
  repaired,   ///< was blocked, leads around the obstacle now
  replanned,  ///< new goal, or no part of the path could be used
  blocked,    ///< no path was found: the arm must stop
};
/// Returns a word for reports: "kept", "improved", "repaired", "replanned" or "blocked".
const char* name(ReplanOutcome);

struct ReplanSettings {
  /// Max distance of the start from the path, which blends do not follow exactly (max norm) [rad].
  double reach{0.5};
  /// l_max: max length of the segments into which the path is divided before the repair [rad].
  double piece{0.15};
  double min_gain{0.02};      ///< min relative reduction of the price for a switch
  double verify_step{0.002};  ///< step of the check of the returned path [rad]
  int rounds{60};             ///< max number of shortcuts and perturbations
  int tries{60};              ///< max number of perturbations for the repair
  /// Max distance from an end at which motions are checked exactly if the batch check is unclear
  /// [rad].
  double near_ends{0.3};
  double max_drop_loss{0.01};  ///< max relative increase of the price by removed waypoints
  double max_drop_gain{0.3};   ///< or max fraction of the preceding reduction of the price
};

struct ReplanResult {
  ReplanOutcome outcome{ReplanOutcome::kept};  ///< result for the running path
  /// Path with front() = start of the problem; unsolved if blocked, with the reason.
  Result result;
  double before{};  ///< price of the remaining path at present costs (infinite: blocked)
  double after{};   ///< price of the returned path
};

/// Replans the running path. `running`: the path that the arm runs along. `problem.start`: first
/// switch point, on the path t_now + t_replan ahead; the path before it does not change.
/// `problem.goals`: present goals. Deterministic for the problem's seed. If the start is not on the
/// path, or no part of the path can be used, plans a new path with the remaining budget.
ReplanResult continue_path(const PlanningModels& models, const Problem& problem,
                           const std::vector<Vector>& running, const Settings& settings,
                           const ReplanSettings& live, const Hooks& hooks = {});

}  // namespace handsel::path_planner
