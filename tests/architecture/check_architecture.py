#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks the includes of core/ and the imports of web/src and fails on an arrow that points the wrong way or in a circle."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# What each module may include, itself apart.
CORE = {
    "base": set(),
    "geometry": {"base"},
    "formats": {"base", "geometry"},
    "numerics": {"base", "geometry"},
    "imaging": {"base", "geometry", "formats"},
    "fabrication": {"base", "geometry", "formats", "imaging"},
    "machines": {"base"},
    "relief": {"base", "geometry", "formats", "numerics", "imaging"},
    "thermoform": {"base", "geometry", "formats", "numerics", "imaging"},
    "zippable": {"base", "geometry", "formats", "numerics", "imaging", "fabrication"},
}
CORE["evidence"] = set(CORE)
CORE["job"] = set(CORE)
# Narrower than their module: the engine that explains measurements knows crafts only as forward models.
FOLDERS = {
    "evidence/fit": {"base", "numerics", "geometry"},
    "evidence/explanations": {"base", "numerics", "geometry", "imaging"},
    "evidence/diagnosis": {"base", "numerics", "geometry", "imaging"},
}
# A folder holds about 20 files, tests of files included.
MAX_FILES = 24
HOSTS = {"wasm": {"job", "base", "machines"}, "native_worker": {"job", "base", "machines"}}

# What core never touches: sockets, files, standard output, Emscripten.
FORBIDDEN_HEADERS = re.compile(
    r"^(emscripten|sys/|unistd|fcntl|netinet|arpa|fstream|iostream|filesystem|boost/(asio|beast)|print$)")
# Libraries that one folder alone includes, so that what they throw and need is handled in one place.
HEADER_FOLDERS = {"opencv2": "core/imaging", "embree3": "core/geometry", "hpdf": "core/imaging"}
FORBIDDEN_WORDS = re.compile(r"\b(std::cout|std::cerr|std::clog|printf|puts|fopen|EM_ASM|EM_JS)\s*[(<]")

# web/src: folder -> folders it may import from, itself apart; crafts do not know each other.
WEB = {
    "jobs": set(),
    "view": set(),
    "project": {"jobs"},
    "ui": set(),
    "machines": {"jobs", "project", "ui"},
    "shared": {"jobs", "project", "view", "ui", "machines"},
    "crafts": {"jobs", "project", "view", "ui", "machines", "shared"},
    "app": {"jobs", "project", "view", "ui", "machines", "shared", "crafts"},
}


def module_of(path: pathlib.Path, base: pathlib.Path) -> str:
    return path.relative_to(base).parts[0]


def check_sources(folder: pathlib.Path, module: str, allowed: set[str], is_core: bool) -> list[str]:
    problems = []
    for path in sorted(folder.rglob("*")):
        if path.suffix not in {".h", ".cpp", ".inl"}:
            continue
        text = path.read_text()
        where = path.relative_to(ROOT)
        for number, line in enumerate(text.splitlines(), 1):
            if match := re.match(r'\s*#\s*include\s*"([^"/]+)/', line):
                target = match.group(1)
                if target in CORE and target != module and target not in allowed:
                    problems.append(f"{where}:{number}: {module} must not include {target}")
            if is_core and (match := re.match(r"\s*#\s*include\s*<([^>]+)>", line)):
                if FORBIDDEN_HEADERS.match(match.group(1)):
                    problems.append(f"{where}:{number}: core must not include <{match.group(1)}>")
            if match := re.match(r"\s*#\s*include\s*<([a-z0-9]+)", line):
                only = HEADER_FOLDERS.get(match.group(1))
                if only and not str(where).startswith(only + "/"):
                    problems.append(f"{where}:{number}: only {only} includes <{match.group(1)}>")
            if is_core and FORBIDDEN_WORDS.search(line.split("//")[0]):
                problems.append(f"{where}:{number}: core must not print or open files")
    return problems


INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def check_folders(tops: list[pathlib.Path]) -> list[str]:
    """Folders that reach themselves by the includes of their files, that hold too many files, or that include what theirs may not."""
    files = {path for top in tops for path in top.rglob("*") if path.suffix in {".h", ".cpp"}}
    reached: dict[pathlib.Path, set[pathlib.Path]] = {path.parent: set() for path in files}
    problems = []
    for path in sorted(files):
        for include in INCLUDE.findall(path.read_text()):
            target = next((base / include for base in (path.parent, *tops) if base / include in files), None)
            if target is None:
                continue
            if target.parent != path.parent:
                reached[path.parent].add(target.parent)
            for folder, allowed in FOLDERS.items():
                inside = tops[0] / folder
                module = module_of(target, tops[0]) if target.is_relative_to(tops[0]) else ""
                if path.is_relative_to(inside) and module not in allowed | {folder.split("/")[0]}:
                    problems.append(f"{path.relative_to(ROOT)}: {folder} must not include {module}")
                elif path.is_relative_to(inside) and target.is_relative_to(tops[0] / "evidence" / "models"):
                    problems.append(f"{path.relative_to(ROOT)}: {folder} must not include a craft's model")
    # Folders that include none of those in question are taken away until none is left: what remains are the circles.
    while ends := {folder for folder, targets in reached.items() if not targets}:
        reached = {folder: targets - ends for folder, targets in reached.items() if folder not in ends}
    while starts := set(reached) - set().union(*reached.values()):
        reached = {folder: targets for folder, targets in reached.items() if folder not in starts}
    problems += [f"{folder.relative_to(ROOT)}: circle of folders with {', '.join(sorted(str(t.relative_to(ROOT)) for t in targets))}"
                 for folder, targets in sorted(reached.items())]
    for folder in sorted({path.parent for path in files}):
        count = sum(1 for path in folder.iterdir() if path.is_file())
        if count > MAX_FILES:
            problems.append(f"{folder.relative_to(ROOT)}: holds {count} files, and at most {MAX_FILES} are easy to survey")
    return problems


