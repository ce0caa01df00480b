# SPDX-License-Identifier: Apache-2.0
"""Robots from their descriptions or URDF: forward and inverse kinematics, limits. People.

Poses are 4 x 4 matrices T_root_link: coordinates in the link's frame to the frame of the root link.
Configurations have one number an axis [rad] (or [m]), in the order of Robot.axes.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _model
from .trajectory import Limits

__all__ = ["DescriptionError", "JOINT_NAMES", "MissingError", "Person", "Robot"]

#: Names of the joints of a body (REP-155), in the order of Person.joints.
JOINT_NAMES: tuple[str, ...] = _model.joint_names

DescriptionError = _model.DescriptionError
MissingError = _model.MissingError


def _path(value: Union[str, os.PathLike], name: str) -> str:
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} must be a str or a path, not {type(value).__name__}.")
    return os.fspath(value)


class Robot:
    """A robot with its links, axes, groups and limits.

    name: of a description ("jido"), or the path of one. Raises MissingError for a file that is not
    there and DescriptionError naming file and field for one that is wrong.
    """

    __slots__ = ("_native",)

    def __init__(self, name: Union[str, os.PathLike]):
        self._native = _model.load(_path(name, "name"))

    @staticmethod
    def from_urdf(urdf: Union[str, os.PathLike], srdf: Optional[Union[str, os.PathLike]] = None, *,
                  meshes: bool = True) -> Robot:
        """Returns the robot of a bare URDF: every movable joint is an axis.

        srdf: file with groups. meshes: read the collision meshes too, which kinematics does not
        need. Errors as for Robot().
        """
        out = object.__new__(Robot)
        out._native = _model.load_urdf(_path(urdf, "urdf"),
                                       None if srdf is None else _path(srdf, "srdf"),
                                       True if meshes else False)
        return out

    @property
    def name(self) -> str:
        """Returns the name in the description."""
        return self._native.name()

    @property
    def axes(self) -> list[str]:
        """Returns the names of the axes in the order of configurations."""
        return self._native.axes()

    @property
    def links(self) -> list[str]:
        """Returns the names of the links, parents before children."""
        return self._native.links()

    @property
    def groups(self) -> dict[str, list[int]]:
        """Returns the groups ("arm", "hand") with the indices of their axes."""
        return self._native.groups()

    @property
    def rest(self) -> NDArray[np.float64]:
        """Returns the rest configuration [rad], shape (axes,)."""
        return self._native.rest()

    @property
    def position_limits(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns the lower and the upper position limits [rad], each of shape (axes,)."""
        return self._native.position_limits()

    @property
    def comfort_limits(self) -> Limits:
        """Returns the limits of planned motion near people."""
        return Limits(*self._native.comfort_limits())

    @property
    def guard_limits(self) -> Limits:
        """Returns the limits that no set-point exceeds."""
        return Limits(*self._native.guard_limits())

    def forward(self, q: ArrayLike, link: Optional[str] = None) -> NDArray[np.float64]:
        """Returns the pose of a link, shape (4, 4), for configurations of shape (n, axes) the poses
        of shape (n, 4, 4). link: left out, the tool link. Raises ValueError for an unknown link."""
        return self._native.link_poses(q, link)

    def poses(self, q: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """Returns the poses of all links at one configuration, by name."""
        return self._native.all_poses(q)

    def jacobian(self, q: ArrayLike, group: str = "arm") -> NDArray[np.float64]:
        """Returns the Jacobian of the group's tip, shape (6, axes of the group): linear above
        angular velocity, root axes."""
        return self._native.jacobian(q, group)

    def inverse(self, pose: ArrayLike, group: str = "arm",
                seed: Optional[ArrayLike] = None) -> Optional[NDArray[np.float64]]:
        """Returns a configuration inside the position limits with the group's tip at `pose`, or
        None when none is found. seed: configuration near which the search begins and that the other
        axes keep; left out: the rest configuration."""
        return self._native.inverse(pose, group, seed)

    def __repr__(self) -> str:
        return f"<Robot {self.name} with {len(self.axes)} axes>"


class Person:
    """A person as points of the body in the world [m].

    joints: positions by name (REP-155, see JOINT_NAMES), any subset: the others are fitted to those
    given by proportions of the stature [m]. gaze: direction; left out, the front of the body
    counts.
    """

    __slots__ = ("_native",)

    def __init__(self, joints: Mapping[str, ArrayLike], *, gaze: Optional[ArrayLike] = None,
                 stature: float = 1.75, name: str = "person"):
        if not isinstance(joints, Mapping):
            raise TypeError(f"joints must be a dict of points, not {type(joints).__name__}.")
        if not joints:
            raise ValueError("joints must have at least one point.")
        points = [_point(value, key) for key, value in joints.items()]
        self._set(name, _model.fit_body(list(joints), np.array(points), stature), stature, gaze)

    def _set(self, name: str, joints: NDArray[np.float64], stature: float,
             gaze: Optional[ArrayLike]) -> None:
        if not isinstance(name, str):
            raise TypeError(f"name must be a str, not {type(name).__name__}.")
        direction = None if gaze is None else _point(gaze, "gaze")
        if direction is not None and not direction.any():
            raise ValueError("gaze must not be zero.")
        self._native = (name, joints, stature, direction)

    @classmethod
    def _of(cls, position: ArrayLike, yaw: float, stature: float, more: tuple) -> Person:
        seated, gaze, name = more
        if stature is True or not 0.5 <= stature <= 2.5:
            raise ValueError("stature must be in 0.5 .. 2.5 m.")
        out = object.__new__(cls)
        out._set(name, _model.body(position, yaw, stature, seated), stature, gaze)
        return out

    @staticmethod
    def standing(position: ArrayLike, yaw: float = 0.0, stature: float = 1.75, *,
                 gaze: Optional[ArrayLike] = None, name: str = "person") -> Person:
        """Returns a person who stands at a point of the floor, facing yaw [rad] (0: along x), arms
        hanging."""
        return Person._of(position, yaw, stature, (False, gaze, name))

    @staticmethod
    def sitting(position: ArrayLike, yaw: float = 0.0, stature: float = 1.75, *,
                gaze: Optional[ArrayLike] = None, name: str = "person") -> Person:
        """Returns a person who sits; position: point of the floor below the hips."""
        return Person._of(position, yaw, stature, (True, gaze, name))

    @property
    def name(self) -> str:
        """Returns the name, which verdicts of collision checks repeat."""
        return self._native[0]

    @property
    def joints(self) -> dict[str, NDArray[np.float64]]:
        """Returns the positions of all joints by name [m], copies."""
        return {name: point.copy() for name, point in zip(JOINT_NAMES, self._native[1])}

    def __repr__(self) -> str:
        return f"<Person {self.name}>"


def _point(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """Returns a point of three finite numbers."""
    try:
        point = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} must be a point of three numbers.") from None
    if point.shape != (3,) or not np.isfinite(point).all():
        raise ValueError(f"{name} must be a point of three finite numbers.")
    return point
