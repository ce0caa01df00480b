// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/environment/environment.hpp"

#include <array>
#include <cmath>

#include "common/base/errors.hpp"
#include "common/config/scenario.hpp"
#include "common/messages/names.hpp"
#include "deploy/handsel/cli/json_lines.hpp"
#include "deploy/handsel/system/performer.hpp"
#include "deploy/handsel/system/system.hpp"

namespace handsel::environment {
namespace {

using Json = nlohmann::json;
using command::LineError;

constexpr double kReadyTimeout = 10.0;    // [s]
constexpr double kDefaultTimeout = 60.0;  // of a scenario without one [s]
constexpr double kMaxStep = 3600.0;       // of one request [s]
constexpr std::uint32_t kMaxGrasps = 200;

template <class Enum, std::size_t N>
Enum word_of(const Json& object, const char* field, const std::array<const char*, N>& words) {
  const Json& value = command::field(object, field);
  std::string all;
  for (std::size_t i = 0; i < N; ++i) {
    if (value == words[i]) return static_cast<Enum>(i);
    all += (i == 0 ? "" : ", ") + std::string(words[i]);
  }
  throw LineError("\"" + std::string(field) + "\" is " + value.dump() +
                  "; it must be one of: " + all);
}

std::string text_of(const Json& object, const char* field, const std::string& otherwise = {}) {
  if (!object.contains(field) || object[field].is_null()) return otherwise;
  if (!object[field].is_string())
    throw LineError("\"" + std::string(field) + "\" must be a text, not " + object[field].dump());
  return object[field].get<std::string>();
}

double number_of(const Json& object, const char* field, double otherwise) {
  return object.contains(field) ? command::number(object, field) : otherwise;
}

Vector list_of(const Json& object, const char* field) {
  return object.contains(field) && !object[field].is_null() ? command::vector_of(object, field)
                                                            : Vector();
}

/// Returns the rows of a list of lists.
std::vector<Vector> rows_of(const Json& object, const char* field) {
  const Json& list = command::field(object, field);
  if (!list.is_array() || list.empty())
    throw LineError("\"" + std::string(field) + "\" must be a list of configurations");
  std::vector<Vector> out;
  for (const Json& row : list) out.push_back(command::vector_of(Json{{field, row}}, field));
  return out;
}

std::vector<std::string> texts_of(const Json& object, const char* field) {
  std::vector<std::string> out;
  for (const Json& one : object.value(field, Json::array()))
    out.push_back(text_of(Json{{field, one}}, field));
  return out;
}

void require_size(const Vector& values, std::size_t size, const char* what) {
  if (values.size() != static_cast<Eigen::Index>(size))
    throw LineError(std::string(what) + " has " + std::to_string(values.size()) +
                    " elements; the group has " + std::to_string(size) + " axes");
}

Json grasp_json(const Grasp& grasp) {
  return {{"id", grasp.id},
          {"arm", list_json(grasp.arm_joints)},
          {"approach", list_json(grasp.approach_joints)},
          {"hand", list_json(grasp.hand_joints)},
          {"opened", list_json(grasp.pregrasp_joints)},
          {"effort", list_json(grasp.hand_effort)},
          {"object_hand", pose_json(grasp.T_object_hand)},
          {"quality", grasp.quality},
          {"visible", grasp.visible}};
}

}  // namespace

Trial::Trial(const NodeContext& context, Control control)
    : context_(context),
      scenario_(read_scenario(context.scenario, context.seed)),
      system_(context, control == Control::task ? MotionSource::planner : MotionSource::policy),
      view_(system_.bus()),
      goals_(system_.bus().advertise<TaskGoal>()) {
  if (control == Control::motion)
    link_.emplace(system_.network(), view_, context.robot, context.seed);
  const bool ready = system_.network().run_until(
      [&] { return view_.complete() && not_ready(system_.snapshot(), false).empty(); },
      system_.now() + from_seconds(kReadyTimeout));
  begin_ = system_.now();
  if (ready) return;
  std::string missing;
  for (const std::string& one : not_ready(system_.snapshot(), false))
    missing += (missing.empty() ? "" : ", ") + one;
  throw LineError("the system is not ready after 10 s: " +
                  (missing.empty() ? "nothing is observed" : missing));
}

PolicyLink& Trial::link() {
  if (!link_)
    throw LineError(
        "this needs the control \"motion\": with \"task\" the system moves the robot itself");
  return *link_;
}

void Trial::send_task(const Json& task) {
  config::TaskDescription description;
  description.set_kind(text_of(task, "kind"));
  description.set_object(text_of(task, "object"));
  description.set_human(text_of(task, "human"));
  description.set_surface(text_of(task, "surface"));
  static constexpr std::array kInstructions = {TaskKind::pause, TaskKind::resume, TaskKind::cancel,
                                               TaskKind::acknowledge, TaskKind::speed};
  for (const TaskKind kind : kInstructions) {
    if (description.kind() != name(kind)) continue;
    goals_->publish({.id = ++tasks_sent_, .kind = kind, .value = number_of(task, "value", 1.0)});
    return;
  }
  goals_->publish(make_goal(description, ++tasks_sent_));
}

void Trial::send_hand(const Json& command) {
  HandCommand out;
  static constexpr std::array kActions = {"move", "grasp", "release_on_pull", "release"};
  out.action = word_of<HandAction>(command, "action", kActions);
  out.group = text_of(command, "group");
  out.position = command::vector_of(command, "position");
  out.effort = list_of(command, "effort");
  out.pull_force = number_of(command, "pull_force", out.pull_force);
  out.payload = number_of(command, "payload", 0.0);
  const Group* fingers = context_.robot->group(out.group.empty() ? "hand" : out.group);
  if (fingers == nullptr) throw LineError("the robot has no hand group \"" + out.group + "\"");
  require_size(out.position, fingers->axes.size(), "\"position\" of the hand");
  link().hand(out);
}

void Trial::act(const std::string& key, const Json& value) {
  if (key == "task") return send_task(value);
  if (key == "hand") return send_hand(value);
  if (key == "stop") return link().stop();
  if (key == "hold") return link().hold(text_of(Json{{key, value}}, "hold"));
  if (key == "engage") {
    const bool giving = scenario_.tasks().empty() || scenario_.tasks(0).kind() != "receive";
    return link().engage(text_of(Json{{key, value}}, "engage"), giving);
  }
  if (key == "run") {
    const auto plan =
        value.is_number_unsigned() ? plans_.find(value.get<std::uint64_t>()) : plans_.end();
    if (plan == plans_.end()) throw LineError("there is no plan " + value.dump());
    return link().run(plan->second);
  }
  if (key != "target")
    throw LineError("an action has no \"" + key +
                    "\"; it has: task, run, target, stop, hand, hold, engage");
  const std::string group = text_of(value, "group", "arm");
  const Group* axes = context_.robot->group(group);
  if (axes == nullptr) throw LineError("the robot has no group \"" + group + "\"");
  const Vector target = command::vector_of(value, "position");
  require_size(target, axes->axes.size(), "\"position\" of the target");
  MotionPlan plan = link().direct(group, target, number_of(value, "speed", 1.0));
  if (!plan.reason.empty()) throw LineError("no motion to the target: " + plan.reason);
  link().run(std::move(plan));
}

void Trial::step(const Json& action, double duration) {
  if (!(duration > 0 && duration <= kMaxStep))
    throw LineError("\"duration\" must be above 0 and at most 3600 s");
  if (!action.is_null() && !action.is_object())
    throw LineError("\"action\" must be an object or null");
  if (action.is_object())
    for (const auto& [key, value] : action.items()) act(key, value);
  system_.network().run_for(from_seconds(duration));
}

/// Returns whether the oracle has seen the task of the scenario done, as `handsel eval` decides it.
bool Trial::succeeded() const {
  if (scenario_.tasks().empty()) return false;
  const config::TaskDescription& task = scenario_.tasks(0);
  const GroundTruth& truth = system_.snapshot().ground_truth.sample;
  if (truth.dropped) return false;
  if (task.kind() != "give" && task.kind() != "receive") {
    const Seen<TaskStatus>& status = system_.snapshot().task;
    return status.ever && status.sample.state == TaskState::succeeded;
  }
  const bool is_watched = task.object().empty() || truth.object == task.object();
  return is_watched && truth.handovers > 0 && (task.kind() == "give" || truth.carrier == "surface");
}

Json Trial::state() const {
  const GroundTruth& truth = system_.snapshot().ground_truth.sample;
  const double time = to_seconds(system_.now() - begin_);
  const double timeout = scenario_.timeout() > 0 ? scenario_.timeout() : kDefaultTimeout;
  const bool done = succeeded();
  Json tasks = Json::array();
  for (const config::TaskDescription& task : scenario_.tasks()) tasks.push_back(task_json(task));
  return {{"observation", observation(view_, *context_.robot, system_.snapshot(), time)},
          {"reward", done ? 1.0 : 0.0},
          {"terminated", done || truth.dropped},
          {"truncated", !done && !truth.dropped && time >= timeout},
          {"info",
           {{"success", done},
            {"seed", context_.seed},
            {"robot", context_.description.string()},
            {"tasks", std::move(tasks)},
            {"oracle", oracle(truth)}}}};
}

Json Trial::grasps(const Json& request) {
  const double count = number_of(request, "max_grasps", 20);
  if (!(count >= 1 && count <= kMaxGrasps)) throw LineError("\"max_grasps\" must be in 1 .. 200");
  const GraspReply reply =
      link().grasps(text_of(request, "object"), text_of(request, "human"),
                    text_of(request, "group", "arm"), static_cast<std::uint32_t>(count));
  Json list = Json::array();
  for (const Grasp& grasp : reply.grasps) list.push_back(grasp_json(grasp));
  return {{"grasps", std::move(list)}, {"reason", reply.reason}};
}

Json Trial::plan(const Json& request) {
  MotionQuery query;
  query.group = text_of(request, "group", query.group);
  query.goals = rows_of(request, "goals");
  query.allowed = texts_of(request, "allowed");
  query.straight = request.value("straight", false);
  query.speed = number_of(request, "speed", query.speed);
  query.time_limit = number_of(request, "time_limit", query.time_limit);
  query.hand = list_of(request, "hand");
  query.from = list_of(request, "from");
  const Group* group = context_.robot->group(query.group);
  const Group* fingers = context_.robot->group("hand");
  if (group == nullptr) throw LineError("the robot has no group \"" + query.group + "\"");
  for (const Vector& goal : query.goals) require_size(goal, group->axes.size(), "a goal");
  if (query.from.size() > 0) require_size(query.from, group->axes.size(), "\"from\"");
  if (query.hand.size() > 0)
    require_size(query.hand, fingers ? fingers->axes.size() : 0, "\"hand\"");
  if (!(query.speed > 0 && query.speed <= 1)) throw LineError("\"speed\" must be in (0, 1]");
  if (!(query.time_limit > 0)) throw LineError("\"time_limit\" must be above 0");
  MotionPlan plan = link().plan(query);
  if (!plan.reason.empty()) return {{"plan", nullptr}, {"reason", plan.reason}};
  Json path = Json::array();
  for (const Vector& waypoint : plan.path) path.push_back(list_json(waypoint));
  const double duration = plan.command.trajectory.duration();
  plans_[++plans_made_] = std::move(plan);
  return {{"plan", plans_made_}, {"reason", ""}, {"duration", duration}, {"path", std::move(path)}};
}

Trial& Environment::trial() {
  if (!trial_) throw LineError("the first request must be \"reset\"");
  return *trial_;
}

Json Environment::carry_out(const Json& request) {
  enum class Request { reset, step, grasps, plan };
  static constexpr std::array kRequests = {"reset", "step", "grasps", "plan"};
  static constexpr std::array kControls = {"task", "motion"};
  switch (word_of<Request>(request, "request", kRequests)) {
    case Request::reset: {
      const double seed = number_of(request, "seed", 1);
      if (!(seed >= 1 && seed <= 1e15 && seed == std::floor(seed)))
        throw LineError("\"seed\" must be a whole number of at least 1");
      const auto control = word_of<Control>(request, "control", kControls);
      trial_.reset();
      trial_ = std::make_unique<Trial>(
          system_context(scenario_, robot_, static_cast<std::uint64_t>(seed)), control);
      return trial_->state();
    }
    case Request::step:
      trial().step(request.value("action", Json(nullptr)), command::number(request, "duration"));
      return trial().state();
    case Request::grasps:
      return trial().grasps(request);
    case Request::plan:
      break;
  }
  return trial().plan(request);
}

Json Environment::answer(const Json& request) {
  try {
    return carry_out(request);
  } catch (const MissingError& error) {
    return {{"error", error.what()}, {"missing", true}};
  } catch (const ConfigError& error) {
    return {{"error", error.what()}};
  } catch (const LineError& error) {
    return {{"error", error.what()}};
  } catch (const Json::exception& error) {
    return {{"error", std::string("a field has another type than expected: ") + error.what()}};
  }
}

}  // namespace handsel::environment
