// SPDX-License-Identifier: Apache-2.0
// Positions along a jerk-limited trajectory: each axis is a series of cubic segments.
import { AxisTrajectory } from "./messages";

// Returns the total time [s].
export function duration(axis: AxisTrajectory): number {
  return axis.segments.reduce((sum, segment) => sum + segment.duration, 0);
}

// Returns the positions at `count` + 1 equal time steps from start to end.
export function sample(axis: AxisTrajectory, count: number): number[] {
  const total = duration(axis), out: number[] = [];
  let p = axis.start_position, v = axis.start_velocity, a = axis.start_acceleration, begin = 0, k = 0;
  for (let i = 0; i <= count; ++i) {
    const t = (total * i) / count;
    for (; k < axis.segments.length && begin + axis.segments[k].duration <= t; ++k) {
      const { duration: h, jerk } = axis.segments[k];
      p += h * (v + h * (a / 2 + (h * jerk) / 6));
      v += h * (a + (h * jerk) / 2);
      a += h * jerk;
      begin += h;
    }
    const s = t - begin, jerk = k < axis.segments.length ? axis.segments[k].jerk : 0;
    out.push(k < axis.segments.length ? p + s * (v + s * (a / 2 + (s * jerk) / 6)) : p);
  }
  return out;
}
