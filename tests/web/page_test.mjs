// SPDX-License-Identifier: Apache-2.0
// The page over a running system, in a headless browser: what it draws, that its numbers are those on DDS, what it says when something is missing.
import assert from "node:assert/strict";
import { mkdir } from "node:fs/promises";
import { dirname } from "node:path";
import test, { after, before } from "node:test";
import { setTimeout as delay } from "node:timers/promises";
import { difference, kNoGl, launchBrowser, picture, Program, settled, startSystem, until } from "./stage.mjs";

const kDomain = process.env.HANDSEL_TEST_DOMAIN ?? "38";
const kAngle = 1e-3;       // [rad] what is shown may differ from DDS by so much
const kPatience = 60_000;  // [ms] for a condition to come true
const kProcesses = 12;
const kFull = { width: 1280, height: 800 }, kSmall = { width: 640, height: 480 };  // [px] without a GPU a small picture is drawn more often

let system, address, browser, page, echo;
const complaints = [], strangers = [];
const onDds = new Map();  // stamp -> every RobotState on DDS since the echo began, as a line of JSON

before(async () => {
  ({ system, address } = await startSystem("up", kDomain));
  echo = new Program("handsel", ["topic", "echo", "robot_state", "--domain", kDomain]);
  echo.onLine = (line) => {
    echo.lines.length = 0;
    const stamp = line.match(/"stamp":(\d+)/)?.[1];
    if (stamp) onDds.set(stamp, line);
  };
  browser = await launchBrowser();
  page = await open(browser);
  await until(page, () => window.handsel.frames > 0 && document.querySelectorAll("#health .dot.ok").length > 0);
  await settled(page);
});

after(async () => {
  await browser?.close();
  await echo?.end();
  await system?.end();
});

async function open(where, size = kFull) {
  const opened = await where.newPage({ viewport: size, colorScheme: "light" });
  opened.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  opened.on("pageerror", (error) => complaints.push(String(error)));
  opened.on("request", (request) => !/^(data|blob):/.test(request.url()) && !request.url().startsWith(address) && strangers.push(request.url()));
  await opened.goto(address);
  await until(opened, () => window.handsel?.connected);
  return opened;
}

// What the page drew beside what DDS said for the same stamp; undefined when DDS' sample was not among those heard.
function compare({ stamp, angles }) {
  const line = onDds.get(stamp);
  if (!line) return undefined;
  const { position } = JSON.parse(line);
  const shown = Object.values(angles);
  assert.equal(shown.length, position.length);
  return { stamp, shown, worst: Math.max(...shown.map((angle, i) => Math.abs(angle - position[i]))) };
}

const speed = async (percent) => assert.equal(await new Program("handsel", ["speed", percent, "--domain", kDomain]).ended, 0);

const drawnNow = () => page.evaluate(() => ({ stamp: window.handsel.stamp, angles: window.handsel.angles }));

// Begins to note in the page every stamp drawn and every text of these elements; the function returned ends that and returns both.
async function record(ids) {
  await page.evaluate((noted) => {
    const texts = Object.fromEntries(noted.map((id) => [id, []])), drawn = [];
    const note = () => {
      const { stamp, angles } = window.handsel;
      if (drawn.at(-1)?.stamp !== stamp) drawn.push({ stamp, angles });
      for (const id of noted) {
        const text = document.getElementById(id).textContent;
        if (!texts[id].includes(text)) texts[id].push(text);
      }
      window.recorder = { texts, drawn, frame: requestAnimationFrame(note) };
    };
    note();
  }, ids);
  return () => page.evaluate(() => {
    cancelAnimationFrame(window.recorder.frame);
    return window.recorder;
  });
}

test("robot, person and object are drawn where they are said to be", async () => {
  await until(page, () => ["robot", "person", "object"].every((part) => window.handsel.region(part)));
  const drawn = async (hidden) => {
    const frames = await page.evaluate((parts) => {
      window.handsel.hide(parts);
      return window.handsel.frames;
    }, hidden);
    await until(page, (before) => window.handsel.frames > before, frames);
  };
  for (const [part, least] of [["robot", 0.15], ["person", 0.25], ["object", 0.25]]) {
    const region = await page.evaluate((name) => window.handsel.region(name), part);
    const others = ["robot", "person", "object"].filter((name) => name !== part);
    await drawn(others);
    const shown = await picture(page, region);
    await drawn([...others, part]);
    const background = await picture(page, region);
    const ratio = await difference(page, shown, background);
    console.log(`${part}: ${(100 * ratio).toFixed(0)} % of ${Math.round(region.width)}x${Math.round(region.height)} pixels are not background`);
    assert.ok(region.width > 8 && region.height > 8, `${part} is too small to see`);
    assert.ok(ratio >= least, `${part}: only ${ratio} of its region`);
  }
  await drawn([]);
});

