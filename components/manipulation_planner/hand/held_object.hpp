// SPDX-License-Identifier: Apache-2.0
// What the hand in use holds, as it was taken, and whether it still does. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/manipulation_planner.hpp"
#include "common/messages/planning.hpp"
#include "components/manipulation_planner/active_arm.hpp"

namespace handsel::manipulation_planner {

class HeldObject {
 public:
  /// The references must outlive what is made.
  HeldObject(const ActiveArm& arm, const Snapshot& now,
             const settings::ManipulationPlannerSettings& settings)
      : arm_(arm), now_(now), settings_(settings) {}

  /// Notes that the hand holds the object where the scene has it.
  void hold(const SceneObject& object);
  /// Notes that no hand holds anything.
  void release() {
    attachment_ = {};
    vain_offers_.clear();
    is_in_both_hands_ = false;
  }
  /// Notes that a further hand holds the object, too, until release().
  void join() { is_in_both_hands_ = true; }
  /// Returns whether two hands hold the object together.
  bool is_in_both_hands() const { return is_in_both_hands_; }
  /// Returns whether something is held.
  bool is_holding() const { return !attachment_.object.empty(); }
  /// Returns what is held and how; `object` empty: nothing.
  const Attachment& attachment() const { return attachment_; }
  /// Returns the scene object id of what is held; empty: nothing.
  const std::string& id() const { return attachment_.object; }
  /// Returns where the hand has what it holds, in the world.
  Pose T_world_object() const { return arm_.T_world_tool() * attachment_.T_tool_object; }

  /// Sets the grasp by which the hand in use takes things; nullopt: unknown.
  void set_grasp(std::optional<Grasp> grasp) { grasp_ = std::move(grasp); }
  /// Returns the grasp of the hand in use; nullopt: unknown.
  const std::optional<Grasp>& grasp() const { return grasp_; }

  /// Notes that nobody took what is held where it is now.
  void note_vain_offer() { vain_offers_.push_back(T_world_object()); }
  /// Returns the poses in the world in which what is held was offered in vain.
  const std::vector<Pose>& vain_offers() const { return vain_offers_; }

  /// Returns whether `object` is what is held and its position within max_slip of its place in the
  /// hand.
  bool is_in_hand(const SceneObject& object) const;
  /// Returns whether the scene has the object in the hand in use.
  bool is_held_by_hand(const std::string& object) const;
  /// Returns whether a hand of the person is within taken_range of the object's surface, or without
  /// a model within person_hand_range of its origin; false if either is unknown.
  bool is_at_hand_of(const std::string& person, const std::string& object) const;
  /// Returns whether a hand of the person is at what is held; false for an empty `person` and while
  /// a surface holds the object.
  bool is_taken_by(const std::string& person) const;

  /// Observes, each step, whether what is held is still in the hand.
  void update(TimePoint now);
  /// Returns whether update() has found the held object outside the hand and near no person's hand
  /// for longer than slip_time. What the scene lacks or has in any hand counts as in the hand.
  bool has_slipped(TimePoint now) const;

 private:
  bool is_out_of_hand() const;

  const ActiveArm& arm_;
  const Snapshot& now_;
  const settings::ManipulationPlannerSettings& settings_;
  Attachment attachment_;
  bool is_in_both_hands_{};
  std::optional<Grasp> grasp_;
  std::vector<Pose> vain_offers_;
  TimePoint seen_in_hand_{};
};

}  // namespace handsel::manipulation_planner
