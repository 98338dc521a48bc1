// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How much memory a piece of work takes, as the kernel counts it.
#include <cstdio>
#include <cstring>
#include <optional>

#if defined(__SANITIZE_ADDRESS__)
#define FORMWRIGHT_KEEPS_FREED_MEMORY
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define FORMWRIGHT_KEEPS_FREED_MEMORY
#endif
#endif

namespace formwright::test {

/// Megabytes that resident memory rises by while `act` runs. Nothing where the kernel does not tell, as in
/// WebAssembly, or where a sanitizer keeps what was freed.
template <class Act>
std::optional<double> peak_growth_mb(const Act& act) {
#if defined(__linux__) && !defined(FORMWRIGHT_KEEPS_FREED_MEMORY)
  const auto kilobytes = [](const char* key) -> long {
    long value = -1;
    if (std::FILE* const file = std::fopen("/proc/self/status", "r")) {
      for (char line[256]; std::fgets(line, sizeof line, file) != nullptr;)
        if (std::strncmp(line, key, std::strlen(key)) == 0) std::sscanf(line + std::strlen(key), ": %ld", &value);
      std::fclose(file);
    }
    return value;
  };
  // Writing 5 sets the peak, VmHWM, to what is resident now: proc(5), clear_refs.
  std::FILE* const reset = std::fopen("/proc/self/clear_refs", "w");
  const bool is_reset = reset != nullptr && std::fputs("5", reset) >= 0 && std::fflush(reset) == 0;
  if (reset != nullptr) std::fclose(reset);
  const long before = kilobytes("VmRSS");
  act();
  const long peak = kilobytes("VmHWM");
  if (is_reset && before >= 0 && peak >= 0) return static_cast<double>(peak - before) / 1024;
#else
  act();
#endif
  return std::nullopt;
}

}  // namespace formwright::test
