# SPDX-License-Identifier: Apache-2.0
"""Parts of Handsel for Python: trajectories, robot models, collisions, costs, grasps, recordings,
and the whole system as an environment.

    import handsel
    limits = handsel.trajectory.Limits([1, 1], [2, 2], [10, 10])
    motion = handsel.trajectory.solve([0, 0], [1, -0.5], limits)

The modules are loaded when they are first used; handsel.Environment is that of handsel.environment.
SI units and radians. Wrong arguments raise TypeError or ValueError with one sentence that names the
argument.
"""

import importlib as _importlib

from ._version import __version__

__all__ = ["collision", "cost", "environment", "grasp", "model", "recording", "trajectory"]


def __getattr__(name: str):
    if name in __all__:
        return _importlib.import_module(f"handsel.{name}")
    if name == "Environment":
        return _importlib.import_module("handsel.environment").Environment
    raise AttributeError(f"module 'handsel' has no attribute {name!r}.")


def __dir__() -> list:
    return sorted([*__all__, "Environment", "__version__"])
