# SPDX-License-Identifier: Apache-2.0
"""handsel.model: kinematics against a plane arm of closed form and the shipped robots."""

import tempfile
import unittest
from pathlib import Path

import numpy as np

from handsel import model, trajectory

PLANE_ARM = """<robot name="plane">
  <link name="base"/><link name="upper"/><link name="fore"/><link name="tip"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
  <joint name="end" type="fixed"><parent link="fore"/><child link="tip"/><origin xyz="0.3 0 0"/></joint>
</robot>"""


class Plane(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        file = Path(self.folder.name) / "plane.urdf"
        file.write_text(PLANE_ARM)
        self.robot = model.Robot.from_urdf(file)

    def tearDown(self):
        self.folder.cleanup()

    def test_names_and_limits_are_those_of_the_urdf(self):
        self.assertEqual(self.robot.axes, ["shoulder", "elbow"])
        self.assertEqual(self.robot.links, ["base", "upper", "fore", "tip"])
        np.testing.assert_array_equal(self.robot.position_limits, [[-3, -3], [3, 3]])
        np.testing.assert_allclose(self.robot.guard_limits.velocity, [2, 1])
        np.testing.assert_allclose(self.robot.comfort_limits.velocity, np.array([2, 1]) / 1.1)

    def test_forward_kinematics_is_that_of_the_closed_form(self):
        random = np.random.default_rng(3)
        q = random.uniform(-3, 3, (50, 2))
        poses = self.robot.forward(q, "tip")
        self.assertEqual(poses.shape, (50, 4, 4))
        a, b = q[:, 0], q.sum(axis=1)
        np.testing.assert_allclose(poses[:, 0, 3], 0.5 * np.cos(a) + 0.3 * np.cos(b), atol=1e-12)
        np.testing.assert_allclose(poses[:, 1, 3], 0.5 * np.sin(a) + 0.3 * np.sin(b), atol=1e-12)
        np.testing.assert_allclose(poses[:, 0, 0], np.cos(b), atol=1e-12)
        for i in range(3):
            np.testing.assert_array_equal(self.robot.forward(q[i], "tip"), poses[i])
            np.testing.assert_array_equal(self.robot.poses(q[i])["tip"], poses[i])

    def test_mistakes_are_one_sentence(self):
        for error, call in (
                (ValueError, lambda: self.robot.forward([0, 0, 0], "tip")),
                (ValueError, lambda: self.robot.forward([0, np.nan], "tip")),
                (ValueError, lambda: self.robot.forward(np.zeros((2, 3)), "tip")),
                (ValueError, lambda: self.robot.forward([0, 0], "nose")),
                (ValueError, lambda: self.robot.forward([0, 0])),
                (TypeError, lambda: self.robot.forward("ab", "tip")),
                (TypeError, lambda: self.robot.forward([0, 0], 3)),
                (ValueError, lambda: self.robot.jacobian([0, 0], "leg")),
                (model.MissingError, lambda: model.Robot("no_such_robot")),
                (model.MissingError, lambda: model.Robot.from_urdf("/no/such.urdf")),
                (TypeError, lambda: model.Robot(3)),
                (model.DescriptionError, lambda: model.Robot.from_urdf(__file__))):
            with self.assertRaises(error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))
            self.assertNotEqual(str(caught.exception), "")


class Shipped(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = model.Robot("jido")

    def test_inverse_kinematics_finds_the_pose_again(self):
        arm = self.robot.groups["arm"]
        lower, upper = self.robot.position_limits
        random = np.random.default_rng(5)
        for _ in range(10):
            q = self.robot.rest
            q[arm] += random.uniform(-0.3, 0.3, len(arm))
            q = np.clip(q, lower, upper)
            target = self.robot.forward(q)
            found = self.robot.inverse(target, seed=q)
            self.assertIsNotNone(found)
            np.testing.assert_allclose(self.robot.forward(found)[:3, 3], target[:3, 3], atol=1e-4)
            self.assertTrue(((found >= lower - 1e-9) & (found <= upper + 1e-9)).all())

    def test_a_pose_out_of_reach_has_no_solution(self):
        far = np.eye(4)
        far[0, 3] = 50
        self.assertIsNone(self.robot.inverse(far))
        with self.assertRaisesRegex(ValueError, "rigid transform"):
            self.robot.inverse(2 * far)

    def test_the_jacobian_is_the_derivative(self):
        arm, q, step = self.robot.groups["arm"], self.robot.rest, 1e-6
        jacobian = self.robot.jacobian(q)
        for column, axis in enumerate(arm):
            moved = q.copy()
            moved[axis] += step
            slope = (self.robot.forward(moved) - self.robot.forward(q))[:3, 3] / step
            np.testing.assert_allclose(jacobian[:3, column], slope, atol=1e-5)

    def test_its_limits_plan_a_trajectory(self):
        start = self.robot.rest
        end = start.copy()
        end[self.robot.groups["arm"]] += 0.1
        motion = trajectory.solve(start, end, self.robot.comfort_limits)
        self.assertEqual(motion.why_not_within(self.robot.guard_limits), "")


if __name__ == "__main__":
    unittest.main()
