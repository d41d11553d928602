#!/usr/bin/env python3
"""Half axes and middle of the cap of validation/similarity_solution, beside the closed form.

    scripts/measure_cap.py OUT [OUT ...]

OUT: a folder of results. The middle is that of the mass, along the slope, from where it began; the half axes are those of the
parabolic cap with the same second moments of mass about the middle, sqrt(6 <x^2>). K is the pressure along the slope over that
across it, and tau the shear stress over it, both of the material within 40 m of the middle. Needs h5py.
"""
import csv
import glob
import math
import pathlib
import sys

import h5py
import numpy as np

SLOPE, TOP = math.radians(35), 500.0  # of the plane: z = TOP - tan(SLOPE) x
DOWN = np.array([math.cos(SLOPE), 0, -math.sin(SLOPE)])
UP = np.array([math.sin(SLOPE), 0, math.cos(SLOPE)])


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    file = pathlib.Path(__file__).parent.parent / "validation" / "similarity_solution" / "similarity.csv"
    form = {float(r["t"]): r for r in csv.DictReader(line for line in file.open() if not line.startswith("#"))}
    for folder in sys.argv[1:]:
        print(folder)
        begin = None
        for n, name in enumerate(sorted(glob.glob(folder + "/particles_*.hdf"))):
            data = h5py.File(name)["VTKHDF"]
            points, mass = data["Points"][:] - [0, 0, TOP], data["PointData/mass"][:]
            stress, velocity = data["PointData/stress"][:], data["PointData/velocity"][:]
            mean = lambda q: (mass * q).sum() / mass.sum()
            along, across, above = points @ DOWN, points[:, 1], points @ UP
            x, y = along - mean(along), across - mean(across)
            begin = mean(along) if begin is None else begin
            t = float(n)
            core = (abs(x) < 40) & (abs(y) < 40)
            tensor = np.array([[stress[:, 0], stress[:, 3], stress[:, 5]], [stress[:, 3], stress[:, 1], stress[:, 4]],
                               [stress[:, 5], stress[:, 4], stress[:, 2]]])
            share = lambda a, b: (mass * np.einsum("i,ijk,j->k", a, tensor, b))[core].sum()
            middle = (abs(x) < 15) & (abs(y) < 15)
            low, high = middle & (above < np.quantile(above[middle], 0.25)), middle & (above > np.quantile(above[middle], 0.75))
            speed = velocity @ DOWN
            if t not in form:
                continue
            f = {k: float(v) for k, v in form[t].items()}
            a, b, way = math.sqrt(6 * mean(x**2)), math.sqrt(6 * mean(y**2)), mean(along) - begin
            p = share(UP, UP)
            print(f"  {t:2.0f} s: middle {way:6.2f} ({way / f['middle'] - 1:+.3f})  half length {a:6.2f} ({a / f['half_length'] - 1:+.3f})"
                  f"  half width {b:6.2f} ({b / f['half_width'] - 1:+.3f})  K {share(DOWN, DOWN) / p:.2f} along"
                  f" {share(np.array([0, 1, 0]), np.array([0, 1, 0])) / p:.2f} across  tau {-share(DOWN, UP) / p:.3f}"
                  f"  speed low {speed[low].mean():.2f} high {speed[high].mean():.2f}")


main()
