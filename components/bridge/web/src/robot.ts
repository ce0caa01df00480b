// SPDX-License-Identifier: Apache-2.0
// The robot from its URDF.
import * as THREE from "three";
import URDFLoader, { URDFRobot } from "urdf-loader";
import { Config } from "./config";
import { RobotState } from "./messages";
import { setPose } from "./shapes";

const kSeen = 2e-4;  // min step of an axis that is redrawn [rad]
const kShades = { base: 0x55606e, light: 0xe9ecef, accent: 0xe8871e, hand: 0x343b45 };

export class Robot {
  readonly group = new THREE.Group();
  // The state drawn now: stamp of its sample and angle of each axis of the model.
  stamp = 0n;
  private readonly model: URDFRobot;
  private readonly ghost: URDFRobot;  // never drawn: computes the tool path
  private drawn: number[] = [];

  constructor(urdf: string, private readonly config: Config) {
    const loader = new URDFLoader();
    loader.workingPath = config.urdf.slice(0, config.urdf.lastIndexOf("/") + 1);
    loader.packages = () => loader.workingPath.replace(/\/$/, "");
    this.model = loader.parse(urdf);
    loader.parseVisual = false;
    this.ghost = loader.parse(urdf);
    for (const robot of [this.model, this.ghost])
      for (const joint of Object.values(robot.joints)) joint.ignoreLimits = true;  // as measured
    this.paint();
    this.group.add(this.model);
  }

  // Returns true if something visible moved.
  show(state: RobotState): boolean {
    let changed = setPose(this.group, state.T_world_base);
    const axes = this.config.axes;
    for (let i = 0; i < axes.length && i < state.position.length; ++i)
      if (!(Math.abs(state.position[i] - this.drawn[i]) < kSeen)) changed = true;
    if (!changed && this.stamp !== 0n) return false;
    this.drawn = axes.map((_, i) => state.position[i] ?? 0);
    axes.forEach((axis, i) => this.model.setJointValue(axis, this.drawn[i]));
    this.stamp = state.stamp;
    return true;
  }

  // Returns the angle of each axis in the drawn model [rad].
  angles(): Record<string, number> {
    return Object.fromEntries(this.config.axes.map((axis) => [axis, this.model.joints[axis]?.angle ?? NaN]));
  }

  // Returns true if one of these axes, by their index, moves the arm or the platform.
  movesTool(axes: ArrayLike<number>): boolean {
    const { arm, platform } = this.config.groups;
    const drawn = new Set([...(arm ?? this.config.axes), ...(platform ?? [])]);
    return Array.from(axes).some((axis) => drawn.has(this.config.axes[axis]));
  }

  // Returns the positions of the tool, world [m], while `axes` take these positions one after the
  // other and the other axes stay at `position`; empty for a robot without a tool.
  toolPath(position: ArrayLike<number>, axes: ArrayLike<number>, positions: number[][]): THREE.Vector3[] {
    const tool = this.ghost.links[this.config.tool_link], points: THREE.Vector3[] = [];
    if (!tool) return points;
    this.config.axes.forEach((axis, i) => this.ghost.setJointValue(axis, position[i] ?? 0));
    this.group.updateMatrixWorld(true);
    for (let i = 0; i < (positions[0]?.length ?? 0); ++i) {
      positions.forEach((values, k) => this.ghost.setJointValue(this.config.axes[axes[k]], values[i]));
      this.ghost.updateMatrixWorld(true);
      points.push(tool.getWorldPosition(new THREE.Vector3()).applyMatrix4(this.group.matrixWorld));
    }
    return points;
  }

  // Returns both ends of each link as drawn, world [m]: its own frame and that of the next link.
  bones(): [THREE.Vector3, THREE.Vector3][] {
    this.group.updateMatrixWorld(true);
    return Object.values(this.model.joints).map((joint) => {
      const above = joint.parent ?? this.model;
      return [above.getWorldPosition(new THREE.Vector3()), joint.getWorldPosition(new THREE.Vector3())];
    });
  }

  private paint(): void {
    const materials = Object.fromEntries(Object.entries(kShades).map(([name, color]) => [name, new THREE.MeshLambertMaterial({ color })]));
    const arm = new Set(this.config.groups.arm ?? []);
    const walk = (part: THREE.Object3D, shade: string, odd: boolean): void => {
      for (const child of part.children) {
        const kind = child as THREE.Object3D & { isURDFJoint?: boolean; isURDFLink?: boolean; isURDFVisual?: boolean; urdfName?: string };
        if (kind.isURDFJoint && arm.has(kind.urdfName ?? "")) walk(kind, odd ? "accent" : "light", !odd);
        else if (kind.isURDFLink && kind.urdfName === this.config.tool_link) walk(kind, "hand", odd);
        else {
          const mesh = kind as unknown as THREE.Mesh<THREE.BufferGeometry, THREE.Material>;
          if (mesh.isMesh) {
            if (mesh.material.name === "") mesh.material = materials[shade];
            mesh.castShadow = true;
          }
          walk(kind, shade, odd);
        }
      }
    };
    walk(this.model, "base", false);
  }
}
