// SPDX-License-Identifier: Apache-2.0
// The time axis over a running system: what the page shows of an earlier instant is what was recorded then, field by field; the present is back with one button; what happened stands beside the axis.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { leavesOf } from "./leaves.mjs";
import { kNoGl, launchBrowser, Program, root, startSystem, until } from "./stage.mjs";

const require = createRequire(join(root, "components/bridge/web/package.json"));
const { McapStreamReader } = require("@mcap/core");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");

const kDomain = process.env.HANDSEL_TEST_DOMAIN ?? "42";
const kTopics = ["robot_state", "scene", "human_state", "active_trajectory", "execution_status", "task_status", "action_status", "attention_advice"].map((topic) => `handsel/${topic}`);
const kLate = 1500;       // [ms] max age of a sample at the instant shown, for topics sent all the time
const kMaxBytes = 160e6;  // of the samples kept
const folder = mkdtempSync(join(tmpdir(), "handsel-test-")), file = join(folder, "task.mcap");
let system, address, browser, page, recorder;

before(async () => {
  ({ system, address } = await startSystem("up", kDomain));
  recorder = new Program("handsel", ["record", file, "--domain", kDomain]);
  await recorder.line(/recording/);
  browser = await launchBrowser(kNoGl);  // the tables: nothing is drawn
  page = await (await browser.newContext({ viewport: { width: 1000, height: 900 } })).newPage();
  await page.goto(address);
  await until(page, () => window.handsel?.connected && window.handsel.sample("handsel/robot_state"));
});

after(async () => {
  await browser?.close();
  await recorder?.end();
  await system?.end();
  rmSync(folder, { recursive: true });
});

// Shows an instant, and returns what the page has of each topic and what it writes.
async function show(time) {
  await page.evaluate((at) => (window.handsel.time = at), time);
  await until(page, () => document.body.classList.contains("past"));
  return page.evaluate((topics) => ({
    samples: Object.fromEntries(topics.map((topic) => [topic, window.handsel.sample(topic)])),
    texts: Object.fromEntries(["mode", "task-state", "phase", "separation"].map((id) => [id, document.getElementById(id).textContent])),
  }), kTopics);
}

// Returns every recorded sample of a topic by its stamp.
function recorded(bytes) {
  const stream = new McapStreamReader(), decoders = new Map(), schemas = new Map(), names = new Map(), found = new Map(kTopics.map((topic) => [topic, new Map()]));
  stream.append(bytes);
  for (let one; (one = stream.nextRecord());) {
    if (one.type === "Schema") schemas.set(one.id, one);
    if (one.type === "Channel" && found.has(one.topic)) {
      const schema = schemas.get(one.schemaId);
      names.set(one.id, one.topic);
      decoders.set(one.id, new MessageReader(schema.name, parseIDL(new TextDecoder().decode(schema.data))));
    }
    if (one.type === "Message" && names.has(one.channelId)) found.get(names.get(one.channelId)).set(String(one.logTime), { data: one.data, decoder: decoders.get(one.channelId) });
  }
  return found;
}

test("an earlier instant is shown as it was recorded, field by field", async () => {
  const begin = Date.now(), instants = [];
  const task = new Program("handsel", ["task", "give", "mug", "--domain", kDomain]);
  for (const phase of ["approach", "carry"]) {
    await until(page, (wanted) => document.getElementById("phase").textContent === wanted, phase);
    await new Promise((resolve) => setTimeout(resolve, 700));
    instants.push(await page.evaluate(() => window.handsel.kept[1]));
  }
  assert.equal(await task.ended, 0);
  await until(page, () => document.getElementById("task-state").textContent === "succeeded");
  const shown = [];
  for (const instant of instants) shown.push(await show(instant));
  await recorder.end();
  const found = recorded(readFileSync(file));
  let fields = 0;
  shown.forEach(({ samples, texts }, i) => {
    for (const topic of kTopics) {
      const sample = samples[topic];
      assert.ok(sample, `${topic}: nothing is shown of ${instants[i]}`);
      const stamp = Number(sample.stamp) / 1e6;
      assert.ok(stamp <= instants[i] + 1e-3, `${topic} is from after the instant shown`);
      if (!topic.endsWith("task_status")) assert.ok(stamp > instants[i] - kLate, `${topic} is ${instants[i] - stamp} ms old`);
      const record = found.get(topic).get(sample.stamp);
      assert.ok(record, `${topic}: the sample ${sample.stamp} was not recorded`);
      const expected = leavesOf(record.decoder.readMessage(record.data));
      assert.deepEqual(leavesOf(sample), expected, topic);
      fields += Object.keys(expected).length;
    }
    assert.equal(texts["task-state"], "running");
    assert.equal(texts.separation, `${samples["handsel/execution_status"].separation.toFixed(2)} m`);
  });
  assert.deepEqual(shown.map(({ texts }) => texts.phase), ["approach", "carry"]);
  console.log(`${shown.length} instants, ${fields} fields equal, the first ${((Date.now() - begin) / 1000).toFixed(0)} s ago`);
});

