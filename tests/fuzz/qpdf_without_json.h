// SPDX-License-Identifier: GPL-3.0-or-later
// Included before all else where clang compiles qpdf's headers: their JSON.hh holds a vector of a class inside that
// class, which clang 16 does not compile in C++20 with libstdc++ 12. Nothing of it is used here, so its name is enough.
#pragma once
#define JSON_HH
class JSON;
