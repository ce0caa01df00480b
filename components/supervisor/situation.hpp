// SPDX-License-Identifier: Apache-2.0
// The present knowledge of the supervisor: facts, scene, the running action. Pure.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "common/base/time.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "components/supervisor/world.hpp"

namespace handsel::supervisor {

class Situation {
 public:
  explicit Situation(Ability ability) : ability_(std::move(ability)) {}

  /// Replaces the facts and stores their people for met(). `now`: time of arrival.
  void on(const Facts& facts, TimePoint now);
  /// Replaces the scene. `now`: time of arrival.
  void on(const Scene& scene, TimePoint now);
  /// Replaces the people, whose positions matter for a mobile robot.
  void on(const HumanState& people) {
    if (!ability_.drives) return;
    people_ = people;
    world_.reset();
  }
  /// Replaces the status of the running action; the held object enters world() immediately.
  void on(const ActionStatus& status);
  /// Sets the arms of the robot, whose reach applies from then on.
  void set_arms(std::vector<Ability::Arm> arms) { ability_.arms = std::move(arms); }

  /// Returns whether facts and scene have both arrived.
  bool known() const { return facts_.has_value() && scene_.has_value(); }
  /// Returns the time for which known() has been true [s]; 0 while false.
  double known_for(TimePoint now) const { return known() ? to_seconds(now - known_since_) : 0.0; }
  /// Only when known().
  World& world();
  /// Returns the newest scene; valid only if known().
  const Scene& scene() const { return *scene_; }
  /// Returns the newest status of an action; nullopt before the first.
  const std::optional<ActionStatus>& action() const { return action_; }
  /// Returns whether a fact about this person has arrived since the start (at most 1024 people).
  bool met(const std::string& person) const { return met_.contains(person); }

  std::string held();                                 ///< Returns the held object; empty: none.
  std::string surface_of(const std::string& object);  ///< Returns its surface; empty: none.
  /// Returns the person that has the object; empty: nobody, or an unknown object.
  std::string person_with(const std::string& object);
  /// Returns what happened to an object as one phrase; empty: unknown.
  std::string fate_of(const std::string& object);

 private:
  Ability ability_;
  std::optional<Facts> facts_;
  std::optional<Scene> scene_;
  HumanState people_;
  std::optional<ActionStatus> action_;
  std::optional<World> world_;
  TimePoint known_since_{};
  std::set<std::string> met_;
};

}  // namespace handsel::supervisor
