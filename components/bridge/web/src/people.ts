// SPDX-License-Identifier: Apache-2.0
// People as rounded limbs between their REP-155 joints.
import * as THREE from "three";
import { Hand } from "./hand_drag";
import { Person } from "./messages";
import { dispose, kCylinder, kSphere, span, vector } from "./shapes";

const kLost = 0.25;       // min time without an observation after which a person is drawn faint [s]
const kSeen = 2e-3;       // min step of a joint that is redrawn [m]
const kSkin = 0xd9a078, kShirt = 0x2f7f86, kTrousers = 0x3d4663;

// Radii as ratios to the stature, for display only; the controller computes its own volumes.
const kLimbs: [string, string, number, number][] = [
  ["neck", "head", 0.03, kSkin],
  ["l_shoulder", "r_shoulder", 0.042, kShirt], ["neck", "torso", 0.06, kShirt], ["torso", "waist", 0.068, kShirt],
  ["l_shoulder", "torso", 0.05, kShirt], ["r_shoulder", "torso", 0.05, kShirt],
  ["l_shoulder", "l_elbow", 0.03, kShirt], ["l_elbow", "l_wrist", 0.024, kSkin], ["l_wrist", "l_hand", 0.022, kSkin],
  ["r_shoulder", "r_elbow", 0.03, kShirt], ["r_elbow", "r_wrist", 0.024, kSkin], ["r_wrist", "r_hand", 0.022, kSkin],
  ["waist", "l_hip", 0.058, kTrousers], ["waist", "r_hip", 0.058, kTrousers],
  ["l_hip", "l_knee", 0.047, kTrousers], ["l_knee", "l_ankle", 0.034, kTrousers],
  ["r_hip", "r_knee", 0.047, kTrousers], ["r_knee", "r_ankle", 0.034, kTrousers],
];
const kBalls: [string, number, number][] = [
  ["head", 0.066, kSkin], ["l_hand", 0.03, kSkin], ["r_hand", 0.03, kSkin], ["l_ankle", 0.036, kTrousers], ["r_ankle", 0.036, kTrousers],
];

class Body {
  readonly group = new THREE.Group();
  readonly head = new THREE.Vector3();
  readonly hands = new Map<"left" | "right", THREE.Vector3>();
  readonly box = new THREE.Box3();
  private readonly material = new THREE.MeshLambertMaterial({ transparent: true });
  private readonly tubes = new THREE.InstancedMesh(kCylinder, this.material, kLimbs.length);
  private readonly balls = new THREE.InstancedMesh(kSphere, this.material, kBalls.length + 2 * kLimbs.length);
  private drawn: THREE.Vector3[] = [];

  constructor() {
    this.tubes.castShadow = this.balls.castShadow = true;
    this.tubes.frustumCulled = this.balls.frustumCulled = false;
    this.group.add(this.tubes, this.balls);
  }

  show(person: Person): boolean {
    const opacity = person.age > kLost ? 0.35 : 1;
    const joints = new Map(person.joints.map((joint) => [joint.name, vector(joint.position)]));
    const points = [...joints.values()];
    for (const side of ["left", "right"] as const) {
      const hand = joints.get(`${side[0]}_hand`);
      if (hand) this.hands.set(side, hand);
      else this.hands.delete(side);
    }
    const still = points.length === this.drawn.length && points.every((p, i) => p.distanceToSquared(this.drawn[i]) < kSeen * kSeen);
    if (still && opacity === this.material.opacity) return false;
    this.drawn = points;
    this.box.setFromPoints([...joints.values()]).expandByScalar(0.06);
    this.material.opacity = opacity;
    const matrix = new THREE.Matrix4(), colour = new THREE.Color();
    let tubes = 0, balls = 0;
    const ball = (at: THREE.Vector3, radius: number, shade: number): void => {
      this.balls.setMatrixAt(balls, matrix.makeScale(radius, radius, radius).setPosition(at));
      this.balls.setColorAt(balls++, colour.set(shade));
    };
    for (const [from, to, share, shade] of kLimbs) {
      const a = joints.get(from), b = joints.get(to);
      if (!a || !b) continue;
      const radius = share * person.stature + person.inflation;
      this.tubes.setMatrixAt(tubes, span(a, b, radius, matrix));
      this.tubes.setColorAt(tubes++, colour.set(shade));
      ball(a, radius, shade);
      ball(b, radius, shade);
    }
    for (const [name, share, shade] of kBalls) {
      const at = joints.get(name);
      if (at) ball(at, share * person.stature + person.inflation, shade);
    }
    this.tubes.count = tubes;
    this.balls.count = balls;
    for (const mesh of [this.tubes, this.balls]) {
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
    this.head.copy(joints.get("head") ?? points[0] ?? this.head);
    return true;
  }

}

export class People {
  readonly group = new THREE.Group();
  private readonly bodies = new Map<string, Body>();

  show(people: Person[]): boolean {
    let changed = false;
    for (const person of people) {
      let body = this.bodies.get(person.id);
      if (!body) {
        body = new Body();
        this.bodies.set(person.id, body);
        this.group.add(body.group);
      }
      changed = body.show(person) || changed;
    }
    for (const [id, body] of this.bodies) {
      if (people.some((person) => person.id === id)) continue;
      dispose(body.group);
      this.bodies.delete(id);
      changed = true;
    }
    return changed;
  }

  // [id, top of the head]
  *labels(): Iterable<[string, THREE.Vector3]> {
    for (const [id, body] of this.bodies) yield [id, body.head.clone().add(new THREE.Vector3(0, 0, 0.16))];
  }
  *hands(): Iterable<Hand> {
    for (const [person, body] of this.bodies) for (const [side, at] of body.hands) yield { person, side, at };
  }
  first(): Body | undefined {
    return [...this.bodies.values()][0];
  }
}
