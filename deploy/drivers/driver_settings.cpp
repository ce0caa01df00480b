// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/driver_settings.hpp"

#include <algorithm>

#include "common/config/settings/driver.hpp"
#include "common/config/settings/trajectory_controller.hpp"
#include "common/config/settings_text.hpp"

namespace handsel::drivers {

namespace {

Place read_common(const std::filesystem::path& folder, const RobotModel& robot,
                  const settings::DriverCommon& in, const TextPlace& place, DriverSettings& out) {
  const auto controller =
      settings::read_trajectory_controller_settings(folder / "trajectory_controller.txtpb");
  out.dry_run = in.dry_run;
  out.watch.max_ahead = in.wire_jitter;
  out.fade_fraction = in.fade_fraction;
  out.watch.min_stop = in.min_stop;
  out.watch.period = controller.period;
  out.watch.max_gap = in.max_setpoint_gap;
  out.max_setpoint_age = in.max_setpoint_age;
  out.T_world_base = Eigen::Translation3d(in.base_x, in.base_y, in.base_z) *
                     Eigen::AngleAxisd(in.base_yaw, Vector3::UnitZ());
  const Group* group = robot.group(in.group);
  if (group == nullptr)
    throw ConfigError(place.of("group") + ": names \"" + in.group + "\", which robot " +
                      robot.name() + " does not have");
  return {in.port, group->axes};
}

void read_gripper(const settings::GripperSettings& in, const RobotModel& robot,
                  const TextPlace& place, GripperSettings& out) {
  constexpr double kMinTravel = 1e-6;  // [m] or [rad]
  const auto refuse = [&](const char* key, const std::string& sentence) {
    throw ConfigError(place.of(key) + ": " + sentence);
  };
  const auto it = std::find_if(robot.axes().begin(), robot.axes().end(),
                               [&](const Axis& a) { return a.name == in.axis; });
  if (it == robot.axes().end())
    refuse("axis", "names \"" + in.axis + "\", which robot " + robot.name() + " does not have");
  if (!(std::abs(in.open - in.closed) > kMinTravel)) refuse("open", "must differ from closed");
  if (!(in.closed_width <= in.open_width - kMinTravel))
    refuse("closed_width", "must be below open_width");
  if (!(in.max_force >= in.min_force)) refuse("max_force", "must be at least min_force");
  out.axis = static_cast<int>(it - robot.axes().begin());
  out.open = in.open;
  out.closed = in.closed;
  out.open_width = in.open_width;
  out.closed_width = in.closed_width;
  out.speed = in.speed;
  out.stiffness = in.stiffness;
  out.min_force = in.min_force;
  out.max_force = in.max_force;
}

}  // namespace

Place load_settings(const std::filesystem::path& folder, const RobotModel& robot,
                    PositionSettings& out) {
  SettingsText text;
  const auto in = settings::read_position_arm_settings(folder / "position_arm.txtpb", &text);
  out.cycle = in.cycle;
  return read_common(folder, robot, in.common, text.root().inside("common"), out.common);
}

Place load_settings(const std::filesystem::path& folder, const RobotModel& robot,
                    ReflexSettings& out) {
  SettingsText text;
  const auto in = settings::read_reflex_arm_settings(folder / "reflex_arm.txtpb", &text);
  out.joint_deceleration = in.joint_deceleration;
  out.limit_ratio = in.limit_ratio;
  out.lost_cycles = in.lost_cycles;
  if (in.gripper) read_gripper(*in.gripper, robot, text.root().inside("gripper"), out.gripper);
  return read_common(folder, robot, in.common, text.root().inside("common"), out.common);
}

}  // namespace handsel::drivers
