// SPDX-License-Identifier: Apache-2.0
// Every topic of the system, in one table: code, documentation, permissions, bridge channels and
// tests are made from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace handsel {

/// Names of the QoS profiles; what each means is written in common/bus/qos.
enum class Profile : std::uint8_t {
  sensor,   ///< best effort, keep last 1
  state,    ///< reliable, transient local, keep last 1
  command,  ///< reliable, keep last 8
  /// A command whose last sample a late joiner must know: reliable, transient local, keep last 1.
  latch,
  goal,      ///< reliable, keep last 8, many writers
  advice,    ///< reliable, keep last 1
  setpoint,  ///< best effort, keep last 32: with simulated time several come at once
  request,   ///< reliable, bounded keep all
  reply,     ///< reliable, bounded keep all
  health,    ///< reliable, keep last 1, liveliness lease
};
/// Returns the enumerator as text, as the bridge shows it and documentation names it: "sensor".
const char* name(Profile);

/// One row of the table.
struct TopicRow {
  const char* type;     ///< message struct in common/messages, and IDL struct in module handsel
  const char* topic;    ///< name on the wire
  Profile profile;      ///< QoS of all its writers and readers
  double rate;          ///< nominal [Hz]; 0 = on change or on demand
  double deadline;      ///< longest time between samples [s]; 0 = none
  std::size_t largest;  ///< bound of the serialised sample [bytes]
  const char* writers;  ///< components, separated by spaces
  /// Components, separated by spaces; the bridge reads everything and is not named.
  const char* readers;
};

// type, topic, profile, rate [Hz], deadline [s], largest [bytes], writers, readers
// clang-format off
#define HANDSEL_TOPICS(X) \
  X(RobotState, "robot_state", sensor, 500, 0.02, 5128, "sim driver ros2_lane", \
    "trajectory_controller spark supervisor ros2_lane") \
  X(JointCommand, "joint_command", setpoint, 1000, 0.02, 2560, "trajectory_controller", \
    "sim driver") \
  X(HumanObservation, "human_observation", sensor, 30, 0.2, 1310720, "sim ros2_lane", "spark sim") \
  X(ObjectObservation, "object_observation", sensor, 30, 0.2, 655360, "sim ros2_lane", "spark") \
  X(RobotReport, "robot_report", sensor, 20, 0, 16384, "spark sim driver", "spark") \
  X(Scene, "scene", state, 10, 0.3, 81928, "spark", \
    "costmap collision_checker path_planner grasp_planner trajectory_planner " \
    "manipulation_planner attention supervisor ros2_lane") \
  X(HumanState, "human_state", state, 30, 0.1, 221184, "spark", \
    "costmap collision_checker path_planner grasp_planner trajectory_planner " \
    "manipulation_planner attention trajectory_controller supervisor") \
  X(Facts, "facts", state, 20, 0.3, 98312, "spark", "supervisor attention manipulation_planner") \
  X(Costmap, "costmap", advice, 10, 0, 2097152, "costmap", \
    "collision_checker path_planner trajectory_planner manipulation_planner") \
  X(TaskGoal, "task_goal", goal, 0, 0, 384, "handsel bridge", "supervisor spark") \
  X(TaskStatus, "task_status", state, 0, 0, 167936, "supervisor", "handsel") \
  X(ActionGoal, "action_goal", request, 0, 0, 512, "supervisor", "manipulation_planner") \
  X(ActionStatus, "action_status", state, 10, 0.3, 131072, "manipulation_planner", \
    "supervisor attention trajectory_controller sim ros2_lane") \
  X(Go, "go", latch, 10, 0.3, 512, "supervisor", "trajectory_controller driver") \
  X(SafetyState, "safety_state", latch, 1, 3, 163840, "supervisor", "spark trajectory_controller") \
  X(TrajectoryCommand, "trajectory", command, 0, 0, 5242880, "manipulation_planner ros2_lane", \
    "trajectory_controller") \
  X(HandCommand, "hand_command", command, 0, 0, 1216, "manipulation_planner", \
    "trajectory_controller") \
  X(ExecutionStatus, "execution_status", state, 50, 0.06, 896, "trajectory_controller", \
    "manipulation_planner supervisor ros2_lane") \
  X(ActiveTrajectory, "active_trajectory", advice, 50, 0.06, 5242880, "trajectory_controller", \
    "collision_checker attention manipulation_planner ros2_lane") \
  X(TrajectoryForecast, "trajectory_forecast", advice, 50, 0.1, 512, "collision_checker", \
    "trajectory_controller attention") \
  X(AttentionState, "attention_state", state, 10, 0.3, 4608, "attention", "bridge") \
  X(AttentionAdvice, "attention_advice", advice, 50, 0.06, 704, "attention", \
    "spark costmap collision_checker path_planner trajectory_planner manipulation_planner " \
    "trajectory_controller supervisor") \
  X(SensorRequest, "sensor_request", advice, 10, 0.3, 2048, "attention", "sim ros2_lane") \
  X(PathRequest, "path_request", request, 0, 0, 2686976, "manipulation_planner", "path_planner") \
  X(PathReply, "path_reply", reply, 0, 0, 2621440, "path_planner", "manipulation_planner") \
  X(TrajectoryRequest, "trajectory_request", request, 0, 0, 2621440, \
    "manipulation_planner ros2_lane", "trajectory_planner") \
  X(TrajectoryReply, "trajectory_reply", reply, 0, 0, 5505024, "trajectory_planner", \
    "manipulation_planner ros2_lane") \
  X(GraspRequest, "grasp_request", request, 0, 0, 1024, "manipulation_planner", "grasp_planner") \
  X(GraspReply, "grasp_reply", reply, 0, 0, 1179648, "grasp_planner", "manipulation_planner") \
  X(GraspCandidates, "grasp_candidates", advice, 2, 0, 1179648, "grasp_planner", "bridge") \
  X(RegraspRequest, "regrasp_request", request, 0, 0, 16384, "manipulation_planner", \
    "grasp_planner") \
  X(RegraspReply, "regrasp_reply", reply, 0, 0, 425984, "grasp_planner", "manipulation_planner") \
  X(StateQuery, "state_query", request, 0, 0, 4194304, "handsel ros2_lane", "collision_checker") \
  X(StateVerdict, "state_verdict", reply, 0, 0, 6144, "collision_checker", "handsel ros2_lane") \
  X(ComponentHealth, "component_health", health, 10, 0.3, 65536,\
    "supervisor spark costmap collision_checker path_planner grasp_planner trajectory_planner " \
    "manipulation_planner attention trajectory_controller bridge sim driver ros2_lane", \
    "supervisor handsel") \
  X(SimClock, "sim_clock", advice, 100, 0, 64, "sim", \
    "supervisor spark costmap collision_checker path_planner grasp_planner trajectory_planner " \
    "manipulation_planner attention trajectory_controller bridge driver ros2_lane") \
  X(ClockReached, "clock_reached", advice, 100, 0, 192, \
    "supervisor spark costmap collision_checker path_planner grasp_planner trajectory_planner " \
    "manipulation_planner attention trajectory_controller bridge driver ros2_lane", "sim") \
  X(SimControl, "sim_control", goal, 0, 0, 160, "handsel bridge", "sim") \
  X(StudyMark, "study_mark", goal, 0, 0, 448, "handsel", "bridge") \
  X(GroundTruth, "ground_truth", state, 50, 0.06, 12288, "sim", "handsel")
