#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""setup/passed_before.py on a build folder with four small tests."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

PASSED_BEFORE = pathlib.Path(__file__).resolve().parents[2] / "setup/passed_before.py"


class PassedBefore(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.outside = pathlib.Path(folder.name).resolve()
        self.build = self.outside / "build"
        self.build.mkdir()
        self.program = self.build / "program"
        self.program.write_text("#!/bin/sh\nexit $1\n")
        self.program.chmod(0o755)
        self.script = self.outside / "check.py"
        self.script.write_text("")
        (self.build / "CTestTestfile.cmake").write_text(
            f'add_test(passes "{self.program}" "0")\n'
            f'add_test(fails "{self.program}" "1")\n'
            f'add_test(script "{sys.executable}" "{self.script}" "{self.program}")\n'
            f'add_test(repository "{sys.executable}" "{self.script}")\n')

    def call(self, *words):
        return subprocess.run([sys.executable, PASSED_BEFORE, *words], capture_output=True, text=True)

    def must_run(self) -> list[int]:
        said = self.call("tests", self.build)
        self.assertEqual(said.returncode, 0, said.stderr)
        return [int(number) for number in said.stdout.split()]

    def run_tests(self) -> None:
        subprocess.run(["ctest", "--test-dir", self.build, "--output-junit", "junit.xml"], capture_output=True)
        kept = self.call("keep", self.build, self.build / "junit.xml")
        self.assertEqual(kept.returncode, 0, kept.stderr)

    def test_only_what_passed_and_is_the_same_is_left_out(self):
        self.assertEqual(self.must_run(), [1, 2, 3, 4])
        self.run_tests()
        self.assertEqual(self.must_run(), [2, 4])
        self.script.write_text("# changed\n")
        self.assertEqual(self.must_run(), [2, 3, 4])
        (self.build / "program.wasm").write_text("what the program is made of")
        self.assertEqual(self.must_run(), [1, 2, 3, 4])

    def test_what_changes_while_tests_run_is_not_kept(self):
        self.must_run()
        self.program.write_text("#!/bin/sh\n# changed\nexit $1\n")
        self.run_tests()
        self.assertEqual(self.must_run(), [1, 2, 3, 4])

    def test_what_fails_later_runs_again(self):
        self.must_run()
        self.run_tests()
        self.program.write_text("#!/bin/sh\nexit 1\n")
        self.assertEqual(self.must_run(), [1, 2, 3, 4])
        self.run_tests()
        self.program.write_text("#!/bin/sh\nexit $1\n")
        self.assertEqual(self.must_run(), [1, 2, 3, 4])

    def test_another_seed_is_another_test(self):
        self.must_run()
        self.run_tests()
        self.assertEqual(self.must_run(), [2, 4])
        os.environ["FORMWRIGHT_SEED"] = "7"
        self.addCleanup(os.environ.pop, "FORMWRIGHT_SEED")
        self.assertEqual(self.must_run(), [1, 2, 3, 4])

    def test_a_broken_record_is_no_record(self):
        self.must_run()
        self.run_tests()
        (self.build / "passed_before.json").write_text("{")
        self.assertEqual(self.must_run(), [1, 2, 3, 4])

    def test_a_hash_is_of_what_files_hold(self):
        before = self.call("hash", self.outside).stdout
        self.assertEqual(self.call("hash", self.outside).stdout, before)
        self.script.write_text("# changed\n")
        self.assertNotEqual(self.call("hash", self.outside).stdout, before)


if __name__ == "__main__":
    unittest.main()
