// SPDX-License-Identifier: Apache-2.0
// The action pick.
#include "components/manipulation_planner/actions/pick.hpp"

#include <algorithm>
#include <functional>
#include <memory>

#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/object_sight.hpp"
#include "components/manipulation_planner/actions/place.hpp"
#include "components/manipulation_planner/handover/otp_search.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kFullStrain = 1;  // of a wrist at an end of its ranges

/// A grasp with which the object can be given to the person.
struct Givable {
  std::size_t grasp;  // place in the list
  double cost;
};
struct GivableGrasps {
  std::vector<Givable> givable;
  Refusals refused;
};

/// Returns a job that searches one object transfer point for each grasp.
std::function<void()> givable_job(Parts& parts, std::shared_ptr<GivableGrasps> result,
                                  const std::vector<Grasp>& grasps, const Person& person,
                                  const Pose& T_world_object) {
  auto settings = parts.settings;
  settings.exchange_goals = 1;
  std::vector<Vector3> backs;
  backs.reserve(grasps.size());
  for (const Grasp& grasp : grasps) backs.push_back(parts.arm.direction_back(grasp));
  return [result = std::move(result), grasps, settings, person, T_world_object,
          robot = parts.arm.shared_robot(), arm = parts.arm.group(), scene = parts.now.scene(),
          layers = parts.now.layers(), q = parts.now.set_point(),
          hands = hands_of(person, parts.now.scene(), T_world_platform(parts.now).translation(),
                           parts.settings),
          backs = std::move(backs), p_robot = Vector3(T_world_platform(parts.now).translation())] {
    const bool has_pairs = std::any_of(grasps.begin(), grasps.end(),
                                       [](const Grasp& grasp) { return !grasp.partners.empty(); });
    for (std::size_t i = 0; i < grasps.size(); ++i) {
      // Beside this one no hand of the person finds room, beside another one does.
      const double strain = has_pairs && grasps[i].partners.empty() ? kFullStrain : 0.0;
      const Pose T_tool_object = grasps[i].T_object_hand.inverse();
      const std::vector<Vector3> barred = barred_directions(grasps[i]);
      const OtpQuery query{
          scene, person,   layers, T_world_object, T_tool_object, barred, grasps[i].partners,
          hands, backs[i], p_robot};
      const OtpSearch search = find_otp(*robot, arm, query, q, settings);
      if (search.poses.empty())
        result->refused.push_back({"grasp " + std::to_string(grasps[i].id), search.reason});
      else
        result->givable.push_back({i, search.poses.front().cost + settings.w_wrist * strain +
                                          settings.w_grasp_rank * static_cast<double>(i)});
    }
  };
}

/// Leaves the grasps by which the object can be given to the person, the best first; waits for a
/// person out of reach until `deadline`.
Routine<Outcome> select_givable(Parts& parts, std::vector<Grasp>& grasps, const std::string& object,
                                const std::string& human, TimePoint deadline) {
  auto result = std::make_shared<GivableGrasps>();
  while (parts.now.person(human) != nullptr && parts.now.object(object) != nullptr) {
    parts.action.phase = ActionPhase::looking_ahead;
    *result = {};
    const std::function<void()> job = givable_job(parts, result, grasps, *parts.now.person(human),
                                                  parts.now.object(object)->T_world_object);
    Outcome worked = co_await parts.worker.run(job);
    if (!worked.good) co_return worked;
    if (!result->givable.empty() || parts.now.time() >= deadline) break;
    if (drives(parts.arm.robot())) co_return Outcome{};  // it is given elsewhere
    parts.action.phase = ActionPhase::waiting_for_person;
    co_await parts.waiting.pause(parts.settings.reach_pause);
  }
  for (const auto& refusal : result->refused) parts.refuse(refusal.what, refusal.reason);
  if (result->givable.empty()) {
    const bool is_unseen = result->refused.empty();
    const std::string why =
        is_unseen ? ", who is out of sight" : ": " + result->refused.front().reason;
    co_return Outcome::failure("no grasp of " + object + " can be handed to " + human + why,
                               is_unseen ? ActionFailure::not_visible : ActionFailure::other);
  }
  std::stable_sort(result->givable.begin(), result->givable.end(),
                   [](const Givable& a, const Givable& b) { return a.cost < b.cost; });
  std::vector<Grasp> givable;
  for (const Givable& one : result->givable) givable.push_back(grasps[one.grasp]);
  grasps = std::move(givable);
  co_return Outcome{};
}

/// Tries grasps until one holds the object, or the object may have moved.
Routine<Outcome> try_grasps(Parts& parts, const std::string& object, const std::string& for_human,
                            const std::vector<Grasp>& grasps, Outcome last) {
  std::uint32_t executed = 0;
  for (const Grasp& grasp : grasps) {
    last = co_await try_grasp(parts, object, for_human, grasp);
    if (last.good) co_return last;
    parts.refuse("grasp " + std::to_string(grasp.id), last.reason);
    if (parts.held.is_holding() || last.target_moved()) co_return last;
    if (parts.action.phase != ActionPhase::planning &&
        ++executed >= parts.settings.max_executed_grasps)
      break;
  }
  co_return last;
}

}  // namespace

Routine<Outcome> pick_by_arm(Parts& parts, const std::string& object, const std::string& for_human,
                             const std::string& onto) {
  Outcome last;
  const TimePoint deadline = parts.now.time() + from_seconds(parts.settings.reach_timeout);
  const TimePoint search_end = parts.now.time() + from_seconds(parts.settings.search_timeout);
  for (std::uint32_t round = 1; round <= parts.settings.grasp_rounds; ++round) {
    last = co_await await_object(parts, object, search_end);
    if (!last.good) co_return last;
    GraspList list;
    if (onto.empty())
      list = co_await ask_grasps(parts, object, for_human, parts.settings.max_grasps);
    else
      list = co_await ask_grasps_onto(parts, object, onto);
    if (!list.outcome.good) {
      last = list.outcome;
      continue;
    }
    if (parts.now.person(for_human) != nullptr && !for_human.empty()) {
      last = co_await select_givable(parts, list.grasps, object, for_human, deadline);
      if (!last.good) continue;
    }
    last = co_await try_grasps(parts, object, for_human, list.grasps, last);
    if (last.good || parts.held.is_holding()) co_return last;
    if (last.target_moved() && parts.now.time() < search_end) --round;
  }
  co_return last;
}

Routine<Outcome> pick(Parts& parts, const std::string& object, const std::string& for_human,
                      const std::string& onto) {
  if (parts.held.is_holding() && parts.held.id() == object) co_return Outcome{};
  parts.action.phase = ActionPhase::looking_for_object;
  const auto is_seen = [&] { return parts.now.object(object) != nullptr; };
  const bool seen = co_await parts.waiting.until(is_seen, parts.settings.sight_timeout);
  if (!seen) co_return Outcome::failure("object " + object + " is not in the scene");
  const Vector3 p_object = parts.now.object(object)->T_world_object.translation();
  const std::vector<std::string> arms = arms_for(parts, p_object, parts.now.surface(onto));
  Outcome last;
  for (const std::string& arm : arms) {
    last = co_await use_arm(parts, arm);
    if (last.good) last = co_await pick_by_arm(parts, object, for_human, onto);
    if (last.good || parts.held.is_holding()) co_return last;
    if (arms.size() > 1) parts.refuse(arm, last.reason);
  }
  co_return last;
}

}  // namespace handsel::manipulation_planner
