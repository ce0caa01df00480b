# SPDX-License-Identifier: Apache-2.0
"""handsel.Environment: the whole system in lock-step from Python."""

import gc
import os
import time
import unittest

import numpy as np

import handsel
from handsel import environment


class Task(unittest.TestCase):
    """The policy gives tasks; the system does the rest."""

    @classmethod
    def setUpClass(cls):
        cls.env = handsel.Environment("give_mug", 5, control="task")
        cls.first, cls.info = cls.env.reset()

    @classmethod
    def tearDownClass(cls):
        cls.env.close()

    def test_1_observation_has_robot_people_and_objects(self):
        self.assertEqual(self.first["robot"]["base"].shape, (4, 4))
        self.assertEqual(self.first["robot"]["position"].shape, self.first["robot"]["measured"].shape)
        self.assertEqual([p["id"] for p in self.first["people"]], ["anna"])
        self.assertEqual(self.first["people"][0]["joints"]["head"].shape, (3,))
        mug = [o for o in self.first["objects"] if o["id"] == "mug"][0]
        self.assertEqual(mug["holder"], "surface")
        self.assertEqual(self.info["tasks"][0]["kind"], "give")
        self.assertEqual(self.info["seed"], 5)
        self.assertFalse(self.info["success"])

    def test_2_without_an_action_nothing_happens(self):
        out = self.env.step(duration=0.5)
        self.assertAlmostEqual(out[0]["time"], self.first["time"] + 0.5, 6)
        self.assertEqual(out[1:4], (0.0, False, False))
        self.assertEqual(out[0]["motion"]["state"], "idle")

    def test_3_mistakes_are_one_sentence_and_the_trial_continues(self):
        for error, call in ((TypeError, lambda: self.env.step(3)),
                            (ValueError, lambda: self.env.step({"jump": 1})),
                            (ValueError, lambda: self.env.step({"task": {"kind": "dance"}})),
                            (ValueError, lambda: self.env.step({"stop": True})),
                            (ValueError, lambda: self.env.step({"task": {"kind": np.nan}})),
                            (TypeError, lambda: self.env.step({"task": object()})),
                            (ValueError, lambda: self.env.step(duration=-1)),
                            (TypeError, lambda: self.env.step(duration="long")),
                            (ValueError, lambda: self.env.grasps("mug")),
                            (TypeError, lambda: self.env.reset(seed=1.5)),
                            (ValueError, lambda: handsel.Environment("a", control="mind")),
                            (TypeError, lambda: handsel.Environment(7)),
                            (ValueError, lambda: handsel.Environment("give_mug").step())):
            with self.assertRaises(error) as caught:
                call()
            self.assertRegex(str(caught.exception), r"^[^\n]{5,300}$")
        self.assertEqual(self.env.step()[0]["motion"]["state"], "idle")

    def test_4_the_task_of_the_scenario_is_done_and_rewarded(self):
        begin, steps = time.process_time(), 0
        observation, reward, terminated, truncated, info = self.env.step(
            {"task": self.info["tasks"][0]})
        states = set()
        while not (terminated or truncated):
            observation, reward, terminated, truncated, info = self.env.step()
            states.add(observation["task"]["state"])
            steps += 1
        self.assertEqual((reward, terminated, truncated), (1.0, True, False))
        self.assertIn("running", states)
        self.assertTrue(info["success"])
        self.assertGreater(info["oracle"]["max_lifted"], 0.1)
        self.assertEqual(info["oracle"]["limit_violations"], 0)
        own = (time.process_time() - begin) / (steps * 0.1)
        self.assertLess(own, 0.1, "Python takes more than a tenth of real time")


class Motion(unittest.TestCase):
    """The policy moves arm and hand."""

    def test_equal_actions_give_equal_bits_and_a_target_is_reached(self):
        hashes = []
        with handsel.Environment("give_mug", control="motion") as env:
            for _ in range(2):
                observation, info = env.reset(seed=3)
                arm = handsel.model.Robot(info["robot"]).groups["arm"]
                target = observation["robot"]["position"][arm]
                target[0] += 0.2
                env.step({"target": {"position": target}})
                while env.observation["motion"]["moving"]:
                    env.step()
                out = env.observation["robot"]
                np.testing.assert_allclose(out["position"][arm], target, atol=1e-6)
                np.testing.assert_allclose(out["measured"][arm], target, atol=0.02)
                self.assertEqual(env.info["oracle"]["limit_violations"], 0)
                hashes.append(env.info["oracle"]["hash"])
                with self.assertRaisesRegex(ValueError, "axes"):
                    env.step({"target": {"position": [0.0]}})
                with self.assertRaisesRegex(ValueError, "no plan"):
                    env.step({"run": 7})
                with self.assertRaisesRegex(ValueError, "no object"):
                    env.step({"hold": "moon"})
        self.assertEqual(hashes[0], hashes[1])
        self.assertGreater(hashes[0], 0)


class Process(unittest.TestCase):
    def test_a_scenario_that_is_not_there_is_a_missing_file(self):
        with self.assertRaisesRegex(FileNotFoundError, "no_such_scenario"):
            handsel.Environment("no_such_scenario").reset()

    def test_a_process_that_dies_is_reported_and_replaced(self):
        with handsel.Environment("give_mug", control="task") as env:
            env.reset()
            os.kill(env._process.pid, 9)
            with self.assertRaisesRegex(environment.SystemEnded, "SIGKILL"):
                env.step()
            with self.assertRaisesRegex(ValueError, "reset"):
                env.step()
            self.assertEqual(env.reset()[1]["seed"], 2)

    def test_an_environment_that_is_forgotten_leaves_no_process(self):
        env = handsel.Environment("give_mug", control="task")
        env.reset()
        process = env._process
        del env
        gc.collect()
        self.assertIsNotNone(process.poll())


if __name__ == "__main__":
    unittest.main()
