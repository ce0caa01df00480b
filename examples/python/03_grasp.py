# SPDX-License-Identifier: Apache-2.0
"""Counts how many fingers around a cylinder give force closure."""

import numpy as np

from handsel import grasp

for fingers in (2, 3, 4):
    angles = 2 * np.pi * np.arange(fingers) / fingers
    out = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    wrenches = grasp.contact_wrenches(0.03 * out, -out, friction=0.6, torque_scale=1 / 0.03)
    print(f"{fingers} fingers: {grasp.force_closure(wrenches)}")
grip = grasp.grip_forces(0.03 * out, -out, 0.6, mass=0.3)
print(f"margin {grip.margin:.1f} N")
# Prints: 2 fingers: False\n3 fingers: True\n4 fingers: True\nmargin [1-9]
