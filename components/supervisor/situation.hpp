// What the supervisor knows now: facts, scene, the running action. Pure.
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

  void on(const Facts& facts, TimePoint now);
  void on(const Scene& scene, TimePoint now);
  void on(const ActionStatus& status);
  /// Of the arm, world [m].
  void set_shoulder(const Vector3& shoulder);
  void set_other_arms(const std::vector<Ability::Arm>& arms) { ability_.other_arms = arms; }

  bool known() const { return facts_.has_value() && scene_.has_value(); }
  double known_for(TimePoint now) const { return known() ? to_seconds(now - known_since_) : 0.0; }  ///< [s]
  /// Only when known().
  World& world();
  const Scene& scene() const { return *scene_; }
  const std::optional<ActionStatus>& action() const { return action_; }
  bool met(const std::string& person) const { return met_.contains(person); }  ///< was seen some time

  std::string held();                                 ///< what the robot holds; empty: nothing
  std::string surface_of(const std::string& object);  ///< empty: it stands on none
  /// What became of an object, one phrase for people; empty: nothing that is known.
  std::string fate_of(const std::string& object);

 private:
  Ability ability_;
  std::optional<Facts> facts_;
  std::optional<Scene> scene_;
  std::optional<ActionStatus> action_;
  std::optional<World> world_;
  TimePoint known_since_{};
  std::set<std::string> met_;
};

}  // namespace handsel::supervisor
