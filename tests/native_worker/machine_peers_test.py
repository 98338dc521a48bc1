#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Our serial and UDP paths to machines that somebody else wrote: MeerK40t's GRBL and Ruida listeners.
Usage: machine_peers_test.py PROGRAM VIRTUAL_GRBL PEERS"""
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import machine_peers as peers
from machine_driven_test import MachineSocket
from worker import Worker

# Between M3 and M5 this listener collects the job; at the M5 that every job is closed with it waits for a laser of its own to burn it, and there is none.
# So it answers every line, and works for ever.
JOB = b"G21\nG90\nM3 S1000\nG0 X10 Y10\n" + b"".join(b"G1 X%d Y%d F6000\n" % (10 + i % 7, 10 + i % 5) for i in range(400))


class Listeners(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.data = self.folder / "data"
        self.processes = []

    def tearDown(self):
        for process in self.processes:
            process.stop() if hasattr(process, "stop") else peers.end(process)
        self.temporary.cleanup()

    def started(self, thing):
        self.processes.append(thing)
        return thing

    def run_job(self, machine: str):
        """Homed, a job of 400 lines sent and every line answered. As a mill: this listener says $32=0 whatever it is set to."""
        worker = self.started(Worker(peers.PROGRAM, self.data))
        page = MachineSocket(worker, machine)
        self.assertEqual(page.ask(open={"controller": "grbl", "tool": "mill"}), {"done": 1})
        page.wait(lambda s: s["connection"] == "ready" and s["phase"] in ("idle", "alarm"), 30)
        self.assertIn("done", page.do("home", confirmed=True))
        page.wait(lambda s: s["phase"] == "idle" and s["position_known"], 30)
        # Homed at its switches it counts from 0 downwards, and the job upwards.
        self.assertIn("done", page.do("set_origin", at="corner"))
        self.assertIn("done", page.ask(load={"name": "job", "sha256": worker.put_blob(JOB)}))
        started = page.do("start", confirmed=True)
        self.assertIn("done", started)
        state = page.wait(lambda s: s["job"] and (s["job"]["ended"] or s["job"]["acknowledged"] == s["job"]["line_count"]), 60)
        self.assertEqual((state["job"]["ended"], state["job"]["acknowledged"]), (None, state["job"]["line_count"]), state)
        return page

    def test_grbl_over_tcp(self):
        meerk40t = self.started(peers.MeerK40t(self.folder / "meerk40t", "grblcontrol -p 2323"))
        meerk40t.wait_for("TCP Server for GRBL Emulator on port: 2323")
        self.run_job(peers.add_machine(self.data, "MeerK40t", "tcp://127.0.0.1:2323"))

    def test_grbl_over_a_serial_line(self):
        meerk40t = self.started(peers.MeerK40t(self.folder / "meerk40t", "grblcontrol -p 2324"))
        meerk40t.wait_for("TCP Server for GRBL Emulator on port: 2324")
        link = self.folder / "ttyLASER"
        cable = self.started(subprocess.Popen(["socat", f"PTY,raw,echo=0,link={link}", "TCP:127.0.0.1:2324"]))
        peers.wait_until(link.exists, 10, "the serial line")
        page = self.run_job(peers.add_machine(self.data, "Serial", f"serial:{link}"))
        # An unplugged cable is noticed and said.
        cable.kill()
        while "closed" not in (message := page.take()):
            pass
        self.assertIn("Serial is no longer connected", message["error"]["message"])

    def test_ruida_over_udp(self):
        meerk40t = self.started(peers.MeerK40t(self.folder / "meerk40t", "ruidacontrol"))
        meerk40t.wait_for("Ruida Data Server opened on port 50200")
        time.sleep(1)
        worker = self.started(Worker(peers.PROGRAM, self.data))
        machine = peers.add_machine(self.data, "Ruida", "ruida://127.0.0.1")
        page = MachineSocket(worker, machine)
        self.assertEqual(page.ask(open={"controller": "ruida"}), {"done": 1})
        state = page.wait(lambda s: s["connection"] == "ready", 30)
        self.assertEqual(state["controller"], "ruida")
        # Nobody else of this computer can have the port it answers to.
        other = MachineSocket(worker, peers.add_machine(self.data, "Second", "ruida://127.0.0.2"))
        answer = other.ask(open={"controller": "ruida"})
        self.assertIn("Port 40200", answer["error"]["message"])

    def test_a_ruida_job_is_framed(self):
        plate = self.folder / "plate.svg"
        plate.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
                         '<g id="cut" stroke="#ff0000" fill="none"><rect x="5" y="5" width="50" height="30"/></g></svg>')
        made = subprocess.run([peers.PROGRAM, "laser-job", "--drawing", plate, "--controller", "ruida", "--kerf-mm", "0", "--x-mm", "100", "--y-mm", "50", "--outputs", "job.rd",
                               "--out", self.folder / "job", "--quiet"], capture_output=True, text=True)
        self.assertEqual(made.returncode, 0, made.stderr)
        meerk40t = self.started(peers.MeerK40t(self.folder / "meerk40t", "ruidacontrol"))
        meerk40t.wait_for("Ruida Data Server opened on port 50200")
        time.sleep(1)
        peers.add_machine(self.data, "Ruida", "ruida://127.0.0.1")
        run = peers.formwright("frame", "--machine", "Ruida", "--job", self.folder / "job/job.rd", "--yes", data=self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("x 105.0 to 155.0 mm, y 55.0 to 85.0 mm", run.stdout)
        # What cannot be framed is refused before anything is sent.
        (self.folder / "job.gcode").write_bytes(JOB)
        run = peers.formwright("frame", "--machine", "Ruida", "--job", self.folder / "job.gcode", "--yes", data=self.data)
        self.assertEqual(run.returncode, 2)
        self.assertIn("not a Ruida job", run.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
