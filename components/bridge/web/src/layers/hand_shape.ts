// SPDX-License-Identifier: Apache-2.0
// A hand of a person as a translucent shape, for hands that are planned and not observed.
import * as THREE from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { Pose } from "../messages";
import { setPose } from "../shapes";

const kGhost = 0x5b3fd6;

function part(size: [number, number, number], at: [number, number, number], turn = 0): THREE.BufferGeometry {
  return new THREE.BoxGeometry(...size).rotateX(turn).translate(...at);
}

// Frame of the wrist: z along the fingers, x out of the palm; the thumb of a right hand is at +y [m].
const kRight = mergeGeometries([
  part([0.026, 0.08, 0.09], [0, 0, 0.05]),
  ...[-0.03, -0.01, 0.01, 0.03].map((y, i) => part([0.016, 0.016, [0.06, 0.075, 0.08, 0.07][i]], [0.004, y, 0.095 + [0.03, 0.0375, 0.04, 0.035][i]])),
  part([0.018, 0.018, 0.07], [0.012, 0.056, 0.075], -0.6),
]);
const kLeft = kRight.clone().scale(1, -1, 1);

// Returns a hand at the pose of its wrist in the frame of its parent.
export function ghostHand(left: boolean, T_parent_wrist: Pose, opacity: number): THREE.Mesh {
  const material = new THREE.MeshLambertMaterial({ color: kGhost, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide });
  const mesh = new THREE.Mesh((left ? kLeft : kRight).clone(), material);
  setPose(mesh, T_parent_wrist, 0);
  return mesh;
}
