// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How many requests one may make: `burst` at once, and `per_second` in the long run.
#include <algorithm>
#include <chrono>

namespace formwright {

class RateBudget {
 public:
  RateBudget(double per_second, double burst) : per_second_(per_second), burst_(burst), left_(burst) {}
  /// False where the budget is used up.
  bool take() {
    refill();
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }
  /// Until the next one may be taken.
  std::chrono::milliseconds wait() {
    refill();
    return std::chrono::milliseconds(left_ >= 1 ? 0 : 1 + static_cast<int>(1000 * (1 - left_) / per_second_));
  }

 private:
  void refill() {
    const auto now = std::chrono::steady_clock::now();
    left_ = std::min(burst_, left_ + per_second_ * std::chrono::duration<double>(now - filled_).count());
    filled_ = now;
  }
  double per_second_, burst_, left_;
  std::chrono::steady_clock::time_point filled_ = std::chrono::steady_clock::now();
};

}  // namespace formwright
