// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/choice/grasp_choice.hpp"

#include <algorithm>

#include "common/collision/platform_places.hpp"
#include "common/model/platform.hpp"
#include "components/grasp_planner/choice/grasp_search.hpp"
#include "components/grasp_planner/pair/retreat.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr std::size_t kReasonsGiven = 3;  // max reasons reported when no grasp is feasible

/// Returns an arm of the robot with its hand; ConfigError where one of the two is missing.
Manipulator hand_of(const RobotModel& robot, const std::string& arm) {
  robot.require_group(arm);
  for (Manipulator& hand : hands_of(robot)) {
    if (hand.name != arm || hand.arm == nullptr) continue;
    if (hand.fingers == nullptr) break;
    if (hand.palm < 0 || hand.arm->tip != hand.palm)
      throw ConfigError("robot " + robot.name() + ": the tip_link of group \"" + arm +
                        "\" must be the palm of its hand");
    return hand;
  }
  throw ConfigError("robot " + robot.name() + ": group \"" + arm + "\" carries no hand");
}

/// Returns whether two grasps are of one variant.
bool alike(const Pose& a, const Pose& b, const settings::GraspPlannerSettings& settings) {
  return (a.translation() - b.translation()).norm() < settings.same_distance &&
         Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle() <
             settings.same_angle;
}

}  // namespace

const char* reason_text(ChoiceReason reason) {
  switch (reason) {
    case ChoiceReason::chosen:
      return "chosen";
    case ChoiceReason::too_weak:
      return "the fingers would not bear the object";
    case ChoiceReason::below_support:
      return "the hand would be in or under what the object stands on";
    case ChoiceReason::out_of_reach:
      return "no configuration of the arm reaches it";
    case ChoiceReason::collision:
      return "arm or hand would collide at the grasp";
    case ChoiceReason::cannot_lift:
      return "the arm could not lift the object straight up";
    case ChoiceReason::no_approach:
      return "no straight approach is free";
    case ChoiceReason::near_giver:
      return "the arm would come too near to the body of the person who holds it";
    case ChoiceReason::goal_support:
      return "the hand would be in or under what the object is to be put on";
    case ChoiceReason::goal_taken:
      return "the object would touch something where it is to be put";
    case ChoiceReason::goal_out_of_reach:
      return "no configuration of the arm reaches the place where the object is to be put";
    case ChoiceReason::goal_collision:
      return "arm or hand would collide where the object is to be put";
    case ChoiceReason::goal_lowering:
      return "the arm could not lower the object straight to where it is to be put";
    case ChoiceReason::goal_leaving:
      return "no straight path off the object is free where it is to be put";
    case ChoiceReason::hidden:
      return "too little of the object would be seen past the hand";
    case ChoiceReason::not_considered:
      return "not considered: enough better ones were found, or the budget was used up";
    case ChoiceReason::count:
      break;
  }
  return "unknown";
}

