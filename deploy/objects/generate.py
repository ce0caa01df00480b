#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the meshes and descriptions of the objects in this folder from the sizes below. Standard library only. Metres, kg.

Origin: middle of the body, z up. Every mesh is closed and its triangles are about 8 mm wide, so that contacts and curvature are resolved.
"""
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
STEP = 0.008


class Mesh:
    def __init__(self):
        self.vertices, self.faces = [], []

    def add(self, p):
        self.vertices.append(p)
        return len(self.vertices)

    def quad(self, a, b, c, d):
        self.faces += [(a, b, c), (a, c, d)]

    def strip(self, rings):
        """Joins neighbouring rings of equal size; a ring of one vertex is a pole. Outside is to the right of the way, seen from above."""
        for low, high in zip(rings, rings[1:]):
            n = max(len(low), len(high))
            for k in range(n):
                a, b = low[k % len(low)], low[(k + 1) % len(low)]
                c, d = high[(k + 1) % len(high)], high[k % len(high)]
                if len(low) == 1:
                    self.faces.append((a, c, d))
                elif len(high) == 1:
                    self.faces.append((a, b, d))
                else:
                    self.quad(a, b, c, d)

    def write(self, name):
        with open(os.path.join(HERE, name, name + ".obj"), "w") as f:
            f.write(f"# made by objects/generate.py\no {name}\n")
            f.writelines("v " + " ".join(f"{x:.6g}" for x in v) + "\n" for v in self.vertices)
            f.writelines("f {} {} {}\n".format(*t) for t in self.faces)


def refine(profile):
    out = [profile[0]]
    for (r0, z0), (r1, z1) in zip(profile, profile[1:]):
        n = max(1, round(math.hypot(r1 - r0, z1 - z0) / STEP))
        out += [(r0 + (r1 - r0) * i / n, z0 + (z1 - z0) * i / n) for i in range(1, n + 1)]
    return out


def around(radius):
    """Returns the number of facets around a body of revolution."""
    return max(16, round(2 * math.pi * radius / STEP))


def revolve(profile):
    """A body of revolution; the profile of (radius, z) runs from the axis at the bottom, outside up, to the axis again."""
    mesh, segments = Mesh(), around(max(r for r, _ in profile))
    rings = []
    for r, z in refine(profile):
        if r < 1e-9:
            rings.append([mesh.add((0, 0, z))])
        else:
            rings.append([mesh.add((r * math.cos(2 * math.pi * k / segments), r * math.sin(2 * math.pi * k / segments), z)) for k in range(segments)])
    mesh.strip(rings)
    return mesh


def add_handle(mesh, radius, reach, half_height, thickness):
    """A bow from the wall at +x back to the wall, closed by its ends inside the wall."""
    around, along, rings = 10, 14, []
    for i in range(along + 1):
        t = math.pi * (i / along - 0.5)
        centre = (radius + reach * math.cos(t), half_height * math.sin(t))
        tangent = (-reach * math.sin(t), half_height * math.cos(t))
        norm = math.hypot(*tangent)
        out = (tangent[1] / norm, -tangent[0] / norm)
        ring = []
        for k in range(around):
            u, v = thickness * math.cos(2 * math.pi * k / around), thickness * math.sin(2 * math.pi * k / around)
            ring.append(mesh.add((centre[0] + u * out[0], v, centre[1] + u * out[1])))
        rings.append(ring)
    first = [mesh.add((radius, 0, -half_height))]
    last = [mesh.add((radius, 0, half_height))]
    mesh.strip([first] + rings + [last])


def block(x, y, z):
    mesh, known = Mesh(), {}
    n = [max(1, round(s / (1.5 * STEP))) for s in (x, y, z)]

    def vertex(i):
        if i not in known:
            known[i] = mesh.add(tuple(s * (k / m - 0.5) for s, k, m in zip((x, y, z), i, n)))
        return known[i]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for i in range(n[u]):
            for j in range(n[v]):
                for side in (0, n[axis]):
                    def at(a, b):
                        c = [0, 0, 0]
                        c[axis], c[u], c[v] = side, a, b
                        return vertex(tuple(c))
                    corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
                    mesh.quad(*(corners if side else corners[::-1]))
    return mesh


def ball(radius):
    n = round(math.pi * radius / STEP)
    profile = [(radius * math.sin(math.pi * i / n), -radius * math.cos(math.pi * i / n)) for i in range(n + 1)]
    profile[0], profile[-1] = (0, -radius), (0, radius)
    return revolve(profile)


def describe(name, text, mesh, mass, friction, parts, com=None, max_tilt=None):
    os.makedirs(os.path.join(HERE, name), exist_ok=True)
    mesh.write(name)
    with open(os.path.join(HERE, name, name + ".txtpb"), "w") as f:
        f.write(f'# {text} Made by objects/generate.py.\nname: "{name}"\nmesh: "{name}.obj"\n')
        f.writelines(f"parts {{ {p} }}\n" for p in parts)
        f.write(f"mass: {mass:g}\nfriction: {friction:g}\n")
        if com:
            f.write("com {{ x: {:g} y: {:g} z: {:g} }}\n".format(*com))
        if max_tilt:
            f.write(f"max_tilt: {max_tilt:g}\n")


def at(x, y, z, roll=0.0, pitch=0.0):
    turn = f" rpy {{ x: {roll:g} y: {pitch:.6g} }}" if roll or pitch else ""
    return f"pose {{ xyz {{ x: {x:g} y: {y:g} z: {z:g} }}{turn} }}"


def cup_walls(R, H, wall, bottom):
    """Walls of an open cup: boxes around it, and its bottom. Narrower boxes make contacts with strong fingers tremble."""
    n = 16
    middle, width, thick = (R - wall / 2) * math.cos(math.pi / n), 2 * R * math.sin(math.pi / n), wall * math.cos(math.pi / n)
    out = [f"{at(0, 0, (bottom - H) / 2)} cylinder {{ radius: {R} length: {bottom} }}"]
    for k in range(n):
        yaw = 2 * math.pi * (k + 0.5) / n
        pose = f"pose {{ xyz {{ x: {middle * math.cos(yaw):.6f} y: {middle * math.sin(yaw):.6f} z: {bottom / 2:g} }} rpy {{ z: {yaw:.6f} }} }}"
        out.append(f"{pose} box {{ x: {thick:.6f} y: {width:.6f} z: {H - bottom:g} }}")
    return "".join(f"\n  walls {{ {w} }}" for w in out)


def mug(name, text, mass, com, max_tilt=None):
    R, H, wall, bottom = 0.040, 0.095, 0.004, 0.006
    reach, half, thick = 0.028, 0.028, 0.006
    h = H / 2
    mesh = revolve([(0, -h), (R, -h), (R, h), (R - wall, h), (R - wall, -h + bottom), (0, -h + bottom)])
    add_handle(mesh, R - wall / 2, reach + wall / 2, half, thick)
    describe(name, text, mesh, mass, 0.6,
             [f"cylinder {{ radius: {R} length: {H} }}{cup_walls(R, H, wall, bottom)}\n",
              f"{at(R + 0.6 * reach, 0, half, 0, math.pi / 2)} capsule {{ radius: {thick} length: {reach:g} }}",
              f"{at(R + reach - thick / 2, 0, 0)} capsule {{ radius: {thick} length: {2 * half:g} }}",
              f"{at(R + 0.6 * reach, 0, -half, 0, math.pi / 2)} capsule {{ radius: {thick} length: {reach:g} }}"], com, max_tilt)


def bottle():
    R, neck, H, shoulder = 0.033, 0.014, 0.22, 0.13
    h = H / 2
    mesh = revolve([(0, -h), (R, -h), (R, -h + shoulder), (neck, -h + shoulder + 0.045), (neck, h), (0, h)])
    cone = shoulder + 0.0225
    describe("bottle", "A half-full bottle of 0.5 l.", mesh, 0.35, 0.6,
             [f"{at(0, 0, -h + shoulder / 2)} cylinder {{ radius: {R} length: {shoulder} }}",
              f"{at(0, 0, -h + cone)} cylinder {{ radius: {(R + neck) / 2:g} length: 0.045 }}",
              f"{at(0, 0, h - (H - shoulder - 0.045) / 2)} cylinder {{ radius: {neck} length: {H - shoulder - 0.045:g} }}"], (0, 0, -0.04))


def can():
    R, H = 0.033, 0.115
    describe("can", "A full drinks can.", revolve([(0, -H / 2), (R, -H / 2), (R, H / 2), (0, H / 2)]), 0.35, 0.5,
             [f"cylinder {{ radius: {R} length: {H} }}"])


def torch():
    R, head, r, H = 0.027, 0.055, 0.018, 0.19
    h = H / 2
    mesh = revolve([(0, -h), (R, -h), (R, -h + head), (r, -h + head + 0.02), (r, h), (0, h)])
    handle = H - head - 0.02
    describe("torch", "A torch that stands on its head, its handle upward.", mesh, 0.28, 0.6,
             [f"{at(0, 0, -h + head / 2)} cylinder {{ radius: {R} length: {head} }}",
              f"{at(0, 0, -h + head + 0.01)} cylinder {{ radius: {(R + r) / 2:g} length: 0.02 }}",
              f"{at(0, 0, h - handle / 2)} cylinder {{ radius: {r} length: {handle:g} }}"], (0, 0, -0.02))


def tube():
    R, H = 0.028, 0.32
    describe("tube", "A long cardboard tube with its ends closed, standing.",
             revolve([(0, -H / 2), (R, -H / 2), (R, H / 2), (0, H / 2)]), 0.22, 0.6,
             [f"cylinder {{ radius: {R} length: {H} }}"])


def merge(mesh, other, x, y, z):
    """Adds a body that is closed by itself; where bodies overlap they are one thing."""
    before = len(mesh.vertices)
    mesh.vertices += [(a + x, b + y, c + z) for a, b, c in other.vertices]
    mesh.faces += [tuple(i + before for i in f) for f in other.faces]


def tray():
    length, width, thick = 0.56, 0.22, 0.02
    apart, R, stem, high = 0.235, 0.035, 0.012, 0.09  # knobs: distance, radius, stem, height [m]
    middle = (high + R - thick / 2) / 2  # of the whole object
    mesh = block(length, width, thick)
    start = math.asin(stem / R)
    n = round((math.pi - start) * R / STEP)
    arc = [start + (math.pi - start) * i / n for i in range(1, n)]
    profile = [(0, -thick / 4), (stem, -thick / 4), (stem, high - R * math.cos(start))]
    profile += [(R * math.sin(a), high - R * math.cos(a)) for a in arc] + [(0, high + R)]
    for side in (1, -1):
        merge(mesh, revolve(profile), side * apart, 0, 0)
    mesh.vertices = [(x, y, z - middle) for x, y, z in mesh.vertices]
    describe("tray", "A laden tray with a knob on a stem to hold at either end, along x.", mesh, 3.0, 0.6,
             [f"{at(0, 0, -middle)} box {{ x: {length} y: {width} z: {thick} }}"] +
             [p for side in (1, -1) for p in (f"{at(side * apart, 0, high - middle)} sphere: {R}",
                                              f"{at(side * apart, 0, high / 2 - middle)} cylinder {{ radius: {stem} length: {high:g} }}")],
             (0, 0, 0.04 - middle))


mug("mug", "An empty mug of 0.3 l with its handle toward +x.", 0.32, (0.003, 0, -0.008))
mug("full_mug", "The mug, filled to 0.2 l.", 0.52, (0.002, 0, -0.009), 0.35)
bottle()
can()
torch()
tube()
tray()
describe("box", "A small carton.", block(0.055, 0.085, 0.13), 0.25, 0.6, ["box { x: 0.055 y: 0.085 z: 0.13 }"])
describe("ball", "A rubber ball.", ball(0.036), 0.15, 0.8, ["sphere: 0.036"])
