// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/container/zip.h"

#include <zlib.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "formats/shared/byte_order.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

constexpr std::uint32_t local_signature = 0x04034b50, central_signature = 0x02014b50, end_signature = 0x06054b50;
constexpr std::uint32_t end64_signature = 0x06064b50, locator64_signature = 0x07064b50;
constexpr std::size_t local_bytes = 30, central_bytes = 46, end_bytes = 22, locator64_bytes = 20, end64_bytes = 56;

std::uint16_t u16(const std::byte* at) { return load<std::uint16_t>(at); }
std::uint32_t u32(const std::byte* at) { return load<std::uint32_t>(at); }
std::uint64_t u64(const std::byte* at) { return load<std::uint64_t>(at); }

Bytef* zbytes(const std::byte* at) { return reinterpret_cast<Bytef*>(const_cast<std::byte*>(at)); }

/// Sizes and offset that did not fit into 32 bits stand in the extra field, in this order, only those.
bool read_zip64_extra(ByteView extra, ZipArchive::Entry& entry) {
  while (extra.size() >= 4) {
    const std::size_t id = u16(extra.data()), size = u16(extra.data() + 2);
    if (size > extra.size() - 4) return false;
    ByteView field = extra.subspan(4, size);
    extra = extra.subspan(4 + size);
    if (id != 1) continue;
    for (std::uint64_t* value : {&entry.bytes, &entry.packed_bytes, &entry.offset}) {
      if (*value != 0xFFFFFFFF) continue;
      if (field.size() < 8) return false;
      *value = u64(field.data());
      field = field.subspan(8);
    }
  }
  return true;
}

// Deflate packs a run of 258 bytes into 2 bits (RFC 1951 3.2.5): what declares more than that is damaged.
constexpr std::uint64_t max_deflate_ratio = 1032;

