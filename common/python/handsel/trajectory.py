# SPDX-License-Identifier: Apache-2.0
"""Jerk-limited trajectories of several axes (chapter sections 4.2 to 4.4).

A trajectory is a series of cubic segments per axis. Units: rad (or m), s. Axes that start and end
together are the default. An array of positions stands for a state at rest.
"""

from __future__ import annotations

from typing import NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _trajectory

__all__ = [
    "Batch", "Blend", "Extremes", "Limits", "NoTrajectoryError", "Run", "Samples", "Smoothed",
    "State", "Switched", "Trajectory", "smooth", "solve", "solve_batch", "stop", "switch_to",
]

_new = object.__new__


class NoTrajectoryError(ValueError):
    """No trajectory exists for a valid input, for example because a duration is too short."""


class Limits:
    """Symmetric bounds of each axis (chapter eq. 9).

    velocity [rad/s], acceleration [rad/s^2] and jerk [rad/s^3]: one positive number an axis.
    Raises ValueError for sizes that differ and for numbers that are not positive and finite.
    """

    __slots__ = ("_native",)

    def __init__(self, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike):
        self._native = _trajectory.Limits(velocity, acceleration, jerk)

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Returns a copy of the velocity limits [rad/s], shape (axes,)."""
        return self._native.velocity

    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Returns a copy of the acceleration limits [rad/s^2], shape (axes,)."""
        return self._native.acceleration

    @property
    def jerk(self) -> NDArray[np.float64]:
        """Returns a copy of the jerk limits [rad/s^3], shape (axes,)."""
        return self._native.jerk

    def __repr__(self) -> str:
        return f"Limits({self.velocity}, {self.acceleration}, {self.jerk})"


class State:
    """Kinematic state of several axes.

    position [rad]; velocity [rad/s] and acceleration [rad/s^2] are 0 when left out. Each has one
    number an axis.
    """

    __slots__ = ("_native",)

    def __init__(self, position: ArrayLike, velocity: Optional[ArrayLike] = None,
                 acceleration: Optional[ArrayLike] = None):
        self._native = _trajectory.State(position, velocity, acceleration)

    @property
    def position(self) -> NDArray[np.float64]:
        """Returns a copy of the positions [rad], shape (axes,)."""
        return self._native.position

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Returns a copy of the velocities [rad/s], shape (axes,)."""
        return self._native.velocity

    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Returns a copy of the accelerations [rad/s^2], shape (axes,)."""
        return self._native.acceleration

    def __repr__(self) -> str:
        return f"State({self.position}, {self.velocity}, {self.acceleration})"


class Samples(NamedTuple):
    """States at several times, each array of shape (times, axes)."""

    position: NDArray[np.float64]  #: [rad]
    velocity: NDArray[np.float64]  #: [rad/s]
    acceleration: NDArray[np.float64]  #: [rad/s^2]


class Extremes(NamedTuple):
    """Exact extremes over a whole trajectory, each array of shape (axes,)."""

    lowest: NDArray[np.float64]  #: lowest position [rad]
    highest: NDArray[np.float64]  #: highest position [rad]
    velocity: NDArray[np.float64]  #: largest magnitude [rad/s]
    acceleration: NDArray[np.float64]  #: largest magnitude [rad/s^2]
    jerk: NDArray[np.float64]  #: largest magnitude [rad/s^3]


