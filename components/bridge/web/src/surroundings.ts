// SPDX-License-Identifier: Apache-2.0
// Light, floor and grid of the 3-D view.
import * as THREE from "three";

export class Surroundings {
  readonly group = new THREE.Group();
  private readonly floor = new THREE.Mesh(new THREE.PlaneGeometry(12, 12), new THREE.ShadowMaterial({ opacity: 0.22 }));
  private readonly grid = new THREE.LineSegments(gridLines(4, 0.5), new THREE.LineBasicMaterial({ vertexColors: true, transparent: true }));

  constructor(shadows: boolean) {
    const sun = new THREE.DirectionalLight(0xffffff, 2.1);
    sun.position.set(-1.2, -2.4, 4);
    sun.target.position.set(0.7, -0.2, 0.6);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    sun.shadow.radius = 3;
    sun.shadow.bias = -0.0006;
    sun.shadow.normalBias = 0.02;
    Object.assign(sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, near: 1, far: 8 });
    this.floor.position.z = -0.002;
    this.floor.receiveShadow = true;
    this.floor.visible = shadows;
    this.group.add(sun, sun.target, new THREE.HemisphereLight(0xffffff, 0x9aa3ad, 1.5), this.floor, this.grid);
  }

  // Takes the colours of the page; returns that of the background.
  theme(): THREE.Color {
    const colour = (name: string): THREE.Color => new THREE.Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim());
    this.grid.material.color.copy(colour("--grid"));
    return colour("--stage");
  }
}

// Returns a square grid that fades out toward its edge.
function gridLines(half: number, step: number): THREE.BufferGeometry {
  const points: number[] = [], shades: number[] = [];
  const add = (x: number, y: number): void => {
    points.push(x, y, 0);
    shades.push(1, 1, 1, Math.max(0, 1 - Math.hypot(x, y) / half) ** 0.7);
  };
  for (let u = -half; u <= half; u += step) {
    for (let v = -half; v < half; v += step) {
      add(u, v);
      add(u, v + step);
      add(v, u);
      add(v + step, u);
    }
  }
  return new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(points, 3))
    .setAttribute("color", new THREE.Float32BufferAttribute(shades, 4));
}
