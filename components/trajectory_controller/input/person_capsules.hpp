// SPDX-License-Identifier: Apache-2.0
// People as capsules ready for many comparisons: made once a HumanState sample, read by the guard
// every period.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"
#include "components/trajectory_controller/supervise/stop/contact_budget.hpp"

namespace handsel::trajectory_controller {

/// One capsule of a person.
struct PersonCapsule {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< world [m]
  double radius{};                                 ///< [m]
  Vector3 centre{Vector3::Zero()};                 ///< between a and b
  double reach{};                                  ///< half the length and the radius [m]
  std::array<Vector3, 8> velocities{};             ///< of the joints that carry it, world [m/s]
  int joints{};                                    ///< 0: lost, velocity unknown
  double fastest{};                                ///< of the joints [m/s]
  double age{};                                    ///< since seen; 0 when the radius holds it [s]
  bool excepted{};                                 ///< forearm or hand exempt from separation
  bool measured{};                                 ///< all joints that carry it were just measured
  BodyRegion region{BodyRegion::torso};            ///< limits that hold for the capsule
};

/// The people of one HumanState sample.
struct PersonCapsules {
  std::vector<PersonCapsule> capsules;  ///< of all people, one person after the other
  bool covered{};                       ///< the reach of the robot is observed: "nobody" is a fact
  std::uint64_t revision{};             ///< grows with every change
};

/// `exception` as in common/model; a person not seen for longer than `unknown_after` [s] has no
/// known velocity. May allocate.
void prepare(const HumanState& people, const SeparationExemption& exception, double unknown_after,
             PersonCapsules& out);

}  // namespace handsel::trajectory_controller
