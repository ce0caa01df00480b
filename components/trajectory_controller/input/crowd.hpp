// People as capsules ready for many comparisons: made once a HumanState sample, read by the guard every period.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"
#include "components/trajectory_controller/supervise/contact_budget.hpp"

namespace handsel::trajectory_controller {

/// One capsule of a person.
struct CrowdCapsule {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< world [m]
  double radius{};
  Vector3 centre{Vector3::Zero()};      ///< between a and b
  double reach{};                       ///< half the length and the radius [m]
  std::array<Vector3, 8> velocities{};  ///< of the joints that carry it, world [m/s]
  int joints{};                         ///< 0: lost, velocity unknown
  double fastest{};                     ///< of the joints [m/s]
  double age{};                         ///< since this person was last seen, when the radius does not hold it yet [s]
  bool excepted{};                      ///< exchanging forearm or hand
  bool measured{};                      ///< the joints that carry it were themselves measured just now
  BodyRegion region{BodyRegion::torso};
};

/// The people of one HumanState sample.
struct Crowd {
  std::vector<CrowdCapsule> capsules;
  bool covered{};
  std::uint64_t revision{};  ///< grows with every change
};

/// `exception` as in common/model; a person not seen for longer than `unknown_after` [s] has no known velocity. May allocate.
void prepare(const HumanState& people, const Exception& exception, double unknown_after, Crowd& out);

}  // namespace handsel::trajectory_controller
