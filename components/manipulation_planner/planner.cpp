#include "components/manipulation_planner/planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/messages/names.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kSameGoal = 1e-6;  // [rad]
constexpr double kAtHand = 0.15;    // [m] from the middle of a hand to that of what it takes hold of
constexpr double kSlipped = 0.2;    // what is this far from where the hand would have it is not in the hand [m]
constexpr double kSlipTime = 0.2;   // for so long [s]
constexpr double kForever = 600;    // [s] a motion this long has been forgotten by everybody
constexpr const char* kHands[] = {"l_hand", "r_hand"};
constexpr std::uint32_t kBlocked = 1U << static_cast<unsigned>(Cause::forecast_collision);
constexpr std::uint32_t kTooNear = (1U << static_cast<unsigned>(Cause::separation)) | (1U << static_cast<unsigned>(Cause::attention_slow));
constexpr double kStraight = 0.9;   // [rad] an axis turns less on a short straight motion; with more the tool swings around
constexpr double kCreeping = 0.04;  // of the speed: who is so near that it is slower does not get anywhere

}  // namespace

ManipulationPlanner::ManipulationPlanner(const config::ManipulationPlannerSettings& settings, std::shared_ptr<const RobotModel> robot,
                                         ObjectLibrary objects, std::uint64_t client, CostSettings cost)
    : settings_(settings),
      robot_(std::move(robot)),
      hands_(hands_of(*robot_)),
      arm_(robot_->require_group("arm")),
      palm_(robot_->tool_link()),
      way_out_(*robot_, arm_),
      live_pace_(settings.live_period(), settings.live_longest(), 0.0),
      clients_(client, outbox_, waiting_, settings_),
      worker_(outbox_, waiting_, settings_.request_timeout()),
      snapshot_(std::move(objects)),
      cost_(std::make_shared<HumanCost>(*robot_, cost)) {
  if (const Group* fingers = robot_->group("hand")) fingers_ = *fingers;
}

void ManipulationPlanner::on(const ActionGoal& goal) {
  if (goal.cancel) {
    if (goal.id != status_.id || status_.state != ActionState::running) return;
    drop_action();
    status_.state = ActionState::cancelled;
    status_.exchange_engaged = false;
    status_.failure = ActionFailure::cancelled;
    status_.reason = "cancelled on request";
    return;
  }
  if (goal.id == status_.id) return;
  drop_action();
  goal_ = goal;
  const bool holding = status_.holding;
  status_ = {};
  status_.id = goal.id;
  status_.task = goal.task;
  status_.kind = goal.kind;
  status_.object = goal.object;
  status_.human = goal.human;
  status_.state = ActionState::running;
  status_.holding = holding;
}

/// What it has asked for is wanted no more.
void ManipulationPlanner::drop_action() {
  if (action_ && snapshot_.active().trajectory != 0) {
    halt_.emplace();
    halt_->id = clients_.ids.next_command();
    halt_->robot = robot_->name();
    halted_at_ = {};
  }
  action_ = {};
  taken_up_ = {};
  at_offer_ = false;
  waiting_.clear();
  clients_.path.drop();
}

void ManipulationPlanner::on(const TrajectoryReply& reply) {
  clients_.trajectory.on(reply);
  clients_.comparison.on(reply);
}

