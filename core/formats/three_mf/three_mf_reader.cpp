// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "formats/shared/colour.h"
#include "formats/shared/media_type.h"
#include "formats/shared/reader_limits.h"
#include "formats/shared/text_scan.h"
#include "formats/three_mf/three_mf.h"

namespace formwright {
namespace {

constexpr int max_nesting = 64;
constexpr std::uint64_t max_picture_bytes = 256u << 20;  // of all together
constexpr std::int64_t max_instances = 1'000'000;

class ThreeMfReader {
 public:
  explicit ThreeMfReader(const MeshSource& source)
      : source_(source), archive_(source), content_(read_three_mf_content(source, archive_)), model_(file_.model) {}

  ModelFile read() {
    file_.format = MeshFormat::three_mf;
    file_.unit = content_.unit;
    std::vector<ThreeMfComponent> items = content_.items;
    if (items.empty()) {
      items = unused_objects();
      if (!items.empty()) file_.notes.push_back("Nothing is on the build plate, so every object was read.");
    }
    std::int64_t triangles = 0, vertices = 0, instances = 0;
    for (const ThreeMfComponent& item : items) {
      const Size size = size_of(item.object, 0);
      triangles += size.triangles, vertices += size.vertices, instances += size.instances;
      source_.check_triangle_count(triangles);
      if (vertices > 3 * source_.options().max_triangles)
        source_.refuse("it holds far more vertices than triangles; export it again.");
      if (instances > max_instances)
        source_.refuse("its objects are repeated more than a million times; export it as one mesh.");
    }
    if (triangles == 0) source_.refuse_empty(content_.beams ? "beams" : "");
    F_.reserve(3 * static_cast<std::size_t>(triangles));
    add_property_tables();
    for (const ThreeMfComponent& item : items) {
      const std::size_t before = F_.size() / 3;
      add(item.object, item.transform);
      if (F_.size() / 3 == before) continue;
      const ThreeMfObject& object = content_.objects.at(item.object);
      model_.group_names.push_back(object.name.empty() ? "object " + std::to_string(item.object.second) : object.name);
      model_.face_group.resize(F_.size() / 3, static_cast<int>(model_.group_names.size()) - 1);
    }
    finish();
    return std::move(file_);
  }

 private:
  struct Size {
    std::int64_t triangles = 0, vertices = 0, instances = 0;
    int height = 0;  // of the tree of components below
  };

  const ThreeMfObject& object(const ThreeMfId& id) const {
    const auto found = content_.objects.find(id);
    if (found == content_.objects.end())
      source_.refuse("it refers to object " + std::to_string(id.second) + ", which does not exist; export it again.");
    return found->second;
  }

  /// Model objects that no other has as a component.
  std::vector<ThreeMfComponent> unused_objects() const {
    std::map<ThreeMfId, bool> used;
    for (const auto& [id, object] : content_.objects)
      for (const ThreeMfComponent& component : object.components) used[component.object] = true;
    std::vector<ThreeMfComponent> items;
    for (const auto& [id, object] : content_.objects)
      if (object.printed && !used.contains(id)) items.push_back({id, Eigen::Matrix4d::Identity()});
    return items;
  }

  /// How much an object becomes with all its components: known before anything is copied, so that a few lines that
  /// double one another forty times are refused at once. Cycles show as nesting without end.
  Size size_of(const ThreeMfId& id, int depth) {
    if (const auto known = sizes_.find(id); known != sizes_.end()) return known->second;
    const auto refuse_nesting = [&] {
      source_.refuse(
          "its objects contain one another in a circle, or are nested more than 64 deep; export it as one mesh.");
    };
    if (depth > max_nesting) refuse_nesting();
    const ThreeMfObject& whole = object(id);
    Size size;
    if (whole.printed) {
      size = {static_cast<std::int64_t>(whole.F.size() / 3), static_cast<std::int64_t>(whole.V.size() / 3), 1, 0};
      for (const ThreeMfComponent& component : whole.components) {
        const Size part = size_of(component.object, depth + 1);
        const auto add_up = [](std::int64_t& sum, std::int64_t more) {
          sum = std::min<std::int64_t>(sum + more, 1'000'000'000'000'000'000);
        };
        add_up(size.triangles, part.triangles), add_up(size.vertices, part.vertices),
            add_up(size.instances, part.instances);
        size.height = std::max(size.height, part.height + 1);
      }
      if (size.height > max_nesting) refuse_nesting();
    }
    sizes_[id] = size;
    return size;
  }

