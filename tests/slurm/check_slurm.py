#!/usr/bin/env python3
"""The job script of doc/guide on a Slurm of one node that this script starts and ends: stops, requeues, another number of ranks.

usage: check_slurm.py PROGRAM FOLDER (as root, with Debian's slurm-wlm and munge)
"""

import csv
import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "doc/guide/seeds.slurm"
CONFIG = """ClusterName=one
SlurmctldHost={host}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={place}/munge.socket
CryptoType=crypto/munge
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
SlurmctldLogFile={place}/slurmctld.log
SlurmdLogFile={place}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
MpiDefault=none
ReturnToService=2
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
NodeName={host} CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
DECK = """[scene]
dimension = 3
[time]
step = 5e-4
steps = 4000
[solver]
criterion = "e8"
tolerance = 1e-3
[output]
record_every = 100
[[material]]
name = "stone"
density = 2600.0
[[law]]
friction = 0.4
[[container]]
size = [0.4, 0.4, 1.0]
[[sample]]
shape = "sphere"
box = [0.0, 0.0, 0.0, 0.4, 0.4, 1.0]
radius = [0.02, 0.03]
count = 300
"""


class Slurm:
    """munged, slurmctld and slurmd with files in one folder."""

    def __init__(self, place):
        self.place, self.started = place, []
        for name in ("state", "spool"):
            (place / name).mkdir()
        config = place / "slurm.conf"
        config.write_text(CONFIG.format(host=socket.gethostname(), place=place, cpus=os.cpu_count()))
        os.environ |= {"SLURM_CONF": str(config), "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        key = place / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self.start("munged", "--foreground", "--force", f"--socket={place}/munge.socket", f"--key-file={key}", f"--pid-file={place}/munge.pid",
                   f"--log-file={place}/munge.log", f"--seed-file={place}/munge.seed")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        wait(lambda: "idle" in output("sinfo", "-h", "-o", "%t"), 60, "the node")

    def start(self, name, *words):
        with open(self.place / f"{name}.out", "w") as log:
            self.started.append(subprocess.Popen([f"/usr/sbin/{name}", *words], stdout=log, stderr=subprocess.STDOUT))
        time.sleep(1)

    def stop(self):
        # Steps of jobs outlive slurmd.
        numbers = output("squeue", "-h", "-o", "%A").split()
        if numbers:
            subprocess.run(["scancel", "--signal=KILL", "--full", *numbers], check=False)
            subprocess.run(["scancel", *numbers], check=False)
            time.sleep(3)
        for process in reversed(self.started):
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def output(*words):
    """What a command prints."""
    return subprocess.run(words, capture_output=True, text=True, check=False).stdout


def wait(is_so, seconds, what):
    """Wait until something is so."""
    end = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > end:
            raise AssertionError(f"{what} took more than {seconds} s\n{output('squeue')}")
        time.sleep(0.5)


def submit(program, place, ranks, steps, walltime):
    """Submit the job script for two seeds; returns when no job is left. Jobs that wait after their requeue are let go at once."""
    deck = place / "deck.toml"
    deck.write_text(DECK.replace("steps = 4000", f"steps = {steps}"))
    words = ["sbatch", "--parsable", "--array=1-2%1", f"--ntasks={ranks}", "--time=10", f"--export=ALL,DECK={deck},PROGRAM={program},WALLTIME={walltime}"]
    done = subprocess.run([*words, str(SCRIPT)], cwd=place, capture_output=True, text=True, check=True)
    number = done.stdout.strip()
    since = {}

    def is_over():
        for line in output("squeue", "-h", "-r", "-o", "%i %t %r").splitlines():
            job, _, reason = line.split(maxsplit=2)
            if reason.strip("()") != "BeginTime":
                since.pop(job, None)
            # The node revokes what began just before for some seconds.
            elif time.monotonic() - since.setdefault(job, time.monotonic()) > 12:
                since.pop(job)
                subprocess.run(["scontrol", "update", f"JobId={job}", "StartTime=now"], check=False, capture_output=True)
        return not output("squeue", "-h")

    wait(is_over, 600, f"job {number}")


def slice_of(program, place, ranks, steps):
    """Seconds that a run may take until it stops, a fifth of all its steps by the pace of the first tenth: on a machine at work longer."""
    deck = place / "pace.toml"
    deck.write_text(DECK.replace("steps = 4000", f"steps = {steps // 10}"))
    start = time.monotonic()
    subprocess.run(["mpiexec", "--oversubscribe", "-n", str(ranks), program, "run", str(deck), "--output", str(place / "pace"), "--quiet"], check=True)
    return max(2, round((time.monotonic() - start) * 2))


def main(program, place):
    """Two seeds stop and go on until they are done, then go on to more steps on another number of ranks."""
    slurm = Slurm(place)
    try:
        seconds = slice_of(program, place, ranks=2, steps=2500)
        submit(program, place, ranks=2, steps=2500, walltime=f"0:{seconds // 60}:{seconds % 60:02}")
        logs = "".join(path.read_text() for path in place.glob("slurm-*.out"))
        for seed in (1, 2):
            check(place / f"seed_{seed}", 2500, 2)
        stops = logs.count("stopped by the walltime")
        assert stops >= 2, f"{stops} stops\n{logs}"
        submit(program, place, ranks=1, steps=2800, walltime="job")
        for seed in (1, 2):
            check(place / f"seed_{seed}", 2800, 1)
        assert (place / "seed_1/record.csv").read_text() != (place / "seed_2/record.csv").read_text()
        print(f"slurm: two seeds done after {stops} stops and requeues on 2 ranks, and on to 2800 steps on 1 rank within --walltime job")
    finally:
        slurm.stop()


def check(folder, steps, ranks):
    """A run must be done, with all rows of its record."""
    run = json.loads((folder / "run.json").read_text())
    assert (run["status"], run["steps"], run["ranks"]) == ("done", steps, ranks), run
    with open(folder / "record.csv", newline="") as file:
        rows = [int(row["step"]) for row in csv.DictReader(file)]
    assert rows == list(range(100, steps + 1, 100)), rows


if __name__ == "__main__":
    main(str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve())
