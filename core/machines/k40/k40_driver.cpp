// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/k40/k40_driver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace formwright {
namespace {

using machines_detail::absent_number;
using machines_detail::number_of;
using machines_detail::refuse;
using machines_detail::require_confirmation;

constexpr std::size_t packet_letters = 30;
constexpr char ask_status = static_cast<char>(0xa0);
constexpr int status_ok = 206, status_checksum = 207, status_finished = 236, status_busy = 238, status_power = 239;
constexpr double k40_asking_s = 0.3, asking_busy_s = 0.02, k40_silence_s = 3, rest_s = 1.0, settled_s = 0.3,
                 rejection_s = 0.5;
constexpr double rounding_mm = 0.0128;  // jobs are written in whole steps of 1/1000 inch
constexpr int max_repeats = 10;

/// LHYMICRO-GL: z is 255; up to 51 one or two letters; three digits beyond.
std::string distance_letters(int mil) {
  std::string letters(static_cast<std::size_t>(mil / 255), 'z');
  const int rest = mil % 255;
  if (rest == 0) return letters;
  if (rest <= 25) return letters + static_cast<char>('a' + rest - 1);
  if (rest <= 51) return letters + '|' + (rest == 51 ? 'z' : static_cast<char>('a' + rest - 26));
  char digits[8];
  std::snprintf(digits, sizeof digits, "%03d", rest);
  return letters + digits;
}

}  // namespace

unsigned char one_wire_crc(std::string_view letters) {
  unsigned crc = 0;
  for (const char letter : letters) {
    auto byte = static_cast<unsigned>(static_cast<unsigned char>(letter));
    for (int bit = 0; bit < 8; ++bit, byte >>= 1) {
      const bool mix = (crc ^ byte) & 1u;
      crc >>= 1;
      if (mix) crc ^= 0x8cu;
    }
  }
  return static_cast<unsigned char>(crc);
}

Bytes k40_transfer(std::string_view letters) {
  std::string packet(letters);
  packet.resize(packet_letters, 'F');
  // 0xA6 stands before every 31 bytes: the zero and the letters, then the checksum alone.
  std::string transfer = std::string("\xa6\0", 2) + packet + "\xa6" + static_cast<char>(one_wire_crc(packet));
  return to_bytes(transfer);
}

std::string k40_rapid_move(int right_mil, int front_mil) {
  std::string letters = "I";
  if (right_mil != 0) letters += (right_mil > 0 ? "B" : "T") + distance_letters(std::abs(right_mil));
  if (front_mil != 0) letters += (front_mil > 0 ? "R" : "L") + distance_letters(std::abs(front_mil));
  return letters + "S1P";
}

