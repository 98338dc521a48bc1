// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Files that are either whole and on the disk, or not there. What is written under a temporary name reaches the disk
// (fsync) before it gets its own name, and the folder, which holds the name, is synchronised after it.
#include <filesystem>
#include <optional>
#include <string>

#include "base/bytes.h"
#include "base/error.h"

namespace formwright {

/// The disk could not keep something: it is full, it fails, or it may not be written to.
class StorageError : public Error {
 public:
  using Error::Error;
};

/// A name beside `path` that only this process uses, once: "<path>.part-<process>-<count>".
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Throws StorageError{invalid_input, "out"} when the file cannot be written (no space, no permission); nothing is left
/// behind under a temporary name.
void write_file(const std::filesystem::path& path, ByteView bytes);

/// Makes a folder, with those above it that are missing. Throws StorageError{invalid_input, "out"}.
void make_folder(const std::filesystem::path& path);

/// Waits until what was written to a file is on the disk. Throws StorageError{invalid_input, "out"}.
void sync_file(const std::filesystem::path& path);

/// Renames within one file system; what has the new name is replaced. Throws StorageError{invalid_input, "out"}.
void move_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Removes a file or a folder with all that is in it. False when it could not be removed for good.
bool remove_for_good(const std::filesystem::path& path);

/// Whether a process of this number runs on this machine. One that has ended and whose parent has not asked for it yet
/// does not run.
bool process_runs(long process);

/// Removes from a folder (not from those in it) the temporary files of processes that do not run any more. This process
/// must not be writing there: a file of its number is of an earlier one.
void remove_abandoned_files(const std::filesystem::path& folder);

/// `content` behind a line with its SHA-256.
Bytes with_checksum(ByteView content);
/// The content again, or nothing where it is not what with_checksum() was given.
std::optional<Bytes> checked_content(ByteView file);

}  // namespace formwright
