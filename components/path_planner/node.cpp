// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/node.hpp"

#include <algorithm>
#include <cmath>

#include "common/cost/cost_settings.hpp"
#include "common/messages/attention.hpp"
#include "components/path_planner/load.hpp"
#include "components/path_planner/request.hpp"

namespace handsel::path_planner {
namespace {

constexpr const char* kCancelled = "cancelled on request";
constexpr Duration kLayerWatch = std::chrono::milliseconds(200);  // period of layer checks

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : Node(bus, context,
           settings::read_path_planner_settings(context.settings / "path_planner.txtpb")) {}

Node::Node(Bus& bus, const NodeContext& context, const settings::PathPlannerSettings& file)
    : bus_(bus),
      timing_{file.check_time, file.max_time, from_seconds(file.max_scene_age)},
      reply_out_(bus.advertise<PathReply>()),
      digits_(context.objects, static_cast<int>(file.holding_samples), file.digit_clearance),
      solver_(context.robot, mobile_of(*context.robot, context.description), context.objects,
              load_cost_settings(context.settings), solver_settings(file)) {
  bus.subscribe<Scene>(
      [this](const Scene& scene, const Receipt&) { scene_ = std::make_shared<Scene>(scene); });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) {
    people_ = std::make_shared<HumanState>(people);
    if (scene_) digits_.add(*scene_, people);
  });
  bus.subscribe<Costmap>([this](const Costmap& layer, const Receipt& receipt) {
    layers_.put(layer, receipt.arrival - receipt.age, receipt.arrival);
  });
  bus.subscribe<AttentionAdvice>([this](const auto& advice, const Receipt& r) {
    cost_gain_.advise(advice.cost_gain, r.arrival);
  });
  bus.every(kLayerWatch, [this](TimePoint now) { bus_.set_degraded(layers_.complaint(now)); });
  bus.subscribe<PathRequest>([this](const auto& request, const Receipt&) { on_request(request); });
}

void Node::on_request(const PathRequest& request) {
  if (request.cancel) {
    cancel(request.id);
    return;
  }
  using Admission = RequestQueue<PathReply>::Admission;
  switch (requests_.admit(request.id)) {
    case Admission::under_way:
      return;
    case Admission::answered:
      reply_out_->publish(*requests_.answer(request.id));
      return;
    case Admission::superseded:
      refuse(request.id, "superseded by a newer request of the same client");
      return;
    case Admission::cancelled:
      refuse(request.id, kCancelled);
      return;
    case Admission::full:
      bus_.count_left_out("path requests: too many wait", 1);
      refuse_once(request.id, requests_.why_full());
      return;
    case Admission::fresh:
      break;
  }
  stop_running(request.id.client, request.id.number);
  if (const std::string why = not_ready(); !why.empty()) {
    refuse(request.id, why);
    return;
  }
  PathRequest whole = request;
  if (const std::string why = solver_.complete(whole, scene_->T_world_base); !why.empty()) {
    refuse(request.id, why);
    return;
  }
  start(whole);
}

void Node::cancel(const RequestId& id) {
  stop_running(id.client, id.number);
  for (const RequestId& open : requests_.cancel(id)) refuse(open, kCancelled);
}

std::string Node::not_ready() const {
  if (!scene_ || bus_.lag<Scene>() > timing_.max_scene_age) return "no current scene is known";
  if (!people_ || bus_.lag<HumanState>() > timing_.max_scene_age)
    return "no current state of people is known";
  if (!scene_->robot_known) return "the robot's place is not known yet";
  return {};
}

void Node::start(const PathRequest& request) {
  const auto task = std::make_shared<PlanningTask>(solver_.make_task(request, scene_));
  task->people = people_;
  if (!request.straight)  // reaches for an object or retreats from it, beside the hand
    task->digits = digits_.obstacles(*scene_, *people_, request.allowed_contacts);
  task->layers = layers_.at(bus_.now());
  task->cost_gain = cost_gain_.at(bus_.now()).value_or(1.0);
  const double time = std::clamp(request.time_limit, 0.0, timing_.max_time);
  task->problem.budget = static_cast<std::uint64_t>(std::llround(time / timing_.check_time));
  const auto compute = [&solver = solver_, check_time = timing_.check_time,
                        task](const CancelToken& token) {
    solver.solve(*task, {[&token] { return token.cancelled(); }, {}});
    return from_seconds(check_time * static_cast<double>(task->result.checks));
  };
  running_[request.id.client].emplace(request.id.number,
                                      bus_.run_job(compute, [this, task] { answer(*task); }));
}

void Node::answer(const PlanningTask& task) {
  const RequestId id = task.request.id;
  if (auto& of_client = running_[id.client]; of_client.erase(id.number) > 0 && of_client.empty())
    running_.erase(id.client);
  if (requests_.answer(id) != nullptr) return;  // cancelled
  PathReply reply = reply_of(id, task.result);
  if (!reply.solved && task.result.cancelled && requests_.superseded(id))
    reply.reason = "superseded by a newer request of the same client";
  if (!task.request.running.empty()) {
    ++replan_outcomes_[static_cast<std::size_t>(task.outcome)];
    reply.outcome = static_cast<PathOutcome>(static_cast<int>(task.outcome) +
                                             static_cast<int>(PathOutcome::kept));
  } else if (!reply.solved) {
    reply.outcome = PathOutcome::blocked;
  }
  requests_.close(reply);
  reply_out_->publish(reply);
}

void Node::stop_running(std::uint64_t client, std::uint64_t last) {
  const auto of_client = running_.find(client);
  if (of_client == running_.end()) return;
  for (auto& [number, token] : of_client->second)
    if (number <= last) token.cancel();
}

void Node::refuse(const RequestId& id, const std::string& reason) {
  requests_.close(refusal(id, reason));
  reply_out_->publish(*requests_.answer(id));
}

void Node::refuse_once(const RequestId& id, const std::string& reason) {
  reply_out_->publish(refusal(id, reason));
}

}  // namespace handsel::path_planner
