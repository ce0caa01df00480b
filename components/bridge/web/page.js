// Shows the newest state from /events. Keeps it in window.handsel for whoever looks from outside.
"use strict";

const bones = [["head", "neck"], ["neck", "torso"], ["torso", "waist"], ["neck", "l_shoulder"], ["l_shoulder", "l_elbow"], ["l_elbow", "l_wrist"],
  ["l_wrist", "l_hand"], ["neck", "r_shoulder"], ["r_shoulder", "r_elbow"], ["r_elbow", "r_wrist"], ["r_wrist", "r_hand"], ["waist", "l_hip"],
  ["l_hip", "l_knee"], ["l_knee", "l_ankle"], ["waist", "r_hip"], ["r_hip", "r_knee"], ["r_knee", "r_ankle"]];
const silentAfter = 0.6;  // [s] without a sign of life
const byId = (id) => document.getElementById(id);
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const metres = (value) => (value === null || value === undefined ? "nobody near" : value.toFixed(2) + " m");

window.handsel = { state: null, updates: 0, connected: false };

function put(id, text) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}

// A view onto the world: axes are indices of the horizontal and vertical coordinate.
function makeView(canvas, axes, low, high) {
  const context = canvas.getContext("2d");
  const scale = Math.min(canvas.width / (high[0] - low[0]), canvas.height / (high[1] - low[1]));
  const left = (canvas.width - scale * (high[0] - low[0])) / 2, bottom = (canvas.height - scale * (high[1] - low[1])) / 2;
  const at = (p) => [left + scale * (p[axes[0]] - low[0]), canvas.height - bottom - scale * (p[axes[1]] - low[1])];
  return { context, canvas, scale, at, axes };
}

function line(view, points, colour, width) {
  const c = view.context;
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.lineCap = c.lineJoin = "round";
  c.beginPath();
  points.forEach((p, i) => { const [x, y] = view.at(p); if (i) c.lineTo(x, y); else c.moveTo(x, y); });
  c.stroke();
}

function disc(view, p, radius, colour) {
  const [x, y] = view.at(p);
  view.context.fillStyle = colour;
  view.context.beginPath();
  view.context.arc(x, y, Math.max(radius * view.scale, 2), 0, 2 * Math.PI);
  view.context.fill();
}

function label(view, p, text) {
  const [x, y] = view.at(p);
  view.context.fillStyle = css("--ink");
  view.context.font = "20px system-ui, sans-serif";
  view.context.fillText(text, x + 10, y - 10);
}

function drawBox(view, box) {
  const [a, b] = view.axes, c = Math.cos(box.yaw), s = Math.sin(box.yaw);
  const corners = [];
  for (const i of [-0.5, 0.5]) for (const j of [-0.5, 0.5]) for (const k of [-0.5, 0.5]) {
    const x = i * box.size[0], y = j * box.size[1];
    corners.push([box.p[0] + c * x - s * y, box.p[1] + s * x + c * y, box.p[2] + k * box.size[2]]);
  }
  const around = b === 2 ? null : [0, 4, 6, 2].map((i) => corners[i]);
  const low = [Math.min(...corners.map((p) => p[a])), Math.min(...corners.map((p) => p[b]))];
  const high = [Math.max(...corners.map((p) => p[a])), Math.max(...corners.map((p) => p[b]))];
  const flat = (h, v) => { const p = [0, 0, 0]; p[a] = h; p[b] = v; return p; };
  const outline = around || [flat(low[0], low[1]), flat(high[0], low[1]), flat(high[0], high[1]), flat(low[0], high[1])];
  line(view, [...outline, outline[0]], css("--quiet"), 3);
}

