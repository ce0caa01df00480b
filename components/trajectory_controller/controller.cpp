#include "components/trajectory_controller/controller.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/errors.hpp"
#include "common/model/human/body_index.hpp"
#include "common/trajectory/edit.hpp"
#include "common/trajectory/stop.hpp"

namespace handsel::trajectory_controller {

namespace {

constexpr double kStopSlack = 0.05;   // [s] after detection and the fastest stop the robot rests
constexpr double kRobotGone = 0.5;    // [s] without a sample: what comes then may be another robot side, somewhere else
constexpr double kGuardSlack = 0.02;  // [s] likewise when the guard asks for less speed: the rest is the person's

HandAxes axes_of(const RobotModel& robot, const Group* fingers) {
  HandAxes hand;
  if (fingers == nullptr) return hand;
  for (int axis : fingers->axes) {
    const Axis& bounds = robot.axes()[static_cast<std::size_t>(axis)];
    const Joint& joint = robot.joints()[static_cast<std::size_t>(bounds.joint)];
    hand.axes.push_back(axis);
    hand.lower.push_back(bounds.lower);
    hand.upper.push_back(bounds.upper);
    hand.sliding.push_back(joint.kind == JointKind::prismatic);
  }
  return hand;
}

/// All axes but those of hands and head.
std::vector<int> trajectory_axes(const RobotModel& robot) {
  std::vector<char> other(static_cast<std::size_t>(robot.dof()), 0);
  const auto leave_out = [&](const Group* group) {
    if (group == nullptr) return;
    for (int axis : group->axes) other[static_cast<std::size_t>(axis)] = 1;
  };
  for (const Manipulator& hand : hands_of(robot)) leave_out(hand.fingers);
  leave_out(robot.group("head"));
  std::vector<int> axes;
  for (int i = 0; i < robot.dof(); ++i)
    if (!other[static_cast<std::size_t>(i)]) axes.push_back(i);
  return axes;
}

void require(bool good, const char* sentence) {
  if (!good) throw ConfigError(std::string("trajectory_controller: ") + sentence);
}

}  // namespace

Controller::Controller(const ControllerSettings& settings, std::shared_ptr<const RobotModel> robot)
    : settings_(settings),
      robot_(std::move(robot)),
      capsules_(robot_capsules(*robot_)),
      head_room_(*robot_),
      part_(static_cast<std::size_t>(robot_->dof()), Part::arm),
      runner_(settings.period),
      movers_(static_cast<std::size_t>(robot_->dof())),
      contact_(settings.contact, trajectory_axes(*robot_)),
      reference_(trajectory_axes(*robot_), robot_->dof()),
      modes_(settings.timeouts),
      proof_(settings.proof, *robot_, robot_capsules(*robot_)),
      reach_limit_(proof_),
      finger_limit_(proof_, *robot_),
      stop_space_(settings.view, proof_, *robot_) {
  require(settings.period > 0 && settings.period <= 0.02, "period must be above 0 and at most 0.02 s");
  require(settings.start_tolerance >= 0, "start_tolerance must not be negative");
  require(settings.forecast_slow > settings.forecast_hold, "forecast_slow must be above forecast_hold");
  require(settings.cost_from >= 0 && settings.cost_from < 1, "cost_from must be in [0, 1)");
  require(settings.late_limit > 0, "late_limit must be above 0");
  for (const Wall& wall : settings.walls) require(std::abs(wall.normal.norm() - 1.0) < 1e-6, "the normal of a wall must have length 1");
  const int n = robot_->dof();
  const auto mark = [&](const Group* group, Part part) {
    if (group == nullptr) return;
    for (int axis : group->axes) part_[static_cast<std::size_t>(axis)] = part;
  };
  for (const Manipulator& hand : hands_of(*robot_)) {
    mark(hand.fingers, Part::hand);
    HandExecutor executor(settings.hand, axes_of(*robot_, hand.fingers), robot_->comfort_limits(), robot_->stop_limits());
    hands_.push_back({hand.fingers != nullptr ? hand.fingers->name : "hand", hand.palm, std::move(executor)});
  }
  other_payloads_ = Vector::Zero(hands_.empty() ? 0 : static_cast<Eigen::Index>(hands_.size()) - 1);
  mark(robot_->group("head"), Part::head);
  arm_axes_ = trajectory_axes(*robot_);
  if (const Group* head = robot_->group("head")) head_axes_ = head->axes;
  head_target_.assign(head_axes_.size(), 0.0);
  set_point_ = rest_state(Vector::Zero(n));
  effort_ = Vector::Zero(n);
  next_ = set_point_;
  finger_speeds_ = full_velocity_ = full_acceleration_ = posture_ = Vector::Zero(n);
  yield_from_ = away_ = measured_before_ = adopted_ = Vector::Zero(n);
  robot_->forward(posture_, links_);
  link_twists(*robot_, full_velocity_, links_, twists_);
}

void Controller::on(const RobotState& state, TimePoint sampled, Duration age, bool new_writer) {
  const auto n = static_cast<Eigen::Index>(robot_->dof());
  if (state.robot != robot_->name() || state.position.size() != n || !state.position.allFinite()) return;
  const double since = robot_seen_.ever ? std::clamp(to_seconds(sampled - robot_seen_.at), 0.0, 0.1) : 0.0;
  touch_ = contact_.update(state.external_torque, since, arm_ == Arm::standing, !exchanging_.empty());
  const bool restarted =
      robot_seen_.ever && (new_writer || (state.sequence < state_.sequence && to_seconds(sampled - robot_seen_.at) > kRobotGone));
  state_ = state;
  gate_.hear(state.mode);
  robot_seen_.mark(sampled);
  new_state_ = true;
  constexpr Duration kFresh = std::chrono::milliseconds(50);  // older ones waited while this process slept
  if (asleep_ && age < kFresh) {
    asleep_ = false;
    ready_ = follows();
  }
  if (ready_ && !restarted) return;
  // The posture of a robot side that has just come up is the first set-point.
  ready_ = true;
  const bool at_reference = !settings_.dry_run && reference_.reported(state);
  const Vector& posture = at_reference ? state.reference.position : state.position;
  set_point_ = rest_state(posture);
  for (Eigen::Index i = 0; i < n; ++i) set_point_.position[i] = inside(static_cast<int>(i), posture[i]);
  next_ = set_point_;
  if (arm_ == Arm::running || rejoin_) give_up_path();
  stand_arm();
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    // What is held stays held: a new controller grips as the one before.
    hands_[i].executor.reset(set_point_.position, at_reference ? state.reference.effort : Vector());
    hands_[i].payload = hands_[i].grasped_payload = at_reference ? held_payload(state.reference, i) : 0.0;
  }
  for (int axis : head_axes_) movers_[static_cast<std::size_t>(axis)].reset(set_point_.position[axis]);
  head_wanted_ = false;
}

