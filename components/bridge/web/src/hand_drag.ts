// SPDX-License-Identifier: Apache-2.0
// A visitor drags a hand of a simulated person: in the plane through the hand that faces the viewer.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { kSphere } from "./shapes";
import { Steering } from "./steering";

const kPick = 22, kPickByFinger = 36;  // max distance of the pointer from a hand [CSS pixels]
const kPeriod = 50, kRepeat = 200;     // min time between messages, max while the pointer rests [ms]
const kHold = 0.5;                     // time for which the simulator keeps a point [s]

export interface Hand { person: string; side: "left" | "right"; at: THREE.Vector3 }

export class HandDrag {
  readonly marker = new THREE.Mesh(kSphere, new THREE.MeshBasicMaterial({ color: 0x1d5fd1, transparent: true, opacity: 0.55, depthTest: false }));
  private hand: Hand | undefined;  // dragged
  private readonly plane = new THREE.Plane();
  private readonly offset = new THREE.Vector3();
  private pointer = -1;
  private sending = false;
  private sentAt = 0;
  private timer = 0;
  private readonly sent = new THREE.Vector3();

  constructor(private readonly canvas: HTMLCanvasElement, private readonly camera: THREE.Camera, private readonly controls: OrbitControls,
              private readonly steering: Steering, private readonly hands: () => Iterable<Hand>, private readonly touch: () => void,
              private readonly say: (refusal: string) => void) {
    this.marker.scale.setScalar(0.045);
    this.marker.visible = false;
    // Before the controls, which would turn the view.
    canvas.parentElement?.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.hover(event));
    addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"] as const) addEventListener(end, (event) => this.end(event));
    addEventListener("blur", () => this.end());
  }

  private begin(event: PointerEvent): void {
    if (event.target !== this.canvas || event.button !== 0 || this.hand) return;
    const hand = this.nearest(event);
    if (!hand || !this.steering.allowed) return;
    event.stopPropagation();
    event.preventDefault();
    this.controls.enabled = false;
    this.hand = { ...hand, at: hand.at.clone() };
    this.pointer = event.pointerId;
    this.plane.setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new THREE.Vector3()), hand.at);
    this.offset.copy(hand.at).sub(this.under(event) ?? hand.at);
    this.marker.position.copy(hand.at);
    this.marker.visible = true;
    this.timer = window.setInterval(() => void this.send(), kPeriod);
    this.touch();
  }

  private move(event: PointerEvent): void {
    if (!this.hand || event.pointerId !== this.pointer) return;
    const at = this.under(event);
    if (at) this.marker.position.copy(at).add(this.offset);
    this.touch();
  }

  private end(event?: PointerEvent): void {
    if (!this.hand || (event && event.pointerId !== this.pointer)) return;
    const hand = this.hand;
    this.hand = undefined;
    clearInterval(this.timer);
    this.controls.enabled = true;
    this.marker.visible = false;
    this.canvas.style.cursor = "";
    this.touch();
    void this.command(hand, 0);
  }

  private hover(event: PointerEvent): void {
    if (this.hand || event.buttons !== 0) return;
    this.canvas.style.cursor = this.steering.allowed && this.nearest(event) ? "grab" : "";
  }

  // Sends the point when it has moved, and again before the simulator would give it up.
  private async send(): Promise<void> {
    const { hand } = this;
    const rests = this.sent.distanceTo(this.marker.position) < 1e-3 && performance.now() - this.sentAt < kRepeat;
    if (!hand || this.sending || rests) return;
    await this.command(hand, kHold);
  }

  private async command({ person, side }: Hand, time: number): Promise<void> {
    this.sending = true;
    this.sentAt = performance.now();
    this.sent.copy(this.marker.position);
    const { x, y, z } = this.sent;
    const refusal = await this.steering.send({ person, action: "hand", side, point: [x, y, z], time });
    this.sending = false;
    if (!refusal) return;
    this.say(refusal);
    this.end();
  }

  // Returns the point of the plane under the pointer.
  private under(event: PointerEvent): THREE.Vector3 | undefined {
    const view = this.canvas.getBoundingClientRect(), ray = new THREE.Raycaster();
    const x = (2 * (event.clientX - view.x)) / view.width - 1, y = 1 - (2 * (event.clientY - view.y)) / view.height;
    ray.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return ray.ray.intersectPlane(this.plane, new THREE.Vector3()) ?? undefined;
  }

  private nearest(event: PointerEvent): Hand | undefined {
    const view = this.canvas.getBoundingClientRect(), reach = event.pointerType === "touch" ? kPickByFinger : kPick;
    let best: Hand | undefined, least = reach;
    for (const hand of this.hands()) {
      const p = hand.at.clone().project(this.camera);
      const distance = Math.hypot(view.x + ((p.x + 1) / 2) * view.width - event.clientX, view.y + ((1 - p.y) / 2) * view.height - event.clientY);
      if (p.z < 1 && distance < least) [best, least] = [hand, distance];
    }
    return best;
  }
}
