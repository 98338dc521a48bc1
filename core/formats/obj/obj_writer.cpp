// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "formats/shared/colour.h"
#include "formats/shared/mesh_source.h"
#include "formats/obj/obj.h"
#include "formats/shared/text_out.h"

namespace formwright {
namespace {

/// A name as OBJ can hold it: one line, never empty.
std::string obj_name(std::string_view name) { return name.empty() ? "unnamed" : clean_text(name); }

int at_or(const std::vector<int>& values, std::size_t i) { return values.empty() ? -1 : values[i]; }

}  // namespace

Bytes write_obj(const Model& model, const WriteOptions& options, Context& context) {
  const auto& [V, F] = model.mesh;
  const auto& colours = model.vertex_colours;
  const bool with_materials = !options.material_library.empty() && !model.face_material.empty();
  std::vector<std::string> pieces;
  const auto add = [&](std::vector<std::string> more) { std::ranges::move(more, std::back_inserter(pieces)); };

  TextOut head;
  head << "# Formwright, lengths in mm\n";
  if (with_materials) head << "mtllib " << obj_name(options.material_library) << '\n';
  if (model.face_group.empty()) head << "o " << obj_name(options.name) << '\n';
  pieces.push_back(std::move(head.text()));

  add(format_rows(static_cast<std::size_t>(V.rows()), colours.rows() > 0 ? 72 : 48, context,
                  [&](TextOut& out, std::size_t i) {
                    const auto v = static_cast<Eigen::Index>(i);
                    out << "v " << V(v, 0) << ' ' << V(v, 1) << ' ' << V(v, 2);
                    if (colours.rows() > 0)  // as float: nobody's colours are finer
                      for (int k = 0; k < 3; ++k) out << ' ' << static_cast<float>(srgb_of_linear(colours(v, k)));
                    out << '\n';
                  }));
  add(format_rows(static_cast<std::size_t>(model.UV.rows()), 36, context, [&](TextOut& out, std::size_t i) {
    const auto t = static_cast<Eigen::Index>(i);
    out << "vt " << model.UV(t, 0) << ' ' << model.UV(t, 1) << '\n';
  }));
  const bool with_texture = model.FT.rows() > 0;
  add(format_rows(
      static_cast<std::size_t>(F.rows()), with_texture ? 48 : 26, context, [&](TextOut& out, std::size_t i) {
        const int group = at_or(model.face_group, i), material = with_materials ? at_or(model.face_material, i) : -1;
        if (!model.face_group.empty() && (i == 0 || group != at_or(model.face_group, i - 1)))
          out << "g " << (group < 0 ? "default" : obj_name(model.group_names[static_cast<std::size_t>(group)])) << '\n';
        if (with_materials && (i == 0 || material != at_or(model.face_material, i - 1)))
          out << "usemtl "
              << (material < 0 ? "default" : obj_name(model.materials[static_cast<std::size_t>(material)].name))
              << '\n';
        const auto f = static_cast<Eigen::Index>(i);
        out << 'f';
        for (int k = 0; k < 3; ++k) {
          out << ' ' << F(f, k) + 1;
          if (with_texture) out << '/' << model.FT(f, k) + 1;
        }
        out << '\n';
      }));
  return concatenate(pieces);
}

Bytes write_mtl(const Model& model) {
  TextOut out;
  out << "# Formwright\n";
  for (const Material& material : model.materials) {
    out << "newmtl " << obj_name(material.name) << "\nKd";
    for (const double c : material.diffuse) out << ' ' << static_cast<float>(srgb_of_linear(c));
    out << '\n';
    if (material.diffuse_texture >= 0)
      out << "map_Kd " << obj_name(model.textures[static_cast<std::size_t>(material.diffuse_texture)].name) << '\n';
  }
  return to_bytes(out.text());
}

}  // namespace formwright
