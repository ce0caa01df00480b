// SPDX-License-Identifier: Apache-2.0
// The fields of messages that the page uses (units: idl/). The wire's schema defines the content of
// a sample.
export interface Vector3 { x: number; y: number; z: number }
export interface Quaternion extends Vector3 { w: number }
export interface Pose { position: Vector3; orientation: Quaternion }

export interface RobotState { robot: string; stamp: bigint; T_world_base: Pose; position: ArrayLike<number>; mode: number }

export enum PrimitiveKind { none, box, cylinder, sphere }
export interface Primitive { kind: PrimitiveKind; size: Vector3 }
export interface SceneObject {
  id: string;
  model: string;
  T_world_object: Pose;
  holder: number;
  age: number;
  primitive: Primitive;
  uncertainty: number;
}
export interface SceneBox { id: string; T_world_box: Pose; size: Vector3 }
export interface Scene { objects: SceneObject[]; boxes: SceneBox[] }

export interface Person {
  id: string;
  joints: { name: string; position: Vector3 }[];
  stature: number;
  gaze_known: boolean;
  gaze_origin: Vector3;
  gaze_direction: Vector3;
  age: number;
  inflation: number;
  hands: { joint: string; ahead: { time: number; position: Vector3; uncertainty: number }[] }[];
}
export interface OtherRobot { name: string; parts: { a: Vector3; b: Vector3; radius: number }[]; age: number }
export interface HumanState { people: Person[]; covered: boolean; robots: OtherRobot[] }

export interface AxisTrajectory {
  start_position: number;
  start_velocity: number;
  start_acceleration: number;
  segments: { duration: number; jerk: number }[];
}
export interface ActiveTrajectory {
  trajectory: bigint;
  time: number;
  speed_factor: number;
  position: ArrayLike<number>;
  velocity: ArrayLike<number>;
  acceleration: ArrayLike<number>;
  axes: ArrayLike<number>;
  rest: { axes: AxisTrajectory[] };
}
export interface TrajectoryForecast { collides: boolean; time_to_collision: number; clearance: number; reason: string }

export interface ExecutionStatus {
  mode: number;
  causes: number;
  progress: number;
  pull: number;
  reason: string;
  cycles: bigint;
  late_cycles: bigint;
  limit_ratio_velocity: number;
  limit_ratio_acceleration: number;
  limit_ratio_jerk: number;
  separation: number;
  separation_limit: number;
  nearest_on_robot: Vector3;
  nearest_on_person: Vector3;
}

export interface AttentionState {
  behaviours: { name: string; period: number; activations: bigint; activations_at_fastest: bigint; released: boolean; stimulus: number; speed_factor: number; winner: boolean; reason: string }[];
}
export interface AttentionAdvice {
  speed_factor: number;
  limiting: string;
  reason: string;
  people_period: number;
  objects_period: number;
  forecast_period: number;
  cost_map_period: number;
  replan_period: number;
}

export interface PlanStep { text: string; depth: number; state: number; reason: string }
export interface TaskStatus { id: bigint; kind: number; state: number; plan: string[]; step: number; reason: string; tree: PlanStep[] }
export interface ActionStatus {
  kind: number;
  state: number;
  phase: number;
  object: string;
  human: string;
  holding: boolean;
  exchange_engaged: boolean;
  exchange_point: Vector3;
  has_partner: boolean;
  partner_side: number;
  T_world_partner_wrist: Pose;
  reason: string;
}

export interface ComponentHealth {
  component: string;
  pid: number;  // 0: not running, reported by its launcher
  state: number;
  reason: string;
  cpu: number;
  memory_mb: number;
  uptime: number;
  topics: { rate: number; deadline_misses: bigint; rejected: bigint }[];
  left_out: { name: string; count: bigint }[];
}

export interface Grasp {
  id: bigint;
  T_object_hand: Pose;
  contacts: { position: Vector3; normal: Vector3; friction: number }[];
  partners: { side: number; T_object_wrist: Pose }[];
}
export interface GraspCandidates { object: string; grasps: Grasp[] }

export interface Costmap {
  layer: string;
  revision: bigint;
  origin: Vector3;
  resolution: number;
  nx: number;
  ny: number;
  nz: number;
  values: ArrayLike<number>;  // cost * 254; 255: forbidden or out of reach
}

export interface SafetyState { paused: boolean; override_factor: number; fault: boolean; awaits_person: boolean; reason: string }

export interface Facts { holding: { kind: number; subject: string; object: string; since: number }[] }

export interface Topics {
  "handsel/robot_state": RobotState;
  "handsel/scene": Scene;
  "handsel/human_state": HumanState;
  "handsel/active_trajectory": ActiveTrajectory;
  "handsel/trajectory_forecast": TrajectoryForecast;
  "handsel/execution_status": ExecutionStatus;
  "handsel/attention_state": AttentionState;
  "handsel/attention_advice": AttentionAdvice;
  "handsel/task_status": TaskStatus;
  "handsel/action_status": ActionStatus;
  "handsel/component_health": ComponentHealth;
  "handsel/facts": Facts;
  "handsel/safety_state": SafetyState;
  "handsel/grasp_candidates": GraspCandidates;
  "handsel/costmap": Costmap;
}
export type TopicName = keyof Topics;
export const kTopics: TopicName[] = [
  "handsel/robot_state", "handsel/scene", "handsel/human_state", "handsel/active_trajectory", "handsel/trajectory_forecast",
  "handsel/execution_status", "handsel/attention_state", "handsel/attention_advice", "handsel/task_status", "handsel/action_status",
  "handsel/component_health", "handsel/facts", "handsel/safety_state",
];
// Large topics, read only while a layer shows them.
export const kLayerTopics: TopicName[] = ["handsel/grasp_candidates", "handsel/costmap"];
// Topics with several instances, whose key is the text with which a sample begins.
const kKeyed: ReadonlySet<TopicName> = new Set(["handsel/component_health", "handsel/grasp_candidates", "handsel/costmap"]);
// Instances of handsel/task_status: of tasks, and of requests such as pause and speed.
export const kOfTasks = "task";
const kOfRequests = "request";
const kKind = 20;                             // offset of the kind of a task status [bytes]
const kFirstRequest = 9, kLastRequest = 14;  // pause and clear_person of TaskKind

// Returns the instance of a topic to which a sample belongs, from its bytes with encapsulation
// header; empty for a topic with one instance.
export function keyOf(topic: TopicName, bytes: DataView): string {
  if (topic === "handsel/task_status" && bytes.byteLength >= kKind + 4) {
    const kind = bytes.getUint32(kKind, true);
    return kind >= kFirstRequest && kind <= kLastRequest ? kOfRequests : kOfTasks;
  }
  if (!kKeyed.has(topic)) return "";
  const length = bytes.byteLength > 8 ? Math.min(bytes.getUint32(4, true), bytes.byteLength - 8) : 0;
  return new TextDecoder().decode(new Uint8Array(bytes.buffer, bytes.byteOffset + 8, Math.max(0, length - 1)));
}
