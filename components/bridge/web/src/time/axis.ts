// SPDX-License-Identifier: Apache-2.0
// The time axis: what happened as marks over the time kept, a slider to go back, and a button to
// return to the present.
import { byId, put } from "../elements";
import { EventKind, Events, Happening, kEventKinds } from "./events";

const kListed = 8;    // events written beside the axis
const kLane = 9;      // height of one kind of event [px]
const kMode: Record<string, string> = { normal: "#12824c", slow: "#8a6d00", hold: "#b3261e", stop: "#b3261e", fault: "#b3261e" };
const kMark: Record<EventKind, string> = { mode: "#5b6877", cause: "#b3261e", task: "#1d5fd1", fact: "#7c4df0", attention: "#0b7fa8" };

// Returns "14:03:07.2" of a time [ms, system clock].
export function clock(time: number): string {
  const date = new Date(time), two = (value: number): string => String(value).padStart(2, "0");
  return `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}.${Math.floor(date.getMilliseconds() / 100)}`;
}

export class Axis {
  // Instant shown [ms, system clock]; undefined: the present.
  at: number | undefined;
  private readonly slider = byId<HTMLInputElement>("scrub");
  private readonly lanes = byId<HTMLCanvasElement>("lanes");
  private begin = 0;
  private end = 0;
  private drawn = "";

  // `source`: events of what the axis runs over. `onChange` is called when another instant is to be
  // shown; `present`: the present.
  constructor(private readonly source: () => Events, private readonly onChange: (present: boolean) => void) {
    this.slider.addEventListener("input", () => this.go(this.begin + Number(this.slider.value) * 1000));
    byId("live").addEventListener("click", () => this.go(undefined));
    this.lanes.addEventListener("pointerdown", (event) => {
      const view = this.lanes.getBoundingClientRect();
      this.go(this.begin + ((event.clientX - view.x) / view.width) * (this.end - this.begin));
    });
  }

  // Shows another instant, within the time kept; undefined: the present.
  go(time: number | undefined): void {
    this.at = time === undefined ? undefined : Math.min(Math.max(time, this.begin), this.end);
    this.drawn = "";
    this.onChange(time === undefined);
  }

  // Shows the time from `begin` to `end` [ms, system clock].
  show(begin: number, end: number): void {
    if (!(end > begin)) return;
    [this.begin, this.end] = [begin, end];
    if (this.at !== undefined) this.at = Math.min(Math.max(this.at, begin), end);
    const at = this.at ?? end, seconds = (end - begin) / 1000;
    this.slider.max = seconds.toFixed(1);
    if (document.activeElement !== this.slider || this.at === undefined) this.slider.value = ((at - begin) / 1000).toFixed(1);
    this.slider.setAttribute("aria-valuetext", clock(at));
    byId<HTMLButtonElement>("live").disabled = this.at === undefined;
    document.body.classList.toggle("past", this.at !== undefined);
    put("shown-time", this.at === undefined ? "live" : `${clock(at)}, ${((end - at) / 1000).toFixed(1)} s before the end`);
    this.list(at);
    const now = [Math.round(begin / 500), Math.round(end / 500), this.source().all.length, at === end ? "" : at, this.lanes.clientWidth].join();
    if (now === this.drawn) return;
    this.drawn = now;
    this.paint(at);
  }

  private list(at: number): void {
    const past = this.source().all.filter(({ time }) => time <= at).slice(-kListed).reverse();
    const list = byId("events"), texts = past.map(({ time, text }) => `${clock(time)}  ${text}`);
    if (list.children.length === texts.length && texts.every((text, i) => list.children[i].textContent === text)) return;
    list.replaceChildren(...past.map(({ kind }, i) => {
      const row = document.createElement("li");
      row.className = kind;
      row.textContent = texts[i];
      return row;
    }));
  }

  private paint(at: number): void {
    const { lanes } = this, width = lanes.clientWidth, ratio = Math.min(devicePixelRatio, 2), context = lanes.getContext("2d");
    if (!context || width === 0) return;
    lanes.width = width * ratio;
    lanes.height = kLane * kEventKinds.length * ratio;
    context.scale(ratio, ratio);
    const x = (time: number): number => ((time - this.begin) / (this.end - this.begin)) * width;
    const modes = this.source().of("mode");
    modes.forEach(({ time, state }, i) => {
      const from = Math.max(0, x(time)), to = i + 1 < modes.length ? x(modes[i + 1].time) : width;
      context.fillStyle = kMode[state] ?? kMark.mode;
      context.fillRect(from, 1, to - from, kLane - 2);
    });
    const mark = ({ time, kind }: Happening): void => {
      context.fillStyle = kMark[kind];
      context.fillRect(x(time) - 0.75, kEventKinds.indexOf(kind) * kLane + 1, 1.5, kLane - 2);
    };
    for (const event of this.source().all) if (event.kind !== "mode") mark(event);
    context.fillStyle = getComputedStyle(lanes).color;
    context.fillRect(x(at) - 1, 0, 2, kLane * kEventKinds.length);
  }
}
