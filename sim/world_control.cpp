// SPDX-License-Identifier: Apache-2.0
// Disturbances of the emulated world from outside.
#include <limits>

#include "common/messages/names.hpp"
#include "sim/world_parts.hpp"

namespace handsel::sim {

namespace {

/// Displacement of the coverage of a source that observes another place, world [m].
const Vector3 kCoverageShift(100.0, 100.0, 0.0);

}  // namespace

/// Stops the robot. `how`: empty: stop by a person; "protective": protective stop of the robot,
/// which ends by itself; "unannounced": stop without a report.
std::string SimWorld::Impl::stop_robot(const std::string& how) {
  if (how.empty())
    side.user_stop();
  else if (how == "protective")
    side.stop(DriveMode::protective_stop);
  else if (how == "unannounced")
    side.stop(DriveMode::enabled);
  else
    return "robot_stop is protective, unannounced or, without a subject, by a person; not \"" +
           how + "\"";
  return "";
}

/// Applies a fault to the source, or to all sources of people if the name is empty.
std::string SimWorld::Impl::disturb(const std::string& source, const SensorFault& fault) {
  bool any = false;
  for (HumanSensor& sensor : human_sensors) {
    if (!source.empty() && sensor.settings().source != source) continue;
    sensor.disturb(fault);
    any = true;
  }
  return any ? "" : "there is no source of people " + source;
}

/// Disturbs localisation or wheels. `until`: end of a loss of localisation [s].
std::string SimWorld::Impl::disturb_platform(const SimControl& c, double until) {
  if (!odometry)
    return std::string("the robot does not drive: ") +
           kSimActionNames[static_cast<std::size_t>(c.action)] + " needs a platform";
  if (c.action == SimAction::localisation_lost)
    odometry->lose(until);
  else if (c.action == SimAction::localisation_jump)
    odometry->shift(c.value);
  else
    odometry->slip(c.value);
  return "";
}

std::string SimWorld::Impl::control(const SimControl& c) {
  const auto for_each_subject = [&](auto&& act) -> std::string {
    bool any = false;
    for (std::size_t p = 0; p < people->size(); ++p) {
      if (!c.subject.empty() && people->model(p).id() != c.subject) continue;
      const bool any_may = c.action == SimAction::person_freeze ||
                           c.action == SimAction::person_unfreeze ||
                           c.action == SimAction::person_hand;
      if (!any_may && !people->model(p).source().empty()) continue;
      act(people->model(p));
      any = true;
    }
    return any ? "" : "there is no person " + c.subject;
  };
  const double until = c.value > 0 ? now() + c.value : std::numeric_limits<double>::infinity();
  switch (c.action) {
    case SimAction::person_freeze:
      return for_each_subject([](PersonModel& p) { p.freeze(true); });
    case SimAction::person_unfreeze:
      return for_each_subject([](PersonModel& p) { p.freeze(false); });
    case SimAction::person_dart:
      return for_each_subject([&](PersonModel& p) { p.dart(c.value > 0 ? c.value : 1.0); });
    case SimAction::person_leave:
      return for_each_subject([](PersonModel& p) { p.leave(); });
    case SimAction::person_refuse:
      return for_each_subject([](PersonModel& p) { p.refuse(); });
    case SimAction::person_hand:
      return for_each_subject([&](PersonModel& p) { p.guide_hand(c.side, c.point, c.value); });
    case SimAction::person_look_away:
      return for_each_subject([&](PersonModel& p) { p.look_away(c.value); });
    case SimAction::robot_stop:
      return stop_robot(c.subject);
    case SimAction::emergency_stop:
      side.stop(DriveMode::emergency_stop);
      return "";
    case SimAction::robot_enable:
      side.enable();
      return "";
    case SimAction::silence_human:
      human_silent_until = until;
      return "";
    case SimAction::silence_robot_state:
      state_silent_until = until;
      return "";
    case SimAction::human_frozen:
      return disturb(c.subject, {SensorFaultKind::frozen, now(), until - now()});
    case SimAction::human_empty:
      return disturb(c.subject, {SensorFaultKind::repeated_empty, now(), until - now()});
    case SimAction::human_late:
      return disturb(c.subject,
                     {SensorFaultKind::late, now(), std::numeric_limits<double>::infinity(),
                      Vector3::Zero(), c.value});
    case SimAction::human_elsewhere:
      return disturb(c.subject, {SensorFaultKind::elsewhere, now(), until - now(), kCoverageShift});
    case SimAction::localisation_lost:
    case SimAction::localisation_jump:
    case SimAction::wheel_slip:
      return disturb_platform(c, until);
    case SimAction::restore:
      human_silent_until = state_silent_until = 0;
      if (odometry) odometry->lose(0), odometry->shift(0);
      for (HumanSensor& sensor : human_sensors) sensor.restore();
      return "";
    default:
      return "";
  }
}

}  // namespace handsel::sim
