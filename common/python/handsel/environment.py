# SPDX-License-Identifier: Apache-2.0
"""The whole system in lock-step: a scenario is stepped, observed and acted on, with the signatures
of Gymnasium (which is not needed).

    env = handsel.Environment("trial_give", seed=3, control="task")
    observation, info = env.reset()
    observation, reward, terminated, truncated, info = env.step({"task": info["tasks"][0]})

Simulator, perception, planners, controller and supervisor run in a process of the handsel command
in virtual time: equal seeds and equal actions give equal bits. docs/environment.md describes
observations, actions and the requests to that process. SI units, world frame, poses as 4 x 4.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
import weakref
from pathlib import Path
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Environment", "Grasp", "MotionPlan", "SystemEnded", "find_command"]

_POSES = ("pose", "base", "tool")
_ARRAYS = ("position", "velocity", "measured", "size", "gaze")


class SystemEnded(RuntimeError):
    """The process of the system has ended by itself; reset() starts another one."""


class Grasp(NamedTuple):
    """A grasp of one hand on one object, within reach and free of collisions."""

    arm: NDArray[np.float64]  #: arm axes at the grasp [rad]
    approach: NDArray[np.float64]  #: arm axes at the stand-off before it [rad]
    hand: NDArray[np.float64]  #: hand axes at contact [rad]
    opened: NDArray[np.float64]  #: hand axes before the approach [rad]
    effort: NDArray[np.float64]  #: torque of the hand axes for the grip [Nm]
    object_hand: NDArray[np.float64]  #: pose of the hand in the frame of the object, shape (4, 4)
    quality: float  #: in [0, 1]
    visible: float  #: fraction of the object that its receiver sees, in [0, 1]


class MotionPlan(NamedTuple):
    """Result of Environment.plan(); false where there is no motion."""

    number: Optional[int]  #: for the action {"run": number}; None: there is no motion
    reason: str  #: why there is none, one sentence; else empty
    duration: float  #: of the motion [s]
    path: NDArray[np.float64]  #: waypoints, one a row [rad]

    def __bool__(self) -> bool:
        return self.number is not None


def find_command() -> str:
    """Returns the path of the command handsel: $HANDSEL_COMMAND, beside the package, or in PATH.
    Raises FileNotFoundError."""
    named = os.environ.get("HANDSEL_COMMAND")
    if named:
        return named
    package = Path(__file__).resolve().parent
    for folder in (package.parents[1], package.parents[3]):  # of a build, of an installed tree
        if (folder / "bin" / "handsel").is_file():
            return str(folder / "bin" / "handsel")
    found = shutil.which("handsel")
    if found is None:
        raise FileNotFoundError("The command handsel is neither beside the package nor in PATH; "
                                "HANDSEL_COMMAND may name it.")
    return found


def _plain(value: Any) -> Any:
    """Returns what JSON can hold for an array or a number of NumPy."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"an action cannot hold {type(value).__name__}.")


def _arrays(value: Any) -> Any:
    """Returns an observation with its poses and vectors as arrays."""
    if isinstance(value, list):
        return [_arrays(one) for one in value]
    if not isinstance(value, dict):
        return value
    out = {}
    for key, one in value.items():
        if key in _POSES and one is not None:
            out[key] = np.array(one, dtype=float).reshape(4, 4)
        elif key in _ARRAYS and isinstance(one, list):
            out[key] = np.array(one, dtype=float)
        elif key == "joints":
            out[key] = {name: np.array(point, dtype=float) for name, point in one.items()}
        else:
            out[key] = _arrays(one)
    return out


def _end(process: subprocess.Popen, errors: Any) -> None:
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout, errors):
        try:
            stream.close()
        except OSError:  # what was not sent is lost with the process
            pass


