#!/usr/bin/env python3
"""Prints the polynomials of src/talus/math/elementary.hpp.

Remez exchange in 60-digit arithmetic, with Python's standard library alone. For each polynomial P it minimises the
largest |w (f - P)| over an interval: f is what the header wants of the polynomial, w makes that the relative error of
the result. Coefficients come highest power first, as the header has them, with their distance from it in units in the
last place.
"""

import math
import pathlib
import re
from decimal import Decimal as D, getcontext

getcontext().prec = 60

N_GRID = 2000  # intervals in which extrema are looked for


def solve(rows):
    """Gaussian elimination of a system whose last column is the right-hand side."""
    n = len(rows)
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(i + 1, n):
            factor = rows[k][i] / rows[i][i]
            rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i])]
    x = [D(0)] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][k] * x[k] for k in range(i + 1, n))) / rows[i][i]
    return x


def polynomial(coefficients, x):
    value = D(0)
    for c in reversed(coefficients):
        value = value * x + c
    return value


def remez(f, w, low, high, degree):
    """Coefficients, lowest power first, and the largest weighted error."""
    grid = [low + (high - low) * i / N_GRID for i in range(N_GRID + 1)]
    f_at, w_at = [f(x) for x in grid], [w(x) for x in grid]
    n = degree + 2
    # Chebyshev's extrema, on the grid.
    points = [round((1 - math.cos(math.pi * i / (n - 1))) / 2 * N_GRID) for i in range(n)]
    while True:
        rows = []
        for k, i in enumerate(points):
            powers = [D(1)]
            for _ in range(degree):
                powers.append(powers[-1] * grid[i])
            rows.append(powers + [(-1) ** k / w_at[i], f_at[i]])
        coefficients = solve(rows)[: degree + 1]
        error = [weight * (value - polynomial(coefficients, x)) for x, value, weight in zip(grid, f_at, w_at)]
        # The largest error between each two changes of its sign.
        extrema = [0]
        for i in range(1, N_GRID + 1):
            if (error[i] > 0) != (error[extrema[-1]] > 0):
                extrema.append(i)
            elif abs(error[i]) > abs(error[extrema[-1]]):
                extrema[-1] = i
        while len(extrema) > n:
            extrema.pop(0 if abs(error[extrema[0]]) < abs(error[extrema[-1]]) else -1)
        if extrema == points or len(extrema) < n:
            return coefficients, max(map(abs, error))
        points = extrema


def atanh(s):
    return ((1 + s) / (1 - s)).ln() / 2


def for_exp():
    """(e^r - 1 - r)/r^2 on |r| <= ln(2)/2 and a little more."""
    end = D(2).ln() / 2 * D("1.0005")
    return remez(
        lambda r: (r.exp() - 1 - r) / (r * r) if abs(r) > D("1e-15") else D("0.5") + r / 6,
        lambda r: (r * r + D("1e-6")) / r.exp(),
        -end, end, 9,
    )


def for_log():
    """(2 atanh(s)/s - 2)/s^2 as a polynomial in z = s^2, on |s| <= (sqrt 2 - 1)/(sqrt 2 + 1) and a little more."""
    root = D(2).sqrt()
    end = ((root - 1) / (root + 1)) ** 2 * D("1.001")
    return remez(
        lambda z: (2 * atanh(z.sqrt()) / z.sqrt() - 2) / z if z > D("1e-12") else D(2) / 3 + 2 * z / 5,
        lambda z: z + D("1e-8"),
        D(0), end, 6,
    )


def constants():
    """log2 e, and ln 2 in two parts of which the first ends in zeros."""
    ln2 = D(2).ln()
    high = D(int(ln2 * 2**32)) / 2**32
    return {"log2_e": 1 / ln2, "ln2_high": high, "ln2_low": ln2 - high}


def ulps(a, b):
    return (a - b) / math.ulp(b)


def main():
    header = (pathlib.Path(__file__).parent / "../src/talus/math/elementary.hpp").read_text()
    for name, make in (("exp", for_exp), ("log", for_log)):
        body = header[header.index(f"TALUS_HD R {name}(") :]
        body = body[: body.index("\n}")]
        there = re.findall(r"(?:R poly = |multiply_add\(poly, [rz], )R\(([-+.\de]+)\)", body)
        coefficients, error = make()
        print(f"{name}: {make.__doc__}\nlargest weighted error {error:.3e}")
        if len(there) != len(coefficients):
            print(f"  the header has {len(there)} coefficients")
        for c, in_header in zip(reversed(coefficients), there):
            print(f"  {float(c)!r:25} {ulps(float(c), float(in_header)):+.0f} ulp")
    for name, value in constants().items():
        in_header = re.search(rf"\b{name} = ([-+.\de]+)", header)[1]
        print(f"{name} = {float(value)!r} {ulps(float(value), float(in_header)):+.0f} ulp")


if __name__ == "__main__":
    main()
