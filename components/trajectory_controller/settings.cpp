#include "components/trajectory_controller/settings.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/config/resources.hpp"
#include "common/config/schema/trajectory_controller.pb.h"

namespace handsel::trajectory_controller {

namespace {

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}
  double operator()(double value, const char* key, double low, double high) const {
    if (!(value >= low && value <= high))
      throw ConfigError(locate(file_, std::string(key) + ":") + ": " + key + " must be given, in [" + std::to_string(low) + ", " +
                        std::to_string(high) + "]");
    return value;
  }

 private:
  std::filesystem::path file_;
};

StopProofSettings read_stop_proof(const config::ControllerStopProof& in, const Reader& read, const std::filesystem::path& file) {
  constexpr double kTiny = 1e-6;
  StopProofSettings s;
  s.latency = read(in.latency(), "latency", 0, 0.5);
  s.robot_side_delay = read(in.robot_side_delay(), "robot_side_delay", 0, 0.5);
  s.tracker_error = read(in.tracker_error(), "tracker_error", 0, 1);
  s.speed_error = read(in.speed_error(), "speed_error", 0, 2);
  s.robot_error = read(in.robot_error(), "robot_error", 0, 1);
  s.limit_ratio = read(in.limit_ratio(), "limit_ratio", kTiny, 1);
  s.limit_margin = read(in.limit_margin(), "limit_margin", 0, 1);
  s.finger_ratio = read(in.finger_ratio(), "finger_ratio", 0.01, 1);
  s.max_rejoins = static_cast<int>(read(in.max_rejoins(), "max_rejoins", 0, 1000));
  s.shown_time = read(in.shown_time(), "shown_time", 0, 10);
  s.min_robot_mass = read(in.min_robot_mass(), "min_robot_mass", kTiny, 1000);
  s.min_finger_mass = read(in.min_finger_mass(), "min_finger_mass", kTiny, 1000);
  std::array<bool, kBodyRegions> given{};
  for (const auto& region : in.regions()) {
    const auto found = std::find(std::begin(kBodyRegionNames), std::end(kBodyRegionNames), region.region());
    if (found == std::end(kBodyRegionNames))
      throw ConfigError(locate(file, "regions") + ": stop_proof.regions names \"" + region.region() +
                        "\"; known are head, torso, upper_arm, forearm, hand, thigh and lower_leg");
    const auto k = static_cast<std::size_t>(found - std::begin(kBodyRegionNames));
    if (std::exchange(given[k], true))
      throw ConfigError(locate(file, "regions") + ": stop_proof.regions gives " + region.region() + " twice; once is right");
    s.contact[k] = {read(region.force(), "force", kTiny, 1e4), read(region.stiffness(), "stiffness", kTiny, 1e7),
                    read(region.mass(), "mass", kTiny, 1e3)};
    s.people[k] = {read(region.speed(), "speed", kTiny, 20), read(region.acceleration(), "acceleration", kTiny, 1000)};
  }
  for (std::size_t k = 0; k < kBodyRegions; ++k)
    if (!given[k]) throw ConfigError(locate(file, "stop_proof") + ": stop_proof.regions lacks " + kBodyRegionNames[k]);
  return s;
}

}  // namespace

