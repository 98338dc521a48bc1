// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <unordered_map>

#include "base/data/xml_text.h"
#include "formats/shared/colour.h"
#include "formats/shared/media_type.h"
#include "formats/shared/text_out.h"
#include "formats/three_mf/three_mf.h"

namespace formwright {
namespace {

std::string hexadecimal(const Vec3& linear) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text = "#";
  for (const double c : linear) {
    const unsigned byte = byte_of_unit(srgb_of_linear(c));
    text += digits[byte >> 4], text += digits[byte & 15];
  }
  return text;
}

constexpr std::string_view content_types = R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
<Default Extension="png" ContentType="image/png"/>
<Default Extension="jpeg" ContentType="image/jpeg"/>
</Types>
)";

constexpr std::string_view relationships_begin = R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
)";

class ThreeMfWriter {
 public:
  ThreeMfWriter(const Model& model, const WriteOptions& options, Context& context)
      : model_(model), options_(options), context_(context) {}

  Bytes write() {
    prepare_textures();
    std::vector<std::string> pieces{head()};
    const auto add = [&](std::vector<std::string> more) { std::ranges::move(more, std::back_inserter(pieces)); };
    const auto& [V, F] = model_.mesh;
    std::string items;
    for (const Object& object : objects()) {
      const auto written = [](const auto& list, std::size_t i) {
        return list.empty() ? static_cast<Eigen::Index>(i) : static_cast<Eigen::Index>(list[i]);
      };
      const auto count = [](const auto& list, Eigen::Index all) {
        return list.empty() ? static_cast<std::size_t>(all) : list.size();
      };
      pieces.push_back("<object id=\"" + std::to_string(object.id) + "\" type=\"model\" name=\"" +
                       xml_attribute(clean_text(object.name)) + "\">\n<mesh>\n<vertices>\n");
      add(format_rows(count(object.vertices, V.rows()), 56, context_, [&](TextOut& out, std::size_t i) {
        const Eigen::Index v = written(object.vertices, i);
        out << "<vertex x=\"" << static_cast<float>(V(v, 0)) << "\" y=\"" << static_cast<float>(V(v, 1)) << "\" z=\""
            << static_cast<float>(V(v, 2)) << "\"/>\n";
      }));
      pieces.emplace_back("</vertices>\n<triangles>\n");
      const auto index = [&](Eigen::Index f, int k) {
        return object.vertices.empty() ? F(f, k) : local_vertex_[static_cast<std::size_t>(F(f, k))];
      };
      add(format_rows(count(object.faces, F.rows()), 56, context_, [&](TextOut& out, std::size_t i) {
        const Eigen::Index f = written(object.faces, i);
        out << "<triangle v1=\"" << index(f, 0) << "\" v2=\"" << index(f, 1) << "\" v3=\"" << index(f, 2) << '"';
        properties(out, f);
        out << "/>\n";
      }));
      pieces.emplace_back("</triangles>\n</mesh>\n</object>\n");
      items += "<item objectid=\"" + std::to_string(object.id) + "\"/>\n";
    }
    pieces.push_back("</resources>\n<build>\n" + items + "</build>\n</model>\n");

    ZipWriter zip;
    zip.add("[Content_Types].xml", content_types, context_);
    zip.add(
        "_rels/.rels",
        std::string(relationships_begin) +
            "<Relationship Id=\"rel0\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\" Target=\"/3D/3dmodel.model\"/>\n</Relationships>\n",
        context_);
    std::string texture_relationships(relationships_begin);
    for (std::size_t i = 0; i < texture_paths_.size(); ++i) {
      if (texture_paths_[i].empty()) continue;
      zip.add_stored(texture_paths_[i], model_.textures[i].bytes);
      texture_relationships += "<Relationship Id=\"tex" + std::to_string(i) +
                               "\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture\" Target=\"/" +
                               texture_paths_[i] + "\"/>\n";
    }
    if (textured_) zip.add("3D/_rels/3dmodel.model.rels", texture_relationships + "</Relationships>\n", context_);
    zip.add("3D/3dmodel.model", pieces, context_);
    return zip.finish();
  }

 private:
  // Ids: 1 the object, 2 base materials, 3 vertex colours, then for each texture its picture and its coordinates, then
  // further objects.
  static int picture_id(std::size_t texture) { return 4 + 2 * static_cast<int>(texture); }
  static int coordinates_id(std::size_t texture) { return picture_id(texture) + 1; }

  /// What becomes an object of its own: rows of V and F, empty lists for all of them.
  struct Object {
    int id;
    std::string name;
    std::vector<int> vertices, faces;
  };
  std::vector<Object> objects() {
    const std::size_t count = model_.group_names.size();
    if (!options_.object_per_group || count < 2 || model_.face_group.empty()) return {{1, options_.name, {}, {}}};
    std::vector<Object> objects;
    for (std::size_t g = 0; g < count; ++g)
      objects.push_back(
          {g == 0 ? 1 : picture_id(model_.textures.size()) + static_cast<int>(g), model_.group_names[g], {}, {}});
    local_vertex_.resize(static_cast<std::size_t>(model_.mesh.V.rows()), -1);
    std::vector<int> owner(local_vertex_.size(), -1);
    for (std::size_t f = 0; f < model_.face_group.size(); ++f) {
      const auto g = static_cast<std::size_t>(std::max(0, model_.face_group[f]));
      objects[g].faces.push_back(static_cast<int>(f));
      for (const int v : model_.mesh.F.row(static_cast<Eigen::Index>(f))) {
        int& first = owner[static_cast<std::size_t>(v)];
        if (first >= 0 && first != static_cast<int>(g))
          return {{1, options_.name, {}, {}}};  // groups of one surface stay together
        if (first >= 0) continue;
        first = static_cast<int>(g);
        local_vertex_[static_cast<std::size_t>(v)] = static_cast<int>(objects[g].vertices.size());
        objects[g].vertices.push_back(v);
      }
    }
    std::erase_if(objects, [](const Object& object) { return object.faces.empty(); });
    return objects;
  }

