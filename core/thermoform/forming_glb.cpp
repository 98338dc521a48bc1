// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/forming_glb.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/glb/glb_assembly.h"
#include "geometry/mesh/measures.h"

namespace formwright {
namespace {

constexpr GlbAssembly::Target vertices = GlbAssembly::Target::vertices, none = GlbAssembly::Target::none;
constexpr std::array<const char*, 3> phase_names{"relax", "raise", "vacuum"};

/// Thin is dark: cream to navy, sRGB stops from thick to thin.
Vec3 thickness_colour(double share) {
  static constexpr std::array<std::array<int, 3>, 5> stops{
      {{0x06, 0x16, 0x3f}, {0x21, 0x57, 0x9f}, {0x41, 0xb0, 0xc2}, {0xc0, 0xe3, 0xbc}, {0xf6, 0xf5, 0xdf}}};
  const double at = std::clamp(share, 0.0, 1.0) * (static_cast<double>(stops.size()) - 1);
  const auto low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double t = at - static_cast<double>(low);
  Vec3 colour;
  for (std::size_t k = 0; k < 3; ++k) {
    const double srgb = ((1 - t) * stops[low][k] + t * stops[low + 1][k]) / 255;
    colour[static_cast<int>(k)] =
        std::pow((srgb + 0.055) / 1.055, 2.4);  // linear; no stop is below 0.04 but one channel, where this is close
  }
  return colour;
}

int add_faces(GlbAssembly& glb, const TriangleMesh& mesh) {
  return glb.add_indices(static_cast<std::size_t>(mesh.F.size()), static_cast<std::size_t>(mesh.V.rows()),
                         [&](std::size_t i) { return mesh.F.data()[i]; });
}

}  // namespace

Bytes write_forming_glb(const FormedResult& result, const TriangleMesh& mould, double sheet_thickness_mm,
                        Context& context) {
  const std::vector<FormingFrame>& frames = result.frames;
  const auto n = static_cast<std::size_t>(result.sheet.mesh.V.rows());
  const std::size_t targets = frames.size() - 1;
  GlbAssembly glb("frames",
                  "The animation would be larger than 4 GB, the limit of GLB files: use fewer frames or triangles.");
  // From the clamp, as one watches the machine: what the platform sees shifted by where it stands.
  const auto place = [&](const FormingFrame& frame, Eigen::Index i, int k) {
    return frame.V(i, k) + (k == 2 ? frame.platform_z_mm : 0);
  };
  double minimum = sheet_thickness_mm, maximum = sheet_thickness_mm;
  for (const FormingFrame& frame : frames)
    for (const float h : frame.thickness_mm) {
      minimum = std::min(minimum, static_cast<double>(h));
      maximum = std::max(maximum, static_cast<double>(h));
    }
  const double scale_from = 0.2 * std::floor(minimum / (0.2 * sheet_thickness_mm)) * sheet_thickness_mm,
               span = std::max(sheet_thickness_mm - scale_from, 1e-9);
  const auto colours_of = [&](const FormingFrame& frame) {
    std::vector<Vec3> colours(n);
    for (std::size_t i = 0; i < n; ++i)
      colours[i] = thickness_colour((static_cast<double>(frame.thickness_mm[i]) - scale_from) / span);
    return colours;
  };

  Json attributes = Json::object(), morphs = Json::array();
  const FormingFrame& first = frames.front();
  const std::vector<Vec3> base = colours_of(first);
  attributes["POSITION"] =
      glb.add_floats(n, 3, "VEC3", true, vertices, [&](Eigen::Index i, int k) { return place(first, i, k); });
  attributes["COLOR_0"] = glb.add_floats(n, 3, "VEC3", false, vertices,
                                         [&](Eigen::Index i, int k) { return base[static_cast<std::size_t>(i)][k]; });
  Json times = Json::array(), phases = Json::array(), platform = Json::array(), touching = Json::array();
  for (std::size_t f = 0; f < frames.size(); ++f) {
    context.check_cancelled();
    times.push_back(frames[f].time_s);
    phases.push_back(phase_names[static_cast<std::size_t>(frames[f].phase)]);
    platform.push_back(frames[f].platform_z_mm);
    touching.push_back(frames[f].touching_share);
    if (f == 0) continue;
    const std::vector<Vec3> colours = colours_of(frames[f]);
    Json target = Json::object();
    target["POSITION"] = glb.add_floats(n, 3, "VEC3", true, vertices, [&](Eigen::Index i, int k) {
      return place(frames[f], i, k) - place(first, i, k);
    });
    target["COLOR_0"] = glb.add_floats(n, 3, "VEC3", false, vertices, [&](Eigen::Index i, int k) {
      return colours[static_cast<std::size_t>(i)][k] - base[static_cast<std::size_t>(i)][k];
    });
    morphs.push_back(std::move(target));
  }
  const int indices = add_faces(glb, result.sheet.mesh);

  Json extras = {{"frame_times_s", times},
                 {"frame_phases", phases},
                 {"platform_z_mm", platform},
                 {"touching_share", touching},
                 {"thickness_mm", {scale_from, sheet_thickness_mm}}};
  Json weights = Json::array();
  for (std::size_t t = 0; t < targets; ++t)
    weights.push_back(t + 1 == targets ? 1 : 0);  // at rest a viewer shows the formed sheet
  Json meshes = Json::array(
      {{{"name", "sheet"},
        {"primitives",
         Json::array({{{"attributes", attributes}, {"indices", indices}, {"material", 0}, {"targets", morphs}}})},
        {"weights", weights},
        {"extras", extras}}});
  // A frame's weight rises and falls linearly between its neighbours' times.
  const int time_accessor = glb.add_floats(frames.size(), 1, "SCALAR", true, none, [&](Eigen::Index i, int) {
    return frames[static_cast<std::size_t>(i)].time_s;
  });
  const int weight_accessor =
      glb.add_floats(frames.size() * targets, 1, "SCALAR", false, none, [&](Eigen::Index i, int) {
        const auto at = static_cast<std::size_t>(i);
        return at / targets == at % targets + 1 ? 1.0 : 0.0;
      });
  const int lift_accessor = glb.add_floats(frames.size(), 3, "VEC3", false, none, [&](Eigen::Index i, int k) {
    return k == 2 ? frames[static_cast<std::size_t>(i)].platform_z_mm : 0.0;
  });
  Json nodes = Json::array({{{"name", "machine"},
                             {"children", {1, 2}},
                             {"scale", {0.001, 0.001, 0.001}},
                             {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}},
                            {{"name", "sheet"}, {"mesh", 0}},
                            {{"name", "mould"}}});
  if (mould.face_count() > 0) {
    const Positions normals = vertex_normals(mould);
    Json mould_attributes = Json::object();
    const auto count = static_cast<std::size_t>(mould.V.rows());
    mould_attributes["POSITION"] =
        glb.add_floats(count, 3, "VEC3", true, vertices, [&](Eigen::Index i, int k) { return mould.V(i, k); });
    mould_attributes["NORMAL"] = glb.add_floats(count, 3, "VEC3", false, vertices, [&](Eigen::Index i, int k) {
      return normals.row(i).squaredNorm() > 0 ? normals(i, k) : (k == 2 ? 1.0 : 0.0);
    });
    const int mould_indices = add_faces(glb, mould);
    meshes.push_back(
        {{"name", "mould"},
         {"primitives",
          Json::array({{{"attributes", mould_attributes}, {"indices", mould_indices}, {"material", 1}}})}});
    nodes[2]["mesh"] = 1;
  }
  const auto material = [](const char* name, double grey) {
    return Json{{"name", name},
                {"pbrMetallicRoughness",
                 {{"baseColorFactor", {grey, grey, grey, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.7}}},
                {"doubleSided", true}};
  };
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "Formwright"}}}};
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", {0}}}});
  json["nodes"] = nodes;
  json["meshes"] = meshes;
  json["materials"] = {material("sheet", 1), material("mould", 0.6)};
  json["animations"] = Json::array(
      {{{"name", "forming"},
        {"samplers", Json::array({{{"input", time_accessor}, {"output", weight_accessor}, {"interpolation", "LINEAR"}},
                                  {{"input", time_accessor}, {"output", lift_accessor}, {"interpolation", "LINEAR"}}})},
        {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 1}, {"path", "weights"}}}},
                                  {{"sampler", 1}, {"target", {{"node", 2}, {"path", "translation"}}}}})}}});
  return glb.finish(std::move(json));
}

}  // namespace formwright