ControllerSettings load_settings(const std::filesystem::path& file) {
  config::TrajectoryControllerSettings in;
  load_text_proto(file, in);
  const Reader read(file);
  constexpr double kTiny = 1e-6;
  ControllerSettings s;
  s.period = read(in.period(), "period", kTiny, 0.02);
  s.attention_lost_factor = read(in.attention_lost_factor(), "attention_lost_factor", kTiny, 1);
  s.recoil_limit = read(in.recoil_limit(), "recoil_limit", 0, 1);
  s.max_command_age = read(in.max_command_age(), "max_command_age", kTiny, 60);
  s.start_tolerance = read(in.start_tolerance(), "start_tolerance", 0, 1);
  s.cost_from = read(in.cost_from(), "cost_from", 0, 0.999);
  s.cost_factor = read(in.cost_factor(), "cost_factor", kTiny, 1);
  s.yield_speed = read(in.yield_speed(), "yield_speed", 0, 2);
  s.yield_reach = read(in.yield_reach(), "yield_reach", 0, 2);
  s.retreat_reach = read(in.retreat_reach(), "retreat_reach", 0, 2);
  s.dry_run = in.dry_run();
  s.switch_reach = read(in.switch_reach(), "switch_reach", 0, 10);
  s.tracking_tolerance = read(in.tracking_tolerance(), "tracking_tolerance", kTiny, 10);
  s.tracking_time = read(in.tracking_time(), "tracking_time", 0, 10);
  s.forecast_hold = read(in.forecast_hold(), "forecast_hold", 0, 10);
  s.forecast_slow = read(in.forecast_slow(), "forecast_slow", s.forecast_hold + kTiny, 60);
  s.head_dead_band = read(in.head_dead_band(), "head_dead_band", 0, 1);
  s.look_ahead = read(in.look_ahead(), "look_ahead", 0, 2);
  s.look_far_ahead = read(in.look_far_ahead(), "look_far_ahead", s.look_ahead, 2);
  s.hand_rejoin = read(in.hand_rejoin(), "hand_rejoin", 0, 10);
  s.late_limit = static_cast<int>(read(in.late_limit(), "late_limit", 1, 1000));

  const auto& t = in.timeouts();
  s.timeouts.robot_state = read(t.robot_state(), "robot_state", kTiny, 10);
  s.timeouts.human_state = read(t.human_state(), "human_state", kTiny, 10);
  s.timeouts.forecast = read(t.forecast(), "forecast", kTiny, 10);
  s.timeouts.attention = read(t.attention(), "attention", kTiny, 10);
  s.timeouts.supervisor = read(t.supervisor(), "supervisor", kTiny, 10);

  const auto& g = in.guard();
  s.guard.speed_max = read(g.speed_max(), "speed_max", kTiny, 10);
  s.guard.speed_floor = read(g.speed_floor(), "speed_floor", 0, s.guard.speed_max);
  s.guard.speed_uncertainty = read(g.speed_uncertainty(), "speed_uncertainty", 0, 10);
  s.guard.speed_unknown = read(g.speed_unknown(), "speed_unknown", 0, s.guard.speed_max);
  s.guard.unknown_after = read(g.unknown_after(), "unknown_after", 0, 10);
  s.guard.reaction = read(g.reaction(), "reaction", 0, 10);
  s.guard.intrusion = read(g.intrusion(), "intrusion", 0, 10);
  s.guard.uncertainty_human = read(g.uncertainty_human(), "uncertainty_human", 0, 10);
  s.guard.uncertainty_robot = read(g.uncertainty_robot(), "uncertainty_robot", 0, 10);
  s.guard.uncovered_factor = read(g.uncovered_factor(), "uncovered_factor", kTiny, 1);
  s.guard.exchange_speed = read(g.exchange_speed(), "exchange_speed", kTiny, 10);
  s.guard.exchange_range = read(g.exchange_range(), "exchange_range", 0, 10);
  s.guard.stop_persistence = read(g.stop_persistence(), "stop_persistence", 0, 10);

  s.proof = read_stop_proof(in.stop_proof(), read, file);

  const auto& v = in.view();
  if (!v.has_require_view()) throw ConfigError(locate(file, "view") + ": view.require_view must be given, true or false");
  s.view.require_view = v.require_view();
  s.view.max_view_age = read(v.max_view_age(), "max_view_age", kTiny, 10);
  s.view.margin = read(v.margin(), "margin", 0, 1);
  s.view.ahead_margin = read(v.ahead_margin(), "ahead_margin", 0, 1);
  s.view.edge_factor = read(v.edge_factor(), "edge_factor", kTiny, 1);
  s.view.floor = read(v.floor(), "floor", -100, 100);

  const auto& c = in.contact();
  s.contact.torque = read(c.torque(), "torque", kTiny, 1000);
  s.contact.time = read(c.time(), "time", 0, 10);
  s.contact.usual_time = read(c.usual_time(), "usual_time", kTiny, 100);
  s.contact.follow_torque = read(c.follow_torque(), "follow_torque", kTiny, 1000);
  s.contact.max_usual = read(c.max_usual(), "max_usual", 0, 1000);
  s.contact.exchange_torque = read(c.exchange_torque(), "exchange_torque", kTiny, 1000);
  s.contact.clamp_time = read(c.clamp_time(), "clamp_time", kTiny, 100);
  s.contact.yield_torque = read(c.yield_torque(), "yield_torque", kTiny, 1000);
  s.contact.yield_time = read(c.yield_time(), "yield_time", 0, 100);

  const auto& h = in.hand();
  s.hand.grasp_speed = read(h.grasp_speed(), "grasp_speed", kTiny, 1);
  s.hand.closing_least = read(h.closing_least(), "closing_least", kTiny, 10);
  s.hand.touch_effort = read(h.touch_effort(), "touch_effort", kTiny, 1000);
  s.hand.touch_time = read(h.touch_time(), "touch_time", 0, 10);
  s.hand.seek_speed = read(h.seek_speed(), "seek_speed", kTiny, 10);
  s.hand.seek_travel = read(h.seek_travel(), "seek_travel", 0, 10);
  s.hand.squeeze_effort = read(h.squeeze_effort(), "squeeze_effort", kTiny, 1000);
  s.hand.squeeze_time = read(h.squeeze_time(), "squeeze_time", kTiny, 10);
  s.hand.settle_time = read(h.settle_time(), "settle_time", 0, 10);
  s.hand.least_contacts = static_cast<int>(read(h.least_contacts(), "least_contacts", 1, 100));
  s.hand.least_push = read(h.least_push(), "least_push", 0, 1);
  s.hand.lost_payload = read(h.lost_payload(), "lost_payload", 0, 100);
  s.hand.lost_time = read(h.lost_time(), "lost_time", 0, 10);
  s.hand.loosen_share = read(h.loosen_share(), "loosen_share", 0, 1);
  s.hand.yield_effort = read(h.yield_effort(), "yield_effort", 1e-3, 100);
  s.hand.yield_speed = read(h.yield_speed(), "yield_speed", 0, 10);
  s.hand.person_range = read(h.person_range(), "person_range", 0, 10);
  s.hand.lever = read(h.lever(), "lever", 1e-3, 1);
  s.hand.pull.baseline_time = read(h.pull_baseline(), "pull_baseline", 0, 10);
  s.hand.pull.filter_time = read(h.pull_filter(), "pull_filter", 0, 10);
  s.hand.pull.quick_time = read(h.pull_quick(), "pull_quick", 0, 10);
  s.hand.pull.hold_time = read(h.pull_hold(), "pull_hold", 0, 10);
  s.hand.pull.impulse = read(h.pull_impulse(), "pull_impulse", 0, 100);
  s.hand.pull.commit_time = read(h.pull_commit(), "pull_commit", 0, 10);
  s.hand.pull.slack_share = read(h.slack_share(), "slack_share", 0, 1);
  s.hand.pull.slack_time = read(h.slack_time(), "slack_time", 0, 10);
  s.hand.pull.lost_time = read(h.load_back(), "load_back", 0, 10);
  s.hand.pull.patience = read(h.release_patience(), "release_patience", 0, 100);
  s.hand.pull.direction_cosine = read(h.pull_cosine(), "pull_cosine", -1, 1);
  s.hand.pull.away_cosine = read(h.pull_away_cosine(), "pull_away_cosine", -1, 1);

  for (const auto& w : in.walls()) {
    const Vector3 normal(w.nx(), w.ny(), w.nz());
    if (!(normal.norm() > 1e-9)) throw ConfigError(locate(file, "walls") + ": a wall has no normal; nx, ny, nz must not all be 0");
    s.walls.push_back({normal.normalized(), w.offset()});
  }
  if (in.has_workspace()) {
    const auto& b = in.workspace();
    if (!(b.x_min() < b.x_max() && b.y_min() < b.y_max() && b.z_min() < b.z_max()))
      throw ConfigError(locate(file, "workspace") + ": each _min of workspace must be below its _max");
    s.walls.push_back({Vector3::UnitX(), b.x_min()});
    s.walls.push_back({-Vector3::UnitX(), -b.x_max()});
    s.walls.push_back({Vector3::UnitY(), b.y_min()});
    s.walls.push_back({-Vector3::UnitY(), -b.y_max()});
    s.walls.push_back({Vector3::UnitZ(), b.z_min()});
    s.walls.push_back({-Vector3::UnitZ(), -b.z_max()});
  }
  return s;
}

}  // namespace handsel::trajectory_controller
