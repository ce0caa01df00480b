// Taking an object from a person's hand: wait for an offer, come to it clear of the fingers, close, feel that they have let go, draw back.
#include <algorithm>
#include <cmath>
#include <set>

#include "common/model/human/holding_hand.hpp"
#include "common/model/human/human_body.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {

namespace {
constexpr double kSteady = 0.25;     // [s] an offer must last before the hand goes for it
constexpr double kFirstOffer = 3.0;  // [s] without an offer, before what is held still before the body counts as one ...
constexpr double kKeptStill = 1.0;   // [s] ... when it has lasted so long; and if there is none, room is made for one
constexpr double kLookAgain = 0.02;  // [s]
constexpr double kMovedOn = 0.03;    // [m] grasps of what has gone farther since they were asked for tell nothing about it
constexpr double kAnotherTry = 1.0;  // [s] before an offer that could not be reached is looked at again
constexpr double kAimed = 0.02;      // [m] before the object the hand stands where the straight way in begins, up to this
constexpr double kHandLength = 0.3;  // [m] palm to what is beyond the open fingers
constexpr double kLoadStays = 0.2;   // [s] before what was taken is drawn away
constexpr double kInHand = 0.05;     // [m] what weighs on the hand lies in it, when so near to where it is grasped
constexpr double kNear = 0.5;        // [m] palm to what is offered
// [m] While a new way is sought, an offer may be shifted by this share of the way that is left to there, and at its end by this.
constexpr double kOfTheWay = 0.5, kBesideHand = 0.04;
// [rad, sum of max norms] Who waits does not watch an arm go all around: the way is no longer than so many times the straight one and the
// second, which each attempt gives again ...
constexpr double kDetour = 1.3, kMoreThan = 1.0;
constexpr double kApproachPatience = 10,
                 kReachPatience = 5;   // [s] where people leave so little room that the arm creeps, another way is tried
constexpr double kThink = 0.6;         // [s] of a way to one grasp, before the next is tried
constexpr std::uint32_t kHurried = 2;  // ... until after so many attempts a long way is better than none
constexpr double kSameWay = 0.5;       // [rad] ways of the arm that differ by less, its farthest axis counted, count as equally long
// A grasp of less than this epsilon is taken where it saves so long a way [rad]: what is held by luck slips as it is carried.
constexpr double kWeak = 0.03, kForStrength = 1.5;
constexpr double kForPlacing = 2.0;      // [rad] likewise a grasp by which it cannot be put down afterwards ...
constexpr std::size_t kPlacesAhead = 8;  // ... at any of so many places: who holds it out waits for the answer
constexpr int kMostAims = 6;             // so often the hand follows before it waits for the offer anew
constexpr double kOffFingers = 0.01;     // [m] kept from the giver's hand, closing included
// More than `held_out` [m] and toward the robot or its hand by this cosine: held out by who was asked for it, though the arm is not
// stretched. The second is less than `held_out`, and means it when nothing else has been offered for long, the third when it is taken up.
// Farther out than kFarOut nothing is kept, wherever that is.
constexpr double kBentArm = 0.02, kBeforeBody = 0.03, kDrawnIn = 0.015, kFarOut = 0.4, kTowardRobot = 0.7;
// [s] An offer that is taken up may seem drawn back for so long, as what is measured trembles about its bounds; longer than the second, it
// is.
constexpr double kFlicker = 0.2, kDrawnBack = 0.6;
// [m/s] Who comes on faster before the hand, or so near [m] holds something into it, makes it step back by kStepBack [m]: what they hold
// would be pressed against the fingers.
constexpr double kComesOn = 0.35, kAtFingers = 0.4, kStepBack = 0.15;

Vector3 level(const Vector3& v) { return {v.x(), v.y(), 0}; }
const Vector3& torso_of(const Person& who) { return who.joints[static_cast<std::size_t>(body_joint_index("torso"))].position; }
}  // namespace

