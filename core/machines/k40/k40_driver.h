// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// K40 lasers with the M2Nano board: packets of 30 letters behind a CH341 chip, each asked after.
//
// A packet is "\x00" + 30 letters + their checksum; the chip's parallel mode (EPP) puts 0xA6 before every 31 bytes of a
// transfer, and 0xA0 asks for the board's status. There is no position to read and no power to set: where the head is
// follows from what was sent.
#include <deque>
#include <optional>

#include "machines/k40/egv_bounds.h"
#include "machines/driver/machine_driver.h"

namespace formwright {

/// One-wire CRC-8 (polynomial 0x8C, reflected) of a packet's 30 letters.
unsigned char one_wire_crc(std::string_view letters);
/// The USB transfer of up to 30 letters, padded with F.
Bytes k40_transfer(std::string_view letters);
/// Letters that move the head without light, from the board's home position: x to the right, y towards the front, in
/// 1/1000 inch.
std::string k40_rapid_move(int right_mil, int front_mil);
/// The packets of an EGV file, its header left out. Throws Error invalid_input ("job").
std::vector<std::string> k40_packets(std::string_view egv);

/// A job as it is sent, and how far it reaches.
struct K40Job {
  std::vector<std::string> packets;
  EgvBounds bounds;
};

class K40Driver final : public MachineDriver {
 public:
  explicit K40Driver(const DriverOptions& options) : options_(options) {}

  void opened(double now_s) override;
  void closed(double now_s) override;
  void received(ByteView bytes, double now_s) override;
  void tick(double now_s) override;
  void command(const Json& command, double now_s) override;
  std::unique_ptr<PreparedJob> prepare(ByteView job) const override;
  void load_prepared(const std::string& name, PreparedJob& job) override;
  Json state(double now_s) const override;

 private:
  enum class Doing { nothing, homing, moving, working, stopping };
  void ask(double now_s);
  void send_next(double now_s);
  void repeat(double now_s);
  void send_switch(double now_s);
  void stop(const char* how, double now_s);
  void move(double right_mm, double front_mm);
  /// Throws Error invalid_input ("job") where the head would leave the bed.
  void require_inside(double right_mm, double front_mm) const;
  void require_job_inside() const;
  std::vector<std::string> possible_commands() const;
  MachinePhase phase() const;

  DriverOptions options_;
  MachineConnection connection_ = MachineConnection::closed;
  std::vector<std::string> program_;
  EgvBounds bounds_;  // of program_
  std::string program_name_;
  std::deque<std::string> queue_;
  std::optional<std::string> unconfirmed_;  // sent; the board has not said yet that it arrived whole
  Doing doing_ = Doing::nothing;
  int status_ = 0, repeats_ = 0;
  bool asked_ = false, paused_ = false, position_known_ = false;
  bool stale_answer_ = false;  // the next one tells of the time before the stop
  // Of "PN", which holds and lets go: asked for and not sent yet; sent and not known to have arrived whole.
  bool switch_due_ = false, switch_unconfirmed_ = false;
  double asked_s_ = 0, heard_s_ = 0, sent_s_ = 0;
  std::array<double, 2> position_mm_{0, 0};  // from home: right, front
};

}  // namespace formwright
