// SPDX-License-Identifier: Apache-2.0
// The tables beside the 3-D view.
import { byId, put } from "./elements";
import { Link } from "./link";
import { kOfTasks } from "./messages";
import { causesOf, Source } from "./source";
import { nearness } from "./nearness";

const kSilent = 0.6;    // max time without a heartbeat [s]
const kNobody = 1e8;    // larger distances mean that no person is present [m]
const kDrives: Record<string, string> = { enabled: "drives on", braked: "brakes closed", off: "drives off" };

type Cell = string | { text: string; kind?: string; ratio?: number };

// Returns a bar from 0 to 1.
function bar(element: HTMLElement, ratio: number, kind = ""): void {
  const fill = (element.firstElementChild as HTMLElement | null) ?? element.appendChild(document.createElement("i"));
  element.className = `bar ${kind}`;
  const text = `scaleX(${Math.min(1, Math.max(0, ratio)).toFixed(3)})`;
  if (fill.style.transform !== text) fill.style.transform = text;
}

function rows(id: string, cells: Cell[][]): void {
  const body = byId(id);
  while (body.children.length > cells.length) body.lastElementChild?.remove();
  cells.forEach((row, i) => {
    const line = body.children[i] ?? body.appendChild(document.createElement("tr"));
    row.forEach((cell, k) => {
      const element = (line.children[k] ?? line.appendChild(document.createElement("td"))) as HTMLElement;
      const { text, kind = "", ratio } = typeof cell === "string" ? { text: cell } : cell;
      if (element.className !== kind) element.className = kind;
      if (ratio !== undefined) {
        const track = (element.firstElementChild as HTMLElement | null) ?? element.appendChild(document.createElement("div"));
        track.title = text;
        bar(track, ratio);
      } else if (element.textContent !== text) {
        element.textContent = text;
      }
    });
  });
}

const kDeepest = 6; // max indentation of the tree of a plan

// Returns the name of the person for whom an action waits.
function phaseText(word: string, human: string): string {
  if (!human) return word;
  if (word === "waiting for person") return `waiting for ${human} to come within reach`;
  return word === "waiting for release" ? `waiting for ${human} to let go` : word;
}

export class Panels {
  private source: Source;

  constructor(private readonly link: Link, private readonly axes: string[]) {
    this.source = link;
  }

  // Shows what `source` has; `angles`: of each axis [rad].
  show(source: Source, angles: (axis: string) => number): void {
    this.source = source;
    this.connection();
    this.mode();
    this.task();
    this.motion();
    this.attention();
    this.health();
    rows("joints", this.axes.map((axis) => [axis, { text: angles(axis).toFixed(4), kind: "number" }]));
  }

  // Shows whether the page is connected.
  connection(): void {
    const { link } = this;
    const lost = link.closedAt > 0 ? `lost ${((performance.now() - link.closedAt) / 1000).toFixed(0)} s ago, ` : "";
    const text = link.connected ? "live" : `not connected: ${lost}trying again`;
    put("link", text);
    byId("link").className = link.connected ? "live" : "lost";
    document.body.classList.toggle("stale", !link.connected);
    put("problem", link.connected ? link.problem : "The connection to the bridge is lost: what is shown is old. The page connects again by itself.");
    byId("problem").hidden = link.connected && link.problem === "";
  }

  private mode(): void {
    const link = this.source;
    const execution = link.newest("handsel/execution_status"), robot = link.newest("handsel/robot_state");
    const silent = link.age("handsel/execution_status") > kSilent;
    const mode = !execution ? "waiting" : silent ? "silent" : link.word("Mode", execution.mode);
    put("mode", mode);
    byId("mode").dataset.mode = mode;
    const drive = robot ? link.word("DriveMode", robot.mode) : "";
    put("drive", !robot ? "no robot yet" : link.age("handsel/robot_state") > kSilent ? "robot silent" : (kDrives[drive] ?? drive));
    byId("drive").dataset.drive = drive;
    const causes = execution && !silent ? causesOf(link, execution.causes) : [];
    const list = byId("causes");
    list.replaceChildren(...causes.map((cause) => {
      const chip = document.createElement("li");
      chip.textContent = cause;
      return chip;
    }));
    put("reason", silent && execution ? "The trajectory controller is silent." : (execution?.reason ?? ""));
  }

