// What sensors say: external perception connects here. All poses and points in frame "world".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"

namespace handsel {

/// A tracked point of a body. Names are REP-155 joints and links: head, neck, torso (chest), waist, l_shoulder, l_elbow, l_wrist,
/// l_hand, r_..., l_hip, l_knee, l_ankle, r_...
struct ObservedJoint {
  std::string name;
  Vector3 position;     ///< world [m]
  double confidence{};  ///< [0, 1]
};

struct ObservedPerson {
  std::string body;  ///< transient id of the tracker
  std::vector<ObservedJoint> joints;
  bool has_gaze{};
  Vector3 gaze_origin{Vector3::Zero()};      ///< between the eyes, world [m]
  Vector3 gaze_direction{Vector3::UnitX()};  ///< unit, world
};

/// The volume a source has looked at: what makes "nobody there" a fact. Axis-aligned box in world [m].
struct Coverage {
  Vector3 low{Vector3::Zero()}, high{Vector3::Zero()};
};

/// Topic HumanObservation, profile sensor, keyed by source.
struct HumanObservation {
  Stamp stamp{};
  std::string source;
  Coverage coverage;
  std::vector<ObservedPerson> people;
};

/// What a force sensor in an object feels where a hand grips it.
struct ObservedGrip {
  Vector3 position{Vector3::Zero()};  ///< of the sensor, world [m]
  double force{};                     ///< [N]
};

enum class PrimitiveKind : std::uint8_t { none, box, cylinder, sphere };

/// Shape of a thing nobody has described, centred in its own frame; cylinders along z.
struct Primitive {
  PrimitiveKind kind{PrimitiveKind::none};
  Vector3 size{Vector3::Zero()};  ///< full extents along the axes of its frame [m]
};

struct ObservedObject {
  std::string id;     ///< persistent name of this object, e.g. "mug"
  std::string model;  ///< object description it was recognised as; empty: unknown, its primitive is what is known
  Pose T_world_object{Pose::Identity()};
  double confidence{};
  std::vector<ObservedGrip> grips{};  ///< of an object with force sensors; else empty
  Primitive primitive{};              ///< of an unknown object; else none
};

/// Topic ObjectObservation, profile sensor, keyed by source.
struct ObjectObservation {
  Stamp stamp{};
  std::string source;
  std::vector<ObservedObject> objects;
};

}  // namespace handsel
