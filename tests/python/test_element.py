"""Laws and element tests give the bits of `talus element`, and refuse what it refuses."""

import csv
import unittest

import numpy as np
import talus
from common import InAFolder, root, talus as program

sand = dict(E0=150, nu=0.2, n=0.6, phi_c="23 deg", e_ref=0.907, Lambda=0.022, xi=0.71, A_d=0.5, k_p=0.001, n_p=1, n_d=1)


class ALaw(unittest.TestCase):
    def test_has_its_parameters_in_si(self):
        law = talus.Law("simsand", **sand)
        self.assertEqual(law.parameters["phi_c"].unit, "deg" if law.parameters["phi_c"].value > 1 else "rad")
        self.assertEqual(law.parameters["E0"].value, 150)
        self.assertIn("kappa", law.quantities)
        self.assertIn("simsand", talus.laws())
        self.assertEqual(law.changed(E0=200).parameters["E0"].value, 200)

    def test_refuses_with_all_complaints_at_once(self):
        with self.assertRaises(talus.InputError) as refused:
            talus.Law("simsand", **{**sand, "phi_c": "23 kPa", "phi_cc": 1, "nu": 0.7})
        text = str(refused.exception)
        self.assertIn("phi_c = ", text)
        self.assertIn("phi_cc", text)
        self.assertIn("nu = 0.7", text)
        self.assertEqual(len(refused.exception.complaints), 3)
        with self.assertRaisesRegex(talus.InputError, "did you mean `simsand`"):
            talus.Law("simsnd", **sand)


class AnElementTest(InAFolder):
    def rows_of_the_program(self, file):
        out = self.folder / "out.csv"
        code, said = program("element", file, "--out", out)
        self.assertEqual(code, 0, said)
        with open(out) as f:
            return list(csv.reader(f))

    def test_has_the_numbers_of_the_command_line(self):
        file = root / "cases/element/drained_triaxial.toml"
        header, *rows = self.rows_of_the_program(file)
        by_file = talus.element(file)
        by_keys = talus.element(talus.Law("simsand", **sand), test="triaxial", drainage="drained", pressure="100 kPa",
                                void_ratio=0.80, axial_strain=0.30, rows=150)
        self.assertEqual(len(by_file), len(header))
        for result in (by_file, by_keys):
            self.assertEqual([n if result.units[n] == "1" else f"{n} [{result.units[n]}]" for n in result], header)
            for i, name in enumerate(result):
                self.assertEqual(len(result[name]), 151)
                shown = np.array([float(row[i]) for row in rows])
                np.testing.assert_allclose(result[name], shown, rtol=1e-8, atol=1e-12)  # printed with some digits
                np.testing.assert_array_equal(by_keys[name], by_file[name])
        # The text of a test is a file that the program runs to the same digits.
        (self.folder / "test.toml").write_text(by_keys.text)
        self.assertEqual(self.rows_of_the_program(self.folder / "test.toml"), [header, *rows])
        self.assertEqual(by_file.to_pandas().shape, (151, len(header)))

    def test_goes_along_several_segments(self):
        law = talus.Law("simsand", **sand)
        path = talus.element(law, initial={"pressure": "100 kPa", "void_ratio": 0.8}, driver={"tolerance": 1e-5},
                             segments=[{"test": "isotropic_compression", "pressure": "200 kPa", "rows": 10},
                                       {"test": "triaxial", "drainage": "undrained", "axial_strain": 0.01, "rows": 10}])
        self.assertEqual(path.n_rows, 21)
        self.assertAlmostEqual(path["p"][10], 2e5, delta=10)

    def test_refuses_with_all_complaints_at_once(self):
        law = talus.Law("simsand", **sand)
        with self.assertRaises(talus.InputError) as refused:
            talus.element(law, test="triaxial", drainage="drained", pressure="100", void_ratio=0.8, axial_strain=0.1, row=3)
        self.assertEqual(len(refused.exception.complaints), 2)
        self.assertIn("did you mean `rows`", str(refused.exception))
        with self.assertRaises(TypeError):
            talus.element(test="triaxial")

    def test_that_fails_has_the_rows_before(self):
        # Dense sand carries no 1 MPa on one axis under 100 kPa beside.
        with self.assertRaises(talus.RunError) as failed:
            talus.element(talus.Law("simsand", **sand), test="triaxial", drainage="drained", pressure="100 kPa",
                          void_ratio=0.8, axial_stress="1 MPa", rows=50)
        self.assertGreater(failed.exception.result.n_rows, 1)
        self.assertLess(failed.exception.result.n_rows, 51)


if __name__ == "__main__":
    unittest.main()
