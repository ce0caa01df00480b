// SPDX-License-Identifier: Apache-2.0
// Taking part from the page over a running system: who may, tasks and requests, actions of the simulated person, and a dragged hand that slows the robot.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { kNoGl, launchBrowser, Program, settled, startSystem, until } from "./stage.mjs";

const kDomain = process.env.HANDSEL_TEST_DOMAIN ?? "39";
const kSize = { width: 1000, height: 620 };  // [px] without a GPU a small picture is drawn more often
const kPatience = 60_000;                    // [ms] for a condition to come true
const kSpeed = 0.15;                         // speed override while a slow browser must keep up with the arm
const kStopped = 0.05;                       // speed factor below which the arm counts as stopped
const kDragged = 0.2;                        // [m] the hand is dragged at least so far
const kSeparation = 1 << 7;                  // cause of ExecutionStatus
const kOfPage = 2;                           // low byte of the id of a task that the page has given

let system, address, token, browser, page, cancelled;
const echoes = [];

// The newest sample of a topic on DDS, as JSON, and all of them while `kept` is set.
class Echo {
  constructor(topic) {
    this.samples = [];
    this.program = new Program("handsel", ["topic", "echo", topic, "--domain", kDomain]);
    this.program.onLine = (line) => {
      this.program.lines.length = 0;
      if (!line.startsWith("{")) return;
      this.newest = JSON.parse(line);
      this.samples.push(this.newest);
      if (this.samples.length > 20_000) this.samples.shift();
    };
    echoes.push(this.program);
  }
}
let goals, controls, execution, active, people, tasks, action;

before(async () => {
  ({ system, address, token } = await startSystem("up", kDomain));
  [goals, controls, execution, active, people, tasks, action] =
    ["task_goal", "sim_control", "execution_status", "active_trajectory", "human_state", "task_status", "action_status"].map((topic) => new Echo(topic));
  browser = await launchBrowser();
  page = await open(browser, `#token=${token}`);
});

after(async () => {
  await browser?.close();
  for (const echo of echoes) await echo.end();
  await system?.end();
});

const usable = (where) => until(where, () => window.handsel?.connected && document.querySelectorAll("#task-object option").length > 0);

async function open(where, fragment) {
  const opened = await (await where.newContext({ viewport: kSize, colorScheme: "light" })).newPage();
  await opened.goto(address + fragment);
  await usable(opened);
  return opened;
}

const post = async (headers, command) => {
  const answer = await fetch(`${address}command`, { method: "POST", headers, body: JSON.stringify(command) });
  return { status: answer.status, text: await answer.text() };
};

