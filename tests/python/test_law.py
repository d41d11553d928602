"""Points under a law have the bits of the C interface and of element tests, and refuse what is wrong."""

import ctypes
import os
import pathlib
import threading
import time
import unittest

import numpy as np
import talus

sand = dict(E0=150, nu=0.2, n=0.6, phi_c="23 deg", e_ref=0.907, Lambda=0.022, xi=0.71, A_d=0.5, k_p=0.001, n_p=1, n_d=1)
grains = dict(I_0=0.28, rho_s="1090 kg/m3", d="1 mm", mu_s=0.4245, mu_d=0.5718, Phi_c=0.62, dPhi=0.29)


class Setting(ctypes.Structure):
    _fields_ = [("key", ctypes.c_char_p), ("text", ctypes.c_char_p), ("number", ctypes.c_double)]


class Response(ctypes.Structure):
    _fields_ = [("stress", ctypes.c_double * 6), ("elastic_energy", ctypes.c_double), ("work", ctypes.c_double),
                ("plastic_work", ctypes.c_double), ("collisional_work", ctypes.c_double), ("stiffness", ctypes.c_double),
                ("viscosity", ctypes.c_double), ("outcome", ctypes.c_int), ("reserved", ctypes.c_int)]


class LawInC:
    """A law through libtalus_law.so."""

    def __init__(self, name, keys):
        self.c = ctypes.CDLL(str(pathlib.Path(os.environ["TALUS_PROGRAM"]).parent / "lib/libtalus_law.so"))
        self.c.talus_law_update_with_tangent.argtypes = [ctypes.c_void_p] * 4 + [ctypes.c_double] + [ctypes.c_void_p] * 2
        settings = (Setting * len(keys))(*(Setting(k.encode(), str(v).encode(), 0) for k, v in keys.items()))
        self.law, message = ctypes.c_void_p(), ctypes.create_string_buffer(4000)
        assert self.c.talus_law_make(name.encode(), settings, len(keys), ctypes.byref(self.law), message, 4000) == 0, message.value

    def update(self, state, strain, dt):
        strain, tangent, response = np.array(strain), np.empty((6, 6)), Response()
        self.c.talus_law_update_with_tangent(self.law, state.ctypes.data, strain.ctypes.data, None, dt, ctypes.addressof(response),
                                             tangent.ctypes.data)
        return response, tangent

    def __del__(self):
        self.c.talus_law_free(self.law)


