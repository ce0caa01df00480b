// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/eval/criteria.hpp"

#include <algorithm>
#include <cmath>

#include "common/cost/human_cost.hpp"
#include "common/cost/person_frame.hpp"
#include "common/messages/attention.hpp"

namespace handsel {
namespace {

constexpr double kNear = 0.40;             // max distance of a person that requires a reaction [m]
constexpr double kCarried = 0.05;          // min path length of interest [m]
constexpr double kToward = 0.1;            // min closing speed [m/s]
constexpr double kSlower = 0.9;            // fraction of the previous speed factor
constexpr double kLate = 0.2;              // max reaction time [s]
constexpr double kGivenUp = 1.0;           // value of a missing reaction [s]
constexpr double kStill = 0.05;            // max speed of a joint at rest [m/s]
constexpr double kMaxTruthInterval = 0.1;  // max interval of ground truth that counts [s]
constexpr double kClose = 0.5;             // max distance at which closing speeds count [m]
constexpr double kPassing = 2.0;  // max distance at which visibility to the person counts [m]
constexpr double kJump = 0.1;     // min jump of ground truth by a changed exemption [m]
constexpr Duration kBefore = std::chrono::milliseconds(500);

constexpr const char* kWorks[] = {"people", "objects", "forecast", "cost_map", "replan"};
constexpr const char* kSensorWorks[] = {"sensed_people", "sensed_objects", "sensed_region"};
constexpr const char* kChain[] = {
    "spark",        "costmap",       "collision_checker",  "attention",
    "path_planner", "grasp_planner", "trajectory_planner", "manipulation_planner"};
constexpr const char* kRuns[][2] = {
    {"Facts", "facts"},        {"Scene", "scene"},       {"TrajectoryForecast", "forecast"},
    {"Costmap", "cost_map"},   {"PathRequest", "paths"}, {"TrajectoryRequest", "trajectories"},
    {"GraspRequest", "grasps"}};

constexpr std::uint32_t kForPeople = bit(Cause::attention_slow) | bit(Cause::separation) |
                                     bit(Cause::forecast_collision) | bit(Cause::cost_ahead);

double quantile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(values.size()))) -
                1];
}

/// Returns the horizontal angle between the front of a person and a point, world [m]: 0 in front,
/// pi behind [rad]; nullopt if the point is at the person's centre.
std::optional<double> angle_from_front(const Person& person, const Vector3& p) {
  const Vector3 to_point = p - find_joint(person, "torso")->position,
                front = torso_axes(person).col(0);
  const Eigen::Vector2d a = to_point.head<2>(), b = front.head<2>();
  const double lengths = a.norm() * b.norm();
  if (lengths <= 0) return std::nullopt;
  return std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0));
}

/// Speed of the person's fastest joint, and closing speed of the joint nearest to `p` [m/s].
struct PersonMotion {
  double fastest{}, toward{};
};

PersonMotion motion(const std::vector<BodyJoint>& before, const std::vector<BodyJoint>& now,
                    const Vector3& p, double step) {
  PersonMotion motion;
  if (before.size() != now.size() || step <= 0) return motion;
  double nearest = 1e9;
  for (std::size_t i = 0; i < now.size(); ++i) {
    motion.fastest = std::max(motion.fastest, (now[i].position - before[i].position).norm() / step);
    const double distance = (now[i].position - p).norm();
    if (distance > nearest) continue;
    nearest = distance;
    motion.toward = ((before[i].position - p).norm() - distance) / step;
  }
  return motion;
}

}  // namespace