void Controller::on(const HumanState& people, TimePoint sampled) {
  people_ = people;
  new_people_ = true;
  human_seen_.mark(sampled);
  stop_space_.set(people);
  points_.clear();
  for (const Person& p : people.people) {
    if (p.joints.size() != kBodyJoints.size()) continue;
    const Vector3 &torso = p.joints[body::torso].position, &left = p.joints[body::l_hand].position;
    points_.push_back({p.id, torso, left, p.joints[body::r_hand].position});
  }
  refresh_capsules();
}

Exception Controller::exception() const {
  Exception e;
  e.person = exchanging_;
  return e;
}

void Controller::refresh_capsules() { prepare(people_, exception(), settings_.guard.unknown_after, person_capsules_); }

void Controller::on(const ActionStatus& action, TimePoint) {
  action_ = action;
  if (!action.exchange_engaged) return;
  std::string person = action.human;
  if (person.empty() && people_.people.size() == 1) person = people_.people.front().id;
  if (person == exchanging_) return;
  exchanging_ = person;
  refresh_capsules();
}

void Controller::on(const Go& go, TimePoint sampled) {
  const GoRefusal refusal = gate_.hear(go);
  if (refusal == GoRefusal::older_epoch) return;
  go_seen_.mark(sampled);
  if (refusal != GoRefusal::none) return;
  go_ = go;
  go_.override_factor = std::clamp(std::isfinite(go.override_factor) ? go.override_factor : 0.0, 0.0, 1.0);
}

void Controller::on(const SafetyState& safety) {
  gate_.hear(safety);
  safety_reason_ = safety.reason;
}

void Controller::on(const TrajectoryForecast& forecast, TimePoint sampled) {
  forecast_ = forecast;
  forecast_seen_.mark(sampled);
}

