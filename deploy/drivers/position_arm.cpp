// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/position_arm.hpp"

namespace handsel::drivers {

namespace {

constexpr int kLost = 3;  // cycles without a message until the link is lost

void measure(const CyclicState& s, bool lost, Measured& out) {
  out.by_person = true;
  if (s.safety == Safety::emergency_stop) {
    out.mode = DriveMode::emergency_stop;
    out.why = "emergency stop";
  } else if (s.safety == Safety::user_stop) {
    out.mode = DriveMode::user_stop;
    out.why = "user stop";
  } else if (!s.drives_on) {
    out.mode = DriveMode::off;
    out.why = "the drives are off";
  } else if (!s.brakes_open) {
    out.mode = DriveMode::braked;
    out.why = "the brakes are closed";
  } else {
    out.by_person = false;
    out.mode =
        !lost && s.session >= Session::monitoring_ready ? DriveMode::enabled : DriveMode::braked;
    out.why =
        lost ? "the arm's controller is silent" : "the arm's controller is not ready for commands";
  }
}

}  // namespace

PositionArm::PositionArm(const RobotModel& model, std::vector<int> arm_axes, double cycle,
                         CyclicLink& link, const DriverSettings& settings)
    : cycle_(cycle), link_(link), core_(model, std::move(arm_axes), settings) {
  measured_.position = measured_.velocity = measured_.effort = measured_.external_torque =
      Vector::Zero(model.dof());
}

void PositionArm::cycle(double now) {
  CyclicState s;
  // A state of another arm is ignored.
  const bool came = link_.receive(s) &&
                    fit({&s.position, &s.velocity, &s.torque, &s.external_torque, &s.interpolated},
                        core_.arm_axes());
  if (came) {
    missed_in_a_row_ = 0;
    last_ = s;
  } else {
    ++missed_;
    ++missed_in_a_row_;
    s = last_;
  }
  if (s.position.size() == 0) return;
  const bool lost = missed_in_a_row_ >= kLost;
  if (!came && !lost) return;  // tolerated: the next message contains the number of cycles passed
  const double dt = came ? cycle_ * count_.passed(s.cycle) : cycle_;
  // The arm left the commanding state by itself: the references restart from its position.
  const bool dropped =
      session_ == Session::commanding_active && (lost || s.session < Session::commanding_active);
  const bool starts =
      !lost && session_ == Session::commanding_wait && s.session == Session::commanding_active;
  session_ = lost ? Session::idle : s.session;
  measure(s, lost, measured_);
  const std::vector<int>& axes = core_.arm_axes();
  measured_.position = core_.reference();
  scatter(s.position, axes, measured_.position);
  scatter(s.velocity, axes, measured_.velocity);
  scatter(s.torque, axes, measured_.effort);
  scatter(s.external_torque, axes, measured_.external_torque);
  if (starts) core_.start_from(measured_.position);
  core_.update(measured_, now, dt);
  if (dropped && measured_.mode == DriveMode::enabled)
    core_.hold("the arm's controller ended the commanding session");
  if (!came || core_.settings().dry_run) return;
  if (session_ == Session::monitoring_ready && core_.following()) link_.request_commanding();
  if (session_ == Session::commanding_wait) link_.answer(s.interpolated);
  if (session_ == Session::commanding_active) link_.answer(gather(core_.reference(), axes));
}

void PositionArm::set_load(double mass) {
  measured_.payload = mass;
  if (!core_.settings().dry_run) link_.set_load(mass);
}

std::string PositionArm::trouble() const {
  if (!core_.trouble().empty() || core_.settings().dry_run ||
      session_ == Session::commanding_active)
    return core_.trouble();
  return last_.position.size() == 0 ? "nothing was received from the arm's controller yet"
                                    : "the commanding session is being negotiated";
}

}  // namespace handsel::drivers
