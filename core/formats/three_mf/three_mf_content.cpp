// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <charconv>
#include <unordered_map>

#include "formats/shared/colour.h"
#include "formats/shared/reader_limits.h"
#include "formats/shared/text_scan.h"
#include "formats/three_mf/three_mf.h"
#include "formats/container/xml_reader.h"

namespace formwright {
namespace {

struct UnitOfLength {
  std::string_view name;
  double mm;
};
constexpr std::array<UnitOfLength, 6> units{
    {{"micron", 0.001}, {"millimeter", 1}, {"centimeter", 10}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1000}}};

constexpr std::size_t max_parts = 10'000;

/// A path inside the archive, from a reference in `base` ("/3D/x.model" or "x.model" next to it).
std::string resolved(std::string_view path, std::string_view base) {
  if (path.starts_with('/')) return std::string(path.substr(1));
  const std::size_t slash = base.find_last_of('/');
  return std::string(base.substr(0, slash == std::string_view::npos ? 0 : slash + 1)) + std::string(path);
}

// A growing vector holds its elements up to three times while it moves to a larger place.
template <class Element>
constexpr std::uint64_t bytes_in_vector = 3 * sizeof(Element);
// A map's node beside its value, and a short name on the heap.
constexpr std::uint64_t node_bytes = 128;

/// What the parts have in common while they are read.
struct Reading {
  ZipArchive& archive;
  ThreeMfContent content;
  std::unordered_map<std::string, int> part_of_path;  // in lower case
  std::int64_t triangles = 0;
};

class PartReader {
 public:
  PartReader(const MeshSource& part, int number, Reading& reading)
      : part_(part), number_(number), reading_(reading), content_(reading.content), xml_(part) {}

  void read() {
    if (!xml_.next() || xml_.name() != "model") xml_.refuse("it is not a 3MF model; export it again.");
    std::string unit = xml_.text_attribute("unit");
    if (unit.empty()) unit = "millimeter";
    const auto known = std::ranges::find(units, unit, &UnitOfLength::name);
    if (known == units.end())
      xml_.refuse("“" + clean_text(unit, 40) + "” is not a unit of length; export it in millimeters.");
    unit_mm_ = known->mm;
    if (number_ == 0) content_.unit = unit;
    while (xml_.next()) {
      if (xml_.tag() == XmlReader::Tag::start) start();
      else if (xml_.name() == "object") object_ = nullptr;
    }
  }

 private:
  void start() {
    const std::string_view name = xml_.name();
    if (name == "vertex") vertex();
    else if (name == "triangle") triangle();
    else if (name == "object") object();
    else if (name == "component") component();
    else if (name == "item") item();
    else if (name == "basematerials") group(ThreeMfProperties::Kind::base_materials);
    else if (name == "colorgroup") group(ThreeMfProperties::Kind::colours);
    else if (name == "texture2dgroup") group(ThreeMfProperties::Kind::texture);
    else if (name == "texture2d") texture();
    else if (name == "multiproperties" || name == "compositematerials") content_.mixed_properties = true;
    else if (name == "base" || name == "color" || name == "tex2coord") property(name);
    else if (name == "beamlattice") content_.beams = true;
  }

  std::int64_t integer(const char* attribute, std::int64_t fallback = -1) const {
    const std::string_view value = trimmed(xml_.attribute(attribute));
    if (value.empty() && fallback >= 0) return fallback;
    TextScan scan(value);
    std::int64_t number = -1;
    if (!scan.integer(number) || !scan.done() || number < 0)
      xml_.refuse("“" + std::string(attribute) + "” must be a whole number, not “" + clean_text(value, 40) +
                  "”; export it again.");
    return number;
  }

  double number(const char* attribute) const {
    TextScan scan(trimmed(xml_.attribute(attribute)));
    double value = 0;
    if (!scan.number(value) || !scan.done())
      xml_.refuse("“" + std::string(attribute) + "” must be a number, not “" +
                  clean_text(xml_.attribute(attribute), 40) + "”; export it again.");
    return value;
  }

  /// Twelve numbers of a 4 x 3 matrix for row vectors, its rows one after the other (core specification 3.3).
  Eigen::Matrix4d transform() const {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    if (!xml_.has("transform")) return matrix;
    TextScan scan(xml_.attribute("transform"));
    for (int k = 0; k < 12; ++k) {
      double value = 0;
      scan.skip_spaces();
      if (!scan.number(value) || !is_sane_coordinate(value))
        xml_.refuse("a transform is not twelve numbers; export it again.");
      matrix(k % 3, k / 3) = value;
    }
    matrix.topRightCorner<3, 1>() *= unit_mm_;
    return matrix;
  }

