// SPDX-License-Identifier: Apache-2.0
// A level slice through a layer of the human-aware costs.
import * as THREE from "three";
import { Costmap } from "../messages";
import { Source } from "../source";
import { kScale, scaleColour } from "./colours";
import { Layer } from "./layer";

const kChoices = ["safety", "visibility", "arm_comfort", "total"];
const kForbidden = 255;  // value of a point that is forbidden or out of reach
const kMaxCost = 254;    // value of cost 1
const kOpacity = 190;    // of 255
const kColours = Array.from({ length: kMaxCost + 1 }, (_, value) => scaleColour(value / kMaxCost).convertLinearToSRGB());

export class CostmapLayer implements Layer {
  readonly id = "costs";
  readonly label = "costs around a person, slice";
  readonly colour = kScale;
  readonly initially = false;
  readonly topics = ["handsel/costmap" as const];
  readonly group = new THREE.Group();
  private choice = "total";  // layer of the cost map
  private height = 1;        // of the slice, world [m]
  private texture: THREE.DataTexture | undefined;
  private readonly plane: THREE.Mesh<THREE.PlaneGeometry, THREE.MeshBasicMaterial>;
  private drawn = "";

  constructor() {
    const material = new THREE.MeshBasicMaterial({ transparent: true, side: THREE.DoubleSide, depthWrite: false });
    this.plane = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), material);
    this.plane.visible = false;
    this.group.add(this.plane);
  }

  controls(onChange: () => void): HTMLElement {
    const place = document.createElement("span"), choice = document.createElement("select"), height = document.createElement("input");
    place.className = "choices";
    choice.append(...kChoices.map((name) => new Option(name.replace("_", " "), name, false, name === this.choice)));
    choice.setAttribute("aria-label", "Layer of the cost map");
    choice.addEventListener("change", () => {
      this.choice = choice.value;
      onChange();
    });
    Object.assign(height, { type: "range", min: "0", max: "2.2", step: "0.05", value: String(this.height) });
    height.setAttribute("aria-label", "Height of the slice in metres");
    height.addEventListener("input", () => {
      this.height = Number(height.value);
      onChange();
    });
    place.append(choice, height);
    return place;
  }

  show(source: Source): boolean {
    const map = source.newest("handsel/costmap", this.choice);
    const level = map && map.resolution > 0 ? Math.round((this.height - map.origin.z) / map.resolution) : -1;
    const there = map !== undefined && level >= 0 && level < map.nz && map.nx > 1 && map.ny > 1;
    const now = there ? [this.choice, map.revision, level, map.origin.x, map.origin.y].join() : "";
    if (now === this.drawn) return false;
    this.drawn = now;
    this.plane.visible = there;
    if (there) this.draw(map, level);
    return true;
  }

  private draw(map: Costmap, level: number): void {
    const { nx, ny, origin, resolution, values } = map, first = level * nx * ny;
    let texels = this.texture?.image.data as Uint8Array | undefined;
    if (!this.texture || !texels || this.texture.image.width !== nx || this.texture.image.height !== ny) {
      this.texture?.dispose();
      texels = new Uint8Array(4 * nx * ny);
      this.texture = new THREE.DataTexture(texels, nx, ny);
      this.texture.colorSpace = THREE.SRGBColorSpace;
      this.plane.material.map = this.texture;
      this.plane.material.needsUpdate = true;
    }
    for (let i = 0; i < nx * ny; ++i) {
      const value = values[first + i];
      const colour = kColours[Math.min(value, kMaxCost)];
      texels.set([255 * colour.r, 255 * colour.g, 255 * colour.b, value === kForbidden ? 0 : kOpacity], 4 * i);
    }
    this.texture.needsUpdate = true;
    this.plane.scale.set(nx * resolution, ny * resolution, 1);
    this.plane.position.set(origin.x + ((nx - 1) * resolution) / 2, origin.y + ((ny - 1) * resolution) / 2, origin.z + level * resolution);
  }
}