void Controller::on(const AttentionAdvice& advice, TimePoint sampled) {
  advice_ = advice;
  advice_seen_.mark(sampled);
  constexpr double kMoved = 0.02;
  if (!ready_ || head_axes_.empty() || !advice.has_gaze_target || (advice.gaze_target - gaze_aimed_).norm() < kMoved) return;
  std::vector<double> target =
      aim(*robot_, *robot_->group("head"), set_point_.position, state_.T_world_base.inverse() * advice.gaze_target);
  if (!head_room_.lets_turn(set_point_.position, target) || !head_room_.lets_turn(where_path_ends(), target)) return;
  gaze_aimed_ = advice.gaze_target;
  head_target_ = std::move(target);
  head_wanted_ = true;
}

/// All axes; here when no path runs.
Vector Controller::where_path_ends() {
  Vector q = set_point_.position;
  if (arm_ != Arm::running) return q;
  runner_.look(runner_.duration(), path_);
  for (std::size_t i = 0; i < axes_.size(); ++i) q[static_cast<Eigen::Index>(axes_[i])] = path_.position[static_cast<Eigen::Index>(i)];
  return q;
}

/// Measured positions are noisy, and what presses on a finger bends it; set-points never leave the bounds because of that.
double Controller::inside(int axis, double position) const noexcept {
  constexpr double kNoise = 0.02, kBent = 0.05;  // [rad, m]
  const Axis& bounds = robot_->axes()[static_cast<std::size_t>(axis)];
  if (!(bounds.lower < bounds.upper)) return position;
  const double within = std::clamp(position, bounds.lower, bounds.upper);
  return std::abs(within - position) <= (part_[static_cast<std::size_t>(axis)] == Part::hand ? kBent : kNoise) ? within : position;
}

/// The piece of the path that is being run.
void Controller::find_piece() noexcept {
  while (current_ + 1 < pieces_.size() && runner_.time() >= pieces_[current_ + 1].begin) ++current_;
  while (current_ > 0 && runner_.time() < pieces_[current_].begin) --current_;
}

void Controller::stand_arm() noexcept {
  for (int axis : arm_axes_) movers_[static_cast<std::size_t>(axis)].reset(set_point_.position[axis]);
  arm_ = Arm::standing;
}

void Controller::stop_arm() noexcept {
  for (int axis : arm_axes_) movers_[static_cast<std::size_t>(axis)].take_over(sent(axis), limits_of(robot_->stop_limits(), axis));
  arm_ = Arm::stopping;
}

bool Controller::attention_silent(TimePoint now) const noexcept {
  const double age = advice_seen_.age(now);
  return age < 0 || age > settings_.timeouts.attention;
}

double Controller::wanted_factor(TimePoint now) const noexcept {
  if (verdict_.mode >= Mode::hold || cancelled_) return 0.0;
  const bool silent = attention_silent(now);
  double wanted = std::min({go_.override_factor, guard_verdict_.forward, silent ? settings_.attention_lost_factor : advice_.speed_factor});
  wanted = std::min({wanted, cost_share(), guard_verdict_.view});
  if (forecast_.collides && forecast_.trajectory == piece().id) {
    const double share = (forecast_.time_to_collision - settings_.forecast_hold) / (settings_.forecast_slow - settings_.forecast_hold);
    wanted = std::min(wanted, std::clamp(share, 0.0, 1.0));
  }
  return wanted >= 0.0 ? wanted : std::max({wanted, guard_verdict_.backward, -settings_.recoil_limit});
}

/// The human-aware cost ahead lowers the speed (chapter section 2), smoothly from cost_from on; at an exchange it is meant to be high.
double Controller::cost_share() const noexcept {
  if (forecast_.trajectory != piece().id || !exchanging_.empty()) return 1.0;
  const double x = std::clamp((forecast_.cost - settings_.cost_from) / (1.0 - settings_.cost_from), 0.0, 1.0);
  return 1.0 - x * x * (3.0 - 2.0 * x) * (1.0 - settings_.cost_factor);
}

