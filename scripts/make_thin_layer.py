#!/usr/bin/env python3
"""Writes closed forms of thin layers for validation/coulomb_dam_break and validation/similarity_solution.

    scripts/make_thin_layer.py FOLDER

Thin layers slide on planes with Coulomb friction mu = tan delta, as plugs, under hydrostatic pressure; pressure along the slope is K
times that across it. Gravity 9.81 m/s2.

FOLDER/coulomb_dam_break/thin_layer.csv: a reservoir, H thick, x < 0, without end; Mangeney, Heinrich and Roche 2000, with K. With
m = g (sin b - mu cos b), c = sqrt(K g cos b H): h = H for x < m t^2/2 - c t, (2 c - x/t + m t/2)^2/(9 K g cos b) up to m t^2/2 + 2 c t.
FOLDER/coulomb_dam_break/front.csv: where it is 0.2 H thick.
FOLDER/similarity_solution/similarity.csv: half axes of a parabolic cap that starts from rest on a circle; Savage and Hutter 1989,
Hutter et al. 1993; K = 1.
"""
import math
import pathlib
import sys

G = 9.81


def dam(folder):
    b, mu, deep = math.radians(22), math.tan(math.radians(21)), 1.0
    m = G * (math.sin(b) - mu * math.cos(b))
    phi = math.cos(math.radians(35))**2  # Savage and Hutter's active K for a base of 21 degrees and 35 degrees inside
    active = 2 * (1 - math.sqrt(1 - phi * (1 + mu * mu))) / phi - 1
    about = "# Closed form (scripts/make_thin_layer.py): Mangeney, Heinrich and Roche 2000, K of Savage and Hutter 1989; t in s, x and h in m."
    profiles, fronts = [about, "curve,x,h"], [about, "curve,t,x"]
    for name, k in (("K_1", 1.0), ("K_active", active)):
        gk = k * G * math.cos(b)
        c = math.sqrt(gk * deep)
        for t in (2, 5, 10):
            head, tip = m * t * t / 2 - c * t, m * t * t / 2 + 2 * c * t
            for i in range(-6, 61):
                x = head + (tip - head) * i / 60
                h = deep if x < head else (2 * c - x / t + m * t / 2)**2 / (9 * gk)
                profiles.append(f"{name}_{t},{x:.3f},{h:.5f}")
        for i in range(4, 41):
            t = i / 4
            fronts.append(f"{name},{t},{m * t * t / 2 + c * t * (2 - 3 * math.sqrt(0.2)):.4f}")
    (folder / "thin_layer.csv").write_text("\n".join(profiles) + "\n")
    (folder / "front.csv").write_text("\n".join(fronts) + "\n")


def cap(folder):
    """Half axes, thickness and middle of a cap with K = 1: a'' = 2 g cos b h/a in the frame that slides with m t^2/2.

    Across, b'' = 2 g cos b h/b less friction, which acts against the direction of sliding: the share of the cross velocity in it is
    b'/(m t), so b'' = 2 g cos b h/b - mu g cos b b'/(m t). h a b is constant.
    """
    slope, mu, deep, radius = math.radians(35), math.tan(math.radians(25)), 4.0, 80.0
    gz = G * math.cos(slope)
    m = G * math.sin(slope) - mu * gz

    def rates(t, y):
        a, da, b, db = y
        h = deep * radius**2 / (a * b)
        return [da, 2 * gz * h / a, db, 2 * gz * h / b - (mu * gz * db / (m * t) if t > 0 else 0)]

    t, dt = 1e-3, 1e-3
    b0 = 2 * gz * deep / radius / (1 + mu * gz / m)  # b'' at the start, where b'/t is b''
    y = [radius, 2 * gz * deep / radius * t, radius, b0 * t]
    rows = ["# Closed form (scripts/make_thin_layer.py): Savage and Hutter 1989, Hutter et al. 1993, K = 1; t in s, lengths in m.",
            "t,half_length,half_width,thickness,middle,front"]
    for step in range(1, 10001):
        if step % 500 == 0:
            rows.append(f"{t:.3f},{y[0]:.3f},{y[2]:.3f},{deep * radius**2 / (y[0] * y[2]):.4f},{m * t * t / 2:.3f},{m * t * t / 2 + y[0]:.3f}")
        k1 = rates(t, y)
        k2 = rates(t + dt / 2, [v + dt / 2 * k for v, k in zip(y, k1)])
        k3 = rates(t + dt / 2, [v + dt / 2 * k for v, k in zip(y, k2)])
        k4 = rates(t + dt, [v + dt * k for v, k in zip(y, k3)])
        y = [v + dt / 6 * (p + 2 * q + 2 * r + s) for v, p, q, r, s in zip(y, k1, k2, k3, k4)]
        t += dt
    (folder / "similarity.csv").write_text("\n".join(rows) + "\n")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    dam(pathlib.Path(sys.argv[1]) / "coulomb_dam_break")
    cap(pathlib.Path(sys.argv[1]) / "similarity_solution")


main()
