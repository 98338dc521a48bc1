// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_page.h"

#include <catch2/catch_test_macros.hpp>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace formwright {
namespace {

using boost::asio::awaitable;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;

// A machine's state is told ten times a second, also while a page is still shaking hands.
TEST_CASE("machine_page.hears_nothing_before_the_handshake_is_done") {
  boost::asio::io_context io;
  tcp::acceptor acceptor(io, {boost::asio::ip::address_v4::loopback(), 0});
  tcp::socket asking(io);
  asking.connect(acceptor.local_endpoint());
  const auto page = std::make_shared<MachinePage>(beast::websocket::stream<beast::tcp_stream>(acceptor.accept()));

  std::string heard;
  boost::asio::co_spawn(
      io,
      [&]() -> awaitable<void> {
        co_await page->stream().async_accept(use_awaitable);
        page->accepted();
        page->send({{"told", "in time"}});
      },
      [](const std::exception_ptr& mistake) { CHECK_FALSE(mistake); });
  io.poll();  // it waits for the request now
  page->send({{"told", "too early"}});
  page->send_state(std::make_shared<const std::string>("too early"));
  boost::asio::co_spawn(
      io,
      [&]() -> awaitable<void> {
        beast::websocket::stream<beast::tcp_stream> client(std::move(asking));
        co_await client.async_handshake("127.0.0.1", "/", use_awaitable);
        beast::flat_buffer buffer;
        co_await client.async_read(buffer, use_awaitable);
        heard = beast::buffers_to_string(buffer.data());
        page->hang_up();
      },
      [](const std::exception_ptr& mistake) { CHECK_FALSE(mistake); });
  io.run_for(std::chrono::seconds(20));
  CHECK(heard == R"({"told":"in time"})");
}

}  // namespace
}  // namespace formwright
