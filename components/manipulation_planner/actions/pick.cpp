// The actions, top to bottom: pick, give.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {

namespace {
constexpr double kLookAgain = 0.5;  // [s]
}

Routine<Outcome> ManipulationPlanner::pick(const std::string& object_id, const std::string& for_human, const std::string& onto) {
  if (status_.holding && attachment_.object == object_id) co_return Outcome{};
  status_.phase = ActionPhase::looking_for_object;
  const bool seen =
      co_await waiting_.until([this, &object_id] { return snapshot_.object(object_id) != nullptr; }, settings_.sight_timeout());
  if (!seen) co_return Outcome::failure("object " + object_id + " is not in the scene");
  Outcome last;
  const TimePoint patience = waiting_.now() + from_seconds(settings_.reach_timeout());
  for (int round = 0; round < 2; ++round) {
    GraspList list;
    if (onto.empty())
      list = co_await ask_grasps(object_id, for_human, settings_.max_grasps());
    else
      list = co_await ask_grasps_onto(object_id, onto);
    if (!list.outcome.good) {
      last = list.outcome;
      continue;
    }
    if (snapshot_.person(for_human) != nullptr && !for_human.empty()) {
      last = co_await keep_givable(list.grasps, object_id, for_human, patience);
      if (!last.good) continue;
    }
    int executed = 0;
    for (const Grasp& grasp : list.grasps) {
      last = co_await try_grasp(object_id, for_human, grasp);
      if (last.good) co_return last;
      refuse("grasp " + std::to_string(grasp.id), last.reason);
      if (status_.holding) co_return last;
      if (status_.phase != ActionPhase::planning && ++executed >= 3) break;  // the object may have moved: look again
    }
  }
  co_return last;
}

