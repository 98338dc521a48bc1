#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The native worker: jobs and results, what it refuses, and what it survives. Usage: worker_test.py PROGRAM"""
import json
import os
import pathlib
import random
import signal
import socket
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from worker import PageSocket, Worker

PROGRAM = sys.argv.pop(1)
PYRAMID = {"mesh": {"sample": "pyramid", "vertices": 1500}}
LONG = {"operation": "relief", "parameters": {"thickness_mm": 1}, "inputs": {"mesh": {"sample": "bust", "vertices": 400000}}, "outputs": []}


class WorkerCase(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.data = pathlib.Path(self.folder.name) / "data"
        self.worker = Worker(PROGRAM, self.data, "--upload-limit-mb", "2")

    def tearDown(self):
        self.worker.stop()
        self.folder.cleanup()


class Jobs(WorkerCase):
    def test_a_job_runs_and_its_outputs_can_be_read(self):
        job = self.worker.post_job(operation="relief", parameters={"thickness_mm": 4}, inputs=PYRAMID)
        detail = self.worker.wait(job)
        self.assertEqual(detail["state"], "done", detail)
        self.assertAlmostEqual(detail["result"]["report"]["size_mm"][2], 7)
        for name, output in detail["result"]["outputs"].items():
            status, body, headers = self.worker.request("GET", f"/api/jobs/{job}/outputs/{name}")
            self.assertEqual(status, 200)
            self.assertEqual(len(body), output["bytes"])
            self.assertEqual(headers["Content-Type"], output["media_type"])
            import hashlib
            self.assertEqual(hashlib.sha256(body).hexdigest(), output["sha256"])

    def test_the_catalog_is_the_command_lines(self):
        import subprocess
        status, catalog = self.worker.json("GET", "/api/catalog")
        self.assertEqual(status, 200)
        self.assertEqual(catalog, json.loads(subprocess.check_output([PROGRAM, "describe"])))

    def test_a_blob_travels_once(self):
        obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        name = self.worker.put_blob(obj)
        self.assertEqual(self.worker.request("HEAD", f"/api/blobs/{name}")[0], 200)
        self.assertEqual(self.worker.request("GET", f"/api/blobs/{name}")[1], obj)
        job = self.worker.post_job(operation="import", inputs={"mesh": {"sha256": name, "file_name": "tetra.obj"}})
        self.assertEqual(self.worker.wait(job)["result"]["report"]["faces"], 4)

    def test_progress_and_the_end_arrive_on_the_socket(self):
        page = PageSocket(self.worker, self.worker.token)
        self.assertEqual(page.status, 101)
        job = self.worker.post_job(operation="relief", inputs={"mesh": {"sample": "bust", "vertices": 8000}}, outputs=["relief.ply"])
        fractions = []
        while True:
            message = page.receive()
            self.assertEqual(message["id"], job)
            if message["type"] == "finished":
                break
            fractions.append(message["fraction"])
        self.assertEqual(message["state"], "done", message)
        self.assertEqual(fractions, sorted(fractions))
        self.assertGreater(len(fractions), 2)

    def test_cancel_over_the_socket_and_over_http(self):
        page = PageSocket(self.worker, self.worker.token)
        first, second = self.worker.post_job(**LONG), self.worker.post_job(**LONG)
        self.worker.wait_running(first)
        asked = time.monotonic()
        page.send({"type": "cancel", "id": first})
        self.assertEqual(self.worker.wait(first)["state"], "cancelled")
        self.assertLess(time.monotonic() - asked, 2.5)
        self.assertEqual(self.worker.request("POST", f"/api/jobs/{second}/cancel")[0], 202)
        self.assertEqual(self.worker.wait(second)["state"], "cancelled")

    def test_a_wrong_job_is_refused_before_it_is_queued(self):
        for job, where in (({"operation": "rleief"}, "operation"), ({"operation": "relief", "inputs": PYRAMID, "parameters": {"thickness_mm": -1}}, "thickness_mm"),
                           ({"operation": "relief"}, "mesh"), ({"operation": "relief", "inputs": {"mesh": {"sha256": "0" * 64}}}, "mesh"),
                           ({"operation": "relief", "inputs": {"mesh": {"sha256": "../../etc/passwd"}}}, "mesh"),
                           ({"operation": "relief", "inputs": PYRAMID, "outputs": ["../x"]}, "outputs")):
            status, answer = self.worker.json("POST", "/api/jobs", job)
            self.assertEqual(status, 422, answer)
            self.assertEqual(answer["error"]["where"], where, answer)
        self.assertEqual(self.worker.request("POST", "/api/jobs", b"{not json")[0], 400)
        self.assertEqual(self.worker.json("GET", "/api/jobs")[1], [])


class Refusals(WorkerCase):
    def test_host_origin_and_token(self):
        port = self.worker.port
        self.assertEqual(self.worker.request("GET", "/api/status")[0], 200)
        self.assertEqual(self.worker.request("GET", "/api/status", headers={"Origin": f"http://localhost:{port}"})[0], 200)
        for host in ("evil.example", f"evil.example:{port}", "127.0.0.1", f"127.0.0.1:{port + 1}", f"127.0.0.1:{port}.evil.example", ""):
            for path in ("/api/status", "/", "/index.html"):
                self.assertEqual(self.worker.request("GET", path, headers={"Host": host})[0], 421, host)
        for origin in ("http://evil.example", f"https://127.0.0.1:{port}", "null", f"http://127.0.0.1:{port}.evil.example"):
            self.assertEqual(self.worker.request("GET", "/api/status", headers={"Origin": origin})[0], 403, origin)
        for token in (None, "", "0" * 48, self.worker.token[:-1], self.worker.token + "0"):
            for method, path in (("GET", "/api/status"), ("GET", "/api/catalog"), ("GET", "/api/jobs"), ("POST", "/api/jobs"), ("PUT", "/api/blobs/" + "0" * 64)):
                self.assertEqual(self.worker.request(method, path, b"{}" if method != "GET" else None, token=token)[0], 401, (token, path))

    def test_the_socket_is_guarded_alike(self):
        self.assertEqual(PageSocket(self.worker, "0" * 48).status, 401)
        self.assertEqual(PageSocket(self.worker, self.worker.token, origin="http://evil.example").status, 403)
        self.assertEqual(PageSocket(self.worker, self.worker.token, host="evil.example").status, 421)
        self.assertEqual(PageSocket(self.worker, self.worker.token).status, 101)

    def test_it_binds_the_loopback_address_only(self):
        tables = pathlib.Path("/proc/net/tcp").read_text().splitlines() + pathlib.Path("/proc/net/tcp6").read_text().splitlines()
        addresses = {line.split()[1] for line in tables if line.split()[1].endswith(f":{self.worker.port:04X}") and line.split()[3] == "0A"}
        self.assertEqual(addresses, {f"0100007F:{self.worker.port:04X}"})

    def test_uploads_are_limited_and_checked(self):
        self.assertEqual(self.worker.request("PUT", "/api/blobs/" + "0" * 64, b"not what it says")[0], 422)
        try:
            status = self.worker.request("PUT", "/api/blobs/" + "0" * 64, bytes(3 << 20))[0]
            self.assertEqual(status, 413)
        except (BrokenPipeError, ConnectionResetError):
            pass  # it stopped reading, as it should
        self.assertEqual(self.worker.request("POST", "/api/jobs", bytes(2 << 20))[0], 413)
        self.assertEqual(list((self.data / "blobs").iterdir()), [])
        self.assertEqual(list((self.data / "uploads").iterdir()), [])

    def test_nothing_outside_is_readable(self):
        for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/api/blobs/../jobs", "/api/jobs/../../x",
                     "/api/jobs/" + "0" * 32 + "/outputs/../job.json"):
            self.assertIn(self.worker.request("GET", path)[0], (404, 400), path)

    def test_reading_has_no_side_effects(self):
        job = self.worker.post_job(operation="import", inputs=PYRAMID)
        self.worker.wait(job)
        for path in (f"/api/jobs/{job}/cancel", f"/api/jobs/{job}/delete"):
            self.assertEqual(self.worker.request("GET", path)[0], 404)
        self.assertEqual(self.worker.json("GET", f"/api/jobs/{job}")[1]["state"], "done")

    def test_noise_and_many_connections_leave_it_standing(self):
        noise = random.Random(5)
        for _ in range(150):
            with socket.create_connection(("127.0.0.1", self.worker.port), timeout=10) as raw:
                raw.sendall(noise.randbytes(noise.randrange(1, 400)) + b"\r\n\r\n")
        held = [socket.create_connection(("127.0.0.1", self.worker.port), timeout=10) for _ in range(100)]
        for connection in held:
            connection.close()
        for frame in (noise.randbytes(200), b"\x81\xff" + b"\xff" * 8, b"\xff" * 64):
            page = PageSocket(self.worker, self.worker.token)
            page.socket.sendall(frame)
            page.socket.close()
        page = PageSocket(self.worker, self.worker.token)
        page.send_frame(0x81, b"{" * 100, claimed_length=1 << 40)
        for message in ([], {"type": "cancel"}, {"type": "cancel", "id": 5}, {"type": "cancel", "id": "x"}):
            other = PageSocket(self.worker, self.worker.token)
            other.send(message)
            other.socket.close()
        time.sleep(0.3)
        self.assertEqual(self.worker.request("GET", "/api/status")[0], 200)


