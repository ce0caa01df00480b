// SPDX-License-Identifier: Apache-2.0
// What tests of decoded samples share.
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";

const patience = 20_000; // [ms] for the whole of one wait
// Fields of the writer's that have another name in the IDL.
const renamed = {
  "RobotState.sequence": "sequence_number",
  "JointCommand.sequence": "sequence_number",
  "SimClock.sequence": "sequence_number",
  "ClockReached.sequence": "sequence_number",
  "Facts.facts": "holding",
};

export function within(what, promise) {
  let timer;
  const late = new Promise((_, reject) => (timer = setTimeout(() => reject(new Error(`${what}: nothing in ${patience / 1000} s`)), patience)));
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

export function start(binary, args, stream, environment = {}) {
  const child = spawn(binary, args, { env: { ...process.env, ...environment }, stdio: ["pipe", "pipe", "pipe"] });
  const lines = createInterface({ input: child[stream] });
  child[stream === "stdout" ? "stderr" : "stdout"].resume();
  const ended = new Promise((resolve) => child.on("exit", resolve));
  return { child, lines, ended };
}

// {a: {b: [1, "x"]}} -> {"a.b[0]": 1, "a.b[1]": "x"}
export function leavesOf(value, path = "", out = {}) {
  if (ArrayBuffer.isView(value) || Array.isArray(value)) value.forEach((one, i) => leavesOf(one, `${path}[${i}]`, out));
  else if (value !== null && typeof value === "object") for (const [name, one] of Object.entries(value)) leavesOf(one, path ? `${path}.${name}` : name, out);
  else out[path] = typeof value === "bigint" ? String(value) : value;
  return out;
}

export function expectedLeaves({ type, leaves }) {
  const out = {};
  for (const [path, value] of Object.entries(leaves)) {
    const first = path.match(/^\w+/)[0];
    out[(renamed[`${type}.${first}`] ?? first) + path.slice(first.length)] = value;
  }
  return out;
}
