// SPDX-License-Identifier: Apache-2.0
// The 3-D view: draws when something changed, at most kFastest times a second.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Config } from "./config";
import { byId } from "./elements";
import { HandDrag } from "./hand_drag";
import { Labels } from "./labels";
import { CostmapLayer } from "./layers/costmap_layer";
import { ForecastLayer } from "./layers/forecast_layer";
import { GazeLayer } from "./layers/gaze_layer";
import { GraspLayer } from "./layers/grasp_layer";
import { HandoverLayer } from "./layers/handover_layer";
import { Layers } from "./layers/layers";
import { PathLayer } from "./layers/path_layer";
import { ZoneLayer } from "./layers/zone_layer";
import { nearness } from "./nearness";
import { OtherRobots } from "./other_robots";
import { People } from "./people";
import { Robot } from "./robot";
import { Rod, vector } from "./shapes";
import { Source } from "./source";
import { Steering } from "./steering";
import { Surroundings } from "./surroundings";
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
  readonly layers: Layers;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.05, 40);
  private readonly controls: OrbitControls;
  private readonly people = new People();
  private readonly others = new OtherRobots();
  private readonly things: Things;
  private readonly separation = new Rod(0.005, kCalm);
  private readonly labels: Labels;
  private readonly surroundings: Surroundings;
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
    this.renderer.setPixelRatio(software ? 1 : Math.min(devicePixelRatio, 2));
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The robot, the people around it and what it handles, in three dimensions");
    stage.prepend(canvas);
    this.labels = new Labels(stage);
    this.robot = new Robot(urdf, config);
    this.things = new Things(config, () => this.touch(), onProblem);
    this.surroundings = new Surroundings(!software);
    this.layers = new Layers(
      [new PathLayer(this.robot), new HandoverLayer(), new GazeLayer(config.attentive_angle), new ForecastLayer(), new GraspLayer(), new CostmapLayer(),
        new ZoneLayer(this.robot, config.zones)],
      byId("layer-list"), () => this.touch());
    this.camera.up.set(0, 0, 1);
    this.scene.add(this.robot.group, this.people.group, this.others.group, this.things.group, this.separation.mesh, this.layers.group, this.surroundings.group);
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

  // Lets the visitor drag hands of people while `present` is true; `say` shows why that was refused.
  letDrag(steering: Steering, present: () => boolean, say: (refusal: string) => void): void {
    const drag = new HandDrag(this.renderer.domElement, this.camera, this.controls, steering, () => (present() ? this.people.hands() : []), () => this.touch(), say);
    this.scene.add(drag.marker);
  }

  // Takes the newest samples; returns true if the picture would change.
  update(source: Source): boolean {
    const state = source.newest("handsel/robot_state"), scene = source.newest("handsel/scene"), humans = source.newest("handsel/human_state");
    let changed = state ? this.robot.show(state) : false;
    if (scene) changed = this.things.show(scene) || changed;
    if (humans) changed = this.people.show(humans.people) || changed;
    if (humans) changed = this.others.show(humans.robots ?? []) || changed;
    changed = this.layers.show(source) || changed;
    if (changed) this.showDistance(source);
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

  // Returns the position of a part or layer in the page [CSS pixels]; undefined if absent or out of
  // view.
  region(name: string): Region | undefined {
    const box = new THREE.Box3();
    if (name === "robot") box.setFromObject(this.robot.group, true);
    if (name === "person") box.copy(this.people.first()?.box ?? box);
    const object = name === "object" ? this.things.first() : undefined;
    if (object) box.setFromObject(object, true);
    const layer = this.layers.find(name)?.group;
    layer?.traverseVisible((part) => (part as THREE.Mesh).geometry && box.expandByObject(part, true));
    return box.isEmpty() ? undefined : this.onPage(box);
  }

  private onPage(box: THREE.Box3): Region | undefined {
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

  private showDistance(source: Source): void {
    const execution = source.newest("handsel/execution_status");
    const known = execution?.nearest_on_robot !== undefined && execution.separation < kNobody && source.age("handsel/execution_status") < 1;
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
    this.scene.background = this.surroundings.theme();
    this.touch();
  }
}

function drawsInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2"), info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

function corners(box: THREE.Box3): THREE.Vector3[] {
  const result: THREE.Vector3[] = [];
  for (const x of [box.min.x, box.max.x])
    for (const y of [box.min.y, box.max.y]) for (const z of [box.min.z, box.max.z]) result.push(new THREE.Vector3(x, y, z));
  return result;
}
