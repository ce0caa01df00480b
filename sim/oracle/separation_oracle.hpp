// SPDX-License-Identifier: Apache-2.0
// Computes the ground-truth separation of robot and people, and checks speed and separation
// monitoring (SSM, ISO 10218-2:2025; formulas: section 2) independently of the guard. Own method:
// the power of contacts decides whether the robot presses against a person.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/model/human/human_body.hpp"
#include "common/model/robot_model.hpp"
#include "sim/physics/contacts.hpp"
#include "sim/robot/robot_body.hpp"

namespace handsel::sim {

struct SsmSettings {
  double reaction{0.1};  ///< T_r: age of the data plus reaction time of the robot [s]
  double margin{0.02};   ///< C + Z_d + Z_r: small, as the positions are exact [m]
  double moving{0.01};   ///< min speed toward the person of a moving robot [m/s]
};

/// One person for the computation of the separation.
struct PersonVolume {
  const Person* person{};  ///< ground truth; not null
  bool exception{};        ///< separation exemption of forearm and hand
  Side side{Side::right};  ///< side of that forearm and hand
  bool both_sides{};       ///< forearms and hands of both sides are exempt
};

struct TrueSeparation {
  double distance{};  ///< [m]; +inf without people; negative: overlap
  int link{-1};       ///< robot link; -1 without people
  Vector3 on_robot{Vector3::Zero()}, on_person{Vector3::Zero()};  ///< nearest points, world [m]
  /// Velocity of the joint nearest to on_person, world [m/s].
  Vector3 person_velocity{Vector3::Zero()};
};

/// The max sustained speed: max of the median over five successive steps. A recomputed elbow may
/// jump within one step, which is not a motion of a person.
class PeakSpeed {
 public:
  void add(double speed) noexcept;                ///< Adds the speed of one step [m/s].
  double peak() const noexcept { return peak_; }  ///< [m/s]; 0 before the fifth step

 private:
  std::array<double, 5> last_{};
  std::size_t count_{};
  double peak_{};
};

class SeparationOracle {
 public:
  SeparationOracle(const RobotModel&, const SsmSettings&);

  /// Returns the min distance over all links and people.
  TrueSeparation separation(const RobotBody&, const std::vector<PersonVolume>&) const;
  /// Returns whether the robot's speed toward the person exceeds the speed that SSM allows, for the
  /// given servo references (all axes).
  bool violates(const TrueSeparation&, const RobotBody&, const Vector& velocity,
                const Vector& acceleration);
  /// Returns whether the servo references (all axes) move the robot against these contacts with a
  /// person (robot first). A compliant arm moves with the pushing hand instead.
  bool presses(const RobotBody&, const std::vector<Touch>&, const Vector& velocity);
  /// Writes time and distance of the jerk-limited minimum-time stop of one axis from (v, a).
  static void stop_measure(double v, double a, double max_a, double max_j, double& time,
                           double& distance);

 private:
  struct LinkVolume {
    int link{};
    Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  // link frame
    double radius{}, bound{};                        // bound: radius of a sphere about the centre
  };
  SsmSettings settings_;
  KinematicLimits stop_;
  std::vector<LinkVolume> volumes_;
  Vector jacobian_;
};

}  // namespace handsel::sim
