// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/forest/forest_files.h"

#include <cmath>
#include <numbers>

#include "fabrication/sheet/word_paths.h"
#include "formats/container/zip.h"
#include "formats/mesh_io.h"
#include "imaging/picture/png_writer.h"
#include "relief/forest/forest_picture.h"

namespace formwright {
namespace {

constexpr double plan_margin_mm = 20, number_height_mm = 2.5, viewpoint_height_mm = 6;
constexpr int hole_corners = 96;
constexpr double seen_beyond = 1.5;  // of the distance of what is looked at
constexpr int model_picture_pixels = 240;

CutPath outline_path(CutLayer layer, const Outline& outline, const Vec2& origin, const std::string& name) {
  CutPath path{layer, {}, true, name};
  for (const Vec2& p : outline) path.points_mm.push_back(p - origin);
  return path;
}

/// Letters and digits for the name of a file.
std::string file_word(const std::string& words) {
  std::string word;
  for (const char c : words) word += (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ? c : '_';
  return word;
}

}  // namespace

std::string numbered(std::size_t index, std::size_t count) {
  const std::string number = std::to_string(index + 1);
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(count).size());
  return std::string(digits - std::min(digits, number.size()), '0') + number;
}

CutSheet floor_plan(const ForestPlan& plan, double hole_diameter_mm) {
  const std::vector<Vec2>& pins = plan.pins_mm;
  Vec2 low = Vec2::Constant(INFINITY), high = -low;
  for (const Pillar& pillar : plan.scene.pillars)
    for (const Vec2& p : pillar.outline_mm) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  const Vec2 origin = low - Vec2::Constant(plan_margin_mm);
  CutSheet sheet;
  sheet.title = "Floor plan";
  sheet.width_mm = high.x() - low.x() + 2 * plan_margin_mm;
  sheet.height_mm = high.y() - low.y() + 2 * plan_margin_mm;
  // Around the circle, so that the hole is nowhere narrower.
  const double hole = hole_diameter_mm / std::cos(std::numbers::pi / hole_corners);
  for (std::size_t p = 0; p < pins.size(); ++p) {
    const std::string number = std::to_string(p + 1);
    const Outline& outline = plan.scene.pillars[p].outline_mm;
    sheet.paths.push_back(
        outline_path(CutLayer::cut, round_outline(pins[p], hole, hole_corners), origin, "hole-" + number));
    sheet.paths.push_back(outline_path(CutLayer::mark, outline, origin, "pillar-" + number));
    double top = pins[p].y();
    for (const Vec2& q : outline) top = std::max(top, q.y());
    const Vec2 mark = pins[p] - origin;
    sheet.paths.push_back({CutLayer::mark,
                           {mark + Vec2(0, 0.5 * hole_diameter_mm), Vec2(mark.x(), top - origin.y())},
                           false,
                           "turn-" + number});
    const Vec2 words = mark - Vec2(0, 0.5 * hole_diameter_mm + 0.7 * number_height_mm);
    for (CutPath& path : word_paths(number, words, Vec2(1, 0), number_height_mm, CutLayer::engrave))
      sheet.paths.push_back(std::move(path));
  }
  // At the edge of the sheet in the direction of each viewpoint.
  const Vec2 middle = 0.5 * Vec2(sheet.width_mm, sheet.height_mm), reach = middle - Vec2::Constant(viewpoint_height_mm);
  for (std::size_t v = 0; v < plan.views.size(); ++v) {
    const Vec2 away = plan.plan_views[v].eye - origin - middle;
    const double share =
        std::min(reach.x() / std::max(std::abs(away.x()), 1e-9), reach.y() / std::max(std::abs(away.y()), 1e-9));
    for (CutPath& path : word_paths("V" + std::to_string(v + 1), middle + std::min(1.0, share) * away, Vec2(1, 0),
                                    viewpoint_height_mm, CutLayer::note))
      sheet.paths.push_back(std::move(path));
  }
  return sheet;
}

Json plan_json(const ForestPlan& plan) {
  const auto place = [](const Vec2& p) { return Json{p.x(), p.y()}; };
  Json views = Json::array(), pillars = Json::array();
  for (std::size_t v = 0; v < plan.views.size(); ++v) {
    const PlanView& view = plan.plan_views[v];
    const auto on_wall = [&](const WallStrip& s, double t) {
      const Outline& outline = plan.scene.pillars[static_cast<std::size_t>(s.pillar)].outline_mm;
      return view.at(t, view.meets_line(t, corner(outline, s.edge), corner(outline, s.edge + 1)));
    };
    // Where rays meet nothing, the area ends beyond what is looked at.
    const double beyond = seen_beyond * view.distance_mm;
    // Not in braces: of a single value in braces some compilers make a list and others a copy.
    Json sight = Json::array(), surfaces = Json::array();
    sight.push_back(place(view.eye));
    double t = view.from;
    for (const WallStrip& s : plan.strips[v]) {
      if (s.from > t) sight.insert(sight.end(), {place(view.at(t, beyond)), place(view.at(s.from, beyond))});
      sight.insert(sight.end(), {place(on_wall(s, s.from)), place(on_wall(s, s.to))});
      t = s.to;
    }
    if (t < view.to) sight.insert(sight.end(), {place(view.at(t, beyond)), place(view.at(view.to, beyond))});
    for (const WallPiece& piece : plan.walls.pieces[v]) {
      Json line = Json::array();
      line.push_back(place(on_wall(piece.strips.front(), piece.from())));
      for (const WallStrip& s : piece.strips) line.push_back(place(on_wall(s, s.to)));
      surfaces.push_back({{"pillar", piece.pillar + 1}, {"line_mm", line}});
    }
    views.push_back({{"eye_mm", place(view.eye)}, {"sight_mm", sight}, {"surfaces", surfaces}});
  }
  for (const Pillar& pillar : plan.scene.pillars) {
    Json outline = Json::array();
    for (const Vec2& p : pillar.outline_mm) outline.push_back(place(p));
    pillars.push_back(outline);
  }
  Json shared = Json::array();
  for (const SharedWall& wall : plan.walls.shared) {
    const Outline& outline = plan.scene.pillars[static_cast<std::size_t>(wall.pillar)].outline_mm;
    const Vec2 &a = corner(outline, wall.edge), &b = corner(outline, wall.edge + 1);
    shared.push_back({{"pillar", wall.pillar + 1},
                      {"viewpoints", {wall.views[0] + 1, wall.views[1] + 1}},
                      {"line_mm", {place(a + wall.from * (b - a)), place(a + wall.to * (b - a))}}});
  }
  return {{"viewpoints", views}, {"pillars_mm", pillars}, {"shared", shared}};
}

Model standing_pillars(const SolvedForest& forest) {
  Model model;
  model.mesh = forest.standing.mesh;
  model.face_group = forest.standing.face_pillar;
  for (std::size_t p = 0; p < forest.pillars.size(); ++p)
    model.group_names.push_back("pillar " + numbered(p, forest.pillars.size()));
  return model;
}

Bytes pillar_files(const SolvedForest& forest, Context& context) {
  ZipWriter zip;
  for (std::size_t p = 0; p < forest.pillars.size(); ++p) {
    const std::string name = "pillar_" + numbered(p, forest.pillars.size());
    Model model;
    model.mesh = forest.pillars[p].mesh;
    const Vec2& pin = forest.pillars[p].pin_mm;
    model.mesh.V.rowwise() -= Eigen::RowVector3d(pin.x(), pin.y(), model.mesh.V.col(2).minCoeff());
    WriteOptions write;
    write.name = name;
    zip.add_stored(name + ".stl", write_model(model, MeshFormat::stl, write, context));
  }
  return zip.finish();
}

std::vector<Image> forest_pictures(const ForestPlan& plan, const SolvedForest& forest, int pixels, Context& context) {
  std::vector<Image> pictures;
  const auto from = [&](const ForestCamera& camera) {
    pictures.push_back(picture_of_forest(forest.standing, *forest.caster, camera, pixels, context));
  };
  for (std::size_t v = 0; v < plan.views.size(); ++v) from(camera_of(plan.scene.viewpoints[v], plan.height_shares[v]));
  from(camera_from_elsewhere(plan.scene));
  return pictures;
}

Bytes picture_files(const ForestPlan& plan, const std::vector<Image>& pictures, Context& context) {
  ZipWriter zip;
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    const std::string name =
        v == plan.views.size() ? "elsewhere"
                               : "viewpoint_" + std::to_string(v + 1) + "_" + file_word(plan.scene.viewpoints[v].model);
    zip.add_stored(name + ".png", write_png(pictures[v], 0, context));
  }
  return zip.finish();
}

Bytes model_picture_files(const std::vector<ViewFrame>& frames, const std::vector<const TriangleMesh*>& meshes,
                          Context& context) {
  ZipWriter zip;
  for (std::size_t v = 0; v < frames.size(); ++v) {
    const Image picture = picture_of_model(frames[v], meshes[v]->F, model_picture_pixels, context);
    zip.add_stored("model_" + std::to_string(v + 1) + ".png", write_png(picture, 0, context));
  }
  return zip.finish();
}

Image overview(const std::vector<Image>& pictures) {
  const int count = static_cast<int>(pictures.size()), columns = static_cast<int>(std::ceil(std::sqrt(count))),
            rows = (count + columns - 1) / columns, width = pictures.front().width, height = pictures.front().height;
  Image all(columns * width, rows * height, Rgba{255, 255, 255, 255});
  for (int k = 0; k < count; ++k) {
    const Image& one = pictures[static_cast<std::size_t>(k)];
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) all.at(k % columns * width + x, k / columns * height + y) = one.at(x, y);
  }
  return all;
}

}  // namespace formwright
