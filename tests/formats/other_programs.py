#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh files of other programs in our readers, and ours in theirs.

other_programs.py MESH_TOOL PROGRAM, with PROGRAM one of admesh, meshio, prusa-slicer, openscad, trimesh. Exits with 77
(skipped, for CTest) and a reason if the program is not installed. Each file, in either direction, must have the same
number of faces and vertices, the same bounds and the same enclosed volume.
"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
TOOL = ""


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def ours(path):
    """What our reader finds."""
    return json.loads(run(TOOL, "read", path))


def written(extension, path, *flags):
    """Has our writer write its torus; tells what it holds."""
    return json.loads(run(TOOL, "write", extension, path, *flags))


def skip(reason):
    print("skipped:", reason)
    sys.exit(SKIPPED)


def need(program):
    if shutil.which(program) is None:
        skip(f"{program} is not installed")


def agree(what, expected, found, tolerance=1e-4):
    """Compares two descriptions in all that both of them tell."""
    for key in ("vertices", "faces", "unmatched_edges"):
        if key in expected and key in found and expected[key] != found[key]:
            sys.exit(f"{what}: {key} is {found[key]}, should be {expected[key]}")
    for key in ("volume_mm3", "low", "high"):
        if key not in expected or key not in found:
            continue
        pairs = zip(expected[key], found[key]) if isinstance(expected[key], list) else [(expected[key], found[key])]
        scale = max(1.0, abs(expected["volume_mm3"])) if key == "volume_mm3" else 1.0
        if any(math.isnan(b) or abs(a - b) > tolerance * scale for a, b in pairs):
            sys.exit(f"{what}: {key} is {found[key]}, should be {expected[key]}")
    print("agrees:", what)


