// SPDX-License-Identifier: GPL-3.0-or-later
// Read before every file of the native worker: cmake/precompiled.cmake.
#include "core.h"

#include <boost/asio.hpp>
#include <boost/beast.hpp>
