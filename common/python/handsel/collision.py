# SPDX-License-Identifier: Apache-2.0
"""Collisions and distances of a robot, of obstacles of any shape, and of people.

    world = collision.World(model.Robot("jido"))
    world.set_obstacles([collision.Obstacle("lamp", collision.Box(0.2, 0.2, 0.2), pose)])
    world.set_people([model.Person.standing([1.5, 0, 0], yaw=3.14)])
    world.check(q)          # Verdict: free, first, second
    world.to_people(qs)     # Distances: distance, on_robot, on_other

Exact (FCL) on the collision shapes of the description; people are capsules. Poses are 4 x 4, in the
world.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _model
from .model import Person, Robot

__all__ = ["Box", "Capsule", "Cylinder", "Distances", "Mesh", "Obstacle", "ShapeDistance", "Sphere",
           "Verdict", "World", "shape_distance"]


class Box(NamedTuple):
    """A box by its full extents."""

    x: float  #: [m]
    y: float  #: [m]
    z: float  #: [m]


class Sphere(NamedTuple):
    """A sphere."""

    radius: float  #: [m]


class Cylinder(NamedTuple):
    """A cylinder along z."""

    radius: float  #: [m]
    length: float  #: along z [m]


class Capsule(NamedTuple):
    """A capsule along z."""

    radius: float  #: [m]
    length: float  #: of the straight part, along z [m]


class Mesh:
    """A triangle mesh: a file (STL, OBJ, PLY, DAE), or vertices (n, 3) [m] with triangles (m, 3) of
    their indices. Raises MissingError and DescriptionError of handsel.model when it is used."""

    __slots__ = ("_native",)

    def __init__(self, file_or_vertices: Union[str, os.PathLike, ArrayLike],
                 triangles: Optional[ArrayLike] = None):
        if isinstance(file_or_vertices, (str, os.PathLike)):
            if triangles is not None:
                raise TypeError("a mesh is a file, or vertices and triangles, not both.")
            self._native = ("file", os.fspath(file_or_vertices))
        elif triangles is None:
            raise TypeError("a mesh of vertices needs triangles.")
        else:
            self._native = ("mesh", np.array(file_or_vertices), np.array(triangles))


Shape = Union[Box, Sphere, Cylinder, Capsule, Mesh]


class Obstacle(NamedTuple):
    """A fixed obstacle."""

    name: str  #: for the verdict
    shape: Shape  #: in its own frame
    pose: ArrayLike  #: T_world_shape, shape (4, 4)


class Verdict(NamedTuple):
    """Result of a check; true where nothing touches."""

    free: bool  #: nothing touches
    first: str  #: what touches, e.g. "link forearm"; empty when free
    second: str  #: what is touched, e.g. "box lamp", "person anna"; empty when free

    def __bool__(self) -> bool:
        return self.free


class Distances(NamedTuple):
    """Distances of configurations, with the points nearest to each other in the world."""

    distance: NDArray[np.float64]  #: one a configuration [m]; infinite where there is nothing
    on_robot: NDArray[np.float64]  #: shape (n, 3) [m]; NaN where there is nothing or a contact
    on_other: NDArray[np.float64]  #: shape (n, 3) [m]


class ShapeDistance(NamedTuple):
    """Result of shape_distance()."""

    collide: bool  #: the shapes touch
    distance: float  #: [m]; 0 when they touch


def _shape(value: Shape) -> tuple:
    if isinstance(value, Mesh):
        return value._native
    if isinstance(value, (Box, Sphere, Cylinder, Capsule)):
        return (type(value).__name__.lower(), list(value))
    raise TypeError("a shape must be a Box, Sphere, Cylinder, Capsule or Mesh, not "
                    f"{type(value).__name__}.")


def _people(people: Iterable[Person]) -> list:
    if isinstance(people, Person) or not isinstance(people, Iterable):
        raise TypeError(f"people must be a list of Person, not {type(people).__name__}.")
    out = list(people)
    for person in out:
        if not isinstance(person, Person):
            raise TypeError(f"people must be a list of Person; it has a {type(person).__name__}.")
    return [person._native for person in out]


class World:
    """A robot among obstacles and people. Several threads may use it, one at a time.

    robot: its links are checked against each other as well. Configurations have one number an axis,
    as Robot.axes; functions that take several of them work without the interpreter lock.
    """

    __slots__ = ("_native",)

    def __init__(self, robot: Robot):
        if not isinstance(robot, Robot):
            raise TypeError(f"robot must be a Robot, not {type(robot).__name__}.")
        self._native = _model.World(robot._native)

    def set_base(self, pose: ArrayLike) -> None:
        """Sets the pose of the robot's root link in the world; at first the world's own frame."""
        self._native.set_base(pose)

    def set_obstacles(self, obstacles: Iterable[Obstacle]) -> None:
        """Replaces the obstacles."""
        out = []
        for one in obstacles:
            if not isinstance(one, Obstacle):
                raise TypeError(f"obstacles must be Obstacle, not {type(one).__name__}.")
            out.append((one.name, _shape(one.shape), one.pose))
        self._native.set_obstacles(out)

    def set_people(self, people: Iterable[Person]) -> None:
        """Replaces the people."""
        self._native.set_people(_people(people))

    def check(self, q: ArrayLike) -> Verdict:
        """Returns whether anything touches at a configuration, and what."""
        return Verdict(*self._native.check(q))

    def are_free(self, q: ArrayLike) -> NDArray[np.bool_]:
        """Returns for configurations of shape (n, axes) whether nothing touches."""
        return self._native.are_free(q)

    def check_motion(self, start: ArrayLike, end: ArrayLike, step: float = 0.02) -> Verdict:
        """Returns the first contact found on the straight line of the axes, checked every `step`
        [rad]."""
        return Verdict(*self._native.check_motion(start, end, step))

    def to_people(self, q: ArrayLike) -> Distances:
        """Returns the distances to the nearest person, negative where they overlap. The robot
        counts as capsules around its links."""
        return self._distances(self._native.to_people(q))

    def to_obstacles(self, q: ArrayLike) -> Distances:
        """Returns the distances to the nearest obstacle, 0 where they touch."""
        return self._distances(self._native.to_obstacles(q))

    @staticmethod
    def _distances(table: NDArray[np.float64]) -> Distances:
        return Distances(table[:, 0], table[:, 1:4], table[:, 4:7])


def shape_distance(first: Shape, first_pose: ArrayLike, second: Shape,
                   second_pose: ArrayLike) -> ShapeDistance:
    """Returns the exact contact and distance of two shapes with their poses in one frame."""
    return ShapeDistance(*_model.shape_distance(_shape(first), first_pose, _shape(second),
                                                second_pose))
