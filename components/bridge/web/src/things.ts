// SPDX-License-Identifier: Apache-2.0
// Objects by their meshes and furniture as boxes.
import * as THREE from "three";
import { OBJLoader } from "three/examples/jsm/loaders/OBJLoader.js";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";
import { mergeVertices, toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { Config } from "./config";
import { PrimitiveKind, Scene, SceneBox, SceneObject } from "./messages";
import { dispose, kSphere, setPose } from "./shapes";

const kFloor = "floor";  // the page draws its own floor
const kUnknownSize = 0.04;  // radius of an object without a mesh [m]
const kSurePlace = 0.02;    // max uncertainty of an object drawn solid, not pale [m]
const kObject = 0xd6336c, kUnknown = 0xb06ab3, kWood = 0xdcc39b, kEdge = 0xa08259;

async function loadMesh(url: string): Promise<THREE.BufferGeometry> {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: HTTP ${answer.status}`);
  let geometry: THREE.BufferGeometry | undefined;
  if (url.toLowerCase().endsWith(".stl")) {
    geometry = new STLLoader().parse(await answer.arrayBuffer());
  } else {
    new OBJLoader().parse(await answer.text()).traverse((part) => {
      if ((part as THREE.Mesh).isMesh) geometry ??= (part as THREE.Mesh).geometry;
    });
  }
  if (!geometry) throw new Error(`${url} holds no mesh`);
  geometry.deleteAttribute("normal");
  geometry.deleteAttribute("uv");
  return toCreasedNormals(mergeVertices(geometry), 0.6);
}

// One metre in each direction; axis along z.
const kCube = new THREE.BoxGeometry(1, 1, 1), kCan = new THREE.CylinderGeometry(0.5, 0.5, 1, 32).rotateX(Math.PI / 2),
      kBall = new THREE.SphereGeometry(0.5, 32, 16);

function primitive(kind: PrimitiveKind): THREE.BufferGeometry | undefined {
  return kind === PrimitiveKind.box ? kCube : kind === PrimitiveKind.cylinder ? kCan : kind === PrimitiveKind.sphere ? kBall : undefined;
}

export class Things {
  readonly group = new THREE.Group();
  private readonly objects = new Map<string, THREE.Mesh<THREE.BufferGeometry, THREE.MeshLambertMaterial>>();
  private readonly boxes = new Map<string, THREE.Mesh>();
  private readonly meshes = new Map<string, Promise<THREE.BufferGeometry>>();

  constructor(private readonly config: Config, private readonly onLoad: () => void, private readonly onProblem: (sentence: string) => void) {}

  show(scene: Scene): boolean {
    let changed = forget(this.objects, scene.objects) || false;
    const furniture = scene.boxes.filter((box) => box.id !== kFloor);
    changed = forget(this.boxes, furniture) || changed;
    for (const object of scene.objects) {
      const mesh = this.object(object);
      changed = setPose(mesh, object.T_world_object) || changed;
      const pale = object.uncertainty > kSurePlace;
      if (mesh.material.transparent !== pale) {
        mesh.material.transparent = pale;
        mesh.material.opacity = pale ? 0.35 : 1;
        mesh.material.needsUpdate = changed = true;
      }
      const shape = object.model ? undefined : primitive(object.primitive.kind);
      const size = new THREE.Vector3(object.primitive.size.x, object.primitive.size.y, object.primitive.size.z);
      if (!shape || (mesh.geometry === shape && mesh.scale.equals(size))) continue;
      mesh.geometry = shape;
      mesh.material.color.set(kUnknown);
      mesh.scale.copy(size);
      changed = true;
    }
    for (const box of furniture) {
      const mesh = this.box(box);
      changed = setPose(mesh, box.T_world_box) || changed;
      const size = new THREE.Vector3(box.size.x, box.size.y, box.size.z);
      if (!mesh.scale.equals(size)) {
        mesh.scale.copy(size);
        changed = true;
      }
    }
    return changed;
  }

  *labels(): Iterable<[string, THREE.Vector3]> {
    for (const [id, mesh] of this.objects) yield [id, mesh.position.clone().add(new THREE.Vector3(0, 0, 0.13))];
  }
  first(): THREE.Object3D | undefined {
    return [...this.objects.values()][0];
  }

  private object(object: SceneObject): THREE.Mesh<THREE.BufferGeometry, THREE.MeshLambertMaterial> {
    const known = this.objects.get(object.id);
    if (known) return known;
    const mesh = new THREE.Mesh<THREE.BufferGeometry, THREE.MeshLambertMaterial>(
      kSphere, new THREE.MeshLambertMaterial({ color: kObject, side: THREE.DoubleSide }));
    mesh.castShadow = true;
    mesh.scale.setScalar(kUnknownSize);
    mesh.position.set(NaN, NaN, NaN);
    this.objects.set(object.id, mesh);
    this.group.add(mesh);
    const url = this.config.objects[object.model]?.mesh;
    if (url) {
      if (!this.meshes.has(url)) this.meshes.set(url, loadMesh(url));
      this.meshes.get(url)?.then(
        (geometry) => {
          mesh.geometry = geometry.clone();
          mesh.scale.setScalar(1);
          this.onLoad();
        },
        (error: Error) => this.onProblem(`The mesh of ${object.id} cannot be shown: ${error.message}.`));
    }
    return mesh;
  }

  private box(box: SceneBox): THREE.Mesh {
    const known = this.boxes.get(box.id);
    if (known) return known;
    const geometry = new THREE.BoxGeometry(1, 1, 1);
    const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color: kWood }));
    mesh.receiveShadow = mesh.castShadow = true;
    mesh.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry), new THREE.LineBasicMaterial({ color: kEdge })));
    this.boxes.set(box.id, mesh);
    this.group.add(mesh);
    return mesh;
  }
}

function forget(known: Map<string, THREE.Object3D>, now: { id: string }[]): boolean {
  let changed = false;
  for (const [id, object] of known) {
    if (now.some((thing) => thing.id === id)) continue;
    dispose(object);
    known.delete(id);
    changed = true;
  }
  return changed;
}