class Inflater {
 public:
  Inflater() {
    if (inflateInit2(&stream_, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  z_stream& stream() { return stream_; }

 private:
  z_stream stream_{};
};

}  // namespace

ZipArchive::ZipArchive(const MeshSource& source) : source_(source), budget_(source.bytes().size()) {
  const ByteView bytes = source.bytes();
  const auto cut_short = [&] { source.refuse("its zip archive ends too early; export it or copy it again."); };
  const auto damaged = [&] {
    source.refuse("the directory of its zip archive is damaged; export it or copy it again.");
  };
  if (bytes.size() < end_bytes) cut_short();
  // The end record is the last, but for a comment of at most 65535 bytes.
  std::size_t end = bytes.size() - end_bytes;
  const std::size_t lowest = end > 65535 ? end - 65535 : 0;
  while (u32(bytes.data() + end) != end_signature) {
    if (end == lowest) cut_short();
    --end;
  }
  std::uint64_t count = u16(bytes.data() + end + 10), offset = u32(bytes.data() + end + 16);
  if ((count == 0xFFFF || offset == 0xFFFFFFFF) && end >= locator64_bytes &&
      u32(bytes.data() + end - locator64_bytes) == locator64_signature) {
    const std::uint64_t end64 = u64(bytes.data() + end - locator64_bytes + 8);
    if (end64 > bytes.size() || bytes.size() - end64 < end64_bytes || u32(bytes.data() + end64) != end64_signature)
      damaged();
    count = u64(bytes.data() + end64 + 32), offset = u64(bytes.data() + end64 + 48);
  }
  // Zip without its 64-bit extension cannot number more; models and measured objects have a few dozen.
  if (count > 0xFFFF) source.refuse("its zip archive lists more than 65 535 files; pack it again with fewer.");
  for (std::uint64_t at = offset; count > 0; --count) {
    if (at > bytes.size() || bytes.size() - at < central_bytes || u32(bytes.data() + at) != central_signature)
      damaged();
    const std::byte* const record = bytes.data() + at;
    const std::size_t name = u16(record + 28), extra = u16(record + 30), comment = u16(record + 32);
    if (bytes.size() - at - central_bytes < name + extra + comment) damaged();
    Entry entry;
    entry.name = as_text(bytes.subspan(static_cast<std::size_t>(at + central_bytes), name));
    entry.method = u16(record + 10);
    entry.encrypted = (u16(record + 8) & 1) != 0;
    entry.crc = u32(record + 16);
    entry.packed_bytes = u32(record + 20), entry.bytes = u32(record + 24), entry.offset = u32(record + 42);
    if (!read_zip64_extra(bytes.subspan(static_cast<std::size_t>(at + central_bytes + name), extra), entry)) damaged();
    entry_of_name_.try_emplace(lower_case(entry.name), entries_.size());
    entries_.push_back(std::move(entry));
    at += central_bytes + name + extra + comment;
  }
}

const ZipArchive::Entry* ZipArchive::find(std::string_view name) const {
  while (name.starts_with('/')) name.remove_prefix(1);
  const auto found = entry_of_name_.find(lower_case(name));
  return found == entry_of_name_.end() ? nullptr : &entries_[found->second];
}

void ZipArchive::take(std::uint64_t bytes) {
  if (!budget_.take(bytes))
    source_.refuse("it unpacks to far more than a file of its size holds; simplify the mesh or export it again.");
}

Bytes ZipArchive::read(const Entry& entry, std::uint64_t max_bytes) {
  const ByteView bytes = source_.bytes();
  const std::string part = "the part “" + clean_text(entry.name, 60) + "” of its zip archive ";
  const auto damaged = [&] { source_.refuse(part + "is damaged; export it or copy it again."); };
  if (entry.encrypted) source_.refuse(part + "is encrypted; export it without a password.");
  if (entry.method != 0 && entry.method != 8)
    source_.refuse(part + "is packed in an unusual way; export it or pack it again as ordinary zip.");
  if (entry.offset > bytes.size() || bytes.size() - entry.offset < local_bytes ||
      u32(bytes.data() + entry.offset) != local_signature)
    damaged();
  const std::byte* const record = bytes.data() + entry.offset;
  const std::uint64_t start = entry.offset + local_bytes + u16(record + 26) + u16(record + 28);
  if (start > bytes.size() || entry.packed_bytes > bytes.size() - start) damaged();
  const ByteView packed = bytes.subspan(static_cast<std::size_t>(start), static_cast<std::size_t>(entry.packed_bytes));
  // Text of numbers packs 5 to 20 times; a bomb a thousand times.
  const std::uint64_t limit = std::min(max_bytes, budget_.left());
  if (std::max<std::uint64_t>(entry.bytes, entry.method == 0 ? packed.size() : 0) > limit)
    source_.refuse(part + "unpacks to more than " + std::to_string(limit >> 20) +
                   " MB; simplify the mesh or export it again.");

  Bytes result;
  if (entry.method == 0) {
    result.assign(packed.begin(), packed.end());
  } else {
    if (entry.bytes / max_deflate_ratio > packed.size()) damaged();
    Inflater inflater;
    z_stream& stream = inflater.stream();
    constexpr std::size_t step = 16u << 20;  // zlib counts with 32 bits; and how often it is asked to cancel
    result.resize(static_cast<std::size_t>(entry.bytes) + 1);  // one more, to see that it ends
    std::size_t in = 0, out = 0;
    int status = Z_OK;
    while (status != Z_STREAM_END) {
      source_.context().check_cancelled();
      if (out > entry.bytes) break;
      stream.next_in = zbytes(packed.data() + in);
      stream.avail_in = static_cast<uInt>(std::min(packed.size() - in, step));
      stream.next_out = zbytes(result.data() + out);
      stream.avail_out = static_cast<uInt>(std::min(result.size() - out, step));
      const uInt in_before = stream.avail_in, out_before = stream.avail_out;
      status = inflate(&stream, Z_NO_FLUSH);
      in += in_before - stream.avail_in, out += out_before - stream.avail_out;
      if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) damaged();
      if (in_before == stream.avail_in && out_before == stream.avail_out && status != Z_STREAM_END)
        damaged();  // no more to come
    }
    if (out > entry.bytes)
      source_.refuse(part + "unpacks to more than its directory says; export it or copy it again.");
    result.resize(out);
  }
  budget_.take(result.size());
  if (crc32_z(0, zbytes(result.data()), result.size()) != entry.crc) damaged();
  return result;
}

void ZipWriter::begin(const Entry& entry) {
  append(bytes_, local_signature);
  append(bytes_, std::uint16_t{20});      // version needed: deflate
  append(bytes_, std::uint16_t{0x0800});  // names in UTF-8
  append(bytes_, static_cast<std::uint16_t>(entry.method));
  append(bytes_, std::uint16_t{0});       // time
  append(bytes_, std::uint16_t{0x0021});  // 1980-01-01
  append(bytes_, entry.crc);
  append(bytes_, static_cast<std::uint32_t>(entry.packed_bytes));
  append(bytes_, static_cast<std::uint32_t>(entry.bytes));
  append(bytes_, static_cast<std::uint16_t>(entry.name.size()));
  append(bytes_, std::uint16_t{0});
  const ByteView name = as_bytes(entry.name);
  bytes_.insert(bytes_.end(), name.begin(), name.end());
  entries_.push_back(entry);
}

void ZipWriter::add(std::string_view name, std::span<const std::string> pieces, const Context& context) {
  std::vector<Bytes> packed(pieces.size());
  std::vector<uLong> crc(pieces.size());
  parallel_for(pieces.size(), 1, [&](std::size_t i, std::size_t) {
    context.check_cancelled();
    const std::string& piece = pieces[i];
    crc[i] = crc32_z(0, reinterpret_cast<const Bytef*>(piece.data()), piece.size());
    z_stream stream{};
    // Level 1: on meshes' text the best takes eight times as long for a sixth less.
    if (deflateInit2(&stream, 1, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
    if (i > 0) {
      const std::string_view before =
          std::string_view(pieces[i - 1])
              .substr(pieces[i - 1].size() - std::min<std::size_t>(pieces[i - 1].size(), 32768));
      deflateSetDictionary(&stream, reinterpret_cast<const Bytef*>(before.data()), static_cast<uInt>(before.size()));
    }
    packed[i].resize(deflateBound(&stream, static_cast<uLong>(piece.size())) + 16);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece.data()));
    stream.avail_in = static_cast<uInt>(piece.size());
    stream.next_out = zbytes(packed[i].data());
    stream.avail_out = static_cast<uInt>(packed[i].size());
    // A sync flush ends a piece on a byte, so that pieces can be joined.
    deflate(&stream, i + 1 == pieces.size() ? Z_FINISH : Z_SYNC_FLUSH);
    const bool all = stream.avail_in == 0 && stream.avail_out > 0;
    packed[i].resize(packed[i].size() - stream.avail_out);
    deflateEnd(&stream);
    if (!all) throw Error(ErrorCode::internal, "", "A part of a zip archive cannot be packed.");
  });
  Entry entry{std::string(name), 0, 0, 0, bytes_.size(), 8};
  uLong whole = crc32(0, nullptr, 0);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    whole = crc32_combine(whole, crc[i], static_cast<z_off_t>(pieces[i].size()));
    entry.packed_bytes += packed[i].size(), entry.bytes += pieces[i].size();
  }
  entry.crc = static_cast<std::uint32_t>(whole);
  begin(entry);
  bytes_.reserve(bytes_.size() + static_cast<std::size_t>(entry.packed_bytes));
  for (const Bytes& piece : packed) bytes_.insert(bytes_.end(), piece.begin(), piece.end());
}

