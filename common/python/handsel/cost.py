# SPDX-License-Identifier: Apache-2.0
"""Human-aware costs (chapter section 4.1.2): safety, visibility and arm comfort, each in [0, 1].

    person = model.Person.standing([1.5, 0, 0], yaw=3.14)
    costs = cost.grid(person, x, y, [1.1])     # costs.total has the shape (len(x), len(y), 1)

Safety falls with the distance to the person, visibility is the angle off the gaze, arm comfort is
the effort of the person's arm to reach the point. The total is their weighted mean.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _model
from .collision import _people
from .model import Person, Robot

__all__ = ["Costs", "RobotCosts", "Settings", "at", "grid", "of_robot"]


class Settings(NamedTuple):
    """Ranges and weights; the defaults are those of the system."""

    safety_radius: float = 1.0  #: distance from which on there is no safety cost [m]
    visibility_cutoff: float = 3.0  #: distance from the eyes without visibility cost [m]
    safety: float = 1.0  #: weight, at least 0
    visibility: float = 0.3  #: weight, at least 0
    comfort: float = 0.3  #: weight of the arm comfort, at least 0


class Costs(NamedTuple):
    """Costs of points."""

    safety: NDArray[np.float64]  #: 1 at the person, 0 from the safety radius on
    visibility: NDArray[np.float64]  #: angle off the gaze over pi
    comfort: NDArray[np.float64]  #: 1 out of reach of the person's arms
    total: NDArray[np.float64]  #: weighted mean


class RobotCosts(NamedTuple):
    """Costs of configurations of a robot, one an entry."""

    safety: NDArray[np.float64]  #: of the links that axes move
    visibility: NDArray[np.float64]  #: of the tool
    comfort: NDArray[np.float64]  #: of the tool
    total: NDArray[np.float64]  #: weighted mean, of the person for whom it is highest
    distance: NDArray[np.float64]  #: to the simplified body [m]; infinite without people


def _settings(settings: Optional[Settings]) -> tuple:
    if settings is None:
        return tuple(Settings())
    if not isinstance(settings, Settings):
        raise TypeError(f"settings must be Settings, not {type(settings).__name__}.")
    return tuple(settings)


def _person(person: Person) -> tuple:
    if not isinstance(person, Person):
        raise TypeError(f"person must be a Person, not {type(person).__name__}.")
    return person._native


def at(person: Person, points: ArrayLike, settings: Optional[Settings] = None) -> Costs:
    """Returns the costs of a hand or object at points of the world, shape (n, 3) [m]."""
    return Costs(*_model.point_costs(_person(person), points, _settings(settings)).T)


def grid(person: Person, x: ArrayLike, y: ArrayLike, z: ArrayLike,
         settings: Optional[Settings] = None) -> Costs:
    """Returns the costs of all points with these coordinates in the world [m], arrays of shape
    (len(x), len(y), len(z)), in one call without the interpreter lock."""
    axes = []
    for name, values in (("x", x), ("y", y), ("z", z)):
        try:
            axis = np.asarray(values, dtype=float)
        except (TypeError, ValueError, OverflowError):
            raise TypeError(f"{name} must be an array of numbers.") from None
        if axis.ndim != 1:
            raise ValueError(f"{name} must have one dimension, not {axis.ndim}.")
        axes.append(axis)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    table = _model.point_costs(_person(person), points.reshape(-1, 3), _settings(settings))
    return Costs(*(table[:, i].reshape(points.shape[:3]) for i in range(4)))


def of_robot(robot: Robot, q: ArrayLike, people: Iterable[Person],
             settings: Optional[Settings] = None, *,
             base: Optional[ArrayLike] = None) -> RobotCosts:
    """Returns the costs of configurations of shape (n, axes) among people. base: pose of the root
    link in the world, (4, 4); left out: the world's own frame."""
    if not isinstance(robot, Robot):
        raise TypeError(f"robot must be a Robot, not {type(robot).__name__}.")
    table = _model.robot_costs(robot._native, np.eye(4) if base is None else base, _people(people),
                               q, _settings(settings))
    return RobotCosts(*table.T)
