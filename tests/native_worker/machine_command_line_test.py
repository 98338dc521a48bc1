#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A laser and a mill driven from the command line: the strict virtual GRBL at a pseudo terminal.
Usage: machine_command_line_test.py PROGRAM VIRTUAL_GRBL PEERS"""
import json
import os
import pathlib
import pty
import select
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import machine_peers as peers
from machine_driven_test import squares
from worker import HEARS_HANGUPS


class CommandLine(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.data = self.folder / "data"
        self.laser = peers.VirtualGrbl("no-homing")
        peers.add_machine(self.data, "Laser", f"serial:{self.laser.port}")
        self.job = self.folder / "job.gcode"
        self.job.write_bytes(squares(2))

    def tearDown(self):
        self.laser.stop()
        self.temporary.cleanup()

    def entries(self) -> list[dict]:
        return [json.loads(line) for log in sorted((self.data / "machine_log").glob("*.jsonl")) for line in log.read_text().splitlines()]

    def test_send_and_frame(self):
        run = peers.formwright("frame", "--machine", "laser", "--job", self.job, "--yes", data=self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("x 0.0 to 32.0 mm, y 0.0 to 30.0 mm", run.stdout)
        self.assertEqual(self.laser.look()["burns"], 0)
        run = peers.formwright("send", "--machine", "laser", "--job", self.job, "--yes", data=self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        seen = self.laser.look()
        self.assertAlmostEqual(seen["burnt_mm"], 80, delta=0.5)
        self.assertEqual(seen["bytes_lost"], 0)
        self.assertTrue(any(e["event"] == "ended" and e["how"] == "done" for e in self.entries()))

    def test_a_job_that_fails_leaves_nothing_held(self):
        for board in ((), ("grblhal",)):
            laser = peers.VirtualGrbl("no-homing", "refuses=G1Y7", *board)
            try:
                peers.add_machine(self.data, "Refuses", f"serial:{laser.port}")
                self.job.write_text("G21\nG90\nG0 X1 Y1\nM4 S500\nG1 X90 F600\nG1 Y7\nG1 X1\nM5\n")
                run = peers.formwright("send", "--machine", "Refuses", "--job", self.job, "--yes", data=self.data)
                self.assertNotEqual(run.returncode, 0)
                self.assertIn("The target of the move is not valid", run.stderr)
                seen = laser.look()
                self.assertIn(seen["state"], ("Idle", "Alarm"))
                self.assertFalse(seen["beam"])
            finally:
                laser.stop()
                peers.formwright("remove", "Refuses", data=self.data)

    def test_nothing_moves_without_a_yes(self):
        run = peers.formwright("send", "--machine", "laser", "--job", self.job, data=self.data, stdin=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("--yes", run.stderr)
        before = self.laser.look()["position_mm"]
        for typed, code in ((b"no\n", 130), (b"y\n", 130), (b"yes\n", 0)):
            master, slave = pty.openpty()
            process = subprocess.Popen([peers.PROGRAM, "machine", "frame", "--data", self.data, "--machine", "laser", "--job", self.job], stdin=slave, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            os.close(slave)
            for _ in range(2 if code == 0 else 1):  # whether it stands at the corner, and before the frame
                time.sleep(2.5)
                os.write(master, typed)
            out, said = process.communicate(timeout=60)
            os.close(master)
            self.assertEqual(process.returncode, code, said)
            self.assertIn("Type yes", said)
            if code:
                self.assertEqual(self.laser.look()["position_mm"], before)
        self.assertEqual(self.laser.look()["burns"], 0)

    def send(self, *before: str, **streams) -> subprocess.Popen:
        self.job.write_bytes(squares(60))
        return subprocess.Popen([*HEARS_HANGUPS, *before, peers.PROGRAM, "machine", "send", "--data", self.data, "--machine", "laser", "--job", self.job, "--yes"], text=True, **streams)

    def assert_stopped(self):
        seen = self.laser.look()
        self.assertFalse(seen["beam"])
        time.sleep(0.5)
        self.assertEqual(self.laser.look()["position_mm"], seen["position_mm"])
        entries = self.entries()
        self.assertTrue(any(e["event"] == "ended" and e["how"] == "stopped" for e in entries))
        self.assertEqual(entries[-1]["event"], "close")

    def test_ctrl_c_stops_the_machine(self):
        process = self.send(stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        peers.wait_until(lambda: self.laser.look()["burns"] > 3, 30, "the burning")
        process.send_signal(signal.SIGINT)
        out, said = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130, said)
        self.assertIn("Stopped: laser off", said)
        self.assert_stopped()

    def test_a_closed_terminal_stops_the_machine(self):
        terminal, theirs = pty.openpty()
        process = self.send("setsid", "--ctty", stdin=theirs, stdout=theirs, stderr=theirs)
        os.close(theirs)

        def burns():
            while select.select([terminal], [], [], 0)[0]:  # its progress: a terminal nobody reads would hold it up
                os.read(terminal, 4096)
            return self.laser.look()["burns"] > 3
        peers.wait_until(burns, 30, "the burning")
        os.close(terminal)  # the window is closed, the line drops
        self.assertEqual(process.wait(20), 130)
        self.assert_stopped()

    def test_a_hangup_stops_the_machine_though_nobody_reads_what_it_says(self):
        process = self.send(stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        peers.wait_until(lambda: self.laser.look()["burns"] > 3, 30, "the burning")
        process.stdout.close()
        process.stderr.close()
        process.send_signal(signal.SIGHUP)
        self.assertEqual(process.wait(20), 130)
        self.assert_stopped()

    def test_mistakes_are_named(self):
        for part, words in (("There is no machine called X", ("send", "--machine", "X", "--job", self.job)), ("There is no file", ("send", "--machine", "laser", "--job", "/nothing")),
                            ("--url", ("add", "--name", "N")), ("called Laser already", ("add", "--name", "laser", "--url", "tcp://1.2.3.4:23")), ("no kind of address", ("add", "--name", "N", "--url", "gopher://x")),
                            ("--kind octoprint", ("add", "--name", "N", "--url", "http://x")), ("does not belong in the address", ("add", "--name", "N", "--url", "http://a:b@x", "--kind", "octoprint")),
                            ("There is no flag --force", ("list", "--force")), ("No machine called Z", ("remove", "Z"))):
            run = peers.formwright(*words, data=self.data)
            self.assertEqual(run.returncode, 2, (words, run.stderr))
            self.assertIn(part, run.stderr)
        peers.add_machine(self.data, "Gone", "serial:/dev/pts/99999")
        run = peers.formwright("stop", "--machine", "Gone", data=self.data)
        self.assertEqual(run.returncode, 3)
        self.assertIn("plug it in", run.stderr)
        peers.add_machine(self.data, "File", f"serial:{self.job}")
        self.assertIn("is no serial port", peers.formwright("stop", "--machine", "File", data=self.data).stderr)


def pocket(depth_mm: float) -> bytes:
    return "\n".join(["G21", "G90", "M5", "G0 Z5", "G0 X10 Y10", "M3 S1000", f"G1 Z-{depth_mm} F600", "G1 X15 Y10", "G0 Z5", "M5", "G0 X0 Y0", "M2"]).encode() + b"\n"


class Mill(unittest.TestCase):
    """A mill without switches: where z is 0 the person says, with every tool."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.data = self.folder / "data"
        self.mill = peers.VirtualGrbl("no-homing", "mill")
        peers.add_machine(self.data, "Mill", f"serial:{self.mill.port}", "--controller", "grbl_mill")
        self.jobs = [self.folder / "job_1_rough.gcode", self.folder / "job_2_finish.gcode"]
        for job, depth in zip(self.jobs, (1, 2)):
            job.write_bytes(pocket(depth))

    def tearDown(self):
        self.mill.stop()
        self.temporary.cleanup()

    def machine(self, *words, **options):
        return peers.formwright(*words, data=self.data, stdin=subprocess.DEVNULL, **options)

    def test_z_is_said_or_nothing_runs(self):
        send = ("send", "--machine", "Mill", "--yes", "--job", self.jobs[0])
        run = self.machine(*send)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("--z here", run.stderr)
        run = self.machine(*send, "--z", "somewhere")
        self.assertEqual(run.returncode, 2, run.stderr)
        run = self.machine(*send, "--z", "here", "--job", self.jobs[1])
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("Between two jobs, z must be set", run.stderr)
        self.assertEqual(self.mill.look()["burns"], 0)
        run = self.machine(*send, "--z", "here")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertAlmostEqual(self.mill.look()["position_mm"][2], 5, places=2)

    def test_the_origin_is_set_from_the_command_line(self):
        run = self.machine("origin", "--machine", "Mill", "--yes")
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("--axes xyz", run.stderr)
        for wrong in (("--axes", "xa"), ("--at", "middle"), ("--at", "corner", "--axes", "xyz")):
            self.assertEqual(self.machine("origin", "--machine", "Mill", "--yes", *wrong).returncode, 2)
        run = self.machine("origin", "--machine", "Mill", "--axes", "xyz", "--yes")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("xyz is 0 at the head", run.stdout)
        run = self.machine("origin", "--machine", "Mill", "--at", "corner", "--yes")  # it has no switches to know a corner by
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("machine without limit switches", run.stderr)

    def test_a_frame_moves_on_the_axes_that_the_job_names(self):
        job = self.folder / "along_y.gcode"
        job.write_text("G0 Y10\nG1 Y30 F600\n")
        self.assertEqual(self.machine("frame", "--machine", "Mill", "--job", job, "--yes").returncode, 0)
        job.write_text("G53 G0 Y10\n")
        run = self.machine("frame", "--machine", "Mill", "--job", job, "--yes")
        self.assertEqual(run.returncode, 2)
        self.assertIn("Line 1 goes to a place in machine coordinates", run.stderr)
        job.write_text("G0 Z10\n")
        self.assertIn("does not move in x and y", self.machine("frame", "--machine", "Mill", "--job", job, "--yes").stderr)

    def test_z_is_set_again_with_the_second_tool(self):
        terminal, theirs = pty.openpty()
        process = subprocess.Popen([peers.PROGRAM, "machine", "send", "--data", self.data, "--machine", "Mill", "--yes", "--z", "here",
                                    "--job", self.jobs[0], "--job", self.jobs[1]], stdin=theirs, stdout=subprocess.PIPE, stderr=theirs, text=True)
        os.close(theirs)
        said = b""

        def wait_for(sentence: bytes):
            nonlocal said
            end = time.monotonic() + 60
            while sentence not in said:
                self.assertLess(time.monotonic(), end, said)
                if select.select([terminal], [], [], 0.2)[0]:
                    said += os.read(terminal, 4096)
            said = said[said.index(sentence) + len(sentence):]
        wait_for(b"Change the tool for")
        for answer in (b"nonsense\n", b"-3\n", b"zero\n"):
            wait_for(b"or stop:")
            os.write(terminal, answer)
        out, _ = process.communicate(timeout=60)
        os.close(terminal)
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(out.count("Done:"), 2)
        # The first job ends 5 mm over its zero, the tool is lowered by 3 mm and set to 0 there: so is the second one's end 2 mm higher.
        self.assertAlmostEqual(self.mill.look()["position_mm"][2], 7, places=2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
