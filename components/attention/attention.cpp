// SPDX-License-Identifier: Apache-2.0
#include "components/attention/attention.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "common/base/errors.hpp"
#include "components/attention/object_search.hpp"

namespace handsel::attention {

namespace {

/// Returns whether the period of the work has a bound which the guard needs.
bool is_bounded(Work work) { return work == Work::sensed_people || work == Work::sensed_objects; }

}  // namespace

Attention::Attention(const AttentionSettings& settings, const Body& body)
    : settings_(settings), body_(body) {
  if (!(settings.tick > 0)) throw ConfigError("attention: tick must be above 0 s");
  if (!(settings.motor.avoid_slow > settings.motor.avoid_stop))
    throw ConfigError("attention: avoid_slow must be above avoid_stop");
  if (!(settings.near_cost_gain >= 1))
    throw ConfigError("attention: near_cost_gain must not be below 1");
  if (settings.behaviours.empty()) throw ConfigError("attention: no behaviour is described");
  std::vector<Releaser> releasers;
  for (const BehaviourSettings& b : settings.behaviours) {
    const std::string called = b.name.empty() ? name(b.behaviour) : b.name;
    if (find(called) != nullptr)
      throw ConfigError("attention: behaviour " + called + " is described twice");
    entries_.push_back(
        {called, make_schema(b.behaviour, body, settings.motor, settings.zones, b.watch),
         AdaptiveClock(b.clock, from_seconds(0.5 * settings.tick), called), b.clock, b.conditions});
    releasers.push_back({called, b.conditions});
  }
  order_ = releaser_order(releasers);
  std::set<Work> seen;
  for (const WorkSettings& w : settings.works) {
    const std::string what =
        std::string("attention: work ") + kWorkNames[static_cast<std::size_t>(w.work)];
    if (!seen.insert(w.work).second) throw ConfigError(what + " is described twice");
    if (!(w.p_min > 0)) throw ConfigError(what + ": p_min must be above 0 s");
    if (!(w.p_max >= w.p_min)) throw ConfigError(what + ": p_max must not be below p_min");
    if (is_bounded(w.work) && !(w.p_max <= settings.max_sensed_period))
      throw ConfigError(what + ": p_max must not be above max_sensed_period");
    if (w.serves.empty()) throw ConfigError(what + " serves nobody");
    for (const std::string& behaviour : w.serves)
      if (find(behaviour) == nullptr)
        throw ConfigError(what + " serves \"" + behaviour + "\", which is not described");
  }
}

const Attention::Entry* Attention::find(const std::string& behaviour) const {
  for (const Entry& e : entries_)
    if (e.name == behaviour) return &e;
  return nullptr;
}

bool Attention::conditions_met(const Entry& entry, const World& world) const {
  return std::all_of(
      entry.conditions.begin(), entry.conditions.end(), [&](const Condition& condition) {
        return met(
            condition, world,
            condition.kind == Condition::Kind::behaviour && find(condition.behaviour)->released);
      });
}

double Attention::period(const WorkSettings& work) const {
  if (work.period > 0) return work.period;
  double ease = 1.0;
  for (const std::string& behaviour : work.serves) {
    const Entry& e = *find(behaviour);
    if (e.clock.activations() == 0) return work.p_min;
    ease = std::min(ease, (e.clock.period() - e.settings.p_min) /
                              std::max(1e-9, e.settings.p_max - e.settings.p_min));
  }
  return work.p_min + (work.p_max - work.p_min) * std::clamp(ease, 0.0, 1.0);
}

double Attention::period(Work work) const {
  for (const WorkSettings& w : settings_.works)
    if (w.work == work) return period(w);
  return 0;
}

void Attention::step(const World& world, TimePoint now) {
  now_ = now;
  if (settings_.off) return;
  for (const std::size_t index : order_) {
    Entry& e = entries_[index];
    if (e.clock.due(now)) {
      e.stimulus = e.schema->perceive(world, now);
      if (e.settings.rule == ClockLaw::margin) e.stimulus = e.schema->person_distance();
      e.clock.fire(e.stimulus, now);
    }
    e.released = e.schema->released(world) && conditions_met(e, world);
  }
  choose_gaze(now);
}

void Attention::choose_gaze(TimePoint now) {
  const auto wants = [](const Entry& e) { return e.released && e.schema->gaze().has_value(); };
  const auto urgent = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
    return wants(e) && e.schema->needs_gaze();
  });
  if (urgent != entries_.end()) {
    const auto index = static_cast<int>(urgent - entries_.begin());
    if (index != gaze_) gaze_since_ = now;
    gaze_ = index;
    return;
  }
  int best = -1;
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (wants(entries_[i]) &&
        (best < 0 ||
         entries_[i].clock.period() < entries_[static_cast<std::size_t>(best)].clock.period()))
      best = static_cast<int>(i);
  if (gaze_ >= 0 && wants(entries_[static_cast<std::size_t>(gaze_)])) {
    if (best == gaze_ || to_seconds(now - gaze_since_) < settings_.gaze_dwell) return;
    const double mine = entries_[static_cast<std::size_t>(gaze_)].clock.period();
    if (entries_[static_cast<std::size_t>(best)].clock.period() >= settings_.gaze_advantage * mine)
      return;
  }
  if (best != gaze_) gaze_since_ = now;
  gaze_ = best;
}

