#!/usr/bin/env python3
"""Solve one contact problem by one solver of Siconos, once for each tolerance, in a process of its own, since it may crash.

usage: siconos_worker.py solve FILE SOLVER SECONDS     a JSON object a tolerance, each written at once
       siconos_worker.py error FILE ANSWER.npy         Siconos' own error of an answer
       siconos_worker.py list DIMENSION                names of the solvers

CPU seconds are those of the driver alone, short runs repeated. The process ends by SIGXCPU when one run
takes more than SECONDS, or all of them more than three times that.
"""

import contextlib
import json
import os
import resource
import sys
import time
import warnings
from dataclasses import asdict

import numpy as np
import siconos.numerics as sn
from contact_problem import errors, read_problem

TOLERANCES = (1e-3, 1e-6, 1e-8, 1e-10, 1e-13)
ENOUGH = 1e-9
MEASURED = 0.05
"""CPU seconds of repeated runs that give the time of one, where one is shorter (clocks count in steps of a millisecond)"""


def constant(name):
    return getattr(sn, f"SICONOS_FRICTION_{name}")


def choose(options, iterations, changes=None):
    """Options with another limit of iterations and some entries of iparam changed."""
    options.iparam[0] = iterations
    for place, value in (changes or {}).items():
        options.iparam[constant(place)] = constant(value) if isinstance(value, str) else value
    return options


def gauss_seidel_by_projections(options):
    sn.solver_options_update_internal(options, 0, constant("3D_ONECONTACT_ProjectionOnConeWithLocalIteration"))
    return choose(options, 100000)


# Name: (Siconos' name, how its options differ from the defaults)
SPACE = {
    "NSGS": ("NSGS", lambda o: choose(o, 100000)),
    "NSGS, projections": ("NSGS", gauss_seidel_by_projections),
    "VI_EG": ("VI_EG", lambda o: choose(o, 100000)),
    "NSN_AC": ("NSN_AC", lambda o: choose(o, 1000)),
    "NSN_AC after VI_EG": ("NSN_AC", lambda o: choose(o, 1000, {
        "3D_NSN_HYBRID_STRATEGY": "3D_NSN_HYBRID_STRATEGY_VI_EG_NSN", "3D_NSN_HYBRID_MAX_LOOP": 10,
        "3D_NSN_HYBRID_MAX_ITER": 100})),
    "PROX": ("PROX", lambda o: choose(o, 1000)),
    "ADMM": ("ADMM", lambda o: choose(o, 20000)),
    "ADMM, balanced": ("ADMM", lambda o: choose(o, 20000, {
        "3D_ADMM_IPARAM_RHO_STRATEGY": "3D_ADMM_RHO_STRATEGY_SCALED_RESIDUAL_BALANCING",
        "3D_ADMM_IPARAM_INITIAL_RHO": "3D_ADMM_INITIAL_RHO_NORM_INF"})),
}
PLANE = {
    "NSGS": ("NSGS", lambda o: choose(o, 100000)),
    "CPG": ("CPG", lambda o: choose(o, 100000)),
    "LEMKE": ("LEMKE", lambda o: choose(o, 100000)),
}


def solvers(dimension):
    """What is run in this dimension."""
    return SPACE if dimension == 3 else PLANE


def there(problem):
    """The problem as an object of Siconos; its solvers in the plane take full matrices only."""
    matrix = problem.w.tocsc() if problem.dimension == 3 else problem.w.toarray()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sn.FrictionContactProblem(problem.dimension, matrix, problem.q, problem.friction)


@contextlib.contextmanager
def silence():
    """Nothing that C code prints reaches our output."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def run(problem, name, tolerance):
    """One solve from zero: impulses, CPU seconds, iterations, its own error."""
    kind, prepare = solvers(problem.dimension)[name]
    options = prepare(sn.SolverOptions(constant(f"{problem.dimension}D_{kind}")))
    options.dparam[0] = tolerance
    theirs, r, u = there(problem), np.zeros_like(problem.q), np.zeros_like(problem.q)
    driver = sn.fc3d_driver if problem.dimension == 3 else sn.fc2d_driver
    with silence():
        start = time.process_time()
        driver(theirs, r, u, options)
        seconds = time.process_time() - start
    return r, seconds, int(options.iparam[1]), float(options.dparam[1])


def limit_cpu(seconds):
    """Let the process use this many seconds more."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    resource.setrlimit(resource.RLIMIT_CPU, (int(used.ru_utime + used.ru_stime + seconds) + 2, hard))


def solve(file, name, seconds):
    """Solve to one tolerance after the other until the answer is good, or gets no better; print each answer's figures."""
    problem = read_problem(file)
    used = 0.0
    for tolerance in TOLERANCES:
        limit_cpu(seconds)
        r, cpu, iterations, own = run(problem, name, tolerance)
        row = {"tolerance": tolerance, "iterations": iterations, "own": own} | asdict(errors(problem, r))
        row["cpu_seconds"] = cpu if cpu > MEASURED else repeated(problem, name, tolerance)
        print(json.dumps(row), flush=True)
        used += cpu
        if row["e1"] <= ENOUGH or not own <= tolerance or used > 2 * seconds:
            break


def repeated(problem, name, tolerance):
    """Mean CPU seconds of a short run."""
    limit_cpu(20)
    total, runs = 0.0, 0
    while total < MEASURED and runs < 200:
        total += run(problem, name, tolerance)[1]
        runs += 1
    return total / runs


def own_error(file, answer):
    """Siconos' own error of an answer in space."""
    problem = read_problem(file)
    r = np.load(answer)
    options = sn.SolverOptions(constant("3D_NSGS"))
    with silence():
        found = sn.fc3d_compute_error(there(problem), r, problem.w @ r + problem.q, 1e-8, options, np.linalg.norm(problem.q))
    print(json.dumps({"error": found[1]}))


if __name__ == "__main__":
    if sys.argv[1:2] == ["solve"] and len(sys.argv) == 5:
        solve(sys.argv[2], sys.argv[3], float(sys.argv[4]))
    elif sys.argv[1:2] == ["error"] and len(sys.argv) == 4:
        own_error(*sys.argv[2:])
    elif sys.argv[1:2] == ["list"] and len(sys.argv) == 3:
        print(json.dumps(list(solvers(int(sys.argv[2])))))
    else:
        sys.exit(__doc__)
