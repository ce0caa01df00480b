#include "components/attention/attention.hpp"

#include <algorithm>
#include <set>

#include "common/base/errors.hpp"

namespace handsel::attention {

Attention::Attention(const AttentionSettings& settings, const Body& body) : settings_(settings) {
  if (!(settings.tick > 0)) throw ConfigError("attention: tick must be above 0 s");
  if (!(settings.motor.avoid_slow > settings.motor.avoid_stop)) throw ConfigError("attention: avoid_slow must be above avoid_stop");
  if (!(settings.near_cost_gain >= 1)) throw ConfigError("attention: near_cost_gain must not be below 1");
  if (settings.behaviours.empty()) throw ConfigError("attention: no behaviour is described");
  std::set<Behaviour> seen;
  for (const BehaviourSettings& b : settings.behaviours) {
    if (!seen.insert(b.behaviour).second)
      throw ConfigError(std::string("attention: behaviour ") + name(b.behaviour) + " is described twice");
    entries_.push_back({name(b.behaviour), make_schema(b.behaviour, body, settings.motor, settings.zones),
                        AdaptiveClock(b.clock, from_seconds(0.5 * settings.tick), name(b.behaviour)), b.clock});
  }
}

void Attention::step(const World& world, TimePoint now) {
  now_ = now;
  if (settings_.off) return;
  for (Entry& e : entries_) {
    if (e.clock.due(now)) {
      e.stimulus = e.schema->perceive(world, now);
      e.clock.fire(e.stimulus, now);
    }
    e.released = e.schema->released(world);
  }
  choose_gaze(now);
}

void Attention::choose_gaze(TimePoint now) {
  const auto wants = [](const Entry& e) { return e.released && e.schema->gaze().has_value(); };
  int best = -1;
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (wants(entries_[i]) && (best < 0 || entries_[i].clock.period() < entries_[static_cast<std::size_t>(best)].clock.period()))
      best = static_cast<int>(i);
  if (gaze_ >= 0 && wants(entries_[static_cast<std::size_t>(gaze_)])) {
    if (best == gaze_ || to_seconds(now - gaze_since_) < settings_.gaze_dwell) return;
    const double mine = entries_[static_cast<std::size_t>(gaze_)].clock.period();
    if (entries_[static_cast<std::size_t>(best)].clock.period() >= settings_.gaze_advantage * mine) return;
  }
  if (best != gaze_) gaze_since_ = now;
  gaze_ = best;
}

AttentionAdvice Attention::advice() const {
  AttentionAdvice advice;
  if (settings_.off) return advice;
  double shortest = 0.0;
  for (const Entry& e : entries_) {
    const Behaviour kind = e.schema->kind();
    const bool about_people = kind != Behaviour::pick && kind != Behaviour::place && kind != Behaviour::search;
    if (about_people && (shortest == 0.0 || e.clock.period() < shortest)) shortest = e.clock.period();
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
    if (kind == Behaviour::avoid) {
      const double urgency = 1.0 - (e.clock.period() - e.settings.p_min) / std::max(1e-9, e.settings.p_max - e.settings.p_min);
      advice.cost_gain = 1.0 + (settings_.near_cost_gain - 1.0) * urgency;
    }
    if (const auto shift = e.schema->target_shift()) {
      advice.has_target_shift = true;
      advice.target_shift = *shift;
    }
  }
  advice.people_period = shortest;
  if (gaze_ >= 0) {
    if (const auto target = entries_[static_cast<std::size_t>(gaze_)].schema->gaze()) {
      advice.has_gaze_target = true;
      advice.gaze_target = *target;
    }
  }
  return advice;
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
