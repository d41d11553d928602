"""What the tests of the Python package share. Run by ctest with PYTHONPATH=build/python and TALUS_PROGRAM=build/talus."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

root = pathlib.Path(__file__).resolve().parents[2]
program = os.environ["TALUS_PROGRAM"]

# 200 particles that slump for some hundred steps.
column = '''title = "A small column slumps"
[domain]
kind = "plane_strain"
min = ["-0.4 m", "0 m"]
max = ["0.4 m", "0.3 m"]
cell = "20 mm"
gravity = ["0 m/s2", "-9.81 m/s2"]
[domain.walls]
y_min = "no_slip"
[material.sand]   # dry
law = "mohr_coulomb"
E = "1 MPa"
nu = 0.3
c = "0 Pa"
phi = "30 deg"   # of friction
psi = "0 deg"
density = "1600 kg/m3"
[body.column]
material = "sand"
box = { min = ["-0.1 m", "0 m"], max = ["0.1 m", "0.1 m"] }
spacing = "10 mm"
initial_stress = "k0"
[run]
end = "0.05 s"
[output]
snapshots = "25 ms"
history = "1 ms"
pictures = []
'''


def talus(*arguments, cwd=None):
    """Runs the program; its exit code and what it printed."""
    done = subprocess.run([program, *map(str, arguments)], cwd=cwd, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return done.returncode, done.stdout


class InAFolder(unittest.TestCase):
    """A test with a folder of its own, `self.folder`, which holds column.toml."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="talus_python_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.column = self.folder / "column.toml"
        self.column.write_text(column)

    def assert_same_results(self, a, b):
        """Tables and snapshots of two runs have the same bytes."""
        names = sorted(p.name for p in pathlib.Path(a).iterdir() if p.suffix in (".csv", ".hdf"))
        self.assertEqual(names, sorted(p.name for p in pathlib.Path(b).iterdir() if p.suffix in (".csv", ".hdf")))
        self.assertGreaterEqual(len(names), 4)
        for name in names:
            self.assertEqual((pathlib.Path(a) / name).read_bytes(), (pathlib.Path(b) / name).read_bytes(), name)