class Survival(WorkerCase):
    def test_a_killed_job_process_costs_that_job_only(self):
        victim = self.worker.post_job(**LONG)
        self.worker.wait_running(victim)
        waiting = self.worker.post_job(operation="import", inputs=PYRAMID)
        time.sleep(0.2)
        os.kill(self.worker.job_process(), signal.SIGKILL)
        detail = self.worker.wait(victim)
        self.assertEqual(detail["state"], "failed")
        self.assertEqual(detail["error"]["code"], "out_of_memory")
        self.assertEqual(self.worker.wait(waiting)["state"], "done")

    def test_a_crash_in_a_job_is_said(self):
        victim = self.worker.post_job(**LONG)
        self.worker.wait_running(victim)
        time.sleep(0.2)
        os.kill(self.worker.job_process(), signal.SIGSEGV)
        self.assertEqual(self.worker.wait(victim)["error"]["code"], "internal")

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

    def test_half_a_folder_from_a_crash_is_not_a_job(self):
        self.worker.stop()
        broken = self.data / "jobs" / ("a" * 32)
        broken.mkdir(parents=True)
        (broken / "job.json").write_text('{"state": "queu')
        self.worker = Worker(PROGRAM, self.data)
        self.assertEqual(self.worker.json("GET", "/api/jobs")[1], [])

    def test_a_finished_job_can_be_forgotten(self):
        job = self.worker.post_job(operation="import", inputs=PYRAMID)
        self.worker.wait(job)
        self.assertEqual(self.worker.request("DELETE", f"/api/jobs/{job}")[0], 204)
        self.assertEqual(self.worker.request("GET", f"/api/jobs/{job}")[0], 404)
        self.assertFalse((self.data / "jobs" / job).exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
