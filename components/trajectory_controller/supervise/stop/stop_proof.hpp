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

#include <array>
#include <cstdint>
#include <vector>

#include "common/model/robot_capsules.hpp"
#include "common/trajectory/min_time.hpp"
#include "components/trajectory_controller/input/person_capsules.hpp"
#include "components/trajectory_controller/supervise/stop/contact_budget.hpp"
#include "components/trajectory_controller/supervise/stop/moving_chain.hpp"
#include "components/trajectory_controller/supervise/stop/reachable_people.hpp"

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
  RegionMotions people{{{1.6, 10.0}, {1.6, 10.0}, {2.0, 50.0}, {2.0, 50.0}, {2.0, 50.0}, {1.6, 20.0}, {1.6, 20.0}}};
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
  StopProof(const StopProofSettings& settings, const RobotModel& robot, const std::vector<LinkCapsule>& capsules);

  /// Returns whether both stops from `state` (all axes) are harmless to `people`, whose data are
  /// `age` old [s]. `payload`: mass held [kg].
  bool check(const MotionState3& state, const PersonCapsules& people, const Pose& T_world_base, double age, double payload) noexcept;
  /// Reason of the last check that failed.
  const StopRefutation& refutation() const noexcept { return refutation_; }
  /// Kinematics that the proof uses, for the indices of capsules.
  const MovingChain& chain() const noexcept { return chain_; }

  // Of the set-point checked last.
  /// Whether any axis moves; if not, there is no stop.
  bool moving() const noexcept { return at_once_.count > 0; }
  /// Bound of the travel of a capsule of chain() in either stop [m]; 0 when no axis moves.
  double max_travel(std::size_t capsule) const noexcept { return moving() ? max_travel_[capsule] : 0.0; }
  /// Bound of the speed of a capsule of chain() in either stop, fingers included [m/s].
  double max_speed(std::size_t capsule) const noexcept { return moving() ? max_carried_[capsule] + max_inner_[capsule] : 0.0; }
  /// How long the stop takes, the robot side's or the controller's own [s].
  double duration(bool robot_side) const noexcept { return (robot_side ? robot_side_ : at_once_).duration; }
  /// Where the axes are `time` after the set-point [s]; of axes that stand, `position` keeps what
  /// it has.
  void position_at(bool robot_side, double time, Vector& position) const noexcept;
  /// Returns the largest contact speed of a region for the robot holding `payload` [m/s].
  double max_speed_at(BodyRegion region, double payload) const noexcept;
  /// Returns the speed of the arm whose contact with the region has the energy of a finger's at 1
  /// m/s [-].
  double finger_ratio_at(BodyRegion region, double payload) const noexcept;
  /// Assumptions and limits of the proof, as given to the constructor.
  const StopProofSettings& settings() const noexcept { return settings_; }

 private:
  static constexpr int kMaxAxes = 64;
  static constexpr int kMaxPairs = 1024;
  static constexpr int kIntervals = 6;

  /// One axis from now until rest.
  struct AxisStop {
    int axis{};
    bool sliding{};
    AxisState start;
    AxisProfile profile;
    double delay{}, duration{};
    double travel{};     ///< of all its motion, there and back [rad, m]
    double max_speed{};  ///< [rad/s, m/s]
    AxisState at(double t) const noexcept;
    double max_speed_between(double from, double to) const noexcept;
  };
  /// All axes that move.
  struct Stop {
    std::array<AxisStop, kMaxAxes> axes;
    int count{};
    double duration{};  ///< until all are at rest [s]
    bool inside{true};  ///< all come to rest inside their bounds
  };
  /// A link and a part of a person that could touch during the stop.
  struct Pair {
    std::uint16_t capsule{}, part{};
  };
  /// A link's capsule at one instant of the stop, with its largest speeds.
  struct Sample {
    Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< world [m]
    double carried{};                                ///< surface speed, fingers at rest [m/s]
    double inner{};                                  ///< finger speed in the hand [m/s]
  };

  void plan(const MotionState3& state, double delay, Stop& stop) const noexcept;
  void need(int frame) noexcept;
  bool ends_inside(int axis, double start, double end) const noexcept;
  void bound_motion() noexcept;
  bool far_from_everybody(const MotionState3& state, double duration) noexcept;
  bool find_pairs(const PersonCapsules& people, const Pose& T_world_base, double duration) noexcept;
  void set_speeds(const ChainCapsule& capsule, Sample& sample) const noexcept;
  double contact_speed(double carried, double inner, std::size_t region) const noexcept;
  bool check_stop(const Stop& stop, const Vector& position, const PersonCapsules& people, const Pose& T_world_base, double age) noexcept;
  void sample(const Stop& stop, double time, const Pose& T_world_base, int slot) noexcept;
  double time_until_rest(const Stop& stop) noexcept;
  const std::vector<double>& speeds_between(const Stop& stop, int slot, double interval) noexcept;
  Sample placed(const ChainCapsule& capsule, const Pose& T_world_base) const noexcept;

  StopProofSettings settings_;
  KinematicLimits limits_;             // of the stops
  std::vector<double> lower_, upper_;  // bounds of the axes
  MovingChain chain_;
  double finger_mass_{};  // of the heaviest finger [kg]
  double moving_mass_{};  // half of what the axes carry [kg]
  std::array<double, kBodyRegions> max_contact_speed_{};

  Stop at_once_, robot_side_;
  std::vector<Pair> pairs_;
  std::vector<char> paired_;  // capsules that are in a pair
  // Marks for the chain: all frames; those that carry a paired capsule.
  std::vector<char> all_frames_, needed_frames_;
  std::array<std::vector<Sample>, kIntervals + 1> samples_;  // of every capsule
  // Largest of each axis between a sample and the next.
  std::array<std::vector<double>, kIntervals> speeds_;
  std::array<bool, kIntervals> speeds_known_{};
  Vector position_, velocity_;
  std::vector<FrameMotion> motions_;  // of each frame
  // By axis: during the two stops, of the stop that is checked, since rooms were measured, at the
  // sample; until when it moves.
  std::vector<double> travel_, other_travel_, speed_, turning_, jerk_, moved_, now_, time_;
  // Of each capsule during both stops [m, m/s].
  std::vector<double> max_travel_, max_carried_, max_inner_;
  // Of a contact of the fingers to one of the arm, see finger_ratio_at().
  std::array<double, kBodyRegions> finger_ratio_{};
  double min_contact_speed_{}, max_person_speed_{};
  // Rooms: how far each capsule could move at a moment before anybody could reach it [m].
  std::vector<double> room_;
  std::uint64_t room_of_{};  // revision of the people
  Vector room_position_;
  Pose room_base_{Pose::Identity()};
  double room_duration_{};
  StopRefutation refutation_;
};

}  // namespace handsel::trajectory_controller
