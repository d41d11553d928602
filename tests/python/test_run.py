"""Runs and sweeps from Python have the bytes of the command line, stop at Ctrl-C, continue, and list their failures."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import unittest
import warnings

import numpy as np
import talus
from common import InAFolder, column, talus as program


def interrupt_when(condition):
    """Sends Ctrl-C to this process once the condition holds."""

    def wait():
        while not condition():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=wait, daemon=True).start()


class ARun(InAFolder):
    def test_has_the_bytes_of_the_command_line(self):
        case = talus.Case(self.column)
        case["material"]["sand"]["phi"] = "25 deg"
        run = talus.run(case, out=self.folder / "python", threads=2)
        edited = self.folder / "edited.toml"
        edited.write_text(column.replace('phi = "30 deg"', 'phi = "25 deg"'))
        code, said = program("run", edited, "--out", self.folder / "shell", "--threads", 1)
        self.assertEqual(code, 0, said)
        self.assert_same_results(self.folder / "python", self.folder / "shell")
        self.assertEqual(run.case_text, edited.read_text())
        self.assertEqual(run.outcome, "finished")
        self.assertEqual(run.settings["material.sand.phi"]["value"], "25 deg")
        self.assertTrue(run.report.exists())
        self.assertEqual(run.snapshots[-1]["velocity"].shape, (200, 3))
        self.assertEqual(run.snapshots[-1].unit("velocity"), "m/s")
        self.assertEqual(run.snapshots.at(0.026).time, run.snapshots[1].time)
        self.assertGreater(len(run.history["time [s]"]), 45)
        self.assertEqual(run.surface.attrs["units"], "m")
        self.assertEqual(run.surface.dims, ("time", "x"))
        self.assertEqual(run.snapshots[0].to_pandas().shape[0], 200)
        self.assertGreaterEqual(len(run.plot().axes), 4)

    def test_is_not_written_over_another(self):
        talus.run(self.column, out=self.folder / "a", until="2 ms")
        with self.assertRaisesRegex(talus.InputError, "holds results already"):
            talus.run(self.column, out=self.folder / "a", until="2 ms")
        case = talus.Case(self.column)
        case["material.sand.phi"] = "20 deg"
        with self.assertRaisesRegex(talus.InputError, "holds another case"):
            talus.run(case, out=self.folder / "a")
        run = talus.run(case, out=self.folder / "a", until="2 ms", overwrite=True)
        self.assertEqual(run.settings["material.sand.phi"]["value"], "20 deg")

    def test_refuses_before_it_writes(self):
        case = talus.Case(self.column)
        case["material.sand.phi"] = 30
        with self.assertRaisesRegex(talus.InputError, "material.sand.phi = 30"):
            talus.run(case, out=self.folder / "a")
        self.assertFalse((self.folder / "a").exists())

    def test_stops_at_ctrl_c_and_resumes_to_the_same_bytes(self):
        case = talus.Case(self.column)
        case["run.end"] = "0.4 s"
        whole = talus.run(case, out=self.folder / "whole", threads=1)
        history = self.folder / "parts" / "history.csv"
        interrupt_when(lambda: history.exists() and history.stat().st_size > 5000)
        with self.assertRaises(KeyboardInterrupt):
            talus.run(case, out=self.folder / "parts", threads=1)
        stopped = talus.open(self.folder / "parts")
        self.assertEqual(stopped.outcome, "stopped")
        self.assertLess(len(stopped.history["time [s]"]), len(whole.history["time [s]"]))
        resumed = talus.run(case, out=self.folder / "parts", threads=1, resume=True)
        self.assertEqual(resumed.outcome, "finished")
        self.assert_same_results(self.folder / "whole", self.folder / "parts")

    def test_opens_without_the_solver(self):
        talus.run(self.column, out=self.folder / "a", until="2 ms")
        # A copy of the package without its compiled part.
        package = pathlib.Path(talus.__file__).parent
        (self.folder / "python" / "talus").mkdir(parents=True)
        for file in package.glob("*.py"):
            (self.folder / "python" / "talus" / file.name).write_bytes(file.read_bytes())
        code = ("import talus, sys; run = talus.open(sys.argv[1]); print(run.snapshots[-1]['position'].shape, run.outcome)\n"
                "print(talus.Case(sys.argv[1] + '/case.toml')['run.end'])\n"
                "try: talus.version()\n"
                "except ImportError: print('no solver')")
        said = subprocess.run([sys.executable, "-c", code, self.folder / "a"], text=True, stdout=subprocess.PIPE,
                              env={**os.environ, "PYTHONPATH": str(self.folder / "python")}, check=True).stdout
        self.assertEqual(said, "(200, 3) finished\n0.05 s\nno solver\n")

    def test_in_space_has_a_map_of_the_surface(self):
        (self.folder / "history.csv").write_text("time [s],front_radius [m],height [m],kinetic_energy [J]\n0,1,1,0\n")
        (self.folder / "surface.csv").write_text("time [s],x [m],y [m],thickness [m],speed [m/s]\n"
                                                 "0,1,1,0.5,2\n0,3,1,0.25,4\n0,1,3,0.125,6\n")
        (self.folder / "rings.csv").write_text("time [s],radius [m],thickness [m]\n0,0.5,0.5\n0,1.5,0\n")
        run = talus.Run(self.folder)
        self.assertEqual(run.surface.dims, ("time", "y", "x"))
        self.assertEqual(float(run.surface.sel(time=0, x=3, y=1)), 0.25)
        self.assertTrue(np.isnan(run.surface.sel(time=0, x=3, y=3)))
        self.assertEqual(float(run.surface_speed.sel(time=0, x=1, y=3)), 6)
        self.assertEqual(run.surface_speed.attrs["units"], "m/s")
        self.assertEqual(list(run.rings.sel(time=0)), [0.5, 0])
        self.assertEqual(run.plot().axes[2].get_xlabel(), "radius [m]")

    def test_of_nothing_is_an_input_error(self):
        with self.assertRaisesRegex(talus.InputError, "no such folder"):
            talus.open(self.folder / "nothing")
        with self.assertRaisesRegex(talus.InputError, "no results"):
            talus.open(self.folder)


class ASweep(InAFolder):
    def test_has_a_folder_a_run_with_the_bytes_of_a_single_run(self):
        angles = ["20 deg", "25 deg", "30 deg"]
        sweep = talus.sweep(self.column, {"material.sand.phi": angles, "material.sand.nu": [0.2, 0.3]},
                            out=self.folder / "s", workers=2)
        self.assertEqual(list(sweep.runs), [f"phi_{a}_deg__nu_{nu}" for a in (20, 25, 30) for nu in (0.2, 0.3)])
        edited = self.folder / "edited.toml"
        edited.write_text(column.replace('phi = "30 deg"', 'phi = "25 deg"').replace("nu = 0.3", "nu = 0.2"))
        code, said = program("run", edited, "--out", self.folder / "one")
        self.assertEqual(code, 0, said)
        self.assert_same_results(self.folder / "one", self.folder / "s" / "phi_25_deg__nu_0.2")
        table = sweep.table()
        self.assertEqual(list(table["material.sand.phi [deg]"]), [20, 20, 25, 25, 30, 30])
        self.assertEqual(list(table["material.sand.nu"]), [0.2, 0.3] * 3)
        self.assertEqual(list(table["outcome"]), ["finished"] * 6)
        self.assertEqual(len(set(table["hash"])), 6)
        last = sweep["phi_25_deg__nu_0.2"].history["height [m]"]
        self.assertEqual(list(table["height [m]"])[2], list(last)[-1])
        self.assertEqual(sweep.failures, {})
        self.assertGreaterEqual(len(sweep.plot().axes), 4)
        self.assertTrue((self.folder / "s" / "sweep.html").exists())

    def test_is_the_same_from_the_command_line(self):
        values = {"material.sand.phi": ["20 deg", "30 deg"]}
        talus.sweep(self.column, values, out=self.folder / "python")
        code, said = program("sweep", self.column, "--set", "material.sand.phi=20 deg,30 deg", "--out", self.folder / "shell",
                             "--workers", 2)
        self.assertEqual(code, 0, said)
        for name in ("phi_20_deg", "phi_30_deg"):
            self.assert_same_results(self.folder / "python" / name, self.folder / "shell" / name)
        of_python, of_shell = (talus.open(self.folder / n).record for n in ("python", "shell"))
        self.assertEqual(of_python["runs"], of_shell["runs"])
        # What one has written the other continues: nothing is left to do.
        code, said = program("sweep", self.folder / "python")
        self.assertEqual(code, 0, said)
        self.assertIn("2 runs, 2 of them complete", said)

    def test_has_the_hashes_of_the_command_line_whatever_the_quotes(self):
        titles = ["plain", "Lamb's", 'a "b", c', "a'b\"c", "x = [1, 2]", "\\psi"]
        talus.sweep(self.column, {"title": titles, "run.end": ["25 ms"]}, out=self.folder / "python")
        typed = ["plain", "Lamb's", '"a \\"b\\", c"', "a'b\"c", "'x = [1, 2]'", "\\psi"]
        code, said = program("sweep", self.column, "--set", f"title={','.join(typed)}", "--set", 'run.end="25 ms"',
                             "--out", self.folder / "shell")
        self.assertEqual(code, 0, said)
        of_python, of_shell = (talus.open(self.folder / n).record for n in ("python", "shell"))
        self.assertEqual(of_python["runs"], of_shell["runs"])
        self.assertEqual([run["settings"]["title"] for run in of_shell["runs"]], titles)

    def test_grows_and_keeps_what_is_complete(self):
        out = self.folder / "s"
        talus.sweep(self.column, {"material.sand.phi": ["20 deg"]}, out=out)
        record = (out / "phi_20_deg" / "record.json").read_bytes()
        sweep = talus.sweep(self.column, {"material.sand.phi": ["20 deg", "25 deg"]}, out=out)
        self.assertEqual((out / "phi_20_deg" / "record.json").read_bytes(), record)
        self.assertEqual(len(sweep), 2)
        case = talus.Case(self.column)
        case["material.sand.nu"] = 0.1
        with self.assertRaisesRegex(talus.InputError, "holds the run of another case"):
            talus.sweep(case, {"material.sand.phi": ["20 deg"]}, out=out)

    def test_stops_at_ctrl_c_and_continues_to_the_same_bytes(self):
        case = talus.Case(self.column)
        case["run.end"] = "0.4 s"
        values, out = {"material.sand.phi": ["25 deg", "30 deg"]}, self.folder / "s"
        history = out / "phi_25_deg" / "history.csv"
        interrupt_when(lambda: history.exists() and history.stat().st_size > 5000)
        with self.assertRaises(KeyboardInterrupt):
            talus.sweep(case, values, out=out, threads=1)
        self.assertEqual([run["outcome"] for run in talus.open(out).record["runs"]], ["stopped", "waiting"])
        sweep = talus.sweep(case, values, out=out, threads=1)
        self.assertEqual([run["outcome"] for run in sweep.record["runs"]], ["finished", "finished"])
        case["material.sand.phi"] = "25 deg"
        talus.run(case, out=self.folder / "whole", threads=1)
        self.assert_same_results(self.folder / "whole", out / "phi_25_deg")

    def test_lists_failures_and_goes_on(self):
        (self.folder / "s" / "nu_0.1" / "surface.csv" / "in_the_way").mkdir(parents=True)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            sweep = talus.sweep(self.column, {"material.sand.nu": [0.1, 0.2]}, out=self.folder / "s")
        self.assertEqual(list(sweep.failures), ["nu_0.1"])
        self.assertIn("1 of 2 runs failed", str(said[0].message))
        table = sweep.table()
        self.assertEqual(list(table["outcome"]), ["failed", "finished"])
        self.assertNotEqual(list(table["failure"])[0], "")

    def test_refuses_all_runs_before_the_first(self):
        with self.assertRaises(talus.InputError) as refused:
            talus.sweep(self.column, {"material.sand.phi": ["20 deg", "25 kPa", 30]}, out=self.folder / "s")
        self.assertEqual(len(refused.exception.complaints), 2)
        self.assertFalse((self.folder / "s").exists())
        with self.assertRaisesRegex(talus.InputError, "did you mean `sand`"):
            talus.sweep(self.column, {"material.sant.phi": ["20 deg"]}, out=self.folder / "s")
        with self.assertRaises(TypeError):
            talus.sweep(self.column, {"material.sand.phi": "20 deg"})


class AComparison(InAFolder):
    def test_tells_what_differs_in_numbers(self):
        for name, angle in (("a", "20 deg"), ("b", "30 deg"), ("c", "20 deg")):
            case = talus.Case(self.column)
            case["material.sand.phi"] = angle
            talus.run(case, out=self.folder / name)
        code, said = program("compare", "a", "b", "--out", "page.html", cwd=self.folder)
        self.assertEqual(code, 0, said)
        self.assertIn("height [m]", said)
        page = (self.folder / "page.html").read_text()
        self.assertIn("<code>material.sand.phi</code></td><td>20 deg</td><td>30 deg</td>", page)
        self.assertNotIn("material.sand.nu</code>", page)
        self.assertIn("data:image/svg+xml;base64,", page)
        code, said = program("compare", "a", "c", cwd=self.folder)
        self.assertEqual(code, 0, said)
        self.assertIn("no difference in history.csv", said)
        self.assertTrue((self.folder / "out/compare_a_c.html").exists())

    def test_of_no_run_is_an_input_error(self):
        code, said = program("compare", "a", "b", cwd=self.folder)
        self.assertEqual(code, 2)
        self.assertIn("a holds no results of a run", said)


if __name__ == "__main__":
    unittest.main()
