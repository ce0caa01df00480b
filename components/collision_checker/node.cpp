// SPDX-License-Identifier: Apache-2.0
#include "components/collision_checker/node.hpp"

#include "common/config/settings/collision_checker.hpp"
#include "common/config/settings_text.hpp"
#include "common/cost/cost_settings.hpp"

namespace handsel::collision_checker {
namespace {

constexpr int kTicksPerPeriod = 4;       // ticks per min period, to which periods are rounded
constexpr std::size_t kMaxQueries = 16;  // max number of waiting queries of up to 4096 states
constexpr Duration kLayerWatch = std::chrono::milliseconds(200);  // period of layer checks

settings::CollisionCheckerSettings load(const NodeContext& context) {
  SettingsText text;
  const auto file = context.settings / "collision_checker.txtpb";
  const auto s = settings::read_collision_checker_settings(file, &text);
  if (s.max_period < s.period) text.refuse("max_period", "must not be below period");
  return s;
}

ForecastSettings core_settings(const settings::CollisionCheckerSettings& s) {
  return {s.horizon, s.min_speed, s.spacing, s.robot_ahead, s.min_approach};
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      robot_(context.robot),
      forecaster_(*context.robot, context.objects, load_cost_settings(context.settings),
                  core_settings(load(context))),
      query_world_(*context.robot, context.objects),
      advised_period_(load(context).period, load(context).max_period,
                      load(context).period / kTicksPerPeriod),
      forecast_out_(bus.advertise<TrajectoryForecast>()),
      verdict_out_(bus.advertise<StateVerdict>()) {
  const settings::CollisionCheckerSettings settings = load(context);
  check_time_ = settings.check_time;
  max_age_ = from_seconds(settings.max_age);
  bus.subscribe<ActiveTrajectory>([this](const ActiveTrajectory& active, const Receipt&) {
    if (active.trajectory != active_.trajectory) news_ = true;
    active_ = active;
  });
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt&) {
    if (!scene_ || scene.revision != scene_->revision) news_ = true;
    scene_ = std::make_shared<Scene>(scene);
    scene_waits_ = true;
  });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) {
    people_ = std::make_shared<HumanState>(people);
    people_wait_ = true;
  });
  bus.subscribe<Costmap>([this](const Costmap& layer, const Receipt& receipt) {
    layers_.put(layer, receipt.arrival - receipt.age, receipt.arrival);
    forecaster_.set_layers(layers_.at(receipt.arrival));
  });
  bus.subscribe<AttentionAdvice>([this](const AttentionAdvice& advice, const Receipt& r) {
    advised_period_.advise(advice.forecast_period, r.arrival);
  });
  bus.every(kLayerWatch, [this](TimePoint now) { forecaster_.set_layers(layers_.at(now)); });
  bus.subscribe<StateQuery>([this](const StateQuery& query, const Receipt&) { answer(query); });
  bus.every(from_seconds(settings.period / kTicksPerPeriod),
            [this](TimePoint now) { forecast(now); });
}

void Node::forecast(TimePoint now) {
  if (!news_ && !advised_period_.due(now)) return;
  const std::string missing =
      bus_.lag<ActiveTrajectory>() > max_age_ ? "no current ActiveTrajectory: no forecast"
      : bus_.lag<Scene>() > max_age_          ? "no current Scene: no forecast"
      : bus_.lag<HumanState>() > max_age_     ? "no current HumanState: no forecast"
                                              : "";
  bus_.set_degraded(missing.empty() ? layers_.complaint(now) : missing);
  if (!missing.empty()) return;
  news_ = false;
  if (scene_waits_) forecaster_.set_scene(*scene_);
  if (people_wait_) forecaster_.set_people(*people_);
  scene_waits_ = people_wait_ = false;
  advised_period_.done(now);
  forecast_out_->publish(forecaster_.forecast(active_));
}

void Node::answer(const StateQuery& query) {
  struct Work {
    StateQuery query;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const HumanState> people;
    StateVerdict verdict;
  };
  const bool full = queries_waiting_ >= kMaxQueries;
  if (full) bus_.count_left_out("state queries: too many wait", 1);
  auto work = std::make_shared<Work>(Work{query, scene_, people_, {}});
  if (!work->scene || !work->people || full) {
    work->verdict.id = query.id;
    work->verdict.reason = full ? std::to_string(kMaxQueries) +
                                      " queries wait already, which is the limit; ask again later"
                           : work->scene ? "no state of people is known"
                                         : "no scene is known";
    work->verdict.free.assign(query.states.size(), 0);
    verdict_out_->publish(work->verdict);
    return;
  }
  ++queries_waiting_;
  bus_.run_job(
      [this, work](const CancelToken&) {
        query_world_.set_scene(*work->scene);
        query_world_.set_people(*work->people);
        const std::uint64_t before = query_world_.checks();
        work->verdict = check_states(*robot_, query_world_, work->query);
        return from_seconds(check_time_ * static_cast<double>(query_world_.checks() - before));
      },
      [this, work] {
        --queries_waiting_;
        verdict_out_->publish(work->verdict);
      });
}

}  // namespace handsel::collision_checker
