// SPDX-License-Identifier: Apache-2.0
// For the sources of SimWorld: the members of a world.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>

#include "common/model/manipulator.hpp"
#include "common/model/robot_capsules.hpp"
#include "sim/oracle/handover_oracle.hpp"
#include "sim/oracle/limits_oracle.hpp"
#include "sim/oracle/taking_oracle.hpp"
#include "sim/people/people.hpp"
#include "sim/robot/hand_measure.hpp"
#include "sim/robot/other_robot.hpp"
#include "sim/robot/platform_odometry.hpp"
#include "sim/robot/robot_grasp.hpp"
#include "sim/robot/stuck_hand.hpp"
#include "sim/world.hpp"

namespace handsel::sim {

/// Hashes numbers; different runs give different hashes.
struct StateHash {
  std::uint64_t value{0xcbf29ce484222325ULL};  ///< hash of the numbers so far
  /// Adds one number.
  void add(double x) {
    value ^= std::bit_cast<std::uint64_t>(x);
    value *= 0x100000001b3ULL;
    value ^= value >> 29;
  }
  /// Adds all elements of a vector.
  template <class V>
  void add_all(const V& v) {
    for (Eigen::Index i = 0; i < v.size(); ++i) add(v[i]);
  }
};

inline constexpr double kContactDistance = 0.001;  ///< max distance of a contact [m]
/// Time after the last contact for which a push still moves the arm [s].
inline constexpr double kPushDuration = 0.2;

struct SimWorld::Impl {
  struct Hand {
    const Group *arm{}, *fingers{};  ///< nullptr: none
    int palm{-1};                    ///< link; -1: none
    RobotGrasp grasp;                ///< from the contacts of the fingers
    Grip grip;                       ///< grasp constraint
    HandMeasure measured;            ///< wrist wrench, payload and external torque
    int gripped{-1};                 ///< index of the held object; -1: none
    int pressed{-1};                 ///< index of the object that the hand presses on; -1: none
  };

  Impl(const RobotModel& robot_model, const ObjectLibrary& library,
       const config::Scenario& scenario, const SimSettings& s, std::uint64_t seed);
  ~Impl();
  /// Returns the simulated time [s].
  double now() const { return static_cast<double>(steps) * settings.step; }
  /// Advances by one physics step.
  void step();
  /// Returns a normally distributed number; for sigma 0 returns 0 and does not use the generator.
  double noise(double sigma) { return sigma > 0 ? sigma * normal(random) : 0; }

  // world.cpp: construction
  void add_hand(const Manipulator& hand);  ///< Adds a hand; empty: the robot has none.
  /// Returns the axes of the fingers of all hands.
  std::vector<int> finger_axes() const;
  /// Adds the boxes of the scene and the floor.
  void build_fixed();
  /// Adds one body that does not move; `shape` must outlive the world.
  void add_fixed(btCollisionShape* shape, const Pose& T, Owner owner, int index);

  /// Returns the positions of all axes as measured by the robot side.
  Vector measured_position() const;

  // world_hands.cpp: grasps of the robot's hands
  BodyState tool_state(const Hand& hand) const;  ///< Returns the palm's state, world.
  void update_robot_hands();                     ///< Writes the hands' state as observed by people.
  void hold_with(Hand& hand);       ///< Applies the grasp constraint for the next step.
  static void release(Hand& hand);  ///< Ends grasp and constraint.
  /// Returns whether the grasp constraint helps to hold the object.
  bool helped(int object) const;
  bool grips(int object) const;  ///< Returns whether any hand holds the object.
  bool holds_firmly(const Hand&) const;
  bool grips_something() const;   ///< Returns whether any hand holds an object.
  bool of_hand(int body) const;   ///< Returns whether the body belongs to a hand.
  void update_grasp(Hand& hand);  ///< Updates a grasp from the contacts of the step.
  /// Updates the grasps of all hands, and whether contacts or constraints bear the load.
  void update_grasps();
  void measure(Hand& hand);  ///< Updates the measurements of a hand.

  // world_oracle.cpp: evaluation
  void evaluate();                     ///< Counts violations and collisions of the step.
  bool is_pushed();                    ///< Returns whether a person pushes the robot.
  ObjectSituation situation() const;   ///< Returns the situation of the watched object.
  std::optional<Taker> taker() const;  ///< Returns the person with a hand on that object.
  void measure_other_robots();         ///< Measures the distance to other robots.
  void add_to_hash();                  ///< Hashes positions and velocities of the step.

  // world_sensing.cpp: sensors of people and objects
  void prepare_sight();  ///< Collects the bodies that can occlude others.
  void update_sight();   ///< Updates the positions of all bodies.
  void sense();          ///< Observes with each sensor that is due.

  // world_control.cpp: disturbances from outside
  std::string control(const SimControl& c);  ///< Implements SimWorld::control().
  /// Stops the robot; empty, or one sentence: why not.
  std::string stop_robot(const std::string& how);
  /// Applies a fault to the source of people, or to all sources; empty, or one sentence: why not.
  std::string disturb(const std::string& source, const SensorFault& fault);
  /// Disturbs localisation or wheels; empty, or one sentence: why not.
  std::string disturb_platform(const SimControl& c, double until);

  const RobotModel& model;
  SimSettings settings;
  SceneSetup setup;
  std::mt19937_64 random;
  std::normal_distribution<double> normal{0, 1};

  ShapeStore shapes;
  btStaticPlaneShape floor{btVector3(0, 0, 1), 0};
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld dynamics;
  std::vector<std::unique_ptr<btCollisionObject>> fixed;
  std::unique_ptr<RobotBody> robot;
  ObjectBodies objects;
  std::unique_ptr<People> people;

  std::optional<PlatformOdometry> odometry;  // nullopt: the robot has no platform
  RobotSide side;
  Reference reference;
  std::optional<StuckHand> stuck_hand;
  std::vector<Hand> hands;  // never empty; the first hand is that of the tool
  /// Whether the constraints bear more of the held objects' load than the contacts.
  bool constraint_carries{false};
  double held_time{0}, constraint_time{0};
  int watched{-1}, ssm_every{10};
  std::uint64_t steps{0}, state_sequence{0};
  std::size_t next_disturbance{0};
  double human_silent_until{0}, state_silent_until{0};
  std::vector<Touch> touches, pushes;
  double pushed_at{-kPushDuration};
  std::vector<PersonVolume> person_volumes;
  std::vector<RobotHandState> robot_hands;  // as observed by people, in the order of `hands`
  Sight sight;
  std::vector<LinkCapsule> hiding_links;
  std::vector<LinkCapsule> links;     // capsules of all links; empty without people
  std::vector<HandPart> robot_parts;  // the same, world
  std::vector<HumanSensor> human_sensors;
  std::vector<ObjectSensor> object_sensors;

  std::vector<OtherRobotBody> other_robots;
  std::vector<LinkCapsule> robot_hull;  // of all links, while there are other robots
  double min_robot_distance{std::numeric_limits<double>::infinity()};

  LimitsOracle limits;
  SeparationOracle separations;
  std::unique_ptr<HandoverOracle> handover;
  TakingOracle taking;
  TrueSeparation near{std::numeric_limits<double>::infinity(), -1, Vector3::Zero(), Vector3::Zero(),
                      Vector3::Zero()};
  double min_separation{std::numeric_limits<double>::infinity()};
  PeakSpeed closing;
  std::uint64_t collisions{0}, ssm_violations{0};
  std::string last_collision;
  StateHash hash;
};

}  // namespace handsel::sim
