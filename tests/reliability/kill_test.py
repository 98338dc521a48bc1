#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs through kill -9 of the worker, of its solver and of both at random moments: every accepted job is done, with the outputs that it has where nothing
is killed, and nothing is left over. Usage: kill_test.py PROGRAM [--jobs 100] [--kills 200] [--seed N]"""
import argparse
import os
import pathlib
import random
import signal
import sys
import tempfile
import time

from kept_jobs import NO_ANSWER, TETRAHEDRON, Figures, job_number, left_over, undisturbed, wait_for_all
from worker import Worker, children_of, runs_jobs

# A kill that comes before the worker listens says nothing of jobs, yet of the folder: some do.
EARLY_SHARE = 0.1


def solver_of(worker: Worker) -> int | None:
    try:
        children = children_of(worker.process.pid)
    except OSError:
        return None
    return next((child for child in children if runs_jobs(child)), None)


def kill(process: int | None) -> bool:
    try:
        os.kill(process, signal.SIGKILL)
        return True
    except (ProcessLookupError, TypeError):
        return False


def bury(worker: Worker) -> None:
    worker.process.kill()
    worker.process.wait()
    worker.process.stdout.close()


def start(program: str, data: pathlib.Path, draw: random.Random) -> Worker:
    if draw.random() < EARLY_SHARE:
        worker = Worker.__new__(Worker)
        Worker.begin(worker, program, data)
        time.sleep(draw.uniform(0, 0.05))
        bury(worker)
    return Worker(program, data)


def main() -> int:
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program")
    arguments.add_argument("--jobs", type=int, default=100)
    arguments.add_argument("--kills", type=int, default=200)
    arguments.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    options = arguments.parse_args()
    draw = random.Random(options.seed)
    print(f"seed {options.seed}")
    killed = {"worker": 0, "solver": 0, "both": 0}
    with tempfile.TemporaryDirectory() as name:
        expected = undisturbed(options.program, pathlib.Path(name) / "undisturbed", list(range(options.jobs)))
        data = pathlib.Path(name) / "data"
        worker = start(options.program, data, draw)
        accepted: dict[str, int] = {}
        posted = 0
        blob = None
        began = time.monotonic()
        while sum(killed.values()) < options.kills:
            # As many jobs wait as still have kills to come through, so that none comes late.
            next_kill = time.monotonic() + draw.uniform(0.005, 0.35)
            due = options.jobs * (sum(killed.values()) + 1) // options.kills
            try:
                blob = blob or worker.put_blob(TETRAHEDRON)
                while posted < due and time.monotonic() < next_kill:
                    status, answer = worker.json("POST", "/api/jobs", job_number(posted, blob))
                    if status != 202:
                        break
                    accepted[answer["id"]] = posted
                    posted += 1
            except NO_ANSWER as error:
                print(f"no answer, though nobody was killed: {error}")
                return 1
            time.sleep(max(0, next_kill - time.monotonic()))
            victim = draw.choice(("worker", "solver", "both"))
            solver = solver_of(worker)
            if victim != "worker" and not kill(solver):
                continue  # none runs at this moment
            if victim != "solver":
                bury(worker)
                worker = start(options.program, data, draw)
            killed[victim] += 1
        while posted < options.jobs:
            status, answer = worker.json("POST", "/api/jobs", job_number(posted, blob))
            if status == 202:
                accepted[answer["id"]] = posted
                posted += 1
            else:
                time.sleep(0.1)
        if not wait_for_all(worker, accepted, 600):
            print("not all jobs have finished after ten minutes")
        figures = Figures()
        figures.add(worker, accepted, expected, "after the kills")
        worker.stop()
        rest = left_over(data)
    print(f"kill -9 of the worker {killed['worker']}, of the solver {killed['solver']}, of both {killed['both']}; {time.monotonic() - began:.0f} s")
    print(f"accepted {figures.accepted}, done {figures.done}, byte-equal {figures.equal}, left over {len(rest)}")
    for failure in figures.failures + rest:
        print("  " + failure)
    return 0 if figures.accepted == figures.done == figures.equal == options.jobs and not rest else 1


if __name__ == "__main__":
    sys.exit(main())
