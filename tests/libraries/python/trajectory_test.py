# SPDX-License-Identifier: Apache-2.0
"""handsel.trajectory: results against closed forms, its own samples, and each other."""

import math
import sys
import threading
import time
import unittest

import numpy as np

import handsel
from handsel import trajectory as t

SEED = 20


def one(value: float) -> np.ndarray:
    return np.array([value])


class Solve(unittest.TestCase):
    def test_rest_to_rest_has_the_duration_of_the_closed_form(self):
        # Acceleration limit reached, velocity limit not: (tj + ta)(2 tj + ta) A = d, tj = A / J.
        for distance in (0.5, 1.0, -1.5):
            a, j = 1.0, 5.0
            tj = a / j
            ta = (-3 * tj + math.sqrt(tj * tj + 4 * abs(distance) / a)) / 2
            motion = t.solve(one(0), one(distance), t.Limits(one(100), one(a), one(j)))
            self.assertAlmostEqual(motion.duration, 2 * (2 * tj + ta), 9)

    def test_random_motions_end_where_asked_and_keep_the_limits(self):
        random = np.random.default_rng(SEED)
        for _ in range(200):
            limits = t.Limits(*random.uniform(0.5, 5, (3, 4)))
            start = t.State(random.uniform(-3, 3, 4), 0.4 * limits.velocity * random.uniform(-1, 1, 4))
            end = t.State(random.uniform(-3, 3, 4))
            motion = t.solve(start, end, limits)
            self.assertEqual(motion.why_not_within(limits, 1e-6), "", f"seed {SEED}")
            at = motion.sample([0, motion.duration])
            np.testing.assert_allclose(at.position[0], start.position, atol=1e-9)
            np.testing.assert_allclose(at.velocity[0], start.velocity, atol=1e-9)
            np.testing.assert_allclose(at.position[1], end.position, atol=1e-6)
            np.testing.assert_allclose(at.velocity[1], 0, atol=1e-6)

    def test_samples_agree_with_the_integral_of_the_segments(self):
        motion = t.solve([0, 0.2], [1, -0.5], t.Limits([1, 2], [2, 1], [9, 7]))
        times = np.linspace(0, motion.duration, 301)
        sampled = motion.sample(times)
        for axis in range(2):
            durations, jerks = motion.segments(axis)
            self.assertAlmostEqual(durations.sum(), motion.duration, 9)
            x, v, a = sampled.position[0, axis], 0.0, 0.0
            knots = [(0.0, x, v, a, 0.0)]
            for duration, jerk in zip(durations, jerks):
                knots[-1] = (*knots[-1][:4], jerk)
                begin = knots[-1][0] + duration
                x, v, a = (x + duration * (v + duration * (a / 2 + duration * jerk / 6)),
                           v + duration * (a + duration * jerk / 2), a + duration * jerk)
                knots.append((begin, x, v, a, 0.0))
            for i, at in enumerate(times):
                begin, x, v, a, jerk = [k for k in knots if k[0] <= at + 1e-12][-1]
                s = at - begin
                self.assertAlmostEqual(sampled.position[i, axis],
                                       x + s * (v + s * (a / 2 + s * jerk / 6)), 9)
                self.assertAlmostEqual(sampled.velocity[i, axis], v + s * (a + s * jerk / 2), 9)
                self.assertAlmostEqual(sampled.acceleration[i, axis], a + s * jerk, 7)

    def test_an_imposed_duration_is_met_or_refused_with_the_axis(self):
        limits = t.Limits([1, 1], [1, 1], [5, 5])
        self.assertAlmostEqual(t.solve([0, 0], [1, 1], limits, duration=5).duration, 5, 9)
        with self.assertRaisesRegex(t.NoTrajectoryError, r"^axis 0: needs 2\.2\d* s.*\.$"):
            t.solve([0, 0], [1, 1], limits, duration=0.1)

    def test_integer_strided_and_swapped_arrays_give_the_same_motion(self):
        limits = t.Limits([1, 1], [1, 1], [5, 5])
        expected = t.solve([0.0, 0.0], [2.0, -1.0], limits).duration
        ends = (np.array([2, -1]), np.array([2, 9, -1, 9])[::2], np.array([2.0, 9, -1, 9])[::2],
                np.array([-1.0, 2])[::-1], np.array([2.0, -1], dtype=">f8"), (2, -1),
                np.array([2, -1], dtype=np.float32), np.array([[2.0, 0], [-1, 0]])[:, 0])
        for end in ends:
            self.assertEqual(t.solve([0, 0], end, limits).duration, expected, repr(end))


