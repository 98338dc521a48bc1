// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Who is connected. Anyone on this computer may connect and ask for the page; only who has the token is the person's
// own page. The two have budgets apart, so that strangers cannot shut the page out.
#include <boost/beast/core.hpp>
#include <chrono>
#include <list>
#include <memory>

#include "system/rate_budget.h"

namespace formwright {

struct Connection {
  boost::beast::tcp_stream* stream = nullptr;  // null: not to be closed from outside
  bool known = false;                          // has shown the token
  bool answering = false;                      // in the middle of an answer
  bool closed = false;                         // by us, to make room
  std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();  // its last change
  RateBudget pages{100, 300};  // files of the page; more have to wait
};

class Connections {
 public:
  static constexpr std::size_t max_strangers = 48, max_known = 96;

  /// A new one, a stranger at first. Where there are too many, the stranger that has rested longest is closed.
  std::shared_ptr<Connection> admit();
  /// It has shown the token. False where there are too many that work; one that rests is closed.
  bool recognise(const std::shared_ptr<Connection>& connection);
  void leave(const std::shared_ptr<Connection>& connection) { all_.remove(connection); }

 private:
  std::size_t count(bool known) const;
  bool close_one(bool known, bool answering);
  std::list<std::shared_ptr<Connection>> all_;  // oldest first
};

}  // namespace formwright
