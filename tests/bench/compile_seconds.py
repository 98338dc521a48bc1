#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Processor seconds that compiling takes, by target, without the compiler cache.

  tests/bench/compile_seconds.py build [PART...]   all of a build folder, or the objects whose names hold one of the parts
"""
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys


def object_of(command: dict) -> str:
    return re.search(r" -o (\S+)", command["command"]).group(1)


def seconds_of(command: dict) -> tuple[str, int, float]:
    """Target, source files, seconds of user and system time."""
    text = re.sub(r" -o \S+ ", " -o /dev/null ", command["command"])
    process = subprocess.Popen(text, shell=True, cwd=command["directory"], env={**os.environ, "CCACHE_DISABLE": "1"})
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{object_of(command)} does not compile: build the folder first")
    source = pathlib.Path(command["file"])
    files = len(re.findall("^#include", source.read_text(), re.M)) if source.parent.name == "groups" else 1
    target = re.search(r"([^/]+)\.dir/", object_of(command)).group(1)
    return target, files, usage.ru_utime + usage.ru_stime


def main() -> None:
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    build, parts = pathlib.Path(sys.argv[1]), sys.argv[2:]
    commands = json.loads((build / "compile_commands.json").read_text())
    if parts:
        commands = [command for command in commands if any(part in object_of(command) for part in parts)]
    files, compiled, seconds = collections.Counter(), collections.Counter(), collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for target, count, spent in pool.map(seconds_of, commands):
            for key in (target, "all"):
                files[key] += count
                compiled[key] += 1
                seconds[key] += spent
    print("| target | files | compiled as | seconds |\n| --- | ---: | ---: | ---: |")
    for target, spent in sorted(seconds.items(), key=lambda item: item[1]):
        print(f"| `{target}` | {files[target]} | {compiled[target]} | {spent:.1f} |")


main()