void ManipulationPlanner::step(TimePoint now, Outbox& out) {
  too_near_ = snapshot_.execution() && (snapshot_.execution()->causes & kTooNear) != 0 && snapshot_.active().trajectory != 0 &&
              std::abs(snapshot_.active().speed_factor) < kCreeping;
  // An arm that stands has no collision ahead: it starts, and is held back again.
  if (snapshot_.execution() && (snapshot_.execution()->causes & kBlocked) != 0) held_back_at_ = now;
  const bool held_back = to_seconds(now - held_back_at_) <= settings_.blocked_pause();
  if (!too_near_ && !held_back) free_at_ = now;
  blocked_for_ = to_seconds(now - free_at_);
  waiting_.set_now(now);
  watch_offer();
  halt();
  if (clients_.path.take_dropped()) {
    PathRequest request;
    request.id = clients_.ids.newest_request();
    request.group = arm_.name;
    request.cancel = true;
    clients_.path.send(request);
  }
  if (status_.state == ActionState::running && !action_) {
    action_ = run(goal_);
    action_.start();
  } else {
    waiting_.poll(now);
  }
  if (!slipped()) held_at_ = now;
  if (action_ && !action_.done() && to_seconds(now - held_at_) > kSlipTime) lose_object();
  if (action_ && action_.done()) {
    const Outcome& outcome = action_.result();
    status_.state = outcome.good ? ActionState::succeeded : ActionState::failed;
    status_.failure = outcome.kind;
    status_.reason = outcome.reason;
    status_.exchange_engaged = false;
    taken_up_ = {};
    action_ = {};
  }
  if (!taken_up_.giver.empty()) status_.exchange_engaged = at_offer_ || still_offered();
  status_.time_to_exchange = time_to_exchange();
  outbox_.move_to(out);
}

bool ManipulationPlanner::in_hand(const SceneObject& held) const {
  const int hand = hand_index(hands_, attachment_.hand);
  if (hand < 0 || attachment_.object != held.id) return false;
  const Pose T_world_palm =
      snapshot_.T_world_base() * robot_->link_pose(snapshot_.set_point(), hands_[static_cast<std::size_t>(hand)].palm);
  return (held.T_world_object.translation() - T_world_palm * attachment_.T_tool_object.translation()).norm() < kSlipped;
}

/// What a hand holds has left it, and no person has it.
bool ManipulationPlanner::slipped() const {
  const SceneObject* held = attachment_.object.empty() ? nullptr : snapshot_.object(attachment_.object);
  if (held == nullptr || held->holder == Holder::robot || held->holder == Holder::human || snapshot_.set_point().size() != robot_->dof())
    return false;
  if (in_hand(*held)) return false;
  const Vector3& p = held->T_world_object.translation();
  return std::none_of(snapshot_.people().people.begin(), snapshot_.people().people.end(), [&](const Person& who) {
    return std::any_of(std::begin(kHands), std::end(kHands), [&](const char* name) {
      return (who.joints[static_cast<std::size_t>(body_joint_index(name))].position - p).norm() < 2 * kAtHand;
    });
  });
}

/// Said again until it is heard: at first the epoch may have changed.
void ManipulationPlanner::halt() {
  constexpr double kAgain = 0.1;  // [s]
  if (!halt_) return;
  const bool heard =
      snapshot_.execution() && snapshot_.execution()->trajectory == halt_->id && snapshot_.execution()->motion != MotionState::refused;
  if (heard || snapshot_.active().trajectory == 0) return halt_.reset();
  if (to_seconds(waiting_.now() - halted_at_) < kAgain) return;
  halted_at_ = waiting_.now();
  halt_->epoch = snapshot_.execution() ? snapshot_.execution()->epoch : 0;
  outbox_.trajectories.push_back(*halt_);
}

/// The action ends where the arm is.
void ManipulationPlanner::lose_object() {
  const std::string lost = attachment_.object;
  drop_action();
  release_object();
  halt();
  status_.state = ActionState::failed;
  status_.exchange_engaged = false;
  status_.failure = ActionFailure::other;
  status_.reason = lost + " slipped out of the hand (" + phase_text(status_) + ")";
}

