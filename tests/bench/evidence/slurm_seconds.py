#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds of evidence commands on this computer and in a Slurm cluster of two nodes on the same computer, one core each, with Slurm's usual delays.
Usage: slurm_seconds.py PROGRAM [plan|grid|diagnosis ...]"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "native_worker" / "slurm"))
from slurm_cluster import SlurmCluster  # noqa: E402

PROGRAM = sys.argv[1]
COMMANDS = {
    "plan of 10 marks, 500 triangles": ("evidence-plan-points", "--sample", "pyramid", "--size-mm", "60", "--triangles", "500"),
    "grid of 625 points, 2,500 triangles": ("evidence-calibrate", "--object", "{object}/", "--method", "grid", "--triangles", "2500"),
    "diagnosis without pairs, 5,000 triangles": ("evidence-diagnose", "--object", "{object}/", "--pairs", "off", "--separate", "off"),
}


def seconds(folder, name, words, *engine, env):
    start = time.monotonic()
    run = subprocess.run([PROGRAM, *words, *engine, "--out", folder / name], env=env, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(run.stderr)
    places = re.findall(r"Simulations: (.*)\.", run.stderr)
    return time.monotonic() - start, places[-1] if places else ""


with tempfile.TemporaryDirectory() as temporary, SlurmCluster() as cluster:
    folder = pathlib.Path(temporary)
    lamp = folder / "lamp"
    subprocess.run([PROGRAM, "evidence-virtual-object", "--sample", "pyramid", "--size-mm", "100", "--heating-gradient-x", "0.4", "--out", lamp, "--quiet"], check=True, capture_output=True)
    print(f"load before: {os.getloadavg()[0]:.1f}")
    for title, words in COMMANDS.items():
        if sys.argv[2:] and title.split()[0] not in sys.argv[2:]:
            continue
        words = [word.format(object=lamp) for word in words]
        for number, engine in enumerate(((), ("--engine", "slurm"), ("--engine", "slurm", "--local-seconds", "0"))):
            took, places = seconds(folder, f"{words[0]}-{number}", words, *engine, env=cluster.environment)
            jobs = cluster.run("scontrol", "show", "job", "--oneliner").stdout
            arrays = len(set(re.findall(r"JobName=(slurm-\w+-\d+)", jobs)))
            print(f"{title} | {' '.join(engine) or 'this computer'} | {took:.1f} s | {places} | arrays so far: {arrays}", flush=True)
