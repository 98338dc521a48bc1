// SPDX-License-Identifier: GPL-3.0-or-later
// What every libFuzzer program does around its target: it counts the memory and the processor time that an input takes,
// says at its end how much the worst one took, and ends the run when the processor time of FORMWRIGHT_FUZZ_SECONDS is
// used up. libFuzzer's own limits count time that passes, which says little on a busy computer.
#include <sanitizer/allocator_interface.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "base/read_budget.h"

extern "C" int FUZZ_TARGET(const std::uint8_t* data, std::size_t size);

namespace {

std::atomic<std::int64_t> live_bytes{0}, peak_bytes{0};
double largest_mb = 0, slowest_s = 0;
constexpr double max_input_s = 10;

void count(const volatile void*, std::size_t size) {
  const std::int64_t now = live_bytes += static_cast<std::int64_t>(size);
  std::int64_t peak = peak_bytes;
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now)) {}
}
void discount(const volatile void* block) {
  live_bytes -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(block));
}

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double max_run_s() {
  const char* text = std::getenv("FORMWRIGHT_FUZZ_SECONDS");
  return text == nullptr ? 1e12 : std::atof(text);
}

void print_statistics() {
  std::fprintf(stderr, "stat::largest_mb: %.1f\nstat::slowest_s: %.2f\n", largest_mb, slowest_s);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool ready = [] {
    __sanitizer_install_malloc_and_free_hooks(count, discount);
    std::atexit(print_statistics);
    return true;
  }();
  static_cast<void>(ready);
  const std::int64_t before = live_bytes;
  peak_bytes = before;
  const double start_s = processor_s();
  FUZZ_TARGET(data, size);
  const double now_s = processor_s();
  slowest_s = std::max(slowest_s, now_s - start_s);
  const std::int64_t taken = peak_bytes - before;
  largest_mb = std::max(largest_mb, static_cast<double>(taken) / (1 << 20));
  if (taken >
      static_cast<std::int64_t>(formwright::ReadBudget(size).left() + formwright::ReadBudget::uncounted_bytes)) {
    std::fprintf(stderr, "SUMMARY: %.1f MB for %zu bytes\n", static_cast<double>(taken) / (1 << 20), size);
    std::abort();
  }
  if (now_s - start_s > max_input_s) {
    std::fprintf(stderr, "SUMMARY: %.1f s of processor time for %zu bytes\n", now_s - start_s, size);
    std::abort();
  }
  static const double end_s = max_run_s();
  if (now_s > end_s) {
    print_statistics();
    std::raise(SIGINT);  // libFuzzer prints its own figures and ends
  }
  return 0;
}
