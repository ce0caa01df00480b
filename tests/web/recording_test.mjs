// SPDX-License-Identifier: Apache-2.0
// The page opens a recording of a handover in virtual time: each instant is shown as recorded, each layer changes the pixels of its region, events and plots have what happened, and of a killed recording nearly all is shown.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { plainLeaves, recordedSamples } from "./recorded.mjs";
import { difference, launchBrowser, picture, Program, settled, until } from "./stage.mjs";

const kDomain = process.env.HANDSEL_TEST_DOMAIN ?? "43";
const kTrial = ["eval", "--scenario", "trial_give", "--replay", "17", "--record"];
const kTopics = ["robot_state", "scene", "human_state", "active_trajectory", "execution_status", "task_status", "action_status", "attention_advice"].map((topic) => `handsel/${topic}`);
const kSize = { width: 640, height: 760 };  // [px] without a GPU a small picture is drawn more often
const kOld = 1500;                          // [ms] max age of a sample at the instant shown, for topics sent all the time
const kStill = 0.003;                       // max ratio of pixels that differ between two pictures of one instant
const kLayers = ["path", "handover", "gaze", "forecast", "grasps", "costs", "zones"];
const kCarry = readFileSync(new URL("../../idl/task.idl", import.meta.url), "utf8").match(/ACTION_PHASE_\w+/g).indexOf("ACTION_PHASE_CARRY");
const folder = mkdtempSync(join(tmpdir(), "handsel-test-")), file = join(folder, "trial.mcap"), killed = join(folder, "killed.mcap");
let bridge, address, browser, page, found, begin, killedAt;

before(async () => {
  const trial = new Program("handsel", [...kTrial, file]), other = new Program("handsel", [...kTrial, killed]);
  killedAt = Number((await other.line(/^ *(\d+\.\d+) s {2}.*pick reaching/))[1]);
  other.child.kill("SIGKILL");
  await trial.ended;
  found = recordedSamples(readFileSync(file), kTopics);
  process.env.HANDSEL_WEB_PORT = "0";
  bridge = new Program("handsel_bridge", ["--domain", kDomain]);
  [, address] = await bridge.line(/page is at (http:\S+)/);
  browser = await launchBrowser();
  page = await (await browser.newContext({ viewport: kSize, colorScheme: "light" })).newPage();
  await page.goto(address);
  await until(page, () => window.handsel?.connected && window.handsel.frames > 0);
  await settled(page);
  await open(file);
  [begin] = await page.evaluate(() => window.handsel.kept);
});

after(async () => {
  await browser?.close();
  await bridge?.end();
  rmSync(folder, { recursive: true });
});

const note = (pattern) => until(page, (source) => new RegExp(source).test(document.getElementById("recording-note").textContent), pattern.source);

async function open(name, sentence = /is shown|shown up to/) {
  await page.evaluate(() => (document.getElementById("recording-note").textContent = ""));
  await page.setInputFiles("#recording-file", name);
  await note(sentence);
}

// Shows the instant `seconds` after the begin of the recording, once it is drawn.
async function show(seconds) {
  const time = begin + 1000 * seconds;
  await page.evaluate((at) => (window.handsel.time = at), time);
  await until(page, (at) => window.handsel.time === at && window.handsel.stamp === window.handsel.sample("handsel/robot_state").stamp, time);
  return time;
}

test("each instant is shown as it was recorded, field by field", async () => {
  let fields = 0;
  for (const seconds of [1.3, 4.9, 9.4, 13.2, 15.7, 17.1]) {
    const time = await show(seconds);
    const { samples, angles } = await page.evaluate((topics) => ({ samples: Object.fromEntries(topics.map((topic) => [topic, window.handsel.sample(topic)])), angles: Object.values(window.handsel.angles) }), kTopics);
    for (const topic of kTopics) {
      const stamp = Number(samples[topic].stamp) / 1e6, record = found.get(topic).get(samples[topic].stamp);
      assert.ok(stamp <= time + 1e-3, `${topic} is from after the instant shown`);
      if (topic !== "handsel/task_status") assert.ok(stamp > time - kOld, `${topic} is ${time - stamp} ms old`);
      assert.ok(record, `${topic}: the sample ${samples[topic].stamp} was not recorded`);
      const expected = plainLeaves(record());
      assert.deepEqual(plainLeaves(samples[topic]), expected, topic);
      fields += Object.keys(expected).length;
    }
    const { position } = samples["handsel/robot_state"];
    assert.ok(angles.every((angle, i) => Math.abs(angle - position[i]) < 1e-3), "the robot is drawn elsewhere");
    await until(page, (text) => document.getElementById("separation").textContent === text, `${samples["handsel/execution_status"].separation.toFixed(2)} m`);
  }
  console.log(`6 instants, ${fields} fields equal`);
});

// Switches layers and waits until that is drawn.
async function drawn(layers) {
  const frames = await page.evaluate((wanted) => {
    for (const [id, on] of Object.entries(wanted)) window.handsel.layer(id, on);
    return window.handsel.frames;
  }, layers);
  await until(page, (before) => window.handsel.frames > before, frames);
}
const off = Object.fromEntries(kLayers.map((id) => [id, false]));

