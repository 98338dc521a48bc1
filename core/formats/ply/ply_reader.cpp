// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "formats/shared/byte_order.h"
#include "formats/shared/colour.h"
#include "formats/ply/ply.h"
#include "formats/shared/polygon_fan.h"
#include "formats/shared/reader_limits.h"
#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

// Bodies hand out one number after the other as a double, which holds every type of PLY exactly.

class AsciiBody {
 public:
  AsciiBody(const MeshSource& source, std::size_t body) : source_(source), scan_(source.text().substr(body)) {}

  double next(PlyType) {
    scan_.skip_spaces();
    from_ = scan_.at;
    double value = 0;
    if (scan_.done()) source_.refuse("it ends too early; export it or copy it again.");
    if (!scan_.number(value) || !(scan_.done() || is_space(*scan_.at))) {
      scan_.at = from_;
      refuse("“" + clean_text(scan_.word(), 40) + "” is not a number; export it again.");
    }
    return value;
  }
  bool can_hold(std::int64_t count, PlyType) const { return count <= static_cast<std::int64_t>(scan_.end - scan_.at); }
  double fraction() const {
    return static_cast<double>(scan_.at - source_.text().data()) / static_cast<double>(source_.bytes().size());
  }
  [[noreturn]] void refuse(const std::string& what) const {
    source_.refuse_line(static_cast<std::size_t>(from_ - source_.text().data()), what);
  }

 private:
  const MeshSource& source_;
  TextScan scan_;
  const char* from_ = nullptr;
};

template <bool swap_bytes>
class BinaryBody {
 public:
  BinaryBody(const MeshSource& source, std::size_t body)
      : source_(source), at_(source.bytes().data() + body), end_(source.bytes().data() + source.bytes().size()) {}

  double next(PlyType type) {
    switch (type) {
      case PlyType::int8: return take<std::int8_t>();
      case PlyType::uint8: return take<std::uint8_t>();
      case PlyType::int16: return take<std::int16_t>();
      case PlyType::uint16: return take<std::uint16_t>();
      case PlyType::int32: return take<std::int32_t>();
      case PlyType::uint32: return take<std::uint32_t>();
      case PlyType::float32: return take<float>();
      case PlyType::float64: return take<double>();
    }
    return 0;
  }
  bool can_hold(std::int64_t count, PlyType type) const {
    return count <= (end_ - at_) / static_cast<std::int64_t>(size_of(type));
  }
  double fraction() const { return 1 - static_cast<double>(end_ - at_) / static_cast<double>(source_.bytes().size()); }
  [[noreturn]] void refuse(const std::string& what) const { source_.refuse(what); }

 private:
  template <class Number>
  double take() {
    if (static_cast<std::size_t>(end_ - at_) < sizeof(Number))
      source_.refuse("it ends too early; export it or copy it again.");
    const Number value = swap_bytes ? load_swapped<Number>(at_) : load<Number>(at_);
    at_ += sizeof(Number);
    return static_cast<double>(value);
  }

  const MeshSource& source_;
  const std::byte *at_, *end_;
};

/// Where a vertex property goes.
struct Target {
  double* data = nullptr;  // nullptr: nowhere
  std::ptrdiff_t stride = 1;
  double scale = 1;  // integer colours: 1/255, 1/65535
  bool coordinate = false;
};

ColumnKind column_kind(PlyType type) {
  switch (type) {
    case PlyType::uint8: return ColumnKind::uint8;
    case PlyType::float32: return ColumnKind::float32;
    case PlyType::uint32:
    case PlyType::float64: return ColumnKind::float64;
    default: return ColumnKind::int32;
  }
}

double colour_scale(PlyType type) {
  switch (type) {
    case PlyType::float32:
    case PlyType::float64: return 1;
    case PlyType::int16:
    case PlyType::uint16: return 1.0 / 65535;
    default: return 1.0 / 255;
  }
}

