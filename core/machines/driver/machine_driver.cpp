// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/driver/machine_driver.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/error.h"

namespace formwright {

const char* to_string(MachinePhase phase) {
  static constexpr const char* names[] = {"unknown", "idle",     "homing", "jogging", "running", "pausing",
                                          "paused",  "stopping", "alarm",  "door",    "check",   "sleep"};
  return names[static_cast<std::size_t>(phase)];
}

const char* to_string(MachineConnection connection) {
  static constexpr const char* names[] = {"closed", "greeting", "ready", "silent"};
  return names[static_cast<std::size_t>(connection)];
}

std::vector<Bytes> MachineDriver::take_output() {
  urgent_count_ = 0;
  return std::exchange(output_, {});
}

Json MachineDriver::take_events() { return std::exchange(events_, Json::array()); }

std::vector<std::string> MachineDriver::lines_in(ByteView bytes) {
  constexpr std::size_t longest = 1024;  // noise must not grow without end
  std::vector<std::string> lines;
  for (const char c : as_text(bytes)) {
    if (c == '\n' || c == '\r') {
      if (!heard_.empty()) lines.push_back(std::exchange(heard_, {}));
    } else if (heard_.size() < longest) {
      heard_ += c >= 0x20 && c <= 0x7e ? c : '?';  // any byte may arrive; what is shown is plain text
    }
  }
  return lines;
}

void MachineDriver::write_urgently(std::string_view bytes) {
  urgent_count_ = std::min(urgent_count_, output_.size());
  output_.insert(output_.begin() + static_cast<std::ptrdiff_t>(urgent_count_++), to_bytes(bytes));
}

void MachineDriver::say(const char* event, std::string_view text, double now_s) {
  const char* key = std::string_view(event) == "ended" ? "how" : "text";
  events_.push_back({{"event", event}, {key, text}, {"now_s", now_s}});
}

bool MachineDriver::end_job(const char* how, double now_s) {
  if (!job_active()) return false;
  job_->ended = how;
  job_->ended_s = now_s;
  say("ended", how, now_s);
  return true;
}

Json MachineDriver::common_state(const char* controller, MachineConnection connection, MachinePhase phase,
                                 const std::array<bool, 3>& axes_known, double now_s) const {
  return {{"controller", controller},
          {"connection", to_string(connection)},
          {"firmware", ""},
          {"phase", to_string(phase)},
          {"position_known", axes_known[0] && axes_known[1]},
          {"axes_known", {{"x", axes_known[0]}, {"y", axes_known[1]}, {"z", axes_known[2]}}},
          {"machine_mm", nullptr},
          {"work_mm", nullptr},
          {"speed_mm_per_s", 0},
          {"power_percent", 0},
          {"job", job_ ? machines_detail::job_json(*job_, now_s) : Json(nullptr)},
          {"alarm", nullptr},
          {"error", nullptr},
          {"laser_on", nullptr},
          {"warnings", Json::array()},
          {"when_connection_ends", ""},
          {"z_choice", nullptr}};
}

namespace machines_detail {

void refuse(const std::string& where, const std::string& sentence) {
  throw Error(ErrorCode::invalid_input, where, sentence);
}

void require_confirmation(const Json& command, const std::string& what_happens) {
  const auto confirmed = command.find("confirmed");
  if (confirmed == command.end() || *confirmed != true)
    refuse("confirmed", what_happens + ": this must first be confirmed by the person in front of the machine.");
}

ZChoice z_choice_of(const Json& command) {
  const auto found = command.find("z");
  if (found != command.end() && *found == "here") return ZChoice::here;
  if (found != command.end() && *found == "kept") return ZChoice::kept;
  refuse(
      "z",
      "Where is z 0 for this job? Say \"here\" when the tip of the tool touches the stock's top now, or \"kept\" when "
      "z was set with this tool before.");
}

Json z_choice_json(std::optional<double> origin_machine_mm, std::optional<double> set_s, double now_s) {
  return {{"origin_machine_mm", origin_machine_mm ? Json(*origin_machine_mm) : Json(nullptr)},
          {"set_seconds_ago", set_s ? Json(now_s - *set_s) : Json(nullptr)}};
}

double number_of(const Json& command, const char* name, double minimum, double maximum, double fallback) {
  const auto found = command.find(name);
  if (found == command.end()) {
    if (std::isnan(fallback)) refuse(name, std::string("The command needs ") + name + ".");
    return fallback;
  }
  const double value = found->is_number() ? found->get<double>() : std::nan("");
  if (!(value >= minimum && value <= maximum))
    refuse(name, std::string(name) + " must be a number from " + decimal(minimum) + " to " + decimal(maximum) + ".");
  return value;
}

std::string command_name(const Json& command, MachineConnection connection) {
  const auto found = command.is_object() ? command.find("do") : command.end();
  if (!command.is_object() || found == command.end() || !found->is_string())
    refuse("do", "A command is an object that says what to \"do\".");
  const std::string what = found->get<std::string>();
  static const char* known[] = {"stop",  "home",      "unlock", "jog",   "jog_cancel", "set_origin", "go_to",   "frame",
                                "focus", "focus_off", "start",  "pause", "resume",     "send",       "override"};
  if (std::none_of(std::begin(known), std::end(known), [&](const char* name) { return what == name; }))
    refuse("do", "There is no command \"" + what + "\".");
  if (connection == MachineConnection::closed) refuse(what, "The machine is not connected: connect it first.");
  return what;
}

void refuse_in_phase(const std::string& what, MachinePhase phase) {
  refuse(what, std::string("This cannot be done while the machine is in the state \"") + to_string(phase) + "\".");
}

std::array<double, 4> bounds_of(const Json& command) {
  const auto found = command.find("bounds_mm");
  std::array<double, 4> bounds{};
  bool good = found != command.end() && found->is_array() && found->size() == 4;
  for (std::size_t i = 0; good && i < 4; ++i) {
    good = (*found)[i].is_number() && std::abs((*found)[i].get<double>()) <= 10000;
    if (good) bounds[i] = (*found)[i].get<double>();
  }
  if (!good) refuse("bounds_mm", "bounds_mm must be four numbers: left, low, right, high.");
  return bounds;
}

std::array<std::array<double, 2>, 5> corners_around(const std::array<double, 4>& b) {
  return {{{b[0], b[1]}, {b[2], b[1]}, {b[2], b[3]}, {b[0], b[3]}, {b[0], b[1]}}};
}

std::string line_of(const Json& command, std::size_t longest) {
  const auto found = command.find("line");
  const std::string line = found != command.end() && found->is_string() ? found->get<std::string>() : "";
  if (line.empty() || line.size() > longest ||
      std::any_of(line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; }))
    refuse("line", "A line has 1 to " + std::to_string(longest) + " characters of plain text.");
  return line;
}

std::string zero_words(const Json& command, const char* space) {
  const auto found = command.find("axes");
  const std::string axes = found == command.end() ? "xy" : found->is_string() ? found->get<std::string>() : "";
  std::string words;
  for (const char axis : std::string("xyz"))
    if (axes.find(axis) != std::string::npos)
      words += space + std::string(1, static_cast<char>(axis - 'a' + 'A')) + "0";
  if (words.empty()) refuse("axes", "axes must name x, y or z.");
  return words;
}

Json alarm_json(int code, const std::string& text, const std::string& fix) {
  return {{"code", code}, {"text", text}, {"fix", fix}, {"mend", fix}};  // "mend": the name of version 0.1
}

Json job_json(const MachineJob& job, double now_s) {
  return {{"name", job.name},
          {"line_count", job.line_count},
          {"sent", job.sent},
          {"acknowledged", job.acknowledged},
          {"line_now", job.line_now},
          {"started_s", job.started_s},
          {"seconds", (job.ended.empty() ? now_s : job.ended_s) - job.started_s},
          {"ended", job.ended.empty() ? Json(nullptr) : Json(job.ended)}};
}

std::string decimal(double value) { return with_max_decimals(value, 3); }

}  // namespace machines_detail
}  // namespace formwright
