// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far an iteration has come whose error falls by about the same factor from step to step.

namespace formwright {

/// For the progress of solvers that converge linearly or faster.
class Convergence {
 public:
  /// `tolerance`: the error, above 0, at which the iteration ends.
  explicit Convergence(double tolerance);

  /// Of the decades between the first error and the tolerance, the share that the smallest error so far has passed:
  /// 0 to 1, never falling. Errors that are not finite or negative change nothing.
  double passed(double error);

 private:
  double tolerance_, first_decades_ = 0, passed_ = 0;
};

}  // namespace formwright
