// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Several small files that belong together as one input: a zip archive.
#include <map>
#include <string>

#include "job/contract/operation.h"

namespace formwright {

/// The same files give the same bytes, so that a pack is known by its hash.
Bytes pack_files(const std::map<std::string, ByteView>& files, const Context& context);

/// The files of a pack by their names without folders. Throws Error{invalid_input, where}: no zip archive, or one of
/// `needed` is missing.
std::map<std::string, Bytes> unpack_files(const InputBlob& input, const std::string& where,
                                          const std::vector<std::string>& needed, Context& context,
                                          const std::vector<std::string>& optional = {});

/// All of a repeatable input, with their names: `name`, `name`_2, ...
std::vector<std::pair<std::string, const InputBlob*>> inputs_named(const OperationCall& call, const std::string& name);

/// What a person calls a pack: its file without ".zip", or `otherwise`.
std::string pack_name(const InputBlob& input, const std::string& otherwise);

}  // namespace formwright
