#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes person.csv: somebody who walks up to the robot, looks, holds out both hands, brings what was taken to the chest, again and again.

Columns as Handsel's recordings have them: time [s], then <joint>.x .y .z [m] in frame "world" (z up, the robot's base at the origin) for
REP-155 joints. The recording was made up here: proportions of a body 1.72 m tall, minimum-jerk motion of its points, a little sway and noise.
From REPEAT on it can be played over and over (--repeat in perception.c).
"""
import math
import random
import sys

RATE = 15.0                   # rows a second; the publisher interpolates
STATURE = 1.72
PLACE = (1.40, -0.05)         # feet [m], facing -x
FROM = 1.6                    # walks up from this far behind that [m]
WALK = (0.5, 3.5)             # [s]
REPEAT = 5.0                  # [s]
PAUSE, REACH, HOLD, DRAW, BACK, REST = 6.5, 1.1, 1.9, 1.4, 1.0, 0.4  # [s]
HANDS = {"l_": (0.97, -0.31, 1.13), "r_": (0.95, 0.02, 1.09)}  # where the hands wait, palms [m]
DRAWN = 0.09                  # drawn back slowly, as one does while another still holds on [m]
CHEST = {"l_": (1.17, -0.16, 1.16), "r_": (1.17, 0.06, 1.14)}  # where they bring what they took

# Of the stature, facing +x: forward, to the left, up.
BODY = {
    "head": (0.01, 0, 0.93), "neck": (0, 0, 0.845), "torso": (0, 0, 0.72), "waist": (0, 0, 0.56),
    "hip": (0, 0.055, 0.53), "knee": (0, 0.055, 0.285), "ankle": (0, 0.055, 0.039),
    "shoulder": (0, 0.12, 0.818), "elbow": (0, 0.135, 0.632), "wrist": (0.02, 0.14, 0.486), "hand": (0.025, 0.14, 0.432),
}
SIDED = ("shoulder", "elbow", "wrist", "hand", "hip", "knee", "ankle")


def smooth(s):
    s = min(1.0, max(0.0, s))
    return s * s * s * (10 + s * (-15 + 6 * s))


def mix(a, b, s):
    return tuple(x + s * (y - x) for x, y in zip(a, b))


def standing(x, y):
    points = {}
    for name, (forward, left, up) in BODY.items():
        for side, sign in ((("l_", 1), ("r_", -1)) if name in SIDED else (("", 0),)):
            points[side + name] = (x - STATURE * forward, y - STATURE * sign * left, STATURE * up)
    return points


def lead_hand(points, side, hand):
    """An arm with the palm at `hand`, elbow down and out."""
    chain = [side + name for name in ("shoulder", "elbow", "wrist", "hand")]
    shoulder = points[chain[0]]
    length = [math.dist(points[a], points[b]) for a, b in zip(chain, chain[1:])]
    way = [h - s for h, s in zip(hand, shoulder)]
    far = max(1e-6, math.hypot(*way))
    wrist = tuple(h - length[2] * w / far for h, w in zip(hand, way))
    to = [w - s for w, s in zip(wrist, shoulder)]
    d = min(math.hypot(*to), length[0] + length[1] - 1e-6)
    along = [t / max(1e-6, math.hypot(*to)) for t in to]
    a = (length[0] ** 2 - length[1] ** 2 + d * d) / (2 * d)
    h = math.sqrt(max(0.0, length[0] ** 2 - a * a))
    out = (0.2, 0.35 if side == "r_" else -0.35, -0.9)   # back, outward of somebody who faces -x, down
    across = [o - al * sum(x * y for x, y in zip(out, along)) for o, al in zip(out, along)]
    across = [c / math.hypot(*across) for c in across]
    points[side + "elbow"] = tuple(s + a * al + h * c for s, al, c in zip(shoulder, along, across))
    points[side + "wrist"] = tuple(s + d * al for s, al in zip(shoulder, along))
    points[side + "hand"] = tuple(w + length[2] * x / far for w, x in zip(points[side + "wrist"], way))


def frame(t):
    walked = smooth((t - WALK[0]) / (WALK[1] - WALK[0]))
    lean = 0.004 * math.sin(1.9 * t)
    points = standing(PLACE[0] + (1 - walked) * FROM + lean, PLACE[1] + 0.003 * math.sin(1.3 * t))
    step = 2 * math.pi * walked * FROM / 1.3
    swing = 0.22 * math.sin(step) * (4 * walked * (1 - walked))
    for side, sign in (("l_", 1), ("r_", -1)):
        for joint, share in (("knee", 0.5), ("ankle", 1.0), ("wrist", -0.5), ("hand", -0.6)):
            x, y, z = points[side + joint]
            points[side + joint] = (x - sign * share * swing, y, z)
    t -= REPEAT + PAUSE
    if t <= 0:
        return points
    for side in ("l_", "r_"):
        rest = points[side + "hand"]
        far = HANDS[side]
        back = t - REACH - HOLD - DRAW
        hand = mix(rest, (far[0] + DRAWN * smooth((back + DRAW) / DRAW), far[1], far[2]), smooth(t / REACH))
        if back > 0:
            hand = mix(hand, CHEST[side], smooth(back / BACK))
            hand = mix(hand, rest, smooth((back - 0.6 * BACK) / (0.4 * BACK + REST)))
        lead_hand(points, side, hand)
    return points


def main():
    random.seed(1)
    joints = [side + name for name in BODY for side in (("l_", "r_") if name in SIDED else ("",))]
    rows = ["time," + ",".join(f"{joint}.{axis}" for joint in joints for axis in "xyz")]
    for i in range(int(RATE * (REPEAT + PAUSE + REACH + HOLD + DRAW + BACK + REST)) + 1):
        points = frame(i / RATE)
        rows.append(f"{i / RATE:.3f}," + ",".join(f"{v + random.gauss(0, 0.002):.3f}" for joint in joints for v in points[joint]))
    with open(sys.argv[1] if len(sys.argv) > 1 else "person.csv", "w") as out:
        out.write("\n".join(rows) + "\n")


main()
