// SPDX-License-Identifier: GPL-3.0-or-later
// What Asio and Beast would compile into every file that uses them, compiled once (their manuals: separate
// compilation).
#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>
