#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A laser driven through the worker's socket: the strict virtual GRBL at a pseudo terminal.
Usage: machine_driven_test.py PROGRAM VIRTUAL_GRBL PEERS"""
import json
import pathlib
import signal
import socket
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import machine_peers as peers
from worker import PageSocket, Worker


def squares(count: int, size_mm: float = 10) -> bytes:
    lines = ["G21", "G90", "M4 S0"]
    for i in range(count):
        x = 10 + (i % 10) * 12
        lines += [f"G0 X{x} Y20", f"G1 X{x + size_mm} Y20 S300 F3000", f"G1 X{x + size_mm} Y{20 + size_mm}", f"G1 X{x} Y{20 + size_mm}", f"G1 X{x} Y20"]
    return "\n".join(lines + ["M5", "G0 X0 Y0", "M2"]).encode() + b"\n"


class MachineSocket(PageSocket):
    """A page at a machine."""

    def __init__(self, worker: Worker, machine: str, token: str | None = None, **options):
        super().__init__(worker, token or worker.token, path=f"/api/machines/{machine}/socket", version=options.pop("version", "formwright.machine.v1"), **options)
        self.state: dict = {}
        self.events: list[dict] = []
        self.count = 0

    def take(self) -> dict:
        message = self.receive()
        self.state = message.get("state", self.state)
        self.events += message.get("events", [])
        return message

    def ask(self, **request) -> dict:
        """The answer to a request: {"done": n} or {"error": ...}."""
        self.count += 1
        self.send(request)
        while True:
            message = self.take()
            if message.get("done") == self.count or message.get("n") == self.count:
                return message

    def do(self, what: str, **more) -> dict:
        return self.ask(command={"do": what, **more})

    def wait(self, condition, seconds: float = 20) -> dict:
        end = time.monotonic() + seconds
        while not (self.state and condition(self.state)):
            assert time.monotonic() < end, self.state
            self.take()
        return self.state

    def vanish(self) -> None:
        self.socket.close()

    __del__ = vanish


class Driven(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.data = self.folder / "data"
        self.laser = peers.VirtualGrbl()
        self.id = peers.add_machine(self.data, "Laser", f"serial:{self.laser.port}")
        self.worker = Worker(peers.PROGRAM, self.data)

    def tearDown(self):
        if self.worker.process.poll() is None:
            self.worker.stop()
        else:
            self.worker.process.stdout.close()
        self.laser.stop()
        self.temporary.cleanup()

    def steering(self) -> MachineSocket:
        page = MachineSocket(self.worker, self.id)
        self.assertEqual(page.ask(open={"controller": "grbl"}), {"done": 1})
        page.wait(lambda s: s["connection"] == "ready" and s["phase"] in ("idle", "alarm"))
        return page

    def ready(self, job: bytes, start: bool = True) -> MachineSocket:
        page = self.steering()
        self.assertIn("done", page.do("home", confirmed=True))
        page.wait(lambda s: s["phase"] == "idle" and s["position_known"])
        # It homes to its far corner, as GRBL does, and counts from there: the work's origin is elsewhere.
        self.assertIn("done", page.do("send", line="G10 L20 P1 X390 Y390", confirmed=True))
        page.wait(lambda s: s["work_mm"] and s["work_mm"][0] > 300)
        self.assertIn("done", page.ask(load={"name": "job.gcode", "sha256": self.worker.put_blob(job)}))
        if start:
            self.assertIn("done", page.do("start", confirmed=True))
            page.wait(lambda s: s["phase"] == "running" and s["job"]["acknowledged"] > 8)
        return page

    def test_a_job_runs_to_its_end(self):
        page = self.ready(squares(3), start=False)
        refused = page.do("start")
        self.assertEqual((refused["error"]["code"], refused["error"]["where"]), ("invalid_input", "confirmed"))
        self.assertEqual(self.laser.look()["burns"], 0)
        self.assertIn("done", page.do("start", confirmed=True))
        page.wait(lambda s: s["job"] and s["job"]["ended"] == "done", 60)
        seen = self.laser.look()
        self.assertAlmostEqual(seen["burnt_mm"], 120, delta=0.5)
        self.assertEqual((seen["bytes_lost"], seen["beam"]), (0, False))
        self.assertTrue(any(e["event"] == "sent" and e["text"].startswith("G1X") for e in page.events))
        self.assertEqual(next(m["state"] for m in self.worker.json("GET", "/api/machines")[1] if m["id"] == self.id), "idle")
        self.assertEqual(page.ask(close=True)["done"], page.count)
        log = self.worker.json("GET", "/api/machines/log?limit=100")[1]
        said = [e["event"] for e in reversed(log)]
        for wanted in ("open", "command", "load", "ended", "close"):
            self.assertIn(wanted, said)
        self.assertFalse({"sent", "received"} & set(said))
        lines = self.worker.json("GET", "/api/machines/log?limit=5000&lines=1")[1]
        self.assertEqual(sum(e["event"] == "sent" and e["text"].startswith("G1X") for e in lines), 12)

    def test_states_come_at_most_ten_times_a_second(self):
        page = self.ready(squares(20))
        start, states = time.monotonic(), 0
        while time.monotonic() - start < 2:
            states += "state" in page.take()
        self.assertLessEqual(states, 10 * (time.monotonic() - start) + 4)
        self.assertGreaterEqual(states, 5)  # fewer than 20 where the machine is busy
        page.do("stop")

    def test_a_second_page_watches_and_may_stop(self):
        page = self.ready(squares(40))
        other = MachineSocket(self.worker, self.id)
        self.assertEqual(other.ask(open={"controller": "grbl"})["error"]["code"], "busy")
        self.assertEqual(other.do("jog", x_mm=5, speed_mm_per_s=10)["error"]["code"], "busy")
        self.assertEqual(other.do("resume", confirmed=True)["error"]["code"], "busy")
        self.assertEqual(other.ask(close=True)["error"]["code"], "busy")
        other.wait(lambda s: s["phase"] == "running")
        self.assertIn("done", other.do("stop"))
        page.wait(lambda s: s["job"] and s["job"]["ended"] == "stopped")
        page.wait(lambda s: s["phase"] in ("idle", "alarm"))
        self.assertFalse(self.laser.look()["beam"])
        self.assertFalse(page.state["position_known"])

    def test_a_page_that_vanishes_leaves_the_machine_held(self):
        page = self.ready(squares(40))
        watcher = MachineSocket(self.worker, self.id)
        watcher.wait(lambda s: s["phase"] == "running")
        page.vanish()
        start = time.monotonic()
        watcher.wait(lambda s: s["phase"] in ("pausing", "paused"))
        self.assertLess(time.monotonic() - start, 3)  # 0.1 s on an idle machine
        watcher.wait(lambda s: s["phase"] == "paused")
        seen = self.laser.look()
        self.assertEqual((seen["state"][:4], seen["beam"]), ("Hold", False))
        time.sleep(0.5)
        self.assertEqual(self.laser.look()["burnt_mm"], seen["burnt_mm"])
        self.assertEqual(watcher.do("resume", confirmed=True)["error"]["code"], "busy")
        # The next one to steer is told, and may go on.
        following = MachineSocket(self.worker, self.id)
        self.assertIn("done", following.ask(open={"controller": "grbl"}))
        self.assertTrue(any("was closed during the job" in e.get("text", "") for e in following.events), following.events)
        self.assertIn("done", following.do("resume", confirmed=True))
        following.wait(lambda s: s["phase"] == "running")
        self.assertIn("done", following.do("stop"))
        following.wait(lambda s: s["job"] and s["job"]["ended"] == "stopped")

    def test_a_page_that_vanishes_while_jogging_or_focusing_leaves_nothing_on(self):
        page = self.steering()
        page.do("home", confirmed=True)
        page.wait(lambda s: s["phase"] == "idle" and s["position_known"])
        self.assertIn("done", page.do("focus", power_percent=1, confirmed=True))
        peers.wait_until(lambda: self.laser.look()["beam"], 5, "the focus light")
        page.vanish()
        peers.wait_until(lambda: not self.laser.look()["beam"], 2, "the light going out")
        page = self.steering()
        if page.state["phase"] != "idle" or not page.state["position_known"]:
            page.do("home", confirmed=True)
            page.wait(lambda s: s["phase"] == "idle" and s["position_known"])
        self.assertIn("done", page.do("jog", x_mm=-150, speed_mm_per_s=20) if page.state["machine_mm"][0] > -150 else page.do("jog", x_mm=150, speed_mm_per_s=20))
        page.wait(lambda s: s["phase"] == "jogging")
        time.sleep(0.3)
        page.vanish()

        def stands():
            place = self.laser.look()["position_mm"]
            time.sleep(0.4)
            return self.laser.look()["position_mm"] == place
        peers.wait_until(stands, 3, "the end of the jogging")  # the whole way takes 7.5 s

    def test_a_stop_does_not_wait_for_a_job_that_is_being_read(self):
        page = self.steering()
        large = self.worker.put_blob(b"G21\nG90\n" + b"G1 X10.5 Y20.25 S300 F3000\nG1 X11.5 Y21.25 S310\n" * 400_000)
        page.send({"load": {"name": "large.gcode", "sha256": large}, "n": 1001})
        page.send({"command": {"do": "start", "confirmed": True}, "n": 1002})
        page.send({"command": {"do": "stop"}, "n": 1003})
        answers = []
        while len(answers) < 3:
            message = page.take()
            if "done" in message or "n" in message:
                answers.append(message)
        self.assertEqual([answer.get("done", answer.get("n")) for answer in answers], [1002, 1003, 1001])
        self.assertEqual(answers[0]["error"]["code"], "busy", answers[0])  # never the job that was loaded before
        self.assertIn("done", answers[2])

    def test_a_pulled_cable_is_said(self):
        page = self.ready(squares(40))
        self.laser.stop()
        while "closed" not in (message := page.take()):
            pass
        self.assertIn("no longer connected", message["error"]["message"])
        self.assertEqual(page.state["job"]["ended"], "cut_off")
        self.assertIn("error", page.do("pause"))
        self.assertIn("error", page.ask(open={"controller": "grbl"}))
        entries = [json.loads(line) for log in (self.data / "machine_log").glob("*.jsonl") for line in log.read_text().splitlines()]
        self.assertTrue(any(e["event"] == "ended" and e["how"] == "cut_off" for e in entries), entries[-3:])

    def ended_by(self, signal_number: int):
        page = self.ready(squares(40))
        self.worker.process.stdout.close()  # nobody reads what it says, as when the terminal is gone
        self.worker.process.send_signal(signal_number)
        self.assertEqual(self.worker.process.wait(10), 0)
        page.vanish()
        peers.wait_until(lambda: not self.laser.look()["beam"], 3, "the beam going out")
        place = self.laser.look()
        time.sleep(0.5)
        self.assertEqual(self.laser.look()["position_mm"], place["position_mm"])
        entries = [json.loads(line) for log in (self.data / "machine_log").glob("*.jsonl") for line in log.read_text().splitlines()]
        self.assertTrue(any(e["event"] == "ended" and e["how"] == "stopped" for e in entries), entries[-3:])
        self.assertEqual((entries[-1]["event"], entries[-1]["text"]), ("close", "The worker ended."))

    def test_a_worker_that_is_ended_stops_the_machine(self):
        self.ended_by(signal.SIGTERM)

    def test_a_worker_whose_terminal_is_closed_stops_the_machine(self):
        self.ended_by(signal.SIGHUP)

    def test_the_log_survives_a_killed_worker(self):
        page = self.ready(squares(40))
        self.worker.process.kill()
        self.worker.process.wait()
        page.vanish()
        lines = [line for log in (self.data / "machine_log").glob("*.jsonl") for line in log.read_text().splitlines()]
        entries = [json.loads(line) for line in lines]
        self.assertTrue(any(e.get("command", {}).get("do") == "start" for e in entries))
        self.assertTrue(any(e["event"] == "sent" and e["text"].startswith("G1") for e in entries))
        # The next worker has the port and the log.
        self.worker.process.stdout.close()
        self.worker = Worker(peers.PROGRAM, self.data)
        self.assertTrue(self.worker.json("GET", "/api/machines/log")[1])
        self.steering()

    def test_the_command_line_stops_what_the_worker_drives(self):
        page = self.ready(squares(40))
        run = peers.formwright("send", "--machine", "Laser", "--job", "/dev/null", "--yes", data=self.data)
        self.assertEqual(run.returncode, 2, run.stderr)  # /dev/null is no file
        (self.folder / "job.gcode").write_bytes(squares(1))
        run = peers.formwright("send", "--machine", "Laser", "--job", self.folder / "job.gcode", "--yes", data=self.data)
        self.assertEqual(run.returncode, 3)
        self.assertIn("driven by another formwright", run.stderr)
        run = peers.formwright("stop", "--machine", "laser", data=self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn(str(self.worker.process.pid), run.stdout)
        page.wait(lambda s: s["job"] and s["job"]["ended"] == "stopped", 5)
        self.assertFalse(self.laser.look()["beam"])


class Guarded(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.data = pathlib.Path(cls.temporary.name) / "data"
        cls.laser = peers.VirtualGrbl()
        cls.id = peers.add_machine(cls.data, "Laser", f"serial:{cls.laser.port}")
        cls.worker = Worker(peers.PROGRAM, cls.data)

    @classmethod
    def tearDownClass(cls):
        cls.worker.stop()
        cls.laser.stop()
        cls.temporary.cleanup()

    def test_host_origin_token_and_version(self):
        for expected, options in ((421, {"host": "evil.example"}), (421, {"host": f"localhost:{self.worker.port + 1}"}), (403, {"origin": "http://evil.example"}),
                                  (403, {"origin": "null"}), (401, {"token": "0" * 48}), (401, {"version": "formwright.v1"}), (101, {"origin": f"http://127.0.0.1:{self.worker.port}"})):
            page = MachineSocket(self.worker, self.id, **options)
            self.assertEqual(page.status, expected, options)
            page.vanish()
        for path in ("/api/machines", f"/api/machines/{self.id}", "/api/machines/log"):
            self.assertEqual(self.worker.request("GET", path, token=None)[0], 401)
            self.assertEqual(self.worker.request("GET", path, headers={"Host": "evil.example"})[0], 421)
            self.assertEqual(self.worker.request("GET", path, headers={"Origin": "http://evil.example"})[0], 403)
        self.assertEqual(self.worker.request("POST", f"/api/machines/{self.id}/print", b"{}", token=None)[0], 401)

    def test_only_machines_that_are_known(self):
        for name in ("0" * 16, "..%2f..", "%00", "a" * 16):
            self.assertIn(MachineSocket(self.worker, name).status, (401, 404))
            self.assertIn(self.worker.request("GET", f"/api/machines/{name}")[0], (404,))
        status, answer = self.worker.json("POST", f"/api/machines/{self.id}/print", {"sha256": "0" * 64})
        self.assertEqual(status, 422)
        self.assertIn("cannot do that", answer["error"]["message"])

    def test_a_page_cannot_name_a_port(self):
        page = MachineSocket(self.worker, self.id)
        for options in ({"controller": "grbl", "port": "/dev/ttyS0"}, {"controller": "grbl", "url": "tcp://10.0.0.1:23"}, {"controller": "virtual"}, {"controller": "ruida"},
                        {"controller": "k40"}, {"controller": "grbl", "baud": 7}, {"controller": ["grbl"]}):
            answer = page.ask(open=options)
            self.assertEqual(answer["error"]["code"], "invalid_input", answer)
        page.vanish()

    def test_malformed_messages_are_answered_counted_and_end_it(self):
        page = MachineSocket(self.worker, self.id)
        self.assertEqual(page.status, 101)
        bad = [b"", b"{", b"[]", b"null", b'{"open": 1}', b'{"command": {}, "load": {}}', b'{"load": {"name": "x", "sha256": "../../x"}}', b'{"close": 7}', b'{"n": -1, "close": true}',
               b"[" * 30000, b'{"shell": "id"}', b'{"command": []}']
        for number, text in enumerate(bad, 1):
            page.send_frame(0x81, text)
            message = page.take()
            self.assertEqual((message["error"]["code"], message["n"]), ("invalid_input", number), text[:40])
        answered = len(bad)
        try:
            for _ in range(40):
                page.send_frame(0x81, b"nonsense")
                page.take()
                answered += 1
        except (ConnectionError, OSError):
            pass
        self.assertLessEqual(answered, 20)
        # What was never opened is said, and is no mistake of form.
        page = MachineSocket(self.worker, self.id)
        self.assertIn("not connected", page.do("home", confirmed=True)["error"]["message"])
        page.vanish()

    def test_oversized_and_broken_frames_end_the_connection_only(self):
        for first, data, claimed in ((0x81, b"x" * 70000, None), (0x81, b"\xff\xfe", None), (0x81, b"x", 1 << 40), (0xF1, b"x", None), (0x8B, b"x", None)):
            page = MachineSocket(self.worker, self.id)
            try:
                page.send_frame(first, data, claimed)
                page.socket.settimeout(15)
                with self.assertRaises((ConnectionError, OSError)):
                    while True:
                        page.receive()
            except (ConnectionError, OSError):
                pass
            page.vanish()
        self.assertEqual(self.worker.request("GET", "/api/status")[0], 200)

    def test_a_flood_is_refused_not_sent(self):
        page = MachineSocket(self.worker, self.id)
        said = []
        try:
            while len(said) < 2000:
                said.append(page.do("home", confirmed=True)["error"]["message"])
        except (ConnectionError, OSError):
            pass
        self.assertTrue(200 <= len(said) < 2000, len(said))
        self.assertIn("Too many requests at once", said[-1])
        page.vanish()

    def test_a_hundred_connections_leave_it_standing(self):
        pages = []
        for _ in range(100):
            try:
                pages.append(MachineSocket(self.worker, self.id))
            except (ConnectionError, OSError, IndexError):
                pass
        self.assertEqual(sum(p.status == 101 for p in pages), 4)
        self.assertTrue(any(p.status == 429 for p in pages))
        for page in pages:
            page.vanish()
        peers.wait_until(lambda: MachineSocket(self.worker, self.id).status == 101, 10, "room again")
        self.assertEqual(self.worker.request("GET", "/api/status")[0], 200)


if __name__ == "__main__":
    unittest.main(verbosity=2)
