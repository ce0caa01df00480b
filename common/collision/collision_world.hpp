// Exact collision and distance on the 3D models (FCL): robot against itself, scene, people. Not thread safe; copy one per thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "common/model/human_body.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

/// Gives the model of an object by its name, or nullptr.
using ObjectLibrary = std::function<const ObjectModel*(const std::string&)>;

struct CollisionVerdict {
  bool free{true};
  std::string first, second;   ///< what touches what, when not free: "link forearm", "object mug", "box table", "person anna"
};

class CollisionWorld {
 public:
  CollisionWorld(const RobotModel& robot, ObjectLibrary library);
  ~CollisionWorld();
  CollisionWorld(CollisionWorld&&) noexcept;

  void set_base(const Pose& T_world_base);
  void set_scene(const Scene&);                 ///< objects (held ones are ignored) and boxes
  void set_people(const HumanState&);           ///< capsules, inflated
  /// The object moves with the tool link; links of the hand may touch it and the `allowed` scene objects. A person named among the
  /// allowed keeps head, torso, upper arms and legs as obstacles; forearms and hands are none (the exchange is engaged).
  void set_attachment(const Attachment&, const std::vector<std::string>& allowed_contacts);

  CollisionVerdict check(const Vector& q);      ///< all axes
  /// Checks the straight line every `step` [rad, max norm], both ends included.
  CollisionVerdict check_motion(const Vector& from, const Vector& to, double step = 0.02);
  /// Least distance robot (with what it holds) to people [m]; closed forms against capsules around the robot's links; +inf if nobody.
  double distance_to_people(const Vector& q);
  /// Least clearance to scene boxes and objects [m] (>= 0).
  double distance_to_scene(const Vector& q);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Distance of two segments [m]; closest points written when given.
double segment_distance(const Vector3& a0, const Vector3& a1, const Vector3& b0, const Vector3& b1, Vector3* on_a = nullptr, Vector3* on_b = nullptr);

/// Contact and distance of two placed shapes (`handsel distance`): distance 0 when they touch.
struct ShapeDistance { bool collide{}; double distance{}; };
ShapeDistance shape_distance(const Shape&, const Pose&, const Shape&, const Pose&);

}  // namespace handsel
