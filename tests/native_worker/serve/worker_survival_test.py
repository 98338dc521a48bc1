#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the native worker and its jobs survive: kills, restarts, a closed terminal, an altered disk. Usage: worker_survival_test.py PROGRAM"""
import http.client
import json
import os
import pathlib
import signal
import subprocess
import time
import unittest

from worker_case import LONG, PROGRAM, PYRAMID, WorkerCase
from worker import Worker, eventually, ignores, runs_jobs, sockets_of


class Survival(WorkerCase):
    def test_a_killed_job_process_costs_no_job(self):
        victim = self.worker.post_job(**LONG)
        for _ in range(3):
            self.worker.wait_running(victim)
            os.kill(self.worker.job_process(), signal.SIGKILL)
            self.assertTrue(eventually(lambda: self.worker.json("GET", f"/api/jobs/{victim}")[1]["state"] == "queued"))
        waiting = self.worker.post_job(operation="import", inputs=PYRAMID)
        self.worker.wait_running(victim)
        self.worker.request("POST", f"/api/jobs/{victim}/cancel")
        self.assertEqual(self.worker.wait(victim)["state"], "cancelled")
        self.assertEqual(self.worker.wait(waiting)["state"], "done")
        self.assertFalse((self.data / "jobs" / victim / "outputs").exists())

    def test_the_job_process_holds_no_socket_of_a_page(self):
        # It would keep the line open after the worker has closed it, and the browser would wait on it for ever.
        line = http.client.HTTPConnection("127.0.0.1", self.worker.port, timeout=60)
        line.request("GET", "/api/status", headers={"Authorization": "Bearer " + self.worker.token})
        line.getresponse().read()
        victim = self.worker.post_job(**LONG)
        self.worker.wait_running(victim)
        os.kill(self.worker.job_process(), signal.SIGKILL)  # the next one is born while the line is open
        self.assertTrue(eventually(lambda: self.worker.json("GET", f"/api/jobs/{victim}")[1]["state"] == "queued"))
        self.worker.wait_running(victim)
        child = self.worker.job_process()
        # What is to be closed on exec goes a moment after the program has its new name.
        self.assertTrue(eventually(lambda: not sockets_of(child)))
        self.assertTrue(runs_jobs(child))
        self.assertGreaterEqual(len(sockets_of(self.worker.process.pid)), 2)  # it listens, and holds the line: they would have been seen
        line.close()

    def test_a_job_that_crashes_twice_fails_and_costs_no_other(self):
        victim = self.worker.post_job(**LONG)
        waiting = self.worker.post_job(operation="import", inputs=PYRAMID)
        for _ in range(2):
            self.worker.wait_running(victim)
            child = self.worker.job_process()
            self.assertTrue(eventually(lambda: ignores(child, signal.SIGINT)))  # it is set up
            os.kill(child, signal.SIGSEGV)
            self.assertTrue(eventually(lambda: not runs_jobs(child)))
        detail = self.worker.wait(victim)
        self.assertEqual(detail["state"], "failed")
        self.assertEqual(detail["error"]["code"], "internal")
        self.assertEqual(self.worker.wait(waiting)["state"], "done")

    def test_queue_and_results_survive_a_restart(self):
        done = self.worker.post_job(operation="import", inputs=PYRAMID)
        before = self.worker.wait(done)
        running = self.worker.post_job(**LONG)
        self.worker.wait_running(running)
        queued = self.worker.post_job(operation="import", inputs=PYRAMID)
        os.kill(self.worker.process.pid, signal.SIGKILL)  # no chance to tidy up
        self.worker.process.wait()
        self.worker = Worker(PROGRAM, self.data, "--upload-limit-mb", "2")
        after = self.worker.json("GET", f"/api/jobs/{done}")[1]
        self.assertEqual(after["result"], before["result"])
        self.worker.wait_running(running)
        self.worker.request("POST", f"/api/jobs/{running}/cancel")
        self.assertEqual(self.worker.wait(running)["state"], "cancelled")
        self.assertEqual(self.worker.wait(queued)["state"], "done")

    def test_restarts_do_not_wear_a_job_out(self):
        running = self.worker.post_job(**LONG)
        for _ in range(4):
            self.worker.wait_running(running)
            self.worker.stop()
            self.worker = Worker(PROGRAM, self.data)
        self.worker.wait_running(running)

    def test_a_killed_worker_does_not_wear_a_job_out_and_takes_its_solver_with_it(self):
        running = self.worker.post_job(**LONG)
        for _ in range(4):
            self.worker.wait_running(running)
            child = self.worker.job_process()
            self.worker.process.kill()
            self.worker.process.wait()
            self.worker.process.stdout.close()
            self.worker = Worker(PROGRAM, self.data)
            self.assertFalse(runs_jobs(child))  # the new worker has waited for its end
        self.worker.wait_running(running)

    def test_a_closed_terminal_costs_no_job(self):
        job = self.worker.post_job(**LONG)
        self.worker.wait_running(job)
        child = self.worker.job_process()
        self.assertTrue(eventually(lambda: ignores(child, signal.SIGINT)))  # it is set up
        os.kill(child, signal.SIGHUP)  # all that ran in the terminal hears of it
        time.sleep(0.3)
        self.assertTrue(runs_jobs(child))
        self.assertEqual(self.worker.json("GET", f"/api/jobs/{job}")[1]["state"], "running")
        self.worker.process.send_signal(signal.SIGHUP)
        self.assertEqual(self.worker.process.wait(10), 0)
        self.worker.process.stdout.close()
        self.worker = Worker(PROGRAM, self.data)
        self.worker.wait_running(job)

    def test_nohup_stays_nohup(self):
        self.worker.stop()
        self.worker = Worker(PROGRAM, self.data, before=("nohup",))
        self.worker.process.send_signal(signal.SIGHUP)
        time.sleep(0.5)
        self.assertEqual(self.worker.request("GET", "/api/status")[0], 200)

    def refused_start(self, *flags: str) -> str:
        run = subprocess.run([PROGRAM, "serve", *flags], capture_output=True, text=True, timeout=60)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertEqual(run.stdout, "")
        self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
        return run.stderr

    def test_a_port_or_a_folder_in_use_is_said(self):
        other = str(pathlib.Path(self.folder.name) / "other")
        self.assertIn(f"Port {self.worker.port}", self.refused_start("--port", str(self.worker.port), "--data", other))
        self.assertIn("Another worker", self.refused_start("--port", "0", "--data", str(self.data)))
        self.assertIn("--port", self.refused_start("--port", "70000"))
        self.assertIn("no flag --prot", self.refused_start("--prot", "1"))

    def test_a_folder_is_free_again_however_the_worker_ended(self):
        for end in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL):
            job = self.worker.post_job(**LONG)
            self.worker.wait_running(job)
            child = self.worker.job_process()
            self.worker.process.send_signal(end)
            self.assertEqual(self.worker.process.wait(10), 0 if end != signal.SIGKILL else -9)
            self.worker = Worker(PROGRAM, self.data)
            self.worker.request("POST", f"/api/jobs/{job}/cancel")
            self.assertTrue(eventually(lambda: not runs_jobs(child)))

    def test_a_job_that_was_never_accepted_is_swept_and_an_altered_one_is_said(self):
        self.worker.stop()
        jobs = self.data / "jobs"
        (jobs / ("a" * 32) / "outputs").mkdir(parents=True)
        (jobs / ("a" * 32) / "job.json.part-1-1").write_text('{"state": "queu')
        (jobs / ("b" * 32)).mkdir()
        (jobs / ("b" * 32) / "job.json").write_text('{"state": "queu')
        self.worker = Worker(PROGRAM, self.data)
        listed = self.worker.json("GET", "/api/jobs")[1]
        self.assertEqual([(job["id"], job["state"]) for job in listed], [("b" * 32, "failed")])
        self.assertIn("altered", self.worker.json("GET", "/api/jobs/" + "b" * 32)[1]["error"]["message"])
        self.assertFalse((jobs / ("a" * 32)).exists())

    def test_what_was_altered_on_the_disk_is_never_served(self):
        def alter(path: pathlib.Path) -> None:
            content = bytearray(path.read_bytes())
            content[len(content) // 2] ^= 1
            path.write_bytes(content)

        obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        blob = self.worker.put_blob(obj)
        message = {"operation": "import", "inputs": {"mesh": {"sha256": blob, "file_name": "tetra.obj"}}}
        job = self.worker.post_job(**message)
        name = next(iter(self.worker.wait(job)["result"]["outputs"]))
        output = f"/api/jobs/{job}/outputs/{name}"
        self.assertEqual(self.worker.request("GET", output)[0], 200)
        alter(self.data / "jobs" / job / "outputs" / name)
        status, body, _ = self.worker.request("GET", output)
        self.assertEqual(status, 410)
        self.assertIn(name, json.loads(body)["error"]["message"])
        # A job does not take the altered bytes, and the page is asked for them again.
        alter(self.data / "blobs" / blob)
        detail = self.worker.wait(self.worker.post_job(**message))
        self.assertEqual((detail["state"], detail["error"]["where"]), ("failed", "mesh"))
        self.assertIn("altered", detail["error"]["message"])
        self.assertEqual(self.worker.request("HEAD", f"/api/blobs/{blob}")[0], 404)
        self.worker.put_blob(obj)
        alter(self.data / "blobs" / blob)
        self.assertEqual(self.worker.request("GET", f"/api/blobs/{blob}")[0], 404)
        self.worker.put_blob(obj)
        self.assertEqual(self.worker.wait(self.worker.post_job(**message))["state"], "done")
        # An altered result is none: the job runs again.
        self.worker.stop()
        alter(self.data / "jobs" / job / "result.json")
        self.worker = Worker(PROGRAM, self.data)
        self.assertEqual(self.worker.wait(job)["state"], "done")
        self.assertEqual(self.worker.request("GET", output)[0], 200)

    def test_a_finished_job_can_be_forgotten(self):
        job = self.worker.post_job(operation="import", inputs=PYRAMID)
        self.worker.wait(job)
        self.assertEqual(self.worker.request("DELETE", f"/api/jobs/{job}")[0], 204)
        self.assertEqual(self.worker.request("GET", f"/api/jobs/{job}")[0], 404)
        self.assertFalse((self.data / "jobs" / job).exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
