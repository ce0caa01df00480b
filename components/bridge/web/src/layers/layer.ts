// SPDX-License-Identifier: Apache-2.0
// A layer of the 3-D view that a viewer switches on and off.
import * as THREE from "three";
import { TopicName } from "../messages";
import { Source } from "../source";

export interface Layer {
  readonly id: string;
  readonly label: string;
  readonly colour: string;      // CSS colour or gradient of its legend
  readonly initially: boolean;  // on when the viewer has chosen nothing
  readonly topics: TopicName[]; // read only while the layer is on
  readonly group: THREE.Group;
  // Makes what the viewer chooses within the layer; `onChange` is called after a choice.
  controls?(onChange: () => void): HTMLElement;
  // Takes the newest samples; returns true if the picture would change.
  show(source: Source): boolean;
}

// Detects that a sample is a new one.
export class Seen {
  private last: unknown;

  // Returns true when `sample` is another one than at the last call.
  changed(sample: unknown): boolean {
    if (sample === this.last) return false;
    this.last = sample;
    return true;
  }
}

// Removes and frees all children.
export function clear(group: THREE.Group, free: (object: THREE.Object3D) => void): void {
  for (const child of [...group.children]) free(child);
}
