// What the page shows, gathered from the newest samples: one JSON object (web/page.js reads it). Pure.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/robot.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"
#include "common/model/robot_model.hpp"

namespace handsel::bridge {

class View {
 public:
  explicit View(std::shared_ptr<const RobotModel> robot);

  void take(const RobotState&, TimePoint);
  void take(const Scene&, TimePoint);
  void take(const HumanState&, TimePoint);
  void take(const Facts&, TimePoint);
  void take(const TaskStatus&, TimePoint);
  void take(const ActionStatus&, TimePoint);
  void take(const ExecutionStatus&, TimePoint);
  void take(const ActiveTrajectory&, TimePoint);
  void take(const TrajectoryForecast&, TimePoint);
  void take(const AttentionState&, TimePoint);
  void take(const AttentionAdvice&, TimePoint);
  void take(const ComponentHealth&, TimePoint);

  /// One line. Positions in world [m]; ages and times [s]; null for what is not known.
  std::string json(TimePoint now);

 private:
  template <class M>
  struct Newest {
    bool ever{false};
    M sample{};
    TimePoint at{};
  };

  std::shared_ptr<const RobotModel> robot_;
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_;
  Newest<RobotState> state_;
  Newest<Scene> scene_;
  Newest<HumanState> people_;
  Newest<Facts> facts_;
  Newest<TaskStatus> task_;
  Newest<ActionStatus> action_;
  Newest<ExecutionStatus> execution_;
  Newest<ActiveTrajectory> active_;
  Newest<TrajectoryForecast> forecast_;
  Newest<AttentionState> attention_;
  Newest<AttentionAdvice> advice_;
  std::map<std::string, Newest<ComponentHealth>> health_;
  std::uint64_t path_of_{0};   ///< trajectory the path belongs to
  std::vector<Vector3> path_;  ///< of the tool, world [m]
};

}  // namespace handsel::bridge
