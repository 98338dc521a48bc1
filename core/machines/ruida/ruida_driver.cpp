// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/ruida/ruida_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace formwright {
namespace {

using machines_detail::absent_number;
using machines_detail::number_of;
using machines_detail::refuse;
using machines_detail::require_confirmation;

constexpr unsigned magic = 0x88;  // RDC644x; other models differ
constexpr std::size_t datagram_bytes = 1470;
constexpr unsigned char acknowledged = 0xcc, refused = 0xcf;
constexpr double resend_s = 1, ruida_asking_s = 0.3, rest_s = 1.5;
constexpr int max_repeats = 4, card_id = 0x057e, machine_status = 0x0400, x_position = 0x0421, y_position = 0x0431;
constexpr std::int64_t status_moving = 0x01000000, status_running = 1;

/// A signed number in seven bits a byte, the highest first.
std::string coordinate(double mm) {
  const std::int64_t um = std::llround(mm * 1000);
  std::string bytes;
  for (int shift = 28; shift >= 0; shift -= 7) bytes += static_cast<char>((um >> shift) & 0x7f);
  return bytes;
}

std::string read_memory(int address) {
  return {static_cast<char>(0xda), 0, static_cast<char>(address >> 8), static_cast<char>(address & 0xff)};
}

}  // namespace

unsigned char ruida_swizzled(unsigned char byte) {
  unsigned b = byte;
  b ^= (b >> 7) & 0xffu;
  b ^= (b << 7) & 0xffu;
  b ^= (b >> 7) & 0xffu;
  return static_cast<unsigned char>(((b ^ magic) + 1) & 0xffu);
}

unsigned char ruida_unswizzled(unsigned char byte) {
  unsigned b = ((byte - 1u) & 0xffu) ^ magic;
  b ^= (b >> 7) & 0xffu;
  b ^= (b << 7) & 0xffu;
  b ^= (b >> 7) & 0xffu;
  return static_cast<unsigned char>(b);
}

Bytes ruida_datagram(std::string_view plain) {
  Bytes datagram(2);
  unsigned sum = 0;
  for (const char c : plain) {
    const unsigned char byte = ruida_swizzled(static_cast<unsigned char>(c));
    sum += byte;
    datagram.push_back(std::byte{byte});
  }
  datagram[0] = static_cast<std::byte>((sum >> 8) & 0xffu);
  datagram[1] = static_cast<std::byte>(sum & 0xffu);
  return datagram;
}

std::vector<Bytes> ruida_datagrams(ByteView rd_file) {
  std::string plain;
  for (const std::byte byte : rd_file)
    plain += static_cast<char>(ruida_unswizzled(std::to_integer<unsigned char>(byte)));
  const auto begins_command = [](char c) { return (static_cast<unsigned char>(c) & 0x80u) != 0; };
  if (plain.empty() || !begins_command(plain[0]))
    refuse("job", "The file is not a Ruida job (.rd): make the job again for this controller.");
  std::vector<Bytes> datagrams;
  for (std::size_t start = 0; start < plain.size();) {
    std::size_t end = std::min(start + datagram_bytes - 2, plain.size());
    if (end < plain.size())
      while (end > start + 1 && !begins_command(plain[end])) --end;
    datagrams.push_back(ruida_datagram(std::string_view(plain).substr(start, end - start)));
    start = end;
  }
  return datagrams;
}

void RuidaDriver::opened(double now_s) {
  *this = RuidaDriver(options_);
  connection_ = MachineConnection::greeting;
  heard_s_ = now_s;
  queue(read_memory(card_id));
  send_next(now_s);
}

void RuidaDriver::closed(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (job_active()) {
    end("cut_off", now_s);
    note(
        "The connection to the laser was lost. If it had received the whole job, it continues by itself: stop it at its panel.",
        now_s);
  }
  drop_output();
  queue_.clear();
  unconfirmed_.reset();
  homed_ = paused_ = homing_ = stopping_ = stale_answer_ = false;
  position_mm_ = {};
  connection_ = MachineConnection::closed;
}

void RuidaDriver::send_next(double now_s) {
  if (unconfirmed_ || queue_.empty()) return;
  unconfirmed_ = queue_.front();
  queue_.pop_front();
  sent_s_ = now_s;
  write(as_text(*unconfirmed_));
}

