// For the sources of SimWorld: what a world consists of.
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

/// Combines numbers into one that tells two runs apart.
struct StateHash {
  std::uint64_t value{0xcbf29ce484222325ULL};  ///< of the numbers so far
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

inline constexpr double kContactDistance = 0.001;  ///< closer than this is a contact [m]
/// A push still moves the arm this long after the last contact [s].
inline constexpr double kPush = 0.2;

struct SimWorld::Impl {
  struct Hand {
    const Group *arm{}, *fingers{};  ///< nullptr: none
    int palm{-1};                    ///< link; -1: none
    RobotGrasp grasp;                ///< from the contacts of the fingers
    Grip grip;                       ///< constraint that helps to hold an object
    HandMeasure measured;            ///< wrist wrench, payload and external torque
    int gripped{-1};                 ///< object; -1: none
  };

  Impl(const RobotModel& robot_model, const ObjectLibrary& library,
       const config::Scenario& scenario, const SimSettings& s, std::uint64_t seed);
  ~Impl();
  /// Returns the simulated time [s].
  double now() const { return static_cast<double>(steps) * settings.step; }
  /// Advances by one physics step.
  void step();
  /// Returns a normally distributed number; 0 without a deviation, which leaves the generator.
  double noise(double sigma) { return sigma > 0 ? sigma * normal(random) : 0; }

  // world.cpp: construction
  void add_hand(const Manipulator& hand);  ///< `hand` may be empty: the robot has none
  /// Returns the axes of the fingers of all hands.
  std::vector<int> finger_axes() const;
  /// Adds the boxes of the scene and the floor.
  void build_fixed();
  /// Adds one body that does not move; `shape` must outlive the world.
  void add_fixed(btCollisionShape* shape, const Pose& T, Owner owner, int index);

  /// Returns all axes as the robot side measures them.
  Vector measured_position() const;

  // world_hands.cpp: grasps of the robot's hands
  BodyState tool_state(const Hand& hand) const;  ///< of its palm, world
  void update_robot_hands();                     ///< writes what people see of all hands
  void hold_with(Hand& hand);       ///< applies the grasp constraint for the coming step
  static void release(Hand& hand);  ///< ends grasp and constraint
  /// Returns whether the grasp constraint helps to hold the object.
  bool helped(int object) const;
  bool grips(int object) const;  ///< whether any hand holds the object
  bool holds_firmly(const Hand&) const;
  bool grips_something() const;   ///< whether any hand holds an object
  bool of_hand(int body) const;   ///< whether the robot's body is part of a hand
  void update_grasp(Hand& hand);  ///< from the contacts of the step
  void update_grasps();           ///< the same for all hands, and which part holds
  void measure(Hand& hand);       ///< what its sensors report

  // world_oracle.cpp: what happened
  void evaluate();                     ///< counts violations and collisions of the step
  bool is_pushed();                    ///< by a person, without the robot pressing against them
  ObjectSituation situation() const;   ///< of the watched object
  std::optional<Taker> taker() const;  ///< who has a hand at the watched object
  void measure_other_robots();         ///< distance to other robots, and contacts with them
  void add_to_hash();                  ///< positions and velocities of the step

  // world_sensing.cpp: what sensors of people and objects see
  void prepare_sight();  ///< which bodies can hide what is behind them
  void update_sight();   ///< where everything is now
  void sense();          ///< observes with each sensor that is due

  // world_control.cpp: what is done to the world from outside
  std::string control(const SimControl& c);        ///< as of SimWorld::control()
  std::string stop_robot(const std::string& how);  ///< empty, or one sentence: why not
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

  std::optional<PlatformOdometry> odometry;  // of a robot that drives
  RobotSide side;
  Reference reference;
  std::optional<StuckHand> stuck_hand;
  std::vector<Hand> hands;  // never empty; the first is that of the tool
  /// The force of the constraints on what is held is larger than that of the hands' contacts.
  bool constraint_carries{false};
  double held_time{0}, constraint_time{0};
  int watched{-1}, ssm_every{10};
  std::uint64_t steps{0}, state_sequence{0};
  std::size_t next_disturbance{0};
  double human_silent_until{0}, state_silent_until{0};
  std::vector<Touch> touches, pushes;
  double pushed_at{-kPush};
  std::vector<PersonVolume> person_volumes;
  std::vector<RobotHandState> robot_hands;  // as people see them, in the order of `hands`
  Sight sight;
  std::vector<LinkCapsule> hiding_links;
  std::vector<LinkCapsule> finger_capsules;  // of all links, while any person minds the fingers
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
