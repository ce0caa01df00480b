#include "components/attention/settings.hpp"

#include <algorithm>
#include <span>

#include "common/config/located.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/attention.pb.h"
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

/// With the place before what is wrong.
template <class F>
void at(const std::string& place, const F& check) {
  try {
    check();
  } catch (const ConfigError& error) {
    throw ConfigError(place + ": " + error.what());
  }
}

BehaviourSettings behaviour_of(const config::AttentionBehaviour& b, const TextPlace& place) {
  BehaviourSettings s;
  s.name = b.name();
  constexpr std::span<const char* const> kProgrammed(kBehaviourNames, static_cast<std::size_t>(Behaviour::watch));
  if (b.name().empty() || b.name().size() > 32) throw ConfigError(place.of("name") + ": a name has 1 to 32 characters");
  s.behaviour = b.kind() == config::BY_NAME ? one_of<Behaviour>(b.name(), kProgrammed, place.of("name"))
                                            : static_cast<Behaviour>(static_cast<int>(b.kind()) - 1);
  const ClockLaw law = b.law() == config::WEBER ? ClockLaw::weber : b.law() == config::FIXED ? ClockLaw::fixed : ClockLaw::linear;
  s.clock = {law, b.p_min(), b.p_max(), b.near(), b.far(), b.weber_gain(), b.period()};
  at(place.of("p_max"), [&] { AdaptiveClock(s.clock, {}, b.name()); });
  for (int i = 0; i < b.released_when_size(); ++i)
    at(place.of("released_when", i), [&] { s.conditions.push_back(parse_condition(b.released_when(i))); });
  if (s.behaviour != Behaviour::watch) {
    if (!b.input().empty()) throw ConfigError(place.of("input") + ": only a behaviour of kind WATCH has an input of its own");
    return s;
  }
  s.watch = {one_of<Input>(b.input(), kInputNames, place.of("input")),
             b.slow_from(),
             b.slow_at(),
             b.slow_factor(),
             static_cast<GazeAt>(b.gaze()),
             b.reason()};
  if (b.slow_from() > 0 && !(b.slow_at() >= 0 && b.slow_at() < b.slow_from()))
    throw ConfigError(place.of("slow_at") + ": slow_at must be in [0, slow_from)");
  if (b.slow_from() > 0 && !(b.slow_factor() >= 0 && b.slow_factor() <= 1))
    throw ConfigError(place.of("slow_factor") + ": slow_factor must be in [0, 1]");
  if (b.slow_from() > 0 && b.reason().empty()) throw ConfigError(place.of("name") + ": what slows the arm needs a reason");
  return s;
}

WorkSettings work_of(const config::AttentionWork& w, const TextPlace& place) {
  if (!(w.p_min() > 0)) throw ConfigError(place.of("p_min") + ": p_min must be above 0 s");
  if (!(w.p_max() >= w.p_min())) throw ConfigError(place.of("p_max") + ": p_max must not be below p_min");
  return {one_of<Work>(w.name(), kWorkNames, place.of("name")), w.p_min(), w.p_max(), w.period(), {w.serves().begin(), w.serves().end()}};
}

/// Whether behaviours and works fit each other.
void check_together(const AttentionSettings& s, const TextPlace& root) {
  std::vector<Releaser> before;
  constexpr std::size_t kMaxBehaviours = 16;  // bound of AttentionState.behaviours
  if (s.behaviours.size() > kMaxBehaviours)
    throw ConfigError(root.inside("behaviours", static_cast<int>(kMaxBehaviours)).of("name") + ": there are " +
                      std::to_string(s.behaviours.size()) + " behaviours; at most " + std::to_string(kMaxBehaviours) + " are allowed");
  for (std::size_t i = 0; i < s.behaviours.size(); ++i) {
    const std::string place = root.inside("behaviours", static_cast<int>(i)).of("name");
    for (const Releaser& other : before)
      if (other.behaviour == s.behaviours[i].name) throw ConfigError(place + ": behaviour " + other.behaviour + " is described twice");
    before.push_back({s.behaviours[i].name, s.behaviours[i].conditions});
  }
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::none_of(before[i].conditions.begin(), before[i].conditions.end(),
                     [](const Condition& c) { return c.kind == Condition::Kind::behaviour; }))
      continue;
    at(root.inside("behaviours", static_cast<int>(i)).of("released_when"), [&] { releaser_order(before); });
  }
  for (std::size_t i = 0; i < s.works.size(); ++i)
    for (std::size_t k = 0; k < s.works[i].serves.size(); ++k)
      if (std::none_of(before.begin(), before.end(), [&](const Releaser& r) { return r.behaviour == s.works[i].serves[k]; }))
        throw ConfigError(root.inside("works", static_cast<int>(i)).of("serves", static_cast<int>(k)) + ": behaviour \"" +
                          s.works[i].serves[k] + "\" is not described");
}

