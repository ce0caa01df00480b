// SPDX-License-Identifier: Apache-2.0
// The robot from its URDF, and the future path of its tool.
import * as THREE from "three";
import URDFLoader, { URDFRobot } from "urdf-loader";
import { Config } from "./config";
import { ActiveTrajectory, RobotState } from "./messages";
import { dispose, kSphere, setPose } from "./shapes";
import { sample } from "./soft_motion";

const kPathPoints = 72;
const kSeen = 2e-4;  // min step of an axis that is redrawn [rad]
const kShades = { base: 0x55606e, light: 0xe9ecef, accent: 0xe8871e, hand: 0x343b45 };

export class Robot {
  readonly group = new THREE.Group();
  readonly path = new THREE.Group();
  // The state drawn now: stamp of its sample and angle of each axis of the model.
  stamp = 0n;
  private readonly model: URDFRobot;
  private readonly ghost: URDFRobot;  // never drawn: computes the tool path
  private drawn: number[] = [];
  private trajectory = 0n;
  private tube: THREE.Mesh<THREE.TubeGeometry, THREE.MeshLambertMaterial[]> | undefined;
  private total = 0;

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

  // Returns true if the path, or the arm's progress along it, has changed.
  showPath(active: ActiveTrajectory | undefined): boolean {
    const moving = active !== undefined && active.trajectory !== 0n && active.rest.axes.length > 0 && this.moves(active);
    if (!moving) {
      if (!this.tube) return false;
      this.clearPath();
      return true;
    }
    if (active.trajectory !== this.trajectory) {
      this.clearPath();
      this.trajectory = active.trajectory;
      this.tube = this.drawPath(active);
    }
    if (!this.tube) return false;
    const indices = this.tube.geometry.index?.count ?? 0, each = indices / kPathPoints;
    const past = each * Math.round(kPathPoints * Math.min(1, active.time / Math.max(this.total, 1e-6)));
    if (this.tube.geometry.groups.length === 2 && this.tube.geometry.groups[0].count === past) return false;
    this.tube.geometry.clearGroups();
    this.tube.geometry.addGroup(0, past, 1);
    this.tube.geometry.addGroup(past, indices - past, 0);
    return true;
  }

  private moves(active: ActiveTrajectory): boolean {
    const { arm, platform } = this.config.groups;
    const drawn = new Set([...(arm ?? this.config.axes), ...(platform ?? [])]);
    return Array.from(active.axes).some((axis) => drawn.has(this.config.axes[axis]));
  }

  private drawPath(active: ActiveTrajectory): typeof this.tube {
    const tool = this.ghost.links[this.config.tool_link];
    if (!tool) return undefined;
    this.config.axes.forEach((axis, i) => this.ghost.setJointValue(axis, active.position[i] ?? 0));
    const moving = active.rest.axes.map((axis) => sample(axis, kPathPoints));
    this.total = active.rest.axes[0].segments.reduce((sum, segment) => sum + segment.duration, 0);
    const points: THREE.Vector3[] = [];
    for (let i = 0; i <= kPathPoints; ++i) {
      moving.forEach((values, k) => this.ghost.setJointValue(this.config.axes[active.axes[k]], values[i]));
      this.ghost.updateMatrixWorld(true);
      points.push(tool.getWorldPosition(new THREE.Vector3()).applyMatrix4(this.group.matrixWorld));
    }
    const geometry = new THREE.TubeGeometry(new THREE.CatmullRomCurve3(points), kPathPoints, 0.007, 6);
    const ahead = new THREE.MeshLambertMaterial({ color: 0x12a150, emissive: 0x0a6b34 });
    const past = new THREE.MeshLambertMaterial({ color: 0x12a150, transparent: true, opacity: 0.25 });
    const tube = new THREE.Mesh(geometry, [ahead, past]);
    const end = new THREE.Mesh(kSphere, ahead);
    end.scale.setScalar(0.018);
    end.position.copy(points[points.length - 1]);
    this.path.add(tube, end);
    return tube;
  }

  private clearPath(): void {
    for (const part of [...this.path.children]) dispose(part);
    this.tube = undefined;
    this.trajectory = 0n;
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
