// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What one run of a command leaves in its folder: all of it or nothing. Files of an earlier run of the same command go
// together with it, so that no job of yesterday stands beside today's report. Which files these are is kept in
// .formwright.json; everything else in the folder is left alone.
#include <filesystem>
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

class OutputFolder {
 public:
  /// `possible_names`: what the command may write, for folders that keep no list yet.
  OutputFolder(std::filesystem::path folder, std::string command, const std::vector<std::string>& possible_names);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Throws Error{invalid_input, "--out"} when the folder cannot be made.
  void make() const;
  /// Writes aside, to the disk. Throws Error{invalid_input, "out"} when there is no room; nothing has changed then.
  void put(const std::string& name, ByteView bytes);
  /// What an earlier run of this command has left goes, what was put comes.
  void replace();
  /// What an earlier run of this command has left goes.
  void clear();

 private:
  void remove_earlier();
  void write_list(const std::vector<std::string>& names);
  void sweep() const;

  const std::filesystem::path folder_, aside_;
  const std::string command_;
  std::vector<std::string> earlier_, put_;
};

}  // namespace formwright