class PointsUnderALaw(unittest.TestCase):
    def setUp(self):
        self.law = talus.Law("granular", **sand, **grains)

    def test_have_the_bits_of_the_c_interface(self):
        # Shear at 0.1/s and at 100/s, back, and opening: contacts, collisions, separation.
        c = LawInC("granular", {**sand, **grains})
        state = self.law.initial_state(pressure="1 kPa", void_ratio=0.85)
        numbers = state.values.copy()
        outcomes = set()
        for strain, dt in [([0, 0, 0, 2e-3, 0, 0], 0.02), ([0, 0, 0, 2e-3, 0, 0], 2e-5), ([1e-5, -3e-5, 0, -2e-3, 0, 1e-4], 1e-2),
                           ([0, -1e-5, 0, 0, 0, 0], 0), ([2e-3, 0, 0, 0, 0, 0], 1e-2)]:
            expected, tangent = c.update(numbers, np.array(strain, dtype=float), dt)
            step = self.law.update(state, strain, dt, tangent=True)
            np.testing.assert_array_equal(state.values, numbers)
            np.testing.assert_array_equal(step.stress, np.array(expected.stress))
            np.testing.assert_array_equal(step.tangent, tangent)
            for name in ("elastic_energy", "work", "plastic_work", "collisional_work", "stiffness", "viscosity", "outcome"):
                self.assertEqual(getattr(step, name), getattr(expected, name), name)
            outcomes.add(int(step.outcome))
        self.assertLessEqual({1, 3}, outcomes)

    def test_have_the_bits_of_an_element_test(self):
        law = talus.Law("simsand", **sand)
        path = talus.element(law, test="triaxial", drainage="undrained", pressure="100 kPa", void_ratio=0.85, axial_strain=0.02, rows=40)
        state = law.initial_state(pressure=1e5, void_ratio=0.85)
        components = ("xx", "yy", "zz", "xy", "yz", "zx")
        strains, rates, stresses = (np.stack([path[f"{what}_{c}"] for c in components], axis=-1) for what in ("strain", "strain_rate", "stress"))
        for i in range(1, 41):
            # The driver's strain increment is the difference of strains; compression-positive.
            step = law.update(state, 0.0 - (strains[i] - strains[i - 1]), path["time"][i] - path["time"][i - 1], 0.0 - rates[i])
            np.testing.assert_array_equal(0.0 - step.stress + 0.0, stresses[i])
        self.assertEqual(law.evaluate(state)["kappa"], path["kappa"][-1])

    def test_in_arrays_have_the_bits_of_one_by_one(self):
        pressures = np.array([[1e3, 2e3, 5e4], [1e4, 3e4, 7e4]])
        strain = 3e-4 * np.random.default_rng(1).standard_normal((2, 3, 6))
        state = self.law.initial_state(pressure=pressures, void_ratio=0.85)
        self.assertEqual(state.shape, (2, 3))
        self.assertEqual(state["frictional_stress"].shape, (2, 3, 6))
        together = self.law.update(state, strain, 0.1, tangent=True)
        self.assertEqual(together.tangent.shape, (2, 3, 6, 6))
        for i in np.ndindex(2, 3):
            one = self.law.initial_state(pressure=pressures[i], void_ratio=0.85)
            step = self.law.update(one, strain[i], 0.1, tangent=True)
            np.testing.assert_array_equal(one.values, state.values[i])
            for here, all_of_them in zip(step, together):
                np.testing.assert_array_equal(here, all_of_them[i])

    def test_have_named_states_that_are_views(self):
        state = self.law.initial_state(pressure="1 kPa", void_ratio=[0.85, 0.87])
        self.assertEqual(list(state), ["frictional_stress", "x", "kappa", "skeleton_void_ratio", "collisional_stress"])
        self.assertEqual(state.units["frictional_stress"], "Pa")
        np.testing.assert_allclose(state["frictional_stress"][0], [-1e3, -1e3, -1e3, 0, 0, 0], rtol=1e-12)
        state["kappa"][1] = 0.25
        self.assertEqual(state.values[1, 7], 0.25)
        before = state.copy()
        self.law.update(state, np.array([0, -1e-4, 0, 0, 0, 0.0]), 1)
        self.assertFalse((before.values == state.values).all())
        again = self.law.state(before.values)
        self.law.update(again, np.array([0, -1e-4, 0, 0, 0, 0.0]), 1)
        np.testing.assert_array_equal(again.values, state.values)

    def test_turn_with_the_material(self):
        state = self.law.initial_state(stress=[-2e3, -1.5e3, -1.5e3, 0, 0, 0], void_ratio=0.85)
        self.law.rotate(state, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
        np.testing.assert_allclose(self.law.stress(state), [-1.5e3, -2e3, -1.5e3, 0, 0, 0], atol=1e-9)

    def test_tangent_predicts_a_neighbouring_step(self):
        state = self.law.initial_state(pressure=1e5, void_ratio=0.85)
        strain, change = np.array([1e-4, -2e-4, 1e-4, 1e-4, 0, 0]), 1e-8 * np.array([1, -0.5, 0.2, 0.3, -0.4, 0.1])
        step = self.law.update(state.copy(), strain, 1, tangent=True)
        ahead, behind = (self.law.update(state.copy(), strain + sign * change, 1).stress for sign in (1, -1))
        engineering = change * [1, 1, 1, 2, 2, 2]
        np.testing.assert_allclose((ahead - behind) / 2, step.tangent @ engineering, rtol=1e-4, atol=1e-6)

    def test_refuse_what_is_wrong(self):
        with self.assertRaisesRegex(talus.InputError, "pressure = \"100\" "):
            self.law.initial_state(pressure="100", void_ratio=0.85)
        with self.assertRaisesRegex(talus.InputError, "void_ratio = 5 is out of range"):
            self.law.initial_state(pressure=1e3, void_ratio=5)
        with self.assertRaisesRegex(talus.InputError, "point 1: void_ratio"):
            self.law.initial_state(pressure=1e3, void_ratio=[0.85, 5])
        with self.assertRaisesRegex(talus.InputError, "the initial state is impossible"):
            self.law.initial_state(stress=[-1e3, -1e5, -1e3, 0, 0, 0], void_ratio=0.85)
        state = self.law.initial_state(pressure=1e3, void_ratio=0.85)
        for wrong, why in [(dict(strain=[1e-3] * 5, dt=1), "shape"), (dict(strain=[np.nan] * 6, dt=1), "not finite"),
                           (dict(strain=[0] * 6, dt=-1), "dt = -1"), (dict(strain=[0] * 6, dt=1, integrator="euler"), "return_mapping"),
                           (dict(strain=[0] * 6, dt=1, tolerance=1), "tolerance"), (dict(strain=np.zeros((2, 6)), dt=1), "does not fit")]:
            with self.assertRaisesRegex(talus.InputError, why):
                self.law.update(state, **wrong)
        with self.assertRaisesRegex(talus.InputError, "another law"):
            talus.Law("mohr_coulomb", E="1 MPa", nu=0.3, c="0 Pa", phi="30 deg", psi="0 deg").update(state, [0] * 6, 1)

    def test_let_other_threads_run(self):
        state = self.law.initial_state(pressure=np.full(1000, 1e5), void_ratio=0.85)
        done = threading.Event()

        def work():
            self.law.update(state, [0, -1e-3, 0, 1e-3, 0, 0], 1)
            done.set()

        thread = threading.Thread(target=work)
        thread.start()
        ticks = 0
        while not done.is_set():
            ticks += 1
            time.sleep(1e-4)
        thread.join()
        self.assertGreater(ticks, 5)


if __name__ == "__main__":
    unittest.main()
