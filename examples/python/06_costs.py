# SPDX-License-Identifier: Apache-2.0
"""Finds the place in front of a person where an offered object costs least."""

import numpy as np

from handsel import cost, model

person = model.Person.standing([0, 0, 0], yaw=0.0)  # faces along x
x, y, z = np.arange(0.2, 0.9, 0.02), np.arange(-0.6, 0.6, 0.02), np.arange(0.8, 1.5, 0.02)
costs = cost.grid(person, x, y, z)
i, j, k = np.unravel_index(np.argmin(costs.total), costs.total.shape)
print(f"{costs.total.size} points, best at {x[i]:.2f} {y[j]:.2f} {z[k]:.2f} m")
print(f"in front of the person: {x[i] > 0.3}, within reach: {costs.comfort[i, j, k] < 1}")
# Prints: 73500 points.*\nin front of the person: True, within reach: True
