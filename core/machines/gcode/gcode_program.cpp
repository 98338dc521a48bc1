// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/gcode/gcode_program.h"

#include <algorithm>
#include <limits>

#include "machines/driver/machine_driver.h"

namespace formwright {
namespace {

using machines_detail::refuse;

constexpr int block_lines = 16, checkpoint_lines = 1000;

bool is_rapid(std::string_view line) {
  return line.starts_with("G0") && (line.size() == 2 || line[2] < '0' || line[2] > '9' || line.starts_with("G00"));
}

/// What the first character that stands for no number or letter tells of the file.
std::string not_gcode(const std::string& line) {
  const std::size_t strange = line.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.+-");
  const std::string shown = "\"" + line.substr(0, 30) + "\"";
  if (strange != std::string::npos && std::string_view("#[]=<>").find(line[strange]) != std::string_view::npos)
    return "calculates with parameters (" + shown + "): post the job with plain numbers.";
  if (strange != std::string::npos && line[strange] == '/')
    return "is one that some machines leave out (" + shown + "): take the line or its / out.";
  if (strange != std::string::npos && line[strange] == '*')
    return "has a checksum (" + shown + "), which the sender adds itself: save the job without.";
  return "is not G-code (" + shown + "): every letter needs a number.";
}

}  // namespace

GcodeProgram GcodeProgram::read(ByteView file, std::size_t longest_line, bool bare_letters) {
  GcodeProgram program;
  program.bare_letters_ = bare_letters;
  std::string_view text = as_text(file);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  program.text_.reserve(text.size() + 1);
  GcodeState state;
  std::string stripped;
  std::vector<GcodeWord> words;
  int number = 0;
  for (std::size_t start = 0, newline = 0; start < text.size();) {
    if (start == 0 || newline < start) newline = std::min(text.find('\n', start), text.size());
    std::string_view raw = text.substr(start, newline - start);
    raw = raw.substr(0, raw.find('\r'));  // some programs end lines with it alone
    const std::size_t end = start + raw.size();
    start = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
    if (number == std::numeric_limits<int>::max()) refuse("job", "The job has over 2,000 million lines: split it.");
    ++number;
    const auto bad = [&](const std::string& what) { refuse("job", "Line " + std::to_string(number) + " " + what); };
    if (!strip_gcode(raw, stripped)) bad("has a character that G-code does not have: choose a G-code file.");
    if (!stripped.empty()) {
      if (stripped[0] == '$') bad("changes the machine's settings ($): send that by hand, not in a job.");
      if (stripped.size() > longest_line)
        bad("has " + std::to_string(stripped.size()) + " characters, more than the " + std::to_string(longest_line) +
            " the machine takes.");
      if (!read_gcode_words(stripped, bare_letters, words)) bad(not_gcode(stripped));
      if (program.line_count_ % block_lines == 0) program.blocks_.push_back({program.text_.size(), number, false});
      if (program.line_count_ % checkpoint_lines == 0) program.checkpoints_.push_back(state);
      if (is_rapid(stripped)) program.blocks_.back().has_rapid = true;
      const std::string unclear = run_gcode_line(words, state, &program.reach_);
      if (!unclear.empty() && program.unclear_.empty())
        program.unclear_ = "Line " + std::to_string(number) + " " + unclear;
      ++program.line_count_;
    }
    program.text_ += stripped;
    program.text_ += '\n';
  }
  if (program.line_count_ == 0) refuse("job", "The job has no G-code in it: choose another file.");
  program.from_here_ = state.from_here;
  return program;
}

GcodeProgram::Found GcodeProgram::line_from(std::size_t start, int number) const {
  for (;; ++number) {
    const std::size_t end = text_.find('\n', start);
    if (end == std::string::npos) return {{}, number, text_.size()};
    if (end > start) return {std::string_view(text_).substr(start, end - start), number, end};
    start = end + 1;
  }
}

GcodeProgram::Found GcodeProgram::find(int index) const {
  const Block& block = blocks_[static_cast<std::size_t>(index / block_lines)];
  Found line = line_from(block.start, block.number);
  for (int i = index % block_lines; i > 0; --i) line = after(line);
  return line;
}

int GcodeProgram::index_of(int number) const {
  const auto block =
      std::partition_point(blocks_.begin(), blocks_.end(), [&](const Block& one) { return one.number < number; });
  int index = std::max(0, static_cast<int>(block - blocks_.begin()) - 1) * block_lines;
  while (index < line_count_ && this->number(index) < number) ++index;
  return index;
}

int GcodeProgram::rapid_before(int index) const {
  const auto within = [&](int block, int last) {
    for (int i = last; i >= block * block_lines; --i)
      if (is_rapid(line(i))) return i;
    return -1;
  };
  for (int block = index / block_lines, last = index; block >= 0; --block, last = (block + 1) * block_lines - 1)
    if (blocks_[static_cast<std::size_t>(block)].has_rapid)
      if (const int found = within(block, last); found >= 0) return found;
  return 0;
}

std::size_t GcodeProgram::memory_bytes() const {
  return text_.capacity() + blocks_.capacity() * sizeof(Block) + checkpoints_.capacity() * sizeof(GcodeState);
}

GcodeState GcodeProgram::state_before(int index) const {
  const int checkpoint = std::min(index / checkpoint_lines, static_cast<int>(checkpoints_.size()) - 1);
  if (checkpoint < 0) return {};
  GcodeState state = checkpoints_[static_cast<std::size_t>(checkpoint)];
  std::vector<GcodeWord> words;
  for_each_line(checkpoint * checkpoint_lines, index, [&](std::string_view line, int) {
    if (read_gcode_words(line, bare_letters_, words)) run_gcode_line(words, state, nullptr);
  });
  return state;
}

}  // namespace formwright
