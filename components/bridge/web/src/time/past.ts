// SPDX-License-Identifier: Apache-2.0
// What the time axis runs over: the last ten minutes of the live connection, or an open recording.
import { Config } from "../config";
import { byId } from "../elements";
import { Source } from "../source";
import { Axis } from "./axis";
import { Plots } from "./plots";
import { Tape } from "./tape";

const kKept = 600_000;          // time kept of the live connection [ms]
const kMaxBytes = 160_000_000;  // of its samples

export class Past {
  readonly axis: Axis;
  readonly live: Tape;
  private recording: Tape | undefined;
  private readonly plots: Plots;

  constructor(config: Config, onChange: () => void) {
    this.live = new Tape(config, kKept, kMaxBytes);
    this.plots = new Plots(byId("plots"), byId<HTMLDetailsElement>("plot-card"), () => this.tape.curves);
    this.axis = new Axis(() => this.tape.events, (present) => {
      if (present) this.recording = undefined;
      document.body.classList.toggle("recorded", this.recording !== undefined);
      onChange();
    });
  }

  get tape(): Tape {
    return this.recording ?? this.live;
  }
  // Returns true while the present is shown.
  get present(): boolean {
    return this.axis.at === undefined;
  }

  // Shows a recording from its end backwards, until the viewer returns to the present.
  open(recording: Tape): void {
    this.recording = recording;
    this.axis.show(recording.begin, recording.end);
    this.axis.go(recording.end);
  }

  // Returns where the instant shown is read: `live` for the present.
  source(live: Source): Source {
    return this.axis.at === undefined ? live : this.tape.history.at(this.axis.at);
  }

  // Shows axis and plots.
  show(): void {
    const { tape } = this;
    this.live.events.forgetBefore(this.live.begin);
    this.axis.show(tape.begin, tape.end);
    this.plots.show((this.axis.at ?? tape.end) / 1000);
  }
}