/// What the running motion still takes at the pace it has now, and what usually comes after it.
double ManipulationPlanner::time_to_exchange() const {
  constexpr double kNever = std::numeric_limits<double>::infinity(), kSlowest = 0.05, kReachIn = 1.5, kClose = 0.5;
  if (status_.state != ActionState::running) return kNever;
  const bool gives = status_.kind == ActionKind::give, receives = status_.kind == ActionKind::receive;
  const ActionPhase phase = status_.phase;
  const bool engaged = receives && status_.exchange_engaged;
  if (gives && phase == ActionPhase::offer) return 0;
  if (engaged && phase == ActionPhase::waiting_for_release) return 0;
  if (receives && phase == ActionPhase::grasp) return kClose;
  const bool carries = gives && phase == ActionPhase::carry, reaches = phase == ActionPhase::reaching_object;
  const bool on_the_way = carries || (receives && (phase == ActionPhase::approach || reaches));
  if (!on_the_way || !snapshot_.execution() || snapshot_.execution()->motion != MotionState::running ||
      snapshot_.active().trajectory != snapshot_.execution()->trajectory)
    return kNever;
  const double left = std::max(0.0, snapshot_.active().rest.duration() - snapshot_.active().time) /
                      std::clamp(snapshot_.active().speed_factor, kSlowest, 1.0);
  return left + (phase == ActionPhase::approach ? kReachIn : 0.0) + (receives ? kClose : 0.0);
}

bool ManipulationPlanner::at_rest() const {
  return snapshot_.set_point().size() == robot_->dof() && snapshot_.active().velocity(arm_.axes).norm() < 1e-9;
}

Vector ManipulationPlanner::posture() const {
  Vector q = snapshot_.scene().robot_position;
  for (const int axis : arm_.axes) q[axis] = snapshot_.set_point()[axis];
  for (const Manipulator& other : hands_)
    if (other.arm != nullptr)
      for (const int axis : other.arm->axes) q[axis] = snapshot_.set_point()[axis];
  const bool opens = opens_to_ && snapshot_.execution() && hand_state() == HandState::moving;
  return opens ? RobotModel::with(q, fingers_, *opens_to_) : q;
}

bool ManipulationPlanner::may_move() const { return !halt_ && snapshot_.execution() && snapshot_.execution()->mode < Mode::hold; }

Pose ManipulationPlanner::T_world_tool() const { return snapshot_.T_world_base() * robot_->link_pose(snapshot_.set_point(), palm_); }

std::optional<Vector> ManipulationPlanner::reach(const Pose& T_world_tool) const {
  IkOptions options;
  options.restarts = 0;
  return robot_->inverse(arm_, snapshot_.T_world_base().inverse() * T_world_tool, snapshot_.set_point(), options);
}

void ManipulationPlanner::hold(const SceneObject& held) {
  attachment_.object = held.id;
  attachment_.hand = hand_name();
  attachment_.T_tool_object = T_world_tool().inverse() * held.T_world_object;
  status_.holding = true;
}

void ManipulationPlanner::release_object() {
  attachment_ = {};
  status_.holding = false;
}

void ManipulationPlanner::refuse(const std::string& what, const std::string& reason) {
  if (status_.refusals.size() < 32) status_.refusals.push_back({what, reason});
}

Routine<ManipulationPlanner::GraspList> ManipulationPlanner::ask_grasps(const std::string& object_id, const std::string& for_human,
                                                                        std::uint32_t most) {
  status_.phase = ActionPhase::choosing_grasp;
  GraspRequest request;
  clients_.grasp.open(request);
  request.object = object_id;
  request.start = snapshot_.set_point();
  request.for_human = for_human;
  request.max_grasps = most;
  request.seed = goal_.id;
  const bool answered = co_await clients_.grasp.ask(request);
  GraspList list;
  if (!answered) {
    list.outcome = Outcome::no_answer("grasp");
    co_return list;
  }
  list.grasps = clients_.grasp.reply()->grasps;
  for (const auto& rejected : clients_.grasp.reply()->rejected) refuse("grasps: " + rejected.what, rejected.reason);
  if (list.grasps.empty()) list.outcome = Outcome::failure("no grasp for " + object_id + ": " + clients_.grasp.reply()->reason);
  co_return list;
}

