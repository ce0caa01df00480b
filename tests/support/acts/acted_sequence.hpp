// SPDX-License-Identifier: Apache-2.0
// Labelled sequences of people with an object in front of a robot: the simulator's giver, a
// scripted person, and a recorded handover. Pure, seeded.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/messages/perception.hpp"
#include "common/model/object_model.hpp"
#include "tests/support/acts/acted_person.hpp"

namespace handsel::test {

struct RecordedHandover;

/// Distance of the middle of a held object in front of the hand, as in the simulator [m].
constexpr double kHeldInFront = 0.08;
/// Min outward distance of an offer from the place where the object was kept [m].
constexpr double kMinOutward = 0.07;

/// The robot in front of the people, world frame.
struct ActStage {
  Vector3 p_robot{Vector3::Zero()};    ///< base of the robot [m]
  Vector3 p_hand{Vector3::Zero()};     ///< hand of the robot [m]
  const ObjectModel* object{nullptr};  ///< model of the object
};

/// A box on which objects stand.
struct Counter {
  Vector3 centre{Vector3::Zero()};  ///< world [m]
  Vector3 size{Vector3::Zero()};    ///< full extents [m]
};

/// Definition of an offer in a sequence.
struct OfferLabel {
  double max_speed{0.02};    ///< of the object at the begin of an offer [m/s]
  double min_duration{0.5};  ///< [s]
};

/// A sequence with its ground truth. The object is "thing", its first holder "anna".
class ActedSequence {
 public:
  virtual ~ActedSequence() = default;
  /// Advances by `dt` [s].
  virtual void step(double dt) = 0;
  /// Returns the duration [s].
  virtual double duration() const = 0;
  /// Returns the people as they are, without velocities.
  virtual std::vector<const Person*> people() const = 0;
  /// Returns the pose of the object, world.
  virtual Pose T_world_object() const = 0;
  /// Returns the holder's activity.
  virtual Act act() const = 0;
  /// Returns whether the object is offered to the robot, relative to the body of its holder.
  bool is_offer() const { return act() == Act::offers; }
  /// Returns whether an offer is indistinguishable from keeping the object, because the robot's
  /// hand is so near.
  virtual bool is_unclear() const { return false; }
  /// Returns the definition of an offer in this sequence.
  virtual OfferLabel label() const { return {}; }
  /// Returns the forces at the sensors of the object; empty: it has none.
  virtual std::vector<ObservedGrip> grips() const { return {}; }
};

/// Where the robot is in the recorded handover.
enum class RecordedView {
  giver,        ///< in place of the omitted taker, facing the giver
  giver_waits,  ///< the same; the giver stops where the offer begins
  taker,        ///< in place of the giver, facing the taker, who puts the object down
  aside,        ///< beside both people
};

/// Returns the counter of the scripted sequence with this `seed`.
Counter counter_of(std::uint64_t seed);
/// Returns a person that acts by a random script: offers among everything else.
std::unique_ptr<ActedSequence> scripted_sequence(const ActStage& stage, std::uint64_t seed);
/// Returns the recorded handover, which must outlive the sequence. The giver is "anna", the taker
/// "ben". An offer begins where the object is slower than a third of the max speed of the reach,
/// and ends as the giver releases the object.
std::unique_ptr<ActedSequence> recorded_sequence(const RecordedHandover& recording,
                                                 RecordedView view);
/// Returns the simulator's giver, varied as in the scenario trial_receive.
std::unique_ptr<ActedSequence> simulated_sequence(const ActStage& stage, std::uint64_t seed);

}  // namespace handsel::test