std::string NamedContacts::commonest() const {
  const auto most =
      std::max_element(counts_.begin(), counts_.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts_.end() ? "" : most->first;
}

Refusals Choice::refusals() const {
  Refusals out;
  for (std::size_t r = 1; r < reasons.size(); ++r) {
    if (reasons[r] > 0)
      out.push_back(
          {std::to_string(reasons[r]) + " grasps", reason_text(static_cast<ChoiceReason>(r))});
  }
  const auto places = [&](std::uint64_t count, const char* why) {
    if (count > 0) out.push_back({std::to_string(count) + " places of the platform", why});
  };
  places(platform.blocked, "the robot would collide there");
  places(platform.near_person, "too near to a person");
  places(platform.useless, "no grasp serves from there");
  if (platform.none)
    out.push_back({"places of the platform", "the robot's description tells of no platform"});
  return out;
}

std::string Choice::why_none(const GraspList& list) const {
  if (list.grasps.empty()) {
    const auto most = std::max_element(list.reasons.begin() + 1, list.reasons.end());
    return "no stable grasp of hand " + list.hand + " on object " + list.object + " in " +
           std::to_string(list.frames) + " frames; mostly " +
           reason_text(static_cast<FrameReason>(most - list.reasons.begin()));
  }
  std::vector<std::pair<std::uint64_t, ChoiceReason>> often;
  for (std::size_t r = 1; r < reasons.size(); ++r) {
    const auto reason = static_cast<ChoiceReason>(r);
    if (reasons[r] > 0 && reason != ChoiceReason::not_considered)
      often.emplace_back(reasons[r], reason);
  }
  std::stable_sort(often.begin(), often.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  // A grasp that failed only the last check was nearest to feasible.
  const auto last = std::max_element(
      often.begin(), often.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (std::distance(often.begin(), last) >= static_cast<std::ptrdiff_t>(kReasonsGiven))
    std::iter_swap(last, often.begin() + kReasonsGiven - 1);
  std::string why = "none of " + std::to_string(list.grasps.size()) + " stable grasps serves here";
  const std::string contact = contacts.commonest();
  for (std::size_t i = 0; i < std::min(often.size(), kReasonsGiven); ++i) {
    const bool is_named = often[i].second == ChoiceReason::collision && !contact.empty();
    why += (i == 0 ? ": for " : ", for ") + std::to_string(often[i].first) + " " +
           reason_text(often[i].second) + (is_named ? " (most often " + contact + ")" : "");
  }
  if (often.size() > kReasonsGiven) why += ", ...";
  if (const auto untried = reasons[static_cast<std::size_t>(ChoiceReason::not_considered)])
    why += "; " + std::to_string(untried) + " were not tried, the budget was used up";
  if (platform.none)
    why += "; the robot's description tells of no platform that could drive elsewhere";
  if (platform.places > 0)
    why +=
        "; nor does one from " + std::to_string(platform.places) + " other places of the platform";
  return why;
}

GraspChooser::GraspChooser(std::shared_ptr<const RobotModel> robot,
                           std::shared_ptr<const HandGeometry> hand_geometry, ObjectLibrary library,
                           const settings::GraspPlannerSettings& settings, const std::string& arm,
                           std::shared_ptr<const RobotModel> mobile)
    : robot_(std::move(robot)),
      mobile_(std::move(mobile)),
      hand_geometry_(std::move(hand_geometry)),
      library_(std::move(library)),
      settings_(settings) {
  manipulator_ = hand_of(*robot_, arm);
  const std::vector<int>& fingers = manipulator_.fingers->axes;
  const std::vector<Axis>& axes = hand_geometry_->hand.model().axes();
  bool same = axes.size() == fingers.size();
  for (std::size_t i = 0; same && i < axes.size(); ++i)
    same = robot_->axes()[static_cast<std::size_t>(fingers[i])].name == axes[i].name;
  if (!same) {
    throw ConfigError("robot " + robot_->name() + ": its group \"" + manipulator_.fingers->name +
                      "\" must list the joints of hand " + hand_geometry_->hand.name() +
                      " in the order of its fingers");
  }
  retreats_ = retreat_directions(hand_geometry_->hand);
}

std::vector<GraspChooser::Found> GraspChooser::consider_all(Search& search, const Ranking& order,
                                                            const Ranking& weak) const {
  const ChoiceInputs& inputs = search.inputs;
  const GraspRequest& request = inputs.request;
  const GraspList& list = inputs.list;
  const TransferTable* pairs = inputs.pairs;
  std::vector<Found> found;
  // Twice the requested number, so that the arm configuration affects the ranking.
  const std::size_t enough = 2 * static_cast<std::size_t>(std::max(1U, request.max_grasps));
  const std::uint64_t budget =
      search.out.reaches +
      (request.has_goal ? 2 : 1) * static_cast<std::uint64_t>(settings_.reach_budget);
  const auto consider = [&](double rank, std::size_t index, std::optional<TransferPose> transfer) {
    const bool stop = found.size() >= enough || search.out.reaches >= budget ||
                      (inputs.cancelled && inputs.cancelled());
    Found one{rank, {}, std::move(transfer), {}};
    const ChoiceReason reason =
        stop ? ChoiceReason::not_considered : search.consider(list.grasps[index].grasp, one);
    ++search.out.reasons[static_cast<std::size_t>(reason)];
    if (reason == ChoiceReason::chosen) found.push_back(std::move(one));
  };
  // For a person, grasps with a handover place come first, upright before tilted; the others
  // follow when too few of those can be picked up.
  Ranking others = order;
  const auto levels = search.places ? tilt_levels(pairs->settings()) : std::vector<double>{};
  for (const double tilt : levels) {
    search.transfer_budget = search.out.transfer_reaches + settings_.transfer_budget;
    std::size_t tries = 0;
    Ranking left;
    for (const auto& [rank, index] : others) {
      const Grasp& g = list.grasps[index].grasp;
      std::optional<TransferPose> transfer;
      const bool try_it = found.size() < enough && tries < settings_.transfer_tries * enough &&
                          !pairs->partners(index).empty();
      if (try_it && !search.below_support(g)) {
        ++tries;
        transfer = search.transfer(index, g, tilt);
      }
      if (transfer) {
        consider(rank, index, std::move(transfer));
      } else {
        left.emplace_back(rank, index);
      }
    }
    others = std::move(left);
  }
  for (const auto& [rank, index] : others) consider(rank, index, {});
  // Adds weaker grasps when fewer than min_grasps_held are feasible.
  for (const auto& [rank, index] : weak) {
    if (found.size() < settings_.min_grasps_held)
      consider(rank, index, {});
    else
      ++search.out.reasons[static_cast<std::size_t>(ChoiceReason::too_weak)];
  }
  return found;
}

Choice GraspChooser::choose(const ChoiceInputs& inputs) const {
  const GraspRequest& request = inputs.request;
  Search search(*this, inputs);
  const auto [order, weak] = search.ranked();
  const auto reasons = search.out.reasons;
  std::vector<Found> found = consider_all(search, order, weak);
  // Nearer to the digits of the giver only where no grasp keeps the full distance.
  if (found.empty() && search.holder_body && search.holder_body->has_digits() &&
      settings_.min_off_digits < settings_.off_digits) {
    search.holder_body->set_digit_clearance(settings_.min_off_digits);
    search.out.reasons = reasons;
    found = consider_all(search, order, weak);
  }
  const NamedContacts contacts_here = search.out.contacts;
  if (found.empty() && request.move_platform) search_places(search, order, found);
  search.out.contacts = contacts_here;
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.rank > b.rank; });
  // One grasp of each variant first, so that a retry uses a different variant.
  const auto known = [&](const Found& f, const std::vector<Found>& among) {
    return std::any_of(among.begin(), among.end(), [&](const Found& g) {
      return alike(g.grasp.T_object_hand, f.grasp.T_object_hand, settings_);
    });
  };
  std::vector<Found> ordered, again;
  for (Found& f : found) (known(f, ordered) ? again : ordered).push_back(std::move(f));
  std::move(again.begin(), again.end(), std::back_inserter(ordered));
  if (ordered.size() > request.max_grasps) ordered.resize(request.max_grasps);
  for (Found& f : ordered) {
    search.out.grasps.push_back(std::move(f.grasp));
    if (request.has_goal) search.out.goals.push_back(std::move(f.goal));
    if (search.places) search.out.transfers.push_back(std::move(f.transfer));
  }
  return search.out;
}

void GraspChooser::search_places(Search& search, const Ranking& order,
                                 std::vector<Found>& found) const {
  const GraspRequest& request = search.inputs.request;
  const GraspList& list = search.inputs.list;
  const std::function<bool()>& cancelled = search.inputs.cancelled;
  PlatformSearch& counts = search.out.platform;
  counts.asked = true;
  counts.none = mobile_ == nullptr;
  if (counts.none) return;
  Ranking tried;
  for (const auto& [rank, index] : order) {
    const Grasp& g = list.grasps[index].grasp;
    if (tried.size() >= settings_.platform_grasps) break;
    const bool again = std::any_of(tried.begin(), tried.end(), [&](const auto& t) {
      return alike(list.grasps[t.second].grasp.T_object_hand, g.T_object_hand, settings_);
    });
    if (!again && !search.below_support(g)) tried.emplace_back(rank, index);
  }
  // The platform moves the root of the model, so the arm is planned for each platform pose at
  // rest.
  const Pose T_world_root = search.scene.T_world_base;
  const Pose T_world_now = T_world_platform(*robot_, request.start, T_world_root);
  const Pose T_platform_root = T_world_now.inverse() * T_world_root;
  PlatformFloor floor(*mobile_, library_, search.scene, search.inputs.people,
                      {settings_.platform_room, settings_.furniture_room});
  const std::uint64_t budget = search.out.reaches + settings_.platform_reaches;
  const std::size_t enough = std::max(1U, request.max_grasps);
  std::size_t served = 0;
  for (const PlatformPlace& place :
       places_around(*robot_, *manipulator_.arm, request.start, T_world_now,
                     search.start.T_world_object.translation())) {
    if (served >= settings_.platform_places || found.size() >= enough ||
        search.out.reaches >= budget || (cancelled && cancelled()))
      break;
    ++counts.places;
    const Pose T_world_there = standing_at(place, T_world_now);
    const PlatformFloor::Verdict verdict = floor.check(request.start, T_world_there);
    if (verdict != PlatformFloor::Verdict::free) {
      ++(verdict == PlatformFloor::Verdict::blocked ? counts.blocked : counts.near_person);
      continue;
    }
    search.stand(T_world_there * T_platform_root);
    const std::size_t before = found.size();
    for (const auto& [rank, index] : tried) {
      if (found.size() >= enough || search.out.reaches >= budget) break;
      Found one{rank - settings_.rank_drive * place.distance, {}, {}, {}};
      if (search.consider(list.grasps[index].grasp, one) != ChoiceReason::chosen) continue;
      one.grasp.has_platform = true;
      one.grasp.platform = place.pose;
      found.push_back(std::move(one));
    }
    ++(found.size() > before ? served : counts.useless);
  }
  search.stand(T_world_root);
}

}  // namespace handsel::grasp_planner
