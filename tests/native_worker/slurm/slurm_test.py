#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A diagnosis in a real Slurm cluster of two nodes, one of which is killed. Usage: slurm_test.py PROGRAM"""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from slurm_cluster import SlurmCluster, missing_programs, processes

PROGRAM = sys.argv.pop(1)
QUICK_SCHEDULER = ",batch_sched_delay=0,sched_interval=2,sched_min_interval=0"
PLAN = ("evidence-plan-points", "--sample", "pyramid", "--size-mm", 60, "--triangles", 500, "--mark-count", 4)


def words_of(*words):
    return [PROGRAM, *map(str, words)]


def same(value):
    """An answer without the seconds and the memory that it took."""
    if isinstance(value, dict):
        return {k: same(v) for k, v in value.items() if not k.startswith(("seconds", "peak_memory"))}
    return [same(v) for v in value] if isinstance(value, list) else value


def simulating():
    """Tasks of an array that still run."""
    found = []
    for process in processes():
        try:
            words = pathlib.Path(f"/proc/{process}/cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if b"run-simulations" in words and os.path.realpath(words[0]) == os.path.realpath(PROGRAM.encode()):
            found.append(process)
    return found


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.cluster = SlurmCluster(scheduler=QUICK_SCHEDULER)
        cls.addClassCleanup(cls.cluster.close)

    def start(self, *words, **variables):
        run = subprocess.Popen(words_of(*words), env={**self.cluster.environment, **variables}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(run.kill)
        return run

    def finish(self, run, code=0):
        _, error = run.communicate(timeout=200)
        self.assertEqual(run.returncode, code, error)
        return error

    def expect_nothing_left(self, results):
        end = time.monotonic() + 5
        while (self.cluster.queue() or simulating()) and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual((self.cluster.queue(), simulating()), ([], []))
        self.assertEqual([p.name for p in results.glob("slurm-*")] + [p.name for p in results.glob("*.claim")], [])

    def expect_refused(self, parts, *words, **variables):
        error = self.finish(self.start(*words, *([] if words[0] == "run-simulations" else ["--quiet"]), **variables), 2)
        self.assertEqual(len(error.strip().splitlines()), 1, error)
        for part in parts:
            self.assertIn(part, error)
        self.assertFalse((self.folder / "refused" / "report.json").exists())

    def test_a_diagnosis_survives_the_death_of_a_node(self):
        lamp = self.folder / "lamp"
        subprocess.run(words_of("evidence-virtual-object", "--sample", "pyramid", "--size-mm", 60, "--triangles", 1200, "--scan-shift-x-mm", 1.5, "--points", 300,
                                "--quiet", "--out", lamp), check=True, capture_output=True)
        diagnose = ("evidence-diagnose", "--object", f"{lamp}/", "--triangles", 1200, "--pairs", "off", "--separate", "off")
        results = self.folder / "shared"
        run = self.start(*diagnose, "--engine", "slurm", "--local-seconds", 0.8, "--results", results, "--out", self.folder / "slurm")
        seen = set()

        def both_have_worked():
            self.assertIsNone(run.poll(), run.stderr.read() if run.poll() is not None else "")
            for file in results.glob("slurm-*/*/finished-*"):
                try:
                    seen.update(line.split()[3] for line in file.read_text().splitlines() if len(line.split()) == 4)
                except OSError:
                    pass
            return seen == {"n1", "n2"} and ("RUNNING", "n1") in self.cluster.queue()

        self.cluster.wait_until(both_have_worked, 60, "both nodes to have worked")
        self.cluster.kill_node("n1")
        error = self.finish(run)
        local = self.start(*diagnose, "--quiet", "--out", self.folder / "local")
        self.finish(local)
        answers = [same(json.loads((self.folder / name / "diagnosis.json").read_text())) for name in ("slurm", "local")]
        self.assertEqual(answers[0], answers[1])
        self.assertEqual(answers[0]["verdict"], ["scan_shift"])
        for file in ("profile.json", "residuals.csv"):
            self.assertEqual((self.folder / "slurm" / file).read_bytes(), (self.folder / "local" / file).read_bytes())
        # To the bit; what Slurm's folder has beyond it is the mould.
        kept = {p.name: p.read_bytes() for p in (self.folder / "local" / "simulations").iterdir()}
        for name, content in kept.items():
            self.assertEqual((results / name).read_bytes(), content, name)
        # Both nodes worked before, the other one after, and Slurm started again what was lost.
        self.assertRegex(error, r"Simulations: this computer \d+ done; n1 \d+ done; n2 \d+ done\.")
        done = dict(re.findall(r"(n[12]) (\d+) done", error.splitlines()[-1]))
        self.assertGreater(int(done["n2"]), int(done["n1"]))
        self.assertNotIn("Slurm did not make", error)
        self.assertRegex((self.cluster.folder / "slurmctld.log").read_text(), r"[Rr]equeu\w* .*n1|n1.*[Rr]equeu")
        self.expect_nothing_left(results)
        self.cluster._start("slurmd", "-D", "-N", "n1", name="n1")
        self.cluster.wait_until(lambda: self.cluster.states()["n1"] == "idle", 30, "the killed node to be back")

    def test_what_slurm_gives_up_is_made_here(self):
        results = self.folder / "given-up"
        run = self.start(*PLAN, "--engine", "slurm", "--local-seconds", 0, "--results", results, "--out", self.folder / "plan")
        waiting = []

        def one_waits():
            waiting[:] = [line for line in self.cluster.run("squeue", "--noheader", "--array", "--state=PENDING", "--format=%F_%K").stdout.split() if line]
            return len(waiting) > 2 or run.poll() is not None

        self.cluster.wait_until(one_waits, 60, "a task to wait")
        self.cluster.run("scancel", waiting[-1])
        error = self.finish(run)
        self.assertIn("Slurm did not make 1 of them: this computer did", error)
        self.finish(self.start(*PLAN, "--quiet", "--out", self.folder / "plan-here"))
        answers = [same(json.loads((self.folder / name / "report.json").read_text())) for name in ("plan", "plan-here")]
        self.assertEqual(answers[0], answers[1])
        self.expect_nothing_left(results)

    def test_a_cancelled_run_leaves_nothing_running(self):
        results = self.folder / "cancelled"
        run = self.start(*PLAN, "--engine", "slurm", "--local-seconds", 0, "--results", results, "--out", self.folder / "never")
        self.cluster.wait_until(lambda: any(state == "RUNNING" for state, *_ in self.cluster.queue()), 60, "a task to run")
        run.send_signal(signal.SIGTERM)
        self.finish(run, 130)
        self.assertEqual(self.cluster.queue(), [])
        self.expect_nothing_left(results)
        # What was made is kept: the same command goes on from there.
        self.assertTrue(any(len(p.name) == 64 for p in results.iterdir()))

    def test_tasks_that_all_fail_are_one_sentence(self):
        results = self.folder / "torn"
        run = self.start(*PLAN, "--engine", "slurm", "--local-seconds", 0, "--quiet", "--results", results, "--out", self.folder / "refused")

        def removed():
            for file in results.glob("slurm-*/*/tasks"):
                file.unlink()
                return True
            return run.poll() is not None

        self.cluster.wait_until(removed, 30, "the list of tasks")
        error = self.finish(run, 2)
        self.assertEqual(len(error.strip().splitlines()), 1, error)
        self.assertIn("came back, and a task says \"There is no file", error)
        self.expect_nothing_left(results)

    def test_what_is_wrong_is_said(self):
        slurm = (*PLAN, "--out", self.folder / "refused", "--engine", "slurm")
        empty = self.folder / "empty"
        empty.mkdir()
        self.expect_refused(["--engine slurm", "no sbatch on the PATH"], *slurm, PATH=str(empty))
        self.expect_refused(["Invalid partition", "--slurm-option", "SBATCH_", "sinfo"], *slurm, "--slurm-option", "--partition=nowhere")
        self.expect_refused(["Invalid partition"], *slurm, SBATCH_PARTITION="nowhere")
        self.expect_refused(["unrecognized option '--nonsense'"], *slurm, "--slurm-option=--nonsense")
        self.expect_refused(["one option of sbatch"], *slurm, "--slurm-option", "partition")
        file = self.folder / "file"
        file.write_text("")
        self.expect_refused(["--results", "every node"], *slurm, "--results", file / "below")
        self.expect_refused(["--engine must be local or slurm"], *PLAN, "--out", self.folder / "refused", "--engine", "pbs")
        self.expect_refused(["--local-seconds must be a number"], *slurm, "--local-seconds", "soon")
        self.expect_refused(["belongs to --engine slurm"], *PLAN, "--out", self.folder / "refused", "--local-seconds", 1)
        # The task's own command, as Slurm starts it.
        self.expect_refused(["SLURM_ARRAY_TASK_ID"], "run-simulations", "--results", empty, "--tasks", file)
        self.expect_refused(["cut short or altered"], "run-simulations", "--results", empty, "--tasks", file, SLURM_ARRAY_TASK_ID="0")


if __name__ == "__main__":
    if missing := missing_programs():
        print(f"SKIPPED: there is no {', '.join(missing)}, so nothing of --engine slurm is tested. Install Debian's slurm-wlm: setup/all.sh --test.", file=sys.stderr)
        sys.exit(77)
    unittest.main(verbosity=2)
