#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the URDFs of our own hands and robots from the numbers below. Run it after changing a number; standard library only.

Shapes are primitives that enclose the real parts; inertias are those of the shapes filled evenly with the link's mass. Metres, kg, radians.
"""
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
DEG = math.pi / 180


# --- small linear algebra -------------------------------------------------------------------------------------------------------------
def mul(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transpose(a):
    return [[a[j][i] for j in range(3)] for i in range(3)]


def rpy(roll, pitch, yaw):
    cr, sr, cp, sp, cy, sy = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch), math.cos(yaw), math.sin(yaw)
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr]]


def to_rpy(R):
    pitch = math.atan2(-R[2][0], math.hypot(R[0][0], R[1][0]))
    if math.hypot(R[0][0], R[1][0]) > 1e-6:
        return math.atan2(R[2][1], R[2][2]), pitch, math.atan2(R[1][0], R[0][0])
    return math.atan2(-R[1][2], R[1][1]), pitch, 0.0


def numbers(values):
    return " ".join(f"{v:.9g}" if abs(v) > 1e-12 else "0" for v in values)


# --- shapes: (kind, sizes, xyz, rpy) ----------------------------------------------------------------------------------------------------
def box(x, y, z, at=(0, 0, 0), turn=(0, 0, 0)):
    return "box", (x, y, z), at, turn


def cylinder(radius, length, at=(0, 0, 0), turn=(0, 0, 0)):
    return "cylinder", (radius, length), at, turn


def sphere(radius, at=(0, 0, 0)):
    return "sphere", (radius,), at, (0, 0, 0)


def rod(radius, a, b):
    """A cylinder between two points."""
    d = [q - p for p, q in zip(a, b)]
    length = math.sqrt(sum(x * x for x in d))
    turn = (0, math.atan2(math.hypot(d[0], d[1]), d[2]), math.atan2(d[1], d[0]))
    return cylinder(radius, length, tuple((p + q) / 2 for p, q in zip(a, b)), turn)


def volume(shape):
    kind, s = shape[:2]
    return {"box": lambda: s[0] * s[1] * s[2], "cylinder": lambda: math.pi * s[0]**2 * s[1], "sphere": lambda: 4 / 3 * math.pi * s[0]**3}[kind]()


def inertia(shape, m):
    """About the shape's own centre, in the link's axes."""
    kind, s, _, turn = shape
    if kind == "box":
        d = [m / 12 * (s[1]**2 + s[2]**2), m / 12 * (s[0]**2 + s[2]**2), m / 12 * (s[0]**2 + s[1]**2)]
    elif kind == "cylinder":
        d = [m / 12 * (3 * s[0]**2 + s[1]**2)] * 2 + [m / 2 * s[0]**2]
    else:
        d = [0.4 * m * s[0]**2] * 3
    R = rpy(*turn)
    return mul(mul(R, [[d[0], 0, 0], [0, d[1], 0], [0, 0, d[2]]]), transpose(R))


# --- URDF -----------------------------------------------------------------------------------------------------------------------------
def link(name, mass=0.0, shapes=()):
    if not shapes:
        return [f'  <link name="{name}"/>']
    total = sum(volume(s) for s in shapes)
    com = [sum(volume(s) / total * s[2][i] for s in shapes) for i in range(3)]
    I = [[0.0] * 3 for _ in range(3)]
    for s in shapes:
        m = mass * volume(s) / total
        own, d = inertia(s, m), [s[2][i] - com[i] for i in range(3)]
        for i in range(3):
            for j in range(3):
                I[i][j] += own[i][j] + m * ((sum(x * x for x in d) if i == j else 0) - d[i] * d[j])
    out = [f'  <link name="{name}">', f'    <inertial><origin xyz="{numbers(com)}"/><mass value="{mass:g}"/>',
           f'      <inertia ixx="{I[0][0]:.4g}" ixy="{I[0][1]:.4g}" ixz="{I[0][2]:.4g}" iyy="{I[1][1]:.4g}" iyz="{I[1][2]:.4g}" '
           f'izz="{I[2][2]:.4g}"/></inertial>']
    for kind, sizes, at, turn in shapes:
        geometry = {"box": lambda: f'<box size="{numbers(sizes)}"/>', "sphere": lambda: f'<sphere radius="{sizes[0]:g}"/>',
                    "cylinder": lambda: f'<cylinder radius="{sizes[0]:g}" length="{sizes[1]:.6g}"/>'}[kind]()
        for use in ("visual", "collision"):
            out.append(f'    <{use}><origin xyz="{numbers(at)}" rpy="{numbers(turn)}"/><geometry>{geometry}</geometry></{use}>')
    return out + ["  </link>"]


def joint(name, kind, parent, child, xyz=(0, 0, 0), turn=(0, 0, 0), axis=None, limits=None, mimic=None, share=1):
    out = [f'  <joint name="{name}" type="{kind}">', f'    <parent link="{parent}"/><child link="{child}"/>',
           f'    <origin xyz="{numbers(xyz)}" rpy="{numbers(turn)}"/>']
    if axis:
        lower, upper, velocity, effort = limits
        out.append(f'    <axis xyz="{numbers(axis)}"/><limit lower="{lower:.6f}" upper="{upper:.6f}" velocity="{velocity:g}" effort="{effort:g}"/>')
    if mimic:
        out.append(f'    <mimic joint="{mimic}" multiplier="{share:g}" offset="0"/>')
    return out + ["  </joint>"]


# --- Schunk Anthropomorphic Hand, right (numbers of the published models of the hand) ----------------------------------------------------
PROXIMAL, MIDDLE, TIP, TIP_RADIUS = 0.067816, 0.029980, 0.029, 0.013
HAND_SPEED, HAND_EFFORT = 3.14, 4.0
FINGER_BASES = {
    "fore": ((-0.003, 0.04025, 0.15584), [[0, 0, 1], [0.0354751, -0.9993706, 0], [0.9993706, 0.0354751, 0]]),
    "middle": ((-0.003, 0, 0.16056), [[0, 0, 1], [0, -1, 0], [1, 0, 0]]),
    "ring": ((-0.003, -0.04025, 0.15584), [[0, 0, 1], [-0.0343239, -0.9994108, 0], [0.9994108, -0.0343239, 0]]),
}
THUMB_AXIS = (-0.003, 0.0271, 0)
THUMB_BASE = ((0, 0.0855, -0.10282), [[-0.0122170, 0.9999254, 0], [0.5735336, 0.0070074, -0.8191520], [-0.8190909, -0.0100076, -0.5735764]])


# [deg]: abduction, proximal, middle (and distal) joints, rotation of the thumb
SAH_RANGES = {"abduction": (-15, 15), "proximal": (-4, 75), "middle": (0, 75), "rotation": (0, 90)}


class Hand:
    """The hand, or one built like it: names begin with `prefix`, lengths are multiplied by `scale`; the left hand is the mirror image in y."""

    def __init__(self, prefix="", scale=1.0, left=False, ranges=None):
        self.prefix, self.scale, self.left, self.ranges = prefix, scale, left, ranges or SAH_RANGES

    def place(self, at):
        return tuple(self.scale * v * (-1 if self.left and i == 1 else 1) for i, v in enumerate(at))

    def turned(self, turn):
        if not self.left:
            return turn
        R = rpy(*turn)
        return to_rpy([[R[i][j] * (-1 if (i == 1) != (j == 1) else 1) for j in range(3)] for i in range(3)])

    def link(self, name, mass=0.0, shapes=()):
        shapes = [(kind, tuple(self.scale * v for v in sizes), self.place(at), self.turned(turn)) for kind, sizes, at, turn in shapes]
        return link(self.prefix + name, mass * self.scale**3, shapes)

    def joint(self, name, kind, parent, child, xyz=(0, 0, 0), turn=(0, 0, 0), range_of=None, mimic=None):
        axis = limits = None
        if range_of:
            axis = (0, 0, -1 if self.left else 1)
            limits = tuple(v * DEG for v in self.ranges[range_of]) + (HAND_SPEED, HAND_EFFORT * self.scale**2)
        return joint(self.prefix + name, kind, self.prefix + parent, self.prefix + child, self.place(xyz), self.turned(turn), axis, limits,
                     self.prefix + mimic if mimic else None)

    def finger(self, name, parent, at, R):
        """Abduction, proximal, middle, distal (mimics middle), then the centre of the fingertip."""
        along = (0, math.pi / 2, 0)
        out = self.joint(f"{name}_abduction", "revolute", parent, f"{name}_base", at, to_rpy(R), "abduction")
        out += self.link(f"{name}_base", 0.03, [sphere(0.012)])
        out += self.joint(f"{name}_proximal", "revolute", f"{name}_base", f"{name}_proximal_link", (0, 0, 0), (math.pi / 2, 0, 0), "proximal")
        out += self.link(f"{name}_proximal_link", 0.07, [cylinder(0.0125, PROXIMAL - 0.008, (PROXIMAL / 2, 0, 0), along)])
        out += self.joint(f"{name}_middle", "revolute", f"{name}_proximal_link", f"{name}_middle_link", (PROXIMAL, 0, 0), (0, 0, 0), "middle")
        out += self.link(f"{name}_middle_link", 0.035, [sphere(0.0125), cylinder(0.012, MIDDLE, (MIDDLE / 2, 0, 0), along)])
        out += self.joint(f"{name}_distal", "revolute", f"{name}_middle_link", f"{name}_distal_link", (MIDDLE, 0, 0), (0, 0, 0), "middle",
                          mimic=f"{name}_middle")
        out += self.link(f"{name}_distal_link", 0.03, [cylinder(0.012, TIP, (TIP / 2, 0, 0), along), sphere(TIP_RADIUS, (TIP, 0, 0))])
        out += self.joint(f"{name}_tip_fixed", "fixed", f"{name}_distal_link", f"{name}_tip", (TIP, 0, 0))
        return out + self.link(f"{name}_tip")

    def urdf(self):
        out = self.link("palm", 1.2, [cylinder(0.035, 0.042, (0, 0, 0.009)), box(0.05, 0.105, 0.112, (-0.008, 0, 0.084))])
        out += self.joint("thumb_rotation", "revolute", "palm", "thumb_carrier", THUMB_AXIS, (0, math.pi, 0), "rotation")
        out += self.link("thumb_carrier", 0.1, [rod(0.016, (0, 0.01, -0.08), THUMB_BASE[0])])
        out += self.finger("thumb", "thumb_carrier", *THUMB_BASE)
        for name, (at, R) in FINGER_BASES.items():
            out += self.finger(name, "palm", at, R)
        return out


# Wrist to tip of the middle finger: 0.300 m of the robot, 0.189 m of an adult of 1.75 m.
HUMAN_SCALE = 0.63
HUMAN_RANGES = {"abduction": (-20, 20), "proximal": (-20, 90), "middle": (0, 90), "rotation": (-10, 100)}


# --- Allegro hand, right (numbers of the maker's model): the palm faces +x, fingers along z --------------------------------------------------
ALLEGRO_TIP, ALLEGRO_EFFORT = 0.012, 0.7
ALLEGRO_FINGERS = [("fore", 0, (0, 0.0435, -0.001542), -5), ("middle", 4, (0, 0, 0.0007), 0), ("ring", 8, (0, -0.0435, -0.001542), 5)]


def allegro():
    def chain(parent, rows):
        out = []
        for number, xyz, turn, axis, limits, mass, shapes in rows:
            child = f"link_{number}"
            out += joint(f"joint_{number}", "revolute", parent, child, xyz, turn, axis, limits + (3.14, ALLEGRO_EFFORT)) + link(child, mass, shapes)
            parent = child
        return out, parent

    def tip(name, parent, along):
        return joint(f"{name}_tip_fixed", "fixed", parent, f"{name}_tip", (0, 0, along)) + link(f"{name}_tip")

    still = (0, 0, 0)
    out = link("palm", 0.4154, [box(0.0414, 0.112, 0.0448, (-0.009, 0, -0.023)), box(0.0414, 0.0538, 0.0428, (-0.009, -0.0253, -0.0667)),
                                box(0.0414, 0.072, 0.013, (-0.0093, -0.00557, -0.08874))])
    for name, n, at, roll in ALLEGRO_FINGERS:
        rows = [(n, at, (roll * DEG, 0, 0), (0, 0, 1), (-0.47, 0.47), 0.0119, [box(0.0196, 0.0275, 0.0164, (0, 0, 0.0082))]),
                (n + 1, (0, 0, 0.0164), still, (0, 1, 0), (-0.196, 1.61), 0.065, [rod(0.0125, (0, 0, 0), (0, 0, 0.054))]),
                (n + 2, (0, 0, 0.054), still, (0, 1, 0), (-0.174, 1.709), 0.0355, [rod(0.0125, (0, 0, 0), (0, 0, 0.0384))]),
                (n + 3, (0, 0, 0.0384), still, (0, 1, 0), (-0.227, 1.618), 0.0368,
                 [rod(0.0115, (0, 0, 0), (0, 0, 0.0267)), sphere(ALLEGRO_TIP, (0, 0, 0.0267))])]
        made, last = chain("palm", rows)
        out += made + tip(name, last, 0.0267)
    rows = [(12, (-0.0182, 0.019333, -0.045987), (0, -95 * DEG, -90 * DEG), (-1, 0, 0), (0.263, 1.396), 0.0176,
             [box(0.0358, 0.034, 0.0455, (-0.0179, 0.009, 0.0145))]),
            (13, (-0.027, 0.005, 0.0399), still, (0, 0, 1), (-0.105, 1.163), 0.0119, [box(0.0196, 0.0275, 0.0177, (0, 0, 0.00885))]),
            (14, (0, 0, 0.0177), still, (0, 1, 0), (-0.189, 1.644), 0.038, [rod(0.0125, (0, 0, 0), (0, 0, 0.0514))]),
            (15, (0, 0, 0.0514), still, (0, 1, 0), (-0.162, 1.719), 0.0388,
             [rod(0.0115, (0, 0, 0), (0, 0, 0.0423)), sphere(ALLEGRO_TIP, (0, 0, 0.0423))])]
    made, last = chain("palm", rows)
    return out + made + tip("thumb", last, 0.0423)


# --- Barrett hand (numbers of published models): two fingers spread together about z, each distal joint follows its middle joint -------------
BARRETT_TIP, BARRETT_DISTAL = 0.009, 1 / 3


def barrett():
    def finger(n, parent, at, turn):
        out = joint(f"finger_{n}", "revolute", parent, f"finger_{n}_middle_link", at, turn, (0, 0, -1), (0, 2.44, 2.0, 5))
        out += link(f"finger_{n}_middle_link", 0.1, [rod(0.0115, (0, 0.003, 0), (-0.069936, 0.003, 0))])
        out += joint(f"finger_{n}_distal", "revolute", f"finger_{n}_middle_link", f"finger_{n}_distal_link", (-0.069936, 0.003, 0), (0, 0, 0),
                     (0, 0, -1), (0, 0.838, 2.0, 5), mimic=f"finger_{n}", share=BARRETT_DISTAL)
        out += link(f"finger_{n}_distal_link", 0.06, [rod(0.009, (0, 0, 0), (-0.038, 0.034, 0)), sphere(BARRETT_TIP, (-0.038, 0.034, 0))])
        out += joint(f"finger_{n}_tip_fixed", "fixed", f"finger_{n}_distal_link", f"finger_{n}_tip", (-0.038, 0.034, 0))
        return out + link(f"finger_{n}_tip")

    quarter = math.pi / 2
    out = link("palm", 0.6, [cylinder(0.045, 0.042, (0, 0, 0.021)), box(0.026, 0.108, 0.026, (0, -0.011, 0.054)), box(0.076, 0.046, 0.014, (0, 0, 0.072))])
    for n, x, turning in ((1, 0.025, -1), (2, -0.025, 1)):
        name = "spread" if n == 1 else "spread_other"
        out += joint(name, "revolute", "palm", f"finger_{n}_base", (x, 0, 0.0415), (0, 0, -quarter), (0, 0, turning), (0, math.pi, 2.0, 5),
                     mimic=None if n == 1 else "spread")
        out += link(f"finger_{n}_base", 0.12, [cylinder(0.02, 0.03, (0, 0, 0.012)), box(0.05, 0.024, 0.026, (-0.025, 0, 0.012))])
        out += finger(n, f"finger_{n}_base", (-0.05, 0, 0.0339), (quarter, 0, 0))
    return out + finger(3, "palm", (0, -0.05, 0.0754), (quarter, 0, quarter))


# --- Jido: mobile platform, column, KUKA LWR 4+ mounted sideways, pan-tilt head ----------------------------------------------------------
ARM_BASE = ((0.165, -0.1105, 0.907), [[0, 1, 0], [0, 0, -1], [-1, 0, 0]])
# joint, height above the previous one, axis, limit [deg], [deg/s], [Nm], mass of the link [kg],
# shapes
ARM = [
    ("arm_a1", 0.11, (0, 0, 1), 170, 110, 176, 2.35, [cylinder(0.068, 0.15, (0, 0, 0.075)), sphere(0.083, (0, 0, 0.2005))]),
    ("arm_a2", 0.2005, (0, -1, 0), 120, 110, 176, 2.35, [cylinder(0.066, 0.2, (0, 0, 0.1))]),
    ("arm_e1", 0.2, (0, 0, 1), 170, 128, 100, 2.35, [cylinder(0.066, 0.15, (0, 0, 0.075)), sphere(0.081, (0, 0, 0.2))]),
    ("arm_a3", 0.2, (0, 1, 0), 120, 128, 100, 2.35, [cylinder(0.064, 0.2, (0, 0, 0.1))]),
    ("arm_a4", 0.2, (0, 0, 1), 170, 204, 100, 2.35, [cylinder(0.053, 0.13, (0, 0, 0.065))]),
    ("arm_a5", 0.19, (0, -1, 0), 120, 184, 38, 1.1, [sphere(0.058)]),
    ("arm_a6", 0.078, (0, 0, 1), 170, 184, 38, 0.25, [cylinder(0.035, 0.04)]),
]
WRIST_TO_HAND = 0.1105


def lwr(prefix, parent, arm, limits=None):
    """The arm's joints and links from `parent` on, and the name of its last link. `limits`: of single joints [deg]."""
    out = []
    for i, (name, height, axis, limit, speed, torque, mass, shapes) in enumerate(arm):
        child = f"{prefix}arm_link_{i + 1}"
        lower, upper = (limits or {}).get(name, (-limit, limit))
        out += joint(prefix + name, "revolute", parent, child, (0, 0, height), (0, 0, 0), axis,
                     (lower * DEG, upper * DEG, math.floor(speed * DEG * 1000) / 1000, torque))
        out += link(child, mass, shapes)
        parent = child
    return out, parent


