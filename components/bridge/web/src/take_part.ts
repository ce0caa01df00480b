// SPDX-License-Identifier: Apache-2.0
// The card with which a visitor takes part: tasks, requests, and actions of simulated people.
import { byId, put } from "./elements";
import { Link } from "./link";
import { causesOf } from "./source";
import { Command, Steering } from "./steering";

type Field = "object" | "human" | "surface" | "onto";
// Tasks and their fields; "?" marks a field that may be empty.
const kTasks: Record<string, string[]> = {
  give: ["object", "human?"], receive: ["object?", "human?", "onto?"], pick: ["object"], place: ["object", "surface"],
  clear: ["surface", "onto?"], lift: ["object"], regrasp: ["object"], "go to": [],
};
const kEmpty: Record<Field, string> = { object: "what is offered", human: "anybody", surface: "", onto: "where there is room" };
const kSilent = 1;    // max time without a heartbeat of the simulator [s]
const kNobody = 1e8;  // larger distances mean that no person is present [m]

// Gives a list these values, and keeps what is chosen.
function offer(list: HTMLSelectElement, values: string[], empty?: string): void {
  const wanted = empty === undefined ? values : ["", ...values];
  if (wanted.length === list.options.length && wanted.every((value, i) => list.options[i].value === value)) return;
  const chosen = list.value;
  list.replaceChildren(...wanted.map((value) => new Option(value || empty, value)));
  if (wanted.includes(chosen)) list.value = chosen;
}

export class TakePart {
  private readonly task = byId<HTMLSelectElement>("task-kind");
  private readonly person = byId<HTMLSelectElement>("person-id");
  private readonly speed = byId<HTMLInputElement>("speed-override");

  constructor(private readonly link: Link, private readonly steering: Steering) {
    offer(this.task, Object.keys(kTasks));
    byId("task-form").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.say(this.chosenTask(), `${this.task.value}: asked for`);
    });
    for (const button of document.querySelectorAll<HTMLButtonElement>("#requests button"))
      button.addEventListener("click", () => void this.say({ task: button.value }, `${button.value}: asked for`));
    this.speed.addEventListener("input", () => put("speed-wanted", `${this.speed.value} %`));
    this.speed.addEventListener("change", () => void this.say({ task: "speed", value: Number(this.speed.value) / 100 }, `max speed ${this.speed.value} %: asked for`));
    for (const button of document.querySelectorAll<HTMLButtonElement>("#person-actions button"))
      button.addEventListener("click", () => void this.say({ person: this.person.value, action: button.value }, `${this.person.value}: ${button.textContent}`));
  }

  show(): void {
    const { link, steering } = this;
    this.showSpeed();
    const scene = link.newest("handsel/scene"), people = (link.newest("handsel/human_state")?.people ?? []).map(({ id }) => id).sort();
    const simulated = link.health().some(({ message, age }) => message.component === "sim" && age < kSilent);
    const fields = kTasks[this.task.value] ?? [];
    const values: Record<Field, string[]> = {
      object: (scene?.objects ?? []).map(({ id }) => id).sort(), human: people,
      surface: (scene?.boxes ?? []).map(({ id }) => id).sort(), onto: (scene?.boxes ?? []).map(({ id }) => id).sort(),
    };
    for (const field of Object.keys(values) as Field[]) {
      const may = fields.includes(`${field}?`), list = byId<HTMLSelectElement>(`task-${field}`);
      list.hidden = !may && !fields.includes(field);
      offer(list, values[field], may ? kEmpty[field] : undefined);
    }
    offer(this.person, people);
    byId("steer-note").textContent = steering.note || "Drag a hand of a simulated person in the picture.";
    byId("steer-note").hidden = steering.allowed && !(simulated && people.length > 0);
    byId("steer-state").textContent = steering.allowed ? "" : "read-only";
    for (const button of document.querySelectorAll<HTMLButtonElement>("#task-form button, #requests button")) button.disabled = !steering.allowed;
    for (const button of document.querySelectorAll<HTMLButtonElement>("#person-actions button"))
      button.disabled = !steering.allowed || !simulated || people.length === 0;
    byId("person-actions").hidden = !simulated;
    byId("reaction").textContent = this.reaction();
  }

  // Shows an answer of the bridge.
  answer(text: string): void {
    byId("steer-answer").textContent = text;
  }

  // Shows the speed override in force, unless the viewer is choosing another.
  private showSpeed(): void {
    this.speed.disabled = !this.steering.allowed;
    const safety = this.link.newest("handsel/safety_state");
    if (!safety || document.activeElement === this.speed) return;
    this.speed.value = String(Math.round(100 * safety.override_factor));
    put("speed-wanted", `${this.speed.value} %`);
  }

  private async say(command: Command, done: string): Promise<void> {
    const refusal = await this.steering.send(command);
    this.answer(refusal || `${done}.`);
    this.show();
  }

  private chosenTask(): Command {
    const word = this.task.value, fields = kTasks[word] ?? [];
    if (word === "go to") return { task: "go_to", surface: "rest" };
    const chosen = (field: Field): Record<string, string> => {
      const { value } = byId<HTMLSelectElement>(`task-${field}`);
      return value && (fields.includes(field) || fields.includes(`${field}?`)) ? { [field]: value } : {};
    };
    return { task: word, ...chosen("object"), ...chosen("human"), ...chosen("surface"), ...chosen("onto") };
  }

  // Returns how the robot reacts to people now.
  private reaction(): string {
    const { link } = this;
    const execution = link.newest("handsel/execution_status"), active = link.newest("handsel/active_trajectory");
    if (!execution || execution.separation >= kNobody) return "";
    const speed = !active || active.trajectory === 0n ? "at rest" : `at ${(100 * Math.abs(active.speed_factor)).toFixed(0)} %`;
    const causes = causesOf(link, execution.causes);
    const limit = execution.separation_limit > 0 ? ` of at least ${execution.separation_limit.toFixed(2)} m` : "";
    return [`Robot ${speed}`, `${execution.separation.toFixed(2)} m${limit}`, causes.join(", ")].filter(Boolean).join(" · ");
  }
}
