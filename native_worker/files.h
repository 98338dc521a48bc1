// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Disks belong to the host. Writes go to a temporary name and are renamed, so that a full disk or a crash
// never leaves half a file under a good name.
#include <filesystem>
#include <memory>

#include "base/bytes.h"

namespace formwright {

/// Throws Error{invalid_input, where} when the file cannot be read or is larger than `limit_bytes`.
std::shared_ptr<const Bytes> read_file(const std::filesystem::path& path, const std::string& where, std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// Throws Error{invalid_input, "out"} when the file cannot be written (no space, no permission); nothing is left behind.
void write_file(const std::filesystem::path& path, ByteView bytes);

}  // namespace formwright
