// SPDX-License-Identifier: Apache-2.0
// The time axis over a running system: what the page shows of an earlier instant is what was recorded then, field by field; the present is back with one button; what happened stands beside the axis.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { plainLeaves, recordedSamples } from "./recorded.mjs";
import { kNoGl, launchBrowser, Program, startSystem, until } from "./stage.mjs";

const kDomain = process.env.HANDSEL_TEST_DOMAIN ?? "42";
const kBestEffort = "handsel/robot_state";  // page and recorder each miss samples; recording_test compares its fields
const kTopics = ["robot_state", "scene", "human_state", "active_trajectory", "execution_status", "task_status", "action_status", "attention_advice"].map((topic) => `handsel/${topic}`);
const kLate = 1500;       // [ms] max age of a sample at the instant shown, for topics sent all the time
const kPatience = 180_000;  // [ms] for the page of a machine with other work
const kMaxBytes = 160e6;  // of the samples kept
const folder = mkdtempSync(join(tmpdir(), "handsel-test-")), file = join(folder, "task.mcap");
let system, address, browser, page, recorder;

before(async () => {
  ({ system, address } = await startSystem("up", kDomain));
  recorder = new Program("handsel", ["record", file, "--domain", kDomain]);
  await recorder.line(/recording/);
  browser = await launchBrowser(kNoGl);  // the tables suffice
  page = await (await browser.newContext({ viewport: { width: 640, height: 760 } })).newPage();
  await page.goto(address);
  await until(page, () => window.handsel?.connected && window.handsel.sample("handsel/robot_state"), undefined, kPatience);
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
  const found = recordedSamples(readFileSync(file), kTopics);
  let fields = 0;
  shown.forEach(({ samples, texts }, i) => {
    for (const topic of kTopics) {
      if (topic === kBestEffort) continue;
      const sample = samples[topic];
      assert.ok(sample, `${topic}: nothing is shown of ${instants[i]}`);
      const stamp = Number(sample.stamp) / 1e6;
      assert.ok(stamp <= instants[i] + 1e-3, `${topic} is from after the instant shown`);
      if (!topic.endsWith("task_status")) assert.ok(stamp > instants[i] - kLate, `${topic} is ${instants[i] - stamp} ms old`);
      const record = found.get(topic).get(sample.stamp);
      assert.ok(record, `${topic}: the sample ${sample.stamp} was not recorded`);
      const expected = plainLeaves(record());
      assert.deepEqual(plainLeaves(sample), expected, topic);
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

test("a large topic is read only while its layer is on", async () => {
  const drawing = await launchBrowser(), page = await drawing.newPage({ viewport: { width: 640, height: 620 } });
  await page.goto(`${address}?layers=gaze`);
  await until(page, () => window.handsel?.frames > 0 && window.handsel.received("handsel/human_state") > 20, undefined, kPatience);
  assert.equal(await page.evaluate(() => window.handsel.received("handsel/costmap")), 0, "the cost map is read without its layer");
  await page.click("#layer-list input[value=costs]");
  await until(page, () => window.handsel.received("handsel/costmap") > 1, undefined, kPatience);
  await drawing.close();
});
