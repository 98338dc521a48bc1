#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole confusion table, a process a processor; goes on where it was stopped.

run_confusion_table.py CONFUSION_TABLE RESULTS.jsonl [--repeat N] [--pairs N] [--clean N]
Every cause at three strengths and two noise levels, each left out of the list once, pairs, clean data: what RESULTS has already is not done again, and every
answer is appended as it comes, and those of an older engine are asked again with their seeds. What is asked of most comes first. Each case is one simulation after the
other on one processor, two to four minutes; score_confusion_table.py counts what there is."""
import argparse
import collections
import json
import os
import pathlib
import subprocess
import threading

CAUSES = ("heating_gradient heating_centre slip anisotropy thickness_wedge cooling weak_vacuum clamp_slip mould_shift mould_rotation mould_scale "
          "print_scale print_stretch_x print_stretch_y scan_scale scan_stretch_x scan_stretch_y scan_stretch_z scan_rotation scan_shift").split()


CLEAN_MOULDS = ("pyramid", "box", "ridge", "cross", "dome")


def cases(repeat, pairs, clean):
    """(what the line will say, arguments) in order of worth."""

    def single(level, noise, left_out=False):
        flags = ["--left-out"] if left_out else ["--unseen"] if level >= 0.5 else []
        for cause in CAUSES:
            yield ((cause,), level, noise, left_out), ["--only", cause, "--levels", str(level), "--noise", str(noise), "--no-pairs", *flags]

    for _ in range(repeat):
        yield from single(1, 0.05)
        yield from single(1, 0.15)
        for k in range(clean // repeat):
            noise, mould = (0.05, 0.15)[k % 2], CLEAN_MOULDS[k % 5]
            yield ((mould,), 1, noise, False), ["--only", "none", "--mould", mould, "--levels", "1", "--noise", str(noise), "--no-pairs"]
        yield from single(1, 0.05, left_out=True)
        for _ in range(pairs // repeat):
            yield ("pair", 1, 0.05, False), ["--pairs", "1", "--levels", "1", "--noise", "0.05"]
        yield from single(0.5, 0.05)
        for level, noise in ((0.5, 0.15), (0.25, 0.05), (0.25, 0.15)):
            yield from single(level, noise)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--pairs", type=int, default=18)
    parser.add_argument("--clean", type=int, default=18)
    a = parser.parse_args()
    lines = [json.loads(line) for line in a.results.read_text().splitlines()] if a.results.exists() else []
    engine = int(subprocess.run([a.program, "--engine"], capture_output=True, text=True, check=True).stdout)
    done = collections.Counter()
    older = collections.defaultdict(list)  # seeds of answers to ask for again
    again = {line["seed"] for line in lines if line.get("engine", 1) == engine}
    for line in lines:
        hidden = tuple(line["hidden"])
        key = "pair" if len(hidden) == 2 else hidden or (line.get("mould"),), line.get("level"), line.get("sigma_mm"), line.get("left_out", False)
        if line.get("engine", 1) == engine:
            done[key] += 1
        elif line["seed"] not in again and line["seed"] % 1000 == 1:  # the first of its call, as here
            older[key].append(line["seed"] // 1000)
    todo = []
    unused = 1 + max((line["seed"] for line in lines), default=0) // 1000
    for key, flags in cases(a.repeat, a.pairs, a.clean):
        if done[key] > 0:
            done[key] -= 1
        elif older[key]:
            todo.append((older[key].pop(0), flags))
        else:
            todo.append((unused, flags))
            unused += 1
    print(f"{sum(line.get('engine', 1) == engine for line in lines)} done, {len(todo)} to do", flush=True)
    ask(a.program, todo, a.results)


def ask(program, todo, results):
    """Seeds with their flags, a process a processor; answers are appended as they come."""
    lock = threading.Lock()
    queue = iter(todo)

    def work(processor):
        for seed, flags in iter(lambda: next_of(queue, lock), None):
            answer = subprocess.run(["taskset", "-c", str(processor), program, "--seed", str(seed), *flags], capture_output=True, text=True).stdout
            with lock, results.open("a") as out:
                out.write(answer)

    threads = [threading.Thread(target=work, args=(p,)) for p in os.sched_getaffinity(0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def next_of(queue, lock):
    with lock:
        return next(queue, None)


main()
