// SPDX-License-Identifier: GPL-3.0-or-later
// Pages that listen for progress and ends.
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <iostream>

#include "base/data/json_text.h"
#include "server/http_server.h"

namespace formwright {

using boost::asio::use_awaitable;

boost::asio::awaitable<void> HttpServer::serve_page_socket(std::shared_ptr<PageSocket> page, Head head) {
  boost::system::error_code error;
  beast::get_lowest_layer(page->stream).expires_never();
  page->stream.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
  page->stream.set_option(beast::websocket::stream_base::decorator(
      [](beast::websocket::response_type& r) { r.set(http::field::sec_websocket_protocol, "formwright.v1"); }));
  page->stream.read_message_max(64 * 1024);
  co_await page->stream.async_accept(head, boost::asio::redirect_error(use_awaitable, error));
  if (error) co_return;
  pages_.insert(page);
  try {
    for (;;) {
      beast::flat_buffer buffer;
      co_await page->stream.async_read(buffer, boost::asio::redirect_error(use_awaitable, error));
      if (error) break;
      hear_page(beast::buffers_to_string(buffer.data()));
    }
  } catch (const std::exception& mistake) {
    std::cerr << "formwright: socket: " << mistake.what() << std::endl;
  }
  // No guard object: it would outlive the server when the io_context goes. Writes under way hold the page.
  pages_.erase(page);
}

void HttpServer::tell_pages(const Json& message) {
  const auto text = std::make_shared<const std::string>(message.dump());
  const auto listeners = pages_;
  for (const auto& page : listeners) {
    if (page->outgoing.size() > 500) {  // it does not read: progress piles up
      beast::get_lowest_layer(page->stream).close();
      continue;
    }
    page->outgoing.push_back(text);
    if (page->outgoing.size() == 1) write_next(page);
  }
}

void HttpServer::write_next(const std::shared_ptr<PageSocket>& page) {
  page->stream.text(true);
  page->stream.async_write(boost::asio::buffer(*page->outgoing.front()),
                           [this, page](const boost::system::error_code& error, std::size_t) {
                             page->outgoing.pop_front();
                             if (!error && !page->outgoing.empty()) write_next(page);
                           });
}

void HttpServer::hear_page(const std::string& text) {
  const Json message = parse_json_text(text);
  if (!message.is_object() || message.value("type", Json()) != "cancel") return;
  const Json id = message.value("id", Json());
  if (id.is_string()) boost::asio::post(jobs_io_, [this, job = id.get<std::string>()] { queue_.cancel(job); });
}

}  // namespace formwright