ModeInputs Controller::mode_inputs(TimePoint now, bool late) noexcept {
  ModeInputs in;
  in.robot_age = robot_seen_.age(now);
  in.human_age = human_seen_.age(now);
  in.forecast_age = forecast_seen_.age(now);
  in.attention_age = advice_seen_.age(now);
  in.go_age = go_seen_.age(now);
  in.running = arm_ == Arm::running || rejoin_;
  in.running_for = in.running ? to_seconds(now - started_) : 0.0;
  in.at_rest = at_rest();
  in.drive_enabled = state_.mode == DriveMode::enabled;
  in.set_points_late = in.drive_enabled && !follows();

  double off = 0.0;
  int farthest = -1;
  for (int axis : arm_axes_) {
    const double of_axis = std::abs(state_.position[axis] - set_point_.position[axis]);
    if (of_axis > off) farthest = axis;
    off = std::max(off, of_axis);
  }
  tracking_for_ = follows() && !settings_.dry_run && off > settings_.tracking_tolerance ? tracking_for_ + settings_.period : 0.0;
  in.tracking_error = tracking_for_ > settings_.tracking_time;
  if (in.tracking_error) off_axis_ = farthest, off_by_ = off;
  in.limit_violation = limit_violation_;
  limit_violation_ = false;
  late_in_a_row_ = late ? late_in_a_row_ + 1 : 0;
  if (late) ++late_cycles_;
  in.cycle_late = late_in_a_row_ >= settings_.late_limit;

  if (in.running && forecast_.collides && forecast_.trajectory == piece().id) {
    const bool soon = forecast_.time_to_collision < settings_.forecast_hold;
    in.forecast_collision_hold = soon;
    in.forecast_collision_slow = !in.forecast_collision_hold && forecast_.time_to_collision < settings_.forecast_slow;
  }
  in.separation_slow = guard_verdict_.separation && guard_verdict_.forward < 0.999;
  in.wall_slow = guard_verdict_.wall && guard_verdict_.forward < 0.999;
  too_near_for_ = in.running && guard_verdict_.too_near ? too_near_for_ + settings_.period : 0.0;
  in.separation_stop = too_near_for_ > settings_.guard.stop_persistence;
  in.contact_stop = touch_ != Contact::none && !in.at_rest && !yielding_;  // at rest a short push does no harm
  in.clamped = touch_ == Contact::clamped;
  in.human_unknown = human_seen_.ever && !person_capsules_.covered;
  in.attention_slow = in.running && advice_seen_.ever && advice_.speed_factor < 0.999;
  in.cost_slow = in.running && cost_share() < 0.999;
  in.stop_unproven = unproven_shown_ > 0;
  in.blind = blind_ && human_seen_.ever;
  in.blind_ahead = in.running && guard_verdict_.view < 0.999;
  in.override_slow = go_.override_factor < 0.999;
  in.go_epoch = go_.epoch;
  in.go_allowed = gate_.allowed();
  in.first_go_epoch = gate_.first_epoch();
  in.awaits_person = gate_.awaits_person();
  in.go_acknowledge = go_.acknowledge;
  return in;
}

/// Of the arm, each axis by itself [s].
double Controller::fastest_stop() const noexcept {
  double longest = 0.0;
  const MotionState3& now = set_point_;
  for (int axis : arm_axes_) longest = std::max(longest, fastest_stop(axis, now.velocity[axis], now.acceleration[axis]));
  return longest;
}

double Controller::fastest_stop(int axis, double velocity, double acceleration) const noexcept {
  const KinematicLimits& l = robot_->stop_limits();
  return measure_stop(velocity, acceleration, l.acceleration[axis], l.jerk[axis]).duration;
}

/// Longest fastest stop of the arm from where the next cycle can bring it [s]. An axis that brakes
/// almost too hard to stop without swinging back is much later one cycle on.
double Controller::fastest_stop_after_a_cycle() const noexcept {
  const double dt = settings_.period;
  double longest = 0.0;
  for (int axis : arm_axes_) {
    const double jerk = robot_->stop_limits().jerk[axis];
    for (const double j : {-jerk, jerk}) {
      const double a = set_point_.acceleration[axis];
      const double velocity = set_point_.velocity[axis] + a * dt + 0.5 * j * dt * dt;
      longest = std::max(longest, fastest_stop(axis, velocity, a + j * dt));
    }
  }
  return longest;
}

