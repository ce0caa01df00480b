# SPDX-License-Identifier: Apache-2.0
"""handsel.grasp against known grasps."""

import unittest

import numpy as np

from handsel import grasp


def ring(count: int, radius: float = 0.03) -> tuple:
    angles = 2 * np.pi * np.arange(count) / count
    out = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    return radius * out, -out


class Closure(unittest.TestCase):
    def test_three_fingers_close_and_two_points_do_not(self):
        for count, closed in ((2, False), (3, True), (4, True)):
            wrenches = grasp.contact_wrenches(*ring(count), 0.6, torque_scale=30)
            self.assertEqual(wrenches.shape, (6, 8 * count))
            self.assertEqual(grasp.force_closure(wrenches), closed, count)

    def test_two_patches_close(self):
        wrenches = grasp.contact_wrenches(*ring(2), 0.6, 0.01, torque_scale=30)
        self.assertTrue(grasp.force_closure(wrenches))

    def test_without_friction_a_ring_does_not_close(self):
        self.assertFalse(grasp.force_closure(grasp.contact_wrenches(*ring(4), 0.0)))

    def test_edges_lie_on_the_friction_cone(self):
        positions, normals = ring(3)
        wrenches = grasp.contact_wrenches(positions, normals, 0.4, edges=12)
        for i in range(36):
            force, torque = wrenches[:3, i], wrenches[3:, i]
            normal = normals[i // 12]
            along = force @ normal
            self.assertAlmostEqual(np.linalg.norm(force - along * normal), 0.4 * along, 9)
            np.testing.assert_allclose(torque, np.cross(positions[i // 12], force), atol=1e-12)


class Grip(unittest.TestCase):
    def test_forces_cancel_out_and_bear_the_load(self):
        positions, normals = ring(3)
        out = grasp.grip_forces(positions, normals, 0.6, mass=0.3)
        np.testing.assert_allclose(out.forces.sum(axis=0), 0, atol=1e-4)
        np.testing.assert_allclose(np.cross(positions, out.forces).sum(axis=0), 0, atol=1e-5)
        self.assertGreater(out.margin, 0)
        self.assertTrue((np.einsum("ij,ij->i", out.forces, normals) <= 15 + 1e-6).all())

    def test_a_load_that_is_too_heavy_has_no_margin(self):
        self.assertLess(grasp.grip_forces(*ring(3), 0.6, mass=30).margin, 0)

    def test_two_contacts_bear_nothing(self):
        self.assertEqual(grasp.grip_forces(*ring(2), mass=0.1).margin, 0)


if __name__ == "__main__":
    unittest.main()
