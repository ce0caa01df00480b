// SPDX-License-Identifier: Apache-2.0
// Samples over time with what happened and the curves made of them: of the live connection or of a
// recording.
import { Config } from "../config";
import { Decoder } from "../decoder";
import { TopicName } from "../messages";
import { Source } from "../source";
import { Curves } from "./curves";
import { Events } from "./events";
import { History } from "./history";

// Min time between two samples kept of a topic whose samples are large [ms].
const kSpacing: Partial<Record<TopicName, number>> = {
  "handsel/human_state": 95, "handsel/active_trajectory": 95, "handsel/grasp_candidates": 450, "handsel/costmap": 950,
};

export class Tape {
  readonly history: History;
  readonly events = new Events();
  readonly curves: Curves;
  private readonly kept = new Map<string, number>();  // stamp of the last sample by topic and key

  // `maxAge` [ms], `maxBytes`: of the samples kept.
  constructor(config: Config, private readonly maxAge: number, maxBytes: number) {
    const arm = (config.groups.arm ?? config.axes).map((name) => config.axes.indexOf(name));
    this.history = new History(maxAge, maxBytes);
    this.curves = new Curves(arm, config.axes, config.limits, maxAge);
  }

  get begin(): number {
    return Math.max(this.history.begin, this.history.end - this.maxAge);
  }
  get end(): number {
    return this.history.end;
  }

  // Takes a sample; `live` has it as its newest, without it the samples kept do. Stamp [ns].
  take(topic: TopicName, key: string, stamp: bigint, bytes: DataView, decoder: Decoder, live?: Source): void {
    const time = Number(stamp) / 1e6, instance = `${topic} ${key}`;
    const due = time - (this.kept.get(instance) ?? -Infinity) >= (kSpacing[topic] ?? 0);
    if (due) {
      this.kept.set(instance, time);
      this.history.add(topic, key, time, bytes, decoder);
    }
    const source = live ?? this.history.at(time);
    this.events.take(topic, source, time);
    this.curves.take(topic, source, time);
  }
}