std::vector<std::string> k40_packets(std::string_view egv) {
  std::vector<std::string> packets;
  std::string open;
  bool header = egv.starts_with("Document type");
  while (!egv.empty()) {
    const std::size_t end = std::min(egv.find('\n'), egv.size());
    std::string_view line = egv.substr(0, end);
    egv.remove_prefix(std::min(end + 1, egv.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (header) {
      // The body begins behind the creator's percentages.
      const std::size_t mark = line.rfind('%');
      if (mark == std::string_view::npos || !line.starts_with("%")) continue;
      header = false;
      line.remove_prefix(mark + 1);
    }
    for (const char letter : line) {
      const bool known = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                         (letter >= '0' && letter <= '9') || letter == '|' || letter == '@' || letter == '$' ||
                         letter == '-';
      if (!known) refuse("job", "The file is not in the K40's format (EGV): make the job again for this controller.");
      if (letter == '-') continue;  // "wait", which the end of the job does anyway
      open += letter;
      if (open.size() == packet_letters) packets.push_back(std::exchange(open, {}));
    }
    // The end of a line ends its packet.
    if (!open.empty()) packets.push_back(std::exchange(open, {}));
  }
  if (packets.empty()) refuse("job", "The job is empty: choose another file.");
  return packets;
}

void K40Driver::opened(double now_s) {
  *this = K40Driver(options_);
  connection_ = MachineConnection::greeting;
  heard_s_ = now_s;
  ask(now_s);
}

void K40Driver::closed(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (job_active()) {
    end_job("cut_off", now_s);
    note(
        "The connection to the laser was lost during the job. It continues with what it has received: open its lid or switch it off.",
        now_s);
  }
  drop_output();
  queue_.clear();
  unconfirmed_.reset();
  asked_ = paused_ = position_known_ = stale_answer_ = switch_due_ = switch_unconfirmed_ = false;
  doing_ = Doing::nothing;
  connection_ = MachineConnection::closed;
}

void K40Driver::ask(double now_s) {
  if (asked_) return;
  asked_ = true;
  asked_s_ = now_s;
  write(std::string_view(&ask_status, 1));
}

void K40Driver::received(ByteView bytes, double now_s) {
  // Of the six bytes of a status the second tells.
  if (connection_ == MachineConnection::closed || bytes.size() < 2) return;
  asked_ = false;
  heard_s_ = now_s;
  connection_ = MachineConnection::ready;
  if (std::exchange(stale_answer_, false)) return;
  status_ = std::to_integer<int>(bytes[1]);
  const bool stopping = doing_ == Doing::stopping;
  // A stop empties the board: one that stays busy has not heard it.
  const bool unheard = stopping && status_ == status_busy && now_s - sent_s_ > rest_s;
  // A rejection is of what went out last, be it the packet that holds or one of the job.
  if ((unconfirmed_ || switch_unconfirmed_) && (status_ == status_checksum || unheard)) return repeat(now_s);
  if (switch_unconfirmed_ && status_ != status_busy) {
    switch_unconfirmed_ = false;
    repeats_ = 0;
  }
  if (status_ == status_power)
    note("The laser's own power supply is off; its board gets power from USB only. Switch the laser on.", now_s);
  // "Busy" comes before a rejection, too: only after a while is the packet before surely in.
  const bool certain = (!unconfirmed_ && !switch_unconfirmed_) || status_ != status_busy;
  if (switch_due_ && (certain || now_s - sent_s_ > rejection_s)) send_switch(now_s);
  if (status_ == status_busy) return;  // asked again by the next tick
  if (unconfirmed_ && (status_ == status_ok || status_ == status_finished || (stopping && status_ == status_power))) {
    unconfirmed_.reset();
    repeats_ = 0;
    if (stopping) doing_ = Doing::nothing;
    if (job_active()) job_->acknowledged = job_->line_now = job_->line_count - static_cast<int>(queue_.size());
  }
  // Spoiled, and nothing unconfirmed: what that was has been given up.
  if (status_ == status_ok || status_ == status_finished || status_ == status_checksum) send_next(now_s);
  if (!queue_.empty() || unconfirmed_) return;
  // A job tells its end; homing and moves are over when the board has rested for a while.
  // Right behind the last packet the board may still tell of the job before.
  if (job_active() && status_ == status_finished && now_s - sent_s_ > settled_s)
    end_job("done", now_s), doing_ = Doing::nothing, position_mm_ = bounds_.end_mm;
  else if (!job_active() && doing_ != Doing::nothing && now_s - sent_s_ > rest_s) {
    if (doing_ == Doing::homing) position_known_ = true, position_mm_ = {0, 0};
    doing_ = Doing::nothing;
  }
}

void K40Driver::repeat(double now_s) {
  if (++repeats_ <= max_repeats) {
    write(as_text(k40_transfer(switch_unconfirmed_ ? "PN" : *unconfirmed_)));
    sent_s_ = now_s;
    return ask(now_s);
  }
  if (doing_ != Doing::stopping) {
    note("The laser reports damaged data again and again: use a shorter cable, away from the laser's power supply.",
         now_s);
    return stop("failed", now_s);
  }
  note("The laser does not take the stop: switch it off.", now_s);
  unconfirmed_.reset();
  doing_ = Doing::nothing;
}

void K40Driver::send_switch(double now_s) {
  switch_due_ = false;
  switch_unconfirmed_ = true;
  repeats_ = 0;
  say("sent", "PN", now_s);
  write_urgently(as_text(k40_transfer("PN")));
  sent_s_ = now_s;
  ask(now_s);
}

void K40Driver::send_next(double now_s) {
  if (queue_.empty() || unconfirmed_ || paused_ || switch_due_ || switch_unconfirmed_) return;
  unconfirmed_ = queue_.front();
  queue_.pop_front();
  say("sent", *unconfirmed_, now_s);
  write(as_text(k40_transfer(*unconfirmed_)));
  sent_s_ = now_s;
  if (job_active()) job_->sent = job_->line_count - static_cast<int>(queue_.size());
  ask(now_s);
}

void K40Driver::tick(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  const bool busy = !queue_.empty() || unconfirmed_ || job_active();
  if (!asked_ && now_s - asked_s_ >= (busy ? asking_busy_s : k40_asking_s)) ask(now_s);
  if (connection_ != MachineConnection::silent && now_s - heard_s_ > k40_silence_s) {
    connection_ = MachineConnection::silent;
    asked_ = false;
    note(doing_ == Doing::stopping ? "The laser does not answer the stop: switch it off."
                                   : "The laser does not answer: check that it is on and its cable plugged in.",
         now_s);
    if (job_active()) end_job("cut_off", now_s), queue_.clear(), position_known_ = false;
    if (std::exchange(switch_due_, false)) paused_ = !paused_;  // it never went out
  }
  if (connection_ == MachineConnection::silent && now_s - asked_s_ > k40_silence_s) asked_ = false;
}

MachinePhase K40Driver::phase() const {
  if (connection_ != MachineConnection::ready) return MachinePhase::unknown;
  if (status_ == status_power) return MachinePhase::alarm;
  if (doing_ == Doing::stopping) return MachinePhase::stopping;
  if (paused_) return MachinePhase::paused;
  if (doing_ == Doing::homing) return MachinePhase::homing;
  if (job_active()) return MachinePhase::running;
  return doing_ == Doing::moving ? MachinePhase::jogging : MachinePhase::idle;
}

std::vector<std::string> K40Driver::possible_commands() const {
  std::vector<std::string> can;
  if (connection_ == MachineConnection::closed) return can;
  can.push_back("stop");
  const MachinePhase now = phase();
  if (now == MachinePhase::running) can.push_back("pause");
  if (now == MachinePhase::paused) can.push_back("resume");
  if (now == MachinePhase::jogging) can.push_back("jog");
  if (now != MachinePhase::idle) return can;
  can.insert(can.end(), {"home", "unlock", "jog"});
  if (position_known_) can.insert(can.end(), {"go_to", "frame"});
  if (position_known_ && !program_.empty()) can.push_back("start");
  return can;
}

void K40Driver::move(double right_mm, double front_mm) {
  const int right = static_cast<int>(std::lround((position_mm_[0] + right_mm) / mm_per_mil)) -
                    static_cast<int>(std::lround(position_mm_[0] / mm_per_mil));
  const int front = static_cast<int>(std::lround((position_mm_[1] + front_mm) / mm_per_mil)) -
                    static_cast<int>(std::lround(position_mm_[1] / mm_per_mil));
  if (right == 0 && front == 0) return;
  position_mm_[0] += right_mm;
  position_mm_[1] += front_mm;
  const std::string letters = k40_rapid_move(right, front);
  for (std::size_t at = 0; at < letters.size(); at += packet_letters)
    queue_.push_back(letters.substr(at, packet_letters));
  doing_ = Doing::moving;
}

void K40Driver::require_inside(double right_mm, double front_mm) const {
  if (right_mm < -1e-6 || front_mm < -1e-6 || right_mm > options_.bed_x_mm + 1e-6 ||
      front_mm > options_.bed_y_mm + 1e-6)
    refuse("job", "This move would leave the bed of " + machines_detail::decimal(options_.bed_x_mm) + " by " +
                      machines_detail::decimal(options_.bed_y_mm) + " mm.");
}

void K40Driver::require_job_inside() const {
  const GcodeBounds& reached = bounds_.reached;
  const std::array<double, 2> bed{options_.bed_x_mm, options_.bed_y_mm};
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (reached.low_mm[axis] < -rounding_mm || reached.high_mm[axis] > bed[axis] + rounding_mm)
      refuse("job", std::string("The job would leave the bed ") + (axis == 0 ? "to the side" : "to the front") +
                        ": from home it goes from " + machines_detail::decimal(reached.low_mm[axis]) + " to " +
                        machines_detail::decimal(reached.high_mm[axis]) + " mm, and the bed is " +
                        machines_detail::decimal(bed[axis]) + " mm long. Move the job or make it smaller.");
}

void K40Driver::stop(const char* how, double now_s) {
  end_job(how, now_s);
  queue_.clear();
  paused_ = position_known_ = switch_due_ = switch_unconfirmed_ = false;
  doing_ = Doing::stopping;
  drop_output();
  unconfirmed_ = "I";  // the board drops everything it has
  repeats_ = 0;
  sent_s_ = now_s;
  write_urgently(as_text(k40_transfer(*unconfirmed_)));
  stale_answer_ = stale_answer_ || asked_;
  asked_ = false;
}

void K40Driver::command(const Json& command, double now_s) {
  const std::string what = machines_detail::command_name(command, connection_);
  if (what == "stop") return stop("stopped", now_s);
  const std::vector<std::string> can = possible_commands();
  if (std::find(can.begin(), can.end(), what) == can.end()) {
    if (what == "focus" || what == "override")
      refuse(what, "A K40's power is set on its panel: use its test button at low power.");
    if ((what == "start" || what == "frame" || what == "go_to") && !position_known_)
      refuse(what, "Where the head stands is unknown: home the laser first.");
    if (what == "start" && program_.empty()) refuse(what, "No job is loaded: choose one first.");
    machines_detail::refuse_in_phase(what, phase());
  }
  if (what == "home") {
    require_confirmation(command, "The head moves to its corner");
    queue_.push_back("IPP");
    doing_ = Doing::homing;
    position_known_ = false;
    sent_s_ = now_s;
  } else if (what == "unlock") {
    queue_.push_back("IS2P");  // lets the rails be moved by hand
    position_known_ = false;
  } else if (what == "jog") {
    // The bed's y goes up, the board's to the front.
    const double x = number_of(command, "x_mm", -2000, 2000, 0), y = number_of(command, "y_mm", -2000, 2000, 0);
    if (position_known_) require_inside(position_mm_[0] + x, position_mm_[1] - y);
    move(x, -y);
  } else if (what == "go_to") {
    const double x = number_of(command, "x_mm", 0, 2000, absent_number),
                 y = number_of(command, "y_mm", 0, 2000, absent_number);
    require_inside(x, options_.bed_y_mm - y);
    move(x - position_mm_[0], options_.bed_y_mm - y - position_mm_[1]);
  } else if (what == "frame") {
    require_confirmation(command, "The head moves once around the job, laser off");
    const std::array<double, 4> b = machines_detail::bounds_of(command);
    require_inside(b[0], options_.bed_y_mm - b[1]);
    require_inside(b[2], options_.bed_y_mm - b[3]);
    for (const auto& [x, y] : machines_detail::corners_around(b))
      move(x - position_mm_[0], options_.bed_y_mm - y - position_mm_[1]);
  } else if (what == "start") {
    require_confirmation(command, "The laser moves and its beam turns on");
    if (number_of(command, "from_line", 1, 1e9, 1) > 1)
      refuse("from_line", "A K40 laser cannot continue a stopped job: start it again.");
    require_job_inside();
    const int count = static_cast<int>(program_.size());
    move(-position_mm_[0], -position_mm_[1]);  // jobs begin at home
    const int moves = static_cast<int>(queue_.size());
    queue_.insert(queue_.end(), program_.begin(), program_.end());
    job_ = MachineJob{program_name_, count + moves, 0, 0, 0, now_s, 0, ""};
    doing_ = Doing::working;
  } else if (what == "pause" || what == "resume") {
    if (what == "resume") require_confirmation(command, "The laser continues with its beam on");
    paused_ = what == "pause";
    // The same packet holds and lets go: two that have not gone out cancel each other. It waits for what is known of
    // the packet before, some milliseconds, so that a rejection is never taken for the wrong one's.
    switch_due_ = !switch_due_;
    if (switch_due_ && !asked_ && !unconfirmed_ && !switch_unconfirmed_) send_switch(now_s);
  }
  ask(now_s);
}

std::unique_ptr<PreparedJob> K40Driver::prepare(ByteView job) const {
  K40Job read;
  read.packets = k40_packets(as_text(job));
  read.bounds = egv_bounds(read.packets);
  return machines_detail::prepared(std::move(read));
}

void K40Driver::load_prepared(const std::string& name, PreparedJob& job) {
  if (job_active()) refuse("job", "A job is running: stop it before another is loaded.");
  K40Job& taken = machines_detail::program_in<K40Job>(job);
  std::swap(program_, taken.packets);
  bounds_ = taken.bounds;
  program_name_ = name;
  job_.reset();
}

Json K40Driver::state(double now_s) const {
  Json state = common_state("k40", connection_, phase(), {position_known_, position_known_, false}, now_s);
  if (position_known_)
    state["machine_mm"] = state["work_mm"] = {position_mm_[0], options_.bed_y_mm - position_mm_[1], 0};
  state["when_connection_ends"] =
      "The board burns what it has received and then stops; its beam may stay on there. Open the lid or switch the laser off.";
  if (status_ == status_power)
    state["alarm"] =
        machines_detail::alarm_json(status_power, "The laser's own supply is off.", "Switch it on and home it.");
  state["can"] = possible_commands();
  return state;
}

}  // namespace formwright
