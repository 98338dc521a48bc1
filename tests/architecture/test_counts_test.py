#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""setup/test_counts.sh on logs as the runners write them."""
import pathlib
import subprocess
import tempfile
import unittest

COUNTS = pathlib.Path(__file__).resolve().parents[2] / "setup/test_counts.sh"

CTEST_FIRST = """\
1/4 Test #1: base.Json.Reads ..................   Passed    0.02 sec
2/4 Test #2: relief.Relief.AsksForCancel ......***Failed    0.40 sec
3/4 Test #3: native_worker.machine_marlin .....***Timeout 600.01 sec
4/4 Test #4: reliability.long_run .............***Skipped   0.01 sec

50% tests passed, 2 tests failed out of 4

Total Test time (real) = 600.46 sec

The following tests did not run:
\t  4 - reliability.long_run (Skipped)

The following tests FAILED:
\t  2 - relief.Relief.AsksForCancel (Failed)
\t  3 - native_worker.machine_marlin (Timeout)
Errors while running CTest
"""
CTEST_AGAIN_ONE = """\
50% tests passed, 1 tests failed out of 2

The following tests FAILED:
\t  2 - relief.Relief.AsksForCancel (Failed)
"""
CTEST_AGAIN_NONE = "100% tests passed, 0 tests failed out of 2\n"
PLAYWRIGHT = """\
  1) run_a_machine.spec.ts:12:1 › a machine is stopped ──────────────────

    Error: expect(locator).toBeVisible() failed

  1 failed
    make_a_relief.spec.ts:40:1 › a relief is kept ───────────────────────
  2 flaky
    run_a_machine.spec.ts:12:1 › a machine is stopped ──────────────────
    everyone.spec.ts:15:1 › with the keyboard alone ─────────────────────
  3 did not run
  27 passed (4.1m)
"""


class Counts(unittest.TestCase):
    def call(self, function, log):
        with tempfile.NamedTemporaryFile("w", suffix=".log") as file:
            file.write(log)
            file.flush()
            return subprocess.run(["bash", "-euo", "pipefail", "-c", f'. "$1"; {function} "$2"', "bash", COUNTS, file.name], capture_output=True, text=True, check=True).stdout

    def test_ctest(self):
        self.assertEqual(self.call("count_ctest", CTEST_FIRST), "1 2\n")
        self.assertEqual(self.call("count_ctest", CTEST_FIRST + CTEST_AGAIN_ONE), "2 1\n")
        self.assertEqual(self.call("count_ctest", CTEST_FIRST + CTEST_AGAIN_NONE), "3 0\n")
        self.assertEqual(self.call("count_ctest", "ninja: error\n"), "0 0\n")

    def test_what_passed_before_counts(self):
        before = "1385 tests passed before with the same programs and data\n"
        self.assertEqual(self.call("count_ctest", before), "1385 0\n")
        self.assertEqual(self.call("count_ctest", before + CTEST_FIRST), "1386 2\n")
        self.assertEqual(self.call("count_playwright", "115 tests passed before with the same programs and data\n"), "115 0\n")

    def test_ctests_that_pass_when_asked_again_are_named(self):
        self.assertEqual(self.call("flaky_ctest", CTEST_FIRST), "")
        self.assertEqual(self.call("flaky_ctest", CTEST_FIRST + CTEST_AGAIN_ONE), "native_worker.machine_marlin\n")
        self.assertEqual(self.call("flaky_ctest", CTEST_FIRST + CTEST_AGAIN_NONE), "relief.Relief.AsksForCancel\nnative_worker.machine_marlin\n")

    def test_unit_tests_of_the_page(self):
        self.assertEqual(self.call("count_vitest", " Test Files  41 passed (41)\n      Tests  394 passed (394)\n"), "394 0\n")
        self.assertEqual(self.call("count_vitest", "      Tests  2 failed | 390 passed | 1 skipped | 1 todo (394)\n"), "390 2\n")
        self.assertEqual(self.call("count_vitest", "      Tests  389 passed (394)\n"), "389 5\n")
        self.assertEqual(self.call("count_vitest", "the configuration could not be read\n"), "0 0\n")
        log = "passed when asked again: src/jobs/jobs.test.ts a job is kept\n      Tests  1 passed (1)\n"
        self.assertEqual(self.call("flaky_vitest", log), "src/jobs/jobs.test.ts a job is kept\n")

    def test_stories(self):
        self.assertEqual(self.call("count_playwright", PLAYWRIGHT), "29 4\n")
        self.assertEqual(self.call("flaky_playwright", PLAYWRIGHT), "run_a_machine.spec.ts:12:1 › a machine is stopped\neveryone.spec.ts:15:1 › with the keyboard alone\n")
        self.assertEqual(self.call("flaky_playwright", "  30 passed (3.9m)\n"), "")


if __name__ == "__main__":
    unittest.main()