Criteria::Criteria(Bus& bus, LocalNetwork& network) : network_(network) {
  network.meter({std::begin(kChain), std::end(kChain)});
  bus.subscribe<GroundTruth>(
      [this](const GroundTruth& ground_truth, const Receipt& r) { on(ground_truth, r.arrival); });
  bus.subscribe<ExecutionStatus>(
      [this](const ExecutionStatus& status, const Receipt& r) { on(status, r.arrival); });
  bus.subscribe<ActiveTrajectory>([this](const ActiveTrajectory& active, const Receipt& r) {
    running_ = active.trajectory != 0;
    speed_factor_ = running_ ? active.speed_factor : 0.0;
    std::erase_if(speed_samples_,
                  [&](const SpeedSample& sample) { return r.arrival - sample.at > kBefore; });
    speed_samples_.push_back({r.arrival, speed_factor_});
    settle(r.arrival);
  });
  bus.subscribe<AttentionAdvice>([this](const AttentionAdvice& a, const Receipt&) {
    const std::array<double, 5> periods{a.people_period, a.objects_period, a.forecast_period,
                                        a.cost_map_period, a.replan_period};
    for (std::size_t i = 0; i < periods.size(); ++i)
      rates_[i] += periods[i] > 0 ? 1.0 / periods[i] : 0.0;
    ++advices_;
  });
  bus.subscribe<SensorRequest>([this](const SensorRequest& r, const Receipt&) {
    sensing_.rates[0] += r.people_rate;
    sensing_.rates[1] += r.objects_rate;
    sensing_.rates[2] += r.region_rate > 0 ? r.region_rate : r.objects_rate;
    ++sensing_.requests;
  });
  bus.subscribe<HumanObservation>([this](const HumanObservation& m, const Receipt&) {
    ++sensing_.samples;
    for (const ObservedPerson& person : m.people) sensing_.values += person.joints.size();
  });
  bus.subscribe<ObjectObservation>([this](const ObjectObservation& m, const Receipt&) {
    ++sensing_.samples;
    sensing_.values += m.objects.size();
  });
}

void Criteria::settle(TimePoint now) {
  if (!waiting_) return;
  const double since = to_seconds(now - waiting_->since);
  if (speed_factor_ > kSlower * waiting_->before && since < kGivenUp) return;
  reactions_.push_back(since);
  waiting_.reset();
}

void Criteria::on(const ExecutionStatus& status, TimePoint) {
  const bool limits = (status.causes & bit(Cause::separation)) != 0 && running_;
  interventions_ += limits && !limited_;
  limited_ = limits;
  status_ = status;
}

void Criteria::on(const GroundTruth& ground_truth, TimePoint now) {
  if (last_) {
    const double step = std::clamp(ground_truth.sim_time - last_->sim_time, 0.0, kMaxTruthInterval);
    const PersonMotion person =
        motion(last_->person, ground_truth.person, status_.nearest_on_robot, step);
    const bool moves = person.fastest > kStill;
    if (!ground_truth.robot_moving) robot_idle_ += step;
    if (!moves) person_idle_ += step;
    if (moves && ground_truth.robot_moving) concurrent_ += step;
    if (!moves && !ground_truth.robot_moving) both_idle_ += step;
    if (limited_) limited_for_ += step;
    if (ground_truth.robot_moving && status_.separation < status_.separation_limit)
      below_for_ += step;
    const double nearer = last_->separation - ground_truth.separation;
    if (step > 0 && last_->separation < kClose && nearer < kJump)
      closing_speed_ = std::max(closing_speed_, nearer / step);
    const bool entered = ground_truth.separation < kNear && last_->separation >= kNear;
    if (entered && !waiting_ && running_ && ground_truth.robot_moving && person.toward > kToward) {
      double max_factor =
          (status_.causes & kForPeople) != 0 ? 1.0 : speed_factor_;  // value without people nearby
      for (const SpeedSample& sample : speed_samples_)
        max_factor = std::max(max_factor, sample.speed_factor);
      if (max_factor > 0.1) waiting_ = Reaction{now, max_factor};
      settle(now);
    }
  }
  watch_handover(ground_truth);
  watch_passing(ground_truth);
  last_ = ground_truth;
}