  private task(): void {
    const link = this.source;
    const task = link.newest("handsel/task_status", kOfTasks), action = link.newest("handsel/action_status");
    const state = task ? link.word("TaskState", task.state) : "none";
    put("task-title", task ? (task.plan[Math.min(task.step, task.plan.length - 1)] ?? link.word("TaskKind", task.kind)) : "no task yet");
    put("task-state", task ? state : "");
    byId("task-state").dataset.state = state;
    const running = action && link.word("ActionState", action.state) === "running";
    put("phase", running ? phaseText(link.word("ActionPhase", action.phase), action.human) : "");
    rows("plan", (task?.tree ?? []).map(({ text, depth, state, reason }) => {
      const how = link.word("StepState", state);
      const why = depth > 0 && reason ? ` (${reason})` : "";
      return [{ text: "", kind: `mark ${how}` }, { text: text + why, kind: `${how} depth-${Math.min(depth, kDeepest)}` }];
    }));
    const held = action?.holding ? `holding ${action.object}` : "";
    const engaged = action?.exchange_engaged ? `${action.human} takes it` : "";
    put("task-note", [held, engaged, task?.reason ?? ""].filter(Boolean).join(" · "));
  }

  private motion(): void {
    const link = this.source;
    const active = link.newest("handsel/active_trajectory"), execution = link.newest("handsel/execution_status");
    const factor = active && active.trajectory !== 0n ? active.speed_factor : undefined;
    put("speed", factor === undefined ? "at rest" : `${(100 * factor).toFixed(0)} %`);
    bar(byId("speed-bar"), Math.abs(factor ?? 0), factor !== undefined && factor < 0 ? "warn" : "");
    put("progress", factor === undefined || !execution ? "–" : `${(100 * execution.progress).toFixed(0)} %`);
    bar(byId("progress-bar"), factor === undefined ? 0 : (execution?.progress ?? 0), "quiet");
    this.distance();
    const forecast = link.newest("handsel/trajectory_forecast"), advice = link.newest("handsel/attention_advice");
    put("forecast", !forecast ? "unknown" : forecast.collides ? `${forecast.reason} in ${forecast.time_to_collision.toFixed(1)} s` : "clear");
    put("advice", !advice ? "none" : advice.speed_factor > 0.999 ? "full speed" : `${(100 * advice.speed_factor).toFixed(0)} %: ${advice.reason}`);
    const limits = execution && [execution.limit_ratio_velocity, execution.limit_ratio_acceleration, execution.limit_ratio_jerk];
    put("limits", limits ? limits.map((ratio, i) => `${["v", "a", "j"][i]} ${(100 * ratio).toFixed(0)} %`).join(" · ") : "–");
    const late = execution && execution.cycles > 0n ? (100 * Number(execution.late_cycles)) / Number(execution.cycles) : 0;
    put("cycles", execution ? `${execution.cycles}, ${late.toFixed(2)} % late` : "");
  }