class Batch(unittest.TestCase):
    def test_equals_the_single_calls(self):
        random = np.random.default_rng(SEED)
        limits = t.Limits(*random.uniform(0.5, 3, (3, 7)))
        start, end = random.uniform(-2, 2, (2, 700, 7))
        speed = 0.3 * limits.velocity * random.uniform(-1, 1, (700, 7))
        batch = t.solve_batch(start, end, limits, start_velocity=speed)
        for i in range(0, 700, 7):
            if batch.outcome[i]:
                continue
            single = t.solve(t.State(start[i], speed[i]), end[i], limits)
            self.assertAlmostEqual(batch.duration[i], single.duration, 9)
        self.assertEqual(np.count_nonzero(batch.outcome), 0)

    def test_names_the_reason_of_a_problem_without_solution(self):
        limits = t.Limits([1, 1], [1, 1], [5, 5])
        batch = t.solve_batch([0, 0], [[1, 1], [1, 1]], limits, end_velocity=[[0, 0], [0, 2]])
        self.assertEqual(batch.reason(0), "")
        self.assertTrue(np.isnan(batch.duration[1]))
        self.assertRegex(batch.reason(1), "^axis 1: .*limit")

    def test_lets_other_threads_run(self):
        counted, done = [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
                time.sleep(0)  # offers the lock
        worker = threading.Thread(target=count)
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000)  # the lock changes hands only where it is released
        try:
            worker.start()
            before = counted[0]
            t.solve_batch(np.zeros((20000, 7)), np.ones(7),
                          t.Limits(np.ones(7), np.ones(7), np.ones(7)))
            during = counted[0] - before
        finally:
            done.set()
            sys.setswitchinterval(interval)
            worker.join()
        self.assertGreater(during, 0)


class Waypoints(unittest.TestCase):
    def test_blends_save_time_within_the_limits(self):
        limits = t.Limits([1, 1], [2, 2], [10, 10])
        out = t.smooth([[0, 0], [1, 0], [1, 1], [2, 1]], limits)
        self.assertAlmostEqual(out.duration_with_stops, 3 * 1.7, 9)  # 1 rad each: 0.7 + 0.3 + 0.7 s
        self.assertLess(out.trajectory.duration, out.duration_with_stops - 1)
        self.assertEqual(out.trajectory.why_not_within(limits, 1e-6), "")
        self.assertEqual([blend.waypoint for blend in out.blends], [1, 2])
        saved = sum(blend.saved for blend in out.blends)
        self.assertAlmostEqual(out.trajectory.duration + saved, out.duration_with_stops, 6)


class Running(unittest.TestCase):
    def setUp(self):
        self.guard = t.Limits([1.1], [2.2], [11])
        self.motion = t.solve([0], [1], t.Limits([1], [2], [10]))

    def test_pauses_and_resumes_on_the_path(self):
        run = t.Run(self.motion, self.guard)
        run.advance(0.4)
        run.set_target(0)
        run.advance(3)
        paused = run.state
        self.assertEqual(run.speed, 0)
        self.assertEqual(paused.velocity[0], 0)
        self.assertTrue(0.1 < paused.position[0] < 0.9)
        run.set_target(1)
        run.advance(5)
        self.assertTrue(run.finished)
        self.assertAlmostEqual(run.state.position[0], 1, 9)

    def test_meets_a_moving_target(self):
        slow = t.solve([0.3], [2], t.Limits([0.25], [2], [10]))
        met = t.switch_to([0], slow, self.guard, moving=True)
        np.testing.assert_allclose(met.trajectory.at(met.connecting).position,
                                   slow.at(met.joins_at).position, atol=1e-6)
        np.testing.assert_allclose(met.trajectory.at(met.connecting).velocity,
                                   slow.at(met.joins_at).velocity, atol=1e-6)

    def test_stops_in_the_time_of_the_closed_form(self):
        out = t.stop(t.State([0], [0.5]), t.Limits([1], [1], [5]))
        self.assertAlmostEqual(out.duration, 0.5 / 1 + 1 / 5, 9)

    def test_reversed_stretched_and_cut_are_the_same_path(self):
        d = self.motion.duration
        times = np.linspace(0, d, 50)
        x = self.motion.sample(times).position
        np.testing.assert_allclose(self.motion.reversed().sample(d - times).position, x, atol=1e-9)
        np.testing.assert_allclose(self.motion.stretched(2).sample(2 * times).position, x, atol=1e-9)
        part = self.motion.cut(0.2, 0.7)
        self.assertAlmostEqual(part.duration, 0.5, 9)
        np.testing.assert_allclose(part.at(0).position, self.motion.at(0.2).position, atol=1e-12)


class Package(unittest.TestCase):
    def test_has_a_semantic_version(self):
        self.assertRegex(handsel.__version__, r"^\d+\.\d+\.\d+$")


if __name__ == "__main__":
    unittest.main()
