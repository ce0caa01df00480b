// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/node.hpp"

#include "components/grasp_planner/choice/grasp_answer.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr const char* kFull = "16 requests wait already, which is the limit; ask again later";

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      settings_(load_settings(context.settings)),
      objects_(context.objects),
      robot_(context.robot),
      arms_(load_arms(*robot_, context.description, settings_)),
      lists_(bus, context.objects, arms_),
      regrasp_settings_(regrasp_settings(settings_)),
      reply_out_(bus.advertise<GraspReply>()),
      regrasp_out_(bus.advertise<RegraspReply>()),
      candidates_out_(bus.advertise<GraspCandidates>()),
      holding_(context.objects, static_cast<int>(settings_.holding_samples)),
      candidates_(settings_.candidates_time, settings_.candidates_moved) {
  const auto platform = mobile(*robot_, context.description);
  for (const ArmGrasps& arm : arms_)
    choosers_.push_back(std::make_shared<const GraspChooser>(robot_, arm.hand_geometry, objects_,
                                                             settings_, arm.arm.name, platform));
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt&) {
    scene_ = scene;
    lists_.prepare(scene);
  });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) { on(people); });
  bus.subscribe<GraspRequest>(
      [this](const GraspRequest& request, const Receipt&) { answer(request); });
  bus.subscribe<RegraspRequest>(
      [this](const RegraspRequest& request, const Receipt&) { answer(request); });
  bus.every(from_seconds(settings_.candidates_period), [this](TimePoint now) { propose(now); });
}

void Node::answer(const GraspRequest& request) {
  if (const GraspReply* known = requests_.reply(request.id); known != nullptr) {
    reply_out_->publish(*known);
    return;
  }
  if (requests_.waits(request.id)) return;
  if (requests_.full()) {
    bus_.count_left_out("grasp requests: too many wait", 1);
    GraspReply reply;
    reply.id = request.id;
    reply.reason = kFull;
    reply_out_->publish(reply);
    return;
  }
  requests_.add(request.id);
  choose(request, true);
}

void Node::choose(const GraspRequest& request, bool reply) {
  const auto result = std::make_shared<GraspReply>();
  result->id = request.id;
  const SceneObject* object = object_in(scene_, request.object);
  const ObjectModel* model = object != nullptr ? objects_(object->model) : nullptr;
  result->reason = objection(request, scene_, *robot_, arms_, model);
  const bool work = result->reason.empty();
  if (work) candidates_.on_choice(object->T_world_object);
  const std::size_t arm = work ? arm_of(request, arms_) : 0;
  bus_.run_job(
      [cache = arms_[arm].cache, transfers = arms_[arm].transfers,
       left_transfers = arms_[arm].left_transfers, chooser = choosers_[arm], request,
       scene = scene_, people = people(), model, result, work](const CancelToken& token) {
        if (!work) return Duration{};
        const auto cancelled = [&token] { return token.cancelled(); };
        try {
          const auto page = cache->page(*model, cancelled);
          if (!page) {
            result->reason = "cancelled";
            return Duration{};
          }
          const auto table = transfers ? transfers->known(model->name) : nullptr;
          const auto left = left_transfers ? left_transfers->known(model->name) : nullptr;
          const Choice choice = chooser->choose(
              {request, page->list, *page->object, scene, people, cancelled, table.get()});
          write(choice, page->list, *result);
          if (request.for_human.empty()) return choice_time(choice);
          if (table) add_partners(page->list, *table, Side::right, *result);
          if (left) add_partners(page->list, *left, Side::left, *result);
          return choice_time(choice);
        } catch (const ConfigError& e) {
          result->reason = e.what();
          return Duration{};
        }
      },
      [this, result, request, reply] {
        candidates_.on_grasps(request.object, result->grasps);
        if (!reply) return;
        requests_.finish(*result);
        reply_out_->publish(*result);
        candidates_.on_answer(request, bus_.now());
      });
}

void Node::answer(const RegraspRequest& request) {
  if (regrasps_.waits(request.id)) return;
  if (const RegraspReply* known = regrasps_.reply(request.id); known != nullptr) {
    regrasp_out_->publish(*known);
    return;
  }
  if (regrasps_.full()) {
    bus_.count_left_out("regrasp requests: too many wait", 1);
    RegraspReply reply;
    reply.id = request.id;
    reply.reason = kFull;
    regrasp_out_->publish(reply);
    return;
  }
  regrasps_.add(request.id);
  auto answer = std::make_shared<RegraspAnswer>();
  answer->reply.id = request.id;
  answer->reply.reason = objection(request, scene_, *robot_, arms_, objects_);
  const bool work = answer->reply.reason.empty();
  const ObjectModel* model = work ? objects_(object_in(scene_, request.object)->model) : nullptr;
  bus_.run_job(
      [this, answer, request, model, scene = scene_](const CancelToken& token) {
        if (model == nullptr) return Duration{};
        try {
          *answer = answer_regrasp(request, {*robot_, arms_, objects_, scene, regrasp_settings_},
                                   *model, [&token] { return token.cancelled(); });
        } catch (const ConfigError& e) {
          answer->reply.reason = e.what();
        }
        return regrasp_time(*answer);
      },
      [this, answer] {
        regrasps_.finish(answer->reply);
        regrasp_out_->publish(answer->reply);
      });
}

void Node::propose(TimePoint now) {
  if (!candidates_.active(now)) return;
  const SceneObject* object = object_in(scene_, candidates_.request().object);
  if (object == nullptr || object->holder == Holder::robot || object->holder == Holder::human)
    return;
  if (candidates_.renew(object->T_world_object)) choose(candidates_.request(), false);
  if (candidates_.message().grasps.empty()) return;
  candidates_out_->publish(candidates_.message());
}

}  // namespace handsel::grasp_planner
