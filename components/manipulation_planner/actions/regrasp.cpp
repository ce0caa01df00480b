// What takes two hands: from one to the other, where one alone cannot bring the object to its place (chapter section 3.2.10).
#include <algorithm>
#include <cmath>

#include "common/model/object_extent.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {

namespace {
constexpr double kAtRest = 0.02;        // an arm this near its rest posture is there, max norm [rad]
constexpr int kCloseTries = 2;          // of a hand on what the other holds
constexpr double kHandy = 0.7;          // from a shoulder [m]
constexpr double kEdge = 0.08;          // what is put down stands this far inside the edge of a surface [m]
constexpr double kRim = 0.01;           // no part of it is nearer to the edge [m]
constexpr double kGrid = 0.02;          // places looked at are this far from each other [m]
constexpr double kApart = 0.2;          // and from other things [m]
constexpr std::size_t kMostPlaces = 4;  // on a surface that are tried
}  // namespace

HandState ManipulationPlanner::hand_state() const {
  if (hand_ == 0) return snapshot_.execution()->hand;
  const auto other = std::find_if(snapshot_.execution()->other_hands.begin(), snapshot_.execution()->other_hands.end(),
                                  [this](const OtherHandState& o) { return o.group == fingers_.name; });
  return other == snapshot_.execution()->other_hands.end() ? HandState::idle : other->hand;
}

bool ManipulationPlanner::holds(const std::string& object_id) const {
  const SceneObject* held = snapshot_.object(object_id);
  return held != nullptr && held->holder == Holder::robot && hand_index(hands_, held->holder_id) == static_cast<int>(hand_);
}

