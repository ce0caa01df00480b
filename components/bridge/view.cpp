#include "components/bridge/view.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace handsel::bridge {
namespace {

using Json = nlohmann::json;

constexpr int kPathPoints = 40;
constexpr std::uint8_t kLastCause = static_cast<std::uint8_t>(Cause::override_slow);

double rounded(double value) { return std::round(value * 1e4) / 1e4; }
Json number(double value) { return std::isfinite(value) && std::abs(value) < 1e8 ? Json(rounded(value)) : Json(nullptr); }
Json point(const Vector3& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }
double yaw(const Pose& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

const char* name_of(Holder holder) {
  switch (holder) {
    case Holder::nobody:
      return "nobody";
    case Holder::surface:
      return "surface";
    case Holder::robot:
      return "robot";
    case Holder::human:
      return "human";
  }
  return "unknown";
}

const char* name_of(HealthState state) {
  switch (state) {
    case HealthState::starting:
      return "starting";
    case HealthState::ok:
      return "ok";
    case HealthState::degraded:
      return "degraded";
    case HealthState::stopping:
      return "stopping";
  }
  return "unknown";
}

template <class Slot, class M>
void keep(Slot& slot, const M& sample, TimePoint at) {
  slot.ever = true;
  slot.sample = sample;
  slot.at = at;
}

Json person_json(const Person& person) {
  Json joints = Json::object();
  for (const BodyJoint& joint : person.joints) joints[joint.name] = point(joint.position);
  Json result{{"id", person.id}, {"joints", std::move(joints)}, {"age", rounded(person.age)}, {"inflation", rounded(person.inflation)}};
  if (person.gaze_known) result["gaze"] = {point(person.gaze_origin), point(person.gaze_direction)};
  return result;
}

Json health_json(const ComponentHealth& health, double age) {
  double rate = 0.0;
  std::uint64_t misses = 0, rejected = 0;
  for (const TopicHealth& topic : health.topics) {
    rate += topic.rate;
    misses += topic.deadline_misses;
    rejected += topic.rejected;
  }
  return {{"component", health.component}, {"state", name_of(health.state)}, {"reason", health.reason},
          {"age", rounded(age)},           {"rate", rounded(rate)},          {"misses", misses},
          {"rejected", rejected},          {"cpu", rounded(health.cpu)},     {"memory", rounded(health.memory_mb)}};
}

}  // namespace

View::View(std::shared_ptr<const RobotModel> robot) : robot_(std::move(robot)), capsules_(robot_capsules(*robot_)) {}

void View::take(const RobotState& m, TimePoint at) { keep(state_, m, at); }
void View::take(const Scene& m, TimePoint at) { keep(scene_, m, at); }
void View::take(const HumanState& m, TimePoint at) { keep(people_, m, at); }
void View::take(const Facts& m, TimePoint at) { keep(facts_, m, at); }
void View::take(const TaskStatus& m, TimePoint at) { keep(task_, m, at); }
void View::take(const ActionStatus& m, TimePoint at) { keep(action_, m, at); }
void View::take(const ExecutionStatus& m, TimePoint at) { keep(execution_, m, at); }
void View::take(const TrajectoryForecast& m, TimePoint at) { keep(forecast_, m, at); }
void View::take(const AttentionState& m, TimePoint at) { keep(attention_, m, at); }
void View::take(const AttentionAdvice& m, TimePoint at) { keep(advice_, m, at); }
void View::take(const ComponentHealth& m, TimePoint at) { keep(health_[m.component], m, at); }

void View::take(const ActiveTrajectory& m, TimePoint at) {
  keep(active_, m, at);
  if (m.trajectory == path_of_) return;
  path_of_ = m.trajectory;
  path_.clear();
  const int tool = robot_->tool_link();
  const bool arm_moves = m.trajectory != 0 && m.rest.size() == static_cast<int>(m.axes.size()) && m.position.size() == robot_->dof();
  if (tool < 0 || !arm_moves || !state_.ever) return;
  Vector q = m.position;
  MotionState3 sample;
  const auto n = static_cast<Eigen::Index>(m.axes.size());
  sample.position = sample.velocity = sample.acceleration = Vector::Zero(n);
  for (int i = 0; i <= kPathPoints; ++i) {
    m.rest.sample(m.rest.duration() * i / kPathPoints, sample);
    for (Eigen::Index axis = 0; axis < n; ++axis) {
      if (m.axes[static_cast<std::size_t>(axis)] < static_cast<std::uint32_t>(q.size()))
        q[m.axes[static_cast<std::size_t>(axis)]] = sample.position[axis];
    }
    path_.push_back((state_.sample.T_world_base * robot_->link_pose(q, tool)).translation());
  }
}

std::string View::json(TimePoint now) {
  Json page{{"robot", nullptr}, {"people", Json::array()}, {"objects", Json::array()}, {"boxes", Json::array()}, {"health", Json::array()}};
  if (state_.ever && state_.sample.position.size() == robot_->dof()) {
    const RobotState& state = state_.sample;
    robot_->forward(state.position, links_);
    Json shapes = Json::array(), path = Json::array();
    for (const LinkCapsule& capsule : capsules_) {
      const Pose T = state.T_world_base * links_[static_cast<std::size_t>(capsule.link)];
      shapes.push_back({point(T * capsule.a), point(T * capsule.b), rounded(capsule.radius)});
    }
    for (const Vector3& p : path_) path.push_back(point(p));
    page["robot"] = {
        {"name", state.robot}, {"shapes", std::move(shapes)}, {"path", std::move(path)}, {"age", rounded(to_seconds(now - state_.at))}};
    if (people_.ever) {
      const Separation nearest = separation(capsules_, links_, state.T_world_base, people_.sample);
      page["separation"] = {{"distance", number(nearest.distance)}, {"person", nearest.person}};
      if (std::isfinite(nearest.distance)) page["separation"]["line"] = {point(nearest.on_robot), point(nearest.on_person)};
    }
  }
  for (const Person& person : people_.sample.people) page["people"].push_back(person_json(person));
  page["covered"] = people_.ever && people_.sample.covered;
  for (const SceneObject& object : scene_.sample.objects) {
    page["objects"].push_back({{"id", object.id},
                               {"p", point(object.T_world_object.translation())},
                               {"holder", name_of(object.holder)},
                               {"by", object.holder_id}});
  }
  for (const SceneBox& box : scene_.sample.boxes) {
    page["boxes"].push_back(
        {{"id", box.id}, {"p", point(box.T_world_box.translation())}, {"size", point(box.size)}, {"yaw", rounded(yaw(box.T_world_box))}});
  }
  if (task_.ever) {
    const TaskStatus& task = task_.sample;
    page["task"] = {{"id", task.id},     {"kind", name(task.kind)}, {"state", name(task.state)},
                    {"plan", task.plan}, {"step", task.step},       {"reason", task.reason}};
  }
  if (action_.ever) {
    const ActionStatus& action = action_.sample;
    page["action"] = {{"kind", name(action.kind)},
                      {"phase", action.phase},
                      {"holding", action.holding},
                      {"engaged", action.exchange_engaged},
                      {"reason", action.reason}};
    const bool exchange = action.state == ActionState::running && (action.kind == ActionKind::give || action.kind == ActionKind::receive);
    if (exchange && !action.exchange_point.isZero()) page["action"]["exchange"] = point(action.exchange_point);
  }
  if (execution_.ever) {
    const ExecutionStatus& execution = execution_.sample;
    Json causes = Json::array();
    for (std::uint8_t cause = 1; cause <= kLastCause; ++cause) {
      if (execution.causes & (1u << cause)) causes.push_back(name(static_cast<Cause>(cause)));
    }
    page["execution"] = {
        {"mode", name(execution.mode)},
        {"causes", std::move(causes)},
        {"reason", execution.reason},
        {"progress", rounded(execution.progress)},
        {"pull", rounded(execution.pull)},
        {"cycles", execution.cycles},
        {"late", execution.late_cycles},
        {"age", rounded(to_seconds(now - execution_.at))},
        {"share",
         {rounded(execution.limit_share_velocity), rounded(execution.limit_share_acceleration), rounded(execution.limit_share_jerk)}}};
  }
  if (active_.ever) page["speed_factor"] = rounded(active_.sample.speed_factor);
  if (advice_.ever)
    page["advice"] = {{"speed_factor", rounded(advice_.sample.speed_factor)},
                      {"limiting", name(advice_.sample.limiting)},
                      {"reason", advice_.sample.reason}};
  if (forecast_.ever) {
    page["forecast"] = {
        {"collides", forecast_.sample.collides}, {"time", number(forecast_.sample.time_to_collision)}, {"reason", forecast_.sample.reason}};
  }
  Json clocks = Json::array();
  for (const BehaviourState& behaviour : attention_.sample.behaviours) {
    clocks.push_back({{"behaviour", name(behaviour.behaviour)},
                      {"period", rounded(behaviour.period)},
                      {"released", behaviour.released},
                      {"speed_factor", rounded(behaviour.speed_factor)}});
  }
  page["clocks"] = std::move(clocks);
  for (const auto& [component, seen] : health_) page["health"].push_back(health_json(seen.sample, to_seconds(now - seen.at)));
  return page.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace handsel::bridge
