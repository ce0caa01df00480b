// SPDX-License-Identifier: Apache-2.0
// Proof that a set-point can be followed by a stop that harms nobody: every link is at rest, or
// slow enough for a contact, wherever a person can be by then. Two stops are checked: the
// controller's own, at once, and the robot side's, after set-points have failed; in each of them
// every axis stops by itself as fast as it can. Pure, no heap after construction, noexcept. Own
// method, after the idea of the SARA shield.
//
// Induction: the stop behind the set-point sent last has been checked. If the one behind the next
// set-point cannot be, the next set-point of the checked stop is sent instead. The assumptions are
// those of StopProofSettings, and that people are where HumanState says within `tracker_error`.
#pragma once

#include <cstdint>
#include <vector>

#include "common/model/robot_capsules.hpp"
#include "common/trajectory/min_time.hpp"
#include "components/trajectory_controller/input/person_capsules.hpp"
#include "components/trajectory_controller/supervise/stop/contact_budget.hpp"
#include "components/trajectory_controller/supervise/stop/contact_speeds.hpp"
#include "components/trajectory_controller/supervise/stop/free_space.hpp"
#include "components/trajectory_controller/supervise/stop/moving_chain.hpp"
#include "components/trajectory_controller/supervise/stop/reachable_people.hpp"
#include "components/trajectory_controller/supervise/stop/stop_bounds.hpp"
#include "components/trajectory_controller/supervise/stop/stop_plan.hpp"
#include "components/trajectory_controller/supervise/stop/stop_samples.hpp"

namespace handsel::trajectory_controller {

/// Assumptions about robot and people, and limits of contact.
struct StopProofSettings {
  bool enabled{true};              ///< false: every set-point passes the check
  double latency{0.01};            ///< from a set-point to the motion of the robot [s]
  double robot_side_delay{0.021};  ///< silence after which the robot side stops by itself [s]
  double tracker_error{0.03};      ///< a part of a person is this near where it was measured [m]
  double speed_error{0.05};        ///< its measured speed is this exact [m/s]
  double robot_error{0.01};        ///< a link is this near its set-point, beyond latency [m]
  /// ReachLimit aims at this fraction of a contact speed, so that the proof seldom intervenes ...
  double limit_ratio{0.9};
  double limit_margin{0.02};  ///< ... and at this much more distance [m]
  /// ReachLimit allows at least this fraction of a contact speed, whatever the acceleration of the
  /// arm adds.
  double min_contact_ratio{0.2};
  /// Fingers alone use this fraction of a contact speed where people can reach them; the arm has
  /// the rest.
  double finger_ratio{0.7};
  /// Attempts, one soon after the other, to rejoin a path that end in a set-point without a checked
  /// stop; then the path is given up.
  int max_rejoins{4};
  /// The cause is shown for so long after a set-point without a checked stop [s].
  double shown_time{0.5};
  double min_robot_mass{2.0};   ///< effective mass of a link at a contact, at least [kg]
  double min_finger_mass{0.1};  ///< of a finger that moves in the hand, at least [kg]
  /// Largest speed and acceleration of people, by region: 2 m/s and 50 m/s^2 for arms and hands,
  /// ISO 13855's walking speed for the rest.
  RegionMotions people{
      {{1.6, 10.0}, {1.6, 10.0}, {2.0, 50.0}, {2.0, 50.0}, {2.0, 50.0}, {1.6, 20.0}, {1.6, 20.0}}};
  /// Transient limits of ISO/TS 15066:2016 table A.2 and A.3, the lowest of each region; for the
  /// head, where no transient contact is allowed, the quasi-static limit of the face.
  ContactLimits contact{{{65.0, 75e3, 4.4},
                         {280.0, 25e3, 40.0},
                         {300.0, 30e3, 3.0},
                         {320.0, 40e3, 2.0},
                         {280.0, 75e3, 0.6},
                         {440.0, 50e3, 75.0},
                         {260.0, 60e3, 75.0}}};
};

/// Where and when a stop would not be harmless; without a link when an axis would leave its bounds,
/// or too many people are near.
struct StopRefutation {
  int link{-1};        ///< of the robot; -1: there is none
  double time{};       ///< after the set-point [s]
  double speed{};      ///< bound of the link's speed then [m/s]
  double max_speed{};  ///< allowed at a contact with the part [m/s]
  double distance{};   ///< from the link to where the part was measured [m]
  double needed{};     ///< so that the part cannot be there by then [m]
};

class StopProof {
 public:
  StopProof(const StopProofSettings& settings, const RobotModel& robot,
            const std::vector<LinkCapsule>& capsules);
  StopProof(const StopProof&) = delete;
  StopProof& operator=(const StopProof&) = delete;

