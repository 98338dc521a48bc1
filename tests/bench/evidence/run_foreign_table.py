#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Forms objects in the foreign laboratory and diagnoses them, one line of JSON each; continues where it was stopped.

run_foreign_table.py FOREIGN_LABORATORY FORMWRIGHT RESULTS.jsonl [--seeds N] [--noise MM] [--points N] [--folder DIR] [--jobs N] [--pairs] [--triangles N]
                     [--level 1|0.5|0.25] [--only CAUSE] [--mould NAME] [--known-machine] [--good-part]

A round is one clean sheet of each mould and every cause once, strong; its seed decides which mould a cause is tried on, before anything is computed.
With another level the same rounds are tried with half or a quarter of every fault, without the clean sheets.
Cases that RESULTS has are not done again, nor are failures hidden: they are lines with "error"."""
import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import tempfile
import threading
import time


def names(program):
    """Moulds and causes as the program lists them."""
    lines = subprocess.run([program, "--names"], capture_output=True, text=True, check=True).stdout.split("\n")
    words = [line.split() for line in lines if line]
    return [name for kind, name in words if kind == "mould"], [name for kind, name in words if kind == "cause"]


def cases(moulds, causes, seeds, level):
    """(seed, mould, cause, level): clean sheets and causes in turn, so that a table that was stopped early has both."""
    for turn in range(seeds):
        first = 100 * (turn + 1)
        clean = [(first + k, mould, "none", 1.0) for k, mould in enumerate(moulds)] if level == 1 else []
        # Moulds follow each other in another order in every round, so that a cause meets each of them.
        faulty = []
        for k, cause in enumerate(causes):
            mould = moulds[(k + turn * 5) % len(moulds)]
            if cause == "mould_rotation" and mould in ("dome", "cone"):  # bodies of revolution do not show it
                mould = "box"
            faulty.append((first + 20 + k, mould, cause, level))
        while clean or faulty:
            yield from faulty[:3]
            yield from clean[:1]
            faulty, clean = faulty[3:], clean[1:]


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{pathlib.Path(command[0]).name} ended with {done.returncode}: {done.stderr.strip()[-400:]}")
    return done.stdout


def form(a, mould, cause, level, seed, out, *more):
    truth = out / "truth.json"
    if truth.exists():  # kept by --folder
        kept = json.loads(truth.read_text())
        if (kept["seed"], kept["mould"], kept["level"], kept["noise_mm"], kept["points"]) == (seed, mould, level, a.noise, a.points):
            return
    run([a.laboratory, "--mould", mould, "--cause", cause, "--level", str(level), "--noise", str(a.noise), "--points", str(a.points), "--seed", str(seed), "--out", str(out),
         *more])


def machine_in_order(a, seed, mould, folder):
    """The profile of the machine, calibrated with one sheet without fault over the next mould, with marks and noise of its own."""
    moulds = names(a.laboratory)[0]
    reference = folder / f"{mould}_in_order_{seed}"
    form(a, moulds[(moulds.index(mould) + 1) % len(moulds)], "none", 1, 500_000 + seed, reference, "--world-seed", str(seed))
    run([a.formwright, "evidence-calibrate", "--object", str(reference), "--out", str(reference / "calibrated"), "--triangles", str(a.triangles)])
    return ["--profile", str(reference / "calibrated" / "profile.json")]


def good_part(a, seed, mould, folder):
    """One sheet without fault of the same machine and plastic over the same mould, of another day, with marks and noise of its own."""
    good = folder / f"{mould}_good_of_another_day_{seed}"
    form(a, mould, "none", 1, 700_000 + seed, good, "--world-seed", str(seed), "--day-seed", str(700_000 + seed))
    return ["--good", str(good)]


def diagnosed(a, seed, mould, cause, level, folder):
    """One line: the hidden truth, what the diagnosis said and how long both took."""
    line = {"seed": seed, "mould": mould, "cause": cause, "level": level, "noise_mm": a.noise, "points": a.points, "pairs": a.pairs, "triangles": a.triangles, "known_machine": a.known_machine, "good_part": a.good_part}
    item = folder / (f"{mould}_{cause}_{seed}" + (f"_{level:g}" if level != 1 else ""))
    try:
        start = time.monotonic()
        form(a, mould, cause, level, seed, item)
        line["seconds_forming"] = round(time.monotonic() - start, 1)
        truth = json.loads((item / "truth.json").read_text())
        line |= {"in_the_list": truth["in_the_list"], "strength": truth["values"], "movement_mean_mm": truth["movement_mean_mm"]}
        start = time.monotonic()
        profile = machine_in_order(a, seed, mould, folder) if a.known_machine else []
        known = good_part(a, seed, mould, folder) if a.good_part else []
        line["seconds_calibrating"] = round(time.monotonic() - start, 1)
        start = time.monotonic()
        run([a.formwright, "evidence-diagnose", "--object", str(item), "--out", str(item / "report"), "--separate", "off", "--pairs", "on" if a.pairs else "off", "--triangles",
             str(a.triangles), *profile, *known])
        line["seconds_diagnosing"] = round(time.monotonic() - start, 1)
        found = json.loads((item / "report" / "diagnosis.json").read_text())
        line |= {key: found[key] for key in ("verdict", "reading", "doubtful", "doubts", "error_before_mm", "error_after_mm", "noise_floor_mm", "unexplained_before_mm",
                                             "unexplained_after_mm", "simulations")}
        nearest = max(found["causes"], key=lambda f: f["likeness"])
        line["nearest"] = [nearest["name"], nearest["likeness"]]
        # How much better than a discrepancy field alone: of the answer that passed, which was tried last.
        line["verdict_gain"] = next((t["gain_share"] for t in reversed(found["trials"]) if sorted(t["causes"]) == sorted(found["verdict"])), None)
        line["simulation"] = [one["name"] for one in found["simulation"] if one["taken"]]
        line["first"] = [{"name": f["name"], "probability": f["probability"], "strength": f["strength"], "interval": f["interval"], "values": f["values"],
                          "min_visible_strength": f["min_visible_strength"]} for f in found["causes"][:3]]
        line["calibrated"] = {p["name"]: p["calibrated"] for p in found["parameters"]}
    except (RuntimeError, OSError, KeyError, json.JSONDecodeError) as error:
        line["error"] = str(error)
    return line


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("laboratory")
    parser.add_argument("formwright")
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=1, help="rounds")
    parser.add_argument("--noise", type=float, default=0.1)
    parser.add_argument("--points", type=int, default=2000)
    parser.add_argument("--triangles", type=int, default=2500, help="of the sheet on which causes are searched")
    parser.add_argument("--folder", type=pathlib.Path, help="keeps the objects and reports here; objects of the same seed, noise and points are not formed again")
    parser.add_argument("--jobs", type=int, default=1, help="cases at a time")
    parser.add_argument("--pairs", action="store_true", help="also looks for two causes at once, which takes twice as long")
    parser.add_argument("--known-machine", action="store_true", help="diagnoses with a profile from when the machine was in order")
    parser.add_argument("--good-part", action="store_true", help="diagnoses beside a sheet without fault over the same mould")
    parser.add_argument("--level", type=float, default=1, help="of the faults: 1 strong, 0.5 medium, 0.25 weak")
    parser.add_argument("--only", help="this cause alone, or none")
    parser.add_argument("--mould", help="this mould alone")
    a = parser.parse_args()
    moulds, causes = names(a.laboratory)
    lines = [json.loads(line) for line in a.results.read_text().splitlines()] if a.results.exists() else []
    done = {(line["seed"], line["mould"], line["cause"], line["level"], line["noise_mm"], line["points"], line["pairs"], line.get("triangles", 5000), line.get("known_machine", False), line.get("good_part", False)) for line in lines if "error" not in line}
    todo = [case for case in cases(moulds, causes, a.seeds, a.level)
            if (*case, a.noise, a.points, a.pairs, a.triangles, a.known_machine, a.good_part) not in done and a.only in (None, case[2]) and a.mould in (None, case[1])]
    print(f"{len(done)} done, {len(todo)} to do", flush=True)
    lock = threading.Lock()

    def work(case):
        with tempfile.TemporaryDirectory() as temporary:
            line = diagnosed(a, *case, a.folder or pathlib.Path(temporary))
        with lock, a.results.open("a") as out:
            out.write(json.dumps(line) + "\n")
        print(case, line.get("verdict", line.get("error")), flush=True)

    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        list(pool.map(work, todo))


if __name__ == "__main__":
    main()