  /// Materials of base materials, and of colours when they never differ by corner.
  void add_property_tables() {
    for (const auto& [id, object] : content_.objects)
      for (const ThreeMfCorner& corner : object.corners) {
        const ThreeMfProperties* const group = properties({id.first, corner.property});
        if (group == nullptr) continue;
        if (group->kind == ThreeMfProperties::Kind::colours && corner.per_corner) vertex_colours_ = true;
        if (group->kind == ThreeMfProperties::Kind::texture) with_texture_ = true;
      }
    for (const auto& [id, group] : content_.properties) {
      first_material_[id] = static_cast<int>(model_.materials.size());
      first_uv_[id] = static_cast<int>(UV_.size() / 2);
      if (group.kind == ThreeMfProperties::Kind::texture) {
        if (!with_texture_) continue;
        for (const Vec2& t : group.coordinates) UV_.insert(UV_.end(), {t.x(), t.y()});
        model_.materials.push_back(
            {"texture " + std::to_string(id.second), Vec3::Ones(), texture({id.first, group.texture})});
      } else if (group.kind == ThreeMfProperties::Kind::base_materials || !vertex_colours_) {
        for (std::size_t k = 0; k < group.colours.size(); ++k) {
          const bool named = k < group.names.size() && !group.names[k].empty();
          model_.materials.push_back({named ? group.names[k] : colour_name(group.colours[k]), group.colours[k], -1});
        }
      }
    }
    UV_.insert(UV_.end(), {0.0, 0.0});  // for faces without
  }

  static std::string colour_name(const Vec3& colour) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string name = "#";
    for (const double c : colour) {
      const unsigned byte = byte_of_unit(srgb_of_linear(c));
      name += digits[byte >> 4], name += digits[byte & 15];
    }
    return name;
  }

  int texture(const ThreeMfId& id) {
    const auto path = content_.texture_paths.find(id);
    if (path == content_.texture_paths.end()) return -1;
    // By the entry's path: several texture2d may show one picture, which is unpacked once.
    const auto [place, fresh] =
        texture_numbers_.try_emplace(lower_case(path->second), static_cast<int>(model_.textures.size()));
    if (fresh) {
      Texture picture;
      picture.name = clean_text(path->second.substr(path->second.find_last_of('/') + 1));
      if (const auto* const entry = archive_.find(path->second)) {
        picture.bytes = archive_.read(*entry, max_picture_bytes - picture_bytes_);
        picture_bytes_ += picture.bytes.size();
      }
      picture.media_type = picture_media_type(picture.bytes);
      model_.textures.push_back(std::move(picture));
    }
    return place->second;
  }

  const ThreeMfProperties* properties(const ThreeMfId& id) const {
    const auto found = content_.properties.find(id);
    return found == content_.properties.end() ? nullptr : &found->second;
  }

  void add(const ThreeMfId& id, const Eigen::Matrix4d& transform) {
    const ThreeMfObject& whole = object(id);
    if (!whole.printed) {
      supports_ = true;
      return;
    }
    if (++added_ % 256 == 0) source_.context().check_cancelled();
    if (!whole.F.empty()) add_mesh(id, whole, transform);
    for (const ThreeMfComponent& component : whole.components) add(component.object, transform * component.transform);
  }

  void add_mesh(const ThreeMfId& id, const ThreeMfObject& whole, const Eigen::Matrix4d& transform) {
    const auto first = static_cast<int>(V_.size() / 3);
    check_vertex_count(source_, static_cast<std::int64_t>((V_.size() + whole.V.size()) / 3));
    const bool moved = transform != Eigen::Matrix4d::Identity();
    for (std::size_t v = 0; v < whole.V.size(); v += 3) {
      Eigen::Vector4d p(whole.V[v], whole.V[v + 1], whole.V[v + 2], 1);
      if (moved) p = transform * p;
      for (int k = 0; k < 3; ++k) {
        if (!is_sane_coordinate(p[k]))
          source_.refuse(insane_coordinate("vertex", static_cast<std::int64_t>(v / 3) + 1, p[k]));
        V_.push_back(p[k]);
      }
    }
    const bool mirrored = transform.topLeftCorner<3, 3>().determinant() < 0;
    if (vertex_colours_) colours_.resize(V_.size(), 1.0), colour_known_.resize(V_.size() / 3, ColourKnown::none);
    const std::size_t faces = whole.F.size() / 3;
    for (std::size_t f = 0; f < faces; ++f) {
      std::array<std::size_t, 3> order{0, 1, 2};
      if (mirrored) std::swap(order[1], order[2]);
      for (const std::size_t k : order) F_.push_back(first + whole.F[3 * f + k]);
      add_properties(id, f < whole.corners.size() ? whole.corners[f] : ThreeMfCorner{}, order);
    }
  }

