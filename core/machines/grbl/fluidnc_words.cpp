// SPDX-License-Identifier: GPL-3.0-or-later
// FluidNC's own numbers (Alarm.h, Error.h), in our words.
#include "machines/grbl/grbl_words.h"

namespace formwright {
std::optional<GrblWords> fluidnc_alarm(int code) {
  static const std::map<int, GrblWords> words = {
      {10, {"The spindle's drive does not follow its orders.", "Check its cable and that it is on, then unlock."}},
      {11,
       {"A switch or button was pressed when the machine started.",
        "Release it, or move the head off the switch, then unlock or home."}},
      {12,
       {"Homing cannot tell which of an axis's two switches is pressed.",
        "Move the head off the switches by hand, then home."}},
      {13, {"The emergency stop is pressed.", "Release it when it is safe, then home."}},
      {14, {"The machine wants to be homed before it moves.", "Home it."}},
      {15, {"The machine has just started and is locked.", "Unlock or home it."}},
      {16,
       {"An expansion board with inputs and outputs has restarted.",
        "Check its cable, switch the machine off and on, then home."}},
      {17, {"A line was refused, and the machine is set to stop then.", "Correct that line, then unlock."}},
      {18,
       {"A limit switch was hit while the probe was moving.",
        "Move the head off the switch by hand, unlock, then home."}}};
  return word_of(words, code);
}

std::optional<std::string> fluidnc_error(int code) {
  static const std::map<int, std::string> words = {
      {5, "This is switched off in the machine's settings."},
      {18, "No axis of the machine is set up to home."},
      {19, "This axis does not home alone."},
      {39, "A numbered value of the line is out of range."},
      {40, "A switch or button was pressed when the machine started."},
      {60, "The memory card or file store could not be used."},
      {61, "The file on the board could not be read."},
      {62, "The folder on the board could not be opened."},
      {63, "The board has no such folder."},
      {64, "The file on the board is empty."},
      {65, "The board has no such file."},
      {66, "The file on the board could not be opened."},
      {67, "The board's file store is in use: try again."},
      {68, "The folder on the board could not be deleted."},
      {69, "The file on the board could not be deleted."},
      {70, "The file on the board could not be renamed."},
      {80, "The setting's number is out of range."},
      {81, "The setting does not take this value."},
      {82, "The file on the board could not be made."},
      {83, "The board's file store could not be formatted."},
      {90, "The board could not send a message."},
      {100, "The board could not keep the setting."},
      {101, "The board could not read how much room its settings take."},
      {110, "The password is wrong."},
      {113, "The board was reset meanwhile."},
      {120, "The machine takes its lines from elsewhere just now: end that first."},
      {130, "The jog was ended before it began."},
      {150, "The board's settings name a pin that it does not have."},
      {151, "That part of the board's settings does not take this value."},
      {152, "The board's settings file is not valid: correct it and restart."},
      {160, "The file could not be sent to the board."},
      {161, "The file could not be fetched from the board."},
      {162, "This setting can only be read."},
      {170, "The line divides by zero."},
      {171, "A function in the line got a value that it does not take."},
      {172, "A calculation in the line has no finite result."},
      {173, "The line calculates with an operation that the board does not know."},
      {174, "A function in the line got a number outside of what it takes."},
      {175, "A calculation in the line is malformed."},
      {176, "A jump or loop in the line is malformed."},
      {177, "Jumps and loops work only in programs that lie on the board."},
      {178, "The board has no memory left for a jump or loop."},
      {179, "Jumps or loops are nested too deeply for the board."},
      {180, "A value of the line could not be kept."},
      {181, "A number in the line is not valid there."}};
  return word_of(words, code);
}

}  // namespace formwright
