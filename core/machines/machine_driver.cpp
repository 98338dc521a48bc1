// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_driver.h"

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "machines/grbl_driver.h"
#include "machines/marlin_driver.h"

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

std::unique_ptr<MachineDriver> make_machine_driver(const Json& options) {
  const auto read = read_parameters<MachineOptions>(options);
  switch (read.controller) {
    case Controller::grbl: return std::make_unique<GrblDriver>(read);
    case Controller::marlin: return std::make_unique<MarlinDriver>(read);
    case Controller::k40:
    case Controller::ruida: break;
  }
  machines_detail::refuse("controller", "There is no driver for this controller: choose another.");
}

namespace machines_detail {

void refuse(const std::string& where, const std::string& sentence) { throw Error(ErrorCode::invalid_input, where, sentence); }

void require_confirmation(const Json& command, const std::string& what_happens) {
  const auto confirmed = command.find("confirmed");
  if (confirmed == command.end() || *confirmed != true)
    refuse("confirmed", what_happens + ": this must be confirmed by the person in front of the machine.");
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

std::string decimal(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f", value);
  std::string s = text;
  while (s.back() == '0') s.pop_back();
  if (s.back() == '.') s.pop_back();
  return s == "-0" ? "0" : s;
}

}  // namespace machines_detail
}  // namespace formwright
