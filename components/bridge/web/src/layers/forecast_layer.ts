// SPDX-License-Identifier: Apache-2.0
// Where hands of people are foreseen in the next half second: a ball of uncertainty at each time.
import * as THREE from "three";
import { dispose, kSphere, Rod, vector } from "../shapes";
import { Source } from "../source";
import { clear, Layer, Seen } from "./layer";

const kForecast = 0x0b7fa8;
const kSmallest = 0.02;  // min radius drawn [m]

export class ForecastLayer implements Layer {
  readonly id = "forecast";
  readonly label = "forecast of hands";
  readonly colour = "#0b7fa8";
  readonly initially = false;
  readonly topics = [];
  readonly group = new THREE.Group();
  private readonly seen = new Seen();

  show(source: Source): boolean {
    const humans = source.newest("handsel/human_state");
    if (!this.seen.changed(humans)) return false;
    clear(this.group, dispose);
    for (const { hands } of humans?.people ?? [])
      for (const { ahead } of hands)
        ahead.forEach(({ position, uncertainty }, i) => {
          const at = vector(position);
          const material = new THREE.MeshBasicMaterial({ color: kForecast, transparent: true, opacity: 0.28 - (0.2 * i) / ahead.length, depthWrite: false });
          const ball = new THREE.Mesh(kSphere, material);
          ball.scale.setScalar(Math.max(uncertainty, kSmallest));
          ball.position.copy(at);
          this.group.add(ball);
          if (i === 0) return;
          const rod = new Rod(0.004, kForecast);
          rod.place(vector(ahead[i - 1].position), at);
          this.group.add(rod.mesh);
        });
    return true;
  }
}
