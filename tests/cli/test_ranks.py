#!/usr/bin/env python3
"""Test runs on several ranks from outside: what goes wrong ends soon, is said once, and leaves a checkpoint that serves.

usage: test_ranks.py PROGRAM MPIEXEC [GROUP] [unittest options]
"""

import sys
import unittest

from ranks_alike import Alone, Shares  # noqa: F401
from ranks_case import Ranks, take_launcher
from ranks_ends import Breaks, Stops  # noqa: F401
from ranks_restarts import Restarts  # noqa: F401
from ranks_said import Log, Once, Refusals  # noqa: F401
from ranks_verdicts import Verdicts  # noqa: F401

if __name__ == "__main__":
    take_launcher()
    if not Ranks.launcher:
        print("skipped: the program has no MPI, or there is no mpiexec\n0 passed, 0 failed")
        sys.exit(0)
    unittest.main()
