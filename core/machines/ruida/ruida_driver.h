// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Ruida controllers over UDP: the board answers on port 40200 what arrives on 50200. A datagram is at most 1470 bytes:
// a 16-bit big-endian sum of the bytes behind it, and those bytes scrambled ("swizzled") with the model's number. Every
// datagram is acknowledged.
#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "machines/driver/machine_driver.h"
#include "machines/ruida/ruida_bounds.h"

namespace formwright {

unsigned char ruida_swizzled(unsigned char byte);
unsigned char ruida_unswizzled(unsigned char byte);
/// Plain commands as one datagram.
Bytes ruida_datagram(std::string_view plain);
/// An .rd file cut into datagrams between its commands. Throws Error invalid_input ("job").
std::vector<Bytes> ruida_datagrams(ByteView rd_file);

/// A job as it is sent, and how far it reaches.
struct RuidaJob {
  std::vector<Bytes> datagrams;
  RuidaBounds bounds;
};

class RuidaDriver final : public MachineDriver {
 public:
  explicit RuidaDriver(const DriverOptions& options) : options_(options) {}

  void opened(double now_s) override;
  void closed(double now_s) override;
  void received(ByteView datagram, double now_s) override;
  void tick(double now_s) override;
  void command(const Json& command, double now_s) override;
  std::unique_ptr<PreparedJob> prepare(ByteView job) const override;
  void load_prepared(const std::string& name, PreparedJob& job) override;
  Json state(double now_s) const override;

 private:
  void queue(std::string_view plain) { queue_.push_back(ruida_datagram(plain)); }
  void send_next(double now_s);
  void stop(double now_s);
  void hear_answer(bool taken, double now_s);
  void repeat(double now_s);
  void give_up(const char* how, const char* why, double now_s);
  void hear_memory(int address, std::int64_t value);
  void end(const char* how, double now_s);
  std::vector<std::string> possible_commands() const;
  MachinePhase phase() const;
  /// Throws Error invalid_input ("job") where the job would leave the bed.
  void require_job_inside() const;

  DriverOptions options_;
  MachineConnection connection_ = MachineConnection::closed;
  std::vector<Bytes> program_;
  RuidaBounds bounds_;  // of program_
  std::string program_name_;
  std::deque<Bytes> queue_;
  std::optional<Bytes> unconfirmed_;
  std::size_t job_left_ = 0;
  std::int64_t status_ = 0;
  int repeats_ = 0;
  bool stopping_ = false;      // what is unconfirmed is the stop
  bool stale_answer_ = false;  // to a command sent before the stop: answers do not name their command
  std::array<std::optional<double>, 2> position_mm_;
  bool paused_ = false, homed_ = false, homing_ = false, seen_running_ = false;
  double sent_s_ = 0, heard_s_ = 0, asked_s_ = 0, uploaded_s_ = -1, homing_s_ = 0;
};

}  // namespace formwright
