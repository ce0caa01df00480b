// True separation of robot and people, and speed and separation monitoring (SSM, ISO 10218-2:2025;
// formulas: section 2), computed apart from the guard's code. Own method: the power of contacts
// decides whether the robot presses against a person.
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
  double reaction{0.1};  ///< T_r: age of the data and reaction of the robot [s]
  double margin{0.02};   ///< C + Z_d + Z_r: small, as the positions are exact [m]
  double moving{0.01};   ///< slower than this toward the person counts as stopped [m/s]
};

/// One person as the separation sees them.
struct PersonVolume {
  const Person* person{};  ///< ground truth; not null
  bool exception{};        ///< forearm and hand of the handover are left out
  Side side{Side::right};  ///< of that forearm and hand
};

struct TrueSeparation {
  double distance{};  ///< [m], +inf if nobody; negative: overlapping
  int link{-1};       ///< of the robot; -1 if nobody
  Vector3 on_robot{Vector3::Zero()}, on_person{Vector3::Zero()};  ///< nearest points, world [m]
  Vector3 person_velocity{Vector3::Zero()};  ///< of the joint nearest to on_person, world [m/s]
};

/// The highest speed that lasts: the median of five steps in a row. An elbow whose bend is solved
/// anew may jump within one step, which is no motion of a person.
class PeakSpeed {
 public:
  void add(double speed) noexcept;                ///< takes the speed of one step [m/s]
  double peak() const noexcept { return peak_; }  ///< [m/s], 0 before the fifth step

 private:
  std::array<double, 5> last_{};
  std::size_t count_{};
  double peak_{};
};

class SeparationOracle {
 public:
  SeparationOracle(const RobotModel&, const SsmSettings&);

  /// Least distance over all links and people.
  TrueSeparation separation(const RobotBody&, const std::vector<PersonVolume>&) const;
  /// Whether the robot is faster toward the person than SSM allows, given its servo references (all
  /// axes).
  bool violates(const TrueSeparation&, const RobotBody&, const Vector& velocity,
                const Vector& acceleration);
  /// Whether the servo references (all axes) move the robot against these touches, robot first, of
  /// a person. An arm that complies with a push moves with the hand that pushes, wherever that is.
  bool presses(const RobotBody&, const std::vector<Touch>&, const Vector& velocity);
  /// Time and distance of the jerk-limited minimum-time stop of one axis from (v, a).
  static void stop_measure(double v, double a, double max_a, double max_j, double& time,
                           double& distance);

 private:
  struct LinkVolume {
    int link{};
    Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  // link frame
    double radius{}, bound{};                        // bound: sphere about the middle
  };
  SsmSettings settings_;
  KinematicLimits stop_;
  std::vector<LinkVolume> volumes_;
  Vector jacobian_;
};

}  // namespace handsel::sim
