// SPDX-License-Identifier: Apache-2.0
// Robot, people and objects as the well-known types that any 3-D panel draws, published beside the
// raw samples. Pure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/messages/robot.hpp"
#include "common/messages/world.hpp"
#include "common/model/object_model.hpp"
#include "common/model/robot_model.hpp"
#include "components/bridge/foxglove.hpp"

namespace handsel::bridge {

class Drawing {
 public:
  using Objects = std::function<const ObjectModel*(const std::string& model)>;
  Drawing(std::shared_ptr<const RobotModel> robot, Objects objects);

  /// Keeps the robot's newest state; the robot counts as not known while it has another number of
  /// positions than the model has axes, or one that is not finite.
  void take(const RobotState& state) { state_ = state; }
  /// Keeps the newest people, world frame.
  void take(const HumanState& people) { people_ = people; }
  /// Keeps the newest objects and furniture, world frame.
  void take(const Scene& scene) { scene_ = scene; }

  /// foxglove.FrameTransforms: "world" to the robot's root link, and every link below its parent;
  /// empty until the robot is known.
  std::string transforms(Stamp now) const;
  /// foxglove.SceneUpdate: robot (in its links' frames), people, objects and furniture. Each entity
  /// fades after a second without news.
  std::string scene(Stamp now) const;

  /// The two channels, in the order transforms, scene.
  static std::vector<Channel> channels();

 private:
  bool robot_known() const;

  std::shared_ptr<const RobotModel> robot_;
  Objects objects_;
  RobotState state_;
  HumanState people_;
  Scene scene_;
};

}  // namespace handsel::bridge