/// A stop along the path may take longer than the axes need: then it is ended beside it, in the time that is promised.
bool Controller::must_leave_path(TimePoint now) const noexcept {
  if (runner_.standing() || !(verdict_.mode == Mode::hold || too_fast())) return false;
  const double slack = verdict_.mode == Mode::hold ? kStopSlack : kGuardSlack;
  const double needed = fastest_stop_after_a_cycle() + 3 * settings_.period;
  return now + from_seconds(needed) >= rest_due_ + from_seconds(slack);
}

void Controller::give_up_path() noexcept {
  motion_ = MotionState::stopped;
  rejoin_ = false;
}

void Controller::go_back_to_path() noexcept {
  for (std::size_t i = 0; i < axes_.size(); ++i) path_.position[static_cast<Eigen::Index>(i)] = set_point_.position[axes_[i]];
  path_.velocity.setZero();
  path_.acceleration.setZero();
  rejoin_ = false;
  if (!runner_.rejoin(path_)) {
    give_up_path();
    return;
  }
  for (Piece& p : pieces_) {
    p.begin += runner_.rejoin_shift();
    p.offset += runner_.rejoin_shift();
  }
  arm_ = Arm::running;
  // It begins at rest. What may be is found out in the next cycles, one of the three verdicts in each: all at once would make a late cycle.
  verdict_now_ = verdict_near_ = verdict_far_ = {};
  verdict_now_.forward = verdict_near_.forward = verdict_far_.forward = 0.0;
  merge_verdicts();
  runner_.begin_with(0.0);
}

void Controller::step_arm(TimePoint now) noexcept {
  if (rejoin_ && verdict_.mode >= Mode::stop) give_up_path();
  if (rejoin_ && arm_ == Arm::standing && verdict_.mode < Mode::hold) go_back_to_path();
  if (arm_ == Arm::running) {
    if (verdict_.mode >= Mode::stop) {
      give_up_path();
      stop_arm();
    } else if (must_leave_path(now) || !runner_.step(wanted_factor(now))) {
      rejoin_ = !cancelled_;
      stop_arm();
    } else {
      find_piece();
      for (std::size_t i = 0; i < axes_.size(); ++i) {
        const auto axis = static_cast<Eigen::Index>(axes_[i]);
        const auto k = static_cast<Eigen::Index>(i);
        next_.position[axis] = runner_.state().position[k];
        next_.velocity[axis] = runner_.finished() ? 0.0 : runner_.state().velocity[k];
        next_.acceleration[axis] = runner_.finished() ? 0.0 : runner_.state().acceleration[k];
        movers_[static_cast<std::size_t>(axis)].reset(next_.position[axis]);
      }
      if (runner_.finished()) {
        arm_ = Arm::standing;
        if (!cancelled_ && motion_ == MotionState::running) motion_ = MotionState::finished;
      } else if (cancelled_ && runner_.standing()) {
        arm_ = Arm::standing;
      }
    }
  }
  bool resting = true;
  for (int axis : arm_axes_) {
    AxisMover& mover = movers_[static_cast<std::size_t>(axis)];
    const bool on_path = arm_ == Arm::running && std::find(axes_.begin(), axes_.end(), static_cast<std::uint32_t>(axis)) != axes_.end();
    if (on_path || (arm_ == Arm::standing && mover.at_rest() && next_.velocity[axis] == 0.0 && next_.acceleration[axis] == 0.0)) continue;
    write(axis, mover.step(settings_.period));
    resting = resting && mover.at_rest();
  }
  if (arm_ == Arm::stopping && resting) arm_ = Arm::standing;
}

double Controller::held_payload(const ServoReference& reference, std::size_t hand) noexcept {
  if (hand == 0) return reference.payload;
  const auto other = static_cast<Eigen::Index>(hand) - 1;
  return other < reference.other_payloads.size() ? reference.other_payloads[other] : 0.0;
}

double Controller::felt_payload(std::size_t hand) const noexcept {
  if (hand == 0) return state_.payload;
  return hand <= state_.other_hands.size() ? state_.other_hands[hand - 1].payload : 0.0;
}

const Wrench* Controller::felt_wrench(std::size_t hand) const noexcept {
  if (hand == 0) return &state_.wrist_wrench;
  return hand <= state_.other_hands.size() ? &state_.other_hands[hand - 1].wrist_wrench : nullptr;
}