bool ManipulationPlanner::holds_out(const Person& who, const SceneObject& held) const {
  if (held.holder != Holder::human || held.holder_id != who.id) return false;
  const Vector3 out = level(held.T_world_object.translation() - torso_of(who));
  const bool fact = std::any_of(snapshot_.facts().facts.begin(), snapshot_.facts().facts.end(),
                                [&](const Fact& f) { return f.kind == FactKind::offering && f.subject == who.id && f.object == held.id; });
  // What is taken up is held out until it clearly is not.
  const bool taken_up = taken_up_.object == held.id && taken_up_.giver == who.id;
  const double least = settings_.held_out() + (waited_long_ ? -kBeforeBody : taken_up ? -kDrawnIn : fact ? 0.0 : kBentArm);
  if (fact) return out.norm() >= least;
  // Who was asked for it and holds it out toward the robot means it, with a bent arm too.
  const bool asked = goal_.human == who.id && goal_.object == held.id;
  const auto toward = [&out, &who](const Vector3& there) {
    const Vector3 way = level(there - torso_of(who));
    return out.dot(way) > kTowardRobot * out.norm() * way.norm();
  };
  if (asked && out.norm() > kFarOut) return true;
  return asked && out.norm() >= least && (toward(snapshot_.T_world_base().translation()) || toward(T_world_tool().translation()));
}

void ManipulationPlanner::watch_offer() {
  const SceneObject* held = snapshot_.object(taken_up_.object);
  const Person* who = held == nullptr ? nullptr : snapshot_.person(taken_up_.giver);
  if (who != nullptr && holds_out(*who, *held)) offered_at_ = waiting_.now();
}

bool ManipulationPlanner::still_offered() const { return to_seconds(waiting_.now() - offered_at_) < kFlicker; }

std::optional<ManipulationPlanner::Offer> ManipulationPlanner::offered(const std::string& wanted, const std::string& giver) const {
  for (const SceneObject& held : snapshot_.scene().objects) {
    if (!wanted.empty() && held.id != wanted) continue;
    for (const Person& who : snapshot_.people().people) {
      if ((!giver.empty() && who.id != giver) || held.velocity.norm() > settings_.offer_still() || !holds_out(who, held)) continue;
      return Offer{held.id, who.id};
    }
  }
  return std::nullopt;
}

bool ManipulationPlanner::comes_on(const std::string& giver) const {
  const Person* who = snapshot_.person(giver);
  const SceneObject* held = snapshot_.object(taken_up_.object);
  if (who == nullptr || held == nullptr) return false;
  const Vector3 p_hand = T_world_tool().translation(), p_held = held->T_world_object.translation();
  const auto toward_hand = [&p_hand](const Vector3& p, const Vector3& v) { return v.dot((p_hand - p).stableNormalized()) > kComesOn; };
  const BodyJoint& torso = who->joints[static_cast<std::size_t>(body_joint_index("torso"))];
  const double apart = (p_held - p_hand).norm();
  return (apart < kNear && toward_hand(torso.position, torso.velocity)) || (apart < kAtFingers && toward_hand(p_held, held->velocity));
}

bool ManipulationPlanner::strayed(const Motion& motion) const {
  if (motion.aims_at.empty()) return false;
  if (motion.follows && comes_on(taken_up_.giver)) return true;
  const SceneObject* aim = snapshot_.object(motion.aims_at);
  if (aim == nullptr) return true;
  const double shifted = (aim->T_world_object.translation() - motion.p_world_aim).norm();
  if (!motion.follows) return shifted > motion.aim_slack;
  const double ahead = (aim->T_world_object.translation() - T_world_tool().translation()).norm() - kHandLength;
  return shifted > std::clamp(kOfTheWay * ahead, kBesideHand, motion.aim_slack) || !still_offered();
}

std::optional<Vector3> ManipulationPlanner::follow_offer(Motion& motion) {
  const SceneObject* aim = snapshot_.object(motion.aims_at);
  if (aim == nullptr || (aim->T_world_object.translation() - motion.p_world_aim).norm() < kAimed) return std::nullopt;
  const std::optional<Grasp> there = aimed(motion.aims_at, *motion.follows);
  if (!there) return std::nullopt;
  motion.goals = {there->approach_joints};
  return aim->T_world_object.translation();
}

std::optional<Grasp> ManipulationPlanner::aimed(const std::string& object_id, const Grasp& grasp) const {
  const SceneObject* held = snapshot_.object(object_id);
  if (held == nullptr) return std::nullopt;
  const auto hand_in_root = [this](const Vector& arm_joints) {
    return robot_->link_pose(RobotModel::with(snapshot_.set_point(), arm_, arm_joints), palm_);
  };
  const Pose T_grasp_standoff = hand_in_root(grasp.arm_joints).inverse() * hand_in_root(grasp.approach_joints);
  const Pose T_root_hand = snapshot_.T_world_base().inverse() * held->T_world_object * grasp.T_object_hand;
  IkOptions options;
  options.restarts = 0;
  Grasp now = grasp;
  const auto at = robot_->inverse(arm_, T_root_hand, RobotModel::with(snapshot_.set_point(), arm_, grasp.arm_joints), options);
  if (!at) return std::nullopt;
  const auto before = robot_->inverse(arm_, T_root_hand * T_grasp_standoff, RobotModel::with(snapshot_.set_point(), arm_, *at), options);
  if (!before) return std::nullopt;
  now.arm_joints = *at;
  now.approach_joints = *before;
  return now;
}

