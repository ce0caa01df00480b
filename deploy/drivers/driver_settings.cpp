#include "deploy/drivers/driver_settings.hpp"

#include <algorithm>

#include "common/config/resources.hpp"
#include "common/config/schema/driver.pb.h"
#include "common/config/schema/trajectory_controller.pb.h"

namespace handsel::drivers {

namespace {

class File {
 public:
  File(const std::filesystem::path& file, google::protobuf::Message& out) : file_(file) { load_text_proto(file, out); }
  double in(double value, const char* key, double low, double high) const {
    if (value >= low && value <= high) return value;
    fail(key, "must be given, in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
  }
  [[noreturn]] void fail(const char* key, const std::string& what) const {
    throw ConfigError(locate(file_, std::string(key) + ":") + ": " + key + " " + what);
  }

 private:
  std::filesystem::path file_;
};

constexpr double kTiny = 1e-6;

Place read_common(const std::filesystem::path& folder, const File& file, const RobotModel& robot, const config::DriverCommon& in,
                  DriverSettings& out) {
  out.dry_run = in.dry_run();
  out.watch.max_ahead = file.in(in.wire_jitter(), "wire_jitter", 0.0, 0.1);
  out.fade_fraction = file.in(in.fade_share(), "fade_share", 0.01, 1.0);
  out.watch.min_stop = file.in(in.min_stop(), "min_stop", 0.1, 60.0);
  config::TrajectoryControllerSettings controller;
  out.watch.period = File(folder / "trajectory_controller.txtpb", controller).in(controller.period(), "period", kTiny, 0.02);
  out.watch.max_gap = file.in(in.max_setpoint_gap(), "max_setpoint_gap", 0.001, 1.0);
  out.T_world_base = Eigen::Translation3d(in.base_x(), in.base_y(), in.base_z()) * Eigen::AngleAxisd(in.base_yaw(), Vector3::UnitZ());
  const Group* group = robot.group(in.group());
  if (group == nullptr) file.fail("group", "names \"" + in.group() + "\", which robot " + robot.name() + " does not have");
  return {static_cast<int>(file.in(in.port(), "port", 1, 65535)), group->axes};
}

}  // namespace

Place load_settings(const std::filesystem::path& folder, const RobotModel& robot, PositionSettings& out) {
  config::PositionArmSettings in;
  const File file(folder / "position_arm.txtpb", in);
  out.cycle = file.in(in.cycle(), "cycle", 0.001, 0.01);
  return read_common(folder, file, robot, in.common(), out.common);
}

Place load_settings(const std::filesystem::path& folder, const RobotModel& robot, ReflexSettings& out) {
  config::ReflexArmSettings in;
  const File file(folder / "reflex_arm.txtpb", in);
  out.joint_deceleration = file.in(in.joint_deceleration(), "joint_deceleration", kTiny, 1000.0);
  out.limit_ratio = file.in(in.limit_share(), "limit_share", 0.1, 1.0);
  out.lost_cycles = static_cast<int>(file.in(in.lost_cycles(), "lost_cycles", 1, 1000));
  if (in.has_gripper()) {
    const config::GripperSettings& g = in.gripper();
    const auto it = std::find_if(robot.axes().begin(), robot.axes().end(), [&](const Axis& a) { return a.name == g.axis(); });
    if (it == robot.axes().end()) file.fail("axis", "names \"" + g.axis() + "\", which robot " + robot.name() + " does not have");
    out.gripper.axis = static_cast<int>(it - robot.axes().begin());
    out.gripper.open = g.open();
    out.gripper.closed = g.closed();
    if (!(std::abs(g.open() - g.closed()) > kTiny)) file.fail("open", "must differ from closed");
    out.gripper.open_width = file.in(g.open_width(), "open_width", kTiny, 1.0);
    out.gripper.closed_width = file.in(g.closed_width(), "closed_width", 0.0, out.gripper.open_width - kTiny);
    out.gripper.speed = file.in(g.speed(), "speed", kTiny, 1.0);
    out.gripper.stiffness = file.in(g.stiffness(), "stiffness", kTiny, 1e6);
    out.gripper.min_force = file.in(g.least_force(), "least_force", 0.0, 1000.0);
    out.gripper.max_force = file.in(g.most_force(), "most_force", out.gripper.min_force, 1000.0);
  }
  return read_common(folder, file, robot, in.common(), out.common);
}

}  // namespace handsel::drivers