def describe_arrays(points, triangles):
    """The same description of plain lists of points and triangles."""
    volume = 0.0
    for a, b, c in triangles:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[a], points[b], points[c]
        volume += (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6
    return {
        "vertices": len(points),
        "faces": len(triangles),
        "volume_mm3": volume,
        "low": [min(float(p[k]) for p in points) for k in range(3)],
        "high": [max(float(p[k]) for p in points) for k in range(3)],
    }


def check_admesh(folder):
    need("admesh")
    ascii_file, binary_file = folder / "ours_ascii.stl", folder / "ours.stl"
    expected = written("stl", ascii_file, "-a")
    written("stl", binary_file)
    for source in (ascii_file, binary_file):
        report = run("admesh", "--no-check", source)
        report = run("admesh", "--exact", source)
        facets = int(next(line for line in report.splitlines() if "Number of facets" in line).split(":")[1].split()[0])
        volume = float(next(line for line in report.splitlines() if "Volume" in line).split("Volume")[1].split(":")[1].split()[0])
        disconnected = [line for line in report.splitlines() if line.startswith("Total disconnected facets")]
        if not disconnected or disconnected[0].split(":")[1].split() != ["0", "0"]:
            sys.exit(f"admesh finds {source.name} open: {disconnected}")
        agree(f"{source.name} in admesh", expected, {"faces": facets, "volume_mm3": volume})
        for flag, name in (("--write-ascii-stl", "theirs_ascii.stl"), ("--write-binary-stl", "theirs.stl")):
            run("admesh", "--no-check", f"{flag}={folder / name}", source)
            agree(f"admesh's {name} of {source.name}", expected, ours(folder / name))


def check_meshio(folder):
    code = "import meshio"
    python = next((p for p in ("/usr/bin/python3", sys.executable) if subprocess.run([p, "-c", code], capture_output=True, check=False).returncode == 0), None)
    if python is None:
        skip("python3-meshio is not installed")
    read = (
        "import meshio, json, sys\nmesh = meshio.read(sys.argv[1])\n"
        "print(json.dumps([mesh.points.tolist(), [t.tolist() for c in mesh.cells if c.type == 'triangle' for t in c.data]]))"
    )
    convert = "import meshio, sys\nmeshio.write(sys.argv[2], meshio.read(sys.argv[1]), **eval(sys.argv[3]))"
    for extension, flags in (("stl", ()), ("stl", ("-a",)), ("ply", ()), ("ply", ("-a",)), ("obj", ("-p",))):  # meshio cannot read texture seams
        path = folder / f"ours{len(flags)}.{extension}"
        expected = written(extension, path, *flags)
        found = describe_arrays(*json.loads(run(python, "-c", read, path)))
        agree(f"{path.name} in meshio", expected, found)
    source = folder / "ours0.ply"
    expected = ours(source)
    for name, options in (("b.ply", "{'binary': True}"), ("a.ply", "{'binary': False}"), ("x.obj", "{}"), ("b.stl", "{'binary': True}"), ("a.stl", "{'binary': False}")):
        run(python, "-c", convert, source, folder / name, options)
        agree(f"meshio's {name}", expected, ours(folder / name))


def check_prusa_slicer(folder):
    need("prusa-slicer")
    source = folder / "ours.3mf"
    expected = written("3mf", source)
    info = run("prusa-slicer", "--info", source)
    values = dict(line.split(" = ") for line in info.splitlines() if " = " in line)
    if values.get("manifold") != "yes":
        sys.exit(f"PrusaSlicer finds our 3MF open:\n{info}")
    # PrusaSlicer puts things on its bed: sizes compare, places do not.
    size = [high - low for low, high in zip(expected["low"], expected["high"])]
    found = {"faces": int(values["number_of_facets"]), "volume_mm3": float(values["volume"]), "high": [float(values[f"size_{k}"]) for k in "xyz"]}
    agree("our 3MF in PrusaSlicer", {**expected, "high": size}, found)
    for extension in ("stl", "obj"):
        path = folder / f"ours.{extension}"
        expected_too = written(extension, path)
        info = run("prusa-slicer", "--info", path)
        values = dict(line.split(" = ") for line in info.splitlines() if " = " in line)
        agree(f"our {extension} in PrusaSlicer", expected_too, {"faces": int(values["number_of_facets"]), "volume_mm3": float(values["volume"])})
    for flag, name in (("--export-3mf", "theirs.3mf"), ("--export-stl", "theirs.stl"), ("--export-obj", "theirs.obj")):
        run("prusa-slicer", "--dont-arrange", flag, "-o", folder / name, source)
        found = ours(folder / name)
        found["size"] = [high - low for low, high in zip(found["low"], found["high"])]
        agree(f"PrusaSlicer's {name}", {"vertices": expected["vertices"], "faces": expected["faces"], "unmatched_edges": 0, "volume_mm3": expected["volume_mm3"], "high": size},
              {**found, "high": found["size"]})


def check_openscad(folder):
    need("openscad")
    # Volume known: a box of 20 x 30 x 10 with a square hole of 10 x 10 through it.
    (folder / "box.scad").write_text("difference() { cube([20, 30, 10]); translate([5, 10, -1]) cube([10, 10, 12]); }\n")
    expected = {"unmatched_edges": 0, "volume_mm3": 20 * 30 * 10 - 10 * 10 * 10, "low": [0, 0, 0], "high": [20, 30, 10]}
    offered = 0
    for extension in ("stl", "3mf", "obj"):
        path = folder / f"theirs.{extension}"
        done = subprocess.run(["openscad", "-o", str(path), str(folder / "box.scad")], capture_output=True, text=True, timeout=300, check=False)
        if done.returncode != 0 or not path.exists() or path.stat().st_size == 0:
            print(f"this openscad does not write {extension}")
            continue
        offered += 1
        agree(f"openscad's {path.name}", expected, ours(path))
    if offered == 0:
        sys.exit("openscad wrote nothing")
    for extension in ("off", "amf"):
        path = folder / f"theirs.{extension}"
        subprocess.run(["openscad", "-o", str(path), str(folder / "box.scad")], capture_output=True, timeout=300, check=False)
        if not path.exists():
            continue
        refused = subprocess.run([TOOL, "read", str(path)], capture_output=True, text=True, check=False)
        if refused.returncode != 1 or path.name not in refused.stderr or "export the model as OBJ" not in refused.stderr:
            sys.exit(f"{path.name} should be refused in words: {refused.stderr}")
        print("refused in words:", refused.stderr.strip())
    for extension, flags in (("stl", ()), ("3mf", ())):
        path = folder / f"ours.{extension}"
        expected = written(extension, path, *flags)
        (folder / "import.scad").write_text(f'import("{path}");\n')
        run("openscad", "-o", folder / "again.stl", folder / "import.scad")
        agree(f"our {extension} through openscad", expected, ours(folder / "again.stl"))


def check_trimesh(folder):
    try:
        import trimesh  # pylint: disable=import-outside-toplevel
    except ImportError:
        other = os.environ.get("FORMWRIGHT_TRIMESH_PYTHON")
        if other and other != sys.executable:
            os.environ.pop("FORMWRIGHT_TRIMESH_PYTHON")
            sys.exit(subprocess.run([other, *sys.argv], check=False).returncode)
        skip("trimesh is not installed for this Python; FORMWRIGHT_TRIMESH_PYTHON may name one that has it (venv, pip install trimesh scipy pillow)")

    def theirs(path):
        mesh = trimesh.load(path, force="mesh")
        scale = 1000 if path.suffix == ".glb" else 1
        return {"faces": len(mesh.faces), "volume_mm3": float(mesh.volume) * scale**3, "low": (mesh.bounds[0] * scale).tolist(), "high": (mesh.bounds[1] * scale).tolist()}

    for extension in ("glb", "ply", "stl", "obj"):
        path = folder / f"ours.{extension}"
        expected = written(extension, path)
        agree(f"our {extension} in trimesh", expected, theirs(path), 1e-3)
        scene = trimesh.load(path, force="mesh")
        if extension == "glb":
            scene.apply_scale(1000)
            if scene.visual.kind != "texture":
                sys.exit("trimesh finds no texture coordinates in our GLB")
        if extension == "ply" and scene.visual.kind != "vertex":
            print("note: trimesh reads texture coordinates rather than colours from our PLY")
        for name in ("theirs.ply", "theirs.stl", "theirs.obj", "theirs.glb"):
            copy = scene.copy()
            if name.endswith("glb"):
                copy.apply_scale(0.001)
            copy.export(folder / name)
            found = ours(folder / name)
            found.pop("vertices")  # trimesh splits vertices at texture seams
            found.pop("unmatched_edges")
            agree(f"trimesh's {name} of our {extension}", expected, found, 1e-3)


CHECKS = {"admesh": check_admesh, "meshio": check_meshio, "prusa-slicer": check_prusa_slicer, "openscad": check_openscad, "trimesh": check_trimesh}


def main():
    global TOOL
    if len(sys.argv) != 3 or sys.argv[2] not in CHECKS:
        sys.exit(__doc__)
    TOOL = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        CHECKS[sys.argv[2]](pathlib.Path(folder))


if __name__ == "__main__":
    main()
