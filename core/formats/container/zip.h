// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Zip archives in memory (PKWARE APPNOTE 6.3), as 3MF is one. On zlib alone rather than minizip: an archive is a byte
// range here, never a file, what it unpacks to is limited while it unpacks, and it is packed in parallel.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/bytes.h"
#include "base/read_budget.h"
#include "formats/shared/mesh_source.h"

namespace formwright {

class ZipArchive {
 public:
  struct Entry {
    std::string name;
    std::uint64_t offset = 0;  // of the local header
    std::uint64_t packed_bytes = 0, bytes = 0;
    std::uint32_t crc = 0;
    int method = 0;  // 0 stored, 8 deflated
    bool encrypted = false;
  };

  /// Reads the directory, Zip64 included. Throws Error{invalid_input} if there is none, it is damaged, or it lists more
  /// than 65,535 entries.
  explicit ZipArchive(const MeshSource& source);

  const std::vector<Entry>& entries() const { return entries_; }
  /// By name without a leading slash, in any case (OPC 10.2.3); nullptr if there is none.
  const Entry* find(std::string_view name) const;
  /// Unpacks; throws Error{invalid_input}: damaged, encrypted, packed by another method, over `max_bytes`, or more than
  /// is left of the budget of the whole archive, against which every call counts, also of the same entry again.
  Bytes read(const Entry& entry, std::uint64_t max_bytes);
  /// For what is made of the entries. Throws Error{invalid_input} once the file has taken more than it may.
  void take(std::uint64_t bytes);

 private:
  const MeshSource& source_;
  std::vector<Entry> entries_;
  std::unordered_map<std::string, std::size_t> entry_of_name_;  // in lower case
  ReadBudget budget_;
};

/// Writes entries one after the other. Dates are 1980-01-01, so the same content gives the same bytes.
class ZipWriter {
 public:
  /// Deflates `pieces` (in parallel, each with the end of the one before as its dictionary) as one entry.
  void add(std::string_view name, std::span<const std::string> pieces, const Context& context);
  void add(std::string_view name, std::string_view text, const Context& context);
  /// As it is: for pictures, which are packed already.
  void add_stored(std::string_view name, ByteView bytes);
  /// Throws Error{invalid_input} if the archive exceeds 4 GB.
  Bytes finish();

 private:
  struct Entry {
    std::string name;
    std::uint32_t crc;
    std::uint64_t packed_bytes, bytes, offset;
    int method;
  };
  void begin(const Entry& entry);

  Bytes bytes_;
  std::vector<Entry> entries_;
};

}  // namespace formwright
