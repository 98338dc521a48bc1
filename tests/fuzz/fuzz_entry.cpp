// SPDX-License-Identifier: GPL-3.0-or-later
// What every libFuzzer program does around its target: it counts the memory that an input takes, and says at its end
// how much the worst one took and how long the slowest.
#include <sanitizer/allocator_interface.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "base/read_budget.h"

extern "C" int FUZZ_TARGET(const std::uint8_t* data, std::size_t size);

namespace {

std::atomic<std::int64_t> live_bytes{0}, peak_bytes{0};
double largest_mb = 0, slowest_s = 0;

void count(const volatile void*, std::size_t size) {
  const std::int64_t now = live_bytes += static_cast<std::int64_t>(size);
  std::int64_t peak = peak_bytes;
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now)) {}
}
void discount(const volatile void* block) {
  live_bytes -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(block));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool ready = [] {
    __sanitizer_install_malloc_and_free_hooks(count, discount);
    std::atexit([] { std::fprintf(stderr, "stat::largest_mb: %.1f\nstat::slowest_s: %.2f\n", largest_mb, slowest_s); });
    return true;
  }();
  static_cast<void>(ready);
  const std::int64_t before = live_bytes;
  peak_bytes = before;
  const auto start = std::chrono::steady_clock::now();
  FUZZ_TARGET(data, size);
  slowest_s = std::max(slowest_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  const std::int64_t taken = peak_bytes - before;
  largest_mb = std::max(largest_mb, static_cast<double>(taken) / (1 << 20));
  if (taken >
      static_cast<std::int64_t>(formwright::ReadBudget(size).left() + formwright::ReadBudget::uncounted_bytes)) {
    std::fprintf(stderr, "SUMMARY: %.1f MB for %zu bytes\n", static_cast<double>(taken) / (1 << 20), size);
    std::abort();
  }
  return 0;
}