PathRequest ManipulationPlanner::path_request(const Vector& start, const Motion& motion) {
  PathRequest request;
  clients_.path.open(request);
  request.group = arm_.name;
  request.start = start;
  request.goals = motion.goals;
  request.attachment = attachment_;
  request.allowed_contacts = motion.allowed;
  request.time_limit = settings_.planning_time();
  request.seed = goal_.id + request.id.number;
  request.straight = motion.straight;
  return request;
}

Routine<ManipulationPlanner::PlannedPath> ManipulationPlanner::plan_path(const Vector& start, const Motion& motion) {
  const PathRequest request = path_request(start, motion);
  PlannedPath planned;
  const bool answered = co_await clients_.path.ask(request);
  if (!answered) {
    planned.outcome = Outcome::no_answer("path");
    co_return planned;
  }
  const PathReply& reply = *clients_.path.reply();
  planned.nodes = reply.path;
  double length = 0;
  for (std::size_t i = 1; i < planned.nodes.size(); ++i) length += (planned.nodes[i] - planned.nodes[i - 1]).cwiseAbs().maxCoeff();
  planned.start_touches = reply.start_touches;
  if (!reply.solved) planned.outcome = Outcome::failure(reply.reason);
  if (length > motion.longest) planned.outcome = Outcome::failure("only a long way around leads there");
  co_return planned;
}

TrajectoryRequest ManipulationPlanner::trajectory_request(TrajectoryClient& client, const std::vector<Vector>& nodes, const Vector& start,
                                                          const Motion& motion) {
  TrajectoryRequest request;
  client.open(request);
  request.group = arm_.name;
  request.nodes = nodes;
  request.start = start;
  request.attachment = attachment_;
  request.allowed_contacts = motion.allowed;
  request.speed_scale = motion.speed;
  return request;
}

TrajectoryCommand ManipulationPlanner::command_for(const Trajectory& trajectory, const Motion& motion) {
  TrajectoryCommand command;
  command.id = clients_.ids.next_command();
  command.epoch = snapshot_.execution()->epoch;
  command.robot = robot_->name();
  for (const int axis : arm_.axes) command.axes.push_back(static_cast<std::uint32_t>(axis));
  command.trajectory = trajectory;
  command.attachment = attachment_;
  command.allowed_contacts = motion.allowed;
  command.allowed_contacts.insert(command.allowed_contacts.end(), motion.tolerated.begin(), motion.tolerated.end());
  return command;
}

/// Until the controller has heard of it.
Routine<Outcome> ManipulationPlanner::send(const TrajectoryCommand& command) {
  const std::uint64_t id = command.id;
  for (int tries = 0; tries < 5; ++tries) {
    outbox_.trajectories.push_back(command);
    const bool heard = co_await waiting_.until([this, id] { return snapshot_.execution()->trajectory == id; }, 0.3);
    if (heard) co_return Outcome{};
  }
  co_return Outcome::failure("the trajectory controller does not acknowledge the trajectory");
}