  /// Number of a part, which is read later if it is new.
  int part_of(const std::string& path) {
    if (path.empty()) return number_;
    const std::string name = resolved(path, "");
    const auto [place, fresh] =
        reading_.part_of_path.try_emplace(lower_case(name), static_cast<int>(content_.parts.size()));
    if (!fresh) return place->second;
    if (content_.parts.size() >= max_parts) xml_.refuse("it refers to more than 10 000 parts; export it again.");
    content_.parts.push_back(name);
    return place->second;
  }

  void texture() {
    reading_.archive.take(node_bytes);
    content_.texture_paths[{number_, integer("id")}] =
        resolved(xml_.text_attribute("path"), content_.parts[static_cast<std::size_t>(number_)]);
  }

  void object() {
    const std::int64_t id = integer("id");
    if (object_ != nullptr) xml_.refuse("an object stands within another; export it again.");
    reading_.archive.take(sizeof(ThreeMfObject) + node_bytes);
    const auto [place, fresh] = content_.objects.try_emplace({number_, id});
    if (!fresh) xml_.refuse("object " + std::to_string(id) + " is defined twice; export it again.");
    object_ = &place->second;
    object_->unit_mm = unit_mm_;
    object_->name = clean_text(xml_.text_attribute("name"));
    const std::string_view type = xml_.attribute("type");
    object_->printed = type != "support" && type != "solidsupport" && type != "other";
    object_default_ = {xml_.has("pid") ? integer("pid") : -1, {}, false};
    object_default_.index.fill(integer("pindex", 0));
    vertices_ = 0;
  }

  void vertex() {
    if (object_ == nullptr) xml_.refuse("a vertex stands outside of an object; export it again.");
    ++vertices_;
    reading_.archive.take(3 * bytes_in_vector<double>);
    for (const char* axis : {"x", "y", "z"}) {
      const double value = number(axis) * unit_mm_;
      if (!is_sane_coordinate(value)) xml_.refuse(insane_coordinate("vertex", vertices_, value));
      object_->V.push_back(value);
    }
  }

  void triangle() {
    if (object_ == nullptr) xml_.refuse("a triangle stands outside of an object; export it again.");
    part_.check_triangle_count(++reading_.triangles);
    if (reading_.triangles % 16384 == 0) part_.context().check_cancelled();
    reading_.archive.take(3 * bytes_in_vector<int>);
    for (const char* corner : {"v1", "v2", "v3"}) {
      const std::int64_t vertex = integer(corner);
      if (vertex >= vertices_)
        xml_.refuse("a triangle refers to vertex " + std::to_string(vertex) + ", but its object has " +
                    counted(vertices_, "vertex", "vertices") + "; export it again.");
      object_->F.push_back(static_cast<int>(vertex));
    }
    ThreeMfCorner properties = object_default_;
    if (xml_.has("pid")) properties.property = integer("pid");
    if (xml_.has("p1")) {
      properties.index.fill(integer("p1"));
      if (xml_.has("p2")) properties.index[1] = integer("p2");
      if (xml_.has("p3")) properties.index[2] = integer("p3");
      properties.per_corner = properties.index[1] != properties.index[0] || properties.index[2] != properties.index[0];
    }
    content_.painted = content_.painted || xml_.has("paint_color") || xml_.has("mmu_segmentation");
    const std::size_t face = object_->F.size() / 3 - 1;
    if (properties.property < 0 && object_->corners.empty()) return;
    reading_.archive.take((face - object_->corners.size() + 1) * bytes_in_vector<ThreeMfCorner>);
    object_->corners.resize(face);  // faces before the first with properties have none
    object_->corners.push_back(properties);
  }

  void component() {
    if (object_ == nullptr) xml_.refuse("a component stands outside of an object; export it again.");
    reading_.archive.take(bytes_in_vector<ThreeMfComponent>);
    object_->components.push_back({{part_of(xml_.text_attribute("path")), integer("objectid")}, transform()});
  }

  void item() {
    if (number_ != 0) return;
    reading_.archive.take(bytes_in_vector<ThreeMfComponent>);
    content_.items.push_back({{part_of(xml_.text_attribute("path")), integer("objectid")}, transform()});
  }

  void group(ThreeMfProperties::Kind kind) {
    reading_.archive.take(sizeof(ThreeMfProperties) + node_bytes);
    group_ = &content_.properties[{number_, integer("id")}];
    *group_ = {};
    group_->kind = kind;
    if (kind == ThreeMfProperties::Kind::texture) group_->texture = integer("texid");
  }

