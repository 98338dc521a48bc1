// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Commands and flags of the shell: operations from the catalog, and the few commands that are no operation. Help,
// completions and the manual are made from these.
#include <string>
#include <vector>

#include "job/contract/operation.h"

namespace formwright {

/// What a shell can propose after a flag. `none`: anything else that the person types.
enum class FlagValue { none, file, folder, choice, no_value };

struct FlagInfo {
  std::string name, placeholder, help, group;  // "--mesh", "FILE", ...; group: the heading in the help
  FlagValue value = FlagValue::none;
  std::vector<std::string> choices = {};  // when value is choice
};

/// "thickness_mm" -> "--thickness-mm"
std::string dashed(std::string name);

/// Flags of one operation in the order of its help: input, files, then parameters by group.
std::vector<FlagInfo> operation_flags(const Operation& operation);

struct CommandInfo {
  std::string name, summary;
  std::vector<std::string> words = {};  // which may follow the name, such as subcommands; empty when none
  std::vector<FlagInfo> flags = {};
};

/// Commands beside the operations, in the order of the overview.
const std::vector<CommandInfo>& other_commands();

/// Is there an input from the folder of a measured object (--object)?
bool takes_object(const Operation& operation);

}  // namespace formwright