test("while it hands over, the angles drawn are those on DDS at the same stamp, and the tables tell the story", async () => {
  if (!process.env.HANDSEL_PICTURE) await page.setViewportSize(kSmall);
  await speed("40");  // so that a slow browser draws enough of the motion
  const recorded = await record(["phase", "speed", "separation", "separation-limit"]);
  const task = new Program("handsel", ["task", "give", "mug", "--domain", kDomain]);
  if (process.env.HANDSEL_PICTURE) {
    await until(page, () => document.getElementById("phase").textContent === "carry" && /\d/.test(document.getElementById("speed").textContent));
    await mkdir(dirname(process.env.HANDSEL_PICTURE), { recursive: true });
    await page.screenshot({ path: process.env.HANDSEL_PICTURE });
  }
  const ended = await task.ended;
  await speed("100");
  assert.equal(ended, 0, task.lines.join("\n"));
  const { drawn, texts } = await recorded();
  const seen = drawn.map(compare).filter(Boolean);
  const moved = Math.max(...seen[0].shown.map((_, i) => Math.max(...seen.map(({ shown }) => shown[i])) - Math.min(...seen.map(({ shown }) => shown[i]))));
  const worst = Math.max(...seen.map((sample) => sample.worst));
  console.log(`moving: ${drawn.length} stamps drawn, ${seen.length} of them heard on DDS, the axes moved up to ${moved.toFixed(2)} rad, largest difference ${worst.toExponential(1)} rad`);
  assert.ok(seen.length >= 8 && moved >= 0.3, "too few matching stamps, or the arm did not move");
  assert.ok(worst <= kAngle);
  assert.ok(texts.phase.filter(Boolean).length >= 3, `phases shown: ${texts.phase}`);
  assert.ok(texts.speed.some((text) => /^\d+ %$/.test(text)), `speeds shown: ${texts.speed}`);
  assert.ok(texts.separation.some((text) => /^\d\.\d\d m$/.test(text)), `distances shown: ${texts.separation}`);
  assert.ok(texts["separation-limit"].filter((text) => /^limit \d\.\d\d m$/.test(text)).length >= 2, `limit of the separation as shown: ${texts["separation-limit"]}`);
});

test("at rest the angles drawn and written are those on DDS", async () => {
  await until(page, () => document.querySelector("#task-state").textContent === "succeeded" && document.querySelector("#speed").textContent === "at rest");
  assert.deepEqual(await page.$$eval("#plan td:last-child", (cells) => cells.map((cell) => `${cell.className}: ${cell.textContent}`)), [
    "done depth-0: give mug to somebody",
    "done depth-1: give mug to anna",
    "done depth-2: fetch mug",
    "done depth-3: pick mug for anna",
    "done depth-2: bring mug to anna",
    "done depth-3: give mug to anna",
    "done depth-2: go to rest",
  ]);
  // Words and picture follow the robot after a delay: both come to rest where the newest sample on DDS has the robot.
  const written = () => page.$$eval("#joints tr", (rows) => rows.map((row) => Number(row.lastElementChild.textContent)));
  let sample, shown;
  const differs = () => shown.some((angle, i) => !(Math.abs(angle - sample.shown[i]) <= kAngle));
  for (const begin = Date.now(); Date.now() - begin < kPatience; await delay(50)) {
    const { angles } = await drawnNow();
    const [newest] = [...onDds].at(-1);
    sample = compare({ stamp: newest, angles });
    shown = await written();
    if (sample.worst <= kAngle && !differs()) break;
  }
  assert.ok(sample.worst <= kAngle, `${sample.worst} rad`);
  assert.equal(shown.length, 7);
  assert.ok(!differs(), `${shown} written, ${sample.shown} drawn`);
  console.log(`at rest: largest difference ${sample.worst.toExponential(1)} rad`);
});

test("every process is listed and healthy", async () => {
  await until(page, (count) => document.querySelectorAll("#health .dot.ok").length === count, kProcesses);
  assert.equal(await page.locator("#health tr:has(.dot.ok) td:nth-child(5).warn").count(), 0, "a healthy process has a warning for past misses");
  assert.equal(await page.textContent("#mode"), "normal");
  assert.equal(await page.textContent("#drive"), "drives on");
  assert.equal(await page.locator("#clocks tr").count(), 7);
});

test("a narrow window needs no scrolling sideways", async () => {
  await page.setViewportSize({ width: 480, height: 900 });
  await until(page, () => document.querySelector("#stage canvas").clientWidth < 480);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await page.setViewportSize(kSmall);
});

test("a browser without WebGL is told so in one sentence and the tables work", async () => {
  const plain = await launchBrowser(kNoGl);
  try {
    const bare = await open(plain);
    await until(bare, (count) => document.querySelectorAll("#health tr").length === count, kProcesses);
    const sentence = await bare.textContent("#stage-note");
    assert.match(sentence, /^This browser cannot draw the 3-D view \(WebGL [^.]*\.$/);
    assert.ok(await bare.isVisible("#stage-note"));
    assert.equal(await bare.evaluate(() => window.handsel.webgl), false);
    await until(bare, () => /^-?\d+\.\d{4}$/.test(document.querySelector("#joints tr")?.lastElementChild.textContent ?? ""));
  } finally {
    await plain.close();
  }
});

test("nothing was fetched from elsewhere and nothing was complained about", () => {
  assert.deepEqual(strangers, []);
  assert.deepEqual(complaints, []);
});

test("a lost connection is said, and the page comes back by itself", async () => {
  const health = new Program("handsel", ["topic", "echo", "component_health", "--domain", kDomain]);
  const match = await health.line(/"component":"bridge"/);
  await health.end();
  // The bridge may be back before the test looks again.
  await page.evaluate(() => {
    window.said = [];
    const link = document.getElementById("link"), problem = document.getElementById("problem");
    const note = () => window.said.push({ link: link.className, problem: problem.hidden ? "" : problem.textContent });
    new MutationObserver(note).observe(document.body, { subtree: true, childList: true, characterData: true, attributeFilter: ["class", "hidden"] });
  });
  process.kill(JSON.parse(match.input).pid, "SIGKILL");
  await until(page, () => window.said.some(({ link, problem }) => link === "lost" && /connection to the bridge is lost/.test(problem)));
  await until(page, () => document.querySelector("#link").className === "live" && document.querySelector("#problem").hidden);
});
