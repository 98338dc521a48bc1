// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include "base/error.h"
#include "machines/machine_page.h"
#include "machines/machine_session.h"

namespace formwright {
namespace {

TEST_CASE("machine_request.the_four_kinds") {
  CHECK(read_machine_request(R"({"open": {"controller": "grbl"}})").content["controller"] == "grbl");
  CHECK(read_machine_request(R"({"n": 7, "command": {"do": "stop"}})").number == 7);
  const auto load = read_machine_request(R"({"load": {"name": "a", "sha256": ")" + std::string(64, 'a') + R"("}})");
  CHECK(load.kind == MachineRequest::Kind::load);
  CHECK(load.sha256 == std::string(64, 'a'));
  CHECK(read_machine_request(R"({"close": true})").kind == MachineRequest::Kind::close);
}

TEST_CASE("machine_request.anything_else_is_refused_with_a_sentence") {
  for (const std::string text :
       {"", "x", "{}", "[]", "{\"n\": 3}", "{\"open\": 3}", "{\"close\": false}", "{\"open\": {}, \"close\": true}",
        "{\"n\": 1.5, \"close\": true}", "{\"n\": 1e99, \"close\": true}",
        "{\"load\": {\"name\": \"a\", \"sha256\": \"../x\"}}", "{\"load\": {\"sha256\": 4}}", "{\"run\": {}}"}) {
    try {
      read_machine_request(text);
      FAIL_CHECK(text);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      INFO(error.what());
      CHECK(std::string(error.what()).ends_with('.'));
    }
  }
}

TEST_CASE("driver_options.a_port_has_the_controllers_that_speak_over_it") {
  Machine serial;
  serial.controller = "grbl_mill";
  serial.baud = 57600;
  const Json options = driver_options(serial, nullptr);
  CHECK(options["controller"] == "grbl");
  CHECK(options["tool"] == "mill");
  CHECK(options["baud"] == 57600);
  CHECK(driver_options(serial, {{"controller", "marlin"}})["controller"] == "marlin");
  CHECK_THROWS_AS(driver_options(serial, {{"controller", "ruida"}}), Error);
  CHECK_THROWS_AS(driver_options(serial, {{"controller", "k40"}}), Error);
  CHECK_THROWS_AS(driver_options(serial, Json::array()), Error);
  serial.controller = "marlin_printer";
  CHECK(driver_options(serial, nullptr)["controller"] == "marlin");
  CHECK(driver_options(serial, nullptr)["tool"] == "printer");
  Machine ruida;
  ruida.kind = MachineKind::ruida;
  ruida.controller = "ruida";
  CHECK(driver_options(ruida, nullptr)["controller"] == "ruida");
  CHECK_THROWS_AS(driver_options(ruida, {{"controller", "grbl"}}), Error);
}

}  // namespace
}  // namespace formwright
