// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/zipping_files.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "formats/glb/glb_assembly.h"
#include "formats/mesh_io.h"

namespace formwright {
namespace {

/// Near is cream, far is red; linear RGB.
Vec3 distance_colour(double share) {
  const Vec3 near(0.91, 0.87, 0.76), far(0.55, 0.02, 0.03);
  const double t = std::clamp(share, 0.0, 1.0);
  return (1 - t) * near + t * far;
}

}  // namespace

Bytes write_zipped_ply(const ZippingResult& result, Context& context) {
  Model model;
  model.mesh = {result.zipped_mm, result.pattern.flat.F};
  Eigen::VectorXd strain = Eigen::VectorXd::Zero(result.zipped_mm.rows());
  for (const ClothTriangle& t : cloth_triangles(result.pattern.flat))
    for (const int v : t.vertex) strain[v] = std::max(strain[v], largest_strain(t, result.zipped_mm));
  const std::vector<VertexColumn> columns{{"distance_mm", result.comparison.distance_mm, ColumnKind::float32},
                                          {"strain", strain, ColumnKind::float32}};
  WriteOptions options;
  options.columns = columns;
  return write_model(model, MeshFormat::ply, options, context);
}

Bytes write_zipping_glb(const ZippingResult& result, Context& context) {
  constexpr GlbAssembly::Target vertices = GlbAssembly::Target::vertices, none = GlbAssembly::Target::none;
  const std::vector<ZippingFrame>& frames = result.frames;
  const auto n = static_cast<std::size_t>(result.zipped_mm.rows());
  const std::size_t targets = frames.size() - 1;
  constexpr double frames_per_second = 8;
  const double colour_span = std::max(0.05 * result.pattern.size_mm, 1e-9);
  GlbAssembly glb("frames",
                  "The animation would be larger than 4 GB, the limit of GLB files: use fewer frames or triangles.");
  Json attributes = Json::object(), morphs = Json::array(), shares = Json::array(), frame_times = Json::array(),
       weights = Json::array();
  attributes["POSITION"] = glb.add_floats(
      n, 3, "VEC3", true, vertices, [&](Eigen::Index i, int k) { return static_cast<double>(frames[0].V(i, k)); });
  attributes["COLOR_0"] = glb.add_floats(n, 3, "VEC3", false, vertices, [&](Eigen::Index i, int k) {
    return distance_colour(result.comparison.distance_mm[i] / colour_span)[k];
  });
  for (std::size_t f = 0; f < frames.size(); ++f) {
    context.check_cancelled();
    shares.push_back(frames[f].zipped_share);
    frame_times.push_back(static_cast<double>(f) / frames_per_second);
    if (f == 0) continue;
    Json target = Json::object();
    target["POSITION"] = glb.add_floats(n, 3, "VEC3", true, vertices, [&](Eigen::Index i, int k) {
      return static_cast<double>(frames[f].V(i, k)) - static_cast<double>(frames[0].V(i, k));
    });
    morphs.push_back(std::move(target));
    weights.push_back(f == targets ? 1 : 0);  // at rest a viewer shows what is zipped
  }
  const Triangles& F = result.pattern.flat.F;
  const int indices =
      glb.add_indices(static_cast<std::size_t>(F.size()), n, [&](std::size_t i) { return F.data()[i]; });
  // A frame's weight rises and falls linearly between its neighbours' times.
  const int times = glb.add_floats(frames.size(), 1, "SCALAR", true, none,
                                   [](Eigen::Index i, int) { return static_cast<double>(i) / frames_per_second; });
  const int course = glb.add_floats(frames.size() * targets, 1, "SCALAR", false, none, [&](Eigen::Index i, int) {
    const auto at = static_cast<std::size_t>(i);
    return at / targets == at % targets + 1 ? 1.0 : 0.0;
  });
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "Formwright"}}}, {"scene", 0}};
  json["scenes"] = Json::array({{{"nodes", {0}}}});
  json["nodes"] = Json::array({{{"name", "cloth"},
                                {"mesh", 0},
                                {"scale", {0.001, 0.001, 0.001}},
                                {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}}});
  json["meshes"] = Json::array(
      {{{"name", "cloth"},
        {"primitives",
         Json::array({{{"attributes", attributes}, {"indices", indices}, {"material", 0}, {"targets", morphs}}})},
        {"weights", weights},
        {"extras", {{"zipped_share", shares}, {"frame_times_s", frame_times}, {"distance_mm", {0, colour_span}}}}}});
  json["materials"] = Json::array({{{"name", "cloth"},
                                    {"doubleSided", true},
                                    {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}}});
  json["animations"] =
      Json::array({{{"name", "zipping"},
                    {"samplers", Json::array({{{"input", times}, {"output", course}, {"interpolation", "LINEAR"}}})},
                    {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})}}});
  return glb.finish(std::move(json));
}

std::string zipping_verdict(const ZippingResult& result, double tolerance_percent) {
  const ShapeComparison& c = result.comparison;
  const std::string figures = "95 % of it lie within " + with_digits(c.percentile_95_mm, 3) + " mm (" +
                              with_digits(100 * c.percentile_95_mm / std::max(result.pattern.size_mm, 1e-9), 3) +
                              " % of its size) of the design";
  const std::string how = std::string(c.mirrored ? ", inside out" : "") +
                          (result.pressed_out ? ", once it is pressed out from inside" : "");
  switch (zipping_outcome(result, tolerance_percent)) {
    case ZippingOutcome::open_seams:
      return "It does not zip up: " + std::to_string(result.open_seams) +
             " pairs of points that should meet stay up to " + with_digits(result.gap_max_mm, 3) + " mm apart; " +
             figures + ".";
    case ZippingOutcome::not_settled:
      return "The cloth was still moving when the simulation ended, so the result is uncertain; " + figures + ".";
    case ZippingOutcome::takes_shape: return "It zips into the intended shape" + how + ": " + figures + ".";
    case ZippingOutcome::as_the_cloth_does:
      return "It zips into the intended shape" + how + ", as closely as this cloth can hold it: " + figures +
             ", and put there it would rest " + with_digits(result.rest.percentile_95_mm, 3) +
             " mm away. Stiffer cloth or stuffing comes closer.";
    case ZippingOutcome::another_shape: break;
  }
  const bool would_stay = result.rest.percentile_95_mm <= 0.01 * tolerance_percent * result.pattern.size_mm;
  return "It zips up, but not into the intended shape: " + figures +
         (would_stay ? "; placed in the intended shape, it would stay there."
                     : "; placed in the intended shape, it would not stay there.");
}

}  // namespace formwright