class Environment:
    """A scenario that a policy takes part in.

    scenario: name or path. seed: of the first reset(); each further one takes the next number.
    control: "motion": the policy moves arm and hand in the place of the manipulation planner, with
    all limits and guards of the controller; "task": the policy gives tasks and the system does the
    rest. period: virtual time of one step [s]. robot: name or path; left out: the scenario's.
    Raises TypeError, ValueError, or FileNotFoundError for a scenario that is not there (at reset).
    """

    def __init__(self, scenario: str, seed: int = 1, *, control: str = "motion",
                 period: float = 0.1, robot: Optional[str] = None):
        for name, text in (("scenario", scenario), ("control", control), ("robot", robot)):
            if not isinstance(text, (str, os.PathLike)) and not (name == "robot" and text is None):
                raise TypeError(f"{name} must be a str, not {type(text).__name__}.")
        if control not in ("motion", "task"):
            raise ValueError(f'control must be "motion" or "task", not "{control}".')
        self._arguments = ["environment", os.fspath(scenario)]
        if robot is not None:
            self._arguments += ["--robot", os.fspath(robot)]
        self._control = control
        self._period = self._seconds(period, "period")
        self._next_seed = self._whole(seed, "seed")
        self._process: Optional[subprocess.Popen] = None
        self._errors: Any = None
        self._finalizer: Any = None
        self._state: dict = {}

    @staticmethod
    def _whole(value: Any, name: str) -> int:
        if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
            raise TypeError(f"{name} must be an int, not {type(value).__name__}.")
        if not 1 <= value <= 10**15:
            raise ValueError(f"{name} must be in 1 .. 10^15.")
        return int(value)

    @staticmethod
    def _seconds(value: Any, name: str) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
            raise TypeError(f"{name} must be a number, not {type(value).__name__}.")
        if not 0 < value <= 3600:
            raise ValueError(f"{name} must be above 0 and at most 3600 s.")
        return float(value)

    def _start(self) -> None:
        self._errors = tempfile.TemporaryFile()
        try:
            self._process = subprocess.Popen([find_command(), *self._arguments],
                                             stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                             stderr=self._errors)
        except OSError as error:
            raise FileNotFoundError(f"The command handsel cannot be started: {error}.") from None
        self._finalizer = weakref.finalize(self, _end, self._process, self._errors)

    def _ended(self) -> Exception:
        """Returns the exception for a process that has ended by itself."""
        code = self._process.wait()
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        self.close()
        if code == 3 and lines:
            return FileNotFoundError(lines[-1])
        if code == 2 and lines:
            return ValueError(lines[-1])
        how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
        return SystemEnded(f"The process of the system has ended with {how}"
                           + (f": {lines[-1]}" if lines else "."))

    def _request(self, request: dict) -> dict:
        try:
            line = json.dumps(request, allow_nan=False, default=_plain) + "\n"
        except (ValueError, RecursionError):
            raise ValueError("an action holds a number that is not finite, or itself.") from None
        if self._process is None:
            if request["request"] != "reset":
                raise ValueError("reset() must come first.")
            self._start()
        try:
            try:
                self._process.stdin.write(line.encode())
                self._process.stdin.flush()
                answer = self._process.stdout.readline()
            except BrokenPipeError:
                answer = b""
        except BaseException:  # interrupted: the answer would be that of the next request
            self.close()
            raise
        if not answer.endswith(b"\n"):
            raise self._ended()
        out = json.loads(answer)
        if "error" in out:
            kind = FileNotFoundError if out.get("missing") else ValueError
            raise kind(out["error"])
        return out

    def _keep(self, answer: dict) -> dict:
        answer["observation"] = _arrays(answer["observation"])
        self._state = answer
        return answer

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[dict] = None) -> tuple[dict, dict]:
        """Begins a trial and returns observation and info. seed: left out, the next one. options:
        there are none; Gymnasium passes the argument."""
        if seed is not None:
            self._next_seed = self._whole(seed, "seed")
        if options:
            raise ValueError("reset() has no options.")
        state = self._keep(self._request({"request": "reset", "seed": self._next_seed,
                                          "control": self._control}))
        self._next_seed += 1
        return state["observation"], state["info"]

    def step(self, action: Optional[dict] = None,
             duration: Optional[float] = None) -> tuple[dict, float, bool, bool, dict]:
        """Carries out an action, advances the virtual time and returns observation, reward,
        terminated, truncated, info.

        action: None or a dict, see docs/environment.md. duration: left out, the period [s].
        reward: 1 once the simulator's oracle has seen the task of the scenario done, else 0.
        Raises ValueError for an action that is none; the trial then continues unchanged unless
        other parts of the same action were carried out.
        """
        if action is not None and not isinstance(action, dict):
            raise TypeError(f"action must be a dict or None, not {type(action).__name__}.")
        for_s = self._period if duration is None else self._seconds(duration, "duration")
        state = self._keep(self._request({"request": "step", "action": action,
                                          "duration": for_s}))
        return (state["observation"], state["reward"], state["terminated"], state["truncated"],
                state["info"])

    @property
    def observation(self) -> dict:
        """Returns the newest observation; empty before reset()."""
        return self._state.get("observation", {})

    @property
    def info(self) -> dict:
        """Returns the newest info; empty before reset()."""
        return self._state.get("info", {})

    @property
    def over(self) -> bool:
        """Returns whether the trial is terminated or truncated."""
        return bool(self._state and (self._state["terminated"] or self._state["truncated"]))

    def grasps(self, object: str, human: str = "", *, group: str = "arm",
               count: int = 20) -> list[Grasp]:
        """Returns grasps of an object from the grasp planner, best first; none where none is
        reachable. human: receiver, whose hand needs room. The virtual time advances meanwhile."""
        answer = self._request({"request": "grasps", "object": object, "human": human,
                                "group": group, "max_grasps": self._whole(count, "count")})
        out = []
        for one in answer["grasps"]:
            arrays = [np.array(one[name]) for name in Grasp._fields[:5]]
            out.append(Grasp(*arrays, np.array(one["object_hand"]).reshape(4, 4), one["quality"],
                             one["visible"]))
        return out

    def plan(self, goals: ArrayLike, *, group: str = "arm", start: Optional[ArrayLike] = None,
             hand: Optional[ArrayLike] = None, straight: bool = False, speed: float = 1.0,
             allowed: tuple = (), time_limit: float = 3.0) -> MotionPlan:
        """Returns a collision-free motion of a group to one of the goals, shape (n, axes).

        start: axes of the group from which it begins; left out: where they are. hand: hand axes
        meanwhile. straight: only the straight line to the first goal. speed: factor on the velocity
        limits, (0, 1]. allowed: objects and people that may be touched. time_limit: of the path
        planner [s]. The virtual time advances meanwhile.
        """
        request = {"request": "plan", "goals": np.asarray(goals, dtype=float), "group": group,
                   "straight": bool(straight), "speed": speed, "allowed": list(allowed),
                   "time_limit": time_limit}
        for name, value in (("from", start), ("hand", hand)):
            if value is not None:
                request[name] = np.asarray(value, dtype=float)
        answer = self._request(request)
        return MotionPlan(answer["plan"], answer["reason"], answer.get("duration", 0.0),
                          np.array(answer.get("path", [])))

    def run(self, plan: MotionPlan) -> bool:
        """Runs a planned motion to its end and returns whether it got there."""
        if not plan:
            return False
        self.step({"run": plan.number})
        while not self.over and self.observation["motion"]["state"] == "running":
            self.step()
        return self.observation["motion"]["state"] == "finished"

    def move_hand(self, action: str, position: ArrayLike, **more: Any) -> str:
        """Sends a command to the hand and returns its state when it no longer moves: "grasped",
        "empty", "idle", "released", "refused". more: effort, payload, pull_force, group."""
        self.step({"hand": {"action": action, "position": np.asarray(position, float), **more}})
        while not self.over and self.observation["motion"]["hand"] == "moving":
            self.step()
        return self.observation["motion"]["hand"]

    def close(self) -> None:
        """Ends the process of the system; reset() starts another one."""
        if self._process is not None:
            self._finalizer()
            self._process = None

    def __enter__(self) -> Environment:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
