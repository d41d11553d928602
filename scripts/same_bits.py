#!/usr/bin/env python3
"""Compares two builds of talus bit by bit: history.csv and the last checkpoint of short runs of every case.

    scripts/same_bits.py OLD_TALUS NEW_TALUS [--seconds S] [--threads 1 2 3 7] [CASE...]

Without cases: all of cases/ and validation/. Each case runs for as much simulated time as OLD needs about S seconds for,
with one thread; then NEW runs as far with each number of threads. Exit code 1 if anything differs.
"""
import argparse
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

import h5py


def arrays(file):
    """The arrays of a checkpoint, as bytes."""
    with h5py.File(file) as checkpoint:
        return {name: array[()].tobytes() for name, array in checkpoint["state"].items()}


def run(talus, case, out, until, threads):
    start = time.time()
    done = subprocess.run([talus, "run", str(case), "--out", str(out), "--until", f"{until} s", "--threads", str(threads)],
                          capture_output=True, text=True)
    if done.returncode != 0:
        return None, time.time() - start, done.stderr.strip().splitlines()[-1:]
    # Two checkpoints are kept: the one at the start and the last, or the last two.
    states = [arrays(f) for f in sorted(out.glob("checkpoint_*.h5"))]
    last = max(states, key=lambda s: struct.unpack_from("<d", s["ledger"])[0])
    return {"history.csv": (out / "history.csv").read_bytes(), **last}, time.time() - start, []


def end_of(case):
    for line in case.read_text().splitlines():
        if line.strip().startswith("end"):
            number, unit = line.split('"')[1].split()
            return float(number) * {"s": 1, "ms": 1e-3, "us": 1e-6}[unit]
    raise SystemExit(f"{case}: no end")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("cases", nargs="*", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=3)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2, 3, 7])
    args = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parent.parent
    cases = args.cases or sorted(root.glob("cases/*.toml")) + sorted(
        f for f in root.glob("validation/*/*.toml") if f.name != "figure.toml" and "[domain]" in f.read_text())
    differing = 0
    for case in cases:
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            until, old, said = end_of(case) / 1000, None, []
            for attempt in range(8):
                old, taken, said = run(args.old, case, folder / f"old{attempt}", until, 1)
                if old is None or taken > 0.5 * args.seconds or until >= end_of(case):
                    break
                until = min(end_of(case), until * min(10, max(1.5, args.seconds / max(taken, 0.1))))
            name = str(case.relative_to(root)) if case.is_relative_to(root) else str(case)
            if old is None:
                print(f"{name}: the old build stops: {' '.join(said)}")
                continue
            steps = struct.unpack_from("<q", old["ledger"], 8)[0]
            for threads in args.threads:
                new, _, said = run(args.new, case, folder / f"new{threads}", until, threads)
                unlike = ["it stops: " + " ".join(said)] if new is None else sorted(
                    k for k in old.keys() | new.keys() if old.get(k) != new.get(k))
                differing += bool(unlike)
                print(f"{name}: {steps} steps, {threads} threads: {'same bits' if not unlike else 'differs in ' + ', '.join(unlike[:6])}",
                      flush=True)
    sys.exit(differing > 0)


main()
