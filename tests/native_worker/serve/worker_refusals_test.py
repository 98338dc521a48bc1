#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the native worker refuses, and that refusing leaves nothing behind. Usage: worker_refusals_test.py PROGRAM"""
import hashlib
import http.client
import pathlib
import random
import socket
import time
import unittest

from worker_case import PYRAMID, WorkerCase
from worker import PageSocket, eventually


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


if __name__ == "__main__":
    unittest.main(verbosity=2)
