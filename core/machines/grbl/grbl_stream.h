// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What lies in GRBL's serial buffer, as far as one can know: "character counting". Every line is answered once, in
// order, and frees its bytes only then; a line goes out when all that is unanswered leaves room for it.
#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

namespace formwright {

class GrblStream {
 public:
  struct Line {
    std::string text;       // without its end
    int job_line = -1;      // index in the job, or -1
    bool alone = false;     // writes to the EEPROM: nothing may arrive meanwhile
    double patience_s = 0;  // how much longer than others it may take
    bool pulse = false;     // of the focus light
  };

  /// 127 of the 128 bytes of an Uno; some boards tell of more.
  void set_buffer_bytes(int bytes) { buffer_bytes_ = bytes; }
  int buffer_bytes() const { return buffer_bytes_; }

  bool has_room(std::size_t length, bool alone) const {
    if (unanswered_.empty()) return true;
    return !alone && !unanswered_.back().alone && unanswered_bytes_ + static_cast<int>(length) + 1 <= buffer_bytes_;
  }
  void sent(Line line) {
    unanswered_bytes_ += static_cast<int>(line.text.size()) + 1;
    unanswered_.push_back(std::move(line));
  }
  /// The line that an ok or an error is about; none when nothing was asked.
  std::optional<Line> answered() {
    if (unanswered_.empty()) return std::nullopt;
    Line line = std::move(unanswered_.front());
    unanswered_.pop_front();
    unanswered_bytes_ -= static_cast<int>(line.text.size()) + 1;
    return line;
  }
  void clear() {
    unanswered_.clear();
    unanswered_bytes_ = 0;
  }
  bool empty() const { return unanswered_.empty(); }
  /// Is a line that begins so not answered yet?
  bool waits_for(std::string_view beginning) const {
    return std::any_of(unanswered_.begin(), unanswered_.end(),
                       [&](const Line& line) { return line.text.starts_with(beginning); });
  }
  bool waits_for_motion() const;
  int bytes() const { return unanswered_bytes_; }
  double patience_s() const {
    double sum = 0;
    for (const Line& line : unanswered_) sum += line.patience_s;
    return sum;
  }

 private:
  std::deque<Line> unanswered_;
  int unanswered_bytes_ = 0, buffer_bytes_ = 127;
};

/// Does the head move when the line is carried out? Origins are set by axis words, too.
bool moves_head(const std::string& line);

/// Does the line write to GRBL's EEPROM, which stops its serial line meanwhile?
bool writes_eeprom(const std::string& line);

}  // namespace formwright
