// What stands where and who holds it: objects from observations, fixed boxes from the place, the
// robot's own configuration. Pure.
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

/// An object stays when nobody sees it: `uncertainty` grows from then on, faster where somebody's
/// hand could reach it, until it is seen again. In a hand out of sight it moves with the hand, and
/// leaves with the person. Of several sources that see it one is believed as long as it reports;
/// what another reports makes the place more uncertain when it differs. Two things of a kind that
/// change places faster than anybody could have carried them have changed names. An object nobody
/// has described enters as its primitive. Own method: an object out of sight may have been moved.
class SceneModel {
 public:
  SceneModel(const settings::SparkSettings& settings, std::shared_ptr<const RobotModel> robot,
             ObjectLibrary objects, std::vector<SceneBox> boxes);

  /// What is neither described nor a primitive of a size is refused and counted.
  void observe(const ObjectObservation& observation, TimePoint seen);
  /// Returns how many objects of observations were refused so far.
  std::uint64_t refused() const { return refused_; }
  /// The task wants this object: it is kept before others when there are too many. The last few
  /// count.
  void want(const std::string& object);
  /// Objects and boxes left out of the last scene.
  std::uint32_t objects_left_out() const { return objects_left_out_.count; }
  /// Returns how many boxes were left out of the last scene.
  std::uint32_t boxes_left_out() const { return boxes_left_out_.count; }
  /// Observations of objects beyond what is remembered.
  std::uint64_t forgotten() const { return forgotten_; }
  /// One sentence about the objects refused lately and what is left out within reach of the arm;
  /// empty: none.
  std::string trouble(TimePoint now) const;
  /// Takes the state of the robot, which must be this one's: configuration, base pose, payload of
  /// each hand.
  void update(const RobotState& state) { robot_.update(state); }
  /// Decides who holds what from geometry, the hand's load and the people's hands.
  Scene scene(TimePoint now, const HumanState& people);

  /// Returns whether update() was called.
  bool robot_known() const { return robot_.known(); }
  /// Returns the base pose of the last update(); identity before.
  const Pose& T_world_base() const { return robot_.T_world_base(); }
  /// Returns the pose of the first hand's palm as of the last observe(), scene() or obstacles();
  /// identity before the robot is known.
  const Pose& T_world_tool() const { return robot_.hands().front().T_world_palm; }
  /// The box around everything the robot can reach: what must be covered for "nobody" to be a fact.
  Coverage reach() const { return robot_.reach(); }
  /// What hides people from a source: the robot as it stands and the fixed boxes.
  const Obstacles& obstacles();

 private:
  Rank rank(const SceneObject& object) const;
  void shorten(std::vector<ObservedObject>& seen);
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
  std::deque<std::string> wanted_;
  LeftOut objects_left_out_, boxes_left_out_;
  std::uint64_t forgotten_{0};
};

}  // namespace handsel::spark
