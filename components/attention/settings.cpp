#include "components/attention/settings.hpp"

#include "common/config/attention.pb.h"
#include "common/config/resources.hpp"

namespace handsel::attention {

namespace {

Behaviour behaviour_named(const std::string& text, const std::filesystem::path& file) {
  for (Behaviour b :
       {Behaviour::search, Behaviour::track, Behaviour::avoid, Behaviour::pick, Behaviour::place, Behaviour::give, Behaviour::receive})
    if (text == name(b)) return b;
  throw ConfigError(locate(file, '"' + text + '"') + ": behaviours.name: \"" + text +
                    "\" is none of search, track, avoid, pick, place, give, receive");
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
  load_text_proto(file, read);
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
  for (const auto& b : read.behaviours()) {
    const ClockLaw law = b.law() == config::WEBER ? ClockLaw::weber : b.law() == config::FIXED ? ClockLaw::fixed : ClockLaw::linear;
    const Behaviour behaviour = behaviour_named(b.name(), file);
    const ClockSettings clock{law, b.p_min(), b.p_max(), b.near(), b.far(), b.weber_gain(), b.period()};
    try {
      AdaptiveClock(clock, {}, b.name());
    } catch (const ConfigError& error) {
      throw ConfigError(locate(file, '"' + b.name() + '"') + ": " + error.what());
    }
    s.behaviours.push_back({behaviour, clock});
  }
  return s;
}

}  // namespace handsel::attention