def jido():
    out = link("base_link", 150, [box(0.68, 0.60, 0.36, (0, 0, 0.2)), box(0.26, 0.221, 0.70, (0.165, 0, 0.73))])
    out += joint("arm_mount", "fixed", "base_link", "arm_base", ARM_BASE[0], to_rpy(ARM_BASE[1]))
    out += link("arm_base", 2.0, [cylinder(0.08, 0.11, (0, 0, 0.055))])
    arm, parent = lwr("", "arm_base", ARM)
    out += arm
    out += joint("hand_mount", "fixed", parent, "palm", (0, 0, WRIST_TO_HAND - ARM[-1][1]))
    out += Hand().urdf()
    out += joint("head_pan", "revolute", "base_link", "pan_link", (0.243, 0, 1.244), (0, 0, 0), (0, 0, 1), (-170 * DEG, 170 * DEG, 2.0, 10))
    out += link("pan_link", 0.8, [cylinder(0.045, 0.12, (0, 0, -0.06))])
    out += joint("head_tilt", "revolute", "pan_link", "tilt_link", (0, 0, 0.06), (0, 0, 0), (0, -1, 0), (-45 * DEG, 30 * DEG, 2.0, 10))
    out += link("tilt_link", 0.8, [box(0.07, 0.2, 0.07, (0.03, 0, 0.04))])
    out += joint("camera_fixed", "fixed", "tilt_link", "camera", (0.057, 0, 0.046))
    return out + link("camera")


