// Taking an object from a person's hand: wait for an offer, come to it clear of the fingers, close, feel that they have let go, draw back.
#include <algorithm>
#include <set>

#include "common/model/human_body.hpp"
#include "components/manipulation_planner/manipulation_planner.hpp"

namespace handsel::manipulation_planner {

namespace {
constexpr double kSteady = 0.25;     // [s] an offer must last before the hand goes for it
constexpr double kLookAgain = 0.02;  // [s]
}  // namespace

std::optional<ManipulationPlanner::Offer> ManipulationPlanner::offered(const std::string& wanted, const std::string& giver) const {
  for (const Fact& fact : facts_.facts) {
    if (fact.kind != FactKind::offering || (!giver.empty() && fact.subject != giver) || (!wanted.empty() && fact.object != wanted))
      continue;
    const SceneObject* held = object(fact.object);
    const Person* who = person(fact.subject);
    if (held == nullptr || who == nullptr || held->holder != Holder::human || held->holder_id != fact.subject) continue;
    const Vector3 out = held->T_world_object.translation() - who->joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
    if (out.head<2>().norm() < settings_.held_out() || held->velocity.norm() > settings_.offer_still()) continue;
    return Offer{fact.object, fact.subject};
  }
  return std::nullopt;
}

bool ManipulationPlanner::strayed(const Motion& motion) const {
  if (motion.aims_at.empty()) return false;
  const SceneObject* aim = object(motion.aims_at);
  return aim == nullptr || (aim->T_world_object.translation() - motion.p_world_aim).norm() > motion.aim_slack;
}

std::optional<Grasp> ManipulationPlanner::aimed(const std::string& object_id, const Grasp& grasp) const {
  const SceneObject* held = object(object_id);
  if (held == nullptr) return std::nullopt;
  const auto hand_in_root = [this](const Vector& arm_joints) {
    return robot_->link_pose(RobotModel::with(set_point_, arm_, arm_joints), robot_->tool_link());
  };
  const Pose T_grasp_standoff = hand_in_root(grasp.arm_joints).inverse() * hand_in_root(grasp.approach_joints);
  const Pose T_root_hand = scene_.T_world_base.inverse() * held->T_world_object * grasp.T_object_hand;
  IkOptions options;
  options.restarts = 0;
  Grasp now = grasp;
  const auto at = robot_->inverse(arm_, T_root_hand, RobotModel::with(set_point_, arm_, grasp.arm_joints), options);
  if (!at) return std::nullopt;
  const auto before = robot_->inverse(arm_, T_root_hand * T_grasp_standoff, RobotModel::with(set_point_, arm_, *at), options);
  if (!before) return std::nullopt;
  now.arm_joints = *at;
  now.approach_joints = *before;
  return now;
}

Routine<Outcome> ManipulationPlanner::receive(const std::string& wanted, const std::string& giver) {
  if (status_.holding && (wanted.empty() || attachment_.object == wanted)) co_return Outcome{};
  Outcome last = Outcome::failure((giver.empty() ? "nobody offers " : giver + " does not offer ") + (wanted.empty() ? "anything" : wanted) +
                                  " within " + std::to_string(static_cast<int>(settings_.receive_timeout())) + " s");
  std::set<std::uint64_t> did_not_hold;
  for (std::uint32_t attempt = 0; attempt < settings_.receive_attempts(); ++attempt) {
    status_.phase = "watching for an offer";
    status_.exchange_engaged = false;
    const TimePoint patience = waiting_.now() + from_seconds(settings_.receive_timeout());
    std::optional<Offer> offer;
    for (TimePoint since = waiting_.now(); waiting_.now() < patience;) {
      const std::optional<Offer> seen = offered(wanted, giver);
      if (!seen || !offer || seen->object != offer->object || seen->giver != offer->giver) since = waiting_.now();
      offer = seen;
      if (offer && to_seconds(waiting_.now() - since) >= kSteady) break;
      co_await waiting_.pause(kLookAgain);
    }
    if (!offer) co_return last;
    status_.object = offer->object;
    status_.human = offer->giver;
    status_.exchange_point = object(offer->object)->T_world_object.translation();
    GraspList list = co_await ask_grasps(offer->object, "", settings_.max_grasps());
    last = list.outcome;
    if (std::all_of(list.grasps.begin(), list.grasps.end(), [&](const Grasp& g) { return did_not_hold.count(g.id) > 0; }))
      did_not_hold.clear();
    for (const Grasp& grasp : list.grasps) {
      if (did_not_hold.count(grasp.id) > 0) continue;
      last = co_await take(offer->object, offer->giver, grasp);
      if (last.good) co_return last;
      refuse("grasp " + std::to_string(grasp.id), last.reason);
      if (!last.strayed) did_not_hold.insert(grasp.id);
      if (last.strayed || !offered(offer->object, offer->giver)) break;
    }
    if (!last.good && list.grasps.empty()) {
      refuse("offer", last.reason);
      co_await waiting_.pause(kSteady);
    }
  }
  status_.exchange_engaged = false;
  co_return last;
}

Routine<Outcome> ManipulationPlanner::take(const std::string& object_id, const std::string& giver, const Grasp& chosen) {
  status_.phase = "planning";
  const bool ready = co_await waiting_.until([this] { return may_move() && at_rest(); }, settings_.permission_timeout());
  if (!ready) co_return Outcome::failure("no permission to move: " + execution_->reason);
  const std::optional<Grasp> first_aim = aimed(object_id, chosen);
  if (!first_aim) co_return Outcome::failure("no posture of the arm reaches it where it is held now");

  Motion approach;
  approach.phase = "approach";
  approach.goals = {first_aim->approach_joints};
  approach.tolerated = {object_id, giver};
  approach.aims_at = object_id;
  approach.p_world_aim = object(object_id)->T_world_object.translation();
  approach.aim_slack = settings_.approach_slack();
  const Group& hand_group = robot_->require_group("hand");
  const Vector opened = RobotModel::with(set_point_, hand_group, chosen.pregrasp_joints);
  PlannedPath way = co_await plan_path(opened, approach);
  if (!way.outcome.good) co_return Outcome::failure("approach: " + way.outcome.reason);
  status_.phase = "opening the hand";
  HandResult open = co_await hand(HandAction::move, chosen.pregrasp_joints, settings_.hand_timeout());
  if (!open.outcome.good) co_return open.outcome;
  status_.exchange_engaged = true;
  Outcome moved = co_await move(approach);
  if (!moved.good) status_.exchange_engaged = false;
  if (!moved.good) co_return moved;

  const auto steady = [this, &object_id, &giver] { return offered(object_id, giver).has_value(); };
  const bool offers = co_await waiting_.until(steady, settings_.sight_timeout());
  const std::optional<Grasp> grasp = offers ? aimed(object_id, chosen) : std::nullopt;
  if (!grasp) status_.exchange_engaged = false;
  if (!offers) co_return Outcome::failure(giver + " has drawn " + object_id + " back");
  if (!grasp) co_return Outcome::failure("no posture of the arm reaches it where it is held now");
  Motion reach_object;
  reach_object.phase = "reaching the object";
  reach_object.goals = {grasp->arm_joints};
  reach_object.straight = true;
  reach_object.allowed = {object_id, giver};
  reach_object.speed = settings_.approach_speed();
  reach_object.aims_at = object_id;
  reach_object.p_world_aim = object(object_id)->T_world_object.translation();
  reach_object.aim_slack = settings_.aim_slack();
  status_.exchange_point = reach_object.p_world_aim;
  moved = co_await move(reach_object);
  if (!moved.good) {
    moved = co_await back_off(object_id, giver, *grasp, moved);
    co_return moved;
  }

  status_.phase = "grasp";
  HandResult closed = co_await hand(HandAction::grasp, grasp->hand_joints, settings_.hand_timeout(), &grasp->hand_effort);
  if (!closed.outcome.good || closed.state != HandState::grasped) {
    const Outcome why = closed.outcome.good ? Outcome::failure("the hand closed on nothing") : closed.outcome;
    moved = co_await back_off(object_id, giver, *grasp, why);
    co_return moved;
  }
  status_.phase = "waiting for " + giver + " to let go";
  const auto mine = [this, &object_id] {
    const SceneObject* taken = object(object_id);
    return taken != nullptr && taken->holder == Holder::robot;
  };
  const bool let_go = co_await waiting_.until(mine, settings_.let_go_timeout());
  if (!let_go) {
    const Outcome why = Outcome::failure(giver + " does not let go of " + object_id);
    moved = co_await back_off(object_id, giver, *grasp, why);
    co_return moved;
  }
  grasp_ = *grasp;
  hold(*object(object_id));
  Motion back;
  back.phase = "retreat";
  back.straight = true;
  back.goals = {grasp->approach_joints};
  back.allowed = {object_id, giver};
  back.speed = settings_.carry_speed();
  moved = co_await move(back);
  status_.exchange_engaged = false;
  if (!moved.good) refuse("retreat", moved.reason);
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::back_off(const std::string& object_id, const std::string& giver, const Grasp& grasp,
                                               const Outcome& why) {
  status_.phase = "backing off";
  HandResult opened = co_await hand(HandAction::move, grasp.pregrasp_joints, settings_.hand_timeout());
  if (!opened.outcome.good) refuse("backing off", opened.outcome.reason);
  Motion back;
  back.phase = "backing off";
  back.straight = true;
  back.goals = {grasp.approach_joints};
  back.allowed = {object_id, giver};
  back.speed = settings_.approach_speed();
  Outcome backed = co_await move(back);
  if (!backed.good) refuse("backing off", backed.reason);
  status_.exchange_engaged = false;
  co_return why;
}

}  // namespace handsel::manipulation_planner
