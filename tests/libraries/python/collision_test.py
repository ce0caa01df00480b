# SPDX-License-Identifier: Apache-2.0
"""handsel.collision and handsel.cost against closed forms; people of handsel.model."""

import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np

from handsel import collision, cost, model

# A ball of 0.1 m radius, 0.5 m from the axis of one joint about z.
BALL = """<robot name="ball">
  <link name="base"/>
  <link name="ball"><collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="ball"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
</robot>"""
CUBE = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                  [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def pose(x, y, z):
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out


class Ball(unittest.TestCase):
    def setUp(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "ball.urdf"
            file.write_text(BALL)
            self.world = collision.World(model.Robot.from_urdf(file))

    def refused(self, error, call):
        with self.assertRaises(error) as caught:
            call()
        self.assertRegex(str(caught.exception), r"^[^\n]{5,300}$")

    def test_distances_to_shapes_are_those_of_the_closed_form(self):
        q = np.linspace(-2, 2, 41)
        ball = np.stack([0.5 * np.cos(q), 0.5 * np.sin(q), 0 * q], axis=1)
        shapes = {"box": (collision.Box(0.2, 0.2, 0.2), None),
                  "mesh": (collision.Mesh(CUBE, FACES), None),
                  "sphere": (collision.Sphere(0.05), 0.05)}
        for name, (shape, radius) in shapes.items():
            at = np.array([0.9, 0.2, 0.0])
            self.world.set_obstacles([collision.Obstacle("thing", shape, pose(*at))])
            out = self.world.to_obstacles(q[:, None])
            off = np.abs(ball - at)
            apart = (np.linalg.norm(np.maximum(off - 0.1, 0), axis=1) if radius is None
                     else np.linalg.norm(off, axis=1) - radius)
            expected = np.maximum(apart - 0.1, 0)
            self.assertGreater(np.count_nonzero(expected), 30)
            np.testing.assert_allclose(out.distance, expected, atol=2e-5, err_msg=name)
            far = expected > 1e-3
            np.testing.assert_allclose(np.linalg.norm(out.on_robot - out.on_other, axis=1)[far],
                                       expected[far], atol=1e-4, err_msg=name)
            clear = np.abs(apart - 0.1) > 1e-4
            np.testing.assert_array_equal(self.world.are_free(q[:, None])[clear],
                                          (apart > 0.1)[clear])

    def test_a_contact_is_named(self):
        self.world.set_obstacles([collision.Obstacle("lamp", collision.Box(0.1, 0.1, 0.1),
                                                     pose(0, 0.5, 0))])
        self.assertTrue(self.world.check([0]))
        verdict = self.world.check([np.pi / 2])
        self.assertEqual(verdict, (False, "link ball", "box lamp"))
        self.assertEqual(self.world.check_motion([0], [3]).second, "box lamp")
        self.assertTrue(self.world.check_motion([0], [0.9]).free)
        self.world.set_base(pose(5, 0, 0))
        self.assertTrue(self.world.check([np.pi / 2]).free)

    def test_people_are_near_and_touched(self):
        self.assertEqual(self.world.to_people([0]).distance[0], np.inf)
        person = model.Person.standing([2.0, 0, -1.2], np.pi, name="anna")
        self.world.set_people([person])
        out = self.world.to_people([0])
        chest = out.on_other[0]
        self.assertAlmostEqual(out.distance[0], np.linalg.norm(chest - out.on_robot[0]), 6)
        self.assertTrue(1.0 < out.distance[0] < 1.35, out.distance)  # 1.4 m less half a trunk
        self.world.set_people([model.Person.standing([0.5, 0, -1.2], np.pi, name="anna")])
        self.assertEqual(self.world.check([0]).second, "person anna")
        self.assertLess(self.world.to_people([0]).distance[0], 0)

    def test_threads_share_a_world(self):
        self.world.set_obstacles([collision.Obstacle("a", collision.Sphere(0.1), pose(1, 0, 0))])
        q = np.linspace(-1, 1, 200)[:, None]
        expected = self.world.to_obstacles(q).distance
        wrong = []

        def work():
            for _ in range(5):
                if not np.array_equal(self.world.to_obstacles(q).distance, expected):
                    wrong.append(1)
        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_mistakes_are_one_sentence(self):
        box, here = collision.Box(1, 1, 1), np.eye(4)
        put = lambda shape, at=here: self.world.set_obstacles(  # noqa: E731
            [collision.Obstacle("x", shape, at)])
        for error, call in (
                (TypeError, lambda: collision.World("jido")),
                (ValueError, lambda: self.world.check([0, 1])),
                (ValueError, lambda: self.world.check([np.nan])),
                (ValueError, lambda: self.world.are_free(np.zeros((3, 2)))),
                (ValueError, lambda: self.world.check_motion([0], [1], 0)),
                (TypeError, lambda: self.world.set_obstacles([box])),
                (TypeError, lambda: self.world.set_people(["anna"])),
                (TypeError, lambda: put("box")),
                (ValueError, lambda: put(collision.Box(1, -1, 1))),
                (ValueError, lambda: put(collision.Sphere(np.nan))),
                (TypeError, lambda: put(collision.Sphere("big"))),
                (ValueError, lambda: put(box, 2 * here)),
                (ValueError, lambda: put(collision.Mesh(CUBE, [[0, 1, 8]]))),
                (ValueError, lambda: put(collision.Mesh(CUBE, [[0, 0, 1]]))),
                (TypeError, lambda: collision.Mesh(CUBE)),
                (model.MissingError, lambda: put(collision.Mesh("/no/such.stl")))):
            self.refused(error, call)


class Shapes(unittest.TestCase):
    def test_distance_of_two_spheres_is_that_of_their_centres(self):
        out = collision.shape_distance(collision.Sphere(0.1), pose(0, 0, 0), collision.Sphere(0.2),
                                       pose(0, 3, 4))
        self.assertFalse(out.collide)
        self.assertAlmostEqual(out.distance, 4.7, 5)


class People(unittest.TestCase):
    def test_a_body_is_completed_from_a_few_joints(self):
        standing = model.Person.standing([1, 2, 0], 0.5)
        some = {name: point + [0, 0, 0.1] for name, point in standing.joints.items()
                if name in ("head", "r_hand", "torso")}
        person = model.Person(some)
        self.assertEqual(sorted(person.joints), sorted(model.JOINT_NAMES))
        for name, point in some.items():
            np.testing.assert_allclose(person.joints[name], point, atol=1e-9)

    def test_mistakes_are_one_sentence(self):
        for error, call in ((TypeError, lambda: model.Person([1, 2, 3])),
                            (ValueError, lambda: model.Person({})),
                            (ValueError, lambda: model.Person({"nose": [0, 0, 1]})),
                            (ValueError, lambda: model.Person({"head": [0, np.nan, 1]})),
                            (TypeError, lambda: model.Person({"head": "up"})),
                            (ValueError, lambda: model.Person.standing([0, 0, 0], gaze=[0, 0, 0])),
                            (ValueError, lambda: model.Person.standing([0, 0, 0], 0, 17)),
                            (ValueError, lambda: model.Person.sitting([0, 0]))):
            with self.assertRaises(error) as caught:
                call()
            self.assertRegex(str(caught.exception), r"^[^\n]{5,200}\.$")


class Costs(unittest.TestCase):
    def setUp(self):
        self.person = model.Person.standing([0, 0, 0], 0.0, gaze=[1, 0, 0])
        self.head = self.person.joints["head"]

    def test_visibility_is_the_angle_off_the_gaze(self):
        angles = np.linspace(0, np.pi, 19)
        points = self.head + np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
        np.testing.assert_allclose(cost.at(self.person, points).visibility, angles / np.pi,
                                   atol=1e-9)
        far = cost.at(self.person, [self.head + [-5, 0, 0]])
        self.assertEqual(far.visibility[0], 0)

    def test_safety_falls_to_zero_at_its_radius(self):
        x = np.linspace(0.3, 2.5, 30)
        out = cost.at(self.person, np.stack([x, 0 * x, 0 * x + 1], axis=1))
        self.assertTrue((np.diff(out.safety) <= 1e-12).all())
        self.assertEqual(out.safety[-1], 0)
        self.assertGreater(out.safety[0], 0.3)

    def test_the_total_is_the_weighted_mean(self):
        points = np.random.default_rng(2).uniform([-1, -1, 0], [1, 1, 2], (200, 3))
        out = cost.at(self.person, points, cost.Settings(safety=2, visibility=1, comfort=1))
        np.testing.assert_allclose(out.total, (2 * out.safety + out.visibility + out.comfort) / 4)
        self.assertTrue(((out.comfort >= 0) & (out.comfort <= 1)).all())
        self.assertTrue((out.comfort < 1).any() and (out.comfort == 1).any())

    def test_a_grid_has_the_costs_of_its_points(self):
        x, y, z = np.linspace(-1, 1, 7), np.linspace(-1, 1, 5), [0.9, 1.2]
        out = cost.grid(self.person, x, y, z)
        self.assertEqual(out.total.shape, (7, 5, 2))
        for i, j, k in ((0, 0, 0), (3, 4, 1), (6, 2, 0)):
            self.assertEqual(out.total[i, j, k], cost.at(self.person, [[x[i], y[j], z[k]]]).total[0])

    def test_a_robot_costs_more_near_a_person(self):
        robot = model.Robot("jido")
        tool = robot.forward(robot.rest)[:3, 3]
        costs = [cost.of_robot(robot, [robot.rest], [model.Person.standing(
            [tool[0] + d, tool[1], 0], np.pi)]) for d in (0.6, 1.2, 9)]
        self.assertTrue(costs[0].safety > costs[1].safety > costs[2].safety)
        self.assertEqual(costs[2].safety[0], 0)
        self.assertGreater(costs[2].distance[0], 7)
        self.assertEqual(cost.of_robot(robot, [robot.rest], []).total[0], 0)

    def test_mistakes_are_one_sentence(self):
        for error, call in ((TypeError, lambda: cost.at("anna", [[0, 0, 1]])),
                            (ValueError, lambda: cost.at(self.person, [0, 0, 1])),
                            (ValueError, lambda: cost.at(self.person, [[0, 0, np.inf]])),
                            (TypeError, lambda: cost.at(self.person, [[0, 0, 1]], 3)),
                            (ValueError, lambda: cost.at(self.person, [[0, 0, 1]],
                                                         cost.Settings(safety=-1))),
                            (ValueError, lambda: cost.grid(self.person, 1, [1], [1])),
                            (TypeError, lambda: cost.grid(self.person, "ab", [1], [1]))):
            with self.assertRaises(error) as caught:
                call()
            self.assertRegex(str(caught.exception), r"^[^\n]{5,200}\.$")


if __name__ == "__main__":
    unittest.main()
