"""`python3 -m talus ...` is the program `talus`."""

import os
import signal
import sys

from ._load import solver

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # the program has its own handlers
    if os.environ.pop("TALUS_ENDS_WITH_PARENT", ""):  # a run of talus.run stops with a checkpoint if Python is killed
        import ctypes

        pr_set_pdeathsig = 1
        ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)
    sys.exit(solver().program(["talus", *sys.argv[1:]]))
