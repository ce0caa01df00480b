# SPDX-License-Identifier: Apache-2.0
"""Moves two axes from rest to rest in minimum time and samples the motion."""

import numpy as np

from handsel import trajectory

limits = trajectory.Limits(velocity=[1, 1], acceleration=[1, 1], jerk=[5, 5])
motion = trajectory.solve([0, 0], [1, -0.5], limits)
samples = motion.sample(np.linspace(0, motion.duration, 5))
print(f"duration {motion.duration:.4f} s")
print("positions", samples.position.round(3).tolist())
print("largest velocities", motion.extremes().velocity.round(3))
# Prints: duration 2\.2100 s\n.*\[1\.0, -0\.5\]\]
