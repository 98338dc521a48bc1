// SPDX-License-Identifier: GPL-3.0-or-later
// Every fuzz target over its seeds, over what was found (tests/fuzz/found) and over some hundred alterations of both,
// in the builds that every change goes through. FORMWRIGHT_REPLAY_ALTERATIONS: how many of each input.
#include <catch2/catch_test_macros.hpp>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "base/peak_memory.h"
#include "base/read_budget.h"
#include "fuzz/seeds.h"

#define FUZZ_TARGET(name) extern "C" int fuzz_##name(const std::uint8_t* data, std::size_t size);
#include "fuzz_targets.inc"
#undef FUZZ_TARGET

namespace formwright::fuzz {
namespace {

struct Target {
  const char* name;
  int (*run)(const std::uint8_t*, std::size_t);
};

char input_now[300];

/// Targets end the process where something is wrong: then the input is named.
void name_input(int signal) {
  static_cast<void>(!::write(2, input_now, std::strlen(input_now)));
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Where the target is right it comes back, having taken no more memory than it may.
void run(const Target& target, const Bytes& bytes, const std::string& name) {
  std::snprintf(input_now, sizeof input_now, "\nThe input was %s of the target %s.\n", name.c_str(), target.name);
  const auto grown =
      test::peak_growth_mb([&] { target.run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()); });
  if (!grown) return;
  INFO(name);
  CHECK(*grown <= static_cast<double>(ReadBudget(bytes.size()).left() + ReadBudget::uncounted_bytes) / (1 << 20));
}

Bytes altered(Bytes bytes, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random() % n); };
  for (std::size_t changes = 1 + below(6); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = below(bytes.size()), size = std::min(bytes.size() - at, 1 + below(20));
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at), to = from + static_cast<std::ptrdiff_t>(size);
    switch (below(5)) {
      case 0: bytes[at] = static_cast<std::byte>(random()); break;
      case 1: bytes[at] ^= static_cast<std::byte>(1u << below(8)); break;
      case 2: bytes.erase(from, to); break;
      case 3: {
        const Bytes piece(from, to);
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), piece.begin(), piece.end());
        break;
      }
      default: std::fill(from, to, random() % 2 ? std::byte{0xff} : std::byte{'9'}); break;
    }
  }
  return bytes;
}

void replay(const Target& target) {
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE}) std::signal(signal, name_input);
  const char* const setting = std::getenv("FORMWRIGHT_REPLAY_ALTERATIONS");
  const unsigned alterations = setting != nullptr ? static_cast<unsigned>(std::atoi(setting)) : 40;
  std::map<std::string, Bytes> inputs = fuzz_seeds()[target.name];
  const std::filesystem::path found = std::filesystem::path(FORMWRIGHT_FUZZ_FOUND) / target.name;
  if (std::filesystem::exists(found)) {
    for (const auto& file : std::filesystem::directory_iterator(found)) {
      std::ifstream stream(file.path(), std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      inputs["found/" + file.path().filename().string()] = to_bytes(text);
    }
  }
  {
    INFO("the target has no seeds (tests/fuzz/seeds.cpp)");
    REQUIRE_FALSE(inputs.empty());
  }
  run(target, {}, "nothing");
  for (const auto& [name, bytes] : inputs) {
    run(target, bytes, name);
    for (unsigned seed = 1; seed <= alterations; ++seed)
      run(target, altered(bytes, seed), name + ", altered with seed " + std::to_string(seed));
  }
}

// A test each, for the memory that one target took and gave back would hide what the next one takes.
#define FUZZ_TARGET(name) \
  TEST_CASE("Replay." #name) { replay({#name, fuzz_##name}); }
#include "fuzz_targets.inc"
#undef FUZZ_TARGET

}  // namespace
}  // namespace formwright::fuzz
