// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/file_pack.h"

#include <algorithm>

#include "base/error.h"
#include "geometry/io/zip.h"

namespace formwright {
namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;

}  // namespace

Bytes pack_files(const std::map<std::string, ByteView>& files, const Context& context) {
  ZipWriter writer;
  for (const auto& [name, bytes] : files) writer.add(name, as_text(bytes), context);
  return writer.finish();
}

std::map<std::string, Bytes> unpack_files(const InputBlob& input, const std::string& where, const std::vector<std::string>& needed, Context& context) {
  ReadOptions options;
  options.where = where;
  const MeshSource source(*input.bytes, input.file_name, options, context);
  const ZipArchive archive(source);
  std::map<std::string, Bytes> files;
  for (const ZipArchive::Entry& entry : archive.entries()) {
    const std::string name = entry.name.substr(entry.name.find_last_of('/') + 1);
    // Some archivers add notes of their own to every file.
    if (name.empty() || name.starts_with("._") || files.contains(name)) continue;
    if (std::find(needed.begin(), needed.end(), name) == needed.end()) continue;
    files.emplace(name, archive.read(entry, most_bytes));
  }
  for (const std::string& name : needed)
    if (!files.contains(name)) throw Error(ErrorCode::invalid_input, where, input.file_name + " has no " + name + ": a measured object has mould.obj, setup.json and measured.csv.");
  return files;
}

}  // namespace formwright
