"""A simulation in steps has the bits of a run, and its arrays are safe to keep."""

import gc
import os
import signal
import threading
import time
import unittest

import numpy as np
import talus
from common import InAFolder, column, talus as program


class ASimulation(InAFolder):
    def test_has_the_bits_of_the_command_line(self):
        code, said = program("run", self.column, "--out", self.folder / "run", "--threads", 1)
        self.assertEqual(code, 0, said)
        run = talus.open(self.folder / "run")
        for threads in (1, 2):
            sim = talus.Simulation(self.column, threads=threads)
            for snapshot in run.snapshots:
                while sim.n_steps < snapshot.step:
                    sim.step()
                self.assertEqual(sim.time, snapshot.time)
                np.testing.assert_array_equal(sim.particles["position"], snapshot["position"])
                for name in ("velocity", "stress", "p", "kappa"):
                    np.testing.assert_array_equal(sim.particles[name].astype("f4"), snapshot[name])
            history = run.history
            self.assertAlmostEqual(sim.energies["kinetic"], list(history["kinetic_energy [J]"])[-1], delta=1e-9)
            self.assertAlmostEqual(sim.outline["height"], list(history["height [m]"])[-1], delta=1e-9)

    def test_steps_to_a_time(self):
        sim = talus.Simulation(self.column, threads=1)
        self.assertEqual(sim.time, 0)
        self.assertEqual(sim.n_particles, 200)
        while sim.time < 0.005:
            sim.step(until=sim.time + 0.001)
        self.assertLess(sim.time - sim.dt, 0.005)
        n = sim.n_steps
        sim.step(until=0.001)  # reached already
        self.assertEqual(sim.n_steps, n)
        with self.assertRaises(ValueError):
            sim.step(until=float("nan"))

    def test_hands_out_arrays_without_a_copy_that_keep_their_instant(self):
        sim = talus.Simulation(self.column, threads=1)
        particles = sim.particles
        x, same = sim.particles["position"], sim.particles["position"]
        self.assertEqual(x.shape, (200, 3))
        self.assertFalse(x.flags.owndata)
        self.assertTrue(np.shares_memory(x, same))
        with self.assertRaises(ValueError):
            x[0, 0] = 1  # the solver would not see it
        before = x.copy()
        sim.step(until=0.02)
        np.testing.assert_array_equal(x, before)
        self.assertFalse(np.shares_memory(x, sim.particles["position"]))
        self.assertGreater(np.abs(sim.particles["position"] - x).max(), 1e-6)
        self.assertEqual(particles.time, 0)
        velocity = sim.particles["velocity"]
        kept = velocity.copy()
        del sim, particles, same
        gc.collect()
        np.testing.assert_array_equal(velocity, kept)

    def test_tells_its_quantities(self):
        particles = talus.Simulation(self.column, threads=1).particles
        self.assertIn("stress", particles)
        self.assertEqual(particles["stress"].shape, (200, 6))
        self.assertEqual(particles.unit("stress"), "Pa")
        self.assertIn("tension-positive", particles.meaning("stress"))
        self.assertEqual(set(particles), set(particles.keys()))
        with self.assertRaises(KeyError):
            particles["colour"]

    def test_refuses_a_case_with_all_complaints(self):
        case = talus.Case(column)
        case["material.sand.phi"] = 30
        case["run.end"] = "1 m"
        with self.assertRaises(talus.InputError) as refused:
            talus.Simulation(case)
        self.assertEqual(len(refused.exception.complaints), 2)

    def test_stops_between_steps_at_ctrl_c_and_goes_on(self):
        sim = talus.Simulation(self.column, threads=1)
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            sim.step(until=1e6)
        n = sim.n_steps
        self.assertGreater(n, 0)
        sim.step()
        self.assertEqual(sim.n_steps, n + 1)

    def test_lets_other_threads_of_python_run(self):
        sim = talus.Simulation(self.column, threads=1)
        stepping = threading.Thread(target=sim.step, kwargs={"until": 0.4})
        stepping.start()
        turns = 0
        while stepping.is_alive():
            turns += 1
            time.sleep(0.001)
        self.assertGreater(turns, 3)
        self.assertGreaterEqual(sim.time, 0.4)


if __name__ == "__main__":
    unittest.main()
