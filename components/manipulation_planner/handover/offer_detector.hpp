// SPDX-License-Identifier: Apache-2.0
// Detects that a person offers an object, with hysteresis. Pure.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>

#include "common/config/settings/manipulation_planner.hpp"
#include "components/manipulation_planner/handover/object_trail.hpp"
#include "components/manipulation_planner/snapshot.hpp"

namespace handsel::manipulation_planner {

/// An object and the person that offers it.
struct Offer {
  std::string object;  ///< scene object id
  std::string giver;   ///< person id
  bool operator==(const Offer&) const = default;
};

/// Finds what people offer to the robot by the extension of their arm, the direction, the rest
/// of the object and what happens around (settings `offer_*`). Extension: level distance of the
/// object from the shoulder of the hand that holds the object, over the stature of its holder. Own
/// method.
class OfferDetector {
 public:
  /// `now` and `settings` must outlive what is made.
  OfferDetector(const Snapshot& now, const settings::ManipulationPlannerSettings& settings)
      : now_(now), settings_(settings) {}

  /// Sets which object was asked for, and from whom; empty: any. No other offer is awaited.
  void set_asked(const Offer& asked) { asked_ = asked; }
  /// Returns the object that was asked for; empty: any.
  const std::string& asked_object() const { return asked_.object; }

  /// Returns whether the person offers the object, at rest or not. `p_hand`: the robot's hand,
  /// world [m].
  bool is_offered(const Person& person, const SceneObject& object, const Vector3& p_hand) const;
  /// Returns the first offer of an object at rest; `object` or `giver` empty: any.
  std::optional<Offer> find(const std::string& object, const std::string& giver,
                            const Vector3& p_hand) const;

  /// Accepts an offer, which holds from now on until it clearly does not.
  void accept(const Offer& offer);
  /// Forgets the accepted offer.
  void clear() { accepted_ = {}; }
  /// Returns the accepted offer; empty names: none.
  const Offer& accepted() const { return accepted_; }
  /// Returns whether an offer is accepted.
  bool has_accepted() const { return !accepted_.giver.empty(); }
  /// Begins to wait for an offer: none is accepted, and none has been seen.
  void await();
  /// Observes, each step, whether the accepted offer holds or, with none accepted, who offers what
  /// was asked for. `p_hand`: the robot's hand, world [m].
  void update(const Vector3& p_hand);
  /// Returns the offer that has been at rest for long enough, as of the last update().
  std::optional<Offer> made() const;
  /// Returns whether an offer was seen at the last update(), at rest or not.
  bool is_seen() const { return seen_.has_value(); }
  /// Returns whether the accepted offer holds, or held so recently that noise may hide it.
  bool is_still_offered() const;
  /// Returns whether the accepted offer has not held for so long that it was withdrawn.
  bool is_withdrawn() const;
  /// Returns whether the giver moves the accepted object, or steps, into the robot's hand.
  bool is_giver_approaching(const Vector3& p_hand) const;

  /// Sets whether the hand is at the offered object: from the straight approach to the end of the
  /// retreat.
  void set_hand_at_offer(bool at_offer) { hand_at_offer_ = at_offer; }
  /// Returns whether hand and giver meet: the giver offers, or the hand is at the object.
  bool is_engaged() const { return hand_at_offer_ || is_still_offered(); }

 private:
  struct FollowedObject {
    explicit FollowedObject(const settings::ManipulationPlannerSettings& settings)
        : trail(settings) {}
    ObjectTrail trail;
    std::string holder;                                             // person or robot; or empty
    double min_extension{std::numeric_limits<double>::infinity()};  // while this person holds it
  };
  double min_extension(const Person& person, const SceneObject& object,
                       const Vector3& p_hand) const;
  bool is_extended_at_rest(const Person& person, const SceneObject& object) const;
  void follow_objects();
  void follow_extension();
  std::optional<Offer> find(const std::string& object, const std::string& giver,
                            const Vector3& p_hand, double max_speed) const;
  bool is_for_robot(const Person& person, const Vector3& p_shoulder, const Vector3& p_object,
                    const Vector3& p_hand) const;

  const Snapshot& now_;
  const settings::ManipulationPlannerSettings& settings_;
  Offer asked_, accepted_;
  bool hand_at_offer_{};
  double mean_extension_{}, max_extension_{};  // of the accepted offer, since it was accepted
  TimePoint offered_at_{};
  std::optional<Offer> seen_;  // at rest or not, not accepted yet
  TimePoint seen_since_{};
  std::map<std::string, FollowedObject> followed_;  // by id
  std::uint64_t scenes_followed_{};                 // from which these were updated
};

}  // namespace handsel::manipulation_planner
