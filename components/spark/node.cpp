#include "components/spark/node.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

#include "common/config/people.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/scenario.pb.h"
#include "components/spark/capture_age.hpp"

namespace handsel::spark {
namespace {

config::SparkSettings load_settings(const NodeContext& context) {
  config::SparkSettings settings;
  load_text_proto(context.settings / "spark.txtpb", settings);
  if (settings.publish_period() <= 0 || settings.human_period() <= 0)
    throw ConfigError("spark.txtpb: publish_period and human_period must be > 0");
  if (!(settings.news_period() > 0) || settings.longest_period() < std::max(settings.human_period(), settings.publish_period()))
    throw ConfigError("spark.txtpb: news_period must be > 0 and longest_period not below human_period and publish_period");
  if (!(settings.max_view_age() > 0)) throw ConfigError("spark.txtpb: max_view_age must be > 0");
  std::set<std::string> clocks;
  for (const config::SourceClock& clock : settings.clocks())
    if (clock.source().empty() || !clocks.insert(clock.source()).second)
      throw ConfigError(locate(context.settings / "spark.txtpb", "clocks") + ": each of clocks needs a source of its own, not \"" +
                        clock.source() + "\"");
  check_quotas(settings, context.settings / "spark.txtpb");
  *settings.mutable_people() = load_people(context.settings).people();
  return settings;
}

config::Scenario load_scenario(const NodeContext& context) {
  config::Scenario scenario;
  if (!context.scenario.empty()) load_text_proto(context.scenario, scenario);
  return scenario;
}

/// The floor of every place, z = 0 in the world: no arm goes there. What stands on it, the robot's own feet too, does not touch it.
SceneBox floor() {
  constexpr double kWide = 12.0, kThick = 0.1, kBelow = 0.002;  // [m]
  return {"floor", make_pose({0, 0, -kBelow - 0.5 * kThick}), {kWide, kWide, kThick}, false};
}

std::vector<SceneBox> boxes_of(const config::Scenario& scenario) {
  std::vector<SceneBox> boxes{floor()};
  for (const auto& box : scenario.boxes()) {
    const auto& xyz = box.pose().xyz();
    const auto& rpy = box.pose().rpy();
    const Eigen::Quaterniond q = Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
                                 Eigen::AngleAxisd(rpy.x(), Vector3::UnitX());
    boxes.push_back(
        {box.id(), make_pose({xyz.x(), xyz.y(), xyz.z()}, q), {box.size().x(), box.size().y(), box.size().z()}, box.supports()});
  }
  return boxes;
}

std::map<std::string, Vector3> eyes_of(const config::Scenario& scenario, const Calibration& calibration) {
  std::map<std::string, Vector3> eyes;
  for (const auto& [name, source] : calibration.sources())
    if (source.own_frame) eyes[name] = source.T_world_camera.translation();
  for (const auto& sensor : scenario.human_sensors()) {
    const auto& xyz = sensor.pose().xyz();
    if (sensor.occlusion()) eyes[sensor.source()] = {xyz.x(), xyz.y(), xyz.z()};
  }
  return eyes;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context) : Node(bus, context, load_scenario(context)) {}

Node::Node(Bus& bus, const NodeContext& context, const config::Scenario& place)
    : bus_(bus),
      settings_(load_settings(context)),
      calibration_(context.settings / "calibration.txtpb"),
      eyes_(eyes_of(place, calibration_)),
      tracker_(settings_, eyes_),
      scene_(settings_, context.robot, context.objects, boxes_of(place)),
      facts_(settings_, context.robot, context.objects),
      facts_pace_(settings_.human_period(), settings_.longest_period(), settings_.human_period()),
      scene_pace_(settings_.publish_period(), settings_.longest_period(), settings_.human_period()),
      news_pace_(settings_.news_period(), settings_.longest_period(), settings_.news_period()),
      human_out_(bus.advertise<HumanState>()),
      scene_out_(bus.advertise<Scene>()),
      facts_out_(bus.advertise<Facts>()),
      quotas_(quotas_of(settings_)),
      started_(bus.now()) {
  bus.subscribe<HumanObservation>([this](const HumanObservation& observation, const Receipt& receipt) { observe(observation, receipt); });
  bus.subscribe<ObjectObservation>([this](const ObjectObservation& observation, const Receipt& receipt) {
    ObjectObservation there = observation;
    calibration_.to_world(there);
    scene_.observe(there, receipt.arrival - receipt.age);
    publish_news(bus_.now());
  });
  bus.subscribe<RobotState>([this, robot = context.robot->name()](const RobotState& state, const Receipt&) {
    if (state.robot == robot)
      scene_.update(state);
    else
      bus_.count_left_out("robot_state: of another robot", 1);
  });
  bus.subscribe<TaskGoal>([this](const TaskGoal& goal, const Receipt&) {
    scene_.want(goal.object);
    if (goal.kind == TaskKind::clear_person && tracker_.clear(goal.human, bus_.now()) > 0) publish_people(bus_.now());
  });
  bus.subscribe<SafetyState>([this](const SafetyState& safety, const Receipt& receipt) {
    // A transient local sample may be older than its receipt says; a clock that differs only makes people older.
    const Duration since = safety.stamp > 0 ? std::max(receipt.age, Duration(bus_.stamp_now() - safety.stamp)) : receipt.age;
    tracker_.adopt(safety.lost, receipt.arrival - since, started_);
    knows_lost_ = true;
  });
  bus.subscribe<AttentionAdvice>([this](const AttentionAdvice& advice, const Receipt& r) {
    facts_pace_.advise(advice.people_period, r.arrival);
    scene_pace_.advise(advice.objects_period, r.arrival);
    news_pace_.advise(advice.objects_period, r.arrival);
  });
  bus.every(from_seconds(std::min(settings_.human_period(), settings_.publish_period())), [this](TimePoint now) {
    if (to_seconds(now - people_published_) >= 0.99 * settings_.human_period()) publish_people(now);
    interpret(now);
  });
}

void Node::observe(const HumanObservation& observation, const Receipt& receipt) {
  HumanObservation there = observation;
  calibration_.to_world(there);
  const Stamp arrival = bus_.stamp_now() - (bus_.now() - receipt.arrival).count();
  const CaptureAge captured =
      capture_age(observation.stamp, arrival, to_seconds(receipt.age), settings_.least_latency(), clock_of(settings_, observation.source));
  const TimePoint seen = receipt.arrival - from_seconds(captured.age);
  if (!captured.unknown.empty()) {
    tracker_.refuse(there, captured.unknown, receipt.arrival);
    publish_people(bus_.now());
    return;
  }
  const Coverage reach = scene_.reach();
  const std::uint32_t bodies = tracker_.observe(there, seen, eyes_.empty() ? Obstacles{} : scene_.obstacles(), &reach, captured.age);
  bodies_left_out_.add(bodies, receipt.arrival);
  bus_.count_left_out("bodies of an observation: farther than the nearest " + std::to_string(quotas_.bodies), bodies);
  const LeftOut tracks = tracker_.keep_nearest(bus_.now(), reach);
  bus_.count_left_out("people remembered: farther than the nearest " + std::to_string(quotas_.tracks), tracks.count);
  count_left_out("observations of people: more than " + std::to_string(quotas_.sources) + " sources", tracker_.refused_observations(),
                 refused_counted_);
  publish_people(bus_.now());
}

void Node::count_left_out(const std::string& what, std::uint64_t so_far, std::uint64_t& counted) {
  bus_.count_left_out(what, so_far - counted);
  counted = so_far;
}

/// Returns everybody as of now. Before the safety state has been heard "nobody is there" is no fact: somebody may have been lost before.
HumanState Node::people(TimePoint now, LeftOut* left_out) const {
  HumanState state = tracker_.state(now, scene_.reach(), left_out);
  state.covered = state.covered && knows_lost_;
  return state;
}

void Node::publish_people(TimePoint now) {
  HumanState people = this->people(now, &people_left_out_);
  people.left_out += bodies_left_out_.get(now);
  bus_.count_left_out("people: farther than the nearest " + std::to_string(quotas_.people), people.left_out);
  human_out_->publish(people);
  people_published_ = now;
}

void Node::publish(const Scene& scene, TimePoint now) {
  bus_.count_left_out("objects: less relevant than " + std::to_string(quotas_.objects) + " others", scene_.objects_left_out());
  bus_.count_left_out("boxes: farther than the nearest " + std::to_string(quotas_.boxes), scene_.boxes_left_out());
  count_left_out("objects remembered: less relevant than " + std::to_string(quotas_.known_objects) + " others", scene_.forgotten(),
                 forgotten_counted_);
  scene_out_->publish(scene);
  scene_pace_.done(now);
  revision_published_ = scene.revision;
}

void Node::publish_news(TimePoint now) {
  if (!news_pace_.due(now)) return;
  news_pace_.done(now);
  const Scene scene = scene_.scene(now, people(now));
  if (scene.revision != revision_published_) publish(scene, now);
}

std::string Node::trouble(TimePoint now) const {
  std::string out;
  const auto add = [&out](const std::string& sentence) {
    if (!sentence.empty()) out += (out.empty() ? "" : "; ") + sentence;
  };
  add(tracker_.trouble(now));
  if (people_left_out_.count > 0 && people_left_out_.nearest <= arm_radius(scene_.reach())) {
    char text[160];
    std::snprintf(text, sizeof text, "%u people are left out, the nearest %.2f m from the robot and within reach of the arm",
                  people_left_out_.count, people_left_out_.nearest);
    add(text);
  }
  add(scene_.trouble(now));
  return out;
}

void Node::interpret(TimePoint now) {
  bus_.set_degraded(trouble(now));
  const bool facts_due = facts_pace_.due(now), scene_due = scene_pace_.due(now);
  if (!facts_due && !scene_due) return;
  const HumanState all = people(now);
  const Scene scene = scene_.scene(now, all);
  if (facts_due) {
    const Facts facts = facts_.find(scene, all, now);
    bus_.count_left_out("facts: less relevant than " + std::to_string(quotas_.facts) + " others", facts.left_out);
    facts_out_->publish(facts);
    facts_pace_.done(now);
  }
  if (scene_due || scene.revision != revision_published_) publish(scene, now);
}

}  // namespace handsel::spark
