// SPDX-License-Identifier: Apache-2.0
// Short texts over the 3-D view, placed without overlap.
import * as THREE from "three";

interface Label { element: HTMLElement; at: THREE.Vector3 }

export class Labels {
  private readonly layer = document.createElement("div");
  private readonly pool: Label[] = [];
  private used = 0;

  constructor(stage: HTMLElement) {
    this.layer.className = "labels";
    stage.append(this.layer);
  }

  clear(): void {
    this.used = 0;
  }

  add(text: string, at: THREE.Vector3, kind: string): void {
    if (this.used === this.pool.length) {
      const element = document.createElement("span");
      this.layer.append(element);
      this.pool.push({ element, at: new THREE.Vector3() });
    }
    const label = this.pool[this.used++];
    if (label.element.textContent !== text) label.element.textContent = text;
    if (label.element.className !== kind) label.element.className = kind;
    label.at.copy(at);
  }

  place(camera: THREE.Camera, width: number, height: number): void {
    const taken: { x: number; y: number; w: number; h: number }[] = [];
    this.pool.forEach(({ element, at }, i) => {
      const p = at.clone().project(camera);
      const seen = i < this.used && p.z < 1 && Math.abs(p.x) < 1 && Math.abs(p.y) < 1;
      element.hidden = !seen;
      if (!seen) return;
      const w = element.offsetWidth, h = element.offsetHeight;
      const x = Math.min(Math.max(((p.x + 1) / 2) * width - w / 2, 4), width - w - 4);
      let y = ((1 - p.y) / 2) * height - h / 2;
      for (const other of taken)
        if (Math.abs(x + w / 2 - other.x - other.w / 2) < (w + other.w) / 2 && Math.abs(y - other.y) < h + 2) y = other.y - h - 3;
      y = Math.min(Math.max(y, 4), height - h - 4);
      taken.push({ x, y, w, h });
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    });
  }
}
