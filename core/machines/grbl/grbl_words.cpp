// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/grbl/grbl_words.h"

namespace formwright {
namespace {

const std::map<int, GrblWords>& common_alarms() {
  static const std::map<int, GrblWords> words = {
      {1,
       {"A limit switch was hit: the machine stopped at once and no longer knows where it is.",
        "Move the head off the switch by hand, unlock, then home."}},
      {2,
       {"The move would have left the bed, so it was not made.",
        "The position is still known: unlock, then place the job inside the bed."}},
      {3, {"The machine was reset while it moved and may have lost steps.", "Home it before going on."}},
      {4, {"The probe was in the wrong state before it began.", "Check the probe's wiring, then unlock."}},
      {5, {"The probe touched nothing in its whole travel.", "Check the probe and how far it may go, then unlock."}},
      {6, {"Homing was interrupted by a reset.", "Home again."}},
      {7, {"The door was opened while homing.", "Close it and home again."}},
      {8,
       {"Homing did not get clear of a limit switch.",
        "Move the head off the switch, or raise the pull-off ($27), and home again."}},
      {9, {"Homing found no limit switch.", "Check the switches and the travel ($130 to $132), and home again."}},
      {10,
       {"Homing of an axis with two motors found only one of its two switches.",
        "Check both switches of that axis and home again."}}};
  return words;
}

const std::map<int, std::string>& common_errors() {
  static const std::map<int, std::string> words = {{1, "A number came without its G-code letter."},
                                                   {2, "A number was missing or malformed."},
                                                   {3, "The machine does not know this $ command."},
                                                   {4, "A value that must not be negative is negative."},
                                                   {5, "Homing is not switched on in the settings ($22)."},
                                                   {6, "The step pulse is too short ($0)."},
                                                   {7, "The settings could not be read and were reset."},
                                                   {8, "This works only while the machine is idle."},
                                                   {9, "The machine is locked: home or unlock it first."},
                                                   {10, "Soft limits need homing ($20 needs $22)."},
                                                   {11, "The line was too long for the machine."},
                                                   {12, "A step rate in the settings is too high."},
                                                   {13, "The door is open."},
                                                   {14, "The line is too long to be kept in the machine."},
                                                   {15, "The jog would leave the bed."},
                                                   {16, "The jog command is malformed."},
                                                   {17, "Laser mode needs a board with a variable spindle output."},
                                                   {20, "The machine does not know this G-code command."},
                                                   {21, "Two commands of the same kind are in one line."},
                                                   {22, "The feed rate is missing."},
                                                   {23, "A whole number was needed."},
                                                   {24, "Two commands of the line both need X, Y and Z."},
                                                   {25, "A letter occurs twice in one line."},
                                                   {26, "The command needs X, Y or Z."},
                                                   {27, "The line number is out of range."},
                                                   {28, "A number that the command needs is missing."},
                                                   {29, "This work coordinate system does not exist."},
                                                   {30, "G53 needs G0 or G1."},
                                                   {31, "The line has X, Y or Z that nothing uses."},
                                                   {32, "The arc has no end in its plane."},
                                                   {33, "The target of the move is not valid."},
                                                   {34, "The arc's radius does not fit its ends."},
                                                   {35, "The arc's centre is missing."},
                                                   {36, "The line has values that nothing uses."},
                                                   {37, "The tool length offset is not set up."},
                                                   {38, "The tool number is too high."}};
  return words;
}

}  // namespace

GrblWords grbl_alarm(int code, GrblFirmware firmware) {
  if (code == 0) return {"The machine is locked.", "Home it, or unlock it where it has no switches."};
  const auto own = firmware == GrblFirmware::grblhal   ? grblhal_alarm(code)
                   : firmware == GrblFirmware::fluidnc ? fluidnc_alarm(code)
                                                       : std::nullopt;
  if (own) return *own;
  const auto found = common_alarms().find(code);
  if (found != common_alarms().end()) return found->second;
  return {"The machine raised alarm " + std::to_string(code) + ".",
          "Look it up in the controller's manual; home before going on."};
}

std::string grbl_error(int code, GrblFirmware firmware) {
  const auto own = firmware == GrblFirmware::grblhal   ? grblhal_error(code)
                   : firmware == GrblFirmware::fluidnc ? fluidnc_error(code)
                                                       : std::nullopt;
  if (own) return *own;
  const auto found = common_errors().find(code);
  return found != common_errors().end() ? found->second
                                        : "The machine refused the line with error " + std::to_string(code) + ".";
}

bool waits_for_reset(int alarm, GrblFirmware firmware) {
  // grblHAL alarms.h alarm_is_critical, FluidNC Protocol.cpp protocol_do_alarm; 1 and 2 are reset at once.
  return (firmware == GrblFirmware::grblhal && (alarm == 10 || alarm == 17 || alarm == 20)) ||
         (firmware == GrblFirmware::fluidnc && alarm == 13);
}

}  // namespace formwright
