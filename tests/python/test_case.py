"""Cases: keys are read and set in the text of the file, with the refusals of the reader."""

import unittest

import numpy as np
import talus
from common import InAFolder, column


class ACase(InAFolder):
    def test_has_the_values_of_its_file(self):
        case = talus.Case(self.column)
        self.assertEqual(case["material"]["sand"]["phi"], "30 deg")
        self.assertEqual(case["material.sand.nu"], 0.3)
        self.assertEqual(case["body"]["column"]["box"]["max"], ("0.1 m", "0.1 m"))
        self.assertEqual(list(case["material"]), ["sand"])
        self.assertIn("sand", case["material"])
        self.assertEqual(case.text, column)

    def test_is_changed_in_place(self):
        case = talus.Case(column)
        case["material"]["sand"]["phi"] = "25 deg"
        self.assertEqual(case.text, column.replace('phi = "30 deg"   # of', 'phi = "25 deg"   # of'))
        case["output"]["pictures"] = np.array([])
        case["run"]["end"] = "0.1 s"
        case["body.column.box.max"] = ["0.2 m", "0.1 m"]
        case["material.sand.nu"] = np.float64(0.25)
        self.assertEqual(case["body"]["column"]["box"]["max"], ("0.2 m", "0.1 m"))
        self.assertEqual(case.check()["material.sand.nu"].value, "0.25")

    def test_gets_keys_and_tables_that_it_did_not_have(self):
        case = talus.Case(column)
        case["numerics"] = {"cfl": 0.3, "transfer": "flip"}
        case["numerics"]["flip_share"] = 0.9
        case["domain"]["walls"]["x_min"] = "slip"
        settings = case.check()
        self.assertEqual(settings["numerics.cfl"].value, "0.3")
        self.assertFalse(settings["numerics.flip_share"].default)
        self.assertTrue(settings["numerics.shape"].default)
        self.assertTrue(case.text.startswith("title = "))

    def test_gets_another_table_in_place_of_one(self):
        case = talus.Case(column)
        soft = talus.Law("linear_elastic", E="1 MPa", nu=0.2)
        case["material"]["sand"] = {**soft.to_dict(), "density": "1500 kg/m3"}
        self.assertEqual(case["material"]["sand"].to_dict(),
                         {"law": "linear_elastic", "E": "1 MPa", "nu": 0.2, "density": "1500 kg/m3"})
        self.assertLess(case.text.index("nu = 0.2"), case.text.index("[body.column]"))
        case.check()
        before = case.text
        with self.assertRaises(TypeError):
            case["run"] = {"end": object()}
        self.assertEqual(case.text, before)

    def test_loses_a_key(self):
        case = talus.Case(column)
        del case["output"]["history"]
        self.assertEqual(case.text, column.replace('history = "1 ms"\n', ""))
        with self.assertRaises(KeyError):
            del case["output"]["history"]
        with self.assertRaisesRegex(talus.InputError, "cannot be removed"):
            del case["body"]["column"]["box"]["max"]

    def test_refuses_with_all_complaints_at_once(self):
        case = talus.Case(self.column)
        case["material"]["sand"]["phi"] = 30
        case["body"]["column"]["spacing"] = "10 kPa"
        with self.assertRaises(talus.InputError) as refused:
            case.check()
        first, second = refused.exception.complaints
        self.assertIn("material.sand.phi = 30", first.text)
        self.assertEqual(first.line, 1 + column[:column.index("phi =")].count("\n"))
        self.assertIn("10 kPa", second.text)
        self.assertIn(first.text, str(refused.exception))
        self.assertIsInstance(refused.exception, ValueError)

    def test_suggests_a_key(self):
        with self.assertRaisesRegex(KeyError, "did you mean `sand`"):
            talus.Case(column)["material"]["sant"]

    def test_that_is_not_there_or_no_toml_is_an_input_error(self):
        with self.assertRaisesRegex(talus.InputError, "cannot open .*nothing.toml"):
            talus.Case(self.folder / "nothing.toml")
        with self.assertRaises(talus.InputError):
            talus.Case("title = ")
        with self.assertRaises(TypeError):
            talus.Case(column)["run"]["end"] = None

    def test_copy_stands_alone(self):
        case = talus.Case(self.column)
        other = case.copy()
        other["run"]["end"] = "1 s"
        self.assertFalse(case.is_changed)
        self.assertTrue(other.is_changed)
        self.assertEqual(case["run"]["end"], "0.05 s")

    def test_saved_elsewhere_names_the_same_files(self):
        (self.folder / "points.csv").write_text("x,y\n")
        case = talus.Case(column.replace('spacing = "10 mm"', 'points = { file = "points.csv" }'), folder=self.folder)
        (self.folder / "other").mkdir()
        case.save(self.folder / "other" / "case.toml")
        self.assertEqual(talus.Case(self.folder / "other" / "case.toml")["body.column.points.file"],
                         str(self.folder / "points.csv"))


if __name__ == "__main__":
    unittest.main()
