#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names in code use the words of docs/glossary.md: fails on identifiers made of words that it lists as ones to avoid."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# What is avoided in a name, and what is written instead.
AVOIDED = {
    r"(^|_)most_|_most$|^most[A-Z]": "max_",
    r"(^|_)least_|_least$|^least[A-Z]": "min_",
    r"(^|_)told($|_)|^told[A-Z]|[a-z]Told": "reported, distinguishable",
    r"(^|_)mend(s|ed|ing)?($|_)|[a-z]Mend": "fix, repair",
    r"(^|_)libert(y|ies)($|_)": "discrepancy",
    r"_ways?_?$": "path, direction",
}

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
# Comments and text: what remains when they are taken out is code.
NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"([a-z]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|`(?:\\.|[^`\\])*`', re.DOTALL)


def avoided_names(code: str) -> dict[str, str]:
    """By name of the code given: what is written instead."""
    found = {}
    for name in sorted(set(NAME.findall(NOT_CODE.sub(" ", code)))):
        for pattern, instead in AVOIDED.items():
            if re.search(pattern, name):
                found[name] = instead
    return found


def main() -> int:
    files = [path for folder in ("core", "native_worker", "wasm", "tests", "web/src", "e2e") for path in sorted((ROOT / folder).rglob("*"))
             if path.suffix in {".h", ".cpp", ".ts", ".tsx"} and "node_modules" not in path.parts]
    problems = [f"{path.relative_to(ROOT)}: {name}: write {instead} (docs/glossary.md)"
                for path in files for name, instead in avoided_names(path.read_text()).items()]
    for problem in problems:
        print(problem)
    print(f"{len(files)} files checked, {len(problems)} names to change")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
