#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The native worker: jobs and results, and the page it serves. Usage: worker_test.py PROGRAM"""
import hashlib
import json
import pathlib
import subprocess
import tempfile
import unittest

from worker_case import LONG, PROGRAM, PYRAMID, WorkerCase
from worker import PageSocket, Worker


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


if __name__ == "__main__":
    unittest.main(verbosity=2)