void RuidaDriver::received(ByteView datagram, double now_s) {
  if (connection_ == MachineConnection::closed || datagram.empty()) return;
  heard_s_ = now_s;
  connection_ = MachineConnection::ready;
  std::vector<unsigned char> plain;
  for (const std::byte byte : datagram) plain.push_back(ruida_unswizzled(std::to_integer<unsigned char>(byte)));
  if (plain.size() == 1 && (plain[0] == acknowledged || plain[0] == refused))
    return hear_answer(plain[0] == acknowledged, now_s);
  // A reply to a question: DA 01, address, five bytes of seven bits.
  if (plain.size() >= 9 && plain[0] == 0xda && plain[1] == 0x01) {
    std::int64_t value = 0;
    for (std::size_t i = 4; i < 9; ++i) value = value << 7 | (plain[i] & 0x7f);
    hear_memory(plain[2] << 8 | plain[3], value);
  }
  const bool resting = (status_ & (status_moving | status_running)) == 0;
  if (job_active() && job_left_ == 0) {
    seen_running_ = seen_running_ || !resting;
    if (resting && (seen_running_ || now_s - uploaded_s_ > rest_s) && now_s - uploaded_s_ > ruida_asking_s)
      end("done", now_s);
  }
  if (homing_ && resting && now_s - homing_s_ > rest_s) homing_ = false, homed_ = true;
}

void RuidaDriver::hear_answer(bool taken, double now_s) {
  if (!unconfirmed_ || std::exchange(stale_answer_, false)) return;
  if (!taken) {
    if (++repeats_ <= max_repeats) return repeat(now_s);
    return give_up("failed",
                   stopping_
                       ? "The laser refuses to stop: stop it at its own panel or switch it off."
                       : "The laser rejects the commands: check that its controller is a Ruida of a supported model.",
                   now_s);
  }
  unconfirmed_.reset();
  repeats_ = 0;
  stopping_ = false;
  if (job_active() && job_left_ > 0 && job_left_ > queue_.size()) {
    --job_left_;
    job_->acknowledged = job_->line_now = job_->line_count - static_cast<int>(job_left_);
    if (job_left_ == 0) uploaded_s_ = now_s;
  }
  send_next(now_s);
}

void RuidaDriver::repeat(double now_s) {
  write(as_text(*unconfirmed_));
  sent_s_ = now_s;
}

void RuidaDriver::give_up(const char* how, const char* why, double now_s) {
  note(why, now_s);
  queue_.clear();
  unconfirmed_.reset();
  repeats_ = 0;
  stopping_ = stale_answer_ = false;
  end(how, now_s);
}

void RuidaDriver::hear_memory(int address, std::int64_t value) {
  if (address == machine_status) status_ = value;
  if (value & (std::int64_t{1} << 34)) value -= std::int64_t{1} << 35;
  if (address == x_position) position_mm_[0] = 1e-3 * static_cast<double>(value);
  if (address == y_position) position_mm_[1] = 1e-3 * static_cast<double>(value);
}

void RuidaDriver::tick(double now_s) {
  if (connection_ == MachineConnection::closed) return;
  if (unconfirmed_ && now_s - sent_s_ > resend_s) {
    // A datagram or its answer was lost.
    if (++repeats_ > max_repeats) {
      connection_ = MachineConnection::silent;
      homed_ = false;
      return give_up("cut_off",
                     stopping_
                         ? "The laser does not answer the stop: if it moves, stop it at its own panel or switch it off."
                         : "The laser does not answer: check that it is on, its network cable, and its address.",
                     now_s);
    }
    repeat(now_s);
  }
  if (queue_.empty() && !unconfirmed_ && now_s - asked_s_ > ruida_asking_s) {
    asked_s_ = now_s;
    for (const int address : {machine_status, x_position, y_position}) queue(read_memory(address));
  }
  send_next(now_s);
}

void RuidaDriver::end(const char* how, double now_s) {
  if (!end_job(how, now_s)) return;
  job_left_ = 0;
  paused_ = false;
}

MachinePhase RuidaDriver::phase() const {
  if (stopping_) return MachinePhase::stopping;
  if (connection_ != MachineConnection::ready) return MachinePhase::unknown;
  if (homing_) return MachinePhase::homing;
  if (job_active()) return paused_ ? MachinePhase::paused : MachinePhase::running;
  return status_ & status_running  ? MachinePhase::running
         : status_ & status_moving ? MachinePhase::jogging
                                   : MachinePhase::idle;
}

std::vector<std::string> RuidaDriver::possible_commands() const {
  std::vector<std::string> can;
  if (connection_ == MachineConnection::closed) return can;
  can.push_back("stop");
  const MachinePhase now = phase();
  if (now == MachinePhase::running) can.push_back("pause");
  if (now == MachinePhase::paused) can.push_back("resume");
  if (now != MachinePhase::idle) return can;
  can.insert(can.end(), {"home", "jog"});
  if (homed_) can.insert(can.end(), {"go_to", "frame"});
  if (homed_ && !program_.empty()) can.push_back("start");
  return can;
}

void RuidaDriver::stop(double now_s) {
  end("stopped", now_s);
  queue_.clear();
  drop_output();
  homed_ = homing_ = paused_ = false;
  stale_answer_ = stale_answer_ || (unconfirmed_ && !stopping_);
  stopping_ = true;
  repeats_ = 0;
  unconfirmed_ = ruida_datagram("\xd8\x01");
  sent_s_ = now_s;
  write_urgently(as_text(*unconfirmed_));
}

