#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Our Marlin driver and OctoPrint's virtual printer, which nobody here wrote: numbers, checksums, requests, lost answers, waiting.
Usage: machine_marlin_test.py PROGRAM VIRTUAL_GRBL PEERS"""
import itertools
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import machine_peers as peers
from machine_driven_test import MachineSocket
from worker import Worker


class OctoPrintPrinter:
    """tests/native_worker/octoprint_printer.py"""

    def __init__(self, folder: pathlib.Path, **settings):
        words = [f"{name}={json.dumps(value)}" for name, value in settings.items()]
        self.process = subprocess.Popen([peers.PEERS / "bin/python", pathlib.Path(__file__).parent / "octoprint_printer.py", folder, *words],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = self.process.stdout.readline().strip()

    def ask(self, words: str) -> None:
        self.process.stdin.write(words + "\n")
        self.process.stdin.flush()

    def debug(self, *words: str) -> None:
        for word in words:
            self.ask("debug " + word)

    def look(self) -> dict:
        self.ask("look")
        return json.loads(self.process.stdout.readline())

    def stop(self) -> None:
        peers.end(self.process)


def lines(count: int, feed: int = 30000) -> list[str]:
    """Moves, no two of which are alike."""
    return [f"G1X{i % 40}Y{i // 40}E{i * 0.5:.1f}F{feed}" for i in range(count)]


def job(moves: list[str], before: str = "", after: str = "") -> bytes:
    return "\n".join(["G21", "G90", "G28", before, *moves, after]).encode() + b"\n"


def without_repeats(moves: list[str]) -> list[str]:
    """The printer may ask again for what it has done already, and then does it twice."""
    return [move for move, _ in itertools.groupby(moves)]


class Marlin(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.data = self.folder / "data"
        self.things = []

    def tearDown(self):
        for thing in self.things:
            thing.stop()
        self.temporary.cleanup()

    def printer(self, **settings) -> OctoPrintPrinter:
        printer = OctoPrintPrinter(self.folder / "printer", **settings)
        self.things.append(printer)
        peers.add_machine(self.data, "Printer", f"serial:{printer.port}", "--controller", "marlin_printer")
        return printer

    def page(self) -> MachineSocket:
        worker = Worker(peers.PROGRAM, self.data)
        self.things.append(worker)
        self.worker = worker
        machine = next(m["id"] for m in worker.json("GET", "/api/machines")[1] if m["name"] == "Printer")
        page = MachineSocket(worker, machine)
        self.assertEqual(page.ask(open={}), {"done": 1})
        page.wait(lambda s: s["connection"] == "ready" and s["phase"] == "idle", 30)
        return page

    def started(self, page: MachineSocket, program: bytes) -> MachineSocket:
        self.assertIn("done", page.ask(load={"name": "job.gcode", "sha256": self.worker.put_blob(program)}))
        self.assertIn("done", page.do("start", confirmed=True))
        return page

    def under_way(self, page: MachineSocket, lines: int = 20) -> None:
        page.wait(lambda s: s["job"] and not s["job"]["ended"] and s["job"]["acknowledged"] > lines)

    def ended(self, page: MachineSocket, seconds: float = 90) -> str:
        return page.wait(lambda s: s["job"] and s["job"]["ended"], seconds)["job"]["ended"]

    def test_greeting_home_jog_and_frame(self):
        printer = self.printer()
        page = self.page()
        state = page.wait(lambda s: s["machine_mm"] and "hotend_c" in s["temperatures"])
        self.assertEqual(state["firmware"], "Virtual Marlin 1.0")
        self.assertAlmostEqual(state["temperatures"]["hotend_c"], 21.3, delta=0.5)
        self.assertIn("error", page.do("frame", bounds_mm=[1, 2, 3, 4], confirmed=True))
        self.assertIn("done", page.do("home", confirmed=True))
        page.wait(lambda s: s["position_known"] and s["phase"] == "idle")
        self.assertIn("done", page.do("jog", x_mm=10, z_mm=5, speed_mm_per_s=50))
        state = page.wait(lambda s: s["machine_mm"] == [10, 0, 5])
        self.assertAlmostEqual(state["temperatures"]["bed_c"], 21.3, delta=0.5)  # not the motor called B
        self.assertIn("done", page.do("frame", bounds_mm=[1, 2, 33, 44], confirmed=True))
        page.wait(lambda s: s["phase"] == "jogging")
        page.wait(lambda s: s["phase"] == "idle")
        # It has been around when the driver says so, not only heard of it.
        seen = printer.look()
        self.assertEqual((seen["moved"], seen["position_mm"][:2]), (6, [1, 2]))
        self.assertEqual([re.findall("[XY][0-9.]+", move) for move in seen["moves"][1:]], [["X1", "Y2"], ["X33", "Y2"], ["X33", "Y44"], ["X1", "Y44"], ["X1", "Y2"]])
        self.assertIn("done", page.do("override", feed_percent=80))
        peers.wait_until(lambda: printer.look()["feed_percent"] == 80, 5, "the override")

    def test_simulated_errors_of_every_kind(self):
        # Its own defaults: lines 100, 105, 110 and 115 go wrong, each in a way of its own.
        printer = self.printer()
        page = self.page()
        moves = lines(200)
        self.started(page, job(moves))
        self.assertEqual(self.ended(page), "done", page.events[-20:])
        seen = printer.look()
        # Line 105 it asks for again, throws away without a word and takes for done: that one nobody can save.
        done = without_repeats(seen["moves"])
        self.assertEqual([move for move in moves if move in done], done)
        self.assertGreaterEqual(len(done), len(moves) - 1)
        self.assertEqual((seen["moved"], seen["refusals"] >= 4), (len(seen["moves"]), True), "done was said before all had been moved")

    def test_a_noisy_line(self):
        printer = self.printer(simulated_errors=[], spoil_percent=20)
        page = self.page()
        moves = lines(150)
        self.started(page, job(moves))
        self.assertEqual(self.ended(page), "done")
        seen = printer.look()
        self.assertEqual(seen["moves"], moves)
        self.assertGreater(seen["refusals"], 15)

    def errors_one_by_one(self, **settings):
        printer = self.printer(simulated_errors=[], **settings)
        page = self.page()
        moves = lines(400, feed=2000)
        self.started(page, job(moves))
        for words in ("trigger_resend_lineno", "trigger_resend_checksum", "trigger_missing_checksum", "trigger_missing_lineno", "dont_answer", "prepare_ok k",
                      "prepare_ok o", "send echo:busy: processing", "send //action:notification Heating"):
            self.under_way(page, 1)
            before = page.state["job"]["acknowledged"]
            printer.debug(words)
            page.wait(lambda s: s["job"]["acknowledged"] > before + 8, 60)
        self.assertEqual(self.ended(page), "done", page.events[-20:])
        seen = printer.look()
        # A line that is asked for again though it was done is done again; behind it comes the rest.
        self.assertEqual(list(dict.fromkeys(seen["moves"])), moves)
        self.assertEqual(seen["moved"], len(seen["moves"]))

    def test_debug_triggers_with_wait(self):
        self.errors_one_by_one()

    def test_debug_triggers_without_wait(self):
        self.errors_one_by_one(sendWait=False)

    def test_requests_without_the_extra_ok(self):
        printer = self.printer(brokenResend=True, simulated_errors=["60:resend", "70:checksum_mismatch", "80:missing_lineno"])
        page = self.page()
        moves = lines(140)
        self.started(page, job(moves))
        self.assertEqual(self.ended(page), "done")
        self.assertEqual(without_repeats(printer.look()["moves"]), moves)

    def test_answers_before_the_work(self):
        printer = self.printer(okBeforeCommandOutput=True, okFormatString="ok N{lastN} P0 B{buffer}")
        page = self.page()
        moves = lines(60)
        self.started(page, job(moves, after="G4 P3000"))
        self.assertEqual(self.ended(page), "done")
        seen = printer.look()
        self.assertEqual((seen["moves"], seen["moved"]), (moves, 60))

    def test_heating_is_waited_for(self):
        for settings in ({}, {"sendBusy": True, "busyInterval": 1.0}):
            with self.subTest(settings):
                printer = OctoPrintPrinter(self.folder / f"printer{len(settings)}", **settings)
                self.things.append(printer)
                peers.add_machine(self.data, "Printer", f"serial:{printer.port}", "--controller", "marlin_printer")
                page = self.page()
                self.started(page, job(lines(20), before="M140 S30\nM190 S30\nM104 S60\nM109 S60"))
                page.wait(lambda s: 40 < s["temperatures"].get("hotend_c", 0) < 58, 60)
                self.assertEqual(printer.look()["moves"], [])
                self.assertEqual(self.ended(page), "done")
                seen = printer.look()
                self.assertEqual((seen["moves"], seen["targets_c"]), (lines(20), [60, 30]))
                self.assertGreater(seen["hotend_c"], 58)
                page.vanish()
                self.things.pop().stop()
                peers.formwright("remove", "Printer", data=self.data)

    def test_a_long_silence_is_not_the_end(self):
        # A wait of 14 s without a word, and without "busy": longer than the driver waits for an answer. What it sends then is only buffered.
        printer = self.printer(sendWait=False, simulated_errors=[])
        page = self.page()
        moves = lines(8, feed=600)
        self.started(page, job(moves[:4], after="\n".join(["G4 P14000", *moves[4:]])))
        self.assertEqual(self.ended(page), "done")
        seen = printer.look()
        self.assertEqual((seen["moves"], seen["moved"]), (moves, 8), "done was said before all had been moved")

    def test_stop_ends_it_and_turns_the_heaters_off(self):
        printer = self.printer()
        page = self.page()
        self.started(page, job(lines(2000, feed=2000), before="M104 S40\nM140 S35"))
        self.under_way(page, 30)
        self.assertIn("done", page.do("stop"))
        self.assertEqual(self.ended(page, 5), "stopped")
        page.wait(lambda s: s["phase"] == "idle")
        peers.wait_until(lambda: printer.look()["targets_c"] == [0, 0], 5, "the heaters going off")
        seen = len(printer.look()["moves"])
        time.sleep(1.5)
        self.assertEqual(len(printer.look()["moves"]), seen)
        self.assertFalse(page.state["position_known"])
        # And it can be used again.
        self.started(page, job(lines(10)))
        self.assertEqual(self.ended(page), "done")

    def test_stop_while_it_heats_and_hears_nothing(self):
        printer = self.printer()
        page = self.page()
        self.started(page, job(lines(20), before="M109 S220"))
        page.wait(lambda s: s["temperatures"].get("hotend_c", 0) > 25)
        self.assertIn("done", page.do("stop"))
        state = page.wait(lambda s: s["phase"] == "alarm", 10)
        self.assertIn("M112", state["alarm"]["text"])
        peers.wait_until(lambda: printer.look()["halted"], 5, "the printer hearing of it")
        self.assertEqual(state["job"]["ended"], "stopped")

    def test_a_halt_and_a_restart_end_the_job(self):
        printer = self.printer()
        page = self.page()
        self.started(page, job(lines(2000, feed=2000)))
        self.under_way(page)
        printer.debug("trigger_fatal_error_marlin")
        state = page.wait(lambda s: s["phase"] == "alarm", 10)
        self.assertIn("Thermal Runaway", state["alarm"]["text"])
        self.assertEqual(state["job"]["ended"], "failed")
        printer.debug("reset")
        state = page.wait(lambda s: s["phase"] == "idle", 10)
        self.assertFalse(state["position_known"])
        self.started(page, job(lines(2000, feed=2000)))
        self.under_way(page)
        printer.debug("reset")
        self.assertEqual(self.ended(page, 10), "failed")
        self.assertTrue(any("restarted by itself" in e.get("text", "") for e in page.events))
        done = len(printer.look()["moves"])
        time.sleep(1)
        self.assertEqual(len(printer.look()["moves"]), done)

    def test_the_same_line_over_and_over_is_given_up(self):
        printer = self.printer()
        page = self.page()
        self.started(page, job(lines(2000, feed=2000), before="M104 S40"))
        self.under_way(page)
        printer.debug("rerequest_last")
        state = page.wait(lambda s: s["phase"] == "alarm", 30)
        self.assertEqual(state["job"]["ended"], "failed")
        self.assertIn("over and over", state["alarm"]["text"])
        # What turns off went without a number, and was heard.
        peers.wait_until(lambda: printer.look()["targets_c"] == [0, 0], 5, "the heaters going off")

    def test_a_pulled_cable(self):
        printer = self.printer()
        page = self.page()
        self.started(page, job(lines(2000, feed=2000)))
        self.under_way(page)
        printer.stop()
        while "closed" not in (message := page.take()):
            pass
        self.assertIn("no longer connected", message["error"]["message"])
        self.assertEqual(page.state["job"]["ended"], "cut_off")
        self.assertFalse(page.state["position_known"])

    def test_from_the_command_line(self):
        printer = self.printer(simulated_errors=[], spoil_percent=10)
        moves = lines(80)
        (self.folder / "job.gcode").write_bytes(job(moves))
        run = peers.formwright("send", "--machine", "Printer", "--job", self.folder / "job.gcode", "--yes", data=self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("Done: 83 lines", run.stdout)
        seen = printer.look()
        self.assertEqual((without_repeats(seen["moves"]), seen["moved"]), (moves, len(seen["moves"])))
        run = peers.formwright("frame", "--machine", "Printer", "--job", self.folder / "job.gcode", "--yes", data=self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(printer.look()["position_mm"][:2], [0, 0])
        self.assertEqual(printer.look()["moved"], seen["moved"] + 5)


if __name__ == "__main__":
    unittest.main(verbosity=2)
