// SPDX-License-Identifier: Apache-2.0
// Collision and distance on the 3D models: robot against itself, scene, people. Exact (FCL); after
// set_moving_axes(), spheres around the links clear most states first, many at a time (SIMD check),
// and FCL checks the rest: the verdicts are the same. Not thread safe; one per thread.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

/// Returns the model of an object by its name, or nullptr.
using ObjectLibrary = std::function<const ObjectModel*(const std::string&)>;

struct CollisionVerdict {
  bool free{true};  ///< nothing touches
  /// What touches what, when not free: "link forearm", "object mug", "box table", "person anna",
  /// "robot left".
  std::string first, second;
  std::string id;  ///< of the object, box or person touched; empty when the robot touches itself
};

/// A fixed obstacle of any shape (problem files, tests); T_parent_shape is in the world.
struct Obstacle {
  std::string id;      ///< for the verdict
  PlacedShape placed;  ///< pose in the world
};

/// Which parts of people are obstacles.
enum class PeopleParts { all, without_forearms_and_hands };

/// How deep a held object may be inside a box that supports objects: it stood there, and
/// measurements are not exact [m]. Own method: else a lift would begin in collision.
inline constexpr double kSupportSlack = 0.005;

/// Links that no axis moves are not tested against scene and people, and links whose relative pose
/// no moving axis changes (set_moving_axes; two fingers, while the arm moves) not against each
/// other: the motion cannot change that.
class CollisionWorld {
 public:
  CollisionWorld(const RobotModel& robot, ObjectLibrary library);
  ~CollisionWorld();
  CollisionWorld(CollisionWorld&&) noexcept;

  void set_base(const Pose& T_world_base);  ///< pose of the robot's root link
  /// Boxes, and objects the robot does not hold; takes T_world_base when robot_known.
  void set_scene(const Scene&);
  /// People as capsules, inflated, and other robots as they are now.
  void set_people(const HumanState&, PeopleParts parts = PeopleParts::all);
  /// Further fixed obstacles, besides the scene; named "box <id>".
  void set_obstacles(const std::vector<Obstacle>&);
  /// The object moves with the palm of the hand that holds it. Links of that hand may touch it,
  /// each other around it, and the `allowed` scene objects and boxes; so may the object. Where it
  /// is among the allowed itself, so may every other hand. A person named among the allowed keeps
  /// head, torso, upper arms and legs as obstacles; forearms and hands are none (the exchange is
  /// engaged). The object may be up to kSupportSlack inside the top of boxes that support objects.
  void set_attachment(const Attachment&, const std::vector<std::string>& allowed_contacts);

  /// From now on is_free and check_motion use the SIMD check first, and links that these axes do
  /// not move relative to each other may touch. Only these axes should differ between the states
  /// checked; when another one does, the robot is folded anew. Empty: exact only and all pairs of
  /// links, as at the beginning. The first check makes the spheres of the links.
  void set_moving_axes(const std::vector<int>& axes);

  /// Links turned by other axes than the moving ones (the head, while the arm moves) are larger by
  /// this on every side for what the moving axes move: they may turn on their own meanwhile [m]. Of
  /// meshes it is the box around them that is larger. Without moving axes nothing is.
  void set_turning_margin(double margin);

  CollisionVerdict check(const Vector& q);  ///< all axes
  bool is_free(const Vector& q);            ///< the same without the names
  /// Contact with people, what they hold, and other robots, as set_people and the allowed contacts
  /// make them obstacles; cheap when they are far.
  CollisionVerdict check_people(const Vector& q);
  /// Contact with scene, obstacles and itself only.
  CollisionVerdict check_scene(const Vector& q);
  /// Checks the straight line every `step` [rad, max norm], both ends included, ends and middle
  /// first.
  CollisionVerdict check_motion(const Vector& from, const Vector& to, double step = 0.02);
  /// Min distance robot (with what it holds) to people [m]; closed forms against capsules around
  /// the robot's links; +inf without people. Negative when they overlap. All body parts count,
  /// whatever set_people and the allowed contacts say. Writes the points nearest each other on
  /// robot and person, in the world, when given.
  double distance_to_people(const Vector& q, Vector3* on_robot = nullptr,
                            Vector3* on_person = nullptr);
  /// Min clearance to scene boxes, objects and obstacles [m] (>= 0), not below what is asked:
  /// distances beyond `cap` return `cap`. Writes the points nearest each other on robot and scene,
  /// in the world, when given, the distance is below `cap` and nothing touches.
  double distance_to_scene(const Vector& q, double cap = std::numeric_limits<double>::infinity(),
                           Vector3* on_robot = nullptr, Vector3* on_scene = nullptr);

  /// Uses the SIMD check alone for the states of check_motion: true is sure of them, false is
  /// unknown; false without moving axes.
  bool surely_free_at_steps(const Vector& from, const Vector& to, double step = 0.02);

  /// Whether the straight line is free of contact everywhere, not at steps only, as the SIMD check
  /// can show: true is sure, false is unknown.
  bool surely_free(const Vector& from, const Vector& to);

  static constexpr int kMaxBoxes = 16;  ///< upper limit of `count` in unclear_boxes()
  /// Returns, of up to 16 boxes of configurations (all axes; equal on those that do not move), the
  /// bits of those that the SIMD check cannot show to be free of contact everywhere; all bits
  /// without moving axes.
  std::uint32_t unclear_boxes(const Vector* low, const Vector* high, int count);

  std::uint64_t checks() const;        ///< states checked so far, by any function
  std::uint64_t exact_checks() const;  ///< those of them that FCL had to check

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns how many states check_motion checks on a line of this length at this step.
int motion_states(const Vector& from, const Vector& to, double step);

/// Distance of two segments [m]; closest points written when given.
double segment_distance(const Vector3& a0, const Vector3& a1, const Vector3& b0, const Vector3& b1,
                        Vector3* on_a = nullptr, Vector3* on_b = nullptr);

/// Contact and distance of two placed shapes (`handsel distance`): distance 0 when they touch.
struct ShapeDistance {
  bool collide{};     ///< the shapes touch
  double distance{};  ///< [m]
};
/// Returns the exact contact and distance of two shapes with their poses in one frame.
ShapeDistance shape_distance(const Shape&, const Pose&, const Shape&, const Pose&);

}  // namespace handsel
