// SPDX-License-Identifier: Apache-2.0
// The planned handover: the exchange point, and the hand of the person for which it is planned.
import * as THREE from "three";
import { ActionStatus } from "../messages";
import { dispose, kSphere, vector } from "../shapes";
import { Source } from "../source";
import { ghostHand } from "./hand_shape";
import { clear, Layer } from "./layer";

const kExchange = 0x8a5cf6;

export class HandoverLayer implements Layer {
  readonly id = "handover";
  readonly label = "planned handover";
  readonly colour = "#8a5cf6";
  readonly initially = true;
  readonly topics = [];
  readonly group = new THREE.Group();
  private drawn = "";

  show(source: Source): boolean {
    const action = source.newest("handsel/action_status");
    const planned = action && isPlanned(source, action) ? action : undefined;
    const { position: p, orientation: q } = planned?.T_world_partner_wrist ?? { position: undefined, orientation: undefined };
    const now = planned ? [...Object.values(planned.exchange_point), planned.has_partner, ...Object.values(p ?? {}), ...Object.values(q ?? {})].join() : "";
    if (now === this.drawn) return false;
    this.drawn = now;
    clear(this.group, dispose);
    if (!planned) return true;
    const material = new THREE.MeshBasicMaterial({ color: kExchange, transparent: true, opacity: 0.45 });
    const ball = new THREE.Mesh(kSphere, material);
    ball.scale.setScalar(0.03);
    vector(planned.exchange_point, ball.position);
    this.group.add(ball);
    if (planned.has_partner) this.group.add(ghostHand(source.word("BodySide", planned.partner_side) === "left", planned.T_world_partner_wrist, 0.5));
    return true;
  }
}

function isPlanned(source: Source, action: ActionStatus): boolean {
  const exchange = ["give", "receive"].includes(source.word("ActionKind", action.kind)) && source.word("ActionState", action.state) === "running";
  const { x, y, z } = action.exchange_point;
  return exchange && Boolean(x || y || z);
}
