// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/node.hpp"

#include <algorithm>

#include "common/config/people.hpp"
#include "common/config/resources.hpp"
#include "common/config/settings_text.hpp"
#include "common/cost/cost_settings.hpp"

namespace handsel::manipulation_planner {
namespace {

settings::ManipulationPlannerSettings load_settings(const NodeContext& context) {
  SettingsText text;
  auto s = settings::read_manipulation_planner_settings(
      context.settings / "manipulation_planner.txtpb", &text);
  if (s.live_period > 0) {
    if (s.live_max_period < s.live_period)
      text.refuse("live_max_period", "must be at least live_period");
    if (!(s.replan_time > 0)) text.refuse("replan_time", "must be above 0 unless live_period is 0");
    if (!(s.live_reach > 0)) text.refuse("live_reach", "must be above 0 unless live_period is 0");
  }
  if (s.otp_max_ahead < s.otp_min_ahead)
    text.refuse("otp_max_ahead", "must be at least otp_min_ahead");
  if (s.otp_max_below < s.otp_min_below)
    text.refuse("otp_max_below", "must be at least otp_min_below");
  if (s.place_min_gap > s.place_gap) text.refuse("place_min_gap", "must be at most place_gap");
  const double longest_rest = std::max({s.offer_rest, s.offer_detour_rest, s.offer_long_rest,
                                        s.offer_max_turn_time, s.offer_retreat_end});
  if (s.offer_trail <= longest_rest)
    text.refuse("offer_trail",
                "must be above offer_rest, offer_detour_rest, offer_long_rest, "
                "offer_max_turn_time and offer_retreat_end");
  s.people = load_people(context.settings).people;
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
    static constexpr Duration kModelled = std::chrono::milliseconds(60);
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
  if (!changed(status, sent_) && to_seconds(now - status_sent_) < 0.99 * settings_.status_period)
    return;
  status_out_->publish(status);
  sent_ = status;
  status_sent_ = now;
}

}  // namespace handsel::manipulation_planner
