# SPDX-License-Identifier: Apache-2.0
"""Checks a motion of a shipped robot among a box and a person."""

import numpy as np

from handsel import collision, model

robot = model.Robot("jido")
rest = robot.rest
place = robot.forward(rest)
place[2, 3] += 0.5
world = collision.World(robot)
world.set_obstacles([collision.Obstacle("lamp", collision.Box(0.2, 0.2, 0.2), place)])
world.set_people([model.Person.standing([place[0, 3] + 1, place[1, 3], 0], np.pi, name="anna")])
up = robot.forward(rest)
up[2, 3] += 0.4
verdict = world.check_motion(rest, robot.inverse(up, seed=rest))
print(f"{world.to_people(rest).distance[0]:.2f} m to the person")
print(f"{verdict.first} touches {verdict.second}")
# Prints: 0\.\d+ m to the person\nlink \w+ touches box lamp
