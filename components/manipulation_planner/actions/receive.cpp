// SPDX-License-Identifier: Apache-2.0
// The action receive: waits for an offer, clears the area for one, and takes the object.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/actions/actions.hpp"
#include "components/manipulation_planner/actions/arm_choice.hpp"
#include "components/manipulation_planner/actions/giver_hand.hpp"
#include "components/manipulation_planner/actions/grasping.hpp"
#include "components/manipulation_planner/actions/rest.hpp"
#include "components/manipulation_planner/actions/take.hpp"
#include "components/manipulation_planner/placing/destination_search.hpp"

namespace handsel::manipulation_planner {
namespace {

/// Uses the arm that is nearest to the giver: people hold back before that hand.
Routine<Outcome> use_nearest_arm(Parts& parts, const std::string& giver) {
  const Person* person = parts.now.person(giver);
  if (person == nullptr) co_return Outcome{};
  const Vector3& p_torso =
      person->joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  const std::vector<std::string> arms = arms_for(parts, p_torso, nullptr);
  if (arms.empty()) co_return Outcome{};
  Outcome used = co_await use_arm(parts, arms.front());
  co_return used;
}

/// Waits for an offer and clears the offer area if none is made; nullopt: none until `deadline`.
Routine<std::optional<Offer>> await_offer(Parts& parts, const std::string& giver,
                                          TimePoint deadline) {
  const Outcome nearest = co_await use_nearest_arm(parts, giver);
  if (!nearest.good) parts.refuse("choosing the arm", nearest.reason);
  parts.offers.await();
  parts.action.exchange_engaged = false;
  TimePoint waits_since = parts.now.time();
  bool can_clear = true;
  while (parts.now.time() < deadline) {
    parts.action.phase = ActionPhase::watching_for_offer;
    const std::optional<Offer> offer = parts.offers.made();
    if (offer) co_return offer;
    const double waited = to_seconds(parts.now.time() - waits_since);
    if (can_clear && !parts.offers.is_seen() && waited > parts.settings.offer_clear_after &&
        parts.area.is_occupied(giver)) {
      Outcome cleared = co_await clear_offer_area_of_all(parts, giver, ClearUntil::any_offer);
      if (!cleared.good) parts.refuse("clearing the offer area", cleared.reason);
      can_clear = !parts.area.is_occupied(giver);
      waits_since = parts.now.time();
      continue;
    }
    co_await parts.waiting.pause(parts.settings.offer_check_period);
  }
  co_return std::nullopt;
}

/// Asks for grasps that keep clearance to the giver's hand.
Routine<GraspList> ask_clear_grasps(Parts& parts, const Offer& offer) {
  parts.destinations.clear();
  GraspList list = co_await ask_grasps(parts, offer.object, "", parts.settings.max_grasps_onto);
  if (!list.grasps.empty()) list.outcome = co_await select_clear_of_hand(parts, offer, list.grasps);
  co_return list;
}

/// Returns by how much the arm would come nearer to the giver's body than giver_clearance, at the
/// grasp or where the straight motion in begins [m].
double lacking_clearance(const Parts& parts, const Offer& offer, const Grasp& grasp) {
  double lack = 0;
  for (const Vector& joints : {grasp.approach_joints, grasp.arm_joints}) {
    const Vector q = RobotModel::with(parts.arm.configuration(), parts.arm.group(), joints);
    const double distance =
        parts.retreat.separation(q, parts.now.T_world_base(), parts.now.people(), offer.giver);
    lack = std::max(lack, parts.settings.giver_clearance - distance);
  }
  return lack;
}

/// Grasps of what is offered, by one arm.
struct OfferGrasps {
  GraspList list;
  /// Of these, the ones that do not slip and by which the same hand can put the object down, if it
  /// can by any.
  std::vector<Grasp> sure;
  bool serves{};  ///< the object can be put down by some of them, or perhaps by the other hand
  Destinations destinations;  ///< where it can be put down
};

/// Sorts grasps: those that hold first, of these the arm's shortest motion first, since a giver
/// does not wait long, unless the grasp is weak, the hand may touch the giver's digits, the arm
/// would come near to the giver's body, or the object cannot be put down by that grasp. Leaves the
/// best.
Routine<OfferGrasps> rank_grasps(Parts& parts, const Offer& offer, const std::string& onto,
                                 GraspList list) {
  std::vector<Grasp>& grasps = list.grasps;
  const DestinationLimits limits{grasps.size(), parts.settings.receive_places};
  const ServingGrasps later = co_await find_destinations(parts, offer.object, onto, grasps, limits);
  for (const auto& [grasp, destination] : later.at) parts.destinations.add(destination);
  if (later.at.empty() && !later.objections.empty())
    parts.refuse("place", "no grasp of " + offer.object +
                              " as it is held serves for putting it down: " + later.objections);
  const std::optional<GraspIds> clear = co_await clear_of_turned_hand(parts, offer, grasps);
  const auto is_clear = [&clear](const Grasp& g) { return !clear || clear->count(g.id) > 0; };
  std::vector<std::pair<std::pair<bool, double>, Grasp>> ranked;
  for (Grasp& g : grasps) {
    const double penalty = parts.settings.weak_grip_detour * std::max(0.0, -g.margin) +
                           parts.settings.giver_detour * lacking_clearance(parts, offer, g) +
                           (is_clear(g) ? 0.0 : parts.settings.digits_detour) +
                           (parts.destinations.has(g.id) ? 0.0 : parts.settings.place_detour);
    const double distance = (g.approach_joints - parts.arm.joints()).cwiseAbs().maxCoeff();
    const bool may_slip = g.margin < parts.settings.min_sure_margin;
    ranked.emplace_back(std::pair(may_slip, std::floor((distance + penalty) /
                                                       parts.settings.receive_same_distance)),
                        std::move(g));
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  grasps.clear();
  for (auto& [rank, grasp] : ranked) grasps.push_back(std::move(grasp));
  OfferGrasps found;
  const bool has_surface = !later.at.empty() || !later.objections.empty();
  found.serves = !later.outcome.good || !later.at.empty() || !has_surface;
  std::copy_if(grasps.begin(), grasps.end(), std::back_inserter(found.sure), [&](const Grasp& g) {
    return g.margin >= parts.settings.min_sure_margin &&
           (later.at.empty() || parts.destinations.has(g.id));
  });
  for (std::vector<Grasp>* some : {&grasps, &found.sure})
    some->resize(std::min<std::size_t>(some->size(), parts.settings.max_grasps));
  found.list = std::move(list);
  found.destinations = parts.destinations;
  co_return found;
}

/// A grasp by one of the arms: the place of the arm among its manipulators and the id of the grasp.
using GraspOfArm = std::pair<std::size_t, std::uint64_t>;

/// Returns whether all grasps of the arm in use have failed.
bool have_failed(const Parts& parts, const std::vector<Grasp>& grasps,
                 const std::set<GraspOfArm>& failed) {
  return std::all_of(grasps.begin(), grasps.end(), [&](const Grasp& g) {
    return failed.count({parts.arm.index(), g.id}) > 0;
  });
}

/// Tries grasps until one takes the object or the offer ends. `failed`: grasps that did not.
Routine<Outcome> try_grasps(Parts& parts, const TakeAttempt& first,
                            const std::vector<Grasp>& grasps, std::set<GraspOfArm>& failed,
                            Outcome last) {
  TakeAttempt attempt = first;
  const std::size_t arm = parts.arm.index();
  if (have_failed(parts, grasps, failed)) failed.clear();
  for (const Grasp& grasp : grasps) {
    if (failed.count({arm, grasp.id}) > 0) continue;
    attempt.chosen = grasp;
    last = co_await take(parts, attempt);
    if (last.good) co_return last;
    parts.refuse("grasp " + std::to_string(grasp.id), last.reason);
    if (!last.target_moved()) failed.insert({arm, grasp.id});
    if (last.target_moved() || last.end == MotionEnd::late) break;
    const Vector3 p_hand = parts.arm.T_world_tool().translation();
    if (!parts.offers.find(attempt.offer.object, attempt.offer.giver, p_hand)) break;
  }
  co_return last;
}

/// Returns whether an arm other than the one in use reaches a free place for an object on a
/// surface.
Routine<bool> another_arm_places(Parts& parts, const std::string& object, const SceneBox& surface) {
  const SceneObject* thing = parts.now.object(object);
  if (thing == nullptr) co_return false;
  const Pose T_world_object = thing->T_world_object;
  for (const Manipulator& other : parts.arm.manipulators()) {
    if (other.arm == nullptr || other.name == parts.arm.group().name) continue;
    const std::vector<Pose> places =
        co_await find_standing_places(parts, surface, other.name, object, T_world_object);
    if (!places.empty()) co_return true;
  }
  co_return false;
}

/// How well the grasps of an arm suit.
enum class Suitability : std::uint8_t { none, reach, serve, sure };

Suitability suitability(const OfferGrasps& found) {
  if (!found.list.outcome.good || found.list.grasps.empty()) return Suitability::none;
  if (!found.serves) return Suitability::reach;
  return found.sure.empty() ? Suitability::serve : Suitability::sure;
}

/// Asks for grasps by one arm after the other, those first that reach the surface too, until some
/// are sure; uses the arm whose grasps suit best: the hand of one that cannot put the object down
/// can pass the object on.
Routine<OfferGrasps> choose_arm_and_grasps(Parts& parts, const Offer& offer,
                                           const std::string& onto, const Vector3& p_object) {
  OfferGrasps best;
  std::string best_arm;
  const SceneBox* seen = parts.now.surface(onto);
  const std::optional<SceneBox> surface =
      seen != nullptr ? std::optional<SceneBox>(*seen) : std::nullopt;
  std::vector<std::string> arms = arms_for(parts, p_object, surface ? &*surface : nullptr);
  const std::vector<std::string> near = arms_for(parts, p_object, nullptr);
  std::copy_if(near.begin(), near.end(), std::back_inserter(arms), [&arms](const std::string& arm) {
    return std::find(arms.begin(), arms.end(), arm) == arms.end();
  });
  for (const std::string& arm : arms) {
    Outcome used = co_await use_arm(parts, arm);
    OfferGrasps found;
    if (used.good)
      found.list = co_await ask_clear_grasps(parts, offer);
    else
      found.list.outcome = used;
    const bool has_grasps = suitability(found) != Suitability::none;
    if (has_grasps) found = co_await rank_grasps(parts, offer, onto, std::move(found.list));
    if (suitability(found) == Suitability::sure) co_return found;
    if (best_arm.empty() || suitability(found) > suitability(best)) {
      best = std::move(found);
      best_arm = arm;
    }
  }
  if (best_arm != arms.back()) co_await use_arm(parts, best_arm);
  parts.destinations = best.destinations;
  if (surface && suitability(best) == Suitability::reach)
    best.serves = co_await another_arm_places(parts, offer.object, *surface);
  co_return best;
}

/// Waits for another offer after no grasp of this one is reachable: the giver often offers
/// elsewhere, nearer, or farther out where there is space. `p_uncleared`: position of an object
/// from which the arm cannot come farther; nullopt: none.
Routine<Outcome> await_other_offer(Parts& parts, const Offer& offer, const Vector3& p_asked,
                                   const Outcome& why, Outcome last,
                                   std::optional<Vector3>& p_uncleared) {
  const auto has_moved = [&] {
    const SceneObject* held = parts.now.object(offer.object);
    return held == nullptr ||
           (held->T_world_object.translation() - p_asked).norm() > parts.settings.offer_moved;
  };
  if (has_moved()) co_return last;
  if (why.reason != last.reason) parts.refuse("offer", why.reason);
  const bool can_clear =
      !p_uncleared || (p_asked - *p_uncleared).norm() > parts.settings.offer_moved;
  if (can_clear && parts.area.is_occupied(offer.giver)) {
    co_await clear_offer_area(parts, offer.giver, ClearUntil::clear_offer);
    p_uncleared.reset();
    if (parts.area.is_occupied(offer.giver)) p_uncleared = p_asked;
  }
  co_await parts.waiting.until(has_moved, parts.settings.offer_retry);
  co_return why;
}

Outcome none_is_sure(const Offer& offer, const OfferGrasps& found) {
  return Outcome::failure("no grasp of " + offer.object + " as " + offer.giver + " holds it " +
                          (found.serves ? "is sure to hold and serves for putting it down"
                                        : "serves for putting it down"));
}

Outcome nothing_offered(const std::string& wanted, const std::string& giver, double timeout) {
  return Outcome::failure((giver.empty() ? "nobody offers " : giver + " does not offer ") +
                          (wanted.empty() ? "anything" : wanted) + " within " +
                          std::to_string(static_cast<int>(timeout)) + " s");
}

}  // namespace

Routine<Outcome> receive(Parts& parts, const std::string& wanted, const std::string& giver,
                         const std::string& onto) {
  if (parts.held.is_holding() && (wanted.empty() || parts.held.id() == wanted)) co_return Outcome{};
  const double timeout = parts.settings.receive_timeout;
  Outcome last = nothing_offered(wanted, giver, timeout);
  std::set<GraspOfArm> failed;
  TimePoint deadline = parts.now.time() + from_seconds(timeout);
  std::optional<TimePoint> patient_until;
  std::optional<Vector3> p_uncleared;
  for (std::uint32_t attempt = 0; attempt < parts.settings.receive_attempts;) {
    std::optional<Offer> offer = co_await await_offer(parts, giver, deadline);
    if (!offer) break;
    if (!patient_until) {
      patient_until = parts.now.time() + from_seconds(parts.settings.place_patience);
      deadline = *patient_until + from_seconds(timeout);
    }
    parts.offers.accept(*offer);
    parts.offers.set_hand_at_offer(false);
    parts.action.object = offer->object;
    parts.action.human = offer->giver;
    const Vector3 p_asked = parts.now.object(offer->object)->T_world_object.translation();
    parts.action.exchange_point = p_asked;
    const OfferGrasps found = co_await choose_arm_and_grasps(parts, *offer, onto, p_asked);
    if (!found.list.outcome.good || found.list.grasps.empty()) {
      last =
          co_await await_other_offer(parts, *offer, p_asked, found.list.outcome, last, p_uncleared);
      continue;
    }
    const bool all_sure_failed = !found.sure.empty() && have_failed(parts, found.sure, failed);
    const bool is_patient = parts.now.time() < *patient_until && !all_sure_failed;
    if (is_patient && (!found.serves || found.sure.empty())) {
      last = co_await await_other_offer(parts, *offer, p_asked, none_is_sure(*offer, found), last,
                                        p_uncleared);
      continue;
    }
    ++attempt;
    const TakeAttempt first{*offer, {}, attempt};
    const std::vector<Grasp>& grasps = is_patient ? found.sure : found.list.grasps;
    last = co_await try_grasps(parts, first, grasps, failed, last);
    if (last.good) co_return last;
    // Who has withdrawn it offers again where the hand leaves space; and from farther back other
    // paths lead to what is still offered.
    const bool again = attempt < parts.settings.receive_attempts &&
                       (parts.offers.is_still_offered() ? !last.target_moved()
                                                        : parts.area.is_occupied(offer->giver));
    if (again) co_await clear_offer_area(parts, offer->giver, ClearUntil::clear_offer);
    deadline = parts.now.time() + from_seconds(timeout);
  }
  co_return last;
}

}  // namespace handsel::manipulation_planner