/// Where people can reach the hands, fingers move so slowly that they are harmless whenever they touch somebody.
void Controller::limit_fingers(TimePoint now) noexcept {
  constexpr int kEvery = 10;  // cycles
  if (cycles_ % kEvery != 0) return;
  const double age = std::max(0.0, human_seen_.age(now));
  const double limit = finger_limit_.factor(set_point_.position, state_.T_world_base, age, held_payload(), person_capsules_);
  for (Hand& hand : hands_) hand.executor.limit_speed(limit);
}

void Controller::step_hands(TimePoint now) noexcept {
  limit_fingers(now);
  if (new_state_ && arm_ != Arm::running) robot_->forward(set_point_.position, links_);
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    Hand& hand = hands_[i];
    const HandState before = hand.executor.state();
    if (hand.executor.size() > 0) step_hand(hand, now);
    // What the arm feels changes with what the hand holds.
    const HandState state = hand.executor.state();
    if (state == HandState::grasped) hand.payload = hand.grasped_payload;
    if (state == HandState::empty || state == HandState::released) hand.payload = 0.0;
    if (state != before) contact_.reset();
    if (i > 0) other_payloads_[static_cast<Eigen::Index>(i) - 1] = hand.payload;
  }
  new_state_ = false;
}

void Controller::step_hand(Hand& hand, TimePoint now) noexcept {
  const auto index = static_cast<std::size_t>(&hand - hands_.data());
  HandInputs in;
  in.robot = &state_;
  in.new_state = new_state_;
  in.may_move = verdict_.mode < Mode::hold;
  in.stop = verdict_.mode >= Mode::stop;
  in.person_distance = std::numeric_limits<double>::infinity();
  in.clamped = touch_ == Contact::clamped && !exchanging_.empty();
  in.payload = felt_payload(index);
  if (in.new_state && hand.palm >= 0) {
    const Pose T_world_tool = state_.T_world_base * links_[static_cast<std::size_t>(hand.palm)];
    if (const Wrench* felt = felt_wrench(index)) in.force = T_world_tool.linear() * felt->force;
    const Vector3 p = T_world_tool.translation();
    double torso = std::numeric_limits<double>::infinity();
    for (const PersonPoints& person : points_) {
      in.person_distance = std::min({in.person_distance, (person.left_hand - p).norm(), (person.right_hand - p).norm()});
      const Vector3 way = person.torso - p;
      if ((exchanging_.empty() || person.id == exchanging_) && way.norm() < torso && way.norm() > 1e-6) {
        torso = way.norm();
        in.toward = way / torso;
      }
    }
  }
  hand.executor.step(in, settings_.period, now, next_);
  for (int i = 0; i < hand.executor.size(); ++i) effort_[hand.executor.axes()[static_cast<std::size_t>(i)]] = hand.executor.effort(i);
}

void Controller::step_head() noexcept {
  const bool may_move = verdict_.mode < Mode::hold;
  for (std::size_t i = 0; i < head_axes_.size(); ++i) {
    const int axis = head_axes_[i];
    AxisMover& mover = movers_[static_cast<std::size_t>(axis)];
    if (!may_move && !head_paused_) {
      mover.stop(limits_of(robot_->stop_limits(), axis));
    } else if (may_move && head_wanted_ && std::abs(head_target_[i] - mover.target()) > settings_.head_dead_band) {
      mover.go_to(head_target_[i], limits_of(robot_->comfort_limits(), axis), limits_of(robot_->stop_limits(), axis));
    }
    write(axis, mover.step(settings_.period));
  }
  head_paused_ = !may_move;
}

bool Controller::moves_nothing() const noexcept {
  return apart() && !settings_.dry_run && reference_.state() == RobotReference::State::resting;
}

