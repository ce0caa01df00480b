#include "sim/scene/settings.hpp"

#include <cstdlib>

#include "common/config/resources.hpp"
#include "common/config/schema/sim.pb.h"
#include "common/config/schema/trajectory_controller.pb.h"

namespace handsel::sim {

std::filesystem::path data_root() {
  if (const char* data = std::getenv("HANDSEL_DATA")) return data;
  const std::filesystem::path beside = resource_root() / "../../shared/data";
  return std::filesystem::exists(beside) ? beside : std::filesystem::path();
}

/// Period of the set-points that the controller of these settings sends [s].
double controller_period(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "trajectory_controller.txtpb";
  config::TrajectoryControllerSettings read;
  load_text_proto(file, read);
  if (!(read.period() > 0 && read.period() <= 0.02)) throw ConfigError(locate(file, "period:") + ": period must be given, in (0, 0.02]");
  return read.period();
}

SimSettings load_settings(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "sim.txtpb";
  config::SimSettings read;
  load_text_proto(file, read);
  const auto positive = [&](double value, const char* key) {
    if (!(value > 0)) throw ConfigError(file.string() + ": " + key + " is " + std::to_string(value) + ", must be above 0");
    return value;
  };
  SimSettings s;
  s.step = positive(read.step(), "step");
  if (s.step > 0.005) throw ConfigError(file.string() + ": step is " + std::to_string(s.step) + ", must be at most 0.005");
  s.solver_iterations = static_cast<int>(positive(read.solver_iterations(), "solver_iterations"));
  s.state_rate = positive(read.state_rate(), "state_rate");
  s.ground_truth_rate = positive(read.truth_rate(), "truth_rate");
  s.servo.bandwidth = positive(read.servo_bandwidth(), "servo_bandwidth");
  s.robot_side.max_gap = positive(read.max_setpoint_gap(), "max_setpoint_gap");
  s.robot_side.max_ahead = s.robot_side.max_gap;
  s.robot_side.period = controller_period(folder);
  s.robot_side.min_stop = positive(read.min_stop(), "min_stop");
  s.robot_grip.max_force = positive(read.grip_force(), "grip_force");
  s.robot_grip.max_torque = positive(read.grip_torque(), "grip_torque");
  s.person_grip.max_force = positive(read.person_grip_force(), "person_grip_force");
  s.touch_force = positive(read.touch_force(), "touch_force");
  s.grasp_time = positive(read.grasp_time(), "grasp_time");
  s.lose_time = positive(read.lose_time(), "lose_time");
  s.wrench_filter = positive(read.wrench_filter(), "wrench_filter");
  s.force_noise = read.force_noise();
  s.position_noise = read.position_noise();
  s.coverage = positive(read.coverage(), "coverage");
  s.ssm.reaction = positive(read.reaction(), "reaction");
  s.constraint = std::getenv("HANDSEL_NO_WELD") == nullptr;
  s.setpoint_period = read.setpoint_period();
  s.pad.friction = positive(read.pad_friction(), "pad_friction");
  s.pad.patch = positive(read.pad_patch(), "pad_patch");
  s.pad.stiffness = positive(read.pad_stiffness(), "pad_stiffness");
  s.servo.finger_travel = positive(read.finger_travel(), "finger_travel");
  s.servo.rotor_inertia = positive(read.rotor_inertia(), "rotor_inertia");
  s.clock_period = positive(read.clock_period(), "clock_period");
  s.max_lag = positive(read.max_lag(), "max_lag");
  s.max_wait = positive(read.max_wait(), "max_wait");
  s.data_root = data_root();
  return s;
}

}  // namespace handsel::sim