Routine<std::optional<ManipulationPlanner::Offer>> ManipulationPlanner::watch_for_offer(const std::string& wanted, const std::string& giver,
                                                                                        TimePoint patience) {
  std::optional<Offer> offer;
  bool made_room = false;
  taken_up_ = {};
  status_.exchange_engaged = false;
  waited_long_ = false;
  const TimePoint began = waiting_.now();
  for (TimePoint since = began; waiting_.now() < patience;) {
    status_.phase = ActionPhase::watching_for_offer;
    const std::optional<Offer> seen = offered(wanted, giver);
    if (!seen || !offer || seen->object != offer->object || seen->giver != offer->giver) since = waiting_.now();
    offer = seen;
    if (offer && to_seconds(waiting_.now() - since) >= (waited_long_ ? kKeptStill : kSteady)) co_return offer;
    const double waited = to_seconds(waiting_.now() - began);
    waited_long_ = waited > kFirstOffer;
    if (!offer && !made_room && waited > kFirstOffer + kKeptStill && crowds(giver)) {
      made_room = true;
      Outcome made = co_await make_room(giver, true);
      if (!made.good) refuse("making room", made.reason);
      continue;
    }
    co_await waiting_.pause(kLookAgain);
  }
  co_return std::nullopt;
}

Routine<Outcome> ManipulationPlanner::receive(const std::string& wanted, const std::string& giver, const std::string& onto) {
  if (status_.holding && (wanted.empty() || attachment_.object == wanted)) co_return Outcome{};
  Outcome last = Outcome::failure((giver.empty() ? "nobody offers " : giver + " does not offer ") + (wanted.empty() ? "anything" : wanted) +
                                  " within " + std::to_string(static_cast<int>(settings_.receive_timeout())) + " s");
  std::set<std::uint64_t> did_not_hold;
  TimePoint patience = waiting_.now() + from_seconds(settings_.receive_timeout());
  for (std::uint32_t attempt = 0; attempt < settings_.receive_attempts();) {
    std::optional<Offer> offer = co_await watch_for_offer(wanted, giver, patience);
    if (!offer) break;
    taken_up_ = *offer;
    offered_at_ = waiting_.now();
    at_offer_ = false;
    status_.object = offer->object;
    status_.human = offer->giver;
    const Vector3 p_asked = status_.exchange_point = snapshot_.object(offer->object)->T_world_object.translation();
    destinations_.clear();
    GraspList list = co_await ask_grasps(offer->object, "", settings_.max_grasps_onto());
    if (!list.grasps.empty()) list.outcome = co_await keep_off_fingers(offer->object, offer->giver, list.grasps);
    if (!list.outcome.good || list.grasps.empty()) {
      const auto moved_on = [this, &offer, &p_asked] {
        const SceneObject* held = snapshot_.object(offer->object);
        return held == nullptr || (held->T_world_object.translation() - p_asked).norm() > kMovedOn;
      };
      if (moved_on()) continue;
      // Who is not come for holds it out elsewhere, nearer, or farther out where there is room.
      if (list.outcome.reason != last.reason) refuse("offer", list.outcome.reason);
      last = list.outcome;
      if (crowds(offer->giver)) co_await make_room(offer->giver);
      co_await waiting_.until(moved_on, kAnotherTry);
      continue;
    }
    ++attempt;
    const Serving later = co_await serving(offer->object, onto, list.grasps, list.grasps.size(), kPlacesAhead);
    for (const auto& [grasp, destination] : later.at) destinations_.push_back(destination);
    if (later.at.empty() && !later.objections.empty())
      refuse("place", "no grasp of " + offer->object + " as it is held serves for putting it down: " + later.objections);
    // Who holds something out does not wait long: what the arm is at sooner comes first, unless the grasp is weak or cannot put it down.
    const auto way = [this](const Grasp& g) {
      const bool serves = std::any_of(destinations_.begin(), destinations_.end(), [&g](const Destination& d) { return d.grasp == g.id; });
      const double farther = (g.epsilon < kWeak ? kForStrength : 0.0) + (serves ? 0.0 : kForPlacing);
      return std::floor(((g.approach_joints - RobotModel::part(snapshot_.set_point(), arm_)).cwiseAbs().maxCoeff() + farther) / kSameWay);
    };
    std::stable_sort(list.grasps.begin(), list.grasps.end(), [&way](const Grasp& a, const Grasp& b) { return way(a) < way(b); });
    list.grasps.resize(std::min<std::size_t>(list.grasps.size(), settings_.max_grasps()));
    if (std::all_of(list.grasps.begin(), list.grasps.end(), [&](const Grasp& g) { return did_not_hold.count(g.id) > 0; }))
      did_not_hold.clear();
    for (const Grasp& grasp : list.grasps) {
      if (did_not_hold.count(grasp.id) > 0) continue;
      last = co_await take(offer->object, offer->giver, grasp, attempt);
      if (last.good) co_return last;
      refuse("grasp " + std::to_string(grasp.id), last.reason);
      if (!last.target_moved()) did_not_hold.insert(grasp.id);
      if (last.target_moved() || last.end == MotionEnd::late || !offered(offer->object, offer->giver)) break;
    }
    // Who has drawn it back offers it anew where the hand leaves room for it; and from farther back other ways lead to what is held out.
    const bool again = attempt < settings_.receive_attempts() && (still_offered() ? !last.target_moved() : crowds(offer->giver));
    if (again) co_await make_room(offer->giver);
    patience = waiting_.now() + from_seconds(settings_.receive_timeout());
  }
  co_return last;
}

