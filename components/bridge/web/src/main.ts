// SPDX-License-Identifier: Apache-2.0
// The page: shows the newest samples in tables and a 3-D view. Draws on change, at most 30 times a
// second.
import { Config, loadConfig } from "./config";
import { Link } from "./link";
import { TopicName } from "./messages";
import { Panels } from "./panels";
import { Steering } from "./steering";
import { TakePart } from "./take_part";
import { Chooser } from "./time/chooser";
import { Curve } from "./time/curves";
import { Happening } from "./time/events";
import { Past } from "./time/past";
import { Part, Region, World } from "./world";

const kFrame = 33, kTables = 200;  // min time between pictures, between updates of the tables [ms]
const kRest = 5, kLongest = 500;   // pause as a multiple of the last picture's time; its max [ms]
const kNoWebGl = "This browser cannot draw the 3-D view (WebGL is missing or switched off); everything else on this page works.";

// State for external observers, such as tests.
export interface PageState {
  connected: boolean;
  webgl: boolean;
  samples: number;  // received
  received(topic: string): number;  // samples of one topic
  frames: number;   // drawn
  stamp: string;    // [ns] of the RobotState drawn
  angles: Record<string, number>;  // [rad] of the drawn model, by axis
  time: number | undefined;        // instant shown [ms, system clock]; undefined: the present
  kept: number[];                  // begin and end [ms, system clock] and bytes of the samples kept
  events: Happening[];             // in the order of time
  curves: Curve[];                 // as plotted
  sample(topic: string): unknown;  // shown of a topic; 64-bit integers as texts
  region(part: string): Region | undefined;  // of a part or a layer
  pixel(point: [number, number, number]): { x: number; y: number } | undefined;
  hand(person: string, side: string): [number, number, number] | undefined;  // world [m]
  hide(parts: Part[]): void;
  layer(id: string, on: boolean): void;
}

declare global {
  interface Window { handsel: PageState }
}

async function configured(): Promise<[Config, string]> {
  for (;;) {
    try {
      const config = await loadConfig();
      if (config.urdf_text) return [config, config.urdf_text];
      const urdf = await fetch(config.urdf);
      if (!urdf.ok) throw new Error(`${config.urdf}: HTTP ${urdf.status}`);
      return [config, await urdf.text()];
    } catch (error) {
      notice(`The bridge does not answer (${(error as Error).message}); trying again.`);
      await new Promise((resolve) => setTimeout(resolve, 1000));
    }
  }
}

function notice(sentence: string): void {
  const element = document.getElementById("stage-note");
  if (!element) return;
  element.textContent = sentence;
  element.hidden = sentence === "";
}

// Returns a sample with numbers, texts and lists only.
function plain(sample: unknown): unknown {
  return sample === undefined ? undefined
    : JSON.parse(JSON.stringify(sample, (_, value) => (typeof value === "bigint" ? String(value) : ArrayBuffer.isView(value) ? Array.from(value as Float64Array) : value)));
}

async function start(): Promise<void> {
  const [config, urdf] = await configured();
  notice("");
  const name = document.getElementById("scene-name");
  if (name) name.textContent = [config.robot, config.scenario.replaceAll("_", " ")].filter(Boolean).join(" · ");

  let world: World | undefined, pending = false, drawnAt = 0, tablesAt = 0;
  const wake = (): void => {
    if (pending) return;
    pending = true;
    const due = drawnAt + Math.max(kFrame, Math.min(kRest * (world?.cost ?? 0), kLongest)) - performance.now();
    if (due > 4) setTimeout(() => requestAnimationFrame(frame), due - 4);
    else requestAnimationFrame(frame);
  };
  const link = new Link(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/`, wake);
  const past = new Past(config, () => {
    tablesAt = 0;
    wake();
  });
  link.onSample = (topic, key, stamp, bytes, decoder) => past.live.take(topic, key, stamp, bytes, decoder, link);
  new Chooser(config, past);
  const steering = new Steering(), takePart = new TakePart(link, steering);
  const panels = new Panels(link, config.groups.arm ?? config.axes);
  link.onConnection = () => panels.connection();
  const angleOf = (axis: string): number =>
    world ? (world.robot.angles()[axis] ?? NaN) : (past.source(link).newest("handsel/robot_state")?.position[config.axes.indexOf(axis)] ?? NaN);

  const frame = (): void => {
    pending = false;
    const begin = performance.now();
    drawnAt = begin;
    link.want(world?.layers.topics() ?? []);
    const source = past.source(link);
    if (world?.ready() && world.update(source)) world.render();
    if (begin - tablesAt >= kTables) {
      tablesAt = begin;
      panels.show(source, angleOf);
      past.show();
      takePart.show();
    }
  };
  try {
    const stage = document.getElementById("stage");
    if (stage) world = new World(stage, urdf, config, wake, notice);
    world?.letDrag(steering, () => past.present, (refusal) => takePart.answer(refusal));
  } catch (error) {
    notice((error as Error).message === "no WebGL" ? kNoWebGl : `The robot cannot be drawn: ${(error as Error).message}.`);
  }
  document.getElementById("frame")?.addEventListener("click", () => world?.frame());
  setInterval(() => {
    tablesAt = 0;  // ages grow without new samples
    wake();
  }, 500);

  window.handsel = {
    get connected() { return link.connected; },
    get webgl() { return world !== undefined; },
    get samples() { return link.samples; },
    received: (topic) => link.received(topic as TopicName),
    get frames() { return world?.frames ?? 0; },
    get stamp() { return String(world ? world.robot.stamp : (past.source(link).newest("handsel/robot_state")?.stamp ?? 0n)); },
    get angles() { return Object.fromEntries(config.axes.map((axis) => [axis, angleOf(axis)])); },
    get time() { return past.axis.at; },
    set time(at) { past.axis.go(at); },
    get kept() { return [past.tape.begin, past.tape.end, past.tape.history.size]; },
    get events() { return past.tape.events.all; },
    get curves() { return past.tape.curves.curves; },
    sample: (topic) => plain(past.source(link).newest(topic as TopicName)),
    region: (part) => world?.region(part),
    pixel: (point) => world?.pixel(point),
    hand: (person, side) => world?.hand(person, side),
    hide: (parts) => world?.hide(parts),
    layer: (id, on) => world?.layers.switch(id, on),
  };
}

void start();
