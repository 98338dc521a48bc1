// SPDX-License-Identifier: GPL-3.0-or-later
// What JavaScript may call to talk to machines: docs/machines.md, "In the page". Nothing else lives here.
#include <emscripten.h>

#include <deque>
#include <map>

#include "base/error.h"
#include "base/data/json_text.h"
#include "machines/controllers.h"
#include "machines/virtual_grbl/virtual_grbl.h"

namespace {

using namespace formwright;

struct Talk {
  std::unique_ptr<MachineDriver> driver;
  std::deque<Bytes> packets;
};
std::map<int, Talk> talks;
std::map<int, VirtualGrbl> virtual_machines;
int last_handle = 0;
std::string answer;
Bytes packet;

const char* keep(const Json& json) {
  answer = json.dump();
  return answer.c_str();
}

/// What `act` answers, or {"error": {code, where, message}}.
template <class Act>
const char* guarded(Act&& act) {
  try {
    return keep(act());
  } catch (const Error& error) {
    return keep({{"error", {{"code", to_string(error.code())}, {"where", error.where()}, {"message", error.what()}}}});
  } catch (const std::exception& error) {
    return keep({{"error", {{"code", "internal"}, {"where", ""}, {"message", error.what()}}}});
  }
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* fw_machine_options() {
  Json list = Json::array();
  for (const ParameterInfo& info : describe_parameters<DriverOptions>()) {
    list.push_back(parameter_schema(info));
    list.back()["name"] = info.name;
  }
  return keep(list);
}

EMSCRIPTEN_KEEPALIVE const char* fw_machine_new(const char* options) {
  return guarded([&] {
    talks[++last_handle].driver = make_machine_driver(parse_json_text(options));
    return Json{{"handle", last_handle}};
  });
}
EMSCRIPTEN_KEEPALIVE void fw_machine_drop(int handle) { talks.erase(handle); }

/// `call`: {"call": "opened" | "closed" | "received" | "tick" | "load" | "command", ...}; answers {"state", "events"}.
EMSCRIPTEN_KEEPALIVE const char* fw_machine_call(int handle, const char* call, const std::byte* data, std::size_t size,
                                                 double now_s) {
  return guarded([&] {
    Talk& talk = talks.at(handle);
    MachineDriver& driver = *talk.driver;
    const Json message = parse_json_text(call);
    const std::string what = message.at("call");
    if (what == "opened") driver.opened(now_s);
    else if (what == "closed") driver.closed(now_s);
    else if (what == "received") driver.received({data, size}, now_s);
    else if (what == "tick") driver.tick(now_s);
    else if (what == "load") driver.load(message.at("name"), {data, size});
    else driver.command(message.at("command"), now_s);
    for (Bytes& bytes : driver.take_output()) talk.packets.push_back(std::move(bytes));
    return Json{{"state", driver.state(now_s)}, {"events", driver.take_events()}};
  });
}
/// Moves on to the next packet to be written: its size, 0 when there is none.
EMSCRIPTEN_KEEPALIVE std::size_t fw_machine_next_packet(int handle) {
  auto& packets = talks.at(handle).packets;
  packet.clear();
  if (!packets.empty()) packet = std::move(packets.front()), packets.pop_front();
  return packet.size();
}

/// A laser, or with `mill` not 0 a mill (GRBL without its laser mode).
EMSCRIPTEN_KEEPALIVE int fw_virtual_new(double bed_x_mm, double bed_y_mm, int mill, double now_s) {
  VirtualGrblOptions options;
  options.laser_mode = mill == 0;
  options.origin_low = true;
  options.travel_x_mm = bed_x_mm;
  options.travel_y_mm = bed_y_mm;
  VirtualGrbl& machine = virtual_machines.emplace(++last_handle, options).first->second;
  if (mill != 0) machine.set_setting(30, 24'000);  // the speed of a usual spindle
  machine.open(now_s);
  return last_handle;
}
EMSCRIPTEN_KEEPALIVE void fw_virtual_drop(int handle) { virtual_machines.erase(handle); }
EMSCRIPTEN_KEEPALIVE void fw_virtual_receive(int handle, const char* data, std::size_t size, double now_s) {
  virtual_machines.at(handle).receive({data, size}, now_s);
}
/// Lets time pass; the size of what the machine says.
EMSCRIPTEN_KEEPALIVE std::size_t fw_virtual_advance(int handle, double now_s) {
  virtual_machines.at(handle).advance(now_s);
  packet = to_bytes(virtual_machines.at(handle).take_output());
  return packet.size();
}
EMSCRIPTEN_KEEPALIVE void fw_virtual_trip_limit(int handle) { virtual_machines.at(handle).trip_limit(); }

/// The packet, or what the virtual machine said, of the last call.
EMSCRIPTEN_KEEPALIVE const void* fw_machine_packet() { return packet.data(); }
}