Routine<Outcome> ManipulationPlanner::take(const std::string& object_id, const std::string& giver, const Grasp& chosen,
                                           std::uint32_t attempt) {
  status_.phase = ActionPhase::planning;
  const bool ready = co_await waiting_.until([this] { return may_move() && at_rest(); }, settings_.permission_timeout());
  if (!ready) co_return not_permitted();
  const Outcome out_of_reach = Outcome::failure("no posture of the arm reaches it where it is held now");
  std::optional<Grasp> grasp = aimed(object_id, chosen);
  if (!grasp) co_return out_of_reach;
  Motion approach = approach_to(object_id, giver, *grasp, attempt);
  const Vector opened = RobotModel::with(snapshot_.set_point(), fingers_, chosen.pregrasp_joints);
  PlannedPath way = co_await plan_path(opened, approach);
  if (!way.outcome.good) co_return way.outcome.of("approach");
  Outcome opening = co_await tell_hand(HandAction::move, chosen.pregrasp_joints);
  if (!opening.good) co_return opening;
  Outcome last;
  const auto steady = [this, &object_id, &giver] { return offered(object_id, giver).has_value(); };
  // Who is eager puts it into the open hand.
  const auto put_into_hand = [this, &object_id, &chosen] {
    const SceneObject* given = snapshot_.object(object_id);
    if (given == nullptr || given->holder != Holder::robot) return false;
    const Vector3 in_hand = T_world_tool().inverse() * given->T_world_object.translation();
    return (in_hand - chosen.T_object_hand.inverse().translation()).norm() < kInHand;
  };
  bool there = false;
  for (int aims = 0; aims < kMostAims && !there; ++aims) {
    approach = approach_to(object_id, giver, *grasp, attempt);
    last = co_await move(approach);
    if (there = put_into_hand(); there) break;
    if (!last.good && !last.target_moved()) break;
    if (last.target_moved()) waited_long_ = false;
    if (last.end == MotionEnd::giver_approached) co_await step_back(object_id, giver);
    const auto drawn_back = [this] { return to_seconds(waiting_.now() - offered_at_) > kDrawnBack; };
    co_await waiting_.until([&] { return steady() || put_into_hand() || drawn_back(); }, settings_.sight_timeout());
    if (there = put_into_hand(); there) break;
    const bool offers = steady();
    last = offers ? out_of_reach : Outcome::failure(giver + " has drawn " + object_id + " back");
    last.end = offers ? MotionEnd::failed : MotionEnd::target_moved;
    grasp = offers ? aimed(object_id, chosen) : std::nullopt;
    if (!grasp) break;
    const Pose T_before = snapshot_.T_world_base() *
                          robot_->link_pose(RobotModel::with(snapshot_.set_point(), arm_, grasp->approach_joints), robot_->tool_link());
    last = Outcome::failure(object_id + " is moved about");
    last.end = MotionEnd::target_moved;
    if ((T_before.translation() - T_world_tool().translation()).norm() > kAimed) continue;
    last = co_await hand_opened();
    if (!last.good) break;
    std::vector<Grasp> this_one{*grasp};
    last = co_await keep_off_fingers(object_id, giver, this_one);
    if (last.good && snapshot_.object(object_id) == nullptr) last = Outcome::out_of_sight(object_id);
    if (!last.good) break;
    Motion reach_object;
    reach_object.phase = ActionPhase::reaching_object;
    reach_object.goals = {grasp->arm_joints};
    reach_object.straight = true;
    reach_object.allowed = {object_id, giver};
    reach_object.aims_at = object_id;
    reach_object.p_world_aim = status_.exchange_point = snapshot_.object(object_id)->T_world_object.translation();
    reach_object.aim_slack = settings_.aim_slack();
    reach_object.patience = kReachPatience;
    at_offer_ = true;
    last = co_await move(reach_object);
    there = last.good;
    if (there) break;
    last = co_await back_off(object_id, giver, *grasp, last);
    if (!last.target_moved() || !steady()) break;
    grasp = aimed(object_id, chosen);
    if (!grasp) break;
  }
  if (!there) {
    co_await draw_back(object_id, giver);
    co_return last;
  }
  Outcome moved;

  status_.phase = ActionPhase::grasp;
  at_offer_ = true;
  // What lies in the hand otherwise than planned is pressed on where the fingers are.
  const bool laid_in = put_into_hand();
  const Vector closing = laid_in ? RobotModel::part(snapshot_.set_point(), robot_->require_group("hand")) : grasp->hand_joints;
  HandResult closed = co_await hand(HandAction::grasp, closing, settings_.hand_timeout(), &grasp->hand_effort);
  if (!closed.outcome.good || (closed.state != HandState::grasped && !laid_in)) {
    const Outcome why = closed.outcome.good ? Outcome::failure("the hand did not get hold of it") : closed.outcome;
    moved = co_await back_off(object_id, giver, *grasp, why);
    co_return moved;
  }
  status_.phase = ActionPhase::waiting_for_release;
  const auto mine = [this, &object_id] {
    const SceneObject* taken = snapshot_.object(object_id);
    return taken != nullptr && taken->holder == Holder::robot;
  };
  // Fingers that press on it feel some of its weight, too: it is the robot's when that stays and the giver's hand has gone.
  const auto given = [this, &object_id, &giver, &mine] { return mine() && !at_hand_of(giver, object_id); };
  const TimePoint until = waiting_.now() + from_seconds(settings_.let_go_timeout());
  TimePoint since = waiting_.now();
  while (waiting_.now() < until && to_seconds(waiting_.now() - since) < kLoadStays) {
    if (!given()) since = waiting_.now();
    co_await waiting_.pause(kLookAgain);
  }
  if (!given()) {
    const Outcome why = Outcome::failure(giver + " does not let go of " + object_id);
    moved = co_await back_off(object_id, giver, *grasp, why);
    co_return moved;
  }
  grasp_ = *grasp;
  hold(*snapshot_.object(object_id));
  Motion back;
  back.phase = ActionPhase::retreat;
  back.straight = true;
  back.goals = {grasp->approach_joints};
  back.allowed = {object_id, giver};
  back.speed = settings_.carry_speed();
  moved = co_await move(back);
  at_offer_ = false;
  if (!moved.good) refuse("retreat", moved.reason);
  co_return Outcome{};
}

