#!/usr/bin/python3
"""Registers, spills and stack of each kernel on a device, read from the output of `nvcc -Xptxas -v`.

device_kernels.py LOG -- nvcc ARGUMENTS   compiles and writes the output to LOG; fails if nvcc fails or gives a warning
device_kernels.py LOG...                  prints the table

The target `device` of the build runs both (`./dev device`).
"""

import re
import subprocess
import sys
import time
from pathlib import Path

SOURCES = Path(__file__).parent.parent / "src"


def compile_kernels(log, command):
    start = time.monotonic()
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if run.returncode != 0 or re.search(r"\bwarning\b", run.stdout, re.IGNORECASE):
        sys.exit(run.stdout + "device_kernels.py: nvcc failed or gave a warning")
    log.write_text(run.stdout + f"compiled in {time.monotonic() - start:.0f} s\n")


def demangled(names):
    run = subprocess.run(["c++filt"], input="\n".join(names), stdout=subprocess.PIPE, text=True, check=True)
    return run.stdout.splitlines()


def enumerators():
    """The names of all enumerators, by the name of their enumeration."""
    text = "\n".join(file.read_text() for file in SOURCES.rglob("*.hpp"))
    found = {}
    for name, body in re.findall(r"enum class (\w+)[^{;]*\{([^}]*)\}", text):
        body = re.sub(r"//[^\n]*", "", body)
        found[name] = [word.split("=")[0].strip() for word in body.split(",")]
    return found


def short(kernel, names):
    """`update_law<Granular, return_mapping>` of `void talus::cuda::update_law<...>(...)`."""
    kernel = re.sub(r"\(talus::(\w+)\)(\d+)", lambda m: names[m[1]][int(m[2])], kernel)
    kernel = kernel[: kernel.index(">(") + 1] if ">(" in kernel else kernel.split("(")[0]
    return re.sub(r"^\S+ (?=\w)|\b\w+::", "", kernel).replace("> >", ">>")


def kernels(log):
    """Of each kernel: its name; registers; bytes of spill stores, spill loads and stack."""
    pattern = re.compile(
        r"Compiling entry function '(\w+)'.*?(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads"
        r".*?Used (\d+) registers(?:[^\n]*?(\d+) bytes cumulative stack size)?",
        re.DOTALL,
    )
    found = pattern.findall(log)
    names = enumerators()
    for name, (_, frame, stores, loads, registers, stack) in zip(demangled([f[0] for f in found]), found):
        yield short(name, names), (int(registers), int(stores), int(loads), int(stack or frame))


def merged(rows):
    """One row where the last template argument changes nothing."""
    groups = {}
    for name, numbers in rows:
        groups.setdefault(re.sub(r", \w+>$", ">", name), []).append((name, numbers))
    for name, group in groups.items():
        same = len(group) > 1 and len({numbers for _, numbers in group}) == 1
        yield from [(name, group[0][1])] if same else group


def print_table(rows):
    header = ("kernel", "registers", "spill stores [B]", "spill loads [B]", "stack [B]")
    width = max(len(row[0]) for row in rows)
    print(header[0].ljust(width), *header[1:], sep="  ")
    for name, numbers in rows:
        print(name.ljust(width), *(str(n).rjust(len(h)) for n, h in zip(numbers, header[1:])), sep="  ")


def main():
    arguments = sys.argv[1:]
    if "--" in arguments:
        log, _, *command = arguments
        compile_kernels(Path(log), command)
        return
    texts = {log: Path(log).read_text() for log in arguments}
    for log, text in texts.items():
        if not list(kernels(text)):
            sys.exit(f"{log} names no kernels")
    rows = sorted(row for text in texts.values() for row in kernels(text))
    print_table(list(merged(rows)))
    print(f"{len(rows)} kernels, " + " and ".join(text.splitlines()[-1] for text in texts.values()))


main()
