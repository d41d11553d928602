#!/usr/bin/env python3
"""Sliding blocks on a terrain, and the speed that energy allows a run on it.

    scripts/energy_line.py DEM.asc RELEASE.asc MU [--xi XI] [--thickness H] [--cell H] [--maps OUT/maps]

A block, a point without size, starts at rest at the centre of the release, at its highest and at its lowest place, and slides on the ground with
the normal force N = (g + v.f''.v)/s per mass, s = sqrt(1 + f'^2), friction MU N, and with XI [m/s2] and the thickness H [m] of
Voellmy also g v^2/(XI H). Printed: where it stops, drop over distance in plan, its top speed. Where the ground has no curvature drop
over length in plan of its path is MU; a hollow presses and brakes it more. Heights are means over squares of CELL [m], as a run's.

With maps of a run: the largest speed of the map over what energy allows there, v^2 = 2 g (z0 - z - MU d), with the height and the
distance in plan to the place of the release that allows most; d is the shortest way there could be, so a block is never faster
where the ground does not throw it (Coulomb friction; Voellmy's is less still). A layer may exceed it by what its neighbours push.
"""
import argparse
import glob

import numpy as np

G = 9.81


def read(path):
    """Heights, lowest row first; places of the middles of the pixels; size of a pixel."""
    with open(path) as f:
        head = {}
        for line in f:
            words = line.split()
            if words[0][0].isalpha() and words[0].lower() != "nan":
                head[words[0].lower()] = float(words[1])
            else:
                break
        n = len(head)
    a = np.loadtxt(path, skiprows=n)[::-1].copy()
    a[a == head.get("nodata_value", -9999)] = np.nan
    a[a <= -9999] = np.nan
    h = head["cellsize"]
    x0 = head["xllcenter"] if "xllcenter" in head else head["xllcorner"] + h / 2
    y0 = head["yllcenter"] if "yllcenter" in head else head["yllcorner"] + h / 2
    return a, x0 + h * np.arange(a.shape[1]), y0 + h * np.arange(a.shape[0]), h


def smoothed(a, width):
    """Means over squares of `width` pixels, at least 3, so that there are second derivatives."""
    n = max(1, round(width) // 2)
    for axis in (0, 1):
        a = np.mean([np.roll(a, k, axis) for k in range(-n, n + 1)], axis=0)
    return a


def at(a, x, y, px, py, h):
    c, r = (px - x[0]) / h, (py - y[0]) / h
    j, i = int(c), int(r)
    c, r = c - j, r - i
    return ((1 - r) * ((1 - c) * a[i, j] + c * a[i, j + 1]) + r * ((1 - c) * a[i + 1, j] + c * a[i + 1, j + 1]))


def slide(z, x, y, h, start, mu, xi, thickness):
    zy, zx = np.gradient(z, h)
    zyy, zyx = np.gradient(zy, h)
    _, zxx = np.gradient(zx, h)
    p, v, dt = np.array(start, float), np.zeros(2), 0.02  # v: in plan
    path, speed, top, t = 0.0, 0.0, 0.0, 0.0
    here = z0 = at(z, x, y, *p, h)
    while t < 600 and x[2] < p[0] < x[-3] and y[2] < p[1] < y[-3]:
        g = np.array([at(zx, x, y, *p, h), at(zy, x, y, *p, h)])
        s = np.sqrt(1 + g @ g)
        curved = at(zxx, x, y, *p, h) * v[0]**2 + 2 * at(zyx, x, y, *p, h) * v[0] * v[1] + at(zyy, x, y, *p, h) * v[1]**2
        n = max(0.0, (G + curved) / s)
        v = v - dt * n * g / s  # turns it; how fast it is, energy says
        to = p + dt * v
        drop, plan = here - at(z, x, y, *to, h), dt * np.sqrt(v @ v)
        brake = mu * n + (G * speed**2 / (xi * thickness) if xi else 0)
        energy = speed**2 + 2 * G * drop - 2 * brake * np.hypot(plan, drop)
        if energy <= 0:
            break
        p, here, speed = to, here - drop, np.sqrt(energy)
        v *= speed / np.hypot(np.sqrt(v @ v), g @ v)
        path, top, t = path + plan, max(top, speed), t + dt
    drop, away = z0 - here, np.hypot(*(p - start))
    print(f"  from {start[0]:.0f} {start[1]:.0f} to {p[0]:.0f} {p[1]:.0f} in {t:.0f} s: drop {drop:.0f} m, distance {away:.0f} m, drop/distance"
          f" {drop / away:.3f}, drop/path {drop / path:.3f}, top speed {top:.1f} m/s")


def main():
    q = argparse.ArgumentParser()
    q.add_argument("dem"), q.add_argument("release"), q.add_argument("mu", type=float)
    q.add_argument("--xi", type=float), q.add_argument("--thickness", type=float, default=1.5)
    q.add_argument("--cell", type=float, default=15), q.add_argument("--maps")
    a = q.parse_args()
    z, x, y, h = read(a.dem)
    r, rx, ry, _ = read(a.release)
    rows, columns = np.nonzero(np.nan_to_num(r) > 0)
    weights = r[rows, columns]
    ground = smoothed(z, a.cell / h)
    heights = np.array([at(z, x, y, rx[c], ry[i], h) for i, c in zip(rows, columns)])
    top, low = np.argmax(heights), np.argmin(heights)
    print("a block")
    for start in ((np.average(rx[columns], weights=weights), np.average(ry[rows], weights=weights)), (rx[columns[top]], ry[rows[top]]),
                  (rx[columns[low]], ry[rows[low]])):
        slide(ground, x, y, h, start, a.mu, a.xi, a.thickness)
    if not a.maps:
        return
    speed, mx, my, _ = read(glob.glob(a.maps + "/*_pfv.*sc")[0])
    thick = read(glob.glob(a.maps + "/*_pft.*sc")[0])[0]
    edge = np.arange(len(rows))[::max(1, len(rows) // 400)]
    edge = np.unique(np.append(edge, top))
    i, j = np.nonzero(np.nan_to_num(speed) > 0)
    allowed = np.zeros(len(i))
    there = np.array([at(z, x, y, mx[c], my[b], h) for b, c in zip(i, j)])
    for k in edge:
        d = np.hypot(mx[j] - rx[columns[k]], my[i] - ry[rows[k]])
        allowed = np.maximum(allowed, heights[k] + 1.5 - there - a.mu * d)
    v, limit = speed[i, j], np.sqrt(2 * G * np.maximum(allowed, 0))
    fast = np.argmax(v)
    print(f"map: top speed {v[fast]:.1f} m/s at {mx[j[fast]]:.0f} {my[i[fast]]:.0f} where energy allows {limit[fast]:.1f}; it allows {limit.max():.1f} "
          f"anywhere; {np.mean(v > limit) * 100:.1f} % of the pixels that flow reached are faster than allowed, "
          f"{np.mean((v > limit) & (thick[i, j] > 0.5)) * 100:.1f} % where it was thicker than 0.5 m; by at most {np.max(v - limit):.1f} m/s "
          f"({np.max((v - limit)[limit > 20]):.1f} m/s where more than 20 m/s are allowed)")


main()
