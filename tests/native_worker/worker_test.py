#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The native worker: jobs and results, what it refuses, and what it survives. Usage: worker_test.py PROGRAM"""
import hashlib
import http.client
import json
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from worker import PageSocket, Worker, eventually, ignores, runs_jobs, sockets_of

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
            self.assertEqual(hashlib.sha256(body).hexdigest(), output["sha256"])

    def test_the_catalog_is_the_command_lines(self):
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
        page.send({"type": "cancel", "id": first})
        self.assertEqual(self.worker.wait(first)["state"], "cancelled")
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
        # Refused for its length alone, yet the client that sends on hears why.
        self.assertEqual(self.worker.request("PUT", "/api/blobs/" + "0" * 64, bytes(20 << 20))[0], 413)
        self.assertEqual(self.worker.request("POST", "/api/jobs", bytes(2 << 20))[0], 413)
        self.assertEqual(list((self.data / "blobs").iterdir()), [])
        self.assertEqual(list((self.data / "uploads").iterdir()), [])

    def test_a_body_without_a_length_is_limited_too(self):
        for path, method in (("/api/jobs", "POST"), ("/api/blobs/" + "0" * 64, "PUT")):
            connection = http.client.HTTPConnection("127.0.0.1", self.worker.port, timeout=60)
            connection.request(method, path, iter([bytes(1 << 18)] * 16), {"Authorization": "Bearer " + self.worker.token}, encode_chunked=True)
            self.assertEqual(connection.getresponse().status, 413, path)
            connection.close()
        self.assertEqual(list((self.data / "uploads").iterdir()), [])

    def test_a_client_that_asks_first_is_told_to_go_on(self):
        with socket.create_connection(("127.0.0.1", self.worker.port), timeout=10) as raw:
            name = hashlib.sha256(b"mesh").hexdigest()
            raw.sendall(f"PUT /api/blobs/{name} HTTP/1.1\r\nHost: 127.0.0.1:{self.worker.port}\r\nAuthorization: Bearer {self.worker.token}\r\n"
                        "Content-Length: 4\r\nExpect: 100-continue\r\nConnection: close\r\n\r\n".encode())
            self.assertEqual(raw.recv(1000), b"HTTP/1.1 100 Continue\r\n\r\n")
            raw.sendall(b"mesh")
            self.assertTrue(raw.recv(1000).startswith(b"HTTP/1.1 201"))

    def test_an_upload_that_breaks_off_leaves_nothing(self):
        name = hashlib.sha256(b"x").hexdigest()
        half = (f"PUT /api/blobs/{name} HTTP/1.1\r\nHost: 127.0.0.1:{self.worker.port}\r\nAuthorization: Bearer {self.worker.token}\r\n"
                "Content-Length: 1000\r\n\r\nhalf").encode()
        uploads = self.data / "uploads"
        with socket.create_connection(("127.0.0.1", self.worker.port), timeout=10) as raw:
            raw.sendall(half)
            self.assertTrue(eventually(lambda: list(uploads.iterdir())))
        self.assertTrue(eventually(lambda: not list(uploads.iterdir())))
        with socket.create_connection(("127.0.0.1", self.worker.port), timeout=10) as raw:
            raw.sendall(half)
            raw.shutdown(socket.SHUT_WR)  # says no more, but listens
            self.assertTrue(raw.recv(1000).startswith(b"HTTP/1.1 400"))
        self.assertEqual(list(uploads.iterdir()), [])
        self.assertEqual(self.worker.request("HEAD", f"/api/blobs/{name}")[0], 404)

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


class Page(unittest.TestCase):
    def test_the_built_page_is_served_isolated_and_cached_by_name(self):
        with tempfile.TemporaryDirectory() as name:
            web = pathlib.Path(name) / "web"
            (web / "assets").mkdir(parents=True)
            (web / "index.html").write_text("<!doctype html>")
            (web / "assets" / "a-1234.js").write_text("export {};")
            (web / "solver.wasm").write_bytes(b"\0asm")
            (pathlib.Path(name) / "web-beside").mkdir()
            (pathlib.Path(name) / "web-beside" / "secret.txt").write_text("secret")
            (web / "link.txt").symlink_to(pathlib.Path(name) / "web-beside" / "secret.txt")
            worker = Worker(PROGRAM, pathlib.Path(name) / "data", "--web", str(web))
            try:
                for path, kind, cache in (("/", "text/html; charset=utf-8", "no-cache"), ("/?x=1", "text/html; charset=utf-8", "no-cache"),
                                          ("/assets/a-1234.js", "text/javascript", "public, max-age=31536000, immutable"), ("/solver.wasm", "application/wasm", "no-cache")):
                    status, body, headers = worker.request("GET", path, token=None)
                    self.assertEqual(status, 200, path)
                    self.assertEqual(headers["Content-Type"], kind)
                    self.assertEqual(headers["Cache-Control"], cache)
                    self.assertEqual(headers["Cross-Origin-Opener-Policy"], "same-origin")
                    self.assertEqual(headers["Cross-Origin-Embedder-Policy"], "require-corp")
                    self.assertIn("script-src 'self' 'wasm-unsafe-eval';", headers["Content-Security-Policy"])
                    self.assertIn(f"ws://127.0.0.1:{worker.port}", headers["Content-Security-Policy"])
                    head = worker.request("HEAD", path, token=None)
                    self.assertEqual((head[0], head[1], head[2]["Content-Length"]), (200, b"", str(len(body))))
                for path in ("/link.txt", "/../web-beside/secret.txt", "/assets/../../web-beside/secret.txt", "/absent.js"):
                    self.assertEqual(worker.request("GET", path, token=None)[0], 404, path)
                self.assertEqual(worker.request("POST", "/", b"x", token=None)[0], 405)
            finally:
                worker.stop()


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
