// SPDX-License-Identifier: Apache-2.0
// Small three.js parts of several drawn objects.
import * as THREE from "three";
import { Pose, Vector3 } from "./messages";

export const kSphere = new THREE.SphereGeometry(1, 16, 12);
export const kCylinder = new THREE.CylinderGeometry(1, 1, 1, 16, 1, true);  // along y, from -0.5 to 0.5

const up = new THREE.Vector3(0, 1, 0), along = new THREE.Vector3(), middle = new THREE.Vector3(), turn = new THREE.Quaternion();

export const vector = (v: Vector3, out = new THREE.Vector3()): THREE.Vector3 => out.set(v.x, v.y, v.z);

// Places a unit cylinder between a and b.
export function span(a: THREE.Vector3, b: THREE.Vector3, radius: number, out: THREE.Matrix4): THREE.Matrix4 {
  along.subVectors(b, a);
  const length = Math.max(along.length(), 1e-6);
  turn.setFromUnitVectors(up, along.divideScalar(length));
  middle.addVectors(a, b).multiplyScalar(0.5);
  return out.compose(middle, turn, along.set(radius, length, radius));
}

// A straight rod between two points; hidden until placed.
export class Rod {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;

  constructor(private readonly radius: number, colour: number, opacity = 1) {
    this.mesh = new THREE.Mesh(kCylinder, new THREE.MeshBasicMaterial({ color: colour, transparent: opacity < 1, opacity }));
    this.mesh.matrixAutoUpdate = false;
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  place(a: THREE.Vector3, b: THREE.Vector3): void {
    span(a, b, this.radius, this.mesh.matrix);
    this.mesh.matrixWorldNeedsUpdate = true;
    this.mesh.visible = true;
  }
}

// Returns true if the object moved more than `far` [m] or turned more than about `far` [rad].
export function setPose(object: THREE.Object3D, pose: Pose, far = 3e-4): boolean {
  const { position: p, orientation: q } = pose;
  const moved = Math.abs(object.position.x - p.x) + Math.abs(object.position.y - p.y) + Math.abs(object.position.z - p.z);
  const dot = object.quaternion.x * q.x + object.quaternion.y * q.y + object.quaternion.z * q.z + object.quaternion.w * q.w;
  if (moved < far && 1 - Math.abs(dot) < far * far) return false;
  object.position.set(p.x, p.y, p.z);
  object.quaternion.set(q.x, q.y, q.z, q.w);
  return true;
}

export function dispose(object: THREE.Object3D): void {
  object.removeFromParent();
  object.traverse((part) => {
    const mesh = part as THREE.Mesh;
    if (mesh.geometry && mesh.geometry !== kSphere && mesh.geometry !== kCylinder) mesh.geometry.dispose();
    for (const material of [mesh.material ?? []].flat()) material.dispose();
  });
}
