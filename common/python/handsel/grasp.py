# SPDX-License-Identifier: Apache-2.0
"""Contacts of a grasp (chapter section 3.2.7): friction cones, force closure, grip forces.

Contacts are given as positions [m] and normals into the object, each of shape (n, 3) and in one
frame. friction and torsion are one number for all contacts or one a contact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _grasp

__all__ = ["GripForces", "contact_wrenches", "force_closure", "grip_forces"]


class GripForces(NamedTuple):
    """Result of grip_forces()."""

    forces: NDArray[np.float64]  #: on the object, one row a contact, their sum is 0 [N]
    margin: float  #: smallest reserve inside the friction cones in the worst direction [N]


def contact_wrenches(positions: ArrayLike, normals: ArrayLike, friction: ArrayLike = 0.5,
                     torsion: ArrayLike = 0.0, *, edges: int = 8,
                     centre: ArrayLike = (0.0, 0.0, 0.0),
                     torque_scale: float = 1.0) -> NDArray[np.float64]:
    """Returns the edges of the linearised friction cones as wrenches, shape (6, edges of all
    contacts): force above torque.

    torsion: torque about the normal per normal force [m]. edges: of one cone, 3 .. 256. Torques are
    about `centre` [m] times `torque_scale` [1/m].
    """
    return _grasp.contact_wrenches(positions, normals, friction, torsion,
                                   (edges, centre, torque_scale))


def force_closure(wrenches: ArrayLike) -> bool:
    """Returns whether a combination of all wrenches with positive weights is zero and they span the
    space: the contacts resist every force and torque. wrenches: one a column."""
    return _grasp.force_closure(wrenches)


def grip_forces(positions: ArrayLike, normals: ArrayLike, friction: ArrayLike = 0.5, *,
                mass: float, centre_of_mass: ArrayLike = (0.0, 0.0, 0.0),
                max_normal: float = 15.0, friction_fraction: float = 0.8,
                acceleration: float = 13.0) -> GripForces:
    """Returns the forces of the contacts that cancel out and leave the largest margin inside the
    friction cones (own method: a linear program, because the load may pull in any direction).

    mass [kg]; max_normal: of one contact [N]; friction_fraction: fraction of the friction that is
    used, in (0, 1]; acceleration: of the load in its worst direction, gravity included [m/s^2].
    Fewer than three contacts, or all on one line, bear nothing: no forces, margin 0.
    """
    return GripForces(*_grasp.grip_forces(positions, normals, friction, 0.0,
                                          (centre_of_mass, mass, max_normal, friction_fraction,
                                           acceleration)))
