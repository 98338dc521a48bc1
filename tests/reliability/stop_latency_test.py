#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a stop takes from the page's request to the wire, while solvers use every core, large jobs are loaded for another machine, large models
arrive with jobs for the solver, and clients ask for pictures. Every second stop comes from a page that connects for it. With --slow-disk every fsync of the worker takes
a second longer. With --pty the line is a pseudo terminal: the kernel hands its bytes on when a thread of its own has its turn, which no serial port does, so that
what is required there is the time to the worker's write.
Usage: stop_latency_test.py PROGRAM VIRTUAL_GRBL PEERS [--stops N] [--job-mb N] [--model-mb N] [--seed N] [--require-ms N] [--slow-disk LIBRARY] [--pty]"""
import argparse
import http.client
import json
import os
import pathlib
import random
import select
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import tty

CLIENTS = 6
LONG_JOB = {"operation": "relief", "parameters": {"thickness_mm": 1}, "inputs": {"mesh": {"sample": "bust", "vertices": 400000}}, "outputs": []}


def ask_for_pictures(port: int) -> None:
    """As fast as one client can, without the token, for ever."""
    while True:
        try:
            line = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
            for _ in range(50):
                line.request("GET", "/picture.png")
                line.getresponse().read()
        except (OSError, http.client.HTTPException):
            time.sleep(0.01)
        finally:
            line.close()


def carry(terminal: str) -> None:
    """A network line to the machine at this terminal. Prints its port, and for every line on standard input when a feed hold came over it last.
    A pseudo terminal hands bytes on when a thread of the kernel has its turn, which is no wire's delay; the loopback does so at once."""
    machine = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(machine)
    listener = socket.create_server(("127.0.0.1", 0))
    print(listener.getsockname()[1], flush=True)
    line, hold_s = listener.accept()[0], 0.0
    line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    while True:
        for ready in select.select([line, machine, sys.stdin], [], [])[0]:
            if ready is line:
                if b"!" in (said := line.recv(4096)):
                    hold_s = time.monotonic()
                os.write(machine, said)
            elif ready == machine:
                line.sendall(os.read(machine, 4096))
            elif not sys.stdin.readline():
                return
            else:
                print(hold_s, flush=True)


if sys.argv[1] == "--ask-for-pictures":
    ask_for_pictures(int(sys.argv[2]))
if sys.argv[1] == "--carry":
    carry(sys.argv[2])
    sys.exit(0)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "native_worker"))
import machine_peers as peers  # runs this program again in a network of its own
from machine_driven_test import MachineSocket, squares
from worker import Worker


