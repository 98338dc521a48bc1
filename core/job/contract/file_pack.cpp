// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/contract/file_pack.h"

#include <algorithm>

#include "base/error.h"
#include "formats/container/zip.h"

namespace formwright {
namespace {

constexpr std::uint64_t max_unpacked_bytes = std::uint64_t{1} << 30;

}  // namespace

Bytes pack_files(const std::map<std::string, ByteView>& files, const Context& context) {
  ZipWriter writer;
  for (const auto& [name, bytes] : files) writer.add(name, as_text(bytes), context);
  return writer.finish();
}

std::map<std::string, Bytes> unpack_files(const InputBlob& input, const std::string& where,
                                          const std::vector<std::string>& needed, Context& context,
                                          const std::vector<std::string>& optional) {
  const auto is_one_of = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  ReadOptions options;
  options.where = where;
  const MeshSource source(*input.bytes, input.file_name, options, context);
  ZipArchive archive(source);
  std::map<std::string, Bytes> files;
  for (const ZipArchive::Entry& entry : archive.entries()) {
    const std::string name = entry.name.substr(entry.name.find_last_of('/') + 1);
    // Some archivers add notes of their own to every file.
    if (name.empty() || name.starts_with("._") || files.contains(name)) continue;
    if (!is_one_of(needed, name) && !is_one_of(optional, name)) continue;
    files.emplace(name, archive.read(entry, max_unpacked_bytes));
  }
  std::string list;
  for (const std::string& name : needed) list += (list.empty() ? "" : ", ") + name;
  for (const std::string& name : needed)
    if (!files.contains(name))
      throw Error(ErrorCode::invalid_input, where, input.file_name + " has no " + name + ": it needs " + list + ".");
  return files;
}

std::vector<std::pair<std::string, const InputBlob*>> inputs_named(const OperationCall& call, const std::string& name) {
  std::vector<std::pair<std::string, const InputBlob*>> list;
  for (int number = 1; number <= 64; ++number) {
    const std::string own = number == 1 ? name : name + "_" + std::to_string(number);
    if (const auto input = call.inputs.find(own); input != call.inputs.end()) list.emplace_back(own, &input->second);
  }
  return list;
}

std::string pack_name(const InputBlob& input, const std::string& otherwise) {
  const std::string name =
      input.file_name.ends_with(".zip") ? input.file_name.substr(0, input.file_name.size() - 4) : input.file_name;
  return name.empty() ? otherwise : name;
}

}  // namespace formwright
