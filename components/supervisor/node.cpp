// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/node.hpp"

#include "common/config/resources.hpp"
#include "common/config/settings_text.hpp"
#include "common/model/description/robot_text.hpp"
#include "common/model/manipulator.hpp"
#include "common/model/platform.hpp"

namespace handsel::supervisor {
namespace {

/// Period of sampling the modes of the robot side; every stop lasts at least ten set-points (10
/// ms).
constexpr Duration kDrivePeriod = std::chrono::milliseconds(5);

settings::SupervisorSettings load_settings(const NodeContext& context) {
  SettingsText text;
  auto s = settings::read_supervisor_settings(context.settings / "supervisor.txtpb", &text);
  if (s.domain.empty())
    text.refuse("domain", "is empty, must name the file of the task domain, e.g. \"tasks.txtpb\"");
  return s;
}

std::shared_ptr<const StateStore> open_store(const NodeContext& context) {
  return context.state.empty() ? nullptr : std::make_shared<const StateStore>(context.state);
}

/// Returns the stored state; without a store or a file the state of a system just started by a
/// person.
DurableState restore(const StateStore* store, double override_factor, Stamp now) {
  const DurableState initial = fresh_state(static_cast<std::uint64_t>(now), override_factor);
  return store != nullptr ? store->restore(initial, now) : initial;
}

Ability ability_of(const settings::SupervisorSettings& settings, const NodeContext& context) {
  Ability ability;
  ability.spot = settings.spot;
  ability.min_edge = settings.surface_edge;
  ability.place_step = settings.surface_step;
  ability.max_places = settings.max_places;
  ability.objects = context.objects;
  ability.person_reach = settings.person_reach;
  ability.max_width = settings.max_one_hand_width;
  if (context.robot == nullptr) return ability;
  ability.drives = drives(*context.robot);
  if (const auto it = settings.payload.find(context.robot->name()); it != settings.payload.end())
    ability.payload = it->second;
  if (context.description.empty()) return ability;
  ability.hands = 1 + read_robot_text(context.description).other_arms_size();
  return ability;
}

/// Returns the arms with a hand at their poses in the scene.
std::vector<Ability::Arm> arms_of(const RobotModel& robot, const Scene& scene) {
  std::vector<Ability::Arm> arms;
  for (const Manipulator& hand : hands_of(robot)) {
    const ArmReach reach = arm_reach(robot, hand.arm, hand.palm);
    if (reach.shoulder < 0) continue;
    const Pose T_base_shoulder = robot.link_pose(scene.robot_position, reach.shoulder);
    arms.push_back({hand.fingers != nullptr ? hand.fingers->name : "",
                    (scene.T_world_base * T_base_shoulder).translation(), reach.length});
  }
  return arms;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context) : Node(bus, context, load_settings(context)) {}

Node::Node(Bus& bus, const NodeContext& context, const settings::SupervisorSettings& settings)
    : bus_(bus),
      settings_(settings),
      robot_(context.robot),
      store_(open_store(context)),
      core_(settings_, load_domain(context.settings / settings_.domain),
            ability_of(settings_, context), static_cast<std::uint64_t>(bus.stamp_now()),
            restore(store_.get(), settings_.speed_override, bus.stamp_now()), bus.now()),
      action_out_(bus.advertise<ActionGoal>()),
      status_out_(bus.advertise<TaskStatus>()),
      go_out_(bus.advertise<Go>()),
      safety_out_(bus.advertise<SafetyState>()) {
  feed<TaskGoal>();
  feed<Facts>();
  bus.subscribe<Scene>(
      [this](const Scene& scene, const Receipt& receipt) { on_scene(scene, receipt.arrival); });
  feed<ActionStatus>();
  feed<AttentionAdvice>();
  feed<ComponentHealth>();
  feed<ExecutionStatus>();
  bus.subscribe<RobotState>(
      [this](const RobotState& state, const Receipt& receipt) { core_.on(state, receipt.arrival); },
      {.period = kDrivePeriod});
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt& receipt) {
    core_.on(people, receipt.arrival - receipt.age, receipt.writer);
  });
  bus.set_degraded("the state of the world is not known yet");
  bus.every(from_seconds(settings_.period), [this](TimePoint now) { step(now); });
}

template <class M>
void Node::feed() {
  bus_.subscribe<M>(
      [this](const M& message, const Receipt& receipt) { core_.on(message, receipt.arrival); });
}

void Node::on_scene(const Scene& scene, TimePoint arrival) {
  if (robot_ != nullptr && scene.robot_known) core_.set_arms(arms_of(*robot_, scene));
  core_.on(scene, arrival);
}

/// Writes outside the executor, so that a slow disk does not delay a Go.
void Node::store(const DurableState& state) {
  const std::uint64_t revision = state.safety.revision;
  if (store_ == nullptr) return core_.on_stored(revision);
  const auto failure = std::make_shared<std::string>();
  bus_.run_job(
      [store = store_, state, failure, now = bus_.stamp_now()](const CancelToken&) {
        *failure = store->save(state, now);
        return Duration{};
      },
      [this, failure, revision] {
        failure->empty() ? core_.on_stored(revision) : core_.on_store_failure(*failure, bus_.now());
      });
}

void Node::step(TimePoint now) {
  Outbox out;
  core_.step(now, bus_.stamp_now(), out);
  bus_.count_left_out("task goals: too many wait",
                      core_.goals_turned_away() - turned_away_counted_);
  turned_away_counted_ = core_.goals_turned_away();
  bus_.set_degraded(!core_.store_failure().empty() ? core_.store_failure()
                    : core_.knows_world()          ? ""
                                                   : "the state of the world is not known yet");
  for (const auto& goal : out.action_goals) action_out_->publish(goal);
  for (const auto& status : out.task_statuses) status_out_->publish(status);
  if (out.go) go_out_->publish(*out.go);
  if (out.safety) safety_out_->publish(*out.safety);
  if (out.store) store(*out.store);
}

}  // namespace handsel::supervisor