test("what happened until then stands beside the axis", async () => {
  await page.click("#event-card summary");
  await until(page, () => document.querySelectorAll("#events li").length > 0);
  const at = (time) => page.evaluate((t) => (window.handsel.time = t), time);
  const [begin, end] = await page.evaluate(() => window.handsel.kept);
  await at(end - 1);
  const texts = await page.evaluate(() => window.handsel.events.map(({ kind, text }) => `${kind}: ${text}`));
  for (const expected of [/^task: give: running/, /^task: approach/, /^task: carry/, /^task: give: succeeded/, /^mode: /, /^cause: .* begins/, /^fact: .* holds/])
    assert.ok(texts.some((text) => expected.test(text)), `${expected} is missing in ${texts.slice(-30).join("; ")}`);
  const times = await page.evaluate(() => window.handsel.events.map(({ time }) => time));
  assert.ok(times.every((time, i) => i === 0 || time >= times[i - 1] - 1000), "events are out of order");
  await at(begin + 1);
  await until(page, () => document.getElementById("task-state").textContent !== "succeeded");
});

test("the slider goes back by keys and the present is back with one button", async () => {
  await page.focus("#scrub");
  await page.click("#live", { force: true });
  await until(page, () => !document.body.classList.contains("past"));
  await page.focus("#scrub");
  for (let i = 0; i < 20; ++i) await page.keyboard.press("ArrowLeft");
  await until(page, () => document.body.classList.contains("past"));
  const { time, kept } = await page.evaluate(() => ({ time: window.handsel.time, kept: window.handsel.kept }));
  assert.ok(time < kept[1] - 1000, "the keys do not go back");
  assert.match(await page.textContent("#shown-time"), /^\d\d:\d\d:\d\d\.\d, \d+\.\d s before the end$/);
  await page.click("#live");
  await until(page, () => document.getElementById("shown-time").textContent === "live");
  const before = await page.evaluate(() => window.handsel.stamp);
  await until(page, (stamp) => window.handsel.stamp !== stamp, before);
  assert.ok(kept[2] > 0 && kept[2] <= kMaxBytes);
});

test("velocity, acceleration, jerk, force and separation are plotted against their limits", async () => {
  await page.click("#plot-card summary");
  await until(page, () => document.querySelectorAll("#plots .uplot").length === 6);
  const titles = await page.$$eval("#plots .u-title", (all) => all.map((one) => one.textContent));
  for (const word of ["position", "velocity", "acceleration", "jerk", "force", "separation"]) assert.ok(titles.some((title) => title.startsWith(word)), `${word}: ${titles}`);
  const curves = await page.evaluate(() => window.handsel.curves);
  const largest = (id) => Math.max(...curves.find((one) => one.id === id).points.flat().filter(Number.isFinite).map(Math.abs));
  for (const id of ["velocity", "acceleration", "jerk"]) {
    const ratio = largest(id);
    assert.ok(ratio > 0.02 && ratio <= 1.001, `${id}: ${ratio} of its limit`);
  }
  const [distance, limit] = curves.find(({ id }) => id === "separation").points;
  assert.ok(distance.some((value, i) => value > 0 && limit[i] > 0), "no separation is plotted");
});

test("a recording opens up to its last complete record, and Live returns to the system", async () => {
  const bytes = readFileSync(file), cut = join(folder, "cut.mcap"), found = recorded(bytes);
  writeFileSync(cut, bytes.subarray(0, Math.floor(0.7 * bytes.length)));
  for (const [name, sentence] of [[file, /^task\.mcap is shown; Live returns to the running system\.$/], [cut, /^cut\.mcap does not end as a complete recording; it is shown up to its last complete record\.$/]]) {
    await page.setInputFiles("#recording-file", name);
    await until(page, (pattern) => new RegExp(pattern).test(document.getElementById("recording-note").textContent), sentence.source);
    assert.ok(await page.evaluate(() => document.body.classList.contains("recorded")));
    const samples = await page.evaluate((topics) => Object.fromEntries(topics.map((topic) => [topic, window.handsel.sample(topic)])), kTopics);
    for (const topic of kTopics) {
      const record = found.get(topic).get(samples[topic].stamp);
      assert.deepEqual(leavesOf(samples[topic]), leavesOf(record.decoder.readMessage(record.data)), `${name}: ${topic}`);
    }
    const stamps = [...found.get("handsel/execution_status").keys()].map(Number), [begin, end] = await page.evaluate(() => window.handsel.kept);
    const whole = (Math.max(...stamps) - Math.min(...stamps)) / 1e6;
    console.log(`${name.split("/").at(-1)}: ${((end - begin) / 1000).toFixed(1)} of ${(whole / 1000).toFixed(1)} s`);
    assert.ok(end - begin > (name === file ? 0.95 : 0.4) * whole, "too little of the recording is shown");
  }
  writeFileSync(cut, "no recording");
  await page.setInputFiles("#recording-file", cut);
  await until(page, () => /^cut\.mcap holds no samples of a robot/.test(document.getElementById("recording-note").textContent));
  await page.click("#live");
  await until(page, () => !document.body.classList.contains("recorded") && document.getElementById("shown-time").textContent === "live");
});