Routine<Outcome> ManipulationPlanner::keep_givable(std::vector<Grasp>& grasps, const std::string& object_id, const std::string& human,
                                                   TimePoint patience) {
  struct Ahead {
    std::size_t grasp;
    double cost;
  };
  struct Result {
    std::vector<Ahead> givable;
    Refusals refused;
  };
  auto result = std::make_shared<Result>();
  while (snapshot_.person(human) != nullptr && snapshot_.object(object_id) != nullptr) {
    status_.phase = ActionPhase::looking_ahead;
    *result = {};
    const std::function<void()> job = [this, result, grasps, scene = snapshot_.scene(), layers = snapshot_.layers(waiting_.now()),
                                       who = *snapshot_.person(human), q = snapshot_.set_point(),
                                       T_world_object = snapshot_.object(object_id)->T_world_object] {
      auto settings = settings_;
      settings.set_exchange_goals(1);
      for (std::size_t i = 0; i < grasps.size(); ++i) {
        const ExchangeSearch search = find_exchange(*robot_, scene, who, layers, q, T_world_object, grasps[i].T_object_hand.inverse(),
                                                    settings, barred_ways(grasps[i]));
        if (search.poses.empty())
          result->refused.push_back({"grasp " + std::to_string(grasps[i].id), search.reason});
        else
          result->givable.push_back({i, search.poses.front().cost + settings.w_grasp_rank() * static_cast<double>(i)});
      }
    };
    Outcome worked = co_await worker_.run(job);
    if (!worked.good) co_return worked;
    if (!result->givable.empty() || waiting_.now() >= patience) break;
    status_.phase = ActionPhase::waiting_for_person;
    co_await waiting_.pause(kLookAgain);
  }
  for (const auto& refusal : result->refused) refuse(refusal.what, refusal.reason);
  if (result->givable.empty())
    co_return Outcome::failure("no grasp of " + object_id + " can be handed to " + human +
                                   (result->refused.empty() ? ", who is out of sight" : ": " + result->refused.front().reason),
                               result->refused.empty() ? ActionFailure::not_visible : ActionFailure::other);
  std::stable_sort(result->givable.begin(), result->givable.end(), [](const Ahead& a, const Ahead& b) { return a.cost < b.cost; });
  std::vector<Grasp> givable;
  for (const Ahead& ahead : result->givable) givable.push_back(grasps[ahead.grasp]);
  grasps = std::move(givable);
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::try_grasp(const std::string& object_id, const std::string& for_human, const Grasp& grasp) {
  status_.phase = ActionPhase::planning;
  const bool ready = co_await waiting_.until([this] { return may_move() && at_rest(); }, settings_.permission_timeout());
  if (!ready) co_return not_permitted();

  Motion approach;
  approach.phase = ActionPhase::approach;
  approach.goals = {grasp.approach_joints};
  approach.tolerated = {object_id};
  Motion reach_object;
  reach_object.phase = ActionPhase::reaching_object;
  reach_object.goals = {grasp.arm_joints};
  reach_object.straight = true;
  reach_object.allowed = {object_id};
  reach_object.speed = settings_.approach_speed();

  Vector opened = snapshot_.set_point();
  if (!fingers_.axes.empty()) opened = RobotModel::with(opened, fingers_, grasp.pregrasp_joints);
  Vector before = RobotModel::with(opened, arm_, grasp.approach_joints);
  PlannedPath last_part = co_await plan_path(before, reach_object);
  if (!last_part.outcome.good) co_return last_part.outcome.of("last part of the approach");
  PlannedPath first_part = co_await plan_path(opened, approach);
  if (!first_part.outcome.good) co_return first_part.outcome.of("approach");

  Outcome moved = co_await tell_hand(HandAction::move, grasp.pregrasp_joints);
  if (!moved.good) co_return moved;
  moved = co_await move(approach);
  if (!moved.good) co_return moved;
  moved = co_await hand_opened();
  if (!moved.good) co_return moved;
  moved = co_await move(reach_object);
  if (!moved.good) co_return moved;

  status_.phase = ActionPhase::grasp;
  HandResult closed = co_await hand(HandAction::grasp, grasp.hand_joints, settings_.hand_timeout(), &grasp.hand_effort);
  if (!closed.outcome.good || closed.state != HandState::grasped) {
    HandResult reopened = co_await hand(HandAction::move, grasp.pregrasp_joints, settings_.hand_timeout());
    Motion back = reach_object;
    back.phase = ActionPhase::backing_off;
    back.goals = {grasp.approach_joints};
    Outcome backed = co_await move(back);
    if (!closed.outcome.good) co_return closed.outcome;
    co_return Outcome::failure("the hand closed on nothing", ActionFailure::nothing_grasped);
  }
  grasp_ = grasp;
  // Where the fingers have pushed it to: as soon as it is seen to be still.
  const Stamp seen = snapshot_.scene().stamp;
  const auto still = [this, &object_id, seen] {
    const SceneObject* thing = snapshot_.object(object_id);
    return snapshot_.scene().stamp != seen && thing != nullptr && thing->velocity.norm() < settings_.offer_still();
  };
  co_await waiting_.until(still, settings_.settle_time());
  const SceneObject* held = snapshot_.object(object_id);
  if (held == nullptr) co_return Outcome::failure("object " + object_id + " left the scene");
  hold(*held);
  Outcome lifted = co_await lift(object_id, for_human);
  if (lifted.end == MotionEnd::taken) co_return Outcome{};
  if (!lifted.good) co_return lifted;
  const auto came = [this, &object_id] {
    const SceneObject* taken = snapshot_.object(object_id);
    return taken != nullptr && taken->holder == Holder::robot;
  };
  const bool carried = co_await waiting_.until(came, settings_.settle_time());
  if (carried) co_return lifted;
  release_object();
  HandResult emptied = co_await hand(HandAction::move, grasp.pregrasp_joints, settings_.hand_timeout());
  co_return Outcome::failure(object_id + " stayed behind when the hand went up", ActionFailure::left_behind);
}

Routine<Outcome> ManipulationPlanner::lift(const std::string& object_id, const std::string& for_human) {
  Motion up;
  up.phase = ActionPhase::lift;
  up.straight = true;
  up.allowed = {object_id};
  up.yields_to = for_human;
  const Pose T_now = T_world_tool();
  for (const double share : {1.0, 0.85}) {
    Pose T = T_now;
    T.translation().z() += share * settings_.lift_height();
    if (auto joints = reach(T)) {
      up.goals = {*joints};
      Outcome outcome = co_await move(up);
      if (outcome.good || outcome.end == MotionEnd::taken) co_return outcome;
    }
  }
  co_return Outcome::failure("the arm cannot lift " + object_id + " straight up by " + std::to_string(settings_.lift_height()) + " m");
}

Routine<ManipulationPlanner::ExchangeChoice> ManipulationPlanner::choose_exchange(const std::string& receiver, const Pose* T_world_object) {
  auto choice = std::make_shared<ExchangeChoice>();
  const Person* whom = snapshot_.person(receiver);
  if (whom == nullptr) {
    choice->outcome = Outcome::out_of_sight("person " + receiver);
    co_return *choice;
  }
  const Pose T_kept = T_world_object != nullptr ? *T_world_object : Pose::Identity();
  const bool asks = T_world_object != nullptr;
  const std::function<void()> job = [this, choice, asks, T_kept, scene = snapshot_.scene(), layers = snapshot_.layers(waiting_.now()),
                                     who = *whom, q = snapshot_.set_point(), T = attachment_.T_tool_object,
                                     T_now = T_world_tool() * attachment_.T_tool_object,
                                     barred = grasp_ ? barred_ways(*grasp_) : std::vector<Vector3>{}] {
    choice->search = find_exchange(*robot_, scene, who, layers, q, T_now, T, settings_, barred);
    if (asks) choice->kept = exchange_cost(scene, who, layers, T_kept, T_now, T, settings_, barred);
  };
  choice->outcome = co_await worker_.run(job);
  co_return *choice;
}

void ManipulationPlanner::lead_to(const ExchangeSearch& search, const Person& receiver, Motion& motion) {
  motion.goals.clear();
  for (const auto& pose : search.poses) motion.goals.push_back(pose.arm_joints);
  motion.receiver = receiver.id;
  motion.receiver_at = receiver.joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
}

Routine<Outcome> ManipulationPlanner::give(const std::string& object_id, const std::string& human) {
  const SceneObject* held = snapshot_.object(object_id);
  if (held == nullptr) co_return Outcome::failure("object " + object_id + " is not in the scene");
  if (held->holder == Holder::human && !in_hand(*held)) co_return Outcome{};
  if (!status_.holding || attachment_.object != object_id) co_return Outcome::failure("the hand does not hold " + object_id);
  status_.phase = ActionPhase::choosing_exchange_point;
  const bool seen = co_await waiting_.until([this, &human] { return snapshot_.person(human) != nullptr; }, settings_.sight_timeout());
  if (!seen)
    co_return human.empty() ? Outcome::failure("nobody is in sight")
                            : Outcome::failure("person " + human + " is not in sight", ActionFailure::not_visible);
  const std::string receiver = snapshot_.person(human)->id;
  status_.human = receiver;

  Outcome last;
  // In the hand, yet not borne by it: somebody has hold of it already.
  bool at_exchange =
      takes_hold(receiver) || (snapshot_.object(object_id) != nullptr && snapshot_.object(object_id)->holder != Holder::robot);
  const TimePoint patience = waiting_.now() + from_seconds(settings_.reach_timeout());
  for (std::uint32_t attempt = 0; attempt < settings_.motion_attempts() && !at_exchange;) {
    status_.phase = ActionPhase::choosing_exchange_point;
    const Person* whom = snapshot_.person(receiver);
    if (whom == nullptr) co_return Outcome::out_of_sight("person " + receiver);
    ExchangeChoice choice = co_await choose_exchange(receiver, nullptr);
    const ExchangeSearch& search = choice.search;
    last = choice.outcome;
    if (last.good && search.poses.empty()) {
      last = Outcome::failure(search.reason);
      if (waiting_.now() >= patience) {
        refuse("exchange point", last.reason);
        co_return last;
      }
      status_.phase = ActionPhase::waiting_for_person;
      co_await waiting_.pause(kLookAgain);
      continue;
    }
    ++attempt;
    if (!last.good) continue;
    Motion carry;
    carry.phase = ActionPhase::carry;
    carry.speed = settings_.carry_speed();
    carry.allowed = {object_id};
    carry.yields_to = receiver;
    whom = snapshot_.person(receiver);
    if (whom == nullptr) co_return Outcome::out_of_sight("person " + receiver);
    lead_to(search, *whom, carry);
    status_.exchange_point = search.poses.front().T_world_object.translation();
    last = co_await move(carry);
    at_exchange = last.good || last.end == MotionEnd::taken;
    if (last.end == MotionEnd::taken) break;
    if (!at_exchange || settings_.live_period() <= 0 || attempt >= settings_.motion_attempts()) continue;
    const Vector here = RobotModel::part(posture(), arm_);
    const bool elsewhere = co_await follow(carry, here);
    at_exchange = !elsewhere;
  }
  if (!at_exchange) co_return last;

  status_.phase = ActionPhase::offer;
  status_.exchange_point = (T_world_tool() * attachment_.T_tool_object).translation();
  status_.exchange_engaged = true;
  Vector opening = grasp_ ? grasp_->pregrasp_joints : RobotModel::part(robot_->rest_posture(), fingers_);
  HandResult released = co_await hand(HandAction::release_on_pull, opening, settings_.offer_timeout());
  if (!released.outcome.good || released.state != HandState::released) {
    status_.exchange_engaged = false;
    const Vector grip = RobotModel::part(snapshot_.set_point(), fingers_);
    HandResult kept = co_await hand(HandAction::grasp, grip, settings_.hand_timeout());
    if (!kept.outcome.good) refuse("keeping the object", kept.outcome.reason);
    if (!released.outcome.good) co_return released.outcome;
    co_return Outcome::failure(
        receiver + " did not take " + object_id + " within " + std::to_string(static_cast<int>(settings_.offer_timeout())) + " s",
        ActionFailure::not_taken);
  }
  release_object();
  status_.phase = ActionPhase::retreat;
  co_await waiting_.pause(0.5);
  Outcome back = co_await retreat(receiver, object_id);
  if (!back.good) refuse("retreat", back.reason);
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
