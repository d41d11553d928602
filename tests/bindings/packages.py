#!/usr/bin/env python3
"""Builds the Debian packages of a complete build, unpacks them into an empty root, and runs talus from there.

    packages.py BUILD
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], text=True, capture_output=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nfailed ({done.returncode}):\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


build = pathlib.Path(sys.argv[1]).resolve()
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    run("cpack", "-G", "DEB", "--config", build / "CPackConfig.cmake", "-B", folder, cwd=folder)
    packages = {p.name.split("_")[0]: p for p in folder.glob("*.deb")}
    if not {"talus", "libtalus-dev"} <= set(packages):
        sys.exit(f"packages are missing: {sorted(packages)}")
    root = folder / "root"
    for package in packages.values():
        run("dpkg-deb", "-x", package, root)
    depends = run("dpkg-deb", "-f", packages["talus"], "Depends")
    for library in ["libc6", "libfmt", "libgdal", "libudunits2"]:
        if library not in depends:
            sys.exit(f"talus does not depend on {library}: {depends}")
    if "talus (= " not in run("dpkg-deb", "-f", packages["libtalus-dev"], "Depends"):
        sys.exit("libtalus-dev does not depend on talus of the same version")
    clean = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
    loaded = run("ldd", root / "usr/bin/talus", env=clean)
    for name in ["libtalus.so", "libtalus_kernels.so"]:
        if not re.search(rf"{name} => {root}/usr/", loaded):
            sys.exit(f"{name} is not loaded from the package:\n{loaded}")
    run(root / "usr/bin/talus", "--version", env=clean)
    case = next(root.glob("usr/share/doc/**/undrained_simple_shear.toml"))
    if len(run(root / "usr/bin/talus", "element", case, env=clean).splitlines()) < 200:
        sys.exit("the element test has too few rows")
    for name in ["usr/include/talus/law.h", "usr/lib/libtalus_umat.so", "usr/lib/libtalus_law.so", "usr/lib/cmake/talus/talusConfig.cmake"]:
        if not (root / name).exists():
            sys.exit(f"{name} is in no package")
    print("talus runs from the packages")
