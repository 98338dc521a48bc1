// SPDX-License-Identifier: GPL-3.0-or-later
// What the virtual machine does as grblHAL does (core of August 2026: protocol.c, report.c, system.c), where that is
// not what GRBL 1.1 does.
#include "machines/virtual_grbl/virtual_grbl.h"

namespace formwright {

void VirtualGrbl::become_grblhal() {
  options_.error_latch = true;
  options_.planner_blocks = 100;
  options_.rx_bytes = 1024;
  // Bits of $22: homes, and wants to be homed first. $44 to $46: which axes home.
  if (options_.homes) settings_[22] = 5;
  for (const auto& [number, value] : {std::pair{9, 1}, {34, 0}, {39, 1}, {44, 4}, {45, 3}, {46, 0}, {63, 3}})
    settings_[number] = value;
}

/// protocol_enqueue_realtime_command: 0x80 to 0x82 are heard wherever they stand; behind a $ that begins a line, until
/// that line is done, ? ! ~ are text unless $39 says otherwise. 0 where the byte is text.
unsigned char VirtualGrbl::heard_as(unsigned char c) {
  if (c >= 0x80 && c <= 0x82) return static_cast<unsigned char>("?~!"[c - 0x80]);
  const bool begins = rx_.empty() ? !in_line_ : rx_.back() == '\n';
  if (c == '$' && begins) keeps_printable_ = settings_.at(39) == 0;
  return c;
}

/// CMD_JOG_CANCEL empties the buffer in every state; what it held is never answered.
void VirtualGrbl::cancel_unread_lines() {
  rx_.clear();
  last_error_ = 0;  // ASCII_CAN in protocol_main_loop
}

void VirtualGrbl::report_build() {
  const bool low = options_.origin_low, locks = (static_cast<int>(settings_.at(22)) & 4) != 0;
  output_ += std::string("[VER:1.1f.20260817:]\r\n[OPT:VN") + (low ? "Z" : "") + (locks ? "" : "L") + "," +
             std::to_string(options_.planner_blocks) + "," + std::to_string(options_.rx_bytes) +
             ",3,0]\r\n[AXS:3:XYZ]\r\n[NEWOPT:ENUMS,RT" + (settings_.at(39) != 0 ? "+" : "-") +
             (options_.homes ? ",HOME" : "") + ",TC,SED]\r\n[FIRMWARE:grblHAL]\r\n";
}

/// M6 is answered, and no line is read until somebody presses cycle start (tool_change.c).
void VirtualGrbl::then_change_tool() {
  then_wait_for_rest();
  then([this] {
    modes_.spindle = 5;
    set_spindle(5, 0);
    if (state_ == "Idle") state_ = "Tool";
    return true;
  });
}

}  // namespace formwright