def check_foreign(folder: pathlib.Path) -> list[str]:
    """A laboratory that judges the simulation shares nothing with it: it includes and links nothing of ours but its own folder."""
    problems = []
    for path in sorted(folder.rglob("*")):
        where = path.relative_to(ROOT)
        if path.suffix in {".h", ".cpp", ".inl"}:
            for number, line in enumerate(path.read_text().splitlines(), 1):
                match = re.match(r'\s*#\s*include\s*(["<])([^">]+)[">]', line)
                if not match or match.group(2).startswith(folder.name + "/") and ".." not in match.group(2):
                    continue
                if match.group(1) == '"' or match.group(2).split("/")[0] in CORE:
                    problems.append(f"{where}:{number}: {folder.name} must include nothing of ours, and includes {match.group(2)}")
        elif path.name == "CMakeLists.txt":
            linked = set(re.findall(r"\bfw_\w+", path.read_text())) - {"fw_warnings"}
            problems += [f"{where}: {folder.name} must link nothing of ours, and links {name}" for name in sorted(linked)]
    return problems


IMPORT = re.compile(r"""(?:from|import)\s*\(?\s*['"](\.[^'"]+)['"]""")


def imports_of_web(src: pathlib.Path) -> dict[pathlib.Path, list[pathlib.Path]]:
    """By file of the page: the files it imports, types included."""
    files = {path.resolve() for path in src.rglob("*.ts*")}
    found = {}
    for path in sorted(files):
        targets = [path.parent / target for target in IMPORT.findall(path.read_text())]
        endings = ("", ".ts", ".tsx", "/index.ts")
        resolved = [pathlib.Path(f"{target}{ending}").resolve() for target in targets for ending in endings]
        found[path] = [target for target in resolved if target in files]
    return found


def check_circles(src: pathlib.Path) -> list[str]:
    """Files of the page that reach themselves by their imports. Files that import no file in question are taken away until none is left:
    what remains are the circles and what leads into them."""
    imports = {path: set(targets) for path, targets in imports_of_web(src).items()}
    while ends := {path for path, targets in imports.items() if not targets}:
        imports = {path: targets - ends for path, targets in imports.items() if path not in ends}
    while starts := set(imports) - set().union(*imports.values()):
        imports = {path: targets for path, targets in imports.items() if path not in starts}
    base = src.resolve()
    return [f"web/src: import circle: {path.relative_to(base)} imports {', '.join(str(t.relative_to(base)) for t in sorted(targets))}"
            for path, targets in imports.items()]


def check_web(src: pathlib.Path) -> list[str]:
    problems = []
    for path in sorted(src.rglob("*.ts*")):
        parts = path.relative_to(src).parts
        if len(parts) < 2 or parts[0] not in WEB:
            continue
        own = parts[0]
        for target in IMPORT.findall(path.read_text()):
            resolved = (path.parent / target).resolve()
            try:
                to = resolved.relative_to(src.resolve()).parts
            except ValueError:
                continue
            if len(to) < 2 or to[0] not in WEB:
                continue
            where = path.relative_to(ROOT)
            if to[0] != own and to[0] not in WEB[own]:
                problems.append(f"{where}: {own} must not import {to[0]} ({target})")
            between_crafts = own == "crafts" and to[0] == "crafts" and len(parts) > 2 and len(to) > 2 and parts[1] != to[1]
            if between_crafts:  # shared/ is what they have in common
                problems.append(f"{where}: crafts do not know each other ({target})")
    return problems


def main() -> int:
    problems = []
    modules = sorted(p.name for p in (ROOT / "core").iterdir() if p.is_dir())
    for module in modules:
        if module not in CORE:
            problems.append(f"core/{module}: a module this test does not know; say what it may include")
            continue
        problems += check_sources(ROOT / "core" / module, module, CORE[module], is_core=True)
    for host, allowed in HOSTS.items():
        problems += check_sources(ROOT / host, host, allowed, is_core=False)
    problems += check_folders([ROOT / "core", ROOT / "native_worker"])
    problems += check_foreign(ROOT / "tests" / "foreign_laboratory")
    problems += check_web(ROOT / "web" / "src")
    problems += check_circles(ROOT / "web" / "src")
    for problem in problems:
        print(problem)
    print(f"{len(modules)} core modules checked, {len(problems)} wrong arrows and circles")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
