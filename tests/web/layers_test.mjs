// SPDX-License-Identifier: Apache-2.0
// The layers of the 3-D view over a running system: each changes the pixels of its region when it is switched on, the choice is kept, and large topics are read only while they are shown.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { difference, launchBrowser, picture, Program, settled, startSystem, until } from "./stage.mjs";

const kDomain = process.env.HANDSEL_TEST_DOMAIN ?? "41";
const kSize = { width: 640, height: 620 };  // [px] without a GPU a small picture is drawn more often
const kTries = 5;                           // pictures of a robot and a person that move a little
let system, address, browser, page;

before(async () => {
  ({ system, address } = await startSystem("up", kDomain));
  browser = await launchBrowser();
  page = await open("");
  await settled(page);
});

after(async () => {
  await browser?.close();
  await system?.end();
});

async function open(query, context) {
  const opened = await (context ?? await browser.newContext({ viewport: kSize, colorScheme: "light" })).newPage();
  await opened.goto(address + query);
  await until(opened, () => window.handsel?.connected && window.handsel.frames > 0);
  return opened;
}

// Runs a command of `handsel` to its end.
async function run(...args) {
  assert.equal(await new Program("handsel", [...args, "--domain", kDomain]).ended, 0, args.join(" "));
}

// Switches layers and waits until that is drawn.
async function drawn(layers) {
  const frames = await page.evaluate((wanted) => {
    for (const [id, on] of Object.entries(wanted)) window.handsel.layer(id, on);
    return window.handsel.frames;
  }, layers);
  await until(page, (before) => window.handsel.frames > before, frames);
}

const off = Object.fromEntries(["path", "handover", "gaze", "forecast", "grasps", "costs", "zones"].map((id) => [id, false]));

// Checks that at least a ratio `least` of the pixels in the layer's region is drawn by the layer, three times as many as change without it.
async function isSeen(id, least) {
  await drawn({ ...off, [id]: true });
  await until(page, (layer) => window.handsel.region(layer), id);
  const { x, y, width, height } = await page.evaluate((layer) => window.handsel.region(layer), id);
  const grown = { x: Math.max(0, x - 4), y: Math.max(0, y - 4), width: width + 8, height: height + 8 };
  let layer = 0, noise = 1;
  for (let i = 0; i < kTries && !(layer >= least && layer > 3 * noise); ++i) {
    await drawn({ [id]: true });
    const on = await picture(page, grown);
    await drawn({ [id]: false });
    const without = await picture(page, grown);
    layer = await difference(page, on, without);
    noise = await difference(page, without, await picture(page, grown));
  }
  console.log(`${id}: ${(100 * layer).toFixed(1)} % of ${Math.round(width)}x${Math.round(height)} pixels, ${(100 * noise).toFixed(1)} % without it`);
  assert.ok(layer >= least && layer > 3 * noise, `${id}: ${layer} of its region, ${noise} without it`);
}

test("gaze, forecast, zones and costs of a present person are drawn in their regions", async () => {
  await isSeen("gaze", 0.1);
  await isSeen("forecast", 0.2);
  await isSeen("zones", 0.01);
  await isSeen("costs", 0.2);
});

test("a large topic is read only while its layer is on", async () => {
  const count = () => page.evaluate(() => window.handsel.received("handsel/costmap"));
  await drawn(off);
  const before = await count();
  await new Promise((resolve) => setTimeout(resolve, 1500));
  assert.ok((await count()) - before <= 1, "the cost map is read without its layer");
  await drawn({ costs: true });
  await until(page, (seen) => window.handsel.received("handsel/costmap") > seen + 1, before);
  await drawn(off);
});

test("grasps, trajectory and planned handover of a task are drawn in their regions", async () => {
  await drawn({ ...off, grasps: true });
  const task = new Program("handsel", ["task", "give", "mug", "--domain", kDomain]);
  await until(page, () => window.handsel.region("grasps"));
  await run("task", "pause");
  await isSeen("grasps", 0.02);
  await run("task", "resume");
  await drawn({ ...off, path: true, handover: true });
  await until(page, () => document.getElementById("phase").textContent === "carry" && window.handsel.region("path") && window.handsel.region("handover"));
  await run("task", "pause");
  await isSeen("path", 0.02);
  await isSeen("handover", 0.1);
  await run("task", "resume");
  assert.equal(await task.ended, 0);
  await drawn({ path: true, handover: true });
  await until(page, () => !window.handsel.region("path") && !window.handsel.region("handover"));
});

test("the choice of layers is in the address and kept by the browser", async () => {
  await drawn({ ...off, zones: true, gaze: true });
  assert.equal(new URL(page.url()).searchParams.get("layers"), "gaze,zones");
  const again = await open("", page.context());
  assert.deepEqual(await again.$$eval("#layer-list input:checked", (boxes) => boxes.map((box) => box.value)), ["gaze", "zones"]);
  await again.click("#layer-list input[value=zones]");
  assert.equal(new URL(again.url()).searchParams.get("layers"), "gaze");
  const other = await open("?layers=costs");
  assert.deepEqual(await other.$$eval("#layer-list input:checked", (boxes) => boxes.map((box) => box.value)), ["costs"]);
});
