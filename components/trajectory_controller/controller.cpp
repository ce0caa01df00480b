// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_controller/controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/errors.hpp"

namespace handsel::trajectory_controller {

namespace {

void require(bool good, const char* sentence) {
  if (!good) throw ConfigError(std::string("trajectory_controller: ") + sentence);
}

/// Returns whether a retreat may leave the path: not if contacts are allowed, as the hand would
/// shift the object to grasp.
bool may_retreat_beside(const CommandQueue& path) noexcept {
  return path.current().allowed_contacts.empty();
}

ComplianceSettings compliance_settings(const ControllerSettings& s) {
  return {s.yield_speed,          s.yield_reach,       s.retreat_speed, s.retreat_reach,
          s.contact.yield_torque, s.yield_lead,        s.retreat_range, s.retreat_damping,
          s.retreat_min_factor,   s.retreat_aim_cycles};
}

LookaheadSettings lookahead_settings(const ControllerSettings& s) {
  return {s.guard,
          s.walls,
          s.look_ahead,
          s.look_far_ahead,
          s.rise,
          s.ahead_min_factor,
          s.back_min_factor,
          s.rest_check_cycles,
          s.retreat_check_cycles,
          s.too_fast_ratio,
          s.too_fast_margin};
}

OutputCheckSettings output_settings(const ControllerSettings& s) {
  return {s.period, s.dry_run, s.proof.max_rejoins, s.proof.shown_time, s.blind_check_cycles};
}

SpeedSettings speed_settings(const ControllerSettings& s) {
  return {s.attention_lost_factor, s.timeouts.attention, s.recoil_limit, s.forecast_hold,
          s.forecast_slow,         s.cost_from,          s.cost_factor};
}

SupervisorSettings supervisor_settings(const ControllerSettings& s) {
  return {s.period,        s.dry_run,       s.tracking_tolerance,     s.tracking_time,
          s.forecast_hold, s.forecast_slow, s.guard.stop_persistence, s.late_limit,
          s.timeouts};
}

/// Returns whether the platform moves.
bool moves_platform(const AxisGroups& groups, const ArmMotion& arm, const SetPoints& set_points) {
  const auto of_platform = [&groups](std::uint32_t axis) {
    return groups.part(static_cast<int>(axis)) == Part::platform;
  };
  const std::vector<std::uint32_t>& path = arm.path_axes();
  return (arm.active() && std::any_of(path.begin(), path.end(), of_platform)) ||
         set_points.any_moves(groups.platform());
}

/// Returns the mass that adds to that of the arm in a contact: the held load, and the platform if
/// it moves [kg].
double contact_load(double held, double platform, const AxisGroups& groups, const ArmMotion& arm,
                    const SetPoints& set_points) {
  return platform > 0.0 && moves_platform(groups, arm, set_points) ? held + platform : held;
}

}  // namespace

Controller::Controller(const ControllerSettings& settings, std::shared_ptr<const RobotModel> robot)
    : settings_(settings),
      robot_(std::move(robot)),
      groups_(*robot_, settings.bound_noise),
      inputs_{{}, ObservedPeople(settings.guard.unknown_after), {}, {}, {}},
      contact_(settings.contact, groups_.arm_joints()),
      set_points_(robot_->dof()),
      proof_(settings.proof, *robot_, robot_capsules(*robot_)),
      stop_space_(settings.view, proof_, *robot_),
      finger_limit_(proof_, *robot_, settings.guard),
      arm_({settings.period, settings.start_tolerance, settings.switch_reach, settings.join_time,
            settings.rejoin_time, settings.rejoin_tries, settings.alike_distance,
            settings.alike_ratio},
           *robot_, groups_.arm()),
      compliance_(compliance_settings(settings), *robot_, groups_.arm_joints().size(), arm_),
      follower_({settings.dry_run, settings.hand_rejoin, settings.timeouts.robot_state,
                 settings.reference},
                groups_),
      hands_(settings.hand, *robot_, settings.period),
      head_(*robot_, groups_.head(),
            {settings.period, settings.head_dead_band, settings.head_min_target_motion,
             settings.head_clearance}),
      lookahead_(lookahead_settings(settings), *robot_, proof_, stop_space_, hands_.axes()),
      deadline_(*robot_, groups_.arm(), settings.period),
      supervisor_(supervisor_settings(settings)),
      output_check_(output_settings(settings), *robot_, groups_, proof_, stop_space_) {
  require(settings.period > 0 && settings.period <= 0.02,
          "period must be above 0 and at most 0.02 s");
  require(settings.start_tolerance >= 0, "start_tolerance must not be negative");
  require(settings.forecast_slow > settings.forecast_hold,
          "forecast_slow must be above forecast_hold");
  require(settings.cost_from >= 0 && settings.cost_from < 1, "cost_from must be in [0, 1)");
  require(settings.late_limit > 0, "late_limit must be above 0");
  for (const Wall& wall : settings.walls)
    require(std::abs(wall.normal.norm() - 1.0) < 1e-6, "the normal of a wall must have length 1");
}

void Controller::on(const RobotState& state, TimePoint sampled, Duration age, bool new_writer) {
  const auto n = static_cast<Eigen::Index>(robot_->dof());
  if (state.robot != robot_->name()) return;
  if (state.position.size() != n || !state.position.allFinite()) return;
  const bool resting = arm_.state() == ArmState::at_rest;
  const bool in_handover = !inputs_.people.partner().empty();
  contact_.update(state.external_torque, inputs_.robot.since(sampled), resting, in_handover);
  inputs_.permission.set(state.mode);
  if (!inputs_.robot.set(state, sampled, age, new_writer)) return;
  // The first set-point is the configuration of the robot side once that is available.
  const bool at_reference = !settings_.dry_run && follower_.reference().reported(state);
  Vector position = at_reference ? state.reference.position : state.position;
  for (int axis = 0; axis < groups_.size(); ++axis)
    position[axis] = groups_.inside(axis, position[axis]);
  set_points_.restart(position);
  if (arm_.active()) arm_.interrupt_path(false);
  arm_.rest_at(position);
  hands_.reset(position, at_reference ? &state.reference : nullptr);
  head_.reset(position);
}

void Controller::on(const HumanState& people, TimePoint sampled) {
  inputs_.people.set(people, sampled);
  lookahead_.set_new_people();
  stop_space_.set(people);
}

void Controller::on(const ActionStatus& action, TimePoint) { inputs_.people.set(action); }

void Controller::on(const Go& go, TimePoint sampled) { inputs_.permission.set(go, sampled); }

void Controller::on(const SafetyState& safety) { inputs_.permission.set(safety); }

void Controller::on(const TrajectoryForecast& forecast, TimePoint sampled) {
  inputs_.forecast.set(forecast, sampled);
}

void Controller::on(const AttentionAdvice& advice, TimePoint sampled) {
  inputs_.advice.set(advice, sampled);
  if (!inputs_.robot.ready() || !head_.has_new_target(advice)) return;
  const Vector& here = set_points_.sent().position;
  head_.aim_at(advice, inputs_.robot.state().T_world_base, here, positions_ahead(arm_, here));
}

CommandConditions Controller::conditions() const {
  return {*robot_,
          inputs_.permission,
          inputs_.robot.ready(),
          settings_.max_command_age,
          supervisor_.mode(),
          supervisor_.latched_cause()};
}

std::string Controller::accept(const TrajectoryCommand& command, Duration age, TimePoint now) {
  if (commands_.accepted(command.id)) return "it came before; the first one counts";
  const bool joins = arm_.joins(command);
  std::string reason = why_not_now({command.robot, command.epoch, to_seconds(age)}, conditions());
  if (reason.empty()) reason = why_not_executable(command, *robot_);
  if (reason.empty()) reason = hands_.why_not_on_path(command.axes);
  if (reason.empty() && command.axes.empty()) {
    commands_.accept_stop(command.id);
    arm_.cancel();
    return {};
  }
  if (reason.empty()) reason = arm_.accept(command, set_points_.sent());
  if (!reason.empty()) {
    const int shown = static_cast<int>(settings_.refusal_time / settings_.period);
    commands_.refuse(command.id, reason, arm_.active() ? shown : 0);
    return reason;
  }
  commands_.accept(command.id);
  if (!joins) supervisor_.begin_motion(now);
  // A path is evaluated before its first step; from rest it begins with at most the allowed factor.
  lookahead_.evaluate_all(lookahead_inputs(now), !joins);
  arm_.begin_with(std::max(0.0, wanted_factor(now)));
  return {};
}

std::string Controller::accept(const HandCommand& command, Duration age, TimePoint) {
  if (hands_.accepted(command.id)) return {};
  const CommandHead head{command.robot, command.epoch, to_seconds(age)};
  std::string reason =
      hands_.accept(command, why_not_now(head, conditions()), arm_.movers().moved());
  if (reason.empty())
    commands_.accept_hand();
  else
    commands_.refuse_hand(command.id, reason);
  return reason;
}

LookaheadInputs Controller::lookahead_inputs(TimePoint now) noexcept {
  const ObservedPeople& people = inputs_.people;
  const MotionState3& sent = set_points_.sent();
  const bool may_run_back = inputs_.advice.value.speed_factor < 0.0 || arm_.speed_factor() < 0.0;
  return {arm_,
          sent,
          inputs_.robot.state().T_world_base,
          people.capsules(),
          people.uncovered(),
          people.data_age(now),
          deadline_.ease(sent),
          contact_load(hands_.held_payload(), proof_.contact_speeds().platform_mass(), groups_,
                       arm_, set_points_),
          may_run_back,
          compliance_.retreat()};
}

double Controller::wanted_factor(TimePoint now) const noexcept {
  if (supervisor_.mode() >= Mode::hold || arm_.goal() == PathGoal::stop) return 0.0;
  const std::uint64_t trajectory = arm_.queue().current().id;
  const GuardVerdict& guard = lookahead_.verdict();
  const double wanted = trajectory_controller::wanted_factor(speed_settings(settings_), inputs_,
                                                             trajectory, guard, now);
  // Runs backward on the path only from rest: a motion that reverses takes longer to stop.
  constexpr double kStands = 1e-3;  // max speed factor at rest
  return arm_.speed_factor() > kStands ? std::max(0.0, wanted) : wanted;
}

void Controller::supervise(TimePoint now, bool late) noexcept {
  const bool here = lookahead_.step(lookahead_inputs(now), cycles_);
  const GuardVerdict& guard = lookahead_.verdict();
  const std::uint64_t trajectory = arm_.queue().current().id;
  if (here && lookahead_.nearest().handover_clear) inputs_.people.end_exemption();
  supervisor_.update(
      {inputs_, set_points_, groups_.arm(), guard, arm_.active(), trajectory,
       cost_factor(speed_settings(settings_), inputs_, trajectory), contact_.contact(),
       compliance_.moving(), output_check_.take_limit_violation(), output_check_.shows_unproven(),
       output_check_.blind(), late},
      now);
  const bool free = supervisor_.mode() < Mode::hold && !lookahead_.is_too_fast(arm_.speed_factor());
  if (free) deadline_.set_free(set_points_.sent(), now);
  commands_.step();
}

/// Steps the arm. A stop along the path that takes longer than the promised time is completed
/// beside the path.
void Controller::step_arm(TimePoint now) noexcept {
  const Mode mode = supervisor_.mode();
  const MotionState3& sent = set_points_.sent();
  const bool rejoins = arm_.goal() == PathGoal::rejoin;
  if (rejoins && mode >= Mode::stop) arm_.interrupt_path(false);
  const bool recoils = asks_for_recoil(inputs_, settings_.timeouts.attention, now);
  const bool may_rejoin = rejoins && !recoils && !compliance_.moving() && mode < Mode::hold;
  if (may_rejoin && arm_.state() == ArmState::at_rest && arm_.rejoin(sent)) lookahead_.forbid_all();
  ArmOrder order = mode >= Mode::stop ? ArmOrder::stop : ArmOrder::run;
  if (order == ArmOrder::run && recoils && inputs_.advice.value.leaves_path &&
      settings_.retreat_reach > 0.0 && may_retreat_beside(arm_.queue()))
    order = ArmOrder::leave;
  const bool too_fast = mode == Mode::hold || lookahead_.is_too_fast(arm_.speed_factor());
  const double slack = mode == Mode::hold ? settings_.stop_slack : settings_.slow_slack;
  if (order == ArmOrder::run && arm_.running() && !arm_.path().standing() && too_fast &&
      deadline_.is_due(sent, slack, now))
    order = ArmOrder::leave;
  arm_.step(order, wanted_factor(now), set_points_);
}

bool Controller::step(TimePoint now, bool late) noexcept {
  inputs_.robot.begin_cycle(now);
  if (!inputs_.robot.ready()) return false;
  ++cycles_;
  supervise(now, late);
  if (!inputs_.robot.may_send(now, set_points_.at_rest())) return false;
  set_points_.begin_cycle();
  const RobotState& robot = inputs_.robot.state();
  const ObservedPeople& people = inputs_.people;
  const Mode mode = supervisor_.mode();
  const double age = people.data_age(now);
  const bool follows = inputs_.robot.follows(), clamped = contact_.contact() == Contact::clamped;

  follower_.step({inputs_.robot, set_points_, inputs_.robot.age(now), mode == Mode::fault, cycles_},
                 arm_, head_.movers(), hands_);
  const bool undisturbed = people.partner().empty() && !hands_.any_moving();
  const bool may_move = !settings_.dry_run && mode < Mode::fault && follows;
  const bool beside_path = arm_.goal() == PathGoal::rejoin && !arm_.running();
  const bool may_comply = arm_.state() == ArmState::at_rest && !beside_path && may_move &&
                          settings_.yield_speed > 0.0 && (undisturbed || clamped);
  const bool recoils = asks_for_recoil(inputs_, settings_.timeouts.attention, now);
  const bool may_retreat =
      recoils && (beside_path ? may_move && may_retreat_beside(arm_.queue()) : may_comply);
  compliance_.step({inputs_, contact_, set_points_, supervisor_.verdict(), lookahead_.nearest(),
                    lookahead_.retreat_factor(), may_comply, may_retreat, cycles_});
  step_arm(now);

  const auto load = [this] {
    return contact_load(hands_.held_payload(), proof_.contact_speeds().platform_mass(), groups_,
                        arm_, set_points_);
  };
  const Vector& sent = set_points_.sent().position;
  if (cycles_ % settings_.finger_check_cycles == 0)
    hands_.limit(finger_limit_.bounds(sent, robot.T_world_base, age, load(), people.capsules()));
  const bool new_state = inputs_.robot.has_new_state();
  if (new_state && !arm_.running()) lookahead_.place_links(sent);
  const HandsInputs of_hands{robot, people, lookahead_.links(), new_state, arm_.movers().moved(),
                             mode,  clamped};
  // The measured contact torques change with the load of the hand.
  if (hands_.step(of_hands, now, set_points_.next())) contact_.reset();
  inputs_.robot.mark_used();
  head_.step(mode < Mode::hold, arm_.movers().moved(), set_points_.next());

  const std::uint64_t unproven = output_check_.unproven();
  const double factor = arm_.speed_factor();
  output_check_.step({people.capsules(), robot.T_world_base, age, load(), follows,
                      follower_.moves_nothing(), compliance_.complying(), cycles_},
                     {arm_, hands_, head_.movers()}, set_points_);
  if (output_check_.unproven() != unproven) lookahead_.lower(factor);
  set_points_.end_cycle(robot_->guard_limits(), settings_.period);
  return true;
}

StatusSources Controller::sources() const {
  return {*robot_,   inputs_,          supervisor_, arm_,        hands_,
          commands_, set_points_,      contact_,    stop_space_, lookahead_.nearest(),
          cycles_,   settings_.dry_run};
}

}  // namespace handsel::trajectory_controller
