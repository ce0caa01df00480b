// SPDX-License-Identifier: Apache-2.0
// How fast the robot may touch each body region: as an arm, and with its fingers. Pure, no heap.
#pragma once

#include <array>

#include "common/model/robot_model.hpp"
#include "components/trajectory_controller/supervise/stop/contact_budget.hpp"

namespace handsel::trajectory_controller {

class ContactSpeeds {
 public:
  /// While the platform stands: see platform_mass(). `min_robot_mass`: effective mass of a link
  /// at a contact, at least [kg]; `finger_mass`: of the heaviest finger [kg].
  ContactSpeeds(const ContactLimits& limits, const RobotModel& robot, double min_robot_mass,
                double finger_mass);

  /// Returns the largest contact speed of a region for the robot holding `payload` [m/s, kg].
  double max_speed_at(BodyRegion region, double payload) const noexcept;
  /// Returns the speed of the arm whose contact with the region has the energy of a finger's at 1
  /// m/s [-].
  double finger_ratio_at(BodyRegion region, double payload) const noexcept;

  /// What the platform adds to the mass that is held, at a contact while the platform moves: half
  /// of its own (ISO/TS 15066:2016, A.3.4); 0 for a robot that does not drive [kg].
  double platform_mass() const noexcept { return platform_mass_; }

  /// Sets the mass that is held [kg] for what follows.
  void set_payload(double payload) noexcept;
  /// Largest contact speed of a region [m/s].
  double max_speed(std::size_t region) const noexcept { return max_speed_[region]; }
  /// Smallest of the largest contact speeds [m/s].
  double min_speed() const noexcept { return min_speed_; }
  /// Returns the speed of the arm whose contact has the energy of the arm's and the fingers'
  /// together: these are light. `carried`: surface speed of the link; `inner`: of its fingers
  /// [m/s].
  double of(double carried, double inner, std::size_t region) const noexcept;

 private:
  double arm_mass(double payload) const noexcept;

  ContactLimits limits_;
  double min_robot_mass_{};
  double finger_mass_{};
  double moving_mass_{};  // half of what the axes carry [kg]
  double platform_mass_{};
  std::array<double, kBodyRegions> max_speed_{};
  std::array<double, kBodyRegions> finger_ratio_{};  // of a contact, see finger_ratio_at()
  double min_speed_{};
};

}  // namespace handsel::trajectory_controller