Routine<Outcome> ManipulationPlanner::use_arm(const std::string& arm) {
  const auto wanted = std::find_if(hands_.begin(), hands_.end(), [&](const Manipulator& m) { return m.name == arm && m.arm != nullptr; });
  if (wanted == hands_.end()) co_return Outcome::failure("robot " + robot_->name() + " has no arm \"" + arm + "\"");
  const auto index = static_cast<std::size_t>(wanted - hands_.begin());
  if (index == hand_) co_return Outcome{};
  const bool free = co_await waiting_.until([this] { return worker_.is_idle(); }, settings_.request_timeout());
  if (!free) co_return Outcome::failure("a computation for the other arm does not end");
  hand_ = index;
  arm_ = *hands_[index].arm;
  opens_to_.reset();
  fingers_ = hands_[index].fingers != nullptr ? *hands_[index].fingers : Group{};
  palm_ = hands_[index].palm;
  grasp_.reset();
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::others_to_rest() {
  const std::string used = arm_.name;
  for (const Manipulator& other : hands_) {
    if (other.arm == nullptr || other.name == used) continue;
    const Vector off = RobotModel::part(snapshot_.set_point() - robot_->rest_posture(), *other.arm);
    if (off.cwiseAbs().maxCoeff() < kAtRest) continue;
    const std::optional<Grasp> grasp = grasp_;
    Outcome done = co_await use_arm(other.name);
    if (done.good) done = co_await go_to_rest();
    Outcome back = co_await use_arm(used);
    grasp_ = grasp;
    if (!done.good) co_return done;
    if (!back.good) co_return back;
  }
  co_return Outcome{};
}

Routine<ManipulationPlanner::RegraspSteps> ManipulationPlanner::ask_regrasp(const std::string& object_id, const Pose& T_world_goal,
                                                                            bool both) {
  status_.phase = both ? ActionPhase::choosing_two_grasps : ActionPhase::choosing_hands;
  RegraspRequest request;
  clients_.regrasp.open(request);
  request.object = object_id;
  request.start = snapshot_.set_point();
  request.T_world_goal = T_world_goal;
  request.both = both;
  request.seed = goal_.id;
  const bool answered = co_await clients_.regrasp.ask(request);
  RegraspSteps plan;
  if (!answered) {
    plan.outcome = Outcome::no_answer("grasp");
    co_return plan;
  }
  plan.steps = clients_.regrasp.reply()->steps;
  for (const auto& rejected : clients_.regrasp.reply()->rejected) refuse(rejected.what, rejected.reason);
  if (!clients_.regrasp.reply()->solved) plan.outcome = Outcome::failure(clients_.regrasp.reply()->reason);
  co_return plan;
}

std::vector<Pose> ManipulationPlanner::places_for(const ActionGoal& goal, const SceneObject& seen, const ObjectModel& model) const {
  if (goal.has_goal) return {goal.T_world_goal};
  const auto box =
      std::find_if(snapshot_.scene().boxes.begin(), snapshot_.scene().boxes.end(), [&](const SceneBox& b) { return b.id == goal.surface; });
  if (box == snapshot_.scene().boxes.end() || !box->supports) return {};
  std::vector<Vector3> shoulders;
  for (const Manipulator& m : hands_) {
    if (m.arm == nullptr || m.arm->axes.empty()) continue;
    const Axis& first = robot_->axes()[static_cast<std::size_t>(m.arm->axes.front())];
    const int link = robot_->joints()[static_cast<std::size_t>(first.joint)].child;
    shoulders.push_back((snapshot_.T_world_base() * robot_->link_pose(snapshot_.set_point(), link)).translation());
  }
  const Pose& now = seen.T_world_object;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::atan2(now.linear()(1, 0), now.linear()(0, 0)), Vector3::UnitZ()));
  const Eigen::AlignedBox3d extent = object_extent(&model, seen.primitive);
  const Vector3 half = extent.isEmpty() ? Vector3(Vector3::Zero()) : Vector3(0.5 * extent.sizes());
  const double apart = kApart + std::max(0.0, half.head<2>().maxCoeff() - kEdge);
  // Of a corner, in the frame of the surface.
  const auto inside = [&](const Vector3& at) {
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) {
        const Vector3 corner = box->T_world_box.inverse() * (at + turn * (extent.center() + Vector3(x * half.x(), y * half.y(), 0)));
        if (std::abs(corner.x()) > box->size.x() / 2 - kRim || std::abs(corner.y()) > box->size.y() / 2 - kRim) return false;
      }
    return true;
  };
  struct Place {
    Vector3 at;
    double off;
  };
  std::vector<Place> all;
  const double x_end = std::max(0.0, box->size.x() / 2 - kEdge), y_end = std::max(0.0, box->size.y() / 2 - kEdge);
  const bool both = goal.kind == ActionKind::carry;
  for (double x = -x_end; x <= x_end + 1e-9; x += kGrid) {
    for (double y = -y_end; y <= y_end + 1e-9; y += kGrid) {
      const Vector3 at = box->T_world_box * Vector3(x, y, box->size.z() / 2);
      const bool taken = std::any_of(snapshot_.scene().objects.begin(), snapshot_.scene().objects.end(), [&](const SceneObject& other) {
        return other.id != seen.id && (other.T_world_object.translation() - at).head<2>().norm() < apart;
      });
      if (taken || !inside(at)) continue;
      // Neither folded up nor stretched does an arm move well.
      double nearest = 1e9, farthest = 0;
      for (const Vector3& shoulder : shoulders) {
        const double off = std::abs((at - shoulder).norm() - kHandy);
        nearest = std::min(nearest, off);
        farthest = std::max(farthest, off);
      }
      all.push_back({at, both ? farthest : nearest});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Place& a, const Place& b) { return a.off < b.off; });
  std::vector<Pose> out;
  for (const Place& p : all) {
    const bool near =
        std::any_of(out.begin(), out.end(), [&](const Pose& o) { return (o.translation() - p.at).head<2>().norm() < kApart / 2; });
    if (near || out.size() >= kMostPlaces) continue;
    out.push_back(make_pose(p.at + model.height_above_support * Vector3::UnitZ(), turn));
  }
  return out;
}

