// SPDX-License-Identifier: Apache-2.0
// How fast a link may touch a body part: limits of force and energy at a contact (ISO 10218-2:2025,
// which has taken in ISO/TS 15066). Pure.
#pragma once

#include <array>
#include <cstdint>

#include "common/model/human/human_body.hpp"

namespace handsel::trajectory_controller {

/// Body regions with limits of their own.
enum class BodyRegion : std::uint8_t { head, torso, upper_arm, forearm, hand, thigh, lower_leg };
inline constexpr std::size_t kBodyRegions = 7;
inline constexpr const char* kBodyRegionNames[kBodyRegions] = {
    "head", "torso", "upper_arm", "forearm", "hand", "thigh", "lower_leg"};

/// Returns the region a part of the body belongs to; of a leg, the more sensitive one.
BodyRegion region_of(BodyPart part) noexcept;

/// Limit of one body region: the body is a mass behind a spring.
struct ContactLimit {
  double force{};      ///< largest force of a transient contact [N]
  double stiffness{};  ///< of the region [N/m]
  double mass{};       ///< effective mass of the region [kg]
  /// Returns the energy that loads the spring to `force` [J].
  double energy() const noexcept { return force * force / (2.0 * stiffness); }
};

/// Returns the mass that stands for the collision of the region with a robot of effective mass
/// `robot_mass` [kg].
inline double reduced_mass(const ContactLimit& limit, double robot_mass) noexcept {
  return 1.0 / (1.0 / limit.mass + 1.0 / robot_mass);
}

/// Returns the largest speed at which a robot of effective mass `robot_mass` [kg] may touch the
/// region without exceeding force and energy [m/s] (ISO/TS 15066:2016 equation A.4: E = F^2 / 2k =
/// mu v^2 / 2 with the reduced mass mu).
double max_contact_speed(const ContactLimit& limit, double robot_mass) noexcept;

using ContactLimits = std::array<ContactLimit, kBodyRegions>;

}  // namespace handsel::trajectory_controller
