// SPDX-License-Identifier: Apache-2.0
// Measurements of sensors: external perception connects here. All poses and points in frame
// "world".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel {

/// A tracked point of a body. Names are REP-155 joints and links: head, neck, torso (chest), waist,
/// l_shoulder, l_elbow, l_wrist, l_hand, r_..., l_hip, l_knee, l_ankle, r_...
struct ObservedJoint {
  std::string name;     ///< REP-155 name
  Vector3 position;     ///< world [m]
  double confidence{};  ///< [0, 1]
};

/// A person as one tracker sees them.
struct ObservedPerson {
  std::string body;                          ///< transient id of the tracker
  std::vector<ObservedJoint> joints;         ///< any subset of the body
  bool has_gaze{};                           ///< false: the two gaze fields have no meaning
  Vector3 gaze_origin{Vector3::Zero()};      ///< between the eyes, world [m]
  Vector3 gaze_direction{Vector3::UnitX()};  ///< unit, world
};

/// The volume a source has observed: inside, "nobody there" is a fact. Axis-aligned box in world
/// [m].
struct Coverage {
  /// Lowest and highest corner; equal corners: nothing is covered.
  Vector3 low{Vector3::Zero()}, high{Vector3::Zero()};
};

/// Topic HumanObservation, profile sensor, keyed by source.
struct HumanObservation {
  Stamp stamp{};                       ///< time of measurement, UTC [ns]; 0: filled in by the bus
  std::string source;                  ///< name of the sensor
  Coverage coverage;                   ///< volume observed in this measurement
  std::vector<ObservedPerson> people;  ///< all observed people, at most 256
};

/// A part of a robot that moves: the capsule about the segment from `a` to `b`.
struct MovingPart {
  Vector3 a{Vector3::Zero()}, b{Vector3::Zero()};  ///< ends, world [m]
  double radius{};                                 ///< [m]
  /// Velocities of the two ends, world [m/s].
  Vector3 velocity_a{Vector3::Zero()}, velocity_b{Vector3::Zero()};
};

/// Topic RobotReport, profile sensor, keyed by robot: the volume of a robot, for the other robots
/// around.
struct RobotReport {
  Stamp stamp{};                  ///< time of measurement, UTC [ns]; 0: filled in by the bus
  std::string robot;              ///< name of the robot, unique in the domain
  std::vector<MovingPart> parts;  ///< at most 128; together they contain the robot
};

/// Measurement of a force sensor in an object where a hand grips it.
struct ObservedGrip {
  Vector3 position{Vector3::Zero()};  ///< of the sensor, world [m]
  double force{};                     ///< grip force [N]
};

enum class PrimitiveKind : std::uint8_t { none, box, cylinder, sphere };

/// Shape of an object without description, centred in its own frame; cylinders along z.
struct Primitive {
  PrimitiveKind kind{PrimitiveKind::none};  ///< none: no shape is known, and `size` has no meaning
  Vector3 size{Vector3::Zero()};            ///< full extents along the axes of its frame [m]
};

/// An object as one source sees it.
struct ObservedObject {
  std::string id;  ///< persistent name of this object, e.g. "mug"
  /// Object description it was recognised as; empty: unknown, its primitive is what is known.
  std::string model;
  Pose T_world_object{Pose::Identity()};  ///< object frame in the world
  double confidence{};                    ///< [0, 1]
  std::vector<ObservedGrip> grips{};      ///< of an object with force sensors; else empty
  Primitive primitive{};                  ///< of an unknown object; else none
};

/// Topic ObjectObservation, profile sensor, keyed by source.
struct ObjectObservation {
  Stamp stamp{};                        ///< time of measurement, UTC [ns]; 0: filled in by the bus
  std::string source;                   ///< name of the sensor
  std::vector<ObservedObject> objects;  ///< everything seen, at most 1024
};

}  // namespace handsel