ManipulationPlanner::Motion ManipulationPlanner::approach_to(const std::string& object_id, const std::string& giver, const Grasp& grasp,
                                                             std::uint32_t attempt) const {
  Motion approach;
  approach.phase = ActionPhase::approach;
  approach.goals = {grasp.approach_joints};
  approach.tolerated = {giver};
  approach.aims_at = object_id;
  approach.p_world_aim = snapshot_.object(object_id)->T_world_object.translation();
  approach.aim_slack = settings_.approach_slack();
  approach.follows = grasp;
  approach.patience = kApproachPatience;
  if (attempt > kHurried) return approach;
  approach.think = kThink;
  approach.longest =
      kDetour * (grasp.approach_joints - RobotModel::part(snapshot_.set_point(), arm_)).cwiseAbs().maxCoeff() + attempt * kMoreThan;
  return approach;
}

Routine<Outcome> ManipulationPlanner::keep_off_fingers(const std::string& object_id, const std::string& giver, std::vector<Grasp>& grasps) {
  auto clear = std::make_shared<std::vector<Grasp>>();
  HumanState around = snapshot_.people();
  for (Person& who : around.people) {
    if (who.id != giver) continue;
    if (const SceneObject* held = snapshot_.object(object_id)) who = with_fingers_bent(who, held->T_world_object.translation());
    who.inflation += kOffFingers;
  }
  const std::function<void()> job = [this, clear, around, grasps, object_id, world = worker_.world(*robot_, snapshot_.objects()),
                                     scene = snapshot_.scene(), q = posture()] {
    constexpr int kSteps = 6;
    world->set_scene(scene);
    world->set_people(around);
    world->set_attachment({}, {object_id});
    world->set_moving_axes(arm_.axes);
    const Group& fingers = fingers_;
    const auto free = [&](const Vector& arm, const Vector& hand) {
      return world->check_people(RobotModel::with(RobotModel::with(q, arm_, arm), fingers, hand)).free;
    };
    for (const Grasp& g : grasps) {
      bool off = true;
      for (int k = kSteps; k >= 0 && off; --k) {
        const double s = static_cast<double>(k) / kSteps;
        off = free(g.approach_joints + s * (g.arm_joints - g.approach_joints), g.pregrasp_joints) &&
              free(g.arm_joints, g.pregrasp_joints + s * (g.hand_joints - g.pregrasp_joints));
      }
      if (off) clear->push_back(g);
    }
  };
  Outcome worked = co_await worker_.run(job);
  if (!worked.good) co_return worked;
  grasps = *clear;
  if (grasps.empty()) worked = Outcome::failure("the hand would come too near to the fingers of " + giver);
  co_return worked;
}