void Criteria::watch_handover(const GroundTruth& ground_truth) {
  const Vector3 p = ground_truth.T_world_object.translation();
  const std::string before = last_ ? last_->carrier : "";
  if (ground_truth.carrier == "robot") {
    const double up = ground_truth.T_world_object.linear()(2, 2);
    max_tilt_ = std::max(max_tilt_.value_or(0.0), std::acos(std::clamp(up, -1.0, 1.0)));
    if (before == "robot" && carried_from_)
      carried_ += (p - last_->T_world_object.translation()).norm();
    else if (before != "both")
      carried_from_ = p, carried_ = 0;
  }
  if (ground_truth.carrier != "both" || (before != "robot" && before != "human") ||
      ground_truth.person.size() != kBodyJoints.size())
    return;
  Person person;
  person.joints = ground_truth.person;
  discomfort_ = arm_comfort_cost(person, p);
  legibility_.reset();
  if (before == "robot" && carried_from_ && carried_ > kCarried)
    legibility_ = std::min(1.0, (p - *carried_from_).norm() / carried_);
}

void Criteria::watch_passing(const GroundTruth& ground_truth) {
  const bool is_nearer = last_ && ground_truth.separation < last_->separation,
             is_nearest = !nearest_ || ground_truth.separation < *nearest_;
  if (!ground_truth.robot_moving || !(is_nearer || is_nearest) ||
      ground_truth.person.size() != kBodyJoints.size())
    return;
  Person person;
  person.joints = ground_truth.person;
  const std::optional<double> angle = angle_from_front(person, status_.nearest_on_robot);
  if (is_nearer && angle && *angle > M_PI / 2 && ground_truth.separation < kPassing)
    unseen_approach_ += std::min(ground_truth.sim_time - last_->sim_time, kMaxTruthInterval);
  if (!is_nearest) return;
  nearest_ = ground_truth.separation;
  if (angle) nearest_angle_ = angle;
}

nlohmann::json Criteria::fields() const {
  using Json = nlohmann::json;
  std::vector<double> reactions = reactions_;
  if (waiting_) reactions.push_back(kGivenUp);
  Json cpu = Json::object(), runs = Json::object(), periods = Json::object();
  double chain = 0;
  for (const char* component : kChain) {
    cpu[component] = network_.cpu(component);
    chain += network_.cpu(component);
  }
  for (const auto& [type, run] : kRuns) runs[run] = 0;
  for (const LocalNetwork::Endpoint& end : network_.endpoints())
    for (const auto& [type, run] : kRuns)
      if (end.writes && end.type == type) runs[run] = runs[run].get<std::uint64_t>() + end.samples;
  for (std::size_t i = 0; i < rates_.size(); ++i)
    periods[kWorks[i]] =
        rates_[i] > 0 ? Json(static_cast<double>(advices_) / rates_[i]) : Json(nullptr);
  for (std::size_t i = 0; i < sensing_.rates.size(); ++i)
    periods[kSensorWorks[i]] =
        sensing_.rates[i] > 0 ? Json(static_cast<double>(sensing_.requests) / sensing_.rates[i])
                              : Json(nullptr);
  return {{"reactions_s", reactions},
          {"reaction_p50_s", reactions.empty() ? Json(nullptr) : Json(quantile(reactions, 0.5))},
          {"reaction_p99_s", reactions.empty() ? Json(nullptr) : Json(quantile(reactions, 0.99))},
          {"late_reactions",
           std::count_if(reactions.begin(), reactions.end(), [](double r) { return r > kLate; })},
          {"interventions", interventions_},
          {"intervention_s", limited_for_},
          {"below_separation_s", below_for_},
          {"closing_speed_m_s", closing_speed_},
          {"robot_idle_s", robot_idle_},
          {"person_idle_s", person_idle_},
          {"concurrent_s", concurrent_},
          {"functional_delay_s", both_idle_},
          {"discomfort", discomfort_ ? Json(*discomfort_) : Json(nullptr)},
          {"legibility", legibility_ ? Json(*legibility_) : Json(nullptr)},
          {"nearest_angle_rad", nearest_angle_ ? Json(*nearest_angle_) : Json(nullptr)},
          {"unseen_approach_s", unseen_approach_},
          {"max_tilt_rad", max_tilt_ ? Json(*max_tilt_) : Json(nullptr)},
          {"cpu_s", cpu},
          {"cpu_chain_s", chain},
          {"runs", runs},
          {"work_period_s", periods},
          {"sensor_samples", sensing_.samples},
          {"sensor_values", sensing_.values}};
}

}  // namespace handsel
