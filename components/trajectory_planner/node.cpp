#include "components/trajectory_planner/node.hpp"

#include "common/config/resources.hpp"
#include "common/config/trajectory_planner.pb.h"
#include "common/cost/cost_settings.hpp"

namespace handsel::trajectory_planner {
namespace {

config::TrajectoryPlannerSettings load(const NodeContext& context) {
  config::TrajectoryPlannerSettings s;
  load_text_proto(context.settings / "trajectory_planner.txtpb", s);
  if (!(s.corner_step() > 0 && s.cost_step() > 0 && s.max_scene_age() > 0 && s.check_time() > 0))
    throw ConfigError("trajectory_planner.txtpb: corner_step, cost_step, max_scene_age and check_time must be > 0");
  if (!(s.least_speed_factor() > 0 && s.least_speed_factor() <= 1))
    throw ConfigError("trajectory_planner.txtpb: least_speed_factor must be in (0, 1]");
  if (!(s.allowed_excess() >= 0 && s.allowed_excess() <= 0.1))
    throw ConfigError("trajectory_planner.txtpb: allowed_excess must be in [0, 0.1]");
  return s;
}

constexpr Duration kLayerWatch = std::chrono::milliseconds(200);
constexpr Duration kLeastModelled = std::chrono::milliseconds(2);

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      robot_(context.robot),
      reply_out_(bus.advertise<TrajectoryReply>()),
      world_(*context.robot, context.objects),
      cost_(*context.robot, load_cost_settings(context.settings)) {
  const config::TrajectoryPlannerSettings file = load(context);
  settings_ = {file.corner_step(), file.cost_step(), file.least_speed_factor(), file.allowed_excess()};
  max_scene_age_ = from_seconds(file.max_scene_age());
  check_time_ = from_seconds(file.check_time());
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt&) { scene_ = std::make_shared<Scene>(scene); });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) { people_ = std::make_shared<HumanState>(people); });
  bus.subscribe<Costmap>(
      [this](const Costmap& layer, const Receipt& receipt) { layers_.put(layer, receipt.arrival - receipt.age, receipt.arrival); });
  bus.every(kLayerWatch, [this](TimePoint now) { bus_.set_degraded(layers_.complaint(now)); });
  bus.subscribe<TrajectoryRequest>([this](const TrajectoryRequest& request, const Receipt&) { on_request(request); });
}

void Node::on_request(const TrajectoryRequest& request) {
  if (const TrajectoryReply* known = desk_.answer(request.id)) {
    reply_out_->publish(*known);
    return;
  }
  if (!desk_.admit(request.id)) return;
  if (const std::string why = not_ready(); !why.empty()) {
    TrajectoryReply reply;
    reply.id = request.id;
    reply.reason = why;
    answer(reply);
    return;
  }
  start(request);
}

std::string Node::not_ready() const {
  if (!scene_ || bus_.lag<Scene>() > max_scene_age_) return "no current scene is known";
  if (!people_ || bus_.lag<HumanState>() > max_scene_age_) return "no current state of people is known";
  if (!scene_->robot_known) return "the robot's place is not known yet";
  return {};
}

void Node::start(const TrajectoryRequest& request) {
  struct Work {
    TrajectoryRequest request;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const HumanState> people;
    LayersNow layers;
    Result result;
  };
  auto work = std::make_shared<Work>(Work{request, scene_, people_, layers_.at(bus_.now()), {}});
  bus_.run_job(
      [this, work](const CancelToken&) {
        world_.set_scene(*work->scene);
        world_.set_people(*work->people);
        world_.set_attachment(work->request.attachment, work->request.allowed_contacts);
        cost_.set_people(*work->people);
        cost_.set_layers(work->layers);
        cost_.set_base(work->scene->T_world_base);
        work->result = plan(*robot_, world_, cost_, work->request, settings_);
        return kLeastModelled + check_time_ * static_cast<Duration::rep>(work->result.checks);
      },
      [this, work] { answer(work->result.reply); });
}

void Node::answer(const TrajectoryReply& reply) {
  desk_.close(reply);
  reply_out_->publish(reply);
}

}  // namespace handsel::trajectory_planner
