// Two hands at once on what is too heavy for one, a closed chain: up, over and down, level on the way.
#include <algorithm>

#include "common/messages/names.hpp"
#include "common/model/srs_arm.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {

namespace {

constexpr double kMostTilt = 0.05;  // of what is carried, as planned [rad]
constexpr double kTogether = 0.5;   // speed scale of two arms in a closed chain
constexpr double kSame = 0.004;     // what moved less stands where it was planned to be taken [m]
constexpr int kTries = 2;           // to take hold of it
constexpr double kForever = 600;    // [s]

}  // namespace

Routine<Outcome> ManipulationPlanner::carry(const ActionGoal& goal) {
  const std::string object_id = goal.object;
  Outcome stands = co_await wait_standing(object_id);
  if (!stands.good) co_return stands;
  Outcome rested = co_await rest_all();
  if (!rested.good) co_return rested;

  RegraspSteps plan;
  plan.outcome = Outcome::failure("there is no free place on a surface called " + goal.surface);
  const std::vector<Pose> places = places_for(goal, *snapshot_.object(object_id), *snapshot_.model_of(object_id));
  for (const Pose& place : places) {
    plan = co_await ask_regrasp(object_id, place, true);
    if (plan.outcome.good) break;
  }
  if (!plan.outcome.good) co_return plan.outcome;
  if (plan.steps.size() != 3) co_return Outcome::failure("the grasp planner did not say how two hands take " + object_id);
  const RegraspStep first = plan.steps[0], second = plan.steps[1], down = plan.steps[2];

  Outcome done;
  const std::vector<const RegraspStep*> backwards{&second, &first};
  for (int tries = 0; tries < kTries; ++tries) {
    done = co_await take_together(object_id, first, second);
    if (done.good) break;
    refuse("grasp with both hands", done.reason);
    for (const RegraspStep* step : backwards) {
      Outcome off = co_await use_arm(step->to);
      HandResult opened = co_await hand(HandAction::move, step->grasp.pregrasp_joints, settings_.hand_timeout());
      if (off.good && opened.outcome.good) {
        Motion back;
        back.phase = ActionPhase::backing_off;
        back.straight = true;
        back.goals = {step->grasp.approach_joints};
        back.allowed = {object_id};
        off = co_await move(back);
      }
      if (!off.good) refuse("backing off", off.reason);
    }
  }
  if (!done.good) co_return done;
  done = co_await use_arm(first.to);
  if (!done.good) co_return done;
  status_.phase = ActionPhase::lift;
  const auto raised = [this](Pose T, double by) {
    T.translation().z() += by;
    return T;
  };
  const Pose T_start = snapshot_.object(object_id)->T_world_object;
  std::vector<Pose> up{raised(T_start, settings_.lift_height())};
  done = co_await move_together(object_id, second.to, up);
  if (done.good) {
    status_.phase = ActionPhase::carry;
    std::vector<Pose> over{raised(down.T_world_object, settings_.lift_height()), raised(down.T_world_object, kAbovePlace)};
    done = co_await move_together(object_id, second.to, over);
  }
  // Where it cannot go up or over it goes back down; hands that cannot bring it down keep it.
  const SceneObject* now = snapshot_.object(object_id);
  const bool off_the_ground = now == nullptr || now->T_world_object.translation().z() > T_start.translation().z() + kSame;
  if (!done.good && off_the_ground) {
    refuse(text_of(status_.phase), done.reason);
    status_.phase = ActionPhase::put_back;
    std::vector<Pose> back{raised(T_start, kAbovePlace)};
    Outcome lowered = co_await move_together(object_id, second.to, back);
    if (!lowered.good) co_return lowered;
  }
  // Off as they came: what each hand's stand-off is from its grasp holds wherever it was put down.
  const Outcome carried = done;
  const std::vector<std::string> arms{first.to, second.to};
  for (const std::string& arm : arms) {
    done = co_await use_arm(arm);
    if (!done.good) co_return done;
    status_.phase = ActionPhase::letting_go;
    HandResult opened = co_await hand(HandAction::release, RobotModel::part(down.after, fingers_), settings_.hand_timeout());
    if (!opened.outcome.good) co_return opened.outcome;
  }
  release_object();
  for (const std::string& arm : arms) {
    done = co_await use_arm(arm);
    if (done.good) done = co_await let_go(object_id, down.q, down.after);
    if (!done.good) co_return done;
  }
  done = co_await rest_all();
  if (!done.good) refuse("to rest", done.reason);
  co_return carried;
}