Routine<Outcome> ManipulationPlanner::execute(const std::vector<Vector>& nodes, Motion& motion) {
  const TrajectoryRequest request = trajectory_request(clients_.trajectory, nodes, posture(), motion);
  const bool answered = co_await clients_.trajectory.ask(request);
  if (!answered) co_return Outcome::no_answer("trajectory");
  if (!clients_.trajectory.reply()->solved) co_return Outcome::failure(clients_.trajectory.reply()->reason);
  for (const auto& corner : clients_.trajectory.reply()->corners) refuse(corner.what, corner.reason);

  const TrajectoryCommand command = command_for(clients_.trajectory.reply()->trajectory, motion);
  Outcome heard = co_await send(command);
  if (!heard.good) co_return heard;
  Running running{command.id, command.trajectory.duration(), nodes, clients_.trajectory.reply()->speeds};
  const Running* now = &running;
  const auto ended = [this, now] {
    return snapshot_.execution()->trajectory != now->command ||
           (snapshot_.execution()->motion != MotionState::running && snapshot_.execution()->motion != MotionState::idle);
  };
  const Motion* moving = &motion;
  const TimePoint began = waiting_.now();
  free_at_ = began;
  held_back_at_ = {};
  const auto late = [this, began, moving] { return to_seconds(waiting_.now() - began) > moving->patience; };
  const auto over = [this, ended, late, moving] {
    return ended() || late() || blocked_for_ > settings_.blocked_timeout() || strayed(*moving) || takes_hold(moving->yields_to) ||
           room_is_made(*moving);
  };
  const bool live = settings_.live_period() > 0 && !motion.straight;
  for (bool done = false; !done;) {
    done = co_await waiting_.until(over, live ? live_pace_.period(waiting_.now()) : kForever);
    if (done || !live) break;
    if (!motion.receiver.empty()) co_await follow(motion, running.nodes.back());
    const std::optional<Vector3> shifted_to = motion.follows ? follow_offer(motion) : std::nullopt;
    Outcome gone_on = co_await go_on(running, motion);
    if (shifted_to && (running.nodes.back() - motion.goals.front()).norm() < kSameGoal)
      motion.p_world_aim = status_.exchange_point = *shifted_to;
  }
  if (!ended()) {
    const bool taken = takes_hold(motion.yields_to), room_made = room_is_made(motion);
    Outcome blocked = Outcome::failure(taken             ? motion.yields_to + " takes hold of " + attachment_.object
                                       : strayed(motion) ? motion.aims_at + " was moved away"
                                                         : "the way is blocked: " + snapshot_.execution()->reason);
    if (taken)
      blocked.end = MotionEnd::taken;
    else if (strayed(motion))
      blocked.end = motion.follows && comes_on(taken_up_.giver) ? MotionEnd::giver_approached : MotionEnd::target_moved;
    else if (late())
      blocked.end = MotionEnd::late;
    else if (too_near_)
      blocked.end = MotionEnd::person_too_near;
    co_await stop_motion();
    if (room_made) co_return Outcome{};
    co_return blocked;
  }
  Outcome end = co_await end_motion(running.command);
  co_return end;
}

