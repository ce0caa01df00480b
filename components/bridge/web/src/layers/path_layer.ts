// SPDX-License-Identifier: Apache-2.0
// The trajectory that runs, as the path of the tool, coloured by the planned speed of the tool.
import * as THREE from "three";
import { ActiveTrajectory } from "../messages";
import { Robot } from "../robot";
import { dispose, kSphere } from "../shapes";
import { duration, sample } from "../soft_motion";
import { Source } from "../source";
import { kScale, scaleColour } from "./colours";
import { clear, Layer } from "./layer";

const kPoints = 72, kRound = 6;
const kFastest = 1;  // speed at the upper end of the scale [m/s]

export class PathLayer implements Layer {
  readonly id = "path";
  readonly label = `trajectory by speed, 0 to ${kFastest} m/s`;
  readonly colour = kScale;
  readonly initially = true;
  readonly topics = [];
  readonly group = new THREE.Group();
  private trajectory = 0n;
  private tube: THREE.Mesh<THREE.TubeGeometry, THREE.MeshBasicMaterial[]> | undefined;
  private total = 0;

  constructor(private readonly robot: Robot) {}

  show(source: Source): boolean {
    const active = source.newest("handsel/active_trajectory");
    const moving = active !== undefined && active.trajectory !== 0n && active.rest.axes.length > 0 && this.robot.movesTool(active.axes);
    if (!moving) {
      if (!this.tube) return false;
      this.forget();
      return true;
    }
    if (active.trajectory !== this.trajectory) {
      this.forget();
      this.trajectory = active.trajectory;
      this.tube = this.draw(active);
    }
    if (!this.tube) return false;
    const indices = this.tube.geometry.index?.count ?? 0, each = indices / kPoints;
    const past = each * Math.round(kPoints * Math.min(1, active.time / Math.max(this.total, 1e-6)));
    if (this.tube.geometry.groups.length === 2 && this.tube.geometry.groups[0].count === past) return false;
    this.tube.geometry.clearGroups();
    this.tube.geometry.addGroup(0, past, 1);
    this.tube.geometry.addGroup(past, indices - past, 0);
    return true;
  }

  private draw(active: ActiveTrajectory): typeof this.tube {
    const moving = active.rest.axes.map((axis) => sample(axis, kPoints));
    this.total = duration(active.rest.axes[0]);
    const points = this.robot.toolPath(active.position, active.axes, moving);
    if (points.length < 2) return undefined;
    const geometry = new THREE.TubeGeometry(new THREE.CatmullRomCurve3(points), kPoints, 0.008, kRound);
    const ahead = new THREE.MeshBasicMaterial({ vertexColors: true });
    const past = new THREE.MeshBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.25 });
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(speedColours(points, this.total / kPoints), 3));
    const tube = new THREE.Mesh(geometry, [ahead, past]);
    const end = new THREE.Mesh(kSphere, new THREE.MeshBasicMaterial({ color: 0x1f2d6b }));
    end.scale.setScalar(0.018);
    end.position.copy(points[points.length - 1]);
    this.group.add(tube, end);
    return tube;
  }

  private forget(): void {
    clear(this.group, dispose);
    this.tube = undefined;
    this.trajectory = 0n;
  }
}

// Returns the colour of each vertex of a tube through points at equal steps of time; the rings of a
// tube are at equal lengths of its curve.
function speedColours(points: THREE.Vector3[], step: number): number[] {
  const lengths = [0], speeds: number[] = [];
  for (let i = 1; i < points.length; ++i) lengths.push(lengths[i - 1] + points[i].distanceTo(points[i - 1]));
  for (let i = 0; i < points.length; ++i) {
    const a = Math.max(0, i - 1), b = Math.min(points.length - 1, i + 1);
    speeds.push((lengths[b] - lengths[a]) / Math.max((b - a) * step, 1e-9));
  }
  const colours: number[] = [], colour = new THREE.Color(), total = lengths[lengths.length - 1];
  for (let ring = 0, i = 0; ring <= kPoints; ++ring) {
    const at = (total * ring) / kPoints;
    while (i < lengths.length - 2 && lengths[i + 1] < at) ++i;
    const part = (at - lengths[i]) / Math.max(lengths[i + 1] - lengths[i], 1e-9);
    scaleColour((speeds[i] + (speeds[i + 1] - speeds[i]) * part) / kFastest, colour);
    for (let k = 0; k <= kRound; ++k) colours.push(colour.r, colour.g, colour.b);
  }
  return colours;
}
