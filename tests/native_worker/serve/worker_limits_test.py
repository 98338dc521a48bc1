#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What others on this computer cannot do to the worker, and its solver process to the computer. Usage: worker_limits_test.py PROGRAM"""
import json
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from worker_case import LONG, PROGRAM, PYRAMID
from worker import PageSocket, Worker, eventually


class Strangers(unittest.TestCase):
    """Others on this computer, who do not have the token."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.worker = Worker(PROGRAM, pathlib.Path(self.folder.name) / "data")

    def tearDown(self):
        self.worker.stop()
        self.folder.cleanup()

    def answers_soon(self) -> None:
        for _ in range(5):
            start = time.monotonic()
            self.assertEqual(self.worker.request("GET", "/api/status")[0], 200)
            self.assertLess(time.monotonic() - start, 2)

    def test_idle_and_slow_connections_do_not_shut_the_page_out(self):
        page = PageSocket(self.worker, self.worker.token)
        idle = [socket.create_connection(("127.0.0.1", self.worker.port), timeout=10) for _ in range(500)]
        self.answers_soon()
        slow = [socket.create_connection(("127.0.0.1", self.worker.port), timeout=10) for _ in range(100)]
        for letter in "GET / HTTP/1.1":
            for connection in slow:
                try:
                    connection.sendall(letter.encode())
                except OSError:  # closed for others
                    pass
            self.answers_soon()
        # Those that had shown the token stay.
        job = self.worker.post_job(operation="import", inputs=PYRAMID, outputs=[])
        self.assertEqual(page.receive()["id"], job)
        for connection in idle + slow:
            connection.close()

    def test_a_connection_that_says_nothing_is_closed(self):
        start = time.monotonic()
        with socket.create_connection(("127.0.0.1", self.worker.port), timeout=60) as silent:
            self.assertEqual(silent.recv(1), b"")
        self.assertGreater(time.monotonic() - start, 3)  # not at once: a browser connects before it knows what to ask

    def test_clients_that_ask_for_files_do_not_use_up_the_page_s_requests(self):
        over = threading.Event()

        def ask() -> None:
            while not over.is_set():
                try:
                    self.worker.request("GET", "/picture.png", token=None)
                except OSError:  # closed for others
                    pass
        clients = [threading.Thread(target=ask) for _ in range(6)]
        for client in clients:
            client.start()
        try:
            end = time.monotonic() + 3
            while time.monotonic() < end:
                self.answers_soon()
                time.sleep(0.02)  # a page asks less often, and its own requests have their limit, too
        finally:
            over.set()
            for client in clients:
                client.join()

    def test_requests_of_other_sites_are_refused(self):
        for site, status in (("same-origin", 200), ("none", 200), ("cross-site", 403), ("same-site", 403)):
            self.assertEqual(self.worker.request("GET", "/api/status", headers={"Sec-Fetch-Site": site})[0], status, site)
        self.assertEqual(self.worker.request("GET", "/picture.png", headers={"Sec-Fetch-Site": "cross-site"}, token=None)[0], 403)

    def test_bodies_are_as_long_as_what_they_are_for(self):
        job, machine = "/api/jobs/" + "0" * 32 + "/cancel", "/api/machines/" + "0" * 16 + "/print"
        for path, length, status in ((job, 100, 404), (job, 5000, 413), (machine, 5000, 404), (machine, 70_000, 413)):
            self.assertEqual(self.worker.request("POST", path, b" " * length)[0], status, (path, length))


class Solver(unittest.TestCase):
    """The process in which jobs run, and what it may do."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.data = pathlib.Path(self.folder.name) / "data"

    def tearDown(self):
        self.folder.cleanup()

    def worker(self, *flags: str, **options) -> Worker:
        worker = Worker(PROGRAM, self.data, *flags, **options)
        self.addCleanup(worker.stop)
        return worker

    def test_it_is_limited(self):
        worker = self.worker("--solver-memory-mb", "3000")
        job = worker.post_job(**LONG)
        worker.wait_running(job)
        process = pathlib.Path(f"/proc/{worker.job_process()}")
        self.assertTrue(eventually(lambda: re.search(r"Seccomp:\s+2\n", (process / "status").read_text())))
        limits = (process / "limits").read_text()
        for name, value in (("Max address space", 3000 << 20), ("Max core file size", 0), ("Max file size", 16 << 30)):
            self.assertRegex(limits, rf"{name} +{value} +{value} ")
        self.assertIn("NoNewPrivs:\t1\n", (process / "status").read_text())
        self.assertEqual((process / "oom_score_adj").read_text().strip(), "500")
        self.assertEqual((process / "stat").read_text().rsplit(")", 1)[1].split()[16], "10")  # nice, proc(5)

    def test_a_job_without_memory_is_said_and_the_next_one_runs(self):
        worker = self.worker("--solver-memory-mb", "400")
        for _ in range(2):
            failed = worker.wait(worker.post_job(**LONG))
            self.assertEqual((failed["state"], failed["error"]["code"]), ("failed", "out_of_memory"), failed)
            self.assertRegex(failed["error"]["message"], r"400 MB\): use a smaller model, or .* --solver-memory-mb\.$")
        self.assertEqual(worker.wait(worker.post_job(operation="import", inputs=PYRAMID))["state"], "done")

    def test_a_job_has_its_time(self):
        worker = self.worker("--max-job-minutes", "0.02")
        failed = worker.wait(worker.post_job(**LONG))
        self.assertEqual(failed["state"], "failed", failed)
        self.assertIn("after 0.02 min: use a smaller model, or start the worker with a larger --max-job-minutes.", failed["error"]["message"])
        self.assertEqual(worker.wait(worker.post_job(operation="import", inputs=PYRAMID))["state"], "done")

    def run_by_hand(self, outputs: pathlib.Path, *flags: str) -> dict:
        """What the solver process says of a job whose outputs go there."""
        for folder in (self.data / "blobs", self.data / "jobs", outputs):
            folder.mkdir(parents=True, exist_ok=True)
        solver = subprocess.Popen([PROGRAM, "run-jobs", "--data", str(self.data), *flags], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        request = {"run": "x", "job": {"operation": "import", "inputs": PYRAMID}, "blobs": {}, "outputs": str(outputs), "results": str(self.data / "results")}
        solver.stdin.write(json.dumps(request) + "\n")
        solver.stdin.flush()
        answers = (json.loads(line) for line in solver.stdout)
        answer = next(a for a in answers if "finished" in a)
        solver.stdin.close()
        solver.wait(10)
        solver.stdout.close()
        return answer

    def test_it_writes_into_its_own_folders_only(self):
        self.assertIn("report", self.run_by_hand(self.data / "jobs" / "x" / "outputs")["result"])
        elsewhere = pathlib.Path(self.folder.name) / "elsewhere"
        self.assertIn("report", self.run_by_hand(elsewhere, "--no-solver-sandbox")["result"])
        worker = self.worker(stderr=subprocess.PIPE)
        if "Landlock" in self.said_at_start(worker).split("not available")[0]:
            self.assertIn("cannot be written", self.run_by_hand(elsewhere / "inner").get("not_kept", ""))

    def said_at_start(self, worker: Worker) -> str:
        said = next(line for line in worker.process.stderr if line.startswith("solver sandbox: "))
        self.addCleanup(worker.process.stderr.close)
        return said

    def test_what_the_computer_does_not_have_is_said_and_jobs_run_all_the_same(self):
        before = (sys.executable, str(pathlib.Path(__file__).parent / "without_sandbox.py"))
        worker = self.worker(before=before, stderr=subprocess.PIPE)
        self.assertRegex(self.said_at_start(worker), r"^solver sandbox: memory limit \d+ MB, 24 h a job, not available: Landlock, system call filter$")
        self.assertEqual(worker.wait(worker.post_job(operation="relief", inputs=PYRAMID))["state"], "done")

    def test_root_is_warned(self):
        worker = self.worker(stderr=subprocess.PIPE)
        first = worker.process.stderr.readline()
        self.addCleanup(worker.process.stderr.close)
        self.assertEqual("runs as root" in first, os.geteuid() == 0, first)

    def test_what_is_kept_is_for_its_owner_alone(self):
        os.umask(0o022)
        self.data.mkdir(mode=0o755)
        (self.data / "blobs").mkdir(mode=0o755)
        (self.data / "blobs" / ("a" * 64)).write_bytes(b"of an earlier version")
        add = [PROGRAM, "machine", "add", "--data", str(self.data), "--name", "Laser", "--url", "serial:/dev/ttyUSB7"]
        self.assertEqual(subprocess.run(add, capture_output=True).returncode, 0)
        worker = self.worker()
        self.assertEqual(worker.wait(worker.post_job(operation="relief", inputs=PYRAMID))["state"], "done")
        worker.put_blob(b"mesh")
        for path in (self.data, *self.data.rglob("*")):
            self.assertEqual(path.stat().st_mode & 0o777, 0o700 if path.is_dir() else 0o600, path)
        # What the person asked for has the rights that they give to their files.
        out = pathlib.Path(self.folder.name) / "out"
        subprocess.run([PROGRAM, "import", "--sample", "pyramid", "--out", str(out)], check=True, capture_output=True)
        self.assertEqual({path.stat().st_mode & 0o777 for path in out.iterdir()}, {0o644})


if __name__ == "__main__":
    unittest.main(verbosity=2)