Routine<Outcome> ManipulationPlanner::end_motion(std::uint64_t command) {
  if (snapshot_.execution()->trajectory != command) {
    if (snapshot_.active().trajectory != 0) co_await stop_motion();
    co_return Outcome::failure("the trajectory controller lost the trajectory");
  }
  if (snapshot_.execution()->motion == MotionState::refused)
    co_return Outcome::failure("trajectory refused: " + snapshot_.execution()->reason);
  if (snapshot_.execution()->motion != MotionState::finished)
    co_return Outcome::failure("stopped on the way: " + snapshot_.execution()->reason);
  co_await waiting_.until([this] { return at_rest(); }, 1.0);
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::stop_motion() {
  constexpr int kMaxTries = 5;
  constexpr double kPause = 0.3;  // [s] between tries
  TrajectoryCommand stop;
  stop.id = clients_.ids.next_command();
  stop.epoch = snapshot_.execution()->epoch;
  stop.robot = robot_->name();
  for (int tries = 0; tries < kMaxTries && snapshot_.execution()->trajectory != stop.id; ++tries) {
    outbox_.trajectories.push_back(stop);
    co_await waiting_.pause(kPause);
  }
  co_return Outcome{};
}

Outcome ManipulationPlanner::not_permitted() const {
  const std::string why = snapshot_.execution() ? snapshot_.execution()->reason : "the controller is silent";
  return Outcome::failure("no permission to move: " + why, ActionFailure::not_permitted);
}

Routine<Outcome> ManipulationPlanner::move(const Motion& asked) {
  Outcome last;
  Motion motion = asked;
  for (std::uint32_t attempt = 0; attempt < settings_.motion_attempts(); ++attempt) {
    status_.phase = motion.phase;
    const bool ready = co_await waiting_.until([this] { return may_move() && at_rest(); }, settings_.permission_timeout());
    if (!ready) co_return not_permitted();
    const Vector start = posture();
    PlannedPath planned = co_await plan_path(start, motion);
    if (planned.outcome.good) {
      last = co_await execute(planned.nodes, motion);
      if (last.good || last.is_final()) co_return last;
      const Person* in_the_way = last.end == MotionEnd::person_too_near ? snapshot_.person("") : nullptr;
      if (in_the_way != nullptr) {
        refuse(text_of(motion.phase), last.reason);
        const std::string who = in_the_way->id;
        Outcome freed = co_await withdraw(who, motion);
        if (freed.good) continue;
        last.reason += "; " + freed.reason;
      }
    } else {
      last = planned.outcome;
      if (snapshot_.is_lost(planned.start_touches)) {
        refuse(text_of(motion.phase), last.reason);
        const std::string who = planned.start_touches;
        co_await waiting_.until([this, &who] { return !snapshot_.is_lost(who); }, settings_.permission_timeout());
        continue;
      }
      if (!planned.start_touches.empty()) {
        refuse(text_of(motion.phase), last.reason);
        Outcome freed = co_await withdraw(planned.start_touches, motion);
        if (freed.good) continue;
        last.reason += "; " + freed.reason;
      }
    }
    refuse(text_of(motion.phase), last.reason);
    co_await waiting_.pause(0.3);
  }
  co_return last;
}

bool ManipulationPlanner::at_hand_of(const std::string& who, const std::string& object_id) const {
  const SceneObject* thing = snapshot_.object(object_id);
  const Person* them = snapshot_.person(who);
  return thing != nullptr && them != nullptr && std::any_of(std::begin(kHands), std::end(kHands), [&](const char* hand) {
           const Vector3& p = them->joints[static_cast<std::size_t>(body_joint_index(hand))].position;
           return (p - thing->T_world_object.translation()).norm() < kAtHand;
         });
}

bool ManipulationPlanner::takes_hold(const std::string& who) const {
  const SceneObject* held = who.empty() || attachment_.object.empty() ? nullptr : snapshot_.object(attachment_.object);
  return held != nullptr && held->holder != Holder::surface && at_hand_of(who, held->id);
}

std::vector<Vector3> ManipulationPlanner::ways_out(const std::string& touched) const {
  const Pose T_tool = T_world_tool();
  const Vector3 p_tool = T_tool.translation();
  Vector3 from = p_tool + T_tool.linear().col(2);
  if (const Person* who = snapshot_.person(touched))
    from = who->joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  else if (const SceneObject* thing = snapshot_.object(touched))
    from = thing->T_world_object.translation();
  Vector3 level = p_tool - from;
  level.z() = 0;
  if (level.norm() < 1e-3) level = snapshot_.T_world_base().translation() - p_tool;
  level.z() = 0;
  level.normalize();
  const Vector3 up = Vector3::UnitZ(), aside = up.cross(level), hand_back = -T_tool.linear().col(2);
  return {hand_back,
          level,
          (level + up).normalized(),
          up,
          (level - up).normalized(),
          (level + aside).normalized(),
          (level - aside).normalized()};
}

Routine<Outcome> ManipulationPlanner::withdraw(const std::string& touched, const Motion& next) {
  Motion out;
  out.phase = ActionPhase::drawing_back;
  out.straight = true;
  out.speed = settings_.approach_speed();
  out.allowed = next.allowed;
  out.allowed.push_back(touched);
  const Vector start = posture();
  std::vector<Vector> goals = way_out_.steps_away(start, snapshot_.T_world_base(), snapshot_.people(), 1.5 * settings_.retreat_distance());
  std::reverse(goals.begin(), goals.end());
  for (const double share : {0.5, 1.0, 1.5}) {
    for (const Vector3& way : ways_out(touched)) {
      Pose T = T_world_tool();
      T.translation() += share * settings_.retreat_distance() * way;
      if (const auto joints = reach(T)) goals.push_back(*joints);
    }
  }
  std::stable_partition(goals.begin(), goals.end(), [&](const Vector& goal) {
    return way_out_.leads_away(start, RobotModel::with(start, arm_, goal), snapshot_.T_world_base(), snapshot_.people());
  });
  for (const Vector& goal : goals) {
    const Vector clear = RobotModel::with(start, arm_, goal);
    out.goals = {goal};
    PlannedPath first = co_await plan_path(start, out);
    if (!first.outcome.good) continue;
    PlannedPath then = co_await plan_path(clear, next);
    if (!then.outcome.good) continue;
    status_.phase = out.phase;
    Outcome outcome = co_await execute(first.nodes, out);
    co_return outcome;
  }
  co_return Outcome::failure("no straight way leads off " + touched);
}

Routine<Outcome> ManipulationPlanner::tell_hand(HandAction action, const Vector& position, const Vector* effort, double share_of_mass) {
  HandCommand command;
  command.id = clients_.ids.next_command();
  command.robot = robot_->name();
  command.group = hand_name();
  command.action = action;
  command.position = position;
  if (effort != nullptr) command.effort = *effort;
  command.pull_force = settings_.pull_force();
  if (const ObjectModel* grasped = snapshot_.model_of(status_.object); action == HandAction::grasp && grasped != nullptr)
    command.payload = share_of_mass * grasped->mass;
  const std::uint64_t id = command.id;
  bool heard = false;
  for (int tries = 0; tries < 20 && !heard; ++tries) {
    const bool ready = co_await waiting_.until([this] { return may_move(); }, settings_.permission_timeout());
    if (!ready) break;
    command.epoch = snapshot_.execution()->epoch;
    outbox_.hand_commands.push_back(command);
    heard = co_await waiting_.until([this, id] { return snapshot_.execution()->hand_command == id && hand_state() != HandState::refused; },
                                    0.3);
  }
  opens_to_.reset();
  if (heard && action == HandAction::move) opens_to_ = position;
  if (!heard)
    co_return Outcome::failure("hand command not accepted: " +
                               (snapshot_.execution() ? snapshot_.execution()->reason : "the controller is silent"));
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::hand_opened() {
  const bool open = co_await waiting_.until([this] { return hand_state() != HandState::moving; }, settings_.hand_timeout());
  co_return open ? Outcome{} : Outcome::failure("the hand does not open");
}

Routine<ManipulationPlanner::HandResult> ManipulationPlanner::hand(HandAction action, const Vector& position, double timeout,
                                                                   const Vector* effort, double share_of_mass) {
  HandResult result;
  result.outcome = co_await tell_hand(action, position, effort, share_of_mass);
  if (!result.outcome.good) co_return result;
  const std::uint64_t id = snapshot_.execution()->hand_command;
  const bool ended = co_await waiting_.until(
      [this, id] { return snapshot_.execution()->hand_command != id || hand_state() != HandState::moving; }, timeout);
  const bool waits_for_pull = action == HandAction::release_on_pull;
  if (ended && waits_for_pull)
    co_await waiting_.until([this, id] { return snapshot_.execution()->hand_command != id || hand_state() == HandState::released; },
                            timeout);
  if (snapshot_.execution()->hand_command != id) result.outcome = Outcome::failure("the controller lost the hand command");
  if (!ended) result.outcome = Outcome::failure("the hand does not come to an end");
  result.state = hand_state();
  co_return result;
}

Routine<Outcome> ManipulationPlanner::retreat(const std::string& allowed_person, const std::string& object_id) {
  const Pose T_now = T_world_tool();
  Vector3 back = -Vector3::UnitZ();  // tool frame
  if (grasp_) {
    const Pose T_root_grasp = robot_->link_pose(RobotModel::with(snapshot_.set_point(), arm_, grasp_->arm_joints), palm_);
    const Pose T_root_standoff = robot_->link_pose(RobotModel::with(snapshot_.set_point(), arm_, grasp_->approach_joints), palm_);
    back = (T_root_grasp.inverse() * T_root_standoff).translation();
  } else if (const SceneObject* left = snapshot_.object(object_id)) {
    back = -(T_now.inverse() * left->T_world_object.translation());
  }
  const Vector3 away = T_now.linear() * back.normalized();
  Motion motion;
  motion.phase = ActionPhase::retreat;
  motion.straight = true;
  motion.allowed = {object_id};
  if (!allowed_person.empty()) motion.allowed.push_back(allowed_person);
  std::string why = "no posture of the arm lies there";
  for (const double share : {1.0, 0.75, 0.5, 0.3}) {
    Pose T = T_now;
    T.translation() += share * settings_.retreat_distance() * away;
    if (auto joints = reach(T); joints && (*joints - RobotModel::part(snapshot_.set_point(), arm_)).cwiseAbs().maxCoeff() < kStraight) {
      motion.goals = {*joints};
      Outcome outcome = co_await move(motion);
      if (outcome.good) co_return outcome;
      why = outcome.reason;
    }
  }
  co_return Outcome::failure("the hand finds no straight way back from " + object_id + ": " + why);
}

Routine<Outcome> ManipulationPlanner::run(ActionGoal goal) {
  status_.phase = ActionPhase::waiting_for_scene;
  const bool known = co_await waiting_.until(
      [this] { return snapshot_.scene().robot_known && snapshot_.execution() && snapshot_.set_point().size() == robot_->dof(); }, 10.0);
  if (!known) co_return Outcome::failure("no scene or no controller state has come");
  if (const SceneObject* held = snapshot_.object(goal.object); held != nullptr && held->holder == Holder::robot) {
    const int by = hand_index(hands_, held->holder_id);
    Outcome ready = co_await use_arm(by < 0 ? arm_.name : hands_[static_cast<std::size_t>(by)].name);
    if (!ready.good) co_return ready;
    held = snapshot_.object(goal.object);
    if (held == nullptr) co_return Outcome::failure("object " + goal.object + " left the scene");
    if (attachment_.object != held->id) {
      grasp_.reset();
      hold(*held);
    }
  } else if (attachment_.object == goal.object && !(held != nullptr && in_hand(*held) && hand_state() == HandState::grasped)) {
    release_object();  // and not while a person takes hold of it, too
  }
  if (attachment_.object.empty() && hand_ != 0) {
    Outcome ready = co_await use_arm(hands_.front().name);
    if (!ready.good) co_return ready;
  }
  Outcome outcome;
  switch (goal.kind) {
    case ActionKind::pick:
      outcome = co_await pick(goal.object, goal.human, goal.surface);
      break;
    case ActionKind::give:
      outcome = co_await give(goal.object, goal.human);
      break;
    case ActionKind::place:
      outcome = co_await place(goal.object, goal.surface);
      break;
    case ActionKind::go_to:
      outcome = co_await rest_all();
      break;
    case ActionKind::receive:
      outcome = co_await receive(goal.object, goal.human, goal.surface);
      break;
    case ActionKind::regrasp:
    case ActionKind::carry:
      if (hands_.size() < 2)
        outcome = Outcome::failure(std::string(name(goal.kind)) + " needs two hands, robot " + robot_->name() + " has one");
      else if (goal.kind == ActionKind::regrasp)
        outcome = co_await regrasp(goal);
      else
        outcome = co_await carry(goal);
      break;
  }
  co_return outcome;
}

}  // namespace handsel::manipulation_planner
