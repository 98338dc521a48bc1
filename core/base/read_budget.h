// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How much memory reading one file may take: 64 MB and 200 bytes for each of its own. Counted where memory is taken,
// by what is there and not by what the file declares.
#include <cstdint>

namespace formwright {

class ReadBudget {
 public:
  static constexpr std::uint64_t base_bytes = 64u << 20, per_input_byte = 200;

  /// Of this the readers' small parts and the allocator's rounding take what no reader counts.
  static constexpr std::uint64_t uncounted_bytes = 4u << 20;

  explicit ReadBudget(std::uint64_t input_bytes) : left_(base_bytes - uncounted_bytes + per_input_byte * input_bytes) {}

  std::uint64_t left() const { return left_; }
  /// False where `bytes` are more than is left, which is then nothing.
  bool take(std::uint64_t bytes) {
    const bool fits = bytes <= left_;
    left_ = fits ? left_ - bytes : 0;
    return fits;
  }

 private:
  std::uint64_t left_;
};

}  // namespace formwright
