# SPDX-License-Identifier: GPL-3.0-or-later
"""A worker to test: started on a free port with its own data folder, spoken to over plain sockets."""
import base64
import hashlib
import http.client
import json
import os
import pathlib
import re
import socket
import struct
import subprocess
import time


def runs_jobs(process: int) -> bool:
    """Whether there is such a process, and it is a worker's child for jobs."""
    try:
        return "run-jobs" in pathlib.Path(f"/proc/{process}/cmdline").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False


def children_of(process: int) -> list[int]:
    """Of all its threads."""
    found = []
    for task in pathlib.Path(f"/proc/{process}/task").iterdir():
        try:
            found += [int(number) for number in (task / "children").read_text().split()]
        except (FileNotFoundError, ProcessLookupError):  # a thread that ended meanwhile
            pass
    return found


def ignores(process: int, number: int) -> bool:
    """Whether it has said that this signal is nothing to it."""
    mask = re.search(r"SigIgn:\s*(\w+)", pathlib.Path(f"/proc/{process}/status").read_text()).group(1)
    return bool(int(mask, 16) >> (number - 1) & 1)


def sockets_of(process: int) -> list[str]:
    """What it holds open of the network."""
    held = []
    for descriptor in pathlib.Path(f"/proc/{process}/fd").iterdir():
        try:
            held.append(os.readlink(descriptor))
        except FileNotFoundError:  # closed meanwhile
            pass
    return [name for name in held if name.startswith("socket:")]


def eventually(condition) -> bool:
    """Whether it comes true within ten seconds."""
    end = time.monotonic() + 10
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


# These tests may themselves run under nohup, whose children ignore that their terminal is closed.
HEARS_HANGUPS = ("env", "--default-signal=HUP")


class Worker:
    def __init__(self, program: str, data: pathlib.Path, *flags: str, before: tuple[str, ...] = HEARS_HANGUPS, **options):
        self.begin(program, data, *flags, before=before, **options)
        for line in self.process.stdout:
            if match := re.match(r"http://127\.0\.0\.1:(\d+)/#token=([0-9a-f]+)$", line.strip()):
                self.port, self.token = int(match.group(1)), match.group(2)
                return
        raise RuntimeError("the worker did not start")

    def begin(self, program: str, data: pathlib.Path, *flags: str, before: tuple[str, ...] = HEARS_HANGUPS,
              **options) -> None:
        """Starts the program without waiting until it listens."""
        self.process = subprocess.Popen([*before, program, "serve", "--port", "0", "--data", str(data), *flags],
                                        stdout=subprocess.PIPE, text=True, **options)

    def stop(self) -> None:
        self.process.terminate()
        self.process.wait(10)
        self.process.stdout.close()

    def request(self, method: str, path: str, body: bytes | None = None, headers: dict | None = None, token: str | None = "own"):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        all_headers = dict(headers or {})
        if token is not None:
            all_headers["Authorization"] = "Bearer " + (self.token if token == "own" else token)
        try:
            connection.request(method, path, body, all_headers)
            answer = connection.getresponse()
            return answer.status, answer.read(), dict(answer.getheaders())
        finally:
            connection.close()

    def json(self, method: str, path: str, message=None):
        status, body, _ = self.request(method, path, None if message is None else json.dumps(message).encode())
        return status, json.loads(body) if body else None

    def put_blob(self, content: bytes) -> str:
        name = hashlib.sha256(content).hexdigest()
        status, body, _ = self.request("PUT", f"/api/blobs/{name}", content)
        assert status in (200, 201), (status, body)
        return name

    def post_job(self, **job) -> str:
        status, answer = self.json("POST", "/api/jobs", job)
        assert status == 202, (status, answer)
        return answer["id"]

    def wait(self, job: str, seconds: float = 120):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            status, detail = self.json("GET", f"/api/jobs/{job}")
            assert status == 200, (status, detail)
            if detail["state"] in ("done", "failed", "cancelled"):
                return detail
            time.sleep(0.05)
        raise AssertionError(f"job {job} did not finish: {detail}")

    def wait_running(self, job: str) -> None:
        assert eventually(lambda: self.json("GET", f"/api/jobs/{job}")[1]["state"] == "running"), "the job never ran"

    def job_process(self) -> int:
        """The child in which jobs run, once it has become that program: between fork and exec it still is the worker, with all that it holds open."""
        def found():
            return children_of(self.process.pid)
        assert eventually(lambda: len(found()) == 1 and runs_jobs(found()[0])), found()
        return found()[0]


class PageSocket:
    """A WebSocket client of the few things the tests need (RFC 6455)."""

    def __init__(self, worker: Worker, token: str, origin: str | None = None, host: str | None = None, path: str = "/api/socket", version: str = "formwright.v1"):
        self.socket = socket.create_connection(("127.0.0.1", worker.port), timeout=60)
        lines = [f"GET {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{worker.port}'}", "Upgrade: websocket", "Connection: Upgrade",
                 "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode(), "Sec-WebSocket-Version: 13",
                 f"Sec-WebSocket-Protocol: {version}, token.{token}"]
        if origin:
            lines.append(f"Origin: {origin}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        head = b""
        while b"\r\n\r\n" not in head:
            part = self.socket.recv(1)
            if not part:
                break
            head += part
        self.status = int(head.split()[1])

    def _exactly(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            part = self.socket.recv(count - len(data))
            if not part:
                raise ConnectionError("closed")
            data += part
        return data

    def receive(self):
        text = b""
        while True:
            first, second = self._exactly(2)
            assert second < 0x80, "a server masks nothing (RFC 6455, 5.1)"
            length = second
            if length == 126:
                length = struct.unpack(">H", self._exactly(2))[0]
            elif length == 127:
                length = struct.unpack(">Q", self._exactly(8))[0]
            payload = self._exactly(length)
            if first & 0x0F in (0, 1):  # long messages come in several frames
                text += payload
                if first & 0x80:
                    return json.loads(text)
            if first & 0x0F == 9:  # a server that hears no answer takes the page for gone
                self.send_frame(0x8A, payload)
            if first & 0x0F == 8:
                raise ConnectionError("closed by the server")

    def send(self, message) -> None:
        self.send_frame(0x81, json.dumps(message).encode())

    def send_frame(self, first: int, data: bytes, claimed_length: int | None = None) -> None:
        length = len(data) if claimed_length is None else claimed_length
        mask = os.urandom(4)
        head = bytes([first])
        if length < 126:
            head += bytes([0x80 | length])
        elif length < 65536:
            head += bytes([0x80 | 126]) + struct.pack(">H", length)
        else:
            head += bytes([0x80 | 127]) + struct.pack(">Q", length)
        self.socket.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))
