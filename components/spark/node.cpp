// SPDX-License-Identifier: Apache-2.0
#include "components/spark/node.hpp"

#include <algorithm>

#include "common/config/scenario.hpp"
#include "components/spark/capture_age.hpp"
#include "components/spark/load.hpp"
#include "components/spark/place.hpp"

namespace handsel::spark {

Node::Node(Bus& bus, const NodeContext& context)
    : Node(bus, context, read_scenario(context.scenario, context.seed)) {}

Node::Node(Bus& bus, const NodeContext& context, const config::Scenario& place)
    : bus_(bus),
      settings_(load_settings(context.settings)),
      calibration_(context.settings / "calibration.txtpb"),
      eyes_(viewpoints_of(place, calibration_)),
      tracker_(settings_, eyes_),
      scene_(settings_, context.robot, context.objects, boxes_of(place)),
      facts_(settings_, context.robot, context.objects),
      facts_period_(settings_.human_period, settings_.max_period, settings_.human_period),
      scene_period_(settings_.publish_period, settings_.max_period, settings_.human_period),
      news_period_(settings_.news_period, settings_.max_period, settings_.news_period),
      human_out_(bus.advertise<HumanState>()),
      scene_out_(bus.advertise<Scene>()),
      facts_out_(bus.advertise<Facts>()),
      robots_(bus, settings_, context.robot, context.name),
      left_out_(
          [&bus](const std::string& what, std::uint64_t count) { bus.count_left_out(what, count); },
          quotas_of(settings_)),
      started_(bus.now()) {
  bus.subscribe<HumanObservation>(
      [this](const HumanObservation& observation, const Receipt& receipt) {
        observe(observation, receipt);
      });
  bus.subscribe<ObjectObservation>(
      [this](const ObjectObservation& observation, const Receipt& receipt) {
        ObjectObservation there = observation;
        calibration_.to_world(there);
        scene_.observe(there, receipt.arrival - receipt.age);
        publish_news(bus_.now());
      });
  bus.subscribe<RobotState>(
      [this, robot = context.robot->name()](const RobotState& state, const Receipt&) {
        if (state.robot != robot) return bus_.count_left_out("robot_state: of another robot", 1);
        scene_.update(state);
        robots_.update(state);
      },
      {.wakes = false});
  bus.subscribe<TaskGoal>([this](const TaskGoal& goal, const Receipt&) {
    scene_.request(goal.object);
    if (goal.kind == TaskKind::clear_person && tracker_.clear(goal.human, bus_.now()) > 0)
      publish_people(bus_.now());
  });
  bus.subscribe<SafetyState>([this](const SafetyState& safety, const Receipt& receipt) {
    const Duration since = age_of(safety.stamp, bus_.stamp_now(), receipt.age);
    tracker_.adopt(safety.lost, receipt.arrival - since, started_);
    knows_lost_ = true;
  });
  bus.subscribe<AttentionAdvice>([this](const AttentionAdvice& advice, const Receipt& r) {
    facts_period_.advise(advice.people_period, r.arrival);
    scene_period_.advise(advice.objects_period, r.arrival);
    news_period_.advise(advice.objects_period, r.arrival);
  });
  bus.every(from_seconds(std::min(settings_.human_period, settings_.publish_period)),
            [this](TimePoint now) {
              if (to_seconds(now - people_published_) >= 0.99 * settings_.human_period)
                publish_people(now);
              interpret(now);
            });
}

void Node::observe(const HumanObservation& observation, const Receipt& receipt) {
  HumanObservation there = observation;
  calibration_.to_world(there);
  const Stamp arrival = bus_.stamp_now() - (bus_.now() - receipt.arrival).count();
  const CaptureAge captured =
      capture_age(observation.stamp, arrival, to_seconds(receipt.age), settings_.min_latency,
                  clock_of(settings_, observation.source));
  const TimePoint seen = receipt.arrival - from_seconds(captured.age);
  if (!captured.unknown.empty()) {
    tracker_.refuse(there, captured.unknown, receipt.arrival);
    publish_people(bus_.now());
    return;
  }
  const Coverage reach = scene_.reach();
  const std::uint32_t bodies = tracker_.observe(
      there, seen, eyes_.empty() ? Obstacles{} : scene_.obstacles(), &reach, captured.age);
  left_out_.add_bodies(bodies, receipt.arrival);
  left_out_.add_tracks(tracker_.keep_nearest(bus_.now(), reach), tracker_);
  publish_people(bus_.now());
}

/// Returns the present state of all people. Before the safety state is received, `covered` is
/// false: a person may have been lost before the start.
HumanState Node::people(TimePoint now, LeftOut* left_out) const {
  HumanState state = tracker_.state(now, scene_.reach(), left_out);
  state.covered = state.covered && knows_lost_;
  robots_.add_to(state, now, scene_.reach());
  return state;
}

void Node::publish_people(TimePoint now) {
  LeftOut left_out;
  HumanState people = this->people(now, &left_out);
  left_out_.add_people(left_out, now, people);
  human_out_->publish(people);
  people_published_ = now;
}

void Node::publish(const Scene& scene, TimePoint now) {
  left_out_.add_scene(scene_);
  scene_out_->publish(scene);
  scene_period_.done(now);
  news_.published(scene, now);
}

void Node::publish_news(TimePoint now) {
  if (!news_period_.due(now)) return;
  news_period_.done(now);
  const Scene scene = scene_.scene(now, people(now));
  if (news_.has_news(scene, now)) publish(scene, now);
}

std::string Node::trouble(TimePoint now) const {
  std::string out;
  for (const std::string& one : {tracker_.trouble(now), left_out_.people_in_reach(scene_.reach()),
                                 scene_.trouble(now), robots_.trouble(now)})
    if (!one.empty()) out += (out.empty() ? "" : "; ") + one;
  return out;
}

void Node::interpret(TimePoint now) {
  bus_.set_degraded(trouble(now));
  const bool facts_due = facts_period_.due(now), scene_due = scene_period_.due(now);
  if (!facts_due && !scene_due) return;
  const HumanState all = people(now);
  const Scene scene = scene_.scene(now, all);
  if (facts_due) {
    const Facts facts = facts_.find(scene, all, now);
    left_out_.add_facts(facts);
    facts_out_->publish(facts);
    facts_period_.done(now);
  }
  if (scene_due || news_.has_news(scene, now)) publish(scene, now);
}

}  // namespace handsel::spark