double share(double value, double low, double high, const char* key, const std::filesystem::path& file) {
  if (!(value >= low && value <= high))
    throw ConfigError(locate(file, std::string(key) + ":") + ": " + key + " must be in [" + std::to_string(low) + ", " +
                      std::to_string(high) + "]");
  return value;
}

}  // namespace

AttentionSettings load_settings(const std::filesystem::path& file) {
  config::AttentionSettings read;
  google::protobuf::TextFormat::ParseInfoTree tree;
  load_text_proto(file, read, tree);
  AttentionSettings s;
  s.off = read.off();
  s.tick = share(read.tick(), 0.001, 0.1, "tick", file);
  s.gaze_dwell = share(read.gaze_dwell(), 0, 60, "gaze_dwell", file);
  s.gaze_advantage = share(read.gaze_advantage(), 0, 1, "gaze_advantage", file);
  s.near_cost_gain = share(read.near_cost_gain(), 1, 100, "near_cost_gain", file);
  s.zones.limits = {read.contact_zone(), read.danger_zone(), read.interaction_zone(), read.social_zone()};
  double inner = 0.0;
  for (double limit : s.zones.limits) {
    if (!(limit > inner)) throw ConfigError(locate(file, "contact_zone:") + ": the zones must grow: contact, danger, interaction, social");
    inner = limit;
  }
  s.zones.margin = share(read.zone_margin(), 0, 1, "zone_margin", file);
  s.zones.dwell = share(read.zone_dwell(), 0, 60, "zone_dwell", file);
  MotorSettings& m = s.motor;
  m.avoid_stop = share(read.avoid_stop(), 0, 10, "avoid_stop", file);
  m.avoid_slow = share(read.avoid_slow(), m.avoid_stop + 1e-6, 10, "avoid_slow", file);
  m.avoid_contact_time = share(read.avoid_contact_time(), 1e-3, 10, "avoid_contact_time", file);
  m.partner_slow = share(read.partner_slow(), m.avoid_stop + 1e-6, 10, "partner_slow", file);
  m.partner_contact_time = share(read.partner_contact_time(), 1e-3, 10, "partner_contact_time", file);
  m.avoid_recede = share(read.avoid_recede(), 0, 1, "avoid_recede", file);
  m.recoil_factor = share(read.recoil_factor(), -1, 0, "recoil_factor", file);
  m.recoil_speed = share(read.recoil_speed(), 0, 10, "recoil_speed", file);
  m.ease_distance = share(read.ease_distance(), 1e-3, 10, "ease_distance", file);
  m.ease_factor = share(read.ease_factor(), 0, 1, "ease_factor", file);
  m.hand_near = share(read.hand_near(), 1e-3, 10, "hand_near", file);
  m.hand_factor = share(read.hand_factor(), 0, 1, "hand_factor", file);
  m.shift_limit = share(read.shift_limit(), 0, 10, "shift_limit", file);
  m.lost_after = share(read.lost_after(), 0, 60, "lost_after", file);
  m.reach_near = share(read.reach_near(), 1e-3, 10, "reach_near", file);
  m.reach_hold = share(read.reach_hold(), 0, 10, "reach_hold", file);
  const TextPlace root(file.string(), &tree, config::AttentionSettings::descriptor());
  for (int i = 0; i < read.behaviours_size(); ++i) s.behaviours.push_back(behaviour_of(read.behaviours(i), root.inside("behaviours", i)));
  for (int i = 0; i < read.works_size(); ++i) s.works.push_back(work_of(read.works(i), root.inside("works", i)));
  check_together(s, root);
  return s;
}

}  // namespace handsel::attention
