// SPDX-License-Identifier: GPL-3.0-or-later
// Read before every test: cmake/precompiled.cmake.
#include "core.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators_range.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <random>
