#!/usr/bin/env python3
"""Validates the interfaces for other programs: installs talus, builds programs against the installation, and compares element tests
through each interface with `talus element`. Writes a report.

    interfaces.py BUILD [--report FILE.md]      BUILD: a build folder, complete
"""

import csv
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
LIMIT = 1e-10  # of the difference of stresses over the largest stress of a path

SAND = {"E0": "150", "nu": "0.2", "n": "0.5", "phi_c": "18.9 deg", "e_ref": "0.877", "Lambda": "0.0596", "xi": "0.365", "A_d": "0.7",
        "k_p": "0.0044", "n_p": "2.4", "n_d": "2.9"}
GRAINS = {"I_0": "0.28", "rho_s": "2500 kg/m3", "d": "1 mm", "mu_s": "0.38", "mu_d": "0.66", "Phi_c": "0.70", "dPhi": "0.29"}
RATE = {"zeta": "0.8", "reach": "0.15", "Phi_w": "0.02", "E_g": "1 GPa"}
BASELINE = {"E": "20 MPa", "nu": "0.3", "c": "5 kPa", "phi": "30 deg", "psi": "5 deg"}

# Strains per segment, compression-positive (xx yy zz xy yz zx).
TRIAXIAL = [-0.5, 1, -0.5, 0, 0, 0]
SHEAR = [0, 0, 0, 1, 0, 0]
OEDOMETER = [0, 1, 0, 0, 0, 0]
OPENING = [-1, -1, -1, 0.5, 0, 0]

TESTS = [
    # title, law, settings, pressure [Pa], void ratio, integrator, [(direction, strain, duration, rows)]
    ("oedometer, loading and unloading", "linear_elastic", {"E": "10 MPa", "nu": "0.25"}, 1e5, 0, "forward_euler",
     [(OEDOMETER, 0.01, 1, 10), (OEDOMETER, -0.02, 1, 10), (SHEAR, 0.01, 1, 10)]),
    ("undrained triaxial compression", "mohr_coulomb", BASELINE, 1e5, 0, "forward_euler", [(TRIAXIAL, 0.02, 1, 20), (TRIAXIAL, -0.03, 1, 20)]),
    ("undrained triaxial compression and shear", "drucker_prager", BASELINE, 1e5, 0, "forward_euler",
     [(TRIAXIAL, 0.02, 1, 20), (SHEAR, 0.02, 1, 20)]),
    ("shear at 1/s", "local_mu_i", {"E": "1 MPa", "nu": "0.3", "rho_s": "2500 kg/m3", "d": "1 mm", "I_0": "0.3", "mu_s": "0.4", "mu_d": "0.7"},
     1e3, 0, "forward_euler", [(SHEAR, 0.1, 0.1, 40)]),
    ("compression, shear at 10/s and opening", "newtonian_fluid", {"K": "1 MPa", "eta": "1 Pa s"}, 1e3, 0, "forward_euler",
     [(SHEAR, 0.1, 0.01, 10), (OPENING, 0.01, 1, 10)]),
    ("undrained triaxial compression of loose sand", "simsand", SAND, 1e5, 0.88, "modified_euler", [(TRIAXIAL, 0.05, 1, 50)]),
    ("undrained cyclic simple shear of dense sand", "simsand", SAND, 1e5, 0.70, "modified_euler",
     [(SHEAR, 0.01, 1, 20), (SHEAR, -0.02, 1, 40), (SHEAR, 0.02, 1, 40)]),
    ("oedometer of dense sand, explicit", "simsand", SAND, 5e4, 0.70, "forward_euler", [(OEDOMETER, 0.005, 1, 50)]),
    ("simple shear at 0.1/s, then opening and closing", "granular", SAND | GRAINS, 1e4, 0.80, "modified_euler",
     [(SHEAR, 0.05, 0.5, 50), (OPENING, 0.005, 0.05, 20), (OPENING, -0.006, 0.05, 20)]),
    ("simple shear at 50/s", "granular", SAND | GRAINS, 1e3, 0.85, "modified_euler", [(SHEAR, 0.5, 0.01, 50)]),
    ("simple shear at 10/s, then opening", "granular_rate", SAND | GRAINS | RATE, 1e3, 0.85, "modified_euler",
     [(SHEAR, 0.2, 0.02, 40), (OPENING, 0.02, 0.02, 20)]),
    ("simple shear at 100/s, then oedometer", "mu_i", GRAINS, 0, 0.80, "forward_euler", [(SHEAR, 0.5, 0.005, 20), (OEDOMETER, 0.01, 0.001, 10)]),
]
INTEGRATORS = ["modified_euler", "return_mapping", "forward_euler"]


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], text=True, capture_output=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nfailed ({done.returncode}):\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


