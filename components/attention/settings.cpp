// SPDX-License-Identifier: Apache-2.0
#include "components/attention/settings.hpp"

#include <algorithm>
#include <span>

#include "common/config/settings/attention.hpp"
#include "common/config/settings_text.hpp"
#include "common/messages/names.hpp"

namespace handsel::attention {

namespace {

template <class E>
E one_of(const std::string& text, std::span<const char* const> names, const std::string& place) {
  const auto at = std::find(names.begin(), names.end(), text);
  if (at != names.end()) return static_cast<E>(at - names.begin());
  std::string list;
  for (const char* name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  throw ConfigError(place + ": \"" + text + "\" is none of " + list);
}

/// Throws the error with its place in the file.
template <class F>
void at(const std::string& place, const F& check) {
  try {
    check();
  } catch (const ConfigError& error) {
    throw ConfigError(place + ": " + error.what());
  }
}

BehaviourSettings behaviour_of(const settings::AttentionBehaviour& b, const TextPlace& place) {
  BehaviourSettings s;
  s.name = b.name;
  constexpr std::span<const char* const> kProgrammed(kBehaviourNames,
                                                     static_cast<std::size_t>(Behaviour::watch));
  if (b.name.empty() || b.name.size() > 32)
    throw ConfigError(place.of("name") + ": a name has 1 to 32 characters");
  s.behaviour = b.kind == settings::AttentionKind::by_name
                    ? one_of<Behaviour>(b.name, kProgrammed, place.of("name"))
                    : static_cast<Behaviour>(static_cast<int>(b.kind) - 1);
  const ClockLaw law = b.law == settings::AttentionLaw::weber    ? ClockLaw::weber
                       : b.law == settings::AttentionLaw::fixed  ? ClockLaw::fixed
                       : b.law == settings::AttentionLaw::margin ? ClockLaw::margin
                                                                 : ClockLaw::linear;
  s.clock = {
      law,      b.p_min,
      b.p_max,  b.near,
      b.far,    b.weber_gain,
      b.period, {b.margin_use, b.margin_distance, b.person_speed, b.robot_speed, b.data_age}};
  if (law == ClockLaw::margin && s.behaviour != Behaviour::avoid)
    throw ConfigError(place.of("law") +
                      ": MARGIN needs the distance to people, which a behaviour of kind AVOID "
                      "observes");
  at(place.of("p_max"), [&] { AdaptiveClock(s.clock, {}, b.name); });
  for (int i = 0; i < static_cast<int>(b.released_when.size()); ++i)
    at(place.of("released_when", i), [&] {
      s.conditions.push_back(parse_condition(b.released_when[static_cast<std::size_t>(i)]));
    });
  if (s.behaviour != Behaviour::watch) {
    if (!b.input.empty())
      throw ConfigError(place.of("input") +
                        ": only a behaviour of kind WATCH has an input of its own");
    return s;
  }
  s.watch = {one_of<Input>(b.input, kInputNames, place.of("input")),
             b.slow_from,
             b.slow_at,
             b.slow_factor,
             static_cast<GazeAt>(b.gaze),
             b.reason};
  if (b.slow_from > 0 && !(b.slow_at >= 0 && b.slow_at < b.slow_from))
    throw ConfigError(place.of("slow_at") + ": slow_at must be in [0, slow_from)");
  if (b.slow_from > 0 && b.reason.empty())
    throw ConfigError(place.of("name") + ": what slows the arm needs a reason");
  return s;
}

WorkSettings work_of(const settings::AttentionWork& w, double max_sensed_period,
                     const TextPlace& place) {
  if (!(w.p_max >= w.p_min))
    throw ConfigError(place.of("p_max") + ": p_max must not be below p_min");
  const Work work = one_of<Work>(w.name, kWorkNames, place.of("name"));
  if ((work == Work::sensed_people || work == Work::sensed_objects) && w.p_max > max_sensed_period)
    throw ConfigError(place.of("p_max") + ": the guard needs a period of " + w.name +
                      " of at most max_sensed_period");
  return {work, w.p_min, w.p_max, w.period, w.serves};
}

/// Checks the consistency of behaviours and works.
void check_together(const AttentionSettings& s, const TextPlace& root) {
  std::vector<Releaser> before;
  constexpr std::size_t kMaxBehaviours = 16;  // bound of AttentionState.behaviours
  if (s.behaviours.size() > kMaxBehaviours)
    throw ConfigError(root.inside("behaviours", static_cast<int>(kMaxBehaviours)).of("name") +
                      ": there are " + std::to_string(s.behaviours.size()) +
                      " behaviours; at most " + std::to_string(kMaxBehaviours) + " are allowed");
  for (std::size_t i = 0; i < s.behaviours.size(); ++i) {
    const std::string place = root.inside("behaviours", static_cast<int>(i)).of("name");
    for (const Releaser& other : before)
      if (other.behaviour == s.behaviours[i].name)
        throw ConfigError(place + ": behaviour " + other.behaviour + " is described twice");
    before.push_back({s.behaviours[i].name, s.behaviours[i].conditions});
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::none_of(before[i].conditions.begin(), before[i].conditions.end(),
                     [](const Condition& c) { return c.kind == Condition::Kind::behaviour; }))
      continue;
    at(root.inside("behaviours", static_cast<int>(i)).of("released_when"),
       [&] { releaser_order(before); });
  }
  for (std::size_t i = 0; i < s.works.size(); ++i)
    for (std::size_t k = 0; k < s.works[i].serves.size(); ++k)
      if (std::none_of(before.begin(), before.end(),
                       [&](const Releaser& r) { return r.behaviour == s.works[i].serves[k]; }))
        throw ConfigError(
            root.inside("works", static_cast<int>(i)).of("serves", static_cast<int>(k)) +
            ": behaviour \"" + s.works[i].serves[k] + "\" is not described");
}

/// Checks the order of related limits.
void check_order(const settings::AttentionSettings& read, const SettingsText& text) {
  double inner = 0.0;
  for (double limit :
       {read.contact_zone, read.danger_zone, read.interaction_zone, read.social_zone}) {
    if (!(limit > inner))
      text.refuse("contact_zone", "the zones must grow: contact, danger, interaction, social");
    inner = limit;
  }
  constexpr double kMinWidth = 1e-6;  // min width of a range [m]
  const MotorSettings& m = read.motor;
  if (!(m.avoid_slow >= m.avoid_stop + kMinWidth))
    text.refuse("avoid_slow", "must be above avoid_stop");
  if (!(m.partner_slow >= m.avoid_stop + kMinWidth))
    text.refuse("partner_slow", "must be above avoid_stop");
}

}  // namespace

AttentionSettings load_settings(const std::filesystem::path& file) {
  SettingsText text;
  const settings::AttentionSettings read = settings::read_attention_settings(file, &text);
  check_order(read, text);
  AttentionSettings s;
  s.off = read.off;
  s.tick = read.tick;
  s.gaze_dwell = read.gaze_dwell;
  s.gaze_advantage = read.gaze_advantage;
  s.near_cost_gain = read.near_cost_gain;
  s.max_sensed_period = read.max_sensed_period;
  s.region_size = read.region_size;
  s.zones.limits = {read.contact_zone, read.danger_zone, read.interaction_zone, read.social_zone};
  s.zones.margin = read.zone_margin;
  s.zones.dwell = read.zone_dwell;
  s.motor = read.motor;
  int place = 0;
  for (const auto& b : read.behaviours)
    s.behaviours.push_back(behaviour_of(b, text.root().inside("behaviours", place++)));
  place = 0;
  for (const auto& w : read.works)
    s.works.push_back(work_of(w, read.max_sensed_period, text.root().inside("works", place++)));
  check_together(s, text.root());
  return s;
}

}  // namespace handsel::attention
