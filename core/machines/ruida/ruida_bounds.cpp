// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/ruida/ruida_bounds.h"

#include <array>
#include <cstdint>
#include <span>

#include "machines/driver/machine_driver.h"
#include "machines/ruida/ruida_driver.h"

namespace formwright {
namespace {

using machines_detail::refuse;

/// A command byte and the seven-bit bytes behind it.
struct Command {
  unsigned code = 0;
  std::span<const unsigned char> parameters;

  bool is(unsigned first, unsigned second) const {
    return code == first && !parameters.empty() && parameters[0] == second;
  }
  /// A signed number of `bytes` seven-bit bytes, the highest first.
  std::int64_t number(std::size_t from, std::size_t bytes) const {
    if (from + bytes > parameters.size()) refuse("job", "The Ruida job is incomplete or damaged: make it again.");
    std::int64_t value = 0;
    for (std::size_t i = from; i < from + bytes; ++i) value = value << 7 | parameters[i];
    const std::int64_t sign = std::int64_t{1} << (7 * bytes - 1);
    return value & sign ? value - 2 * sign : value;
  }
};

class Reader {
 public:
  void take(const Command& command) {
    const unsigned what = command.code;
    if ((what >= 0x88 && what <= 0x8b) || (what >= 0xa8 && what <= 0xab)) return move(command, what >= 0xa8);
    if (command.is(0xd8, 0x10)) from_zero_ = true;
    else if (command.is(0xd8, 0x11) || command.is(0xd8, 0x12)) from_panel_ = true;
    // Copies across and along; files of one copy say 0 or 1.
    else if ((command.is(0xe7, 0x04) || command.is(0xe7, 0x08) || command.is(0xf2, 0x05)) &&
             (command.number(1, 2) > 1 || command.number(3, 2) > 1))
      refuse(
          "job",
          "The job repeats itself as an array, so its size is not known here: use the frame button at the laser's panel.");
    // One axis by itself, and jumps: of z and u they do not matter.
    else if (command.is(0x80, 0x00) || command.is(0xa0, 0x00) ||
             (what == 0xd9 && !command.is(0xd9, 0x02) && !command.is(0xd9, 0x03)))
      refuse(
          "job",
          "The job moves to positions that are not in the file, so its size is not known here: use the frame button at the laser's panel.");
  }

  RuidaBounds bounds() const {
    if (from_panel_ || !from_zero_)
      refuse(
          "job",
          "The job starts from a position that is set at the laser's panel, so its place is not known here: use the frame button at the panel.");
    if (bounds_.worked.empty) refuse("job", "The job burns nothing: choose another.");
    return bounds_;
  }

 private:
  void move(const Command& command, bool burn) {
    const std::array<double, 3> from = at_mm_;
    const unsigned kind = command.code & 3u;  // both absolute; both relative; x; y
    if (kind == 0) {
      at_mm_ = {1e-3 * static_cast<double>(command.number(0, 5)), 1e-3 * static_cast<double>(command.number(5, 5)), 0};
    } else {
      if (kind != 3) at_mm_[0] += 1e-3 * static_cast<double>(command.number(0, 2));
      if (kind != 2) at_mm_[1] += 1e-3 * static_cast<double>(command.number(kind == 1 ? 2 : 0, 2));
    }
    if (!placed_ && (burn || kind != 0))
      refuse("job", "The job moves before it gives a position, so its size is not known: make it again.");
    placed_ = true;
    bounds_.reached.add(at_mm_);
    if (!burn) return;
    bounds_.worked.add(from);
    bounds_.worked.add(at_mm_);
  }

  RuidaBounds bounds_;
  std::array<double, 3> at_mm_{0, 0, 0};
  bool placed_ = false, from_zero_ = false, from_panel_ = false;
};

}  // namespace

RuidaBounds ruida_job_bounds(ByteView rd_file) {
  std::vector<unsigned char> plain;
  plain.reserve(rd_file.size());
  for (const std::byte byte : rd_file) plain.push_back(ruida_unswizzled(std::to_integer<unsigned char>(byte)));
  if (plain.empty() || plain[0] < 0x80)
    refuse("job", "The file is not a Ruida job (.rd): make the job again for this controller.");
  Reader reader;
  for (std::size_t start = 0; start < plain.size();) {
    std::size_t end = start + 1;
    while (end < plain.size() && plain[end] < 0x80) ++end;
    reader.take({plain[start], std::span(plain).subspan(start + 1, end - start - 1)});
    start = end;
  }
  return reader.bounds();
}

}  // namespace formwright