def case_text(test):
    title, law, settings, pressure, void_ratio, integrator, segments = test
    lines = [f'title = "{title}"', "[material]", f'law = "{law}"']
    lines += [f"{k} = {v}" if re.fullmatch(r"[0-9.e-]+", v) else f'{k} = "{v}"' for k, v in settings.items()]
    lines += ["[initial]", 'background_pressure = "500 Pa"' if law == "mu_i" else f'pressure = "{pressure} Pa"']
    if void_ratio:
        lines.append(f"void_ratio = {void_ratio}")
    lines += ["[driver]", f'integrator = "{integrator}"']
    for direction, strain, duration, rows in segments:
        lines += ["[[segment]]", f'duration = "{duration} s"', f"rows = {rows}"]
        lines += [f'{c} = {{ strain_rate = "{d * strain / duration!r} 1/s" }}' for c, d in zip("xx yy zz xy yz zx".split(), direction) if d]
    return "\n".join(lines) + "\n"


def steps_of(test):
    """The updates of the element driver: dt, strain increment and strain rate, tension-positive."""
    steps, total = [], [0.0] * 6
    for direction, strain, duration, rows in test[6]:
        rate = [d * strain / duration for d in direction]
        start, before = list(total), 0.0
        for row in range(1, rows + 1):
            t = duration if row == rows else duration * row / rows
            increment = [(start[i] + rate[i] * t) - total[i] for i in range(6)]
            total = [total[i] + increment[i] for i in range(6)]
            steps.append((t - before, [0.0 - x for x in increment], [0.0 - x for x in rate]))
            before = t
    return steps


def constants_of(test, laws, stress_unit):
    """The constants of a user material, from the law's table in `talus list`, as docs/howto/use_the_law.md describes them."""
    title, law, settings, pressure, void_ratio, integrator, segments = test
    si = {"deg": math.pi / 180, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "mm": 1e-3}
    parameters = []
    for key in laws[law]["parameters"]:
        number, _, unit = settings[key].partition(" ")
        parameters.append(float(number) * si.get(unit, 1))
    return [laws[law]["number"], stress_unit, INTEGRATORS.index(integrator), 0, void_ratio, 500 if law == "mu_i" else 0,
            *parameters, *[0] * laws[law]["options"]]


def read_laws(program):
    numbers = dict(re.findall(r'\{"(\w+)", (\d+)\}', (HERE / "../../src/talus/law/constants.hpp").read_text()))
    laws = {}
    for block in re.split(r"\n  (?=\w+: )", run(program, "list")):
        name = block.split(":")[0].strip()
        if name not in numbers:
            continue
        rows = [line.split() for line in block.split("\n")[1:] if re.match(r"    \w+ ", line)]
        laws[name] = {"number": int(numbers[name]), "parameters": [r[0] for r in rows if "|" not in r],
                      "options": sum("|" in r for r in rows)}
    return laws


def numbers(values):
    return " ".join(repr(float(v)) for v in values)


def rows_of(text):
    return [[float(x) for x in line.split()] for line in text.splitlines()]