  /// A texture can be written if its picture is known and of a kind that 3MF holds.
  void prepare_textures() {
    texture_paths_.resize(model_.textures.size());
    if (model_.FT.rows() == 0 || model_.face_material.empty()) return;
    for (std::size_t i = 0; i < model_.textures.size(); ++i) {
      const std::string type = picture_media_type(model_.textures[i].bytes);
      if (type != "image/png" && type != "image/jpeg") continue;
      texture_paths_[i] = "3D/Textures/texture" + std::to_string(i + 1) + (type == "image/png" ? ".png" : ".jpeg");
      textured_ = true;
    }
  }

  std::string head() {
    TextOut out;
    const bool coloured = model_.vertex_colours.rows() > 0;
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"";
    if (coloured || textured_) out << " xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"";
    out << ">\n<metadata name=\"Application\">Formwright</metadata>\n<resources>\n";
    if (!model_.materials.empty()) {
      out << "<basematerials id=\"2\">\n";
      for (const Material& material : model_.materials)
        out << "<base name=\"" << xml_attribute(material.name.empty() ? "unnamed" : clean_text(material.name))
            << "\" displaycolor=\"" << hexadecimal(material.diffuse) << "\"/>\n";
      out << "</basematerials>\n";
    }
    if (coloured) {
      out << "<m:colorgroup id=\"3\">\n";
      std::unordered_map<std::string, int> known;
      colour_of_vertex_.reserve(static_cast<std::size_t>(model_.vertex_colours.rows()));
      for (Eigen::Index v = 0; v < model_.vertex_colours.rows(); ++v) {
        const std::string colour = hexadecimal(model_.vertex_colours.row(v).transpose());
        const auto [place, fresh] = known.try_emplace(colour, static_cast<int>(known.size()));
        if (fresh) out << "<m:color color=\"" << colour << "\"/>\n";
        colour_of_vertex_.push_back(place->second);
      }
      out << "</m:colorgroup>\n";
    }
    for (std::size_t i = 0; i < texture_paths_.size(); ++i) {
      const std::string& path = texture_paths_[i];
      if (path.empty()) continue;
      out << "<m:texture2d id=\"" << picture_id(i) << "\" path=\"/" << path << "\" contenttype=\""
          << (path.ends_with(".png") ? "image/png" : "image/jpeg") << "\"/>\n"
          << "<m:texture2dgroup id=\"" << coordinates_id(i) << "\" texid=\"" << picture_id(i) << "\">\n";
      for (Eigen::Index t = 0; t < model_.UV.rows(); ++t)
        out << "<m:tex2coord u=\"" << static_cast<float>(model_.UV(t, 0)) << "\" v=\""
            << static_cast<float>(model_.UV(t, 1)) << "\"/>\n";
      out << "</m:texture2dgroup>\n";
    }
    return std::move(out.text());
  }

  /// pid, p1, p2, p3 of a face: the first of texture, vertex colours and base material that it has.
  void properties(TextOut& out, Eigen::Index f) const {
    const int material = model_.face_material.empty() ? -1 : model_.face_material[static_cast<std::size_t>(f)];
    const int texture = material < 0 ? -1 : model_.materials[static_cast<std::size_t>(material)].diffuse_texture;
    const auto write = [&](int group, int p1, int p2, int p3) {
      out << " pid=\"" << group << "\" p1=\"" << p1 << "\" p2=\"" << p2 << "\" p3=\"" << p3 << '"';
    };
    const auto& F = model_.mesh.F;
    const auto colour = [&](int k) { return colour_of_vertex_[static_cast<std::size_t>(F(f, k))]; };
    if (texture >= 0 && !texture_paths_[static_cast<std::size_t>(texture)].empty())
      write(coordinates_id(static_cast<std::size_t>(texture)), model_.FT(f, 0), model_.FT(f, 1), model_.FT(f, 2));
    else if (!colour_of_vertex_.empty()) write(3, colour(0), colour(1), colour(2));
    else if (material >= 0) out << " pid=\"2\" p1=\"" << material << '"';
  }

  const Model& model_;
  const WriteOptions& options_;
  const Context& context_;
  std::vector<std::string> texture_paths_;            // "" for those that are not written
  std::vector<int> colour_of_vertex_, local_vertex_;  // local_vertex_: its number within its object
  bool textured_ = false;
};

}  // namespace

Bytes write_three_mf(const Model& model, const WriteOptions& options, Context& context) {
  return ThreeMfWriter(model, options, context).write();
}

}  // namespace formwright
