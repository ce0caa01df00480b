// What stands where and who holds it: objects from observations, fixed boxes from the place, the
// robot's own configuration. Pure.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/collision/collision_world.hpp"
#include "common/config/schema/spark.pb.h"
#include "common/messages/robot.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"
#include "common/model/robot_model.hpp"
#include "components/spark/quotas.hpp"
#include "components/spark/sources.hpp"

namespace handsel::spark {

/// Where a robot at `base` could reach, and some more: the room in which people must be watched
/// [m].
Coverage reach_of(const RobotModel& robot, const Vector3& base);

/// An object stays when nobody sees it: `uncertainty` grows from then on, faster where somebody's
/// hand could reach it, until it is seen again. In a hand out of sight it moves with the hand, and
/// leaves with the person. Of several sources that see it one is believed as long as it reports;
/// what another reports makes the place more uncertain when it differs. Two things of a kind that
/// change places faster than anybody could have carried them have changed names. An object nobody
/// has described enters as its primitive. Own method: an object out of sight may have been moved.
class SceneModel {
 public:
  SceneModel(const config::SparkSettings& settings, std::shared_ptr<const RobotModel> robot, ObjectLibrary objects,
             std::vector<SceneBox> boxes);

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
  void update(const RobotState& state);
  /// Decides who holds what from geometry, the hand's load and the people's hands.
  Scene scene(TimePoint now, const HumanState& people);

  /// Returns whether update() was called.
  bool robot_known() const { return robot_known_; }
  /// Returns the base pose of the last update(); identity before.
  const Pose& T_world_base() const { return T_world_base_; }
  /// Returns the pose of the first hand's palm as of the last observe(), scene() or obstacles();
  /// identity before the robot is known.
  const Pose& T_world_tool() const { return hands_.front().T_world_palm; }
  /// The box around everything the robot can reach: what must be covered for "nobody" to be a fact.
  Coverage reach() const;
  /// What hides people from a source: the robot as it stands and the fixed boxes.
  const Obstacles& obstacles();

 private:
  struct Known {
    SceneObject object;
    std::size_t by{};                      ///< the robot's hand it is with, or was last
    Pose T_palm_object{Pose::Identity()};  ///< of that hand
    TimePoint seen{};
    int looks{};  ///< that make up the estimate
    Vector3 last_seen_at{Vector3::Zero()};
    std::vector<ObservedGrip> grips;
    std::string source;  ///< that is believed
    double spread{};     ///< how far from there another sees it [m]
    TimePoint spread_until{};
    double jump{};  ///< faster than anybody carries [m]
    TimePoint jump_until{};
    int hand{};                              ///< joint of the person who holds it
    Vector3 p_hand_object{Vector3::Zero()};  ///< from there, world axes [m]
    std::optional<TimePoint> gripped;        ///< the sample p_hand_object is of
    double wandered{};                       ///< how far it may have gone since it was seen [m]
    TimePoint judged{};                      ///< when that was
  };
  /// A hand of the robot.
  struct Hand {
    std::string name;  ///< as SceneObject::holder_id has it: empty for the first
    int palm{-1};      ///< link
    double payload{};  ///< felt [kg]
    Pose T_world_palm{Pose::Identity()};
  };
  void locate_hands();
  Rank rank(const SceneObject& object) const;
  void shorten(std::vector<ObservedObject>& seen);
  void forget_least_relevant();
  std::string left_out_in_reach() const;
  /// Of the hands that feel it together, the one that has it: whoever had it, while it feels some
  /// of the load; else who feels most of it.
  std::optional<std::size_t> loaded_hand(const Known& known) const;
  void follow(Known& known, const ObservedObject& observed, TimePoint seen) const;
  bool known_shape(ObservedObject& observed) const;
  void unswap(std::vector<ObservedObject>& seen, TimePoint at) const;
  bool believes(Known& known, const ObservedObject& observed, const std::string& source, TimePoint seen) const;
  void mislay(Known& known, const HumanState& people, TimePoint now) const;
  /// Whether it is out of sight in somebody's hand, and moves with it.
  bool carry(Known& known, const HumanState& people) const;
  void attribute_grips(Known& known, const HumanState& people) const;
  void assign_holder(Known& known, const HumanState& people) const;
  bool keep_gripped(SceneObject& object) const;
  /// The box it stands on, its bottom no more than `gap` [m] from the top.
  const SceneBox* support_under(const SceneObject& object, double gap) const;

  config::SparkSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  ObjectLibrary library_;
  std::vector<SceneBox> boxes_;
  std::map<std::string, Known> objects_;
  bool robot_known_{false};
  Vector position_;
  std::vector<Hand> hands_;  ///< never empty; the first is that of the tool link
  Pose T_world_base_{Pose::Identity()};
  double arm_length_{1.0};
  std::vector<Pose> links_;
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
