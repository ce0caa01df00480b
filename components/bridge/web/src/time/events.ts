// SPDX-License-Identifier: Apache-2.0
// What happened and when: changes of mode, causes, task, phase, facts, and of what attention lets
// decide the speed. Pure: times are arguments.
import { Facts, TopicName } from "../messages";
import { causesOf, Source } from "../source";

export type EventKind = "mode" | "cause" | "task" | "fact" | "attention";
export const kEventKinds: EventKind[] = ["mode", "cause", "task", "fact", "attention"];
export interface Happening { time: number; kind: EventKind; text: string; state: string }  // time [ms, system clock]

const kMost = 6000;  // events kept

export class Events {
  readonly all: Happening[] = [];
  private last: Record<string, string> = {};
  private causes = new Set<string>();
  private facts = new Set<string>();

  // Takes the newest sample of `topic` at a time; returns true if something happened.
  take(topic: TopicName, source: Source, time: number): boolean {
    const before = this.all.length;
    if (topic === "handsel/execution_status") this.takeExecution(source, time);
    if (topic === "handsel/task_status") {
      const task = source.newest(topic);
      if (task) this.change(time, "task", "task", `${source.word("TaskKind", task.kind)}: ${source.word("TaskState", task.state)}`, task.reason);
    }
    if (topic === "handsel/action_status") {
      const action = source.newest(topic);
      if (action) this.change(time, "task", "phase", source.word("ActionPhase", action.phase), "");
    }
    if (topic === "handsel/attention_advice") {
      const advice = source.newest(topic);
      if (advice) this.change(time, "attention", "limiting", advice.speed_factor < 0.999 && advice.limiting ? advice.limiting : "nothing slows", advice.speed_factor < 0.999 ? advice.reason : "");
    }
    if (topic === "handsel/facts") this.takeFacts(source, source.newest(topic), time);
    const happened = this.all.length > before;
    if (this.all.length > kMost) this.all.splice(0, this.all.length - kMost);
    return happened;
  }

  // Forgets what happened before a time [ms].
  forgetBefore(time: number): void {
    let count = 0;
    while (count < this.all.length && this.all[count].time < time) ++count;
    // The newest change of the mode stays, so that the mode at the begin of the axis is known.
    if (count > 1) this.all.splice(0, count - 1);
  }

  // Returns the events of one kind in the order of time.
  of(kind: EventKind): Happening[] {
    return this.all.filter((event) => event.kind === kind);
  }

  private takeExecution(source: Source, time: number): void {
    const execution = source.newest("handsel/execution_status");
    if (!execution) return;
    const mode = source.word("Mode", execution.mode);
    this.change(time, "mode", "mode", mode, execution.reason, mode);
    const now = new Set(causesOf(source, execution.causes));
    for (const cause of now) if (!this.causes.has(cause)) this.push(time, "cause", `${cause} begins`);
    for (const cause of this.causes) if (!now.has(cause)) this.push(time, "cause", `${cause} ends`);
    this.causes = now;
  }

  private takeFacts(source: Source, facts: Facts | undefined, time: number): void {
    if (!facts) return;
    const now = new Set(facts.holding.map(({ kind, subject, object }) => [source.word("FactKind", kind), subject, object].filter(Boolean).join(" ")));
    for (const fact of now) if (!this.facts.has(fact)) this.push(time, "fact", `${fact} holds`);
    for (const fact of this.facts) if (!now.has(fact)) this.push(time, "fact", `${fact} ends`);
    this.facts = now;
  }

  private change(time: number, kind: EventKind, what: string, text: string, reason: string, state = ""): void {
    if (this.last[what] === text) return;
    this.last[what] = text;
    this.push(time, kind, reason ? `${text} (${reason})` : text, state);
  }

  private push(time: number, kind: EventKind, text: string, state = ""): void {
    this.all.push({ time, kind, text, state });
  }
}
