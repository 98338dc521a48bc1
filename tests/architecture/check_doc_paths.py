#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files, folders and links that the documentation names exist: fails on each that does not."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Where a path may start, and the folders by which it is recognised.
FOLDERS = {
    "": {"cmake", "core", "docs", "e2e", "native_worker", "setup", "tests", "wasm", "web"},
    "core": {"base", "fabrication", "formats", "geometry", "imaging", "numerics"},
    "tests": {"geometry"},
    "web": {"public", "src"},
    "web/src": {"app", "crafts", "shared", "ui", "view"},
}
# Made by a build.
GENERATED = ("web/dist", "web/node_modules", "web/public/wasm", "public/wasm")
# Written by the reader of an example.
EXAMPLES = re.compile(r"\b(mirror|mirror_test|mirror_cat|program)\.\w+$")
ENDINGS = ("", ".h", ".cpp", ".ts", ".tsx", ".py", ".mjs")

LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
PATH = re.compile(r"(?<![\w/.:-])([a-z][a-z0-9_]*/[A-Za-z0-9_./-]*[A-Za-z0-9_])(?![\w<{*$])")
CODE = re.compile(r"```.*?```|`[^`\n]+`", re.DOTALL)
SOURCE_FILE = re.compile(r"(?<![\w/.-])([a-z][a-z0-9_]*\.(?:h|cpp|ts|tsx|py|sh))(?![\w.])")


def exists(path: str, root: pathlib.Path) -> bool:
    bases = [base for base in FOLDERS if path.split("/")[0] in FOLDERS[base]]
    return not bases or path.startswith(GENERATED) or any((root / base / (path + ending)).exists() for base in bases for ending in ENDINGS)


def missing(document: pathlib.Path, root: pathlib.Path, source_names: set[str]) -> list[str]:
    """What the document names and the tree does not hold. `source_names`: names of all source files, without folders."""
    text = document.read_text()
    found = [target for target in LINK.findall(CODE.sub("", text))
             if "://" not in target and not target.startswith("mailto:") and not (document.parent / target).exists()]
    for code in CODE.findall(text):
        found += [path for path in PATH.findall(code) if not exists(path, root)]
        found += [name for name in SOURCE_FILE.findall(code) if name not in source_names]
    return sorted(name for name in set(found) if not EXAMPLES.search(name))


def documents(root: pathlib.Path) -> list[pathlib.Path]:
    return [root / "README.md", *sorted((root / "docs").rglob("*.md"))]


def main() -> int:
    folders = [path for path in (ROOT / name for name in FOLDERS[""]) if path.is_dir()]
    names = {path.name for folder in folders for path in folder.rglob("*") if "node_modules" not in path.parts}
    problems = [f"{document.relative_to(ROOT)}: {path} does not exist: write where it is" for document in documents(ROOT)
                for path in missing(document, ROOT, names)]
    for problem in problems:
        print(problem)
    print(f"{len(documents(ROOT))} documents checked, {len(problems)} paths missing")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