void RuidaDriver::command(const Json& command, double now_s) {
  const std::string what = machines_detail::command_name(command, connection_);
  if (what == "stop") return stop(now_s);
  const std::vector<std::string> can = possible_commands();
  if (std::find(can.begin(), can.end(), what) == can.end()) {
    if ((what == "start" || what == "frame" || what == "go_to") && phase() == MachinePhase::idle && !homed_)
      refuse(what, "Where the head stands is unknown: home the laser first.");
    if (what == "start" && program_.empty()) refuse(what, "No job is loaded: choose one first.");
    if (what == "focus" || what == "set_origin" || what == "override")
      refuse(what, "This is only possible at the laser's own panel.");
    machines_detail::refuse_in_phase(what, phase());
  }
  const auto go = [&](double x_mm, double y_mm) {
    if (x_mm < -1e-6 || y_mm < -1e-6 || x_mm > options_.bed_x_mm || y_mm > options_.bed_y_mm)
      refuse("job", "This move would leave the bed of " + machines_detail::decimal(options_.bed_x_mm) + " by " +
                        machines_detail::decimal(options_.bed_y_mm) + " mm.");
    queue(std::string("\xd9\x10\x00", 3) + coordinate(x_mm) + coordinate(y_mm));
  };
  if (what == "home") {
    require_confirmation(command, "The head moves to its switches");
    queue("\xd8\x2a");
    homing_ = true;
    homed_ = false;
    homing_s_ = now_s;
  } else if (what == "jog") {
    if (!position_mm_[0] || !position_mm_[1])
      refuse("jog", "The laser has not reported its position yet: wait a moment.");
    go(*position_mm_[0] + number_of(command, "x_mm", -2000, 2000, 0),
       *position_mm_[1] + number_of(command, "y_mm", -2000, 2000, 0));
  } else if (what == "go_to")
    go(number_of(command, "x_mm", 0, 2000, absent_number), number_of(command, "y_mm", 0, 2000, absent_number));
  else if (what == "frame") {
    require_confirmation(command, "The head moves once around the job, laser off");
    const std::array<double, 4> b = machines_detail::bounds_of(command);
    for (const auto& [x, y] : machines_detail::corners_around(b)) go(x, y);
  } else if (what == "start") {
    require_confirmation(command, "The laser moves and its beam turns on");
    if (number_of(command, "from_line", 1, 1e9, 1) > 1)
      refuse("from_line", "A Ruida laser can continue a stopped job only at its own panel: start the job again.");
    require_job_inside();
    queue_.insert(queue_.end(), program_.begin(), program_.end());
    job_left_ = program_.size();
    const int count = static_cast<int>(program_.size());
    job_ = MachineJob{program_name_, count, count, 0, 0, now_s, 0, ""};
    seen_running_ = false;
    uploaded_s_ = -1;
  } else if (what == "pause" || what == "resume") {
    if (what == "resume") require_confirmation(command, "The laser continues with its beam on");
    paused_ = what == "pause";
    queue_.push_front(ruida_datagram(paused_ ? "\xd8\x02" : "\xd8\x03"));
    if (job_left_ > 0) ++job_left_;
  }
  send_next(now_s);
}

void RuidaDriver::require_job_inside() const {
  const GcodeBounds& reached = bounds_.reached;
  const std::array<double, 2> bed{options_.bed_x_mm, options_.bed_y_mm};
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (reached.low_mm[axis] < -1e-3 || reached.high_mm[axis] > bed[axis] + 1e-3)
      refuse("job", std::string("The job would leave the bed in ") + "xy"[axis] + ": it goes from " +
                        machines_detail::decimal(reached.low_mm[axis]) + " to " +
                        machines_detail::decimal(reached.high_mm[axis]) + " mm, and the bed from 0 to " +
                        machines_detail::decimal(bed[axis]) + " mm. Move the job or make it smaller.");
}

std::unique_ptr<PreparedJob> RuidaDriver::prepare(ByteView job) const {
  RuidaJob read;
  read.datagrams = ruida_datagrams(job);
  read.bounds = ruida_job_bounds(job);
  return machines_detail::prepared(std::move(read));
}

void RuidaDriver::load_prepared(const std::string& name, PreparedJob& job) {
  if (job_active()) refuse("job", "A job is running: stop it before another is loaded.");
  RuidaJob& taken = machines_detail::program_in<RuidaJob>(job);
  std::swap(program_, taken.datagrams);
  bounds_ = taken.bounds;
  program_name_ = name;
  job_.reset();
}

Json RuidaDriver::state(double now_s) const {
  Json state = common_state("ruida", connection_, phase(), {homed_, homed_, false}, now_s);
  if (position_mm_[0] && position_mm_[1])
    state["machine_mm"] = state["work_mm"] = {*position_mm_[0], *position_mm_[1], 0};
  state["when_connection_ends"] = "The laser continues with what it has received of the job: stop it at its panel.";
  state["can"] = possible_commands();
  return state;
}

}  // namespace formwright
