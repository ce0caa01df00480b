// SPDX-License-Identifier: Apache-2.0
// A colour scale whose lightness grows steadily, so that it is read without colour vision.
import * as THREE from "three";

const kStops = [0x1f2d6b, 0x22659a, 0x20938c, 0x6dbb4f, 0xf6e11f].map((hex) => new THREE.Color(hex));

export const kScale = `linear-gradient(90deg, ${kStops.map((stop) => `#${stop.getHexString()}`).join(", ")})`;

// Returns the colour of a ratio, 0 to 1, clamped.
export function scaleColour(ratio: number, out = new THREE.Color()): THREE.Color {
  const x = Math.min(1, Math.max(0, ratio)) * (kStops.length - 1), i = Math.min(Math.floor(x), kStops.length - 2);
  return out.lerpColors(kStops[i], kStops[i + 1], x - i);
}
