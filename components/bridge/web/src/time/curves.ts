// SPDX-License-Identifier: Apache-2.0
// Numbers over time for the plots: position, velocity, acceleration, jerk and effort of each axis
// as fractions of their limits, and the separation. Pure: times are arguments.
import { AxisLimits } from "../config";
import { TopicName } from "../messages";
import { Source } from "../source";

const kNobody = 1e8;   // larger distances mean that no person is present [m]
const kSpacing = 90;   // min time between two points [ms]

export interface Curve { id: string; label: string; unit: string; lines: string[]; limits: number[]; points: number[][] }

export class Curves {
  readonly times: number[] = [];  // [s] system clock, as the plots want it
  readonly curves: Curve[];
  private before: { time: number; acceleration: number[] } | undefined;
  private readonly axes: number[];

  // `arm`: indices of the axes shown; `names` and `limits` are of all axes.
  constructor(arm: number[], names: string[], private readonly limits: AxisLimits[], private readonly maxAge: number) {
    this.axes = arm;
    const lines = arm.map((axis) => names[axis]);
    const ratio = (id: string, label: string): Curve => ({ id, label, unit: "of the limit", lines, limits: [-1, 1], points: lines.map(() => []) });
    this.curves = [ratio("position", "position"), ratio("velocity", "velocity"), ratio("acceleration", "acceleration"), ratio("jerk", "jerk, mean between samples"),
      { id: "force", label: "force of the hand on the load, toward the person", unit: "N", lines: ["pull"], limits: [], points: [[]] },
      { id: "separation", label: "separation and its limit", unit: "m", lines: ["separation", "limit"], limits: [], points: [[], []] }];
  }

  // Takes the newest samples when one of the trajectory has come.
  take(topic: TopicName, source: Source, time: number): void {
    if (topic !== "handsel/active_trajectory") return;
    const active = source.newest(topic), execution = source.newest("handsel/execution_status");
    const last = this.times[this.times.length - 1] ?? -Infinity;
    if (!active || time / 1000 - last < kSpacing / 1000) return;
    const acceleration = this.axes.map((axis) => active.acceleration[axis] ?? NaN);
    const step = this.before ? (time - this.before.time) / 1000 : NaN;
    const push = (curve: number, line: number, value: number): void => void this.curves[curve].points[line].push(value);
    this.times.push(time / 1000);
    this.axes.forEach((axis, i) => {
      const { lower, upper, velocity, acceleration: a, jerk } = this.limits[axis];
      push(0, i, (2 * active.position[axis] - upper - lower) / (upper - lower));
      push(1, i, active.velocity[axis] / velocity);
      push(2, i, acceleration[i] / a);
      push(3, i, (acceleration[i] - (this.before?.acceleration[i] ?? NaN)) / step / jerk);
    });
    push(4, 0, execution?.pull ?? NaN);
    const known = execution !== undefined && execution.separation < kNobody;
    push(5, 0, known ? execution.separation : NaN);
    push(5, 1, known ? execution.separation_limit : NaN);
    this.before = { time, acceleration };
    let old = 0;
    while (this.times[old] * 1000 < time - this.maxAge) ++old;
    if (old < 100) return;
    this.times.splice(0, old);
    for (const { points } of this.curves) for (const line of points) line.splice(0, old);
  }

  // Returns times and lines of a curve within a stretch of time [s].
  between(curve: Curve, from: number, to: number): [number[], ...number[][]] {
    const first = this.times.findIndex((time) => time >= from), begin = first < 0 ? this.times.length : first;
    let end = this.times.length;
    while (end > begin && this.times[end - 1] > to) --end;
    return [this.times.slice(begin, end), ...curve.points.map((line) => line.slice(begin, end))];
  }
}
