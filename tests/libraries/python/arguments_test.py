# SPDX-License-Identifier: Apache-2.0
"""Wrong arguments: a TypeError or ValueError with one sentence, never a crash. Each row of CASES is
tried with each wrong value."""

import gc
import subprocess
import sys
import threading
import unittest

import numpy as np

from handsel import grasp, trajectory as t

LIMITS = t.Limits([1, 1], [2, 2], [9, 9])
MOTION = t.solve([0, 0], [1, 1], LIMITS)
POINTS = np.array([[0.03, 0, 0], [-0.03, 0, 0], [0, 0.03, 0]])

# Wrong in the place of an array of two numbers.
WRONG_VECTORS = {
    "None": None, "text": "ab", "bytes": b"ab", "dict": {}, "object": object(), "function": len,
    "NaN": [0, np.nan], "infinite": [np.inf, 0], "scalar": 1.0, "matrix": [[0, 1]],
    "too short": [0], "too long": [0, 1, 2], "empty": [], "bool": np.array([True, False]),
    "complex": np.array([1j, 0]), "objects": np.array([None, 1]), "texts": ["a", "b"],
    "ragged": [[0], [0, 1]], "huge int": [0, 10**400], "dates": np.array(["2020", "2021"], "M8[D]"),
    "limits": LIMITS, "set": {0, 1}, "records": np.zeros(2, dtype=[("a", float)]),
}
VECTOR_CASES = {
    "start": lambda x: t.solve(x, [1, 1], LIMITS),
    "end": lambda x: t.solve([0, 0], x, LIMITS),
    "velocity of State": lambda x: t.State([0, 0], [x] if x is None else x),
    "acceleration of Limits": lambda x: t.solve([0, 0], [1, 1], t.Limits([1, 1], x, [9, 9])),
    "stop": lambda x: t.stop(x, LIMITS),
    "switch_to": lambda x: t.switch_to(x, MOTION, LIMITS),
    "batch": lambda x: t.solve_batch(np.zeros((3, 2)), np.ones((3, 2)),
                                     t.Limits(x, [2, 2], [9, 9])),
}
WRONG_NUMBERS = {"None": [None], "text": "1", "NaN": np.nan, "infinite": -np.inf, "list": [1],
                 "bool": True, "complex": 1j, "object": object(), "huge int": 10**400,
                 "array": np.zeros(2)}
NUMBER_CASES = {
    "duration": lambda x: t.solve([0, 0], [1, 1], LIMITS, duration=x),
    "time": MOTION.at,
    "factor": MOTION.stretched,
    "allowed_excess": lambda x: t.smooth([[0, 0], [1, 1]], LIMITS, allowed_excess=x),
    "dt": lambda x: t.Run(MOTION, LIMITS).advance(x),
    "axis": MOTION.segments,
    "mass": lambda x: grasp.grip_forces(POINTS, -POINTS, mass=x),
    "torque_scale": lambda x: grasp.contact_wrenches(POINTS, -POINTS, torque_scale=x),
    "edges": lambda x: grasp.contact_wrenches(POINTS, -POINTS, edges=x),
}
OTHER_CASES = {
    "limits is a list": lambda: t.solve([0, 0], [1, 1], [1, 1]),
    "limits of a batch": lambda: t.solve_batch([0, 0], [1, 1], None),
    "limits of other size": lambda: t.solve([0], [1], LIMITS),
    "limits of no axis": lambda: t.Limits([], [], []),
    "limits negative": lambda: t.Limits([1], [1], [-1]),
    "limits zero": lambda: t.Limits([0], [1], [1]),
    "target is None": lambda: t.switch_to([0, 0], None, LIMITS),
    "trajectory made directly": t.Trajectory,
    "trajectory too fast to run": lambda: t.Run(MOTION, t.Limits([0.1] * 2, [0.1] * 2, [1] * 2)),
    "axis too large": lambda: MOTION.segments(2),
    "axis negative": lambda: MOTION.segments(-1),
    "time too large": lambda: t.Run(MOTION, LIMITS).advance(1e9),
    "step zero": lambda: t.Run(MOTION, LIMITS, 0),
    "cut backwards": lambda: MOTION.cut(1, 0),
    "one waypoint": lambda: t.smooth([[0, 0]], LIMITS),
    "no waypoints": lambda: t.smooth(np.zeros((0, 2)), LIMITS),
    "waypoints of three axes": lambda: t.smooth(np.zeros((3, 3)), LIMITS),
    "rows that differ": lambda: t.solve_batch(np.zeros((3, 2)), np.zeros((4, 2)), LIMITS),
    "argument missing": lambda: t.solve([0, 0]),
    "argument unknown": lambda: t.solve([0, 0], [1, 1], LIMITS, speed=3),
    "normals missing": lambda: grasp.contact_wrenches(POINTS, POINTS[:2]),
    "normals zero": lambda: grasp.contact_wrenches(POINTS, 0 * POINTS),
    "friction negative": lambda: grasp.contact_wrenches(POINTS, POINTS, -1),
    "friction of two": lambda: grasp.contact_wrenches(POINTS, POINTS, [1, 1]),
    "wrenches flat": lambda: grasp.force_closure(np.zeros(6)),
    "pickle of a state": lambda: __import__("pickle").dumps(t.State([0])),
}


