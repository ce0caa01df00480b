// SPDX-License-Identifier: Apache-2.0
// The world as SPARK represents it: scene, people, facts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/side.hpp"

namespace handsel {

enum class Holder : std::uint8_t { nobody, surface, robot, human };

/// A grip measured by an object's own sensor, and the gripping hand.
struct ObjectGrip {
  std::string person;  ///< id of the person whose hand is nearest, "robot", or empty: nobody's
  double force{};      ///< grip force [N]
};

/// A movable object of the scene.
struct SceneObject {
  std::string id;     ///< persistent name
  std::string model;  ///< name in deploy/objects; empty: unknown, its primitive is what is known
  Pose T_world_object{Pose::Identity()};  ///< object frame in the world
  Holder holder{Holder::nobody};          ///< nobody: in the air, or unknown
  /// Surface, person, or group of the robot's hand; empty for nobody and the first hand.
  std::string holder_id;
  double age{};                       ///< since last seen [s]
  Vector3 velocity{Vector3::Zero()};  ///< of the object frame's origin, world [m/s]
  /// Measured by the object's own sensors; empty where it has none.
  std::vector<ObjectGrip> grips{};
  Primitive primitive{};  ///< of an unknown object; else none
  /// Radius around T_world_object it may be in; grows while out of sight [m].
  double uncertainty{};
};

/// A fixed box: furniture, wall. Support surfaces are the top faces of boxes with supports = true.
struct SceneBox {
  std::string id;                      ///< name of the box, as in TaskGoal::surface
  Pose T_world_box{Pose::Identity()};  ///< centre
  Vector3 size{Vector3::Zero()};       ///< full extents [m]
  bool supports{};                     ///< objects may stand on its top face
};

/// Topic Scene, profile state, 10 Hz.
struct Scene {
  Stamp stamp{};                        ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::uint64_t revision{};             ///< grows with every change that matters to a planner
  bool robot_known{};                   ///< a RobotState has arrived
  Pose T_world_base{Pose::Identity()};  ///< root link of the robot, as last measured
  Vector robot_position;             ///< all axes, as last measured [rad]; empty until robot_known
  std::vector<SceneObject> objects;  ///< objects known, at most 64
  std::vector<SceneBox> boxes;       ///< furniture and walls, at most 64
  std::uint32_t left_out{};  ///< objects and boxes known but left out: farther than those named
};

/// A point of a person's fitted body.
struct BodyJoint {
  std::string name;                   ///< REP-155, as in ObservedJoint
  Vector3 position{Vector3::Zero()};  ///< world [m]
  Vector3 velocity{Vector3::Zero()};  ///< world [m/s]
  /// Since this point itself was measured [s]; 1e9: never, inferred from the fitted body.
  double age{};
};

/// Where a hand is expected.
struct HandAhead {
  double time{};                      ///< from the stamp of the message on [s]
  Vector3 position{Vector3::Zero()};  ///< of the palm, world [m]
  double uncertainty{};               ///< radius of the ball it is in [m]
};

/// Predicted motion of one hand.
struct HandPrediction {
  std::string joint;             ///< REP-155 name of the hand: l_hand or r_hand
  std::vector<HandAhead> ahead;  ///< in order of time
};

/// How a hand is turned.
struct PalmDirection {
  std::string joint;                 ///< REP-155 name of the hand: l_hand or r_hand
  Vector3 normal{Vector3::UnitX()};  ///< out of the palm, world, unit vector
};

/// A person, tracked over all sources.
struct Person {
  std::string id;                 ///< persistent
  std::vector<BodyJoint> joints;  ///< complete fitted body
  double stature{1.75};           ///< body height [m]
  bool gaze_known{};              ///< false: the two gaze fields have no meaning
  Vector3 gaze_origin{Vector3::Zero()}, gaze_direction{Vector3::UnitX()};  ///< world, unit
  double age{};                                                            ///< since last seen [s]
  double inflation{};                   ///< all body volumes grow by this: v_h * age while lost [m]
  std::vector<HandPrediction> hands{};  ///< the next half second; empty while lost
  std::vector<PalmDirection> palms{};   ///< of the hands whose knuckles are observed
};

/// What one source of people observes: what makes "nobody is there" a fact. Axis-aligned box in
/// world.
struct SourceView {
  std::string source;                                   ///< name of the sensor
  Vector3 low{Vector3::Zero()}, high{Vector3::Zero()};  ///< corners of the observed box, world [m]
  double age{};        ///< since the capture of its newest image [s]
  bool live{};         ///< its images are new: neither silent, late nor repeated
  std::string reason;  ///< why it is not live, one sentence
};

/// Another robot: a moving obstacle that is no person.
struct OtherRobot {
  std::string name;               ///< as in RobotReport
  std::vector<MovingPart> parts;  ///< its volume, where it is now; at most 128
  double age{};                   ///< since the robot was reported last [s]
};

/// Topic HumanState, profile state. Published at its rate even when nobody is there.
struct HumanState {
  Stamp stamp{};               ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::vector<Person> people;  ///< all people who may be present, lost people included; at most 16
  bool covered{};  ///< the robot's reach is inside the volume observed recently: "nobody" is a fact
  std::vector<SourceView> views{};  ///< of every source
  std::uint32_t left_out{};  ///< people known but left out: farther from the robot than those named
  std::vector<OtherRobot> robots{};  ///< other robots around, at most 4
};

enum class FactKind : std::uint8_t {
  in_contact_zone,
  in_danger_zone,
  in_interaction_zone,
  in_social_zone,  ///< subject = person (zones of the robot)
  approaching,
  attentive,
  reaching,
  hand_near_object,  ///< subject = person; object where it applies
  on_surface,
  held_by_robot,
  held_by_human,
  reachable_by_robot,
  reachable_by_human,  ///< subject = object; object = surface/person
  inside,
  next_to,             ///< subject = object; object = object
  visible_to,          ///< subject = object; object = person
  looking_at,          ///< subject = person; object = object, person or "robot"
  moving,              ///< subject = person or object
  offering,            ///< subject = person; object = what they hold
  waiting_to_receive,  ///< subject = person; object = what another holds
  withdrawn,           ///< subject = person; object = what they reached for or offered a moment ago
  /// Subject = object; object = the giver (person or "robot") that has just released it into
  /// another hand.
  released,
};
/// Returns the word of kFactNames; "unknown" for a value outside the enumeration.
const char* name(FactKind);

/// Name of the robot as subject or object of a fact.
inline constexpr const char* kRobotName = "robot";

/// A symbolic relation that holds now.
struct Fact {
  FactKind kind{};         ///< defines what subject, object and value mean
  std::string subject;     ///< person or object id
  std::string object;      ///< surface, person or object id; empty where the kind has none
  double value{};          ///< kind-specific: distance [m], speed [m/s]; 1 for plain facts
  double since{};          ///< time for which it has held [s]
  std::string evidence{};  ///< one line for people: what was measured
};

/// Topic Facts, profile state, 20 Hz: the facts that hold now.
struct Facts {
  Stamp stamp{};             ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::vector<Fact> facts;   ///< the most relevant ones, at most 256
  std::uint32_t left_out{};  ///< facts that hold but were left out for want of room
};

/// Names of the cost map's own layers; any other is an outside layer, which planners add to theirs.
inline constexpr const char* kOwnLayers[] = {"safety", "visibility", "arm_comfort", "total"};

/// One layer of cost over a regular grid. Topic Costmap, profile advice, keyed by layer.
/// value(i,j,k) at origin + resolution*(i,j,k) in world; 255 = forbidden or out of reach, else
/// cost*254.
struct Costmap {
  Stamp stamp{};       ///< time of sending, UTC [ns]; 0: filled in by the bus
  std::string layer;   ///< one of kOwnLayers, or an outside one
  std::string person;  ///< id of the person it refers to; empty: an outside layer about nobody
  std::uint64_t revision{};         ///< grows with every new map; a repeated map keeps its number
  Vector3 origin{Vector3::Zero()};  ///< position of value (0, 0, 0), world [m]
  double resolution{};              ///< distance of neighbouring points [m]
  std::uint32_t nx{}, ny{}, nz{};   ///< grid points along x, y and z, at most 1024 each
  double weight{1};  ///< factor on an outside layer's cost where planners add it; own layers: 1
  std::vector<std::uint8_t> values;  ///< index (k*ny + j)*nx + i
};

}  // namespace handsel