for (const [id, seconds, least] of [["path", 4, 0.02], ["handover", 15.3, 0.04], ["gaze", 3, 0.1], ["forecast", 3, 0.15], ["grasps", 1.5, 0.02], ["costs", 3, 0.15], ["zones", 3, 0.01]]) {
  test(`the layer ${id} is drawn in its region`, async () => {
    await show(seconds);
    await drawn({ ...off, [id]: true });
    await until(page, (layer) => window.handsel.region(layer), id);
    const { x, y, width, height } = await page.evaluate((layer) => window.handsel.region(layer), id);
    const grown = { x: Math.max(0, x - 4), y: Math.max(0, y - 4), width: width + 8, height: height + 8 };
    const on = await picture(page, grown);
    await drawn({ [id]: false });
    const without = await picture(page, grown);
    await drawn(off);
    const ratio = await difference(page, on, without), noise = await difference(page, without, await picture(page, grown));
    console.log(`${id}: ${(100 * ratio).toFixed(1)} % of ${Math.round(width)}x${Math.round(height)} pixels, ${(100 * noise).toFixed(1)} % without it`);
    assert.ok(ratio >= least, `only ${ratio} of its region`);
    assert.ok(noise <= kStill, `${noise} changes without it`);
  });
}

test("the choice of layers is in the address and kept by the browser", async () => {
  await drawn({ ...off, zones: true, gaze: true });
  assert.equal(new URL(page.url()).searchParams.get("layers"), "gaze,zones");
  const chosen = (where) => where.$$eval("#layer-list input:checked", (boxes) => boxes.map((box) => box.value));
  const again = await page.context().newPage();
  await again.goto(address);
  await again.waitForSelector("#layer-list input");
  assert.deepEqual(await chosen(again), ["gaze", "zones"]);
  await again.goto(`${address}?layers=costs`);
  await again.waitForSelector("#layer-list input");
  assert.deepEqual(await chosen(again), ["costs"]);
  await again.close();
});

test("events and plots have what happened", async () => {
  const events = await page.evaluate(() => window.handsel.events), texts = events.map(({ kind, text }) => `${kind}: ${text}`);
  for (const expected of [/^task: give: running/, /^task: approach$/, /^task: carry$/, /^task: offer$/, /^mode: slow/, /^mode: normal/, /^cause: separation begins/, /^cause: separation ends/, /^fact: .* holds/, /^attention: /])
    assert.ok(texts.some((text) => expected.test(text)), `${expected} is missing in ${texts.slice(0, 40).join("; ")}`);
  const carry = events.find(({ text }) => text === "carry");
  const recorded = [...found.get("handsel/action_status").entries()].map(([stamp, record]) => ({ time: Number(stamp) / 1e6, phase: record().phase }));
  const begun = recorded.filter(({ phase }, i) => phase !== recorded[i - 1]?.phase).map(({ time }) => Math.abs(carry.time - time));
  assert.ok(recorded.some(({ time, phase }) => Math.abs(carry.time - time) < 300 && phase === kCarry), `no recorded action carries at ${carry.time - begin} ms`);
  assert.ok(Math.min(...begun) < 300, `no phase of the recorded action begins near ${carry.time - begin} ms`);
  await page.click("#event-card summary");
  await show((carry.time - begin) / 1000 + 0.1);
  await until(page, () => [...document.querySelectorAll("#events li")].some((row) => / {2}carry$/.test(row.textContent)));
  const curves = await page.evaluate(() => window.handsel.curves), largest = (id) => Math.max(...curves.find((one) => one.id === id).points.flat().filter(Number.isFinite).map(Math.abs));
  for (const id of ["position", "velocity", "acceleration", "jerk"]) assert.ok(largest(id) > 0.02 && largest(id) <= 1.001, `${id}: ${largest(id)} of its limit`);
  const [distance, limit] = curves.find(({ id }) => id === "separation").points;
  assert.ok(distance.some((value, i) => value > 0 && limit[i] > 0), "no separation is plotted");
  await page.click("#plot-card summary");
  await until(page, () => document.querySelectorAll("#plots .uplot").length === 6);
});

test("a killed recording opens up to its last second, what is no recording is refused", async () => {
  await open(killed, /^killed\.mcap does not end as a complete recording; it is shown up to its last complete record\.$/);
  const [from, to] = await page.evaluate(() => window.handsel.kept);
  console.log(`killed at ${killedAt} s: ${((to - from) / 1000).toFixed(1)} s are shown`);
  assert.ok(to - from > 1000 * killedAt - 1000);
  writeFileSync(killed, "no recording");
  await open(killed, /^killed\.mcap holds no samples of a robot.*\.$/);
  await page.click("#live");
  await until(page, () => !document.body.classList.contains("recorded") && document.getElementById("shown-time").textContent === "live");
});
