// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Words of a shell to job messages: flags derive from the catalog.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "job/contract/operation.h"
#include "slurm/slurm_engine.h"

namespace formwright {

struct ParsedCommand {
  Json message;                                        // without hashes: the files are named below
  std::map<std::string, std::filesystem::path> files;  // input name -> file
  /// Which files of a folder are packed; optional ones where the folder has them.
  struct FolderFiles {
    std::vector<std::string> needed, optional;
  };
  std::map<std::string, FolderFiles> folders;  // of these, folders to pack
  std::filesystem::path out, results;  // results: where intermediate results are kept; empty for out/simulations
  bool slurm = false;                  // simulations run in a Slurm cluster
  SlurmOptions slurm_options;
  bool quiet = false, help = false;
};

/// `words`: what follows the operation's name. Throws Error{invalid_input} naming the flag.
ParsedCommand parse_command(const Operation& operation, const std::vector<std::string>& words);

std::string overview_text();  // formwright, formwright --help
std::string operation_help(const Operation& operation);
std::string operation_usage(const Operation& operation);  // "formwright relief --mesh FILE --out DIR [flags]"

}  // namespace formwright
