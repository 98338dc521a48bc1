// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/error.h"
#include "formats/shared/byte_order.h"
#include "formats/shared/colour.h"
#include "formats/ply/ply.h"
#include "formats/shared/text_out.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

std::string_view type_name(ColumnKind kind) {
  switch (kind) {
    case ColumnKind::uint8: return "uchar";
    case ColumnKind::int32: return "int";
    case ColumnKind::float32: return "float";
    case ColumnKind::float64: return "double";
  }
  return "";
}

std::size_t size_of(ColumnKind kind) {
  switch (kind) {
    case ColumnKind::uint8: return 1;
    case ColumnKind::float64: return 8;
    default: return 4;
  }
}

double clamped(double value, double low, double high) { return std::round(std::clamp(value, low, high)); }

/// Writes rows as bytes, one number after the other.
struct BinaryRow {
  std::byte* at;
  template <class Number>
  void add(Number value) {
    store(at, value);
    at += sizeof value;
  }
  void end() {}
};

/// The same as words of a line.
struct TextRow {
  TextOut& out;
  bool first = true;
  template <class Number>
  void add(Number value) {
    if (!first) out << ' ';
    first = false;
    if constexpr (std::is_integral_v<Number>) out << static_cast<int>(value);
    else out << value;
  }
  void end() { out << '\n'; }
};

class PlyWriter {
 public:
  PlyWriter(const Model& model, const WriteOptions& options, Context& context)
      : model_(model),
        options_(options),
        context_(context),
        uv_(model.FT.rows() > 0),
        colours_(model.vertex_colours.rows() > 0) {
    // Texture coordinates per vertex if each corner of a face takes the vertex's own row.
    per_vertex_uv_ = uv_ && model.UV.rows() == model.mesh.V.rows() && model.FT == model.mesh.F;
  }

  Bytes write() const {
    const auto vertices = static_cast<std::size_t>(model_.mesh.V.rows()),
               faces = static_cast<std::size_t>(model_.mesh.F.rows());
    std::vector<std::string> pieces{header()};
    if (options_.ascii) {
      for (auto& text : format_rows(vertices, 60, context_, [&](TextOut&out, std::size_t i) {
             TextRow row{out};
             vertex(row, i);
           }))
        pieces.push_back(std::move(text));
      for (auto& text : format_rows(faces, 28, context_, [&](TextOut&out, std::size_t i) {
             TextRow row{out};
             face(row, i);
           }))
        pieces.push_back(std::move(text));
      return concatenate(pieces);
    }
    std::size_t vertex_bytes = 24 + (per_vertex_uv_ ? 16u : 0u) + (colours_ ? 3u : 0u);
    for (const VertexColumn& column : options_.columns) vertex_bytes += size_of(column.kind);
    const std::size_t face_bytes = 13 + (uv_ && !per_vertex_uv_ ? 25u : 0u);
    Bytes bytes = to_bytes(pieces[0]);
    const std::size_t body = bytes.size();
    bytes.resize(body + vertices * vertex_bytes + faces * face_bytes);
    const auto fill = [&](std::size_t count, std::size_t row_bytes, std::byte* to, const auto& write_row) {
      parallel_for(count, 65536, [&](std::size_t begin, std::size_t end) {
        context_.check_cancelled();
        BinaryRow row{to + begin * row_bytes};
        for (std::size_t i = begin; i < end; ++i) write_row(row, i);
      });
    };
    fill(vertices, vertex_bytes, bytes.data() + body, [&](BinaryRow& row, std::size_t i) { vertex(row, i); });
    fill(faces, face_bytes, bytes.data() + body + vertices * vertex_bytes,
         [&](BinaryRow& row, std::size_t i) { face(row, i); });
    return bytes;
  }

 private:
  std::string header() const {
    TextOut out;
    out << "ply\nformat " << (options_.ascii ? "ascii" : "binary_little_endian")
        << " 1.0\ncomment Formwright, lengths in mm\n";
    if (uv_)
      for (const Texture& texture : model_.textures) out << "comment TextureFile " << clean_text(texture.name) << '\n';
    out << "element vertex " << static_cast<int>(model_.mesh.V.rows())
        << "\nproperty double x\nproperty double y\nproperty double z\n";
    if (colours_) out << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    if (per_vertex_uv_) out << "property double s\nproperty double t\n";
    std::vector<std::string> names{"x", "y", "z", "red", "green", "blue", "s", "t"};
    for (const VertexColumn& column : options_.columns) {
      std::string name = clean_text(column.name);
      std::ranges::replace_if(name, is_space, '_');
      if (name.empty() || std::ranges::find(names, name) != names.end())
        throw Error(ErrorCode::internal, "",
                    "The column “" + name + "” cannot be written: its name is empty or taken.");
      out << "property " << type_name(column.kind) << ' ' << name << '\n';
      names.push_back(name);
    }
    out << "element face " << static_cast<int>(model_.mesh.F.rows()) << "\nproperty list uchar int vertex_indices\n";
    if (uv_ && !per_vertex_uv_) out << "property list uchar float texcoord\n";
    out << "end_header\n";
    return std::move(out.text());
  }

  template <class Row>
  void vertex(Row& row, std::size_t i) const {
    const auto v = static_cast<Eigen::Index>(i);
    for (int k = 0; k < 3; ++k) row.add(model_.mesh.V(v, k));
    if (colours_)
      for (int k = 0; k < 3; ++k) row.add(byte_of_unit(srgb_of_linear(model_.vertex_colours(v, k))));
    if (per_vertex_uv_)
      for (int k = 0; k < 2; ++k) row.add(model_.UV(v, k));
    for (const VertexColumn& column : options_.columns) {
      const double value = column.values[v];
      switch (column.kind) {
        case ColumnKind::uint8: row.add(static_cast<std::uint8_t>(clamped(value, 0, 255))); break;
        case ColumnKind::int32: row.add(static_cast<std::int32_t>(clamped(value, -2147483648.0, 2147483647.0))); break;
        case ColumnKind::float32: row.add(static_cast<float>(value)); break;
        case ColumnKind::float64: row.add(value); break;
      }
    }
    row.end();
  }

  template <class Row>
  void face(Row& row, std::size_t i) const {
    const auto f = static_cast<Eigen::Index>(i);
    row.add(std::uint8_t{3});
    for (int k = 0; k < 3; ++k) row.add(model_.mesh.F(f, k));
    if (uv_ && !per_vertex_uv_) {
      row.add(std::uint8_t{6});
      for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 2; ++c) row.add(static_cast<float>(model_.UV(model_.FT(f, k), c)));
    }
    row.end();
  }

  const Model& model_;
  const WriteOptions& options_;
  const Context& context_;
  bool uv_, colours_, per_vertex_uv_ = false;
};

}  // namespace

Bytes write_ply(const Model& model, const WriteOptions& options, Context& context) {
  return PlyWriter(model, options, context).write();
}

}  // namespace formwright
