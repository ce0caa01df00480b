// SPDX-License-Identifier: Apache-2.0
// The samples that the page keeps of the past: memory and age stay bounded, and each instant gives the last sample before it, as a search through all samples finds it. node history_test.mjs [SEED]
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";

const web = join(dirname(fileURLToPath(import.meta.url)), "../../components/bridge/web");
const { buildSync } = createRequire(join(web, "package.json"))("esbuild");
const { outputFiles } = buildSync({ entryPoints: [join(web, "src/time/history.ts")], bundle: true, write: false, format: "esm", logLevel: "error" });
const { History } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].text).toString("base64")}`);

const seed = Number(process.argv[2] ?? Date.now() % 1_000_000);
console.log(`seed ${seed}`);
let state = seed;
const random = () => ((state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32);
const decoder = { enumerations: () => new Map([["Mode", ["normal", "slow"]]]), read: (bytes) => ({ value: bytes.getFloat64(0) }) };
const sample = (value, size = 8) => {
  const bytes = new DataView(new ArrayBuffer(size));
  bytes.setFloat64(0, value);
  return bytes;
};

test("each instant gives the last sample at or before it, of every instance", () => {
  const history = new History(Infinity, Infinity), all = new Map([["a", []], ["b", []]]);
  for (let i = 0, time = 1.7e12; i < 3000; ++i) {
    const key = random() < 0.5 ? "a" : "b";
    time += 40 * random();
    history.add("handsel/costmap", key, time, sample(i), decoder);
    all.get(key).push({ time, value: i });
  }
  for (let i = 0; i < 2000; ++i) {
    const time = history.begin - 100 + (history.end - history.begin + 200) * random(), past = history.at(time);
    for (const [key, samples] of all) assert.equal(past.newest("handsel/costmap", key)?.value, samples.findLast((one) => one.time <= time)?.value);
    const newest = [...all.values()].flat().filter((one) => one.time <= time).sort((x, y) => x.time - y.time).at(-1);
    assert.equal(past.newest("handsel/costmap")?.value, newest?.value);
    if (newest) assert.ok(Math.abs(past.age("handsel/costmap") - (time - newest.time) / 1000) < 1e-6);
  }
  assert.equal(history.at(history.end).word("Mode", 1), "slow");
});

test("samples older than the time kept go, and the bytes never exceed their bound", () => {
  const history = new History(600_000, 1_000_000);
  for (let time = 0; time < 1_500_000; time += 50) {
    history.add("handsel/robot_state", "", time, sample(time, 80), decoder);
    if (time % 200 === 0) history.add("handsel/scene", "", time, sample(time, 400), decoder);
    assert.ok(history.size <= 1_000_000);
  }
  assert.ok(history.begin >= history.end - 600_000);
  const past = history.at(history.end);
  assert.equal(past.newest("handsel/robot_state").value, history.end);
  assert.equal(history.at(100).newest("handsel/robot_state"), undefined);
});

test("a sample that is older than the newest is left out", () => {
  const history = new History(Infinity, Infinity);
  history.add("handsel/scene", "", 200, sample(2), decoder);
  history.add("handsel/scene", "", 100, sample(1), decoder);
  assert.equal(history.at(150).newest("handsel/scene"), undefined);
  assert.equal(history.at(250).newest("handsel/scene").value, 2);
});