class Trajectory:
    """Cubic segments of several axes that last equally long. Made by the functions of this module."""

    __slots__ = ("_native",)

    def __init__(self) -> None:
        raise TypeError("a Trajectory is made by solve, smooth, stop or switch_to, not directly.")

    @property
    def duration(self) -> float:
        """Returns the duration [s]."""
        return self._native.duration()

    @property
    def axes(self) -> int:
        """Returns the number of axes."""
        return self._native.axes()

    def sample(self, times: ArrayLike) -> Samples:
        """Returns the states at `times` [s], shape (n,), each clamped to [0, duration]."""
        return Samples(*self._native.samples(times))

    def at(self, time: float) -> State:
        """Returns the state at `time` [s], clamped to [0, duration]."""
        return _wrap(State, self._native.at(time))

    def segments(self, axis: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns durations [s] and jerks [rad/s^3] of the segments of one axis."""
        return self._native.segments(axis)

    def extremes(self) -> Extremes:
        """Returns the exact extremes of each axis; nothing is sampled."""
        return Extremes(*np.ascontiguousarray(self._native.extremes().T))

    def why_not_within(self, limits: Limits, tolerance: float = 1e-9) -> str:
        """Returns one sentence about the first limit exceeded by more than the relative tolerance,
        "" when there is none. Exact, not sampled."""
        return self._native.why_not_within(_native_of(limits), tolerance)

    def cut(self, begin: float, end: float) -> Trajectory:
        """Returns the part between two times [s], starting at time 0."""
        return _wrap(Trajectory, self._native.cut(begin, end))

    def reversed(self) -> Trajectory:
        """Returns the same path from its end to its beginning, in the same time."""
        return _wrap(Trajectory, self._native.reversed())

    def stretched(self, factor: float) -> Trajectory:
        """Returns the same path with every duration times `factor`, which must be positive."""
        return _wrap(Trajectory, self._native.stretched(factor))

    def __repr__(self) -> str:
        return f"<Trajectory of {self.axes} axes, {self.duration:.4f} s>"


class Blend(NamedTuple):
    """What happens at one inner waypoint."""

    waypoint: int  #: index into the waypoints
    method: str  #: "three_segment", "stretched", "overlap" or "stop"
    excess: float  #: relative excess of the limits, 0.1 is 10 %
    saved: float  #: time saved against a stop [s]
    reason: str  #: why the stop is kept, else empty


class Smoothed(NamedTuple):
    """Result of smooth()."""

    trajectory: Trajectory  #: from the first waypoint to the last, at rest at both
    duration_with_stops: float  #: duration with a stop at each waypoint [s]
    blends: list[Blend]  #: one an inner waypoint


class Switched(NamedTuple):
    """Result of switch_to()."""

    trajectory: Trajectory  #: the connecting motion, then the rest of the target
    joins_at: float  #: time of the target at which it is joined [s]
    connecting: float  #: duration of the connecting motion [s]


class Batch(NamedTuple):
    """Result of solve_batch(), each array of shape (n,)."""

    duration: NDArray[np.float64]  #: min duration [s], NaN where there is no trajectory
    outcome: NDArray[np.int32]  #: 0 solved, else a number for reason()
    failed_axis: NDArray[np.int32]  #: axis that failed, -1 where solved

    def reason(self, problem: int) -> str:
        """Returns why a problem has no trajectory, "" when it has one."""
        text = _trajectory.outcome_text(int(self.outcome[problem]))
        return f"axis {self.failed_axis[problem]}: {text}" if text else ""


_WRAPPERS = (State, Limits, Trajectory)


def _native_of(value):
    # Of a wrong type the native function names the argument.
    return value._native if isinstance(value, _WRAPPERS) else value


def _wrap(kind, native):
    out = _new(kind)
    out._native = native
    return out


def _result(native) -> Trajectory:
    if type(native) is str:
        raise NoTrajectoryError(native + ".")
    out = _new(Trajectory)
    out._native = native
    return out


def solve(start: Union[State, ArrayLike], end: Union[State, ArrayLike], limits: Limits, *,
          duration: Optional[float] = None, synchronize: bool = True) -> Trajectory:
    """Returns a trajectory from one state to another (chapter section 4.3).

    start, end: State, or positions [rad] of a state at rest. duration: imposed duration [s]; left
    out: min duration. synchronize: all axes end together; False: each as fast as it can, and those
    that end early wait at rest. Raises NoTrajectoryError with the axis and the reason when no
    trajectory exists.
    """
    return _result(_trajectory.solve(_native_of(start), _native_of(end), _native_of(limits),
                                     duration, True if synchronize else False))


def smooth(waypoints: ArrayLike, limits: Limits, *, allowed_excess: float = 0.0,
           reach: Optional[float] = None) -> Smoothed:
    """Returns a trajectory through straight path segments, blended at the waypoints (chapter
    section 4.4).

    waypoints [rad]: shape (n, axes), at least two rows. allowed_excess: relative excess of the
    limits that blends may have. reach: max time before and after a waypoint that a blend replaces
    [s]; 0 stops at each waypoint; left out: blends begin and end at constant velocity.
    """
    out = _trajectory.smooth(waypoints, _native_of(limits), allowed_excess, reach)
    if type(out) is str:
        raise NoTrajectoryError(out + ".")
    native, with_stops, blends = out
    return Smoothed(_wrap(Trajectory, native), with_stops, [Blend(*blend) for blend in blends])


def stop(start: Union[State, ArrayLike], limits: Limits) -> Trajectory:
    """Returns the motion in which each axis comes to rest as fast as it can; its position is free
    (chapter section 4.3.4)."""
    return _wrap(Trajectory, _trajectory.stop(_native_of(start), _native_of(limits)))


def switch_to(start: Union[State, ArrayLike], target: Trajectory, limits: Limits, *,
              moving: bool = False) -> Switched:
    """Returns the motion from a state, in motion or not, onto a trajectory.

    moving: the target runs already, its time is 0 now, and it is met where it then is. Raises
    NoTrajectoryError when it cannot be joined within the limits.
    """
    out = _trajectory.switch_to(_native_of(start), _native_of(target), _native_of(limits),
                                True if moving else False)
    if type(out) is str:
        raise NoTrajectoryError(out + ".")
    return Switched(_wrap(Trajectory, out[0]), out[1], out[2])


def solve_batch(start: ArrayLike, end: ArrayLike, limits: Limits, *,
                start_velocity: Optional[ArrayLike] = None,
                end_velocity: Optional[ArrayLike] = None,
                start_acceleration: Optional[ArrayLike] = None,
                end_acceleration: Optional[ArrayLike] = None) -> Batch:
    """Solves n problems in one call, axes side by side in SIMD registers, without the interpreter
    lock.

    Each array has shape (n, axes), or (axes,) when all problems share it; left out: 0. Returns the
    min durations; for the trajectory of one problem call solve(). Numbers that are not finite raise
    ValueError; a problem without trajectory has an outcome other than 0.
    """
    if not isinstance(limits, Limits):
        raise TypeError(f"limits must be a Limits, not {type(limits).__name__}.")
    return Batch(*_trajectory.solve_batch(
        (start, end, start_velocity, end_velocity, start_acceleration, end_acceleration),
        (limits.velocity, limits.acceleration, limits.jerk)))


class Run:
    """A trajectory while it runs: pause, resume, lower speed and backward motion on its path,
    without any limit exceeded (own method, see docs/trajectory.md).

    guard: limits of the running motion; the trajectory must keep them, best by a factor of 1.1.
    step: control period [s]. Raises ValueError for a trajectory that does not keep `guard` or does
    not end at rest.
    """

    __slots__ = ("_native",)

    def __init__(self, trajectory: Trajectory, guard: Limits, step: float = 0.001):
        self._native = _trajectory.Run(_native_of(trajectory), _native_of(guard), step)

    def set_target(self, speed: float) -> None:
        """Sets the speed factor aimed at, clamped to [-1, 1]: 0 pauses, 1 resumes."""
        self._native.set_target(speed)

    def advance(self, dt: float) -> State:
        """Advances by `dt` [s], 0 .. 3600, and returns the state then."""
        self._native.advance(dt)
        return _wrap(State, self._native.state())

    @property
    def state(self) -> State:
        """Returns the state now."""
        return _wrap(State, self._native.state())

    @property
    def speed(self) -> float:
        """Returns the speed factor now, in [-1, 1]."""
        return self._native.alpha()

    @property
    def time(self) -> float:
        """Returns the time on the trajectory [s]."""
        return self._native.time()

    @property
    def finished(self) -> bool:
        """Returns whether the end is reached."""
        return self._native.finished()
