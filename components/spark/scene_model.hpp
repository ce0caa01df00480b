// SPDX-License-Identifier: Apache-2.0
// Models objects, their poses and holders, from observations, fixed boxes and the robot's
// configuration. Pure.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/collision/collision_world.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"
#include "common/model/robot_model.hpp"
#include "components/spark/quotas.hpp"
#include "components/spark/scene/object_track.hpp"
#include "components/spark/scene/robot_placement.hpp"
#include "components/spark/sources.hpp"

namespace handsel::spark {

/// An unobserved object remains in the scene; its `uncertainty` grows until the next observation,
/// faster near a person's hand. An unobserved object in a person's hand moves with the hand and
/// disappears with the person. One source of an object is used as long as that source reports; a
/// deviation of another source increases the uncertainty. If two objects of a kind exchange places
/// faster than a person can carry them, their ids are exchanged back. An object without a model is
/// represented by its primitive. Own method: an unobserved object may have been moved.
class SceneModel {
 public:
  SceneModel(const settings::SparkSettings& settings, std::shared_ptr<const RobotModel> robot,
             ObjectLibrary objects, std::vector<SceneBox> boxes);

  /// Takes an observation captured at `seen`. Refuses and counts objects with neither a model nor a
  /// primitive of a size.
  void observe(const ObjectObservation& observation, TimePoint seen);
  /// Returns how many objects of observations were refused so far.
  std::uint64_t refused() const { return refused_; }
  /// Notes that the task requests an object, which is then kept before others beyond the quota; the
  /// last 8 requests count.
  void request(const std::string& object);
  /// Returns the number of objects left out of the last scene.
  std::uint32_t objects_left_out() const { return objects_left_out_.count; }
  /// Returns the number of boxes left out of the last scene.
  std::uint32_t boxes_left_out() const { return boxes_left_out_.count; }
  /// Returns the number of observations of objects beyond the quota of remembered objects.
  std::uint64_t forgotten() const { return forgotten_; }
  /// Returns one sentence about recently refused objects and elements left out within reach of the
  /// arm; empty: none.
  std::string trouble(TimePoint now) const;
  /// Takes the state of the same robot: configuration, base pose, payload of each hand.
  void update(const RobotState& state) { robot_.update(state); }
  /// Returns the scene at `now`; holders are decided from geometry, the load of the robot's hands
  /// and the hands of people.
  Scene scene(TimePoint now, const HumanState& people);

  /// Returns whether update() was called.
  bool robot_known() const { return robot_.known(); }
  /// Returns the base pose of the last update(); identity before.
  const Pose& T_world_base() const { return robot_.T_world_base(); }
  /// Returns the pose of the first hand's palm as of the last observe(), scene() or obstacles();
  /// identity before the robot is known.
  const Pose& T_world_tool() const { return robot_.hands().front().T_world_palm; }
  /// Returns the box around all points within the robot's reach, which sources must cover.
  Coverage reach() const { return robot_.reach(); }
  /// Returns the bodies that occlude people: the robot in its present configuration and fixed
  /// boxes.
  const Obstacles& obstacles();

 private:
  Rank rank(const SceneObject& object) const;
  void apply_quota(std::vector<ObservedObject>& seen);
  void forget_least_relevant();
  std::string left_out_in_reach() const;

  settings::SparkSettings settings_;
  ObjectLibrary library_;
  std::vector<SceneBox> boxes_;
  RobotPlacement robot_;
  ObjectTracks objects_;
  std::vector<LinkCapsule> capsules_;
  Obstacles obstacles_;
  std::uint64_t revision_{0};
  Scene last_;
  std::uint64_t refused_{0};
  std::string refusal_;
  TimePoint refused_at_{};
  std::deque<std::string> requested_;
  LeftOut objects_left_out_, boxes_left_out_;
  std::uint64_t forgotten_{0};
};

}  // namespace handsel::spark