def check_umat(folder, environment):
    """What element tests do not show of UMAT: rotation, steps without time, wrong constants."""
    path, still, identity = folder / "path", [0] * 6, [1, 0, 0, 0, 1, 0, 0, 0, 1]

    def umat(constants, start, steps):
        path.write_text("\n".join([f"{len(constants)} {numbers(constants)}", numbers([*start, 0]), str(len(steps)),
                                   *[numbers(step) for step in steps]]) + "\n")
        return subprocess.run([folder / "drive", "umat", "6", path], text=True, capture_output=True, env=environment)

    elastic = [8, 1, 0, 0, 0, 0, 1e7, 0.25, 0]
    quarter_turn = [0, -1, 0, 1, 0, 0, 0, 0, 1]  # about z
    turned = rows_of(umat(elastic, [-100, 0, 0, 0, 0, 0], [[1, *still, *identity], [1, *still, *quarter_turn]]).stdout)
    if [round(x, 9) for x in turned[1][:6]] != [0, -100, 0, 0, 0, 0]:
        sys.exit(f"DROT does not rotate the state: {turned[1]}")
    fluid, shear = [9, 1, 0, 0, 0, 0, 1e6, 0.5], [0, 0, 0, 1e-3, 0, 0]
    stresses = rows_of(umat(fluid, [-100, -100, -100, 0, 0, 0], [[0, *shear, *identity], [0.1, *shear, *identity]]).stdout)
    if abs(stresses[0][3]) > 1e-12 or abs(stresses[1][3] - 0.5 * 1e-3 / 0.1) > 1e-12:  # eta times the engineering shear rate
        sys.exit(f"without time the stress must be that at rest: {stresses}")
    wrong = umat([8, 1, 0, 0, 0, 0, -1e7, 0.25, 0], still, [[1, *still, *identity]])
    if wrong.returncode != 4 or "PROPS(7) E = -1e+07 is out of range" not in wrong.stderr:
        sys.exit(f"wrong constants must reduce PNEWDT and be printed: {wrong.returncode} {wrong.stderr}")


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    report_file = pathlib.Path(sys.argv[sys.argv.index("--report") + 1]) if "--report" in sys.argv else build / "interfaces.md"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        root = folder / "root"
        run("cmake", "--install", build, "--prefix", root)
        program, library = root / "bin/talus", next(root.glob("lib*/**/libtalus_law.so")).parent
        clean = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
        run(program, "--version", env=clean)
        exported = run("nm", "-D", "--defined-only", "--format=posix", library / "libtalus_law.so").split("\n")
        exported = {line.split()[0].split("@")[0] for line in exported if line} - {"TALUS_LAW_1"}
        declared = set(re.findall(r"\b(talus_\w+)\(", (root / "include/talus/law.h").read_text()))
        if exported != declared:
            sys.exit(f"libtalus_law.so exports other symbols than talus/law.h declares: {sorted(exported ^ declared)}")
        run("cmake", "-S", HERE / "consumer", "-B", folder / "consumer", f"-DCMAKE_PREFIX_PATH={root}", "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", folder / "consumer")
        run(folder / "consumer/path_in_cpp", env=clean)
        run("gfortran", "-O1", "-ffree-line-length-none", "-Wall", "-Wno-unused-dummy-argument", HERE / "drive.f90", "-o", folder / "drive", library / "libtalus_umat.so",
            f"-Wl,-rpath,{library}", cwd=folder)
        laws = read_laws(program)
        check_umat(folder, clean)

        lines, worst = [], 0.0
        for number, test in enumerate(TESTS):
            title, law, settings, pressure, void_ratio, integrator, segments = test
            case = folder / f"{number}.toml"
            case.write_text(case_text(test))
            table = list(csv.reader(run(program, "element", case, env=clean).splitlines()))
            first = [i for i, name in enumerate(table[0]) if name.startswith("stress_xx")][0]
            texts = [row[first:first + 6] for row in table[2:]]  # without the start
            expected = [[0.0 - float(x) for x in row] for row in texts]
            scale = max(abs(x) for row in expected for x in row)
            steps = steps_of(test)
            background = 500 if law == "mu_i" else 0

            path = folder / "path"
            path.write_text("\n".join(
                [law, str(len(settings)), *[f"{k} {v}" for k, v in settings.items()], numbers([-pressure] * 3 + [0] * 3 + [void_ratio, background]),
                 str(len(steps)), *[numbers([dt, *de, *rate]) for dt, de, rate in steps]]) + "\n")
            results = {}
            results["C"] = rows_of(run(folder / "consumer/path_in_c", path, integrator, env=clean))
            same = [[f"{0.0 - x + 0.0:.10g}" for x in row] for row in results["C"]]
            digits = same == [[f"{float(x):.10g}" for x in row] for row in texts]

            def host(interface, ntens, stress_unit):
                constants = constants_of(test, laws, stress_unit)
                path.write_text("\n".join(
                    [f"{len(constants)} {numbers(constants)}", numbers([-pressure / stress_unit] * 3 + [0] * 3 + [0]), str(len(steps)),
                     *[numbers([dt, *de[:3], *[2 * x for x in de[3:]], 1, 0, 0, 0, 1, 0, 0, 0, 1]) for dt, de, rate in steps]]) + "\n")
                return rows_of(run(folder / "drive", interface, ntens, path, env=clean))

            umat = host("umat", 6, 1)
            results["UMAT, 6 components, Pa"] = [row[:6] for row in umat]
            in_plane = all(not d for direction, *_ in segments for d in direction[4:])
            if in_plane:
                results["UMAT, 4 components, kPa"] = [[1000 * x for x in row[:6]] for row in host("umat", 4, 1000)]
            results["User_Mod, kPa"] = [[1000 * x for x in row] for row in host("user_mod", 6, 1000)]
            results["ESM, kPa"] = [[1000 * x for x in row] for row in host("esm", 6, 1000)]
            errors = {}
            for name, rows in results.items():
                if len(rows) != len(expected):
                    sys.exit(f"{title}: {name} has {len(rows)} rows instead of {len(expected)}")
                errors[name] = max(abs(a - b) for r, e in zip(rows, results["C"]) for a, b in zip(r, e)) / scale
            tangent = sorted(row[6] for row in umat)
            worst = max(worst, *errors.values())
            lines.append(f"| `{law}` | {title} | {len(steps)} | {'all' if digits else 'not all'} | "
                         f"{max(e for n, e in errors.items() if n.startswith('UMAT')):.1e} | {errors['User_Mod, kPa']:.1e} | "
                         f"{errors['ESM, kPa']:.1e} | {tangent[len(tangent) // 2]:.1e}, {tangent[-1]:.1e} |")
            if not digits:
                worst = max(worst, 1)
            print(lines[-1], flush=True)
        verdict = worst <= LIMIT
        report_file.write_text(
            "# Interfaces for other programs, compared with `talus element`\n\n"
            "Strain paths through each interface of an installation. C: whether the ten digits that `talus element` prints are those of the C interface, "
            "for all stresses. UMAT (6 and 4 components), User_Mod, ESM: largest difference from the stresses of the C interface in full precision, over "
            "the largest stress; the limit is 1e-10. DDSDDE: error of the stress change that it predicts for a step longer by a thousandth, over its "
            "largest entry times the change of strain; median and largest of the steps.\n\n"
            "| law | test | steps | digits equal in C | UMAT | User_Mod | ESM | DDSDDE |\n|---|---|---|---|---|---|---|---|\n" + "\n".join(lines) +
            f"\n\n{'All agree.' if verdict else 'DISAGREEMENT.'}\n")
        print(f"{report_file}: {'all agree' if verdict else 'disagreement'}, {worst:.1e}")
        sys.exit(0 if verdict else 1)


main()
