// SPDX-License-Identifier: GPL-3.0-or-later
// Read before every test: cmake/precompiled.cmake.
#include "core.h"

#include <gtest/gtest.h>

#include <random>