  /// "#RRGGBB" or "#RRGGBBAA", sRGB.
  Vec3 colour(const char* attribute) const {
    const std::string_view text = trimmed(xml_.attribute(attribute));
    std::uint32_t value = 0;
    const auto result = std::from_chars(text.data() + std::min<std::size_t>(text.size(), 1),
                                        text.data() + std::min<std::size_t>(text.size(), 7), value, 16);
    if ((text.size() != 7 && text.size() != 9) || text[0] != '#' || result.ptr != text.data() + 7)
      xml_.refuse("“" + clean_text(text, 40) + "” is not a colour; export it again.");
    return {linear_of_srgb((value >> 16) / 255.0), linear_of_srgb((value >> 8 & 255) / 255.0),
            linear_of_srgb((value & 255) / 255.0)};
  }

  void property(std::string_view name) {
    using Kind = ThreeMfProperties::Kind;
    if (group_ == nullptr) xml_.refuse("a property stands outside of a group; export it again.");
    // A name of its own, a colour, and the material that the model makes of both.
    reading_.archive.take(bytes_in_vector<std::string> + bytes_in_vector<Vec3> + bytes_in_vector<Material>);
    if (name == "base" && group_->kind == Kind::base_materials) {
      group_->names.push_back(clean_text(xml_.text_attribute("name")));
      group_->colours.push_back(xml_.has("displaycolor") ? colour("displaycolor") : Vec3(0.8, 0.8, 0.8));
    } else if (name == "color" && group_->kind == Kind::colours) {
      group_->colours.push_back(colour("color"));
    } else if (name == "tex2coord" && group_->kind == Kind::texture) {
      group_->coordinates.emplace_back(number("u"), number("v"));
      if (!is_sane_coordinate(group_->coordinates.back().x()) || !is_sane_coordinate(group_->coordinates.back().y()))
        xml_.refuse("a texture coordinate is not a finite number; export it again.");
    }
  }

  const MeshSource& part_;
  int number_;
  Reading& reading_;
  ThreeMfContent& content_;
  XmlReader xml_;
  double unit_mm_ = 1;
  ThreeMfObject* object_ = nullptr;
  ThreeMfProperties* group_ = nullptr;
  ThreeMfCorner object_default_;
  std::int64_t vertices_ = 0;
};

/// Bytes that a part may unpack to: 75 a triangle are usual, properties and digits may treble that.
std::uint64_t max_part_bytes(const ReadOptions& options) {
  return (64u << 20) + 220 * static_cast<std::uint64_t>(options.max_triangles);
}

/// The root model part is the target of a relationship of the archive (OPC); it is "3D/3dmodel.model" nearly always.
std::string root_part(const MeshSource& source, ZipArchive& archive) {
  if (const auto* const entry = archive.find("_rels/.rels")) {
    const Bytes bytes = archive.read(*entry, 1 << 20);
    const MeshSource part(bytes, source.name() + " (_rels/.rels)", source.options(), source.context());
    for (XmlReader xml(part); xml.next();)
      if (xml.tag() == XmlReader::Tag::start && xml.name() == "Relationship" &&
          xml.attribute("Type").ends_with("/3dmodel"))
        return resolved(xml.text_attribute("Target"), "");
  }
  for (const auto& entry : archive.entries())
    if (equal_ignoring_case(entry.name, "3D/3dmodel.model")) return entry.name;
  source.refuse("this zip archive holds no 3MF model; unpack it, or export the model as OBJ, STL, PLY, GLB or 3MF.");
}

}  // namespace

ThreeMfContent read_three_mf_content(const MeshSource& source, ZipArchive& archive) {
  Reading reading{archive, {}, {}, 0};
  ThreeMfContent& content = reading.content;
  content.parts.push_back(root_part(source, archive));
  reading.part_of_path.emplace(lower_case(content.parts[0]), 0);
  for (std::size_t i = 0; i < content.parts.size(); ++i) {  // grows as parts refer to others
    const std::string path = content.parts[i];
    const auto* const entry = archive.find(path);
    if (entry == nullptr) source.refuse("the part “" + clean_text(path, 60) + "” is missing in it; export it again.");
    const Bytes bytes = archive.read(*entry, max_part_bytes(source.options()));
    const MeshSource part(bytes, source.name() + " (" + path + ")", source.options(), source.context());
    PartReader(part, static_cast<int>(i), reading).read();
  }
  return std::move(reading.content);
}

}  // namespace formwright
