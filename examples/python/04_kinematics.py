# SPDX-License-Identifier: Apache-2.0
"""Moves the tool of a shipped robot up by 10 cm: inverse kinematics, then a trajectory."""

from handsel import model, trajectory

robot = model.Robot("jido")
start = robot.rest
target = robot.forward(start)
target[2, 3] += 0.1
goal = robot.inverse(target, seed=start)
motion = trajectory.solve(start, goal, robot.comfort_limits)
end = robot.forward(motion.at(motion.duration).position)
print(f"{robot.name}: tool {1000 * (end - robot.forward(start))[2, 3]:.1f} mm higher")
# Prints: jido: tool 100\.0 mm higher