void Controller::resync(TimePoint now) noexcept {
  using State = RobotReference::State;
  const bool stale = robot_seen_.age(now) > settings_.timeouts.robot_state;
  if (stale) reference_.set_stale();
  const bool due = cycles_ % RobotReference::kInterval == 0 && !stale;
  if (due) reference_.update(state_, set_point_.position, follows());
  const bool wanted = settings_.dry_run || apart();
  if (!wanted) has_adopted_ = false;
  if (!wanted || !due || arm_ != Arm::standing || !at_rest()) return;
  // A robot side whose drives are enabled moves its reference to set-points that rest. Set-points
  // that rest at the reference move nothing; they stay while the reference moves. Where the
  // reference is not known, or follows under a fault, set-points are taken once to the posture the
  // robot came to rest in: if they followed a sagging arm or a bent finger, the robot would creep.
  constexpr double kRests = 0.05, kExact = 1e-12;     // [rad/s], [rad]
  constexpr double kStill = 5e-4, kDeadBand = 0.002;  // [rad] between two evaluations; from the target
  const bool joins = state_.mode == DriveMode::enabled && !settings_.dry_run;
  const bool at_reference = moves_nothing();
  const bool has_velocity = state_.velocity.size() == state_.position.size();
  const auto rests = [&](int axis) {
    const bool still = std::abs(state_.position[axis] - measured_before_[axis]) < kStill;
    return still && (!has_velocity || std::abs(state_.velocity[axis]) < kRests);
  };
  const auto far = [&](int axis) { return std::abs(state_.position[axis] - adopted_[axis]) > RobotReference::kBent; };
  const bool arm_rests = std::all_of(arm_axes_.begin(), arm_axes_.end(), rests);
  measured_before_ = state_.position;
  const bool adopts = !has_adopted_ || std::any_of(arm_axes_.begin(), arm_axes_.end(), far);
  if (joins && !at_reference && adopts && arm_rests && reference_.state() != State::moving) {
    adopted_ = state_.position;
    has_adopted_ = true;
  }
  const auto go_there = [&](int axis, double position, double dead_band) {
    AxisMover& mover = movers_[static_cast<std::size_t>(axis)];
    const double target = inside(axis, position);
    if (std::abs(target - mover.target()) > dead_band)
      mover.go_to(target, limits_of(robot_->comfort_limits(), axis), limits_of(robot_->stop_limits(), axis));
  };
  const auto resync_axis = [&](int axis) {
    if (at_reference)
      go_there(axis, state_.reference.position[axis], kExact);
    else if (!joins)
      go_there(axis, state_.position[axis], kDeadBand);
    else if (has_adopted_)
      go_there(axis, adopted_[axis], kExact);
  };
  if (settings_.dry_run || reference_.state() != State::moving) {
    for (int axis : arm_axes_) resync_axis(axis);
    for (int axis : head_axes_) resync_axis(axis);
  }
  // The fingers stay where they came to rest: what they hold bends them, and a person who holds it too moves them all the time.
  for (Hand& hand : hands_) hand.executor.follow(state_.position, joins ? settings_.hand_rejoin : kDeadBand);
}

AxisState Controller::sent(int axis) const noexcept {
  return {set_point_.position[axis], set_point_.velocity[axis], set_point_.acceleration[axis]};
}

void Controller::write(int axis, const AxisState& s) noexcept {
  next_.position[axis] = s.position;
  next_.velocity[axis] = s.velocity;
  next_.acceleration[axis] = s.acceleration;
}

bool Controller::step(TimePoint now, bool late) noexcept {
  constexpr Duration kSleep = std::chrono::milliseconds(100);
  asleep_ = asleep_ || (last_step_ < now && now - last_step_ > kSleep);
  last_step_ = now;
  if (!ready_) return false;
  ++cycles_;
  run_guard(now);
  verdict_ = modes_.update(mode_inputs(now, late));
  if (verdict_.mode >= Mode::hold) {
    const Cause cause = gravest(verdict_.causes & ~bit(Cause::no_go));
    if (cause != Cause::none)
      latched_cause_ = cause;
    else if (latched_cause_ == Cause::none)
      latched_cause_ = Cause::no_go;
  } else {
    latched_cause_ = Cause::none;
    if (!too_fast()) rest_due_ = now + from_seconds(fastest_stop());
  }
  if (refused_for_ > 0 && --refused_for_ == 0) {
    refused_ = false;
    refusal_.clear();
  }
  // Set-points that nobody is heard to follow would be the first ones of a robot side that comes up elsewhere.
  asleep_ = asleep_ || (robot_seen_.age(now) > kRobotGone && at_rest());
  if (asleep_) return false;
  next_ = set_point_;
  resync(now);
  step_yield(now);
  step_arm(now);
  step_hands(now);
  step_head();
  check_last();
  const std::uint64_t unproven = unproven_;
  prove_stop(now);
  if (unproven == unproven_) keep_observed(now);  // else the stop that is sent was observed with the set-point before
  measure(set_point_, next_, robot_->guard_limits(), settings_.period, shares_);
  set_point_ = next_;
  return true;
}

}  // namespace handsel::trajectory_controller