AttentionAdvice Attention::advice() const {
  AttentionAdvice advice;
  if (settings_.off) return advice;
  for (const Entry& e : entries_) {
    const Behaviour kind = e.schema->kind();
    if (const auto wish = e.schema->wish()) {
      advice.change = wish->change;
      advice.person = wish->person;
    }
    if (!e.released) continue;
    const double factor = std::clamp(e.schema->speed_factor(), -1.0, 1.0);
    if (factor < advice.speed_factor) {
      advice.speed_factor = factor;
      advice.limiting = e.name;
      advice.reason = e.schema->reason();
    }
    advice.leaves_path = advice.leaves_path || e.schema->leaves_path();
    if (kind == Behaviour::avoid) {
      const double urgency = 1.0 - (e.clock.period() - e.settings.p_min) /
                                       std::max(1e-9, e.settings.p_max - e.settings.p_min);
      advice.cost_gain = 1.0 + (settings_.near_cost_gain - 1.0) * urgency;
    }
    if (const auto shift = e.schema->target_shift()) {
      advice.has_target_shift = true;
      advice.target_shift = *shift;
    }
  }
  const std::array<double*, 5> periods{&advice.people_period, &advice.objects_period,
                                       &advice.forecast_period, &advice.cost_map_period,
                                       &advice.replan_period};
  for (std::size_t work = 0; work < periods.size(); ++work)
    *periods[work] = period(static_cast<Work>(work));
  if (gaze_ >= 0) {
    if (const auto target = entries_[static_cast<std::size_t>(gaze_)].schema->gaze()) {
      advice.has_gaze_target = true;
      advice.gaze_target = *target;
    }
  }
  return advice;
}

SensorRequest Attention::sensor_request(const World& world) const {
  SensorRequest request;
  if (settings_.off) {
    request.hands = true;
    return request;
  }
  const auto rate = [](double period) { return period > 0 ? 1 / period : 0; };
  request.people_rate = rate(period(Work::sensed_people));
  request.objects_rate = rate(period(Work::sensed_objects));
  const ActionStatus* action = world.action;
  const bool acts = action != nullptr && action->state == ActionState::running;
  request.hands = acts && !action->human.empty();
  for (const Entry& e : entries_)
    request.hands |= e.released && (e.schema->kind() == Behaviour::give ||
                                    e.schema->kind() == Behaviour::receive);
  if (!acts || action->object.empty()) return request;
  if (world.scene == nullptr || is_object_lost(world, settings_.motor.lost_after)) {
    request.objects_rate = 0;  // it may be anywhere
    return request;
  }
  request.region_rate = rate(period(Work::sensed_region));
  if (request.objects_rate == 0 || request.region_rate <= request.objects_rate) {
    request.region_rate = 0;
    return request;
  }
  request.objects.push_back(action->object);
  if (world.active != nullptr && world.active->position.size() == body_.dof()) {
    const Vector3 p_hand = body_.grasp_point(world.active->position, world.active->T_world_base);
    request.region = {p_hand - Vector3::Constant(settings_.region_size),
                      p_hand + Vector3::Constant(settings_.region_size)};
  }
  return request;
}

AttentionState Attention::state() const {
  AttentionState state;
  const AttentionAdvice now = advice();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& e = entries_[i];
    BehaviourState& b = state.behaviours.emplace_back();
    b.name = e.name;
    b.behaviour = e.schema->kind();
    b.period = e.clock.period();
    b.activations = e.clock.activations();
    b.activations_at_fastest = e.clock.activations_at_fastest(now_);
    b.released = e.released;
    b.stimulus = std::isfinite(e.stimulus) ? e.stimulus : e.settings.far;
    b.speed_factor = std::clamp(e.schema->speed_factor(), -1.0, 1.0);
    b.winner = gaze_ == static_cast<int>(i) || (now.speed_factor < 1 && now.limiting == b.name);
    if (b.speed_factor < 1) b.reason = e.schema->reason();
  }
  return state;
}

}  // namespace handsel::attention