  /// Of the face that F_ ends with.
  void add_properties(const ThreeMfId& id, const ThreeMfCorner& corner, const std::array<std::size_t, 3>& order) {
    using Kind = ThreeMfProperties::Kind;
    const ThreeMfId group_id{id.first, corner.property};
    const ThreeMfProperties* const group = properties(group_id);
    const int spare = static_cast<int>(UV_.size() / 2) - 1;
    int material = -1;
    std::array<int, 3> texture_vertices{spare, spare, spare};
    if (group != nullptr) {
      const auto size =
          static_cast<std::int64_t>(group->kind == Kind::texture ? group->coordinates.size() : group->colours.size());
      for (const std::int64_t index : corner.index)
        if (index >= size)
          source_.refuse("a face refers to property " + std::to_string(index) + " of group " +
                         std::to_string(corner.property) + ", which does not exist; export it again.");
      const int base = first_material_.at(group_id);
      if (group->kind == Kind::base_materials || (group->kind == Kind::colours && !vertex_colours_))
        material = base + static_cast<int>(corner.index[0]);
      if (group->kind == Kind::texture) {
        material = base;
        for (std::size_t k = 0; k < 3; ++k)
          texture_vertices[k] = first_uv_.at(group_id) + static_cast<int>(corner.index[order[k]]);
      }
      if (group->kind == Kind::colours && vertex_colours_)
        for (std::size_t k = 0; k < 3; ++k)
          set_colour(F_[F_.size() - 3 + k], group->colours[static_cast<std::size_t>(corner.index[order[k]])]);
    }
    if (!model_.materials.empty()) model_.face_material.push_back(material);
    if (with_texture_) FT_.insert(FT_.end(), texture_vertices.begin(), texture_vertices.end());
  }

  /// A vertex has one colour: the first that a face gives it.
  void set_colour(int vertex, const Vec3& colour) {
    ColourKnown& known = colour_known_[static_cast<std::size_t>(vertex)];
    const auto place = colours_.begin() + 3 * vertex;
    if (known == ColourKnown::none) {
      known = ColourKnown::one;
      std::copy(colour.begin(), colour.end(), place);
    } else if (known == ColourKnown::one && !std::equal(colour.begin(), colour.end(), place)) {
      known = ColourKnown::several;
      ++several_colours_;
    }
  }

  void finish() {
    const auto n = static_cast<Eigen::Index>(V_.size() / 3), m = static_cast<Eigen::Index>(F_.size() / 3);
    model_.mesh.V = Eigen::Map<const Positions>(V_.data(), n, 3);
    model_.mesh.F = Eigen::Map<const Triangles>(F_.data(), m, 3);
    if (vertex_colours_) model_.vertex_colours = Eigen::Map<const Positions>(colours_.data(), n, 3);
    if (with_texture_) {
      model_.UV = Eigen::Map<const TextureCoordinates>(UV_.data(), static_cast<Eigen::Index>(UV_.size() / 2), 2);
      model_.FT = Eigen::Map<const Triangles>(FT_.data(), m, 3);
      if ((model_.FT.array() != static_cast<int>(UV_.size() / 2) - 1).all())
        model_.UV.conservativeResize(model_.UV.rows() - 1, 2);
    }
    if (model_.group_names.size() < 2) model_.group_names.clear(), model_.face_group.clear();
    if (supports_) file_.notes.push_back("Supports and other objects that are not printed were left out.");
    if (several_colours_ > 0)
      file_.notes.push_back("At " + counted(several_colours_, "vertex", "vertices") +
                            ", faces of different colours meet; the first face's colour was kept there.");
    if (content_.mixed_properties) file_.notes.push_back("Mixed materials and colours were left out.");
    if (content_.painted) file_.notes.push_back("Colours painted in a slicer were left out.");
    if (content_.beams) file_.notes.push_back("Beams were left out.");
  }

  const MeshSource& source_;
  ZipArchive archive_;
  ThreeMfContent content_;
  ModelFile file_;
  Model& model_;
  std::map<ThreeMfId, Size> sizes_;
  std::map<ThreeMfId, int> first_material_, first_uv_;
  std::map<std::string, int> texture_numbers_;
  std::uint64_t picture_bytes_ = 0;
  bool vertex_colours_ = false, with_texture_ = false, supports_ = false;
  enum class ColourKnown : char { none, one, several };
  std::vector<ColourKnown> colour_known_;  // of each vertex
  std::int64_t added_ = 0, several_colours_ = 0;
  std::vector<double> V_, colours_, UV_;
  std::vector<int> F_, FT_;
};

}  // namespace

ModelFile read_three_mf(const MeshSource& source) { return ThreeMfReader(source).read(); }

}  // namespace formwright