/// While the giver's hand is still excepted: from so near to it nothing but straight away leads off.
Routine<Outcome> ManipulationPlanner::draw_back(const std::string& object_id, const std::string& giver) {
  const SceneObject* held = snapshot_.object(object_id);
  const Vector3 p_hand = T_world_tool().translation();
  const Person* who = snapshot_.person(giver);
  const auto far = [&p_hand](const Vector3& p) { return (p - p_hand).norm() > kNear; };
  const bool clear =
      who == nullptr || std::all_of(who->joints.begin(), who->joints.end(), [&far](const BodyJoint& j) { return far(j.position); });
  if (held == nullptr || (clear && far(held->T_world_object.translation()))) co_return Outcome{};
  Motion next;
  next.goals = {RobotModel::part(robot_->rest_posture(), arm_)};
  next.allowed = {object_id};
  Outcome drawn = co_await withdraw(giver, next);
  if (!drawn.good) refuse("drawing back", drawn.reason);
  co_return drawn;
}

/// At once, and only far enough to leave room for what they hold.
Routine<Outcome> ManipulationPlanner::step_back(const std::string& object_id, const std::string& giver) {
  const bool ready = co_await waiting_.until([this] { return may_move() && at_rest(); }, settings_.permission_timeout());
  if (!ready) co_return not_permitted();
  const Vector start = posture();
  Motion back;
  back.phase = ActionPhase::stepping_back;
  back.straight = true;
  back.allowed = {object_id, giver};
  for (const Vector3& way : ways_out(giver)) {
    Pose T = T_world_tool();
    T.translation() += kStepBack * way;
    const auto joints = reach(T);
    if (!joints || !way_out_.leads_away(start, RobotModel::with(start, arm_, *joints), snapshot_.T_world_base(), snapshot_.people()))
      continue;
    back.goals = {*joints};
    PlannedPath planned = co_await plan_path(start, back);
    if (!planned.outcome.good) continue;
    status_.phase = back.phase;
    Outcome stepped = co_await execute(planned.nodes, back);
    co_return stepped;
  }
  Outcome none = Outcome::failure("no straight way leads off " + giver);
  refuse("stepping back", none.reason);
  co_return none;
}

Routine<Outcome> ManipulationPlanner::back_off(const std::string& object_id, const std::string& giver, const Grasp& grasp,
                                               const Outcome& why) {
  status_.phase = ActionPhase::backing_off;
  HandResult opened = co_await hand(HandAction::move, grasp.pregrasp_joints, settings_.hand_timeout());
  if (!opened.outcome.good) refuse("backing off", opened.outcome.reason);
  Motion back;
  back.phase = ActionPhase::backing_off;
  back.straight = true;
  back.goals = {grasp.approach_joints};
  back.allowed = {object_id, giver};
  back.speed = settings_.approach_speed();
  Outcome backed = co_await move(back);
  if (!backed.good) refuse("backing off", backed.reason);
  at_offer_ = false;
  co_return why;
}

}  // namespace handsel::manipulation_planner
