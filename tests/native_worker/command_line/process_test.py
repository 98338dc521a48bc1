#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line as a process: interrupts, bytes of file names, a terminal, help. Usage: process_test.py PROGRAM"""
import json
import os
import pathlib
import pty
import signal
import subprocess
import time
import unittest

from command_line_case import PROGRAM, TETRAHEDRON, CommandLineCase


class CommandLine(CommandLineCase):
    def test_interrupting_ends_with_130(self):
        process = subprocess.Popen([PROGRAM, "relief", "--sample", "bust", "--sample-vertices", "400000", "--out", str(self.folder / "out")],
                                   stderr=subprocess.PIPE, text=True)
        time.sleep(0.7)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=20)[1]
        self.assertEqual(process.returncode, 130)
        self.assertIn("formwright: ", said)
        self.assertFalse((self.folder / "out" / "relief.ply").exists())

    def test_names_that_are_not_utf8(self):
        out = self.folder / "out"
        path = os.fsencode(self.folder) + b"/t\xff\xfe.obj"
        pathlib.Path(os.fsdecode(path)).write_text(TETRAHEDRON)
        run = subprocess.run([PROGRAM, b"import", b"--mesh", path, b"--out", str(out), b"--quiet"], capture_output=True, timeout=300)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(json.loads((out / "report.json").read_text())["faces"], 4)

    def test_a_terminal_shows_a_bar_and_leaves_a_clean_line(self):
        master, slave = pty.openpty()
        run = subprocess.Popen([PROGRAM, "import", "--sample", "bust", "--out", str(self.folder / "out")], stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        shown = b""
        try:
            while part := os.read(master, 65536):
                shown += part
        except OSError:
            pass  # its other end closed
        os.close(master)
        self.assertEqual(run.wait(60), 0)
        self.assertIn("█".encode(), shown)
        self.assertTrue(shown.endswith(b"\r\033[K"), shown[-80:])

    def test_help_and_list_come_from_the_catalog(self):
        self.assertEqual(self.run_program().returncode, 2)
        catalog = json.loads(self.run_program("describe").stdout)
        names = [line.split("\t")[0] for line in self.run_program("list").stdout.splitlines()]
        self.assertEqual(names, [operation["name"] for operation in catalog["operations"]])
        for operation in catalog["operations"]:
            text = self.run_program(operation["name"], "--help").stdout
            for name, schema in operation["parameters"]["properties"].items():
                self.assertIn("--" + name.replace("_", "-"), text)
                self.assertIn(schema["description"], " ".join(text.split()))
            self.assertLessEqual(max(map(len, text.splitlines())), 100)


if __name__ == "__main__":
    unittest.main(verbosity=2)