# --- Duo: two such arms and hands on a torso that leans, both shoulders tilted by 60 degrees (proportions of DLR's Justin) ------------------
TORSO_HEIGHT, TORSO_LINK = 0.7055, 0.300
HEAD = (0.088, 0, 0.2593)
SHOULDER = (0.088, 0.256, 0.190)
# The shoulder's joints begin at the intersection of axes 1 and 2.
DUO_ARM = [("arm_a1", 0.0, (0, 0, 1), 170, 110, 176, 2.35, [sphere(0.083)])] + [
    (name, 0.0 if name == "arm_a2" else height, *rest) for name, height, *rest in ARM[1:]]
DUO_WRIST = {"arm_a5": (-45, 80), "arm_a6": (-45, 135)}
DUO_WRIST_TO_HAND = 0.118


def duo():
    out = link("base_link", 120, [cylinder(0.30, 0.34, (0, 0, 0.22)), cylinder(0.13, 0.18, (0, 0, 0.48))])
    out += joint("torso_turn", "revolute", "base_link", "torso_base", (0, 0, 0.6), (0, 0, 0), (0, 0, 1), (-140 * DEG, 200 * DEG, 1.0, 400))
    out += link("torso_base", 8, [cylinder(0.11, 0.1, (0, 0, 0.04))])
    # Each link of the torso is followed by a counter-rotating joint: the chest stays
    # upright, both angles are measured from the vertical.
    parent = "torso_base"
    for name, at, lower, upper in (("torso_lower", TORSO_HEIGHT - 0.6, -70, 90), ("torso_upper", TORSO_LINK, -70, 90)):
        out += joint(name, "revolute", parent, f"{name}_link", (0, 0, at), (0, 0, 0), (0, 1, 0), (lower * DEG, upper * DEG, 0.8, 300))
        out += link(f"{name}_link", 6, [cylinder(0.075, 0.2, (0, 0, TORSO_LINK / 2))])
        child = "chest" if name == "torso_upper" else "torso_elbow"
        out += joint(f"{name}_back", "revolute", f"{name}_link", child, (0, 0, TORSO_LINK), (0, 0, 0), (0, -1, 0),
                     (lower * DEG, upper * DEG, 0.8, 300), mimic=name)
        if child == "torso_elbow":
            out += link(child, 2, [sphere(0.08)])
            parent = child
    out += link("chest", 14, [box(0.2, 0.24, 0.3, (0.03, 0, 0.08))])
    for side, prefix, sign in (("right", "", -1), ("left", "left_", 1)):
        # Axis 1 points outward and 30 degrees up, x of its frame down and inward; left: mirrored.
        z = (0, sign * math.sqrt(3) / 2, 0.5)
        y = (1, 0, 0)
        x = (y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0])
        R = [[x[i], y[i], z[i]] for i in range(3)]
        dock = (SHOULDER[0], sign * SHOULDER[1], SHOULDER[2])
        out += joint(f"{side}_dock", "fixed", "chest", f"{side}_shoulder", dock, to_rpy(R))
        out += link(f"{side}_shoulder", 2.0, [rod(0.075, (0, 0, -0.17), (0, 0, -0.04))])
        limits = DUO_WRIST if sign < 0 else {name: (-upper, -lower) for name, (lower, upper) in DUO_WRIST.items()}
        arm, last = lwr(prefix, f"{side}_shoulder", DUO_ARM, limits)
        out += arm
        out += joint(f"{side}_hand_mount", "fixed", last, f"{prefix}palm", (0, 0, DUO_WRIST_TO_HAND - ARM[-1][1]),
                     (0, 0, 0) if sign < 0 else (0, 0, math.pi))
        out += Hand(prefix, left=sign > 0).urdf()
    out += joint("head_pan", "revolute", "chest", "pan_link", HEAD, (0, 0, 0), (0, 0, 1), (-105 * DEG, 105 * DEG, 2.0, 10))
    out += link("pan_link", 0.8, [cylinder(0.045, 0.06, (0, 0, -0.01))])
    out += joint("head_tilt", "revolute", "pan_link", "tilt_link", (0, 0, 0.06), (0, 0, 0), (0, -1, 0), (-90 * DEG, 10 * DEG, 2.0, 10))
    out += link("tilt_link", 1.2, [box(0.09, 0.2, 0.09, (0.03, 0, 0.05))])
    out += joint("camera_fixed", "fixed", "tilt_link", "camera", (0.077, 0, 0.056))
    return out + link("camera")


def write(path, name, body):
    with open(os.path.join(HERE, path), "w") as f:
        f.write(f'<?xml version="1.0"?>\n<!-- Made by robots/generate.py; change numbers there. -->\n<robot name="{name}">\n')
        f.write("\n".join(body) + "\n</robot>\n")


write("../hands/sah/sah.urdf", "sah", Hand().urdf())
write("../hands/sah_left/sah_left.urdf", "sah_left", Hand("left_", left=True).urdf())
write("../hands/human_right/human_right.urdf", "human_right", Hand("", HUMAN_SCALE, False, HUMAN_RANGES).urdf())
write("../hands/human_left/human_left.urdf", "human_left", Hand("left_", HUMAN_SCALE, True, HUMAN_RANGES).urdf())
write("../hands/allegro/allegro.urdf", "allegro", allegro())
write("../hands/barrett/barrett.urdf", "barrett", barrett())
write("jido/jido.urdf", "jido", jido())
write("duo/duo.urdf", "duo", duo())
