// Exact collision and distance on the 3D models (FCL): robot against itself, scene, people. Not thread safe; one per thread.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
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
  std::string first, second;  ///< what touches what, when not free: "link forearm", "object mug", "box table", "person anna"
  std::string id;             ///< of the object, box or person touched; empty when the robot touches itself
};

/// A fixed obstacle of any shape (problem files, tests); T_parent_shape is in the world.
struct Obstacle {
  std::string id;
  PlacedShape placed;
};

/// Which parts of people are obstacles.
enum class PeopleParts { all, without_forearms_and_hands };

/// How deep a held object may be inside a box that supports objects: it stood there, and measurements are not exact (ours) [m].
inline constexpr double kSupportSlack = 0.005;

/// Links that no axis moves are not tested against scene and people: planning cannot change that.
class CollisionWorld {
 public:
  CollisionWorld(const RobotModel& robot, ObjectLibrary library);
  ~CollisionWorld();
  CollisionWorld(CollisionWorld&&) noexcept;

  void set_base(const Pose& T_world_base);
  void set_scene(const Scene&);  ///< objects (held ones are ignored) and boxes; takes Scene::T_world_base when robot_known
  void set_people(const HumanState&, PeopleParts parts = PeopleParts::all);  ///< capsules, inflated
  void set_obstacles(const std::vector<Obstacle>&);  ///< further fixed obstacles, besides the scene; named "box <id>"
  /// The object moves with the tool link. Links of the hand may touch it, each other around it, and the `allowed` scene objects and boxes;
  /// so may the object. A person named among the allowed keeps head, torso, upper arms and legs as obstacles; forearms and hands are none
  /// (the exchange is engaged). The object may be up to kSupportSlack inside the top of boxes that support objects.
  void set_attachment(const Attachment&, const std::vector<std::string>& allowed_contacts);

  CollisionVerdict check(const Vector& q);  ///< all axes
  bool is_free(const Vector& q);            ///< the same without the names
  /// Contact with people only, as set_people and the allowed contacts make them obstacles; cheap when they are far.
  CollisionVerdict check_people(const Vector& q);
  /// Contact with scene, obstacles and itself only.
  CollisionVerdict check_scene(const Vector& q);
  /// Checks the straight line every `step` [rad, max norm], both ends included, ends and middle first.
  CollisionVerdict check_motion(const Vector& from, const Vector& to, double step = 0.02);
  /// Least distance robot (with what it holds) to people [m]; closed forms against capsules around the robot's links; +inf if nobody.
  /// Negative when they overlap. All body parts count, whatever set_people and the allowed contacts say.
  double distance_to_people(const Vector& q);
  /// Least clearance to scene boxes, objects and obstacles [m] (>= 0), not below what is asked: distances beyond `cap` return `cap`.
  double distance_to_scene(const Vector& q, double cap = std::numeric_limits<double>::infinity());

  std::uint64_t checks() const;  ///< states judged so far, by whatever function

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// How many states check_motion judges on a line of this length at this step.
int motion_states(const Vector& from, const Vector& to, double step);

/// Distance of two segments [m]; closest points written when given.
double segment_distance(const Vector3& a0, const Vector3& a1, const Vector3& b0, const Vector3& b1, Vector3* on_a = nullptr,
                        Vector3* on_b = nullptr);

/// Contact and distance of two placed shapes (`handsel distance`): distance 0 when they touch.
struct ShapeDistance {
  bool collide{};
  double distance{};
};
ShapeDistance shape_distance(const Shape&, const Pose&, const Shape&, const Pose&);

}  // namespace handsel