// clang-format on

#define HANDSEL_ROW(type, topic, ...) struct type;
/// Declares the message struct of every row.
HANDSEL_TOPICS(HANDSEL_ROW)
#undef HANDSEL_ROW

#define HANDSEL_ROW(type, topic, profile, rate, deadline, largest, writers, readers) \
  TopicRow{#type, "handsel/" topic, Profile::profile, rate, deadline, largest, writers, readers},
inline constexpr TopicRow kTopics[] = {HANDSEL_TOPICS(HANDSEL_ROW)};
#undef HANDSEL_ROW

enum class TopicIndex : std::size_t {
#define HANDSEL_ROW(type, topic, ...) type,
  HANDSEL_TOPICS(HANDSEL_ROW)
#undef HANDSEL_ROW
};

/// The row of a message type; only messages of the table have one.
template <class M>
struct TopicOf;
#define HANDSEL_ROW(type, topic, ...)                                                \
  template <>                                                                        \
  struct TopicOf<type> {                                                             \
    static constexpr std::size_t index = static_cast<std::size_t>(TopicIndex::type); \
    static constexpr const TopicRow& row = kTopics[index];                           \
  };
HANDSEL_TOPICS(HANDSEL_ROW)
#undef HANDSEL_ROW

/// Returns all rows, in the order of TopicIndex.
inline std::span<const TopicRow> topics() { return kTopics; }
/// By type ("RobotState") or topic ("handsel/robot_state", "robot_state"); nullptr if there is
/// none.
const TopicRow* find_topic(std::string_view type_or_topic);
/// Has this topic one writer, pinned by identity, whose samples alone are accepted
/// (docs/architecture.md)?
bool has_one_writer(const TopicRow& row);
/// Do all systems of a domain use this topic together, whatever their names?
bool is_of_all_systems(const TopicRow& row);
/// Is `component` one of the names in `list`?
bool named_in(const char* list, std::string_view component);

}  // namespace handsel