// Waits for a condition over what is on DDS.
async function onDds(condition, what) {
  for (const begin = Date.now(); Date.now() - begin < kPatience;) {
    const value = condition();
    if (value) return value;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  assert.fail(`on DDS: ${what}; ${JSON.stringify([tasks.newest?.state, tasks.newest?.reason, action.newest?.phase, execution.newest?.mode, execution.newest?.reason])}`);
}

const shows = (page, word) => until(page, (wanted) => document.getElementById("task-state").textContent === wanted, word);
const joint = (name) => people.newest?.people[0]?.joints.find((one) => one.name === name)?.position;
const at = (point) => page.evaluate((p) => window.handsel.pixel(p), point);
const drawn = async (side) => at(await page.evaluate((s) => window.handsel.hand("anna", s), side));
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

test("without the token nothing is commanded, and the page says so", async () => {
  const give = { task: "give", object: "mug" };
  assert.deepEqual((await post({}, give)).status, 401);
  const wrong = await post({ Authorization: `Bearer ${"0".repeat(32)}` }, give);
  assert.equal(wrong.status, 401);
  assert.match(wrong.text, /^the token is not the one of this system; [^.]*$/);
  assert.equal((await post({ Authorization: `Bearer ${token}`, Origin: "https://example.org" }, give)).status, 403);
  const plain = await launchBrowser(kNoGl), bare = await open(plain, "");
  assert.match(await bare.textContent("#steer-note"), /^Read-only\. To take part, open the address/);
  assert.ok(await bare.isVisible("#steer-note"));
  assert.ok(await bare.isDisabled("#task-start"));
  assert.equal(await bare.locator("#requests button:enabled, #person-actions button:enabled").count(), 0);
  const stranger = await open(plain, `#token=${"0".repeat(32)}`);
  await stranger.click("#task-start");
  await until(stranger, () => /^Read-only: the token is not the one of this system/.test(document.getElementById("steer-note").textContent));
  assert.ok(await stranger.isDisabled("#task-start"));
  assert.deepEqual([goals.samples, controls.samples], [[], []]);
  await plain.close();
});

test("a task is started, paused, resumed and cancelled", async () => {
  assert.equal(new URL(page.url()).hash, "", "the token stays in the address");
  await page.reload();
  await usable(page);
  await page.selectOption("#task-kind", "give");
  await page.selectOption("#task-object", "mug");
  await page.selectOption("#task-human", "anna");
  // Slowly, so that the task still runs when a slow browser pauses, resumes and cancels.
  assert.equal((await post({ Authorization: `Bearer ${token}` }, { task: "speed", value: kSpeed })).status, 202);
  await page.click("#task-start");
  await shows(page, "running");
  const goal = await onDds(() => goals.newest, "no goal");
  assert.deepEqual([goal.kind, goal.object, goal.human, goal.id % 256], ["give", "mug", "anna", kOfPage]);
  await page.click("#requests button[value=pause]");
  await shows(page, "paused");
  await onDds(() => ["hold", "stop"].includes(execution.newest?.mode), "not held");
  await page.click("#requests button[value=resume]");
  await shows(page, "running");
  await onDds(() => execution.newest?.mode === "normal" || execution.newest?.mode === "slow", "still held");
  await page.evaluate(() => {
    const slider = document.getElementById("speed-override");
    slider.value = "20";
    slider.dispatchEvent(new Event("change"));
  });
  await onDds(() => goals.samples.some(({ kind, value }) => kind === "speed" && Math.abs(value - 0.2) < 1e-6), "the speed slider sends nothing");
  await page.click("#requests button[value=cancel]");
  await shows(page, "cancelled");
  await onDds(() => tasks.samples.some(({ id, state }) => id === goal.id && state === "cancelled"), "not cancelled");
  assert.equal(await page.textContent("#steer-answer"), "cancel: asked for.");
  assert.equal((await post({ Authorization: `Bearer ${token}` }, { task: "speed", value: 1 })).status, 202);
  await until(page, () => document.getElementById("speed-wanted").textContent === "100 %");
  cancelled = goal.id;
});

test("a refusal is shown", async () => {
  const answer = await post({ Authorization: `Bearer ${token}` }, { task: "give" });
  assert.equal(answer.status, 400);
  assert.equal(answer.text, 'the field "object" is missing\n');
});

// Returns the newest sample whose stamp is at most `stamp`; undefined if there is none.
const atTime = (samples, stamp) => samples.findLast((sample) => sample.stamp <= stamp);

// Returns the first status, after the hand has left `rest`, in which the separation stops the arm, with the hand and the speed factor of that time.
function stopAtHand(rest) {
  for (const status of execution.samples) {
    const hand = atTime(people.samples, status.stamp)?.people[0]?.joints.find(({ name }) => name === "l_hand")?.position;
    const speed = atTime(active.samples, status.stamp)?.speed_factor;
    const stopped = status.causes & kSeparation && speed !== undefined && Math.abs(speed) <= kStopped;
    if (hand && stopped && distance(hand, rest) > kDragged) return { ...status, hand, speed };
  }
  return undefined;
}

test("a hand dragged to the arm stops it, dragged away the arm continues", async () => {
  await settled(page);
  await page.selectOption("#task-kind", "give");
  await page.selectOption("#task-object", "mug");
  await page.click("#task-start");
  const moving = () => Math.abs(active.newest?.speed_factor ?? 0) > kSpeed / 2;
  // The drag begins while the arm is still at the table: carried on, the arm would stop at the resting hand by itself.
  await onDds(() => ["lift", "carry"].includes(action.newest?.phase), "nothing is lifted");
  // Slowly from here, so that a slow browser finds the arm on its path.
  assert.equal((await post({ Authorization: `Bearer ${token}` }, { task: "speed", value: kSpeed })).status, 202);
  await onDds(moving, "the arm does not carry");
  const rest = joint("l_hand");
  const from = await drawn("left");
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  active.samples.length = execution.samples.length = people.samples.length = 0;
  const far = distance(execution.newest.nearest_on_robot, rest);
  let stop, shown;
  for (const begin = Date.now(); Date.now() - begin < kPatience && !(stop && shown);) {
    const to = await at(execution.newest.nearest_on_robot);
    await page.mouse.move(to.x, to.y, { steps: 3 });
    stop ??= stopAtHand(rest);
    const texts = await page.evaluate(() => ["speed", "mode", "reaction", "separation"].map((id) => document.getElementById(id).textContent));
    if (stop && /^\d+ %$/.test(texts[0]) && Number.parseInt(texts[0], 10) <= 100 * kStopped) shown = texts;
  }
  assert.ok(stop, "the robot does not stop for the hand");
  console.log(`dragged from ${far.toFixed(2)} m: causes ${stop.causes}, ${stop.separation} of ${stop.separation_limit} m at ${stop.speed}, hand ${JSON.stringify(stop.hand)} from ${JSON.stringify(rest)}; shown: ${shown}`);
  assert.ok(far > stop.separation_limit + kDragged, "the drag began at the arm");
  assert.ok(distance(stop.nearest_on_person, stop.hand) < 0.2, "the robot does not stop for the hand");
  assert.ok(shown, "the page does not show the stop");
  assert.match(shown[2], /^Robot at [0-5] % · \d\.\d\d m of at least \d\.\d\d m · .*separation/);
  // Away from the arm, to the side of the person.
  const aside = await at([1.5, -0.05, 0.8]);
  await page.mouse.move(aside.x, aside.y, { steps: 5 });
  await until(page, (least) => Number.parseInt(document.getElementById("speed").textContent, 10) >= least, 50 * kSpeed);
  await onDds(moving, "the arm does not continue");
  await page.mouse.up();
  assert.equal((await post({ Authorization: `Bearer ${token}` }, { task: "speed", value: 1 })).status, 202);
  await onDds(() => tasks.samples.some(({ id, kind, state }) => kind === "give" && id !== cancelled && state === "succeeded"), "not given");
  assert.ok(controls.samples.some(({ action, value }) => action === "person_hand" && value === 0), "the end of the drag was not sent");
  await onDds(() => distance(joint("l_hand"), rest) < 0.1 || tasks.newest.state === "succeeded", "the hand does not go back");
});

test("a finger drags a hand too, which goes back without it", async () => {
  const finger = await page.context().newCDPSession(page), from = await drawn("left"), before = joint("l_hand");
  const touch = (type, touchPoints) => finger.send("Input.dispatchTouchEvent", { type, touchPoints });
  await touch("touchStart", [from]);
  for (let i = 1; i <= 10; ++i) await touch("touchMove", [{ x: from.x, y: from.y - 8 * i }]);
  await onDds(() => joint("l_hand")[2] > before[2] + 0.1, "the hand does not follow the finger");
  await touch("touchEnd", []);
  await onDds(() => distance(joint("l_hand"), before) < 0.05, "the hand does not go back");
});

test("the person looks away and leaves when asked to", async () => {
  const gaze = () => people.newest.people[0].gaze_direction;
  const before = gaze();
  await page.click("#person-actions button[value=look_away]");
  await onDds(() => gaze() && distance(gaze(), before) > 0.4, "anna does not look away");
  assert.match(await page.textContent("#steer-answer"), /^anna: Look away\.$/);
  const torso = joint("torso");
  await page.click("#person-actions button[value=leave]");
  await onDds(() => !joint("torso") || distance(joint("torso"), torso) > 0.5, "anna does not leave");
});
