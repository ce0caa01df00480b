// Detects that a person offers an object, with hysteresis. Pure.
#pragma once

#include <optional>
#include <string>

#include "components/manipulation_planner/snapshot.hpp"

namespace handsel::manipulation_planner {

/// An object and the person that offers it.
struct Offer {
  std::string object;  ///< scene object id
  std::string giver;   ///< person id
  bool operator==(const Offer&) const = default;
};

/// Bounds of an offer.
struct OfferBounds {
  double min_distance{};  ///< level distance of an offered object from the torso, at least [m]
  double max_speed{};     ///< of an offered object [m/s]
};

class OfferDetector {
 public:
  /// `now` must outlive what is made.
  OfferDetector(const Snapshot& now, const OfferBounds& bounds) : now_(now), bounds_(bounds) {}

  /// Sets which object was asked for, and from whom; empty: any. Their offers are recognised by
  /// weaker signs.
  void set_asked(const Offer& asked) { asked_ = asked; }
  /// Returns the object that was asked for; empty: any.
  const std::string& asked_object() const { return asked_.object; }
  /// Sets whether nothing was offered for so long that an object before the body counts as offered.
  void set_waited_long(bool waited_long) { waited_long_ = waited_long; }
  /// Returns whether set_waited_long() is in force.
  bool waited_long() const { return waited_long_; }

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
  /// Observes, each step, whether the accepted offer holds.
  void update(const Vector3& p_hand);
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
  double min_distance(const Person& person, const SceneObject& object, bool is_fact) const;

  const Snapshot& now_;
  OfferBounds bounds_;
  Offer asked_, accepted_;
  bool waited_long_{};
  bool hand_at_offer_{};
  TimePoint offered_at_{};
};

}  // namespace handsel::manipulation_planner