/// Both hands open about their grasps, then one after the other closed.
Routine<Outcome> ManipulationPlanner::take_together(const std::string& object_id, const RegraspStep& first, const RegraspStep& second) {
  const std::vector<const RegraspStep*> steps{&first, &second};
  for (const RegraspStep* step : steps) {
    Outcome done = co_await use_arm(step->to);
    if (!done.good) co_return done;
    std::optional<Grasp> grasp = aimed(object_id, step->grasp);
    const SceneObject* thing = snapshot_.object(object_id);
    const bool as_planned = thing != nullptr && (thing->T_world_object.translation() - step->T_world_object.translation()).norm() < kSame;
    if (!grasp && as_planned) grasp = step->grasp;  // at the end of a joint's range only the place as it was seen then is reached
    if (!grasp) co_return Outcome::failure(step->to + " does not reach " + object_id + " where it stands now");
    status_.phase = ActionPhase::opening_hand;
    HandResult open = co_await hand(HandAction::move, grasp->pregrasp_joints, settings_.hand_timeout());
    if (!open.outcome.good) co_return open.outcome;
    Motion approach;
    approach.phase = ActionPhase::approach;
    approach.goals = {grasp->approach_joints};
    done = co_await move(approach);
    if (!done.good) co_return done;
    Motion reach_object;
    reach_object.phase = ActionPhase::reaching_object;
    reach_object.straight = true;
    reach_object.goals = {grasp->arm_joints};
    reach_object.allowed = {object_id};
    reach_object.speed = settings_.approach_speed();
    done = co_await move(reach_object);
    if (!done.good) co_return done;
  }
  for (const RegraspStep* step : steps) {
    Outcome done = co_await use_arm(step->to);
    if (done.good) done = co_await grip(step->grasp, 0.5);
    if (!done.good) co_return done;
  }
  co_await waiting_.pause(settings_.settle_time());
  Outcome done = co_await use_arm(first.to);
  if (!done.good) co_return done;
  const SceneObject* held = snapshot_.object(object_id);
  if (held == nullptr) co_return Outcome::failure("object " + object_id + " left the scene");
  hold(*held);
  grasp_ = first.grasp;
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::grip(const Grasp& grasp, double share_of_mass) {
  status_.phase = ActionPhase::grasp;
  HandResult closed = co_await hand(HandAction::grasp, grasp.hand_joints, 2 * settings_.hand_timeout(), &grasp.hand_effort, share_of_mass);
  if (!closed.outcome.good) co_return closed.outcome;
  if (closed.state != HandState::grasped)
    co_return Outcome::failure("the hand " + fingers_.name + " closed on nothing", ActionFailure::nothing_grasped);
  co_return Outcome{};
}

Routine<Outcome> ManipulationPlanner::move_together(const std::string& object_id, const std::string& follower,
                                                    const std::vector<Pose>& T_world_object) {
  const auto other = std::find_if(hands_.begin(), hands_.end(), [&](const Manipulator& m) { return m.name == follower; });
  if (other == hands_.end()) co_return Outcome::failure("there is no arm " + follower);
  const bool ready = co_await waiting_.until([this] { return may_move() && at_rest(); }, settings_.permission_timeout());
  if (!ready) co_return not_permitted();
  Motion together;
  together.allowed = {object_id};
  together.speed = kTogether;
  const Vector start = posture();
  TrajectoryRequest request = trajectory_request(clients_.trajectory, {}, start, together);
  // The whole way was looked at with the elbow where it is.
  const ik::Chain chain(*robot_, arm_, start);
  const std::optional<ik::SrsArm> srs = ik::SrsArm::recognise(chain);
  for (const Pose& T : T_world_object) {
    TipNode node;
    node.T_world_tip = T * attachment_.T_tool_object.inverse();
    node.has_elbow = srs.has_value();
    if (srs) node.elbow = srs->elbow_angle(RobotModel::part(start, arm_));
    request.poses.push_back(node);
  }
  request.follower = follower;
  request.T_tip_follower = robot_->link_pose(start, palm_).inverse() * robot_->link_pose(start, other->palm);
  request.upright = true;
  request.upright_axis = attachment_.T_tool_object.linear() * Vector3::UnitZ();
  request.most_tilt = kMostTilt;
  const bool answered = co_await clients_.trajectory.ask(request);
  if (!answered) co_return Outcome::no_answer("trajectory");
  if (!clients_.trajectory.reply()->solved) co_return Outcome::failure("both hands together: " + clients_.trajectory.reply()->reason);
  TrajectoryCommand command = command_for(clients_.trajectory.reply()->trajectory, together);
  command.axes = clients_.trajectory.reply()->axes;
  Outcome run = co_await run_to_end(command);
  co_return run;
}

Routine<Outcome> ManipulationPlanner::run_to_end(const TrajectoryCommand& command) {
  Outcome heard = co_await send(command);
  if (!heard.good) co_return heard;
  const std::uint64_t id = command.id;
  co_await waiting_.until(
      [this, id] {
        return snapshot_.execution()->trajectory != id ||
               (snapshot_.execution()->motion != MotionState::running && snapshot_.execution()->motion != MotionState::idle);
      },
      kForever);
  Outcome end = co_await end_motion(id);
  co_return end;
}

}  // namespace handsel::manipulation_planner
