#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The n-th write, fsync, rename, new file or new folder of a worker and its solver fails: every job that was answered 202 is done after a restart at the
latest, with the outputs that it has where nothing fails, and nothing is left over.
Usage: disk_fault_test.py PROGRAM LIBRARY [--from 1] [--to 500] [--step 1] [--seed N]
The error is ENOSPC or EIO, drawn; every fourth disk stays full until the restart."""
import argparse
import errno
import itertools
import pathlib
import random
import shutil
import struct
import sys
import tempfile
import time

from kept_jobs import DONE, NO_ANSWER, TETRAHEDRON, Figures, job_number, left_over, states, undisturbed, wait_for_all
from worker import HEARS_HANGUPS, Worker

CHANGES_OF_A_JOB = 20  # of the disk, at least
SECONDS_AFTER_FAULT = 1.5  # then the restart comes


def jobs_for(number: int) -> list[int]:
    """Enough of the quick ones for the n-th change of the disk to be among theirs."""
    quick = (job for job in itertools.count() if job % 6 in (0, 1, 3))
    return list(itertools.islice(quick, 3 + number // CHANGES_OF_A_JOB))


def changes(counter: pathlib.Path) -> int:
    return struct.unpack("q", counter.read_bytes())[0]


def run_with_fault(worker: Worker, jobs: list[int], counter: pathlib.Path, number: int) -> tuple[dict[str, int], int]:
    """The jobs that were accepted, and how many answers were 507."""
    accepted: dict[str, int] = {}
    refused = 0
    blob = None
    for job in jobs:
        try:
            if job % 6 == 0 and blob is None:  # a refused upload is sent again, as a page does
                for _ in range(2):
                    try:
                        blob = worker.put_blob(TETRAHEDRON)
                        break
                    except AssertionError:
                        refused += 1
            if job % 6 == 0 and blob is None:
                continue
            status, answer = worker.json("POST", "/api/jobs", job_number(job, blob or ""))
        except NO_ANSWER:
            break
        if status == 202:
            accepted[answer["id"]] = job
        elif status == 507:
            assert answer["error"]["message"], answer
            refused += 1
        else:
            raise AssertionError((status, answer))
    restart = None
    while not all(state in DONE for state in states(worker, accepted).values()) and (not restart or time.monotonic() < restart):
        if not restart and changes(counter) >= number:
            restart = time.monotonic() + SECONDS_AFTER_FAULT
        time.sleep(0.02)
    return accepted, refused


def main() -> int:
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program")
    arguments.add_argument("library")
    arguments.add_argument("--from", type=int, default=1, dest="first")
    arguments.add_argument("--to", type=int, default=500)
    arguments.add_argument("--step", type=int, default=1)
    arguments.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    options = arguments.parse_args()
    draw = random.Random(options.seed)
    print(f"seed {options.seed}")
    figures = Figures()
    runs = refused = not_started = met = 0
    rest: list[str] = []
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name).resolve()
        expected = undisturbed(options.program, folder / "undisturbed", jobs_for(options.to))
        for number in range(options.first, options.to + 1, options.step):
            data, counter = folder / "data", folder / "counter"
            counter.write_bytes(bytes(8))
            error, stays = draw.choice((errno.ENOSPC, errno.EIO)), draw.randrange(4) == 0
            where = f"n = {number}, {errno.errorcode[error]}{', stays' if stays else ''}"
            faults = {"LD_PRELOAD": options.library, "FORMWRIGHT_FAULT_FOLDER": data, "FORMWRIGHT_FAULT_COUNTER": counter,
                      "FORMWRIGHT_FAULT_AT": number, "FORMWRIGHT_FAULT_ERROR": error, "FORMWRIGHT_FAULT_STAYS": int(stays)}
            accepted: dict[str, int] = {}
            runs += 1
            try:
                worker = Worker(options.program, data, before=(*HEARS_HANGUPS, *(f"{key}={value}" for key, value in faults.items())))
                accepted, answers = run_with_fault(worker, jobs_for(number), counter, number)
                refused += answers
                worker.stop()
            except RuntimeError:
                not_started += 1
            met += changes(counter) >= number
            worker = Worker(options.program, data)
            if not wait_for_all(worker, accepted, 60):
                figures.failures.append(f"{where}: not all jobs have finished")
            figures.add(worker, accepted, expected, where)
            others = {job["id"] for job in worker.json("GET", "/api/jobs?limit=500")[1]} - accepted.keys()
            worker.stop()
            rest += [f"{where}: left over {path}" for path in left_over(data)] + [f"{where}: job {job} was never accepted" for job in others]
            shutil.rmtree(data)
    print(f"{runs} runs, the fault was met in {met}, {not_started} did not start, {refused} answers 507; {time.monotonic() - began:.0f} s")
    print(f"accepted {figures.accepted}, done {figures.done}, byte-equal {figures.equal}, lost {figures.accepted - figures.done}, left over {len(rest)}")
    for failure in figures.failures + rest:
        print("  " + failure)
    return 0 if figures.accepted == figures.done == figures.equal and figures.accepted > 0 and met == runs and not rest else 1


if __name__ == "__main__":
    sys.exit(main())