class Arguments(unittest.TestCase):
    def refused(self, name, call):
        with self.subTest(name), self.assertRaises((TypeError, ValueError)) as caught:
            call()
        sentence = str(getattr(caught, "exception", "")).strip()
        self.assertNotIn("\n", sentence, name)
        self.assertTrue(0 < len(sentence) < 400, f"{name}: {sentence!r}")

    def test_vectors(self):
        for place, call in VECTOR_CASES.items():
            for name, wrong in WRONG_VECTORS.items():
                self.refused(f"{place}: {name}", lambda: call(wrong))

    def test_numbers(self):
        for place, call in NUMBER_CASES.items():
            for name, wrong in WRONG_NUMBERS.items():
                self.refused(f"{place}: {name}", lambda: call(wrong))

    def test_other_mistakes(self):
        for name, call in OTHER_CASES.items():
            self.refused(name, call)


class Lifetimes(unittest.TestCase):
    def test_arrays_outlive_what_they_came_from(self):
        limits = t.Limits([1, 1], [2, 2], [9, 9])
        velocity, samples = limits.velocity, t.solve([0, 0], [1, 1], limits).sample([0, 9]).position
        del limits
        gc.collect()
        np.testing.assert_array_equal(velocity, [1, 1])
        np.testing.assert_allclose(samples, [[0, 0], [1, 1]], atol=1e-9)

    def test_a_returned_array_is_a_copy(self):
        limits = t.Limits([1, 1], [2, 2], [9, 9])
        limits.velocity[:] = -7
        np.testing.assert_array_equal(limits.velocity, [1, 1])

    def test_threads_share_limits_and_trajectories(self):
        failures = []

        def work():
            try:
                for _ in range(300):
                    out = t.solve_batch(np.zeros((20, 2)), np.ones(2), LIMITS)
                    assert abs(out.duration[0] - MOTION.duration) < 1e-9
                    assert MOTION.sample([0.1]).position.shape == (1, 2)
            except BaseException as error:  # noqa: BLE001
                failures.append(error)
        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])

    def test_an_interpreter_that_ends_while_threads_work_does_not_crash(self):
        script = ("import threading, numpy as np\nfrom handsel import trajectory as t\n"
                  "L = t.Limits(np.ones(7), np.ones(7), np.ones(7))\n"
                  "def work():\n  while True: t.solve_batch(np.zeros((2000, 7)), np.ones(7), L)\n"
                  "for _ in range(3): threading.Thread(target=work, daemon=True).start()\n"
                  "t.solve_batch(np.zeros((4000, 7)), np.ones(7), L)\n")
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                              timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