  private distance(): void {
    const execution = this.source.newest("handsel/execution_status"), humans = this.source.newest("handsel/human_state");
    const forecast = this.source.newest("handsel/trajectory_forecast");
    const distance = execution?.separation ?? forecast?.clearance;
    if (distance === undefined || distance >= kNobody) {
      put("separation", humans && humans.people.length === 0 ? (humans.covered ? "nobody present" : "nobody observed, not all of the space in view") : "unknown");
      put("separation-limit", "");
      byId("separation-mark").hidden = true;
      bar(byId("separation-bar"), 0);
      return;
    }
    const limit = execution?.separation_limit ?? 0;
    put("separation", `${distance.toFixed(2)} m`);
    put("separation-limit", limit > 0 ? `limit ${limit.toFixed(2)} m` : "");
    const how = nearness(distance, limit), full = Math.max(2 * limit, 1.5);
    bar(byId("separation-bar"), distance / full, how === "calm" ? "good" : how === "near" ? "warn" : "bad");
    byId("separation-mark").hidden = limit === 0;
    byId("separation-mark").style.transform = `translateX(${((100 * limit) / full).toFixed(1)}cqw)`;
  }

  private attention(): void {
    const attention = this.source.newest("handsel/attention_state"), advice = this.source.newest("handsel/attention_advice");
    const limiting = advice && advice.speed_factor < 0.999 ? advice.limiting : "";
    rows("clocks", (attention?.behaviours ?? []).map((b) => {
      const fastest = Number(b.activations_at_fastest), ratio = fastest > 0 ? Number(b.activations) / fastest : 0;
      const kind = !b.released ? "quiet" : b.name === limiting ? "limiting" : "";
      const leads = b.name === limiting ? b.reason : b.winner ? "activated" : "";
      return [{ text: b.name, kind }, { text: `${(1 / Math.max(b.period, 1e-3)).toFixed(1)} Hz`, kind: `number ${kind}` },
        { text: `${b.activations} activations, ${(100 * ratio).toFixed(0)} % of those of a clock at its shortest period`, ratio },
        { text: b.stimulus.toFixed(2), kind: `number ${kind}` },
        { text: b.released ? `${(100 * b.speed_factor).toFixed(0)} %` : "–", kind: `number ${kind}` }, { text: leads, kind: b.name === limiting ? "why" : "quiet" }];
    }));
    const work: [string, number | undefined][] = [["people", advice?.people_period], ["objects", advice?.objects_period],
      ["forecast", advice?.forecast_period], ["cost map", advice?.cost_map_period], ["running path", advice?.replan_period]];
    put("work", work.filter(([, period]) => period).map(([name, period]) => `${name} ${(1 / (period ?? 1)).toFixed(1)} Hz`).join(" · "));
  }

  private health(): void {
    const sorted = this.source.health().sort((a, b) => a.message.component.localeCompare(b.message.component));
    rows("health", sorted.map(({ message: h, age }) => {
      const silent = age > kSilent;
      const said = this.source.word("HealthState", h.state);
      // Reported by the launcher while the process is restarting.
      const word = silent ? "silent" : said === "stopping" && h.pid === 0 ? "restarting" : said;
      const rate = h.topics.reduce((sum, topic) => sum + topic.rate, 0);
      const misses = h.topics.reduce((sum, topic) => sum + Number(topic.deadline_misses), 0);
      const rejected = h.topics.reduce((sum, topic) => sum + Number(topic.rejected), 0);
      const leftOut = h.left_out.map(({ name, count }) => `left out ${count}: ${name}`);
      const number = (text: string, bad = false): Cell => ({ text, kind: bad ? "number warn" : "number" });
      return [{ text: "", kind: `dot ${word}` }, h.component.replaceAll("_", " "), { text: word, kind: word }, number(rate.toFixed(0)),
        number(String(misses), misses > 0 && word !== "ok"), number(String(rejected), rejected > 0), number(`${(100 * h.cpu).toFixed(0)} %`),
        number(`${h.memory_mb.toFixed(0)} MB`), { text: [h.reason, ...leftOut].filter(Boolean).join("; "), kind: "why" }];
    }));
    const alive = sorted.filter(({ message, age }) => age <= kSilent && this.source.word("HealthState", message.state) === "ok").length;
    put("health-count", sorted.length > 0 ? `${alive} of ${sorted.length} healthy` : "");
  }
}
