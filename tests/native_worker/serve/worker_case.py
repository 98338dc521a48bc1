# SPDX-License-Identifier: GPL-3.0-or-later
"""A worker for every test, and jobs for it. The first word after the test's name is PROGRAM."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from worker import Worker

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
