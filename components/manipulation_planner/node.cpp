#include "components/manipulation_planner/node.hpp"

#include "common/config/people.hpp"
#include "common/config/resources.hpp"
#include "common/cost/cost_settings.hpp"

namespace handsel::manipulation_planner {
namespace {

config::ManipulationPlannerSettings load_settings(const NodeContext& context) {
  config::ManipulationPlannerSettings s;
  load_text_proto(context.settings / "manipulation_planner.txtpb", s);
  const auto positive = [](const char* key, double value) {
    if (value <= 0)
      throw ConfigError(std::string("manipulation_planner.txtpb: ") + key + " must be > 0");
  };
  positive("request_retry", s.request_retry());
  positive("request_timeout", s.request_timeout());
  positive("motion_attempts", s.motion_attempts());
  positive("max_grasps", s.max_grasps());
  positive("max_grasps_onto", s.max_grasps_onto());
  positive("planning_time", s.planning_time());
  positive("carry_speed", s.carry_speed());
  positive("approach_speed", s.approach_speed());
  positive("status_period", s.status_period());
  positive("regrasp_timeout", s.regrasp_timeout());
  if (s.w_preference() < 0)
    throw ConfigError("manipulation_planner.txtpb: w_preference must be >= 0");
  *s.mutable_people() = load_people(context.settings).people();
  if (s.live_period() < 0)
    throw ConfigError("manipulation_planner.txtpb: live_period must be >= 0");
  if (s.live_period() > 0) {
    if (s.live_max_period() < s.live_period())
      throw ConfigError(
          "manipulation_planner.txtpb: live_max_period must not be below live_period");
    positive("live_time", s.live_time());
    positive("replan_time", s.replan_time());
    positive("live_reach", s.live_reach());
    if (s.live_slower() < 0 || s.live_gain() < 0 || s.live_gain() >= 1 || s.live_pace() < 0 ||
        s.live_pace() >= 1)
      throw ConfigError(
          "manipulation_planner.txtpb: live_slower must be >= 0, live_gain and live_pace in [0, "
          "1)");
  }
  return s;
}

std::uint64_t client_id(const Bus& bus) { return static_cast<std::uint64_t>(bus.stamp_now()); }

bool changed(const ActionStatus& a, const ActionStatus& b) {
  return a.id != b.id || a.state != b.state || a.phase != b.phase || a.holding != b.holding ||
         a.exchange_engaged != b.exchange_engaged;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      settings_(load_settings(context)),
      core_(settings_, context.robot, context.objects, client_id(bus),
            load_cost_settings(context.settings)),
      grasp_out_(bus.advertise<GraspRequest>()),
      regrasp_out_(bus.advertise<RegraspRequest>()),
      path_out_(bus.advertise<PathRequest>()),
      trajectory_request_out_(bus.advertise<TrajectoryRequest>()),
      trajectory_out_(bus.advertise<TrajectoryCommand>()),
      hand_out_(bus.advertise<HandCommand>()),
      status_out_(bus.advertise<ActionStatus>()) {
  feed<ActionGoal>();
  feed<Scene>();
  feed<HumanState>();
  feed<Facts>();
  bus.subscribe<Costmap>([this](const Costmap& layer, const Receipt& receipt) {
    core_.on(layer, receipt.arrival - receipt.age, receipt.arrival);
  });
  bus.subscribe<AttentionAdvice>(
      [this](const AttentionAdvice& advice, const Receipt& r) { core_.on(advice, r.arrival); });
  feed<ExecutionStatus>();
  feed<ActiveTrajectory>();
  feed<GraspReply>();
  feed<RegraspReply>();
  feed<PathReply>();
  feed<TrajectoryReply>();
  bus.every(from_seconds(0.02), [this](TimePoint now) { step(now); });
}

template <class M>
void Node::feed() {
  bus_.subscribe<M>([this](const M& message, const Receipt&) { core_.on(message); });
}

void Node::step(TimePoint now) {
  Outbox out;
  core_.step(now, out);
  for (auto& m : out.grasp_requests) grasp_out_->publish(m);
  for (auto& m : out.regrasp_requests) regrasp_out_->publish(m);
  for (auto& m : out.path_requests) path_out_->publish(m);
  for (auto& m : out.trajectory_requests) trajectory_request_out_->publish(m);
  for (auto& m : out.trajectories) trajectory_out_->publish(m);
  for (auto& m : out.hand_commands) hand_out_->publish(m);
  for (auto& job : out.jobs) {
    constexpr Duration kModelled = std::chrono::milliseconds(60);
    bus_.run_job(
        [job = std::move(job)](const CancelToken&) {
          job();
          return kModelled;
        },
        [this] { core_.job_done(); });
  }
  bus_.set_degraded(core_.complaint(now));
  publish_status(now);
}

void Node::publish_status(TimePoint now) {
  const ActionStatus& status = core_.status();
  if (!changed(status, sent_) && to_seconds(now - status_sent_) < 0.99 * settings_.status_period())
    return;
  status_out_->publish(status);
  sent_ = status;
  status_sent_ = now;
}

}  // namespace handsel::manipulation_planner
