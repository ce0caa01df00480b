// SPDX-License-Identifier: Apache-2.0
// Where people look: the ray of the gaze, and the cone in which the robot counts as looked at.
import * as THREE from "three";
import { dispose, Rod, span, vector } from "../shapes";
import { Source } from "../source";
import { clear, Layer, Seen } from "./layer";

const kLength = 0.9;  // [m]
const kGaze = 0x7c4df0;

export class GazeLayer implements Layer {
  readonly id = "gaze";
  readonly label: string;
  readonly colour = "#7c4df0";
  readonly initially = true;
  readonly topics = [];
  readonly group = new THREE.Group();
  private readonly seen = new Seen();
  private readonly cone: THREE.ConeGeometry;  // unit height, apex at the eyes
  private drawn = "";

  // `angle`: half the opening of the cone [rad].
  constructor(angle: number) {
    this.label = `gaze, attentive within ${((angle * 180) / Math.PI).toFixed(0)}°`;
    this.cone = new THREE.ConeGeometry(Math.tan(angle), 1, 32, 1, true).rotateX(Math.PI);
  }

  show(source: Source): boolean {
    const humans = source.newest("handsel/human_state");
    if (!this.seen.changed(humans)) return false;
    const looking = (humans?.people ?? []).filter(({ gaze_known }) => gaze_known);
    const now = looking.map(({ gaze_origin: o, gaze_direction: d }) => [o.x, o.y, o.z, d.x, d.y, d.z].map((v) => v.toFixed(2))).join();
    if (now === this.drawn) return false;
    this.drawn = now;
    clear(this.group, dispose);
    for (const { gaze_origin, gaze_direction } of looking) {
      const from = vector(gaze_origin), to = vector(gaze_direction).multiplyScalar(kLength).add(from);
      const ray = new Rod(0.006, kGaze, 0.75);
      ray.place(from, to);
      const material = new THREE.MeshBasicMaterial({ color: kGaze, transparent: true, opacity: 0.09, depthWrite: false, side: THREE.DoubleSide });
      const cone = new THREE.Mesh(this.cone.clone(), material);
      cone.matrixAutoUpdate = false;
      span(from, to, kLength, cone.matrix);
      cone.matrixWorldNeedsUpdate = true;
      this.group.add(ray.mesh, cone);
    }
    return true;
  }
}
