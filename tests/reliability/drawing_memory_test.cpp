// SPDX-License-Identifier: GPL-3.0-or-later
// drawing_memory_test [SEED [COUNT]]: reads drawings made to take memory (hostile_drawings.h) and COUNT random changes
// of small ones, each in a process of its own. None may take more than 200 times its size and 64 MB, nor longer than a
// minute, nor end otherwise than with a drawing or an Error{invalid_input}. Prints the largest. The short form reads
// files of 7 and 170 kB; FORMWRIGHT_LONG_TESTS=1 those of 1 MB, too.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "base/error.h"
#include "fabrication/svg/svg_reader.h"
#include "reliability/hostile_drawings.h"

namespace {

using namespace formwright;

constexpr double max_seconds = 60, bytes_per_byte = 200, base_bytes = 64e6;
constexpr int skipped = 77;

struct Outcome {
  int status = 0;
  double peak_bytes = 0, seconds = 0;
};

/// 0 read, 1 refused, 2 refused without naming the drawing or a fix, 3 anything else.
int read_one(const std::string& file) {
  try {
    read_svg_drawing(as_bytes(file), {}, Context());
  } catch (const Error& error) {
    const std::string_view sentence = error.what();
    const bool sound = error.code() == ErrorCode::invalid_input && error.where() == "drawing" &&
                       sentence.ends_with('.') && sentence.find(':') != std::string_view::npos;
    return sound ? 1 : 2;
  } catch (...) {
    return 3;
  }
  return 0;
}

Outcome read_aside(const std::string& file) {
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    alarm(2 * static_cast<unsigned>(max_seconds));
    _exit(read_one(file));
  }
  Outcome outcome;
  rusage usage{};
  if (child < 0 || wait4(child, &outcome.status, 0, &usage) != child) std::abort();
  outcome.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return outcome;
}

std::string changed(std::string file, std::mt19937_64& random) {
  const char* pieces[] = {
      "1e9", "-1e-9", "<g>",  "</g>", "<use href='#a0'/>", "'", "\"", "&#0;", "url(#c)", "%", "1e308", "nan",
      "/*",  "}",     "<!--", "\xff"};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t i = 0; i <= below(8); ++i) {
    const std::size_t at = below(file.size());
    switch (below(3)) {
      case 0: file.erase(at, below(30)); break;
      case 1: file.insert(at, pieces[below(std::size(pieces))]); break;
      default: file.insert(at, file.substr(below(file.size()), below(200)));
    }
  }
  return file;
}

}  // namespace

int main(int argc, char** argv) {
#if defined(__SANITIZE_ADDRESS__)
  std::puts("not measured: the sanitizer's own memory is no measure");
  return skipped;
#endif
  const std::uint64_t seed = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1;
  const std::size_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 300;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  int failures = 0;
  double worst_share = 0, slowest = 0, worst_small = 0;
  std::string worst_name, slowest_name;
  const auto check = [&](const std::string& name, const std::string& file, bool say) {
    const Outcome outcome = read_aside(file);
    const double ceiling = bytes_per_byte * static_cast<double>(file.size()) + base_bytes;
    const bool ended = WIFEXITED(outcome.status) && WEXITSTATUS(outcome.status) <= 1;
    const bool good = ended && outcome.peak_bytes <= ceiling && outcome.seconds <= max_seconds;
    if (!good) ++failures;
    if (say || !good)
      std::printf("%s %-30s %8zu bytes %8.1f MB of %6.1f %6.2f s %s\n", good ? "  " : "NO", name.c_str(), file.size(),
                  outcome.peak_bytes / 1e6, ceiling / 1e6, outcome.seconds,
                  !ended                             ? "ended badly"
                  : WEXITSTATUS(outcome.status) == 0 ? "read"
                                                     : "refused");
    if (file.size() <= 10'000) worst_small = std::max(worst_small, outcome.peak_bytes);
    if (outcome.peak_bytes / ceiling > worst_share) worst_share = outcome.peak_bytes / ceiling, worst_name = name;
    if (outcome.seconds > slowest) slowest = outcome.seconds, slowest_name = name;
    return good;
  };
  std::vector<std::size_t> sizes{7'000, 170'000};
  if (std::getenv("FORMWRIGHT_LONG_TESTS") != nullptr) sizes.push_back(1'000'000);
  for (const std::size_t size : sizes)
    test::hostile_drawings(size, [&](const std::string& name, const std::string& file) { check(name, file, true); });
  std::mt19937_64 random(seed);
  std::vector<std::string> small;
  test::hostile_drawings(600, [&](const std::string&, const std::string& file) { small.push_back(file); });
  for (std::size_t i = 0; i < count; ++i) {
    const std::string file = changed(small[random() % small.size()], random);
    if (!check("changed " + std::to_string(i), file, false)) std::printf("%s\n", file.c_str());
  }
  std::printf(
      "largest share of the ceiling: %.0f %% (%s); files up to 10 kB: at most %.0f MB; longest: %.2f s (%s); %d failed\n",
      100 * worst_share, worst_name.c_str(), worst_small / 1e6, slowest, slowest_name.c_str(), failures);
  return failures == 0 ? 0 : 1;
}