Routine<Outcome> ManipulationPlanner::wait_standing(const std::string& object_id) {
  if (status_.holding) co_return Outcome::failure(attachment_.object + " is in the hand: it must be put down first");
  status_.phase = ActionPhase::looking_for_object;
  const bool seen =
      co_await waiting_.until([this, &object_id] { return snapshot_.object(object_id) != nullptr; }, settings_.sight_timeout());
  if (!seen) co_return Outcome::failure("object " + object_id + " is not in the scene");
  const auto stands = [this, &object_id] {
    const SceneObject* thing = snapshot_.object(object_id);
    return thing != nullptr && thing->holder != Holder::robot && thing->holder != Holder::human;
  };
  const bool free = co_await waiting_.until(stands, settings_.sight_timeout());
  if (!free) co_return Outcome::failure(object_id + " is held: it must stand first");
  if (snapshot_.model_of(object_id) == nullptr) co_return Outcome::failure("object " + object_id + " has no model");
  co_await waiting_.pause(settings_.settle_time());
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::regrasp(const ActionGoal& goal) {
  const std::string object_id = goal.object;
  Outcome stands = co_await wait_standing(object_id);
  if (!stands.good) co_return stands;
  RegraspSteps plan;
  plan.outcome = Outcome::failure(goal.surface.empty() ? "it was not said where " + object_id + " is to stand"
                                                       : "there is no free place on a surface called " + goal.surface);
  const std::vector<Pose> places = places_for(goal, *snapshot_.object(object_id), *snapshot_.model_of(object_id));
  for (const Pose& place : places) {
    plan = co_await ask_regrasp(object_id, place, false);
    if (plan.outcome.good) break;
  }
  if (!plan.outcome.good) co_return plan.outcome;
  Outcome alone = co_await rest_all();  // where the steps begin
  if (!alone.good) co_return alone;
  for (const RegraspStep& step : plan.steps) {
    Outcome done = co_await use_arm(step.kind == RegraspKind::pick ? step.to : step.from);
    if (!done.good) co_return done;
    switch (step.kind) {
      case RegraspKind::pick:
        done = co_await try_grasp(object_id, "", step.grasp);
        break;
      case RegraspKind::pass:
        if (&step != &plan.steps[1]) done = co_await make_room();
        if (!done.good) refuse("making room", done.reason);
        done = co_await pass(object_id, step);
        break;
      case RegraspKind::place:
        done = co_await put_down(object_id, step);
        if (!done.good && holds(object_id)) {  // the hand that passed it on may stand in the way
          refuse("put down", done.reason);
          done = co_await make_room();
          if (done.good) done = co_await put_down(object_id, step);
        }
        break;
      case RegraspKind::join:
        done = Outcome::failure("two hands at once were not asked for");
        break;
    }
    if (!done.good) co_return done;
  }
  Outcome rested = co_await rest_all();
  if (!rested.good) refuse("to rest", rested.reason);
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::rest_all() {
  // One arm's rest posture may be where another stands: who is in the way goes first.
  Outcome others = co_await others_to_rest();
  Outcome own = co_await go_to_rest();
  if (own.good && !others.good) others = co_await others_to_rest();
  if (!own.good) co_return own;
  co_return others;
}

/// To what the other hand holds, and closed on it; where it does not hold, the hand is opened again and off it.
Routine<Outcome> ManipulationPlanner::take_over(const std::string& object_id, const Grasp& grasp) {
  status_.phase = ActionPhase::opening_other_hand;
  HandResult open = co_await hand(HandAction::move, grasp.pregrasp_joints, settings_.hand_timeout());
  if (!open.outcome.good) co_return open.outcome;
  Motion approach;
  approach.phase = ActionPhase::approach_other_hand;
  approach.goals = {grasp.approach_joints};
  Outcome done = co_await move(approach);
  if (!done.good) co_return done;
  Motion reach_object;
  reach_object.phase = ActionPhase::reaching_object;
  reach_object.straight = true;
  reach_object.goals = {grasp.arm_joints};
  reach_object.allowed = {object_id};
  reach_object.speed = settings_.approach_speed();
  done = co_await move(reach_object);
  if (!done.good) co_return done;
  status_.phase = ActionPhase::grasp;
  HandResult closed = co_await hand(HandAction::grasp, grasp.hand_joints, settings_.hand_timeout(), &grasp.hand_effort);
  if (closed.outcome.good && closed.state == HandState::grasped) co_return Outcome{};
  HandResult reopened = co_await hand(HandAction::move, grasp.pregrasp_joints, settings_.hand_timeout());
  Motion back = reach_object;
  back.phase = ActionPhase::backing_off;
  back.goals = {grasp.approach_joints};
  Outcome backed = co_await move(back);
  if (!closed.outcome.good) co_return closed.outcome;
  co_return Outcome::failure("the other hand closed on nothing", ActionFailure::nothing_grasped);
}

/// The arm in use draws what it holds to its own side, so that the others can go to rest.
Routine<Outcome> ManipulationPlanner::make_room() {
  Outcome rested = co_await others_to_rest();
  if (rested.good) co_return rested;
  const Pose T_now = T_world_tool();
  const Eigen::Matrix3d base = snapshot_.T_world_base().linear();
  const double side = base.col(1).dot(p_world_shoulder() - snapshot_.T_world_base().translation()) < 0 ? -1 : 1;
  const std::vector<Vector3> ways{{0, 1, 0.3}, {0, 1, 0}, {0.5, 1, 0}, {-0.5, 1, 0}, {0, 0.3, 1}, {0, 1, -0.5}, {0.7, 0, 0.7}};
  for (const Vector3& way : ways) {
    std::optional<Vector> farthest;
    for (const double share : {0.15, 0.25, 0.35}) {
      Pose T = T_now;
      T.translation() += share * (base * Vector3(way.x(), side * way.y(), way.z()));
      if (auto joints = reach(T)) farthest = std::move(joints);
    }
    if (!farthest) continue;
    Motion draw;
    draw.phase = ActionPhase::making_room;
    draw.goals = {*farthest};
    draw.speed = settings_.carry_speed();
    Outcome drawn = co_await move(draw);
    if (!drawn.good) continue;
    rested = co_await others_to_rest();
    if (rested.good) co_return rested;
  }
  co_return rested;
}

Vector3 ManipulationPlanner::p_world_shoulder() const {
  const Axis& first = robot_->axes()[static_cast<std::size_t>(arm_.axes.front())];
  return (snapshot_.T_world_base() *
          robot_->link_pose(snapshot_.set_point(), robot_->joints()[static_cast<std::size_t>(first.joint)].child))
      .translation();
}

/// What the hand holds does not lie in it quite as planned: it is the object that goes to its place, or where both arms reach it near that.
std::optional<Vector> ManipulationPlanner::meeting_posture(const RegraspStep& step) const {
  const auto taker = std::find_if(hands_.begin(), hands_.end(), [&](const Manipulator& m) { return m.name == step.to; });
  if (taker == hands_.end() || taker->arm == nullptr) return std::nullopt;
  const Pose T_base_world = snapshot_.T_world_base().inverse();
  const Pose T_grasp_standoff = robot_->link_pose(step.q, taker->palm).inverse() * robot_->link_pose(step.before, taker->palm);
  IkOptions near_by;
  near_by.restarts = 0;
  for (const double off : {0.0, 0.02, 0.04}) {
    for (const Vector3& way :
         {Vector3(0, 0, -1), Vector3(-1, 0, 0), Vector3(0, 0, 1), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0)}) {
      Pose T_base_object = T_base_world * step.T_world_object;
      T_base_object.translation() += off * way;
      auto own = robot_->inverse(arm_, T_base_object * attachment_.T_tool_object.inverse(), step.q, near_by);
      const Pose T_base_hand = T_base_object * step.grasp.T_object_hand;
      const bool both = own && robot_->inverse(*taker->arm, T_base_hand, step.q, near_by) &&
                        robot_->inverse(*taker->arm, T_base_hand * T_grasp_standoff, step.before, near_by);
      if (both) return own;
      if (off == 0) break;
    }
  }
  return std::nullopt;
}

Routine<Outcome> ManipulationPlanner::pass(const std::string& object_id, const RegraspStep& step) {
  const std::optional<Vector> meeting = meeting_posture(step);
  if (!meeting) co_return Outcome::failure("the arms do not reach the place where " + object_id + " is to change hands");
  Motion bring;
  bring.phase = ActionPhase::carry_to_other_hand;
  bring.goals = {*meeting};
  bring.speed = settings_.carry_speed();
  Outcome done = co_await move(bring);
  if (!done.good) co_return done;

  done = co_await use_arm(step.to);
  if (!done.good) co_return done;
  std::optional<Grasp> grasp;
  for (int tries = 0; tries < kCloseTries; ++tries) {
    grasp = aimed(object_id, step.grasp);
    if (!grasp) co_return Outcome::failure("the other arm does not reach " + object_id + " where the first holds it");
    done = co_await take_over(object_id, *grasp);
    if (done.good) break;
    refuse("grasp by the other hand", done.reason);
  }
  if (!done.good) co_return done;
  co_await waiting_.pause(settings_.settle_time());
  const SceneObject* held = snapshot_.object(object_id);
  if (held == nullptr) co_return Outcome::failure("object " + object_id + " left the scene");
  hold(*held);

  done = co_await use_arm(step.from);
  if (!done.good) co_return done;
  status_.phase = ActionPhase::letting_go_first_hand;
  done = co_await let_go(object_id, step.q, step.after);
  if (!done.good) co_return done;
  done = co_await use_arm(step.to);
  if (!done.good) co_return done;
  grasp_ = grasp;
  const bool taken = co_await waiting_.until([this, &object_id] { return holds(object_id); }, settings_.settle_time());
  if (!taken) {
    release_object();
    co_return Outcome::failure("the other hand does not feel the load of " + object_id);
  }
  hold(*snapshot_.object(object_id));
  co_return Outcome{};
}

/// Opens the hand in use and leads it away as `after` is from `closed`, both of all axes.
Routine<Outcome> ManipulationPlanner::let_go(const std::string& object_id, const Vector& closed, const Vector& after) {
  HandResult opened = co_await hand(HandAction::release, RobotModel::part(after, fingers_), settings_.hand_timeout());
  if (!opened.outcome.good) co_return opened.outcome;
  if (attachment_.hand == hand_name()) release_object();
  const Pose T_off = robot_->link_pose(closed, palm_).inverse() * robot_->link_pose(after, palm_);
  std::string why = "no posture of the arm lies there";
  for (const double share : {1.0, 0.8, 0.6}) {
    Pose T = T_off;
    T.translation() *= share;
    const auto off = reach(T_world_tool() * T);
    if (!off) continue;
    Motion away;
    away.phase = ActionPhase::retreat;
    away.straight = true;
    away.goals = {*off};
    away.allowed = {object_id};
    away.speed = settings_.approach_speed();
    Outcome gone = co_await move(away);
    if (gone.good) co_return gone;
    why = gone.reason;
  }
  co_return Outcome::failure("the hand finds no straight way off " + object_id + ": " + why);
}

Routine<Outcome> ManipulationPlanner::put_down(const std::string& object_id, const RegraspStep& step) {
  if (!holds(object_id)) co_return Outcome::failure("the hand does not hold " + object_id);
  const Pose T_base_world = snapshot_.T_world_base().inverse(), T_object_tool = attachment_.T_tool_object.inverse();
  IkOptions options;
  options.restarts = 2;
  Pose T_world_object = step.T_world_object;
  T_world_object.translation().z() += kAbovePlace;
  const auto at = robot_->inverse(arm_, T_base_world * T_world_object * T_object_tool, step.q, options);
  if (!at) co_return Outcome::failure("the arm does not reach the place where " + object_id + " is to stand");
  std::optional<Vector> above;
  for (const double share : {1.0, 0.75}) {
    Pose T_above = T_world_object;
    T_above.translation().z() += share * settings_.lift_height();
    if (!above) above = robot_->inverse(arm_, T_base_world * T_above * T_object_tool, RobotModel::with(step.q, arm_, *at), options);
  }
  if (!above) co_return Outcome::failure("the arm does not reach above the place where " + object_id + " is to stand");
  PuttingPosture posture;
  posture.T_world_object = T_world_object;
  posture.arm_above = *above;
  posture.arm_at = *at;
  Outcome down = co_await lower(posture);
  if (!down.good) co_return down;
  down = co_await let_go(object_id, step.q, step.after);
  co_return down;
}

}  // namespace handsel::manipulation_planner
