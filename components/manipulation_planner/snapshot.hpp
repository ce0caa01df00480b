// SPDX-License-Identifier: Apache-2.0
// The newest state of the world, as the messages that came in report it. Pure.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/collision/collision_world.hpp"
#include "common/cost/cost_layers.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/holding_hand_average.hpp"
#include "common/model/object_model.hpp"
#include "common/model/platform.hpp"

namespace handsel::manipulation_planner {

/// Newest scene, people, facts, cost layers and state of the controller.
class Snapshot {
 public:
  /// `objects`: the models of the objects that scenes name. `robot`: nullptr: it stands at its
  /// root. `holding_samples`: over which hands are averaged on the objects in them.
  explicit Snapshot(ObjectLibrary objects, std::shared_ptr<const RobotModel> robot = nullptr,
                    int holding_samples = 1)
      : robot_(std::move(robot)),
        objects_(std::move(objects)),
        holding_(objects_, holding_samples) {}

  /// Takes the newest scene; objects, boxes and base of the robot in the world frame.
  void on(const Scene& scene) {
    scene_ = scene;
    ++scene_count_;
  }
  /// Takes the newest people, joints in the world frame.
  void on(const HumanState& people) {
    people_ = people;
    holding_.add(scene_, people);
  }
  /// Takes the facts that hold now; they replace all before.
  void on(const Facts& facts) { facts_ = facts; }
  /// Takes a cost layer; `sent`: when its writer sent the layer.
  void on(const Costmap& layer, TimePoint sent, TimePoint now) { layers_.put(layer, sent, now); }
  /// Takes the newest report of the controller.
  void on(const ExecutionStatus& status) { execution_ = status; }
  /// Takes what the controller runs, and its set-point.
  void on(const ActiveTrajectory& active) { active_ = active; }

  /// Sets the time of the step that runs.
  void set_time(TimePoint now) { time_ = now; }
  /// Returns the time of the step that runs.
  TimePoint time() const { return time_; }
  /// Returns the newest scene.
  const Scene& scene() const { return scene_; }
  /// Returns how many scenes have come.
  std::uint64_t scene_count() const { return scene_count_; }
  /// Returns the pose of the root of the robot's model in the world.
  const Pose& T_world_base() const { return scene_.T_world_base; }
  /// Returns where the robot stands in the world: its platform, or its root.
  friend Pose T_world_platform(const Snapshot& now) {
    return now.robot_ ? T_world_platform(*now.robot_, now.scene_) : now.scene_.T_world_base;
  }
  /// Returns the newest people.
  const HumanState& people() const { return people_; }
  /// Returns the newest people, hands averaged on the objects in them.
  HumanState people_averaged() const { return holding_.averaged(scene_, people_); }
  /// Returns the facts that hold.
  const Facts& facts() const { return facts_; }
  /// Returns the newest report of the controller; nullopt: none has come.
  const std::optional<ExecutionStatus>& execution() const { return execution_; }
  /// Returns what the controller runs.
  const ActiveTrajectory& active() const { return active_; }
  /// Returns all axes as commanded [rad, m]; empty: not known yet.
  const Vector& set_point() const { return active_.position; }
  /// Returns the cost layers that are not stale now.
  LayersNow layers() { return layers_.at(time_); }
  /// Returns which cost layer was left out and why, one sentence; empty: none was.
  std::string complaint(TimePoint now) { return layers_.complaint(now); }

  /// Returns the object of that id; null: it is not in the scene.
  const SceneObject* object(const std::string& id) const;
  /// Returns the box of that id on which things can stand; null: there is none.
  const SceneBox* surface(const std::string& id) const;
  /// Returns the model of an object of the scene; null: unknown.
  const ObjectModel* model_of(const std::string& id) const;
  /// Returns the models of objects.
  const ObjectLibrary& objects() const { return objects_; }
  /// Returns the person of that id, for an empty id the one nearest to the base; null: none.
  const Person* person(const std::string& id) const;

 private:
  TimePoint time_{};
  std::shared_ptr<const RobotModel> robot_;
  ObjectLibrary objects_;
  Scene scene_;
  std::uint64_t scene_count_{};
  HumanState people_;
  HoldingHandAverage holding_;
  Facts facts_;
  CostLayers layers_;
  std::optional<ExecutionStatus> execution_;
  ActiveTrajectory active_;
};

/// Returns whether this person is out of sight and may be near their last place.
bool is_lost(const Snapshot& now, const std::string& id);

}  // namespace handsel::manipulation_planner
