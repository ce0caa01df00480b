// The path that runs (chapter section 4.1.1, path perturbation on a running path): made cheaper for
// the costs as they are now, repaired where something came into it, planned anew where that fails.
// Pure.
#pragma once

#include <vector>

#include "components/path_planner/path_planner.hpp"

namespace handsel::path_planner {

enum class ReplanOutcome {
  kept,       ///< free, and nothing cheaper was found
  improved,   ///< free, and cheaper than before
  repaired,   ///< was blocked; led around what blocks it
  replanned,  ///< another goal, or nothing of it could be saved
  blocked,    ///< no path was found: the arm must stop
};
/// Returns a word for reports: "kept", "improved", "repaired", "replanned" or "blocked".
const char* name(ReplanOutcome);

struct ReplanSettings {
  /// A start farther from the path than this is not on it (corners are cut, max norm) [rad].
  double reach{0.5};
  /// l_max: the path is cut into pieces of at most this before it is repaired [rad].
  double piece{0.15};
  double min_gain{0.02};  ///< a path cheaper by less than this fraction is not worth switching to
  double verify_step{0.002};  ///< states on what is returned are checked this close [rad]
  int rounds{60};             ///< shortcuts and perturbations tried each time
  int tries{60};              ///< perturbations tried to repair
};

struct ReplanResult {
  ReplanOutcome outcome{ReplanOutcome::kept};  ///< what was done with the running path
  /// front() of the path = start of the problem; unsolved when blocked, with the reason.
  Result result;
  double before{};  ///< price of the remainder as it was, for the costs now (infinite: blocked)
  double after{};   ///< price of the path returned
};

/// `running`: the path the arm runs along. `problem.start`: where it can be left at the earliest
/// (on it, t_now + t_replan ahead: what comes before stays as it is). `problem.goals`: as they are
/// wanted now. Deterministic for the problem's seed. When the start is not on the path, or nothing
/// of it can be saved, the problem is planned anew with what is left of the budget.
ReplanResult continue_path(const PlanningModels& models, const Problem& problem,
                           const std::vector<Vector>& running, const Settings& settings,
                           const ReplanSettings& live, const Hooks& hooks = {});

}  // namespace handsel::path_planner