void ZipWriter::add(std::string_view name, std::string_view text, const Context& context) {
  const std::string piece(text);
  add(name, std::span(&piece, 1), context);
}

void ZipWriter::add_stored(std::string_view name, ByteView bytes) {
  begin({std::string(name), static_cast<std::uint32_t>(crc32_z(0, zbytes(bytes.data()), bytes.size())), bytes.size(),
         bytes.size(), bytes_.size(), 0});
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

Bytes ZipWriter::finish() {
  const std::uint64_t directory = bytes_.size();
  for (const Entry& entry : entries_) {
    append(bytes_, central_signature);
    append(bytes_, std::uint16_t{20});
    append(bytes_, std::uint16_t{20});
    append(bytes_, std::uint16_t{0x0800});
    append(bytes_, static_cast<std::uint16_t>(entry.method));
    append(bytes_, std::uint16_t{0});
    append(bytes_, std::uint16_t{0x0021});
    append(bytes_, entry.crc);
    append(bytes_, static_cast<std::uint32_t>(entry.packed_bytes));
    append(bytes_, static_cast<std::uint32_t>(entry.bytes));
    append(bytes_, static_cast<std::uint16_t>(entry.name.size()));
    for (int k = 0; k < 4; ++k) append(bytes_, std::uint16_t{0});  // extra, comment, disk, internal attributes
    append(bytes_, std::uint32_t{0});
    append(bytes_, static_cast<std::uint32_t>(entry.offset));
    const ByteView name = as_bytes(entry.name);
    bytes_.insert(bytes_.end(), name.begin(), name.end());
    if (entry.bytes > 0xFFFFFFFE || directory > 0xFFFFFFFE)
      throw Error(ErrorCode::invalid_input, "mesh",
                  "The mesh is too large for a zip archive of 4 GB; choose PLY or simplify it.");
  }
  const std::uint64_t size = bytes_.size() - directory;
  append(bytes_, end_signature);
  append(bytes_, std::uint32_t{0});
  for (int k = 0; k < 2; ++k) append(bytes_, static_cast<std::uint16_t>(entries_.size()));
  append(bytes_, static_cast<std::uint32_t>(size));
  append(bytes_, static_cast<std::uint32_t>(directory));
  append(bytes_, std::uint16_t{0});
  return std::move(bytes_);
}

}  // namespace formwright
