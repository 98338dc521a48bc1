// SPDX-License-Identifier: GPL-3.0-or-later
#include "system/secret.h"

#include <sys/random.h>

#include <array>
#include <stdexcept>

namespace formwright {

std::string random_hex(int bytes) {
  std::array<unsigned char, 64> data{};
  const auto count = static_cast<std::size_t>(bytes);
  if (count > data.size() || getrandom(data.data(), count, 0) != static_cast<ssize_t>(count))
    throw std::runtime_error("the system gave no random numbers");
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += "0123456789abcdef"[data[i] >> 4];
    text += "0123456789abcdef"[data[i] & 15];
  }
  return text;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  return difference == 0;
}

}  // namespace formwright
