// SPDX-License-Identifier: Apache-2.0
// Other robots nearby, as the capsules that they report.
import * as THREE from "three";
import { OtherRobot } from "./messages";
import { kCylinder, kSphere, span, vector } from "./shapes";

const kMaxParts = 4 * 128;  // four robots of 128 parts each, the bound of the message
const kColour = 0x8b8f98;
const kSeen = 2e-3;         // min step that is redrawn [m]

export class OtherRobots {
  readonly group = new THREE.Group();
  private readonly material = new THREE.MeshLambertMaterial({ color: kColour, transparent: true, opacity: 0.85 });
  private readonly tubes = new THREE.InstancedMesh(kCylinder, this.material, kMaxParts);
  private readonly balls = new THREE.InstancedMesh(kSphere, this.material, 2 * kMaxParts);
  private drawn: THREE.Vector3[] = [];
  private tops = new Map<string, THREE.Vector3>();

  constructor() {
    this.tubes.count = this.balls.count = 0;
    this.tubes.castShadow = this.balls.castShadow = true;
    this.tubes.frustumCulled = this.balls.frustumCulled = false;
    this.group.add(this.tubes, this.balls);
  }

  // Returns whether the picture changes.
  show(robots: OtherRobot[]): boolean {
    const ends = robots.flatMap((robot) => robot.parts.flatMap((part) => [vector(part.a), vector(part.b)]));
    const still = ends.length === this.drawn.length && ends.every((p, i) => p.distanceToSquared(this.drawn[i]) < kSeen * kSeen);
    if (still) return false;
    this.drawn = ends;
    this.tops = new Map();
    const matrix = new THREE.Matrix4();
    let tubes = 0, balls = 0;
    for (const robot of robots) {
      const top = new THREE.Vector3(0, 0, -Infinity);
      for (const part of robot.parts) {
        const a = vector(part.a), b = vector(part.b), r = part.radius;
        this.tubes.setMatrixAt(tubes++, span(a, b, r, matrix));
        for (const end of [a, b]) {
          this.balls.setMatrixAt(balls++, matrix.makeScale(r, r, r).setPosition(end));
          if (end.z + r > top.z) top.copy(end).setZ(end.z + r);
        }
      }
      this.tops.set(robot.name, top);
    }
    this.tubes.count = tubes;
    this.balls.count = balls;
    this.tubes.instanceMatrix.needsUpdate = this.balls.instanceMatrix.needsUpdate = true;
    return true;
  }

  // [name, highest point]
  labels(): Iterable<[string, THREE.Vector3]> {
    return this.tops.entries();
  }
}