  /// Returns whether both stops from `state` (all axes) are harmless to `people`, whose data are
  /// `age` old [s]. `payload`: mass held [kg].
  bool check(const MotionState3& state, const PersonCapsules& people, const Pose& T_world_base,
             double age, double payload) noexcept;
  /// Reason of the last check that failed.
  const StopRefutation& refutation() const noexcept { return refutation_; }
  /// Kinematics that the proof uses, for the indices of capsules.
  const MovingChain& chain() const noexcept { return chain_; }

  // Of the set-point checked last.
  /// Whether any axis moves; if not, there is no stop.
  bool moving() const noexcept { return at_once_.count() > 0; }
  /// Bound of the travel of a capsule of chain() in either stop [m]; 0 when no axis moves.
  double max_travel(std::size_t capsule) const noexcept {
    return moving() ? bounds_.travel(capsule) : 0.0;
  }
  /// Bound of the speed of a capsule of chain() in either stop, fingers included [m/s].
  double max_speed(std::size_t capsule) const noexcept {
    return moving() ? bounds_.carried(capsule) + bounds_.inner(capsule) : 0.0;
  }
  /// The stop: the robot side's or the controller's own.
  const StopPlan& stop(bool robot_side) const noexcept {
    return robot_side ? robot_side_ : at_once_;
  }
  /// Largest contact speeds.
  const ContactSpeeds& contact_speeds() const noexcept { return contact_; }
  /// Assumptions and limits of the proof, as given to the constructor.
  const StopProofSettings& settings() const noexcept { return settings_; }

 private:
  static constexpr int kMaxPairs = 1024;

  /// A link and a part of a person that could touch during the stop.
  struct Pair {
    std::uint16_t capsule{}, part{};
  };
  /// By how much a link may be faster between two samples than at both.
  struct Bend {
    double carried{}, inner{};  // [m/s]
    double inner_travel{};      // of its fingers, whose sphere is that of the start [m]
  };

  bool find_pairs(const PersonCapsules& people, const Pose& T_world_base, double duration) noexcept;
  bool check_stop(const StopPlan& stop, const Vector& position, const PersonCapsules& people,
                  const Pose& T_world_base, double age) noexcept;
  Bend bend_of(std::size_t capsule) const noexcept;
  bool check_pair(const StopPlan& stop, const Pair& pair, const Bend& bend,
                  const PersonCapsule& part, double age) noexcept;
  bool is_within(const CapsuleSample& link, double radius, const PersonCapsule& part,
                 double needed) noexcept;

  StopProofSettings settings_;
  KinematicLimits limits_;  // of the stops
  MovingChain chain_;
  ContactSpeeds contact_;
  StopPlan at_once_, robot_side_;
  StopBounds bounds_;
  FreeSpace free_space_;
  StopSamples samples_;
  std::vector<Pair> pairs_;
  std::vector<char> all_frames_;      // marks for the chain
  std::vector<FrameMotion> motions_;  // of each frame, at the set-point
  Vector at_rest_;                    // of all axes
  // By axis, of the stop that is checked: largest speed, the same as turning, jerk.
  std::vector<double> speed_, turning_, jerk_;
  StopRefutation refutation_;
};

}  // namespace handsel::trajectory_controller