function draw(view, state) {
  view.context.clearRect(0, 0, view.canvas.width, view.canvas.height);
  for (const box of state.boxes) drawBox(view, box);
  for (const person of state.people) {
    for (const [from, to] of bones) {
      if (person.joints[from] && person.joints[to]) line(view, [person.joints[from], person.joints[to]], css("--warn"), 0.07 * view.scale);
    }
    if (person.joints.head) { disc(view, person.joints.head, 0.11, css("--warn")); label(view, person.joints.head, person.id); }
    if (person.gaze) line(view, [person.gaze[0], person.gaze[0].map((v, i) => v + 0.5 * person.gaze[1][i])], css("--quiet"), 2);
  }
  if (state.robot) {
    if (state.robot.path.length) line(view, state.robot.path, css("--good"), 3);
    for (const [from, to, radius] of state.robot.shapes) line(view, [from, to], css("--accent") + "99", Math.max(2 * radius * view.scale, 2));
  }
  for (const object of state.objects) { disc(view, object.p, 0.04, css("--bad")); label(view, object.p, object.id); }
  if (state.separation && state.separation.line) line(view, state.separation.line, css("--bad"), 2);
  if (state.action && state.action.exchange) disc(view, state.action.exchange, 0.02, css("--good"));
}

function fillTable(table, head, rows) {
  const fragment = document.createDocumentFragment();
  const add = (cells, kind) => {
    const row = document.createElement("tr");
    for (const cell of cells) {
      const element = document.createElement(kind);
      element.textContent = cell.text === undefined ? cell : cell.text;
      if (cell.className) element.className = cell.className;
      row.append(element);
    }
    fragment.append(row);
  };
  add(head, "th");
  for (const row of rows) add(row, "td");
  table.replaceChildren(fragment);
}

function show(state) {
  const execution = state.execution;
  const mode = execution ? (execution.age > silentAfter ? "silent" : execution.mode) : "unknown";
  put("mode", mode);
  byId("mode").dataset.mode = mode;
  put("causes", execution ? execution.causes.join(", ").replaceAll("_", " ") : "");
  const task = state.task;
  put("task", task ? [task.kind, task.state, state.action ? state.action.phase : "", task.reason].filter(Boolean).join(" · ") : "no task yet");
  byId("plan").replaceChildren(...(task ? task.plan : []).map((text, i) => {
    const item = document.createElement("li");
    item.textContent = text;
    item.className = i < task.step ? "past" : i === task.step ? "now" : "";
    return item;
  }));
  byId("speed").value = Math.abs(state.speed_factor || 0);
  put("speed-text", state.speed_factor === undefined ? "" : state.speed_factor.toFixed(2));
  put("separation", state.separation ? metres(state.separation.distance) : "unknown");
  put("forecast", state.forecast ? (state.forecast.collides ? `in ${state.forecast.time} s: ${state.forecast.reason}` : "clear") : "unknown");
  put("advice", state.advice ? `${state.advice.speed_factor.toFixed(2)} ${state.advice.reason}` : "none");
  put("share", execution ? execution.share.map((value) => Math.round(100 * value) + " %").join(", ") : "");
  put("cycles", execution ? `${execution.cycles}, late ${execution.late}` : "");
  fillTable(byId("clocks"), ["behaviour", "period", "asks for"],
    state.clocks.map((c) => [c.behaviour, c.period.toFixed(3) + " s", c.released ? c.speed_factor.toFixed(2) : "–"]));
  fillTable(byId("health"), ["process", "state", "samples/s", "misses", "rejected", "cpu", "memory", ""],
    state.health.map((h) => {
      const word = h.age > silentAfter ? "silent" : h.state;
      return [h.component, { text: word, className: word }, h.rate.toFixed(0), h.misses, h.rejected, (100 * h.cpu).toFixed(0) + " %", h.memory.toFixed(0) + " MB", h.reason];
    }));
}

const views = [makeView(byId("side"), [0, 2], [-0.9, -0.1], [2.6, 2.1]), makeView(byId("top"), [0, 1], [-0.9, -1.1], [2.6, 1.1])];
const events = new EventSource("events");
events.onopen = () => { window.handsel.connected = true; put("link", "live"); };
events.onerror = () => { window.handsel.connected = false; put("link", "not connected; trying again"); };
events.onmessage = (event) => {
  const state = JSON.parse(event.data);
  if (!state.health) return;
  window.handsel.state = state;
  window.handsel.updates += 1;
  show(state);
  for (const view of views) draw(view, state);
};
