// SPDX-License-Identifier: Apache-2.0
// Zones of distance to the robot as contours on the floor, and the separation that is kept now.
import * as THREE from "three";
import { Robot } from "../robot";
import { kSphere, vector } from "../shapes";
import { Source } from "../source";
import { Layer } from "./layer";

const kNobody = 1e8;    // larger distances mean that no person is present [m]
const kCells = 112;     // of the grid of distances, each way
const kMargin = 0.3;    // of the grid beyond the outermost contour [m]
const kMoved = 0.02;    // min motion of a link that is redrawn [m]
const kAbove = 0.004;   // height over the floor [m]
const kWidest = 1.5;    // zones beyond this distance are not drawn [m]
const kColours = [0x7a1fa2, 0xb3261e, 0x1d5fd1, 0x5b6877];

type Segment = [THREE.Vector2, THREE.Vector2];

export class ZoneLayer implements Layer {
  readonly id = "zones";
  readonly label: string;
  readonly colour = "linear-gradient(90deg, #7a1fa2, #b3261e, #1d5fd1)";
  readonly initially = false;
  readonly topics = [];
  readonly group = new THREE.Group();
  private readonly lines: THREE.LineSegments[];
  private readonly kept = new THREE.Mesh(kSphere, new THREE.MeshBasicMaterial({ color: 0xb3261e, transparent: true, opacity: 0.13, depthWrite: false }));
  private at: THREE.Vector3[] = [];

  // `limits`: outer limits of the zones, growing [m].
  constructor(private readonly robot: Robot, private readonly limits: number[]) {
    this.limits = limits.filter((limit) => limit <= kWidest);
    this.label = `zones ${this.limits.join(", ")} m, separation kept`;
    this.lines = this.limits.map((_, i) => {
      const line = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: kColours[i % kColours.length] }));
      line.frustumCulled = false;
      return line;
    });
    this.kept.visible = false;
    this.group.add(...this.lines, this.kept);
  }

  show(source: Source): boolean {
    const execution = source.newest("handsel/execution_status");
    const known = execution !== undefined && execution.separation < kNobody && execution.separation_limit > 0;
    let changed = this.kept.visible !== known;
    this.kept.visible = known;
    if (known) {
      const before = this.kept.position.clone().setComponent(2, this.kept.scale.x);
      this.kept.scale.setScalar(execution.separation_limit);
      vector(execution.nearest_on_robot, this.kept.position);
      changed ||= before.distanceTo(this.kept.position.clone().setComponent(2, this.kept.scale.x)) > 1e-3;
    }
    const bones = this.robot.bones(), flat = bones.flat();
    const still = flat.length === this.at.length && flat.every((p, i) => p.distanceTo(this.at[i]) < kMoved);
    if (still) return changed;
    this.at = flat;
    this.draw(bones.map(([a, b]) => [new THREE.Vector2(a.x, a.y), new THREE.Vector2(b.x, b.y)]));
    return true;
  }

  private draw(segments: Segment[]): void {
    const reach = Math.max(...this.limits) + kMargin, box = new THREE.Box2();
    for (const segment of segments) segment.forEach((end) => box.expandByPoint(end));
    box.expandByScalar(reach);
    const step = box.getSize(new THREE.Vector2()).divideScalar(kCells), field = new Float32Array((kCells + 1) ** 2), p = new THREE.Vector2();
    for (let j = 0; j <= kCells; ++j)
      for (let i = 0; i <= kCells; ++i)
        field[j * (kCells + 1) + i] = distance(p.set(box.min.x + i * step.x, box.min.y + j * step.y), segments);
    this.limits.forEach((limit, k) => {
      this.lines[k].geometry.dispose();
      this.lines[k].geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(contour(field, limit, box.min, step), 3));
    });
  }
}

function distance(p: THREE.Vector2, segments: Segment[]): number {
  let least = Infinity;
  for (const [a, b] of segments) {
    const dx = b.x - a.x, dy = b.y - a.y, length = dx * dx + dy * dy;
    const s = length > 0 ? Math.min(1, Math.max(0, ((p.x - a.x) * dx + (p.y - a.y) * dy) / length)) : 0;
    least = Math.min(least, Math.hypot(p.x - a.x - s * dx, p.y - a.y - s * dy));
  }
  return least;
}

// Returns the ends of the line segments where the field has this value (marching squares).
function contour(field: Float32Array, value: number, origin: THREE.Vector2, step: THREE.Vector2): number[] {
  const points: number[] = [], row = kCells + 1;
  for (let j = 0; j < kCells; ++j)
    for (let i = 0; i < kCells; ++i) {
      const corner: [number, number][] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
      const crossings: number[] = [];
      for (let e = 0; e < 4; ++e) {
        const [a, b] = [corner[e], corner[(e + 1) % 4]], u = field[a[1] * row + a[0]] - value, v = field[b[1] * row + b[0]] - value;
        if (u < 0 === v < 0) continue;
        const s = u / (u - v);
        crossings.push(origin.x + (a[0] + s * (b[0] - a[0])) * step.x, origin.y + (a[1] + s * (b[1] - a[1])) * step.y, kAbove);
      }
      points.push(...crossings);  // two crossings, or four of a saddle: pairs of ends
    }
  return points;
}
