#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which tests passed before with the same programs, scripts and data, so that they need not run again.

  passed_before.py tests BUILD [--preset P]  numbers of the tests of a build folder that have to run, one a line
  passed_before.py keep BUILD JUNIT          keeps those that passed, by the report that ctest wrote
  passed_before.py hash PATH...              a hash of files and folders and of the packages of this machine

A test is known by a hash of its command, its environment, every file that the command names with those that belong to it
(a program's .wasm), the data of its module in tests/, for scripts all data and scripts in tests/, the packages of this
machine, and what FORMWRIGHT_... variables say. A test whose
command names nothing that was built looks at the repository itself and always runs. A record is a file in the build
folder; without it all tests run."""
import argparse
import functools
import hashlib
import json
import os
import pathlib
import re
import subprocess
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[1]
MACHINE = (pathlib.Path("/var/lib/dpkg/status"), pathlib.Path(__file__).resolve())
NOT_OF_TESTS = {"FORMWRIGHT_JOBS", "FORMWRIGHT_PASSED_BEFORE", "FORMWRIGHT_BACKEND", "FORMWRIGHT_CACHE"}
SOURCES = {".cpp", ".h", ".txt", ".md"}  # compiled, or read by nothing
SCRIPTS = {".py", ".mjs"}


@functools.cache
def hash_of_file(path: pathlib.Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def hash_of(*parts) -> str:
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


def files_below(paths) -> list[pathlib.Path]:
    """Of folders what git would keep, and what a build left in them where git keeps nothing."""
    found = []
    for path in map(pathlib.Path, paths):
        if not path.is_dir():
            found.append(path)
            continue
        kept = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "."], cwd=path, capture_output=True)
        names = [name for name in kept.stdout.decode().split("\0") if name] if kept.returncode == 0 else []
        found += [path / name for name in names] or [file for file in path.rglob("*") if file.is_file()]
    return sorted(file for file in found if file.is_file())


def hash_of_files(files) -> str:
    return hash_of([[str(file), hash_of_file(file)] for file in files])


@functools.cache
def hash_of_surroundings() -> str:
    said = {name: value for name, value in os.environ.items() if name.startswith("FORMWRIGHT_") and name not in NOT_OF_TESTS}
    return hash_of(sorted(said.items()), hash_of_files([file for file in MACHINE if file.is_file()]))


@functools.cache
def hash_of_data(module: str) -> str:
    """Of one module's data without scripts; of all data and scripts for an empty name."""
    folder = ROOT / "tests" / module
    files = [file for file in files_below([folder]) if file.suffix not in SOURCES] if folder.is_dir() else []
    return hash_of_files([file for file in files if not module or file.suffix not in SCRIPTS])


def hash_of_test(test: dict, build: pathlib.Path) -> str | None:
    """Nothing for a test that has to run whatever was built."""
    files = [pathlib.Path(word) for word in test["command"] if pathlib.Path(word).is_file()]
    built = [file for file in files if build.resolve() in file.resolve().parents]
    if not built:
        return None
    own = {part for file in built for part in file.parent.glob(f"{file.stem}.*") if part.is_file()} | set(files)
    environment = [entry for entry in test.get("properties", []) if entry["name"] == "ENVIRONMENT"]
    # build/tests/relief/parts/test_relief_parts is of the module relief.
    within = built[0].resolve().relative_to(build.resolve()).parts
    is_script = any(file.suffix in SCRIPTS for file in files)
    module = within[1] if not is_script and within[0] == "tests" and len(within) > 2 else ""
    return hash_of(test["command"], environment, hash_of_files(sorted(own)), hash_of_data(module), hash_of_surroundings())


def read(record: pathlib.Path) -> dict:
    try:
        return json.loads(record.read_text())
    except (OSError, ValueError):
        return {}


def show_tests(build: pathlib.Path, preset: str | None) -> None:
    ctest = ["ctest", *(["--preset", preset] if preset else ["--test-dir", build])]
    listed = subprocess.run([*ctest, "--show-only=json-v1"], capture_output=True, check=True, cwd=ROOT)
    numbered = subprocess.run([*ctest, "-N"], capture_output=True, check=True, text=True, cwd=ROOT)  # json-v1 has no numbers
    hashes = {test["name"]: hash_of_test(test, build) for test in json.loads(listed.stdout)["tests"] if "command" in test}
    passed = read(build / "passed_before.json")
    (build / "tests_asked.json").write_text(json.dumps(hashes))
    for number, name in re.findall(r"^ *Test +#(\d+): (.+)$", numbered.stdout, re.MULTILINE):
        known = hashes.get(name)
        if known is None or passed.get(name) != known:
            print(number)


def keep_tests(build: pathlib.Path, junit: pathlib.Path) -> None:
    # Hashes of before the run: what was changed meanwhile was not what ran.
    asked, passed = read(build / "tests_asked.json"), read(build / "passed_before.json")
    for case in xml.etree.ElementTree.parse(junit).getroot().iter("testcase"):
        name = case.get("name")
        passed.pop(name, None)
        if case.get("status") == "run" and asked.get(name) is not None:
            passed[name] = asked[name]
    (build / "passed_before.json").write_text(json.dumps({name: known for name, known in passed.items() if name in asked}))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    tests = commands.add_parser("tests")
    tests.add_argument("build", type=pathlib.Path)
    tests.add_argument("--preset")
    keep = commands.add_parser("keep")
    keep.add_argument("build", type=pathlib.Path)
    keep.add_argument("junit", type=pathlib.Path)
    commands.add_parser("hash").add_argument("paths", nargs="+")
    options = parser.parse_args()
    if options.command == "tests":
        show_tests(options.build, options.preset)
    elif options.command == "keep":
        keep_tests(options.build, options.junit)
    else:
        print(hash_of(hash_of_files(files_below(options.paths)), hash_of_surroundings()))


if __name__ == "__main__":
    main()
