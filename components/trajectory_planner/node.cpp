// SPDX-License-Identifier: Apache-2.0
#include "components/trajectory_planner/node.hpp"

#include <algorithm>
#include <cmath>

#include "common/cost/cost_settings.hpp"
#include "common/messages/attention.hpp"
#include "common/model/platform.hpp"
#include "components/trajectory_planner/load.hpp"

namespace handsel::trajectory_planner {
namespace {

constexpr double kMaxTilt = 0.02;  // max tilt of a level platform [rad]
constexpr Duration kLayerWatch = std::chrono::milliseconds(200);  // period of layer checks
constexpr Duration kMinModelled = std::chrono::milliseconds(2);   // min modelled planning time
using settings::read_trajectory_planner_settings;

TrajectoryReply refusal(const RequestId& id, const std::string& reason) {
  TrajectoryReply reply;
  reply.id = id;
  reply.reason = reason;
  return reply;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      robot_(context.robot),
      objects_(context.objects),
      weights_(load_cost_settings(context.settings)),
      reply_out_(bus.advertise<TrajectoryReply>()),
      world_(*context.robot, context.objects),
      cost_(*context.robot, weights_) {
  if (!context.description.empty()) on_platform_ = on_platform(*context.robot, context.description);
  const auto file = read_trajectory_planner_settings(context.settings / "trajectory_planner.txtpb");
  settings_ = core_settings(file);
  max_scene_age_ = from_seconds(file.max_scene_age);
  check_time_ = from_seconds(file.check_time);
  bus.subscribe<Scene>(
      [this](const Scene& scene, const Receipt&) { scene_ = std::make_shared<Scene>(scene); });
  bus.subscribe<HumanState>([this](const auto& people, const Receipt&) {
    people_ = std::make_shared<HumanState>(people);
  });
  bus.subscribe<Costmap>([this](const Costmap& layer, const Receipt& receipt) {
    layers_.put(layer, receipt.arrival - receipt.age, receipt.arrival);
  });
  bus.subscribe<AttentionAdvice>([this](const auto& advice, const Receipt& r) {
    cost_gain_.advise(advice.cost_gain, r.arrival);
  });
  bus.every(kLayerWatch, [this](TimePoint now) { bus_.set_degraded(layers_.complaint(now)); });
  bus.subscribe<TrajectoryRequest>([this](const auto& r, const Receipt&) { on_request(r); });
}

void Node::on_request(const TrajectoryRequest& request) {
  using Admission = RequestQueue<TrajectoryReply>::Admission;
  const Admission admission = requests_.admit(request.id);
  if (admission == Admission::answered) reply_out_->publish(*requests_.answer(request.id));
  if (admission == Admission::full) {
    bus_.count_left_out("trajectory requests: too many wait", 1);
    reply_out_->publish(refusal(request.id, requests_.why_full()));
  }
  if (admission != Admission::fresh) return;
  if (const std::string why = not_ready(); !why.empty()) return refuse(request.id, why);
  if (drives(request) && !(scene_->T_world_base.linear()(2, 2) > std::cos(kMaxTilt)))
    return refuse(request.id, "the platform does not stand level: it cannot be planned for");
  start(request);
}

void Node::refuse(const RequestId& id, const std::string& reason) { answer(refusal(id, reason)); }

bool Node::drives(const TrajectoryRequest& request) const {
  return on_platform_ && !handsel::drives(*robot_) && !request.poses.empty() &&
         std::any_of(request.also.begin(), request.also.end(),
                     [&](std::uint32_t axis) { return static_cast<int>(axis) >= robot_->dof(); });
}

std::string Node::not_ready() const {
  if (!scene_ || bus_.lag<Scene>() > max_scene_age_) return "no current scene is known";
  if (!people_ || bus_.lag<HumanState>() > max_scene_age_)
    return "no current state of people is known";
  return scene_->robot_known ? "" : "the robot's place is not known yet";
}

void Node::start(const TrajectoryRequest& request) {
  struct Work {
    TrajectoryRequest request;
    Scene scene;
    Surroundings around;
    LayersNow layers;
    bool driving;
    Result result;
  };
  const double gain = cost_gain_.at(bus_.now()).value_or(1.0);
  auto work = std::make_shared<Work>(Work{request,
                                          *scene_,
                                          {*people_, scene_->T_world_base, gain},
                                          layers_.at(bus_.now()),
                                          drives(request),
                                          {}});
  if (work->driving) {
    if (request.start.size() == robot_->dof())
      work->request.start = with_platform(request.start, scene_->T_world_base);
    work->scene.T_world_base = work->around.T_world_base =
        make_pose({0, 0, scene_->T_world_base.translation().z()});
  }
  bus_.run_job(
      [this, work](const CancelToken&) {
        if (work->driving && !mobile_)
          mobile_ = std::make_unique<Mobile>(*on_platform_, objects_, weights_);
        const RobotModel& robot = work->driving ? *on_platform_ : *robot_;
        CollisionWorld& world = work->driving ? mobile_->world : world_;
        HumanCost& cost = work->driving ? mobile_->cost : cost_;
        world.set_scene(work->scene);
        world.set_people(work->around.people);
        world.set_attachment(work->request.attachment, work->request.allowed_contacts);
        cost.set_people(work->around.people);
        cost.set_layers(work->layers);
        cost.set_gain(work->around.cost_gain);
        cost.set_base(work->around.T_world_base);
        const Group* group = robot.group(work->request.group);
        if (group != nullptr) cost.set_moving_axes(group->axes);
        work->result = plan(robot, world, cost, work->around, work->request, settings_);
        return kMinModelled + check_time_ * static_cast<Duration::rep>(work->result.checks);
      },
      [this, work] { answer(work->result.reply); });
}

void Node::answer(const TrajectoryReply& reply) {
  requests_.close(reply);
  reply_out_->publish(reply);
}

}  // namespace handsel::trajectory_planner