template <class Body>
class PlyReader {
 public:
  PlyReader(const MeshSource& source, const PlyHeader& header)
      : source_(source), header_(header), body_(source, header.body), model_(file_.model) {}

  ModelFile read() {
    file_.format = MeshFormat::ply;
    const PlyElement* const vertices = header_.element("vertex");
    vertex_count_ = vertices == nullptr ? 0 : vertices->count;
    check_vertex_count(source_, vertex_count_);
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      if (element.name == "vertex") read_vertices(element);
      else if (element.name == "face") read_faces(element);
      else if (element.name == "tristrips") read_strips(element);
      else skip(element);
    }
    finish();
    return std::move(file_);
  }

 private:
  void beat(std::int64_t row) {
    if (row % 16384 == 0) source_.context().progress(body_.fraction());
  }

  std::int64_t list_length(const PlyProperty& property) {
    const double length = body_.next(*property.count_type);
    if (!(length >= 0) || length != std::floor(length) ||
        !body_.can_hold(static_cast<std::int64_t>(std::min(length, 1e15)), property.type))
      body_.refuse("a list in it is longer than the file; export it or copy it again.");
    return static_cast<std::int64_t>(length);
  }

  void skip_property(const PlyProperty& property) {
    const std::int64_t count = property.count_type ? list_length(property) : 1;
    for (std::int64_t i = 0; i < count; ++i) body_.next(property.type);
  }

  void skip(const PlyElement& element) {
    for (std::int64_t row = 0; row < element.count; ++row) {
      beat(row);
      for (const PlyProperty& property : element.properties) skip_property(property);
    }
  }

  /// Sends the named properties to the columns of a row-major matrix; `data` is null when it has no rows.
  static void aim(const PlyElement& element, std::vector<Target>& targets,
                  std::initializer_list<std::string_view> names, double* data, bool colour, bool coordinate) {
    std::ptrdiff_t k = 0;
    for (const std::string_view name : names) {
      const auto place = std::ranges::find(element.properties, name, &PlyProperty::name);
      Target& target = targets[static_cast<std::size_t>(place - element.properties.begin())];
      target = {data == nullptr ? nullptr : data + k, static_cast<std::ptrdiff_t>(names.size()),
                colour ? colour_scale(place->type) : 1, coordinate};
      ++k;
    }
  }

  static bool has(const PlyElement& element, std::initializer_list<std::string_view> names) {
    return std::ranges::all_of(names, [&](std::string_view name) {
      const auto place = std::ranges::find(element.properties, name, &PlyProperty::name);
      return place != element.properties.end() && !place->count_type;
    });
  }

  void read_vertices(const PlyElement& element) {
    const auto n = static_cast<Eigen::Index>(element.count);
    if (!has(element, {"x", "y", "z"})) source_.refuse("its vertices have no x, y and z; export it again.");
    std::vector<Target> targets(element.properties.size());
    model_.mesh.V.resize(n, 3);
    aim(element, targets, {"x", "y", "z"}, model_.mesh.V.data(), false, true);
    for (const auto& names : {std::array{"red", "green", "blue"},
                              std::array{"diffuse_red", "diffuse_green", "diffuse_blue"}, std::array{"r", "g", "b"}})
      if (model_.vertex_colours.rows() == 0 && has(element, {names[0], names[1], names[2]})) {
        model_.vertex_colours.resize(n, 3);
        aim(element, targets, {names[0], names[1], names[2]}, model_.vertex_colours.data(), true, false);
      }
    for (const auto& names : {std::array{"s", "t"}, std::array{"u", "v"}, std::array{"texture_u", "texture_v"},
                              std::array{"texture_s", "texture_t"}})
      if (model_.UV.rows() == 0 && has(element, {names[0], names[1]})) {
        model_.UV.resize(n, 2);
        aim(element, targets, {names[0], names[1]}, model_.UV.data(), false, true);
      }
    file_.columns.reserve(targets.size());  // so that their values stay put
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (targets[k].data != nullptr || property.count_type) continue;
      file_.columns.push_back({property.name, Eigen::VectorXd(n), column_kind(property.type)});
      targets[k].data = file_.columns.back().values.data();
    }
    for (Eigen::Index row = 0; row < n; ++row) {
      beat(row);
      for (std::size_t k = 0; k < targets.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        if (property.count_type) {
          skip_property(property);
          continue;
        }
        const Target& target = targets[k];
        const double value = body_.next(property.type);
        if (target.coordinate && !is_sane_coordinate(value)) body_.refuse(insane_coordinate("vertex", row + 1, value));
        target.data[row * target.stride] = value * target.scale;
      }
    }
  }

  int vertex_index(const PlyProperty& property, std::int64_t row) {
    const double index = body_.next(property.type);
    if (!(index >= 0 && index < static_cast<double>(vertex_count_)) || index != std::floor(index))
      body_.refuse(
          "face " + std::to_string(row + 1) + " refers to vertex " +
          (std::isfinite(index) ? std::to_string(static_cast<std::int64_t>(std::clamp(index, -1e15, 1e15))) : "NaN") +
          ", but the vertices count from 0 to " + std::to_string(vertex_count_ - 1) + "; export it again.");
    return static_cast<int>(index);
  }

  void read_faces(const PlyElement& element) {
    const auto is_list = [](const PlyProperty& p, std::initializer_list<std::string_view> names) {
      return p.count_type && std::ranges::find(names, std::string_view(p.name)) != names.end();
    };
    const bool with_texture =
        std::ranges::any_of(element.properties, [&](const auto& p) { return is_list(p, {"texcoord"}); });
    F_.reserve(3 * static_cast<std::size_t>(
                       std::min<std::int64_t>(element.count, static_cast<std::int64_t>(source_.bytes().size() / 4))));
    std::vector<int> corners;
    std::vector<double> texture;
    for (std::int64_t row = 0; row < element.count; ++row) {
      beat(row);
      corners.clear(), texture.clear();
      for (const PlyProperty& property : element.properties) {
        if (is_list(property, {"vertex_indices", "vertex_index"})) {
          for (std::int64_t count = list_length(property); count > 0; --count)
            corners.push_back(vertex_index(property, row));
        } else if (is_list(property, {"texcoord"})) {
          for (std::int64_t count = list_length(property); count > 0; --count)
            texture.push_back(body_.next(property.type));
        } else {
          skip_property(property);
        }
      }
      if (corners.size() < 3) {
        ++short_faces_;
        continue;
      }
      const auto first = static_cast<std::int64_t>(F_.size() / 3);
      source_.check_triangle_count(first + static_cast<std::int64_t>(corners.size()) - 2);
      if (corners.size() > 3) fans_.push_back({first, static_cast<int>(corners.size())});
      for (std::size_t k = 2; k < corners.size(); ++k) F_.insert(F_.end(), {corners[0], corners[k - 1], corners[k]});
      if (with_texture) wedge(corners.size(), texture);
    }
  }

  /// Texture coordinates of one face's corners, as MeshLab writes them: u0 v0 u1 v1 ...
  void wedge(std::size_t corners, const std::vector<double>& texture) {
    const bool given = texture.size() == 2 * corners && std::ranges::all_of(texture, is_sane_coordinate);
    if (!given) ++untextured_;
    const int first = static_cast<int>(wedge_uv_.size() / 2);
    if (given) wedge_uv_.insert(wedge_uv_.end(), texture.begin(), texture.end());
    else wedge_uv_.insert(wedge_uv_.end(), 2 * corners, 0.0);
    for (int k = 2; k < static_cast<int>(corners); ++k) FT_.insert(FT_.end(), {first, first + k - 1, first + k});
  }

  /// Stanford's older files: one list of triangle strips, -1 between two strips; each second triangle is turned.
  void read_strips(const PlyElement& element) {
    for (std::int64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) {
        if (!property.count_type || (property.name != "vertex_indices" && property.name != "vertex_index")) {
          skip_property(property);
          continue;
        }
        std::array<int, 2> last{};
        std::int64_t in_strip = 0;
        const std::int64_t count = list_length(property);
        for (std::int64_t k = 0; k < count; ++k) {
          beat(k);
          const double index = body_.next(property.type);
          if (index == -1) {
            in_strip = 0;
            continue;
          }
          if (!(index >= 0 && index < static_cast<double>(vertex_count_)) || index != std::floor(index))
            body_.refuse("a triangle strip refers to a vertex that does not exist; export it again.");
          const int v = static_cast<int>(index);
          if (in_strip >= 2) {
            if (in_strip % 2 == 0) F_.insert(F_.end(), {last[0], last[1], v});
            else F_.insert(F_.end(), {last[1], last[0], v});
            source_.check_triangle_count(static_cast<std::int64_t>(F_.size() / 3));
          }
          last = {last[1], v};
          ++in_strip;
        }
      }
    }
  }

  void finish() {
    const auto m = static_cast<Eigen::Index>(F_.size() / 3);
    if (m == 0) source_.refuse_empty(vertex_count_ > 0 ? "a cloud of points" : "");
    model_.mesh.F = Eigen::Map<const Triangles>(F_.data(), m, 3);
    std::vector<int>().swap(F_);
    if (static_cast<Eigen::Index>(FT_.size() / 3) == m && untextured_ < m) {
      model_.FT = Eigen::Map<const Triangles>(FT_.data(), m, 3);
      model_.UV =
          Eigen::Map<const TextureCoordinates>(wedge_uv_.data(), static_cast<Eigen::Index>(wedge_uv_.size() / 2), 2);
      if (untextured_ > 0)
        file_.notes.push_back(counted(untextured_, "face has", "faces have") +
                              " no texture coordinates and got (0, 0).");
    } else if (model_.UV.rows() > 0) {
      model_.FT = model_.mesh.F;
    }
    triangulate_fans(fans_, model_, source_.context());
    if (model_.vertex_colours.rows() > 0)
      model_.vertex_colours =
          model_.vertex_colours.unaryExpr([](double c) { return c >= 0 ? linear_of_srgb(c) : 0.0; }).eval();
    std::erase_if(file_.columns, [&](const VertexColumn& column) {
      if (column.values.allFinite()) return false;
      file_.columns_not_numbers.push_back(column.name);
      file_.notes.push_back("The column “" + column.name + "” holds values that are not numbers and was left out.");
      return true;
    });
    std::set<std::string> pictures;  // by the bare name, as companions are found
    for (const std::string& name : header_.textures)
      if (pictures.insert(bare_name(name)).second) model_.textures.push_back({name, "", {}});
    if (!model_.textures.empty() && model_.UV.rows() > 0) {
      // A face's texnumber distinguishes several textures, which hardly anything writes: the first serves all.
      model_.materials.push_back({"texture", Vec3::Ones(), 0});
      model_.face_material.assign(static_cast<std::size_t>(m), 0);
    }
    if (short_faces_ > 0)
      file_.notes.push_back(counted(short_faces_, "face", "faces") + " with fewer than three corners left out.");
  }

  const MeshSource& source_;
  const PlyHeader& header_;
  Body body_;
  ModelFile file_;
  Model& model_;
  std::int64_t vertex_count_ = 0, short_faces_ = 0, untextured_ = 0;
  std::vector<int> F_, FT_;
  std::vector<double> wedge_uv_;
  std::vector<PolygonFan> fans_;
};

}  // namespace

ModelFile read_ply(const MeshSource& source) {
  const PlyHeader header = read_ply_header(source);
  switch (header.encoding) {
    case PlyHeader::Encoding::ascii: return PlyReader<AsciiBody>(source, header).read();
    case PlyHeader::Encoding::little_endian: return PlyReader<BinaryBody<false>>(source, header).read();
    case PlyHeader::Encoding::big_endian: return PlyReader<BinaryBody<true>>(source, header).read();
  }
  return {};
}

}  // namespace formwright
