// SPDX-License-Identifier: GPL-3.0-or-later
// Names the unit tests that failed and passed when asked again; setup/test.sh lists them at its end.
import type { Reporter, TestCase } from 'vitest/node';

export class FlakyReporter implements Reporter {
  onTestCaseResult(test: TestCase): void {
    if (test.diagnostic()?.flaky === true)
      console.log(`passed when asked again: ${test.module.relativeModuleId} ${test.fullName}`);
  }
}
