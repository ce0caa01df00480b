// SPDX-License-Identifier: Apache-2.0
// The layers of the 3-D view and the menu that switches them. The choice is in the address of the
// page (?layers=path,zones) and is kept by the browser.
import * as THREE from "three";
import { TopicName } from "../messages";
import { Source } from "../source";
import { Layer } from "./layer";

const kKept = "handsel-layers";  // of this browser
const kParameter = "layers";     // of the address

export class Layers {
  readonly group = new THREE.Group();
  private readonly boxes = new Map<string, HTMLInputElement>();

  // `onChange` is called after a layer was switched or set differently.
  constructor(private readonly layers: Layer[], menu: HTMLElement, private readonly onChange: () => void) {
    const chosen = stored();
    for (const layer of layers) {
      this.group.add(layer.group);
      layer.group.visible = chosen?.has(layer.id) ?? layer.initially;
      menu.append(this.row(layer));
    }
  }

  // Returns the topics that the layers need which are on.
  topics(): TopicName[] {
    return this.layers.filter(({ group }) => group.visible).flatMap(({ topics }) => topics);
  }

  // Returns true if the picture would change.
  show(source: Source): boolean {
    let changed = false;
    for (const layer of this.layers) if (layer.group.visible) changed = layer.show(source) || changed;
    return changed;
  }

  find(id: string): Layer | undefined {
    return this.layers.find((layer) => layer.id === id);
  }

  // Switches one layer; the menu, the address and the browser's memory follow.
  switch(id: string, on: boolean): void {
    const layer = this.find(id), box = this.boxes.get(id);
    if (!layer || !box) return;
    layer.group.visible = box.checked = on;
    box.closest("li")?.classList.toggle("on", on);
    store(this.layers.filter(({ group }) => group.visible).map((shown) => shown.id));
    this.onChange();
  }

  private row(layer: Layer): HTMLElement {
    const row = document.createElement("li"), label = document.createElement("label"), box = document.createElement("input"), swatch = document.createElement("i");
    box.type = "checkbox";
    box.value = layer.id;
    box.checked = layer.group.visible;
    box.addEventListener("change", () => this.switch(layer.id, box.checked));
    swatch.style.background = layer.colour;
    label.append(box, swatch, layer.label);
    row.append(label);
    row.classList.toggle("on", box.checked);
    if (layer.controls) row.append(layer.controls(this.onChange));
    this.boxes.set(layer.id, box);
    return row;
  }
}

function stored(): Set<string> | undefined {
  const text = new URLSearchParams(location.search).get(kParameter) ?? localStorage.getItem(kKept);
  return text === null ? undefined : new Set(text.split(",").filter(Boolean));
}

function store(ids: string[]): void {
  localStorage.setItem(kKept, ids.join(","));
  const address = new URL(location.href);
  address.searchParams.set(kParameter, ids.join(","));
  history.replaceState(null, "", address);
}