class Line:
    def __init__(self, terminal: str):
        self.process = subprocess.Popen([sys.executable, __file__, "--carry", terminal], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.address = f"tcp://127.0.0.1:{int(self.process.stdout.readline())}"

    def hold_s(self) -> float:
        self.process.stdin.write("?\n")
        self.process.stdin.flush()
        return float(self.process.stdout.readline())

    def stop(self) -> None:
        peers.end(self.process)


class Terminal:
    """The machine's own pseudo terminal. The machine notes when a feed hold came."""

    def __init__(self, machine):
        self.process, self.machine, self.address = machine.process, machine, f"serial:{machine.port}"

    def hold_s(self) -> float:
        return self.machine.look()["hold_monotonic_s"]

    def stop(self) -> None:
        pass


def measure_first(process: int) -> bool:
    """What measures must not wait for what is measured."""
    try:
        os.sched_setscheduler(process, os.SCHED_RR, os.sched_param(1))
        return True
    except PermissionError:
        return False


def load_only() -> None:
    """A thread that is load, not measure, has an ordinary one's turn: it began with that of the thread that started it."""
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


def raster(megabytes: float) -> bytes:
    line = b"".join(b"G1 X%d.5 Y%d.25 S%d F3000\n" % (x, x % 7, x % 1000) for x in range(100))
    return b"G21\nG90\nM4 S0\n" + line * max(1, int(megabytes * 1e6 / len(line))) + b"M5\n"


def model(megabytes: float) -> bytearray:
    """A binary STL of a corrugated sheet."""
    count = max(2, int(megabytes * 1e6 / 50))
    one = b"".join(struct.pack("<12fH", 0, 0, 1, x, 0, x % 2, x + 1, 0, (x + 1) % 2, x, 10, x % 2, 0) for x in range(1000))
    return bytearray(bytes(80) + struct.pack("<I", count) + (one * (count // 1000 + 1))[:50 * count])


def keep_posting(worker: Worker, megabytes: float, over: threading.Event, posts: list[float]) -> None:
    """Models that the worker has not seen, each with its job."""
    load_only()
    content = model(megabytes)
    while not over.is_set():
        content[:8] = struct.pack("<Q", len(posts))
        start = time.monotonic()
        try:
            job = {"operation": "relief", "parameters": {"thickness_mm": 1}, "inputs": {"mesh": {"sha256": worker.put_blob(bytes(content)), "file_name": "sheet.stl"}}, "outputs": []}
            status, answer = worker.json("POST", "/api/jobs", job)
            assert status in (202, 429), (status, answer)
            posts.append(time.monotonic() - start)
            if status == 202:
                worker.request("POST", f"/api/jobs/{answer['id']}/cancel")
        except (OSError, http.client.HTTPException):  # the worker was ended
            assert over.is_set()


def connect(worker: Worker, machine: str) -> MachineSocket:
    page = MachineSocket(worker, machine)
    assert "done" in page.ask(open={"controller": "grbl"})
    page.wait(lambda s: s["connection"] == "ready" and s["phase"] in ("idle", "alarm"), 60)
    return page


def home(page: MachineSocket) -> None:
    assert "done" in (answer := page.do("home", confirmed=True)), answer
    page.wait(lambda s: s["phase"] == "idle" and s["position_known"], 60)


def keep_loading(worker: Worker, machine: str, content: bytes, over: threading.Event, loads: list[float]) -> None:
    load_only()
    page, job = connect(worker, machine), worker.put_blob(content)
    while not over.is_set():
        start = time.monotonic()
        try:
            answer = page.ask(load={"name": "large.gcode", "sha256": job})
        except ConnectionError:  # the worker was ended
            assert over.is_set()
            return
        if "not arrived" in answer.get("error", {}).get("message", ""):  # the posted models took its place in the store
            job = worker.put_blob(content)
            continue
        assert "done" in answer, answer
        loads.append(time.monotonic() - start)


def written_s(data: pathlib.Path, machine: str, stops: int) -> list[float]:
    """When the worker had written each stop to the port, of the computer's clock. The log may be later than the machine."""
    def logged():
        return [line for log in sorted((data / "machine_log").glob(f"*-{machine}.jsonl")) for line in log.read_text().splitlines() if '"do":"stop"' in line]
    peers.wait_until(lambda: len(logged()) >= stops, 60, "the log")
    return [json.loads(line)["unix_s"] for line in logged()]


def stop_once(page: MachineSocket, line, chance: random.Random, stranger) -> tuple[float, float]:
    """Seconds of the monotonic clock: asked, and heard at the other end of the line. `stranger`: connects another page, which stops; None: the page
    that steers does."""
    home(page)
    assert "done" in (answer := page.do("start", confirmed=True)), answer
    page.wait(lambda s: s["phase"] == "running" and s["job"]["acknowledged"] > 4, 60)
    end = time.monotonic() + chance.uniform(0.02, 0.4)
    while time.monotonic() < end:
        page.take()
    asked = time.monotonic()
    assert "done" in (answer := (stranger() if stranger else page).do("stop")), answer
    page.wait(lambda s: s["job"] and s["job"]["ended"] == "stopped" and s["phase"] in ("idle", "alarm"), 60)
    heard = line.hold_s()
    assert heard >= asked, "no feed hold came over the wire"
    return asked, heard


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--stops", type=int, default=int(os.environ.get("FORMWRIGHT_STOPS", "8")))
    parser.add_argument("--job-mb", type=float, default=114)
    parser.add_argument("--model-mb", type=float, default=20)
    parser.add_argument("--slow-disk", help="tests/reliability/slow_disk.c, built")
    parser.add_argument("--pty", action="store_true")
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--require-ms", type=float, default=2000)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        web = folder / "web"
        web.mkdir()
        (web / "index.html").write_text("<!doctype html>")
        (web / "picture.png").write_bytes(random.Random(1).randbytes(400_000))
        laser, other = peers.VirtualGrbl(), peers.VirtualGrbl()
        line = Terminal(laser) if options.pty else Line(laser.port)
        measures_first = measure_first(0) and measure_first(line.process.pid)
        data = folder / "data"
        machine = peers.add_machine(data, "Laser", line.address)
        second = peers.add_machine(data, "Other", f"serial:{other.port}")
        slow = {"LD_PRELOAD": options.slow_disk, "FORMWRIGHT_SLOW_FOLDER": str(data.resolve()), "FORMWRIGHT_SLOW_SECONDS": "1"} if options.slow_disk else {}
        worker = Worker(peers.PROGRAM, data, "--web", str(web), env={**os.environ, **slow})
        over, loads, posts, askers = threading.Event(), [], [], []
        try:
            page = connect(worker, machine)
            home(page)
            assert "done" in page.do("send", line="G10 L20 P1 X390 Y390", confirmed=True)
            page.wait(lambda s: s["work_mm"] and s["work_mm"][0] > 300)
            assert "done" in page.ask(load={"name": "job.gcode", "sha256": worker.put_blob(squares(40))})
            loader = threading.Thread(target=keep_loading, args=(worker, second, raster(options.job_mb), over, loads), daemon=True)
            loader.start()
            poster = threading.Thread(target=keep_posting, args=(worker, options.model_mb, over, posts), daemon=True)
            poster.start()
            # Ordinary programs of their own: they are load, and do not measure.
            askers = [subprocess.Popen(["nice", "-n", "0", sys.executable, __file__, "--ask-for-pictures", str(worker.port)], preexec_fn=load_only)
                      for _ in range(CLIENTS)]
            job, taken, connected, all_asked = worker.post_job(**LONG_JOB), [], [], []
            clocks_s = time.time() - time.monotonic()
            for number in range(options.stops):
                if worker.json("GET", f"/api/jobs/{job}")[1]["state"] in ("done", "failed"):
                    job = worker.post_job(**LONG_JOB)
                connects = number % 2 == 1
                asked, heard = stop_once(page, line, chance, (lambda: MachineSocket(worker, machine)) if connects else None)
                (connected if connects else taken).append(1000 * (heard - asked))
                all_asked.append(asked)
            inside = [1000 * (written - clocks_s - asked) for written, asked in zip(written_s(data, machine, options.stops), all_asked)]
        finally:
            over.set()
            for asker in askers:
                asker.kill()
                asker.wait()
            worker.process.kill()
            worker.process.wait()
            worker.process.stdout.close()
            for one in (line, laser, other):
                one.stop()
    print(f"seed {options.seed}, load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, {len(loads)} jobs of {options.job_mb:g} MB loaded and {len(posts)} models of {options.model_mb:g} MB posted meanwhile, "
          f"measured {'ahead of' if measures_first else 'among'} other programs")
    rows = (("from request to wire", taken), ("from request to the worker's write", inside[::2]),
            ("from a connecting page to wire", connected), ("from a connecting page to the worker's write", inside[1::2]))
    required_ms = max(inside if options.pty else taken + connected)
    for what, figures in rows:
        figures.sort()
        print(f"{len(figures)} stops {what}: median {figures[len(figures) // 2]:.1f} ms, 90 % {figures[len(figures) * 9 // 10]:.1f} ms, max {figures[-1]:.1f} ms")
    return 0 if required_ms <= options.require_ms else 1


if __name__ == "__main__":
    sys.exit(main())
