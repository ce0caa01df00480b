// SPDX-License-Identifier: Apache-2.0
// Grasp candidates of the robot's hand with the friction cones of the best, and the hand of the
// person that finds room beside it.
import * as THREE from "three";
import { Grasp, GraspCandidates, Pose } from "../messages";
import { dispose, setPose, vector } from "../shapes";
import { Source } from "../source";
import { ghostHand } from "./hand_shape";
import { clear, Layer } from "./layer";

const kShown = 40;           // candidates drawn, best first
const kBest = 0x0f7a43, kOther = 0x5b6877;
const kConeLength = 0.03;    // [m]
// A hand as a fork, open along z of the tool frame [m].
const kFork = [[0, 0, -0.09], [0, 0, -0.035], [-0.04, 0, -0.035], [0.04, 0, -0.035], [-0.04, 0, -0.035], [-0.04, 0, 0.02], [0.04, 0, -0.035], [0.04, 0, 0.02]];

export class GraspLayer implements Layer {
  readonly id = "grasps";
  readonly label = "grasp candidates, person's grasp";
  readonly colour = "#0f7a43";
  readonly initially = false;
  readonly topics = ["handsel/grasp_candidates" as const];
  readonly group = new THREE.Group();
  private drawn: GraspCandidates | undefined;

  show(source: Source): boolean {
    const key = source.newest("handsel/grasp_candidates")?.object;
    const candidates = key === undefined ? undefined : source.newest("handsel/grasp_candidates", key);
    const pose = source.newest("handsel/scene")?.objects.find(({ id }) => id === key)?.T_world_object;
    const old = !candidates || !pose || source.age("handsel/grasp_candidates") > 2;
    if (old) {
      if (!this.drawn) return false;
      clear(this.group, dispose);
      this.drawn = undefined;
      return true;
    }
    const moved = setPose(this.group, pose as Pose);
    if (candidates === this.drawn) return moved;
    this.drawn = candidates;
    clear(this.group, dispose);
    this.group.add(forks(candidates.grasps.slice(1, kShown), kOther, 0.4), forks(candidates.grasps.slice(0, 1), kBest, 1));
    for (const contact of candidates.grasps[0]?.contacts ?? []) this.group.add(frictionCone(contact));
    const partner = candidates.grasps[0]?.partners[0];
    if (partner) this.group.add(ghostHand(source.word("BodySide", partner.side) === "left", partner.T_object_wrist, 0.45));
    return true;
  }
}

function forks(grasps: Grasp[], colour: number, opacity: number): THREE.LineSegments {
  const points: number[] = [], pose = new THREE.Object3D(), p = new THREE.Vector3();
  for (const { T_object_hand } of grasps) {
    setPose(pose, T_object_hand, 0);
    pose.updateMatrix();
    for (const [x, y, z] of kFork) points.push(...p.set(x, y, z).applyMatrix4(pose.matrix).toArray());
  }
  const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity, depthTest: opacity < 1 }));
}

function frictionCone({ position, normal, friction }: Grasp["contacts"][0]): THREE.Mesh {
  const geometry = new THREE.ConeGeometry(friction * kConeLength, kConeLength, 16, 1, true).rotateX(Math.PI).translate(0, kConeLength / 2, 0);
  const cone = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: kBest, transparent: true, opacity: 0.5, side: THREE.DoubleSide }));
  vector(position, cone.position);
  cone.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector(normal).normalize());
  return cone;
}
