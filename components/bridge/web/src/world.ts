// SPDX-License-Identifier: Apache-2.0
// The 3-D view: draws when something changed, at most kFastest times a second.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Config } from "./config";
import { HandDrag } from "./hand_drag";
import { Labels } from "./labels";
import { Link } from "./link";
import { nearness } from "./nearness";
import { OtherRobots } from "./other_robots";
import { People } from "./people";
import { Robot } from "./robot";
import { kSphere, Rod, vector } from "./shapes";
import { Steering } from "./steering";
import { Things } from "./things";

const kNobody = 1e8;  // larger distances mean that no person is present [m]
const kView = new THREE.Vector3(0.12, -1, 0.36);
const kCalm = 0x12a150, kNear = 0xd97706, kTooNear = 0xdc2626;

export type Part = "robot" | "person" | "object";
export interface Region { x: number; y: number; width: number; height: number }

export class World {
  frames = 0;
  cost = 0;  // duration of the last picture [ms]
  readonly robot: Robot;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.05, 40);
  private readonly controls: OrbitControls;
  private readonly people = new People();
  private readonly others = new OtherRobots();
  private readonly things: Things;
  private readonly separation = new Rod(0.005, kCalm);
  private readonly exchange = new THREE.Mesh(kSphere, new THREE.MeshBasicMaterial({ color: 0x8a5cf6, transparent: true, opacity: 0.45 }));
  private readonly labels: Labels;
  private fence: WebGLSync | null = null;
  private begun = 0;
  private framed = false;
  private dirty = true;

  // Throws an Error when the browser has no WebGL.
  constructor(private readonly stage: HTMLElement, urdf: string, config: Config, private readonly wake: () => void,
              onProblem: (sentence: string) => void) {
    const canvas = document.createElement("canvas");
    const software = drawsInSoftware();
    const context = canvas.getContext("webgl2", { antialias: !software, powerPreference: "low-power" });
    if (!context) throw new Error("no WebGL");
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    // Without a GPU the processor draws, which may also run the robot's control: no shadows then,
    // which are half of the work.
    this.renderer.shadowMap.enabled = !software;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.floor.visible = !software;
    this.renderer.setPixelRatio(software ? 1 : Math.min(devicePixelRatio, 2));
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The robot, the people around it and what it handles, in three dimensions");
    stage.prepend(canvas);
    this.labels = new Labels(stage);
    this.robot = new Robot(urdf, config);
    this.things = new Things(config, () => this.touch(), onProblem);
    this.exchange.scale.setScalar(0.03);
    this.exchange.visible = false;
    this.camera.up.set(0, 0, 1);
    this.scene.add(this.robot.group, this.robot.path, this.people.group, this.others.group, this.things.group, this.separation.mesh, this.exchange);
    this.light();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.controls.minDistance = 0.4;
    this.controls.maxDistance = 12;
    this.controls.addEventListener("change", () => this.touch());
    canvas.addEventListener("webglcontextlost", () => onProblem("The browser took the 3-D view away; reload the page to get it back."));
    new ResizeObserver(() => this.resize()).observe(stage);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.theme());
    this.resize();
    this.theme();
  }

  // Lets the visitor drag hands of people; `say` shows why that was refused.
  letDrag(steering: Steering, say: (refusal: string) => void): void {
    const drag = new HandDrag(this.renderer.domElement, this.camera, this.controls, steering, () => this.people.hands(), () => this.touch(), say);
    this.scene.add(drag.marker);
  }

  // Takes the newest samples; returns true if the picture would change.
  update(link: Link): boolean {
    const state = link.newest("handsel/robot_state"), scene = link.newest("handsel/scene"), humans = link.newest("handsel/human_state");
    let changed = state ? this.robot.show(state) : false;
    if (scene) changed = this.things.show(scene) || changed;
    if (humans) changed = this.people.show(humans.people) || changed;
    if (humans) changed = this.others.show(humans.robots ?? []) || changed;
    changed = this.robot.showPath(link.newest("handsel/active_trajectory")) || changed;
    if (changed) this.showDistance(link);
    this.showExchange(link);
    if (!this.framed && state && scene && humans) this.frame();
    this.dirty ||= changed;
    return this.dirty;
  }

  render(): void {
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.begun = performance.now();
    this.labels.place(this.camera, this.renderer.domElement.clientWidth, this.renderer.domElement.clientHeight);
    this.frames += 1;
  }

  // Returns false while the last picture is being drawn.
  ready(): boolean {
    if (!this.fence) return true;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (!gl.isContextLost() && gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(this.fence);
    this.fence = null;
    this.cost = performance.now() - this.begun;
    return true;
  }

  // Centres the view on robot, people and furniture.
  frame(): void {
    this.scene.updateMatrixWorld(true);
    const box = new THREE.Box3();
    for (const part of [this.robot.group, this.things.group]) box.expandByObject(part);
    const person = this.people.first();
    if (person) box.union(person.box);
    if (box.isEmpty()) return;
    this.framed = true;
    const direction = kView.clone().normalize(), middle = box.getCenter(new THREE.Vector3());
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).add(direction);
    this.camera.lookAt(middle);
    this.camera.updateMatrixWorld(true);
    // Returns the min distance at which every corner of the box is in view.
    const inverse = this.camera.matrixWorldInverse.copy(this.camera.matrixWorld).invert();
    const tall = Math.tan(THREE.MathUtils.degToRad(this.camera.fov) / 2), wide = tall * this.camera.aspect;
    let back = 0;
    for (const corner of corners(box)) {
      const p = corner.applyMatrix4(inverse);
      back = Math.max(back, Math.abs(p.x) / wide + p.z, Math.abs(p.y) / tall + p.z);
    }
    this.camera.position.copy(middle).addScaledVector(direction, 1.02 * back + 1);
    this.controls.update();
    this.touch();
  }

  // Returns the position of a part in the page [CSS pixels]; undefined if absent or out of view.
  region(name: Part): Region | undefined {
    const box = new THREE.Box3();
    if (name === "robot") box.setFromObject(this.robot.group, true);
    if (name === "person") box.copy(this.people.first()?.box ?? box);
    const object = this.things.first();
    if (name === "object" && object) box.setFromObject(object, true);
    if (box.isEmpty()) return undefined;
    const view = this.renderer.domElement.getBoundingClientRect(), flat = new THREE.Box2();
    for (const corner of corners(box)) {
      corner.project(this.camera);
      flat.expandByPoint(new THREE.Vector2((corner.x + 1) / 2 * view.width, (1 - corner.y) / 2 * view.height));
    }
    flat.intersect(new THREE.Box2(new THREE.Vector2(0, 0), new THREE.Vector2(view.width, view.height)));
    if (flat.isEmpty()) return undefined;
    return { x: view.x + flat.min.x, y: view.y + flat.min.y, width: flat.max.x - flat.min.x, height: flat.max.y - flat.min.y };
  }

  // Returns the position in the page of a point in the world [CSS pixels].
  pixel(point: [number, number, number]): { x: number; y: number } {
    const p = new THREE.Vector3(...point).project(this.camera), view = this.renderer.domElement.getBoundingClientRect();
    return { x: view.x + ((p.x + 1) / 2) * view.width, y: view.y + ((1 - p.y) / 2) * view.height };
  }

  // Returns the position of a person's hand as drawn, world [m].
  hand(person: string, side: string): [number, number, number] | undefined {
    for (const hand of this.people.hands()) if (hand.person === person && hand.side === side) return hand.at.toArray();
    return undefined;
  }

  // Hides parts, so that a test can distinguish them from their background.
  hide(names: Part[]): void {
    this.robot.group.visible = !names.includes("robot");
    this.people.group.visible = !names.includes("person");
    const object = this.things.first();
    if (object) object.visible = !names.includes("object");
    this.touch();
  }

  private showDistance(link: Link): void {
    const execution = link.newest("handsel/execution_status");
    const known = execution?.nearest_on_robot !== undefined && execution.separation < kNobody && link.age("handsel/execution_status") < 1;
    this.separation.mesh.visible = false;
    const legend = this.stage.querySelector<HTMLElement>(".legend .near");
    if (legend) legend.hidden = !known;
    this.labels.clear();
    for (const [id, at] of this.people.labels()) this.labels.add(id, at, "person");
    for (const [name, at] of this.others.labels()) this.labels.add(name, at, "robot");
    for (const [id, at] of this.things.labels()) this.labels.add(id, at, "object");
    if (!known || !execution) return;
    const a = vector(execution.nearest_on_robot), b = vector(execution.nearest_on_person);
    const how = nearness(execution.separation, execution.separation_limit);
    this.separation.mesh.material.color.setHex(how === "calm" ? kCalm : how === "near" ? kNear : kTooNear);
    this.separation.place(a, b);
    this.labels.add(`${execution.separation.toFixed(2)} m`, a.add(b).multiplyScalar(0.5), `distance ${how.replace(" ", "-")}`);
  }

  private showExchange(link: Link): void {
    const action = link.newest("handsel/action_status");
    const giving = action && ["give", "receive"].includes(link.word("ActionKind", action.kind)) && link.word("ActionState", action.state) === "running";
    const at = action?.exchange_point, there = Boolean(giving && at && (at.x || at.y || at.z));
    if (there !== this.exchange.visible) this.touch();
    this.exchange.visible = there;
    if (there && at) vector(at, this.exchange.position);
  }

  private touch(): void {
    this.dirty = true;
    this.wake();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.stage;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.framed) this.frame();
    this.touch();
  }

  private theme(): void {
    const colour = (name: string): THREE.Color => new THREE.Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim());
    this.scene.background = colour("--stage");
    this.grid.material.color.copy(colour("--grid"));
    this.touch();
  }

  private readonly floor = new THREE.Mesh(new THREE.PlaneGeometry(12, 12), new THREE.ShadowMaterial({ opacity: 0.22 }));
  private readonly grid = new THREE.LineSegments(gridLines(4, 0.5), new THREE.LineBasicMaterial({ vertexColors: true, transparent: true }));

  private light(): void {
    const sun = new THREE.DirectionalLight(0xffffff, 2.1);
    sun.position.set(-1.2, -2.4, 4);
    sun.target.position.set(0.7, -0.2, 0.6);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    sun.shadow.radius = 3;
    sun.shadow.bias = -0.0006;
    sun.shadow.normalBias = 0.02;
    Object.assign(sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, near: 1, far: 8 });
    this.scene.add(sun, sun.target, new THREE.HemisphereLight(0xffffff, 0x9aa3ad, 1.5));
    this.floor.position.z = -0.002;
    this.floor.receiveShadow = true;
    this.scene.add(this.floor, this.grid);
  }
}

function drawsInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2"), info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

// Returns a square grid that fades out toward its edge.
function gridLines(half: number, step: number): THREE.BufferGeometry {
  const points: number[] = [], shades: number[] = [];
  const add = (x: number, y: number): void => {
    points.push(x, y, 0);
    shades.push(1, 1, 1, Math.max(0, 1 - Math.hypot(x, y) / half) ** 0.7);
  };
  for (let u = -half; u <= half; u += step) {
    for (let v = -half; v < half; v += step) {
      add(u, v);
      add(u, v + step);
      add(v, u);
      add(v + step, u);
    }
  }
  return new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(points, 3))
    .setAttribute("color", new THREE.Float32BufferAttribute(shades, 4));
}

function corners(box: THREE.Box3): THREE.Vector3[] {
  const result: THREE.Vector3[] = [];
  for (const x of [box.min.x, box.max.x])
    for (const y of [box.min.y, box.max.y]) for (const z of [box.min.z, box.max.z]) result.push(new THREE.Vector3(x, y, z));
  return result;
}
