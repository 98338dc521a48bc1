// SPDX-License-Identifier: GPL-3.0-or-later
// From the model's colours to the pixels: dots that land where a closed form says, the picture carried back, bleed,
// pages.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include "base/error.h"
#include "formats/mesh_io.h"
#include "geometry/samples/samples.h"
#include "imaging/picture/light.h"
#include "imaging/picture/picture_reader.h"
#include "thermoform/print/formed_sheets.h"
#include "thermoform/print/print_pages.h"
#include "thermoform/print/texture_print.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using test::Cone;

/// UV from straight above: [-half, half]^2 onto the whole picture.
void lay_from_above(Model& model, double half_mm) {
  model.UV = (model.mesh.V.leftCols(2).array() / (2 * half_mm) + 0.5).matrix();
  model.FT = model.mesh.F;
}

Image white(int side) { return {side, side, {255, 255, 255, 255}}; }

TEST_CASE("Print.DotsOnAConeLandWhereTheClosedFormSays") {
  const Cone cone;
  const double half_mm = 65, dot_mm = 0.6;
  Image picture = white(3000);
  std::vector<Vec2> dots;
  for (int ring = 0; ring < 5; ++ring)
    for (int k = 0; k < 12; ++k)
      dots.push_back(Vec2(std::cos(0.5 * k + ring), std::sin(0.5 * k + ring)) * (14 + 9.5 * ring));
  const auto texels = static_cast<double>(picture.width) / (2 * half_mm);
  for (const Vec2& dot : dots) {
    const Vec2 centre((dot.x() + half_mm) * texels, (half_mm - dot.y()) * texels);
    for (int y = static_cast<int>(centre.y() - 20); y <= centre.y() + 20; ++y)
      for (int x = static_cast<int>(centre.x() - 20); x <= centre.x() + 20; ++x)
        if ((Vec2(x + 0.5, y + 0.5) - centre).norm() < dot_mm * texels) picture.at(x, y) = {0, 0, 0, 255};
  }
  Model model;
  model.mesh = cone.mesh(1, 180);
  lay_from_above(model, half_mm);
  ThermoformPrintOptions options = test::plain_options(2 * cone.radius_mm, 300);
  Context context;
  const TexturePrint print = make_texture_print(model, model.mesh, cone.sheet(80, 180), picture, options, context);
  CHECK(print.colours == PrintColours::picture);
  double worst = 0;
  for (const Vec2& dot : dots) {
    const Vec2 expected = cone.flat(Vec3(dot.x(), dot.y(), 0)), pixel = print.grid.pixel(expected);
    // Middle of the dark within 2 mm, weighted by how dark.
    Vec2 sum = Vec2::Zero();
    double weight = 0;
    const int reach = 20;
    for (int y = static_cast<int>(pixel.y()) - reach; y <= pixel.y() + reach; ++y)
      for (int x = static_cast<int>(pixel.x()) - reach; x <= pixel.x() + reach; ++x) {
        const double dark = 1 - light_of_byte()[print.picture.at(x, y)[1]] / light_levels;
        sum += dark * Vec2(x + 0.5, y + 0.5);
        weight += dark;
      }
    {
      INFO(dot.transpose());
      REQUIRE(weight > 10);
    }
    worst = std::max(worst, (sum / weight - pixel).norm() * print.grid.pixel_mm());
  }
  SUCCEED("worst_um " << static_cast<int>(1000 * worst));
  CHECK(worst < 0.05);
}

TEST_CASE("Print.CarriedBackOntoTheSheetItIsTheModelAgain") {
  Context context;
  const Model model = make_sample("mountain", 6000, context);
  ThermoformPrintOptions options = test::plain_options(130, 300);
  options.size_mm = 100;
  options.bleed_mm = 0;
  const TriangleMesh placed = place(model.mesh, options, clamp_opening_mm(options))(model.mesh);
  const FormedSheet sheet = test::dropped_sheet(placed, 130, 90, 0.3);
  const TexturePrint print = make_texture_print(model, placed, sheet, std::nullopt, options, context);
  CHECK(print.area_mm2[0] > 4000);
  // The model's own colour at a point, against the print's where that point went; both as bytes.
  const LinearPicture picture(read_picture(model.textures.at(0).bytes, "", "mould"), false, context);
  double error = 0, error_shifted = 0, count = 0;
  for (std::size_t f = 0; f < print.projected.face.size(); f += 7) {
    if (print.projected.face[f] != Coverage::coloured) continue;
    Vec2 at = Vec2::Zero(), uv = Vec2::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      at +=
          print.projected.sheet_mm.row(print.surface.mesh.F(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)))
              .transpose() /
          3;
      const Eigen::Vector2d w = print.surface.place[f][k].cast<double>();
      const auto corner = [&](int c) -> Vec2 { return model.UV.row(model.FT(print.surface.face_of[f], c)); };
      uv += ((1 - w.sum()) * corner(0) + w.x() * corner(1) + w.y() * corner(2)) / 3;
    }
    const Light own = picture.sample(
        Vec2(uv.x(), 1 - uv.y()),
        picture.footprint(Eigen::Matrix2d::Identity() * (100.0 / print.grid.per_metre * picture.width() / 10)));
    const auto differ = [&](const Vec2& place) {
      const Vec2 pixel = print.grid.pixel(place);
      const Rgba& printed = print.picture.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        sum += std::abs(printed[k] - byte_of_light()[static_cast<std::size_t>(own[k])]) / 3.0;
      return sum;
    };
    error += differ(at);
    error_shifted += differ(at + Vec2(0.5, 0));
    count += 1;
  }
  REQUIRE(count > 1000);
  SUCCEED("mean_levels " << static_cast<int>(100 * error / count));
  CHECK(error / count < 4);                            // of 255: a pixel's worth of texture
  CHECK(error_shifted / count > 1.3 * error / count);  // half a mm off would show
}

TEST_CASE("Print.LeavesNoCracksAndNoSeams") {
  Context context;
  const Cone cone;
  Model model;
  model.mesh = cone.mesh(20, 50);
  model.vertex_colours = Positions::Constant(model.mesh.vertex_count(), 3, 0.2);
  ThermoformPrintOptions options = test::plain_options(2 * cone.radius_mm, 200);
  options.bleed_mm = 0;
  options.gap_mm = 3;
  const TexturePrint print = make_texture_print(model, model.mesh, cone.sheet(60, 50), std::nullopt, options, context);
  CHECK(print.colours == PrintColours::vertex_colours);
  const std::uint8_t expected = byte_of_unit(srgb_of_linear(0.2));
  int inside = 0;
  for (int y = 0; y < print.grid.height; ++y)
    for (int x = 0; x < print.grid.width; ++x) {
      const Vec2 mm = (Vec2(x + 0.5, y + 0.5) - Vec2(print.grid.width, print.grid.height) / 2) * print.grid.pixel_mm();
      if (mm.norm() < 0.98 * cone.radius_mm) {
        {
          INFO(x << " " << y);
          REQUIRE(print.picture.at(x, y) == Rgba{expected, expected, expected, 255});
        }
        ++inside;
      } else if (mm.norm() > 1.01 * cone.radius_mm) {
        INFO(x << " " << y);
        REQUIRE(print.picture.at(x, y) == Rgba{255, 255, 255, 255});
      }
    }
  CHECK(inside > 100'000);
  CHECK_THAT(print.stretch_mean, WithinAbs(2 / 0.75, 0.1));  // h0 / h = 1 / (0.75 u) over the area 2 u du
}

TEST_CASE("Print.TheFormedSheetWearsThePrint") {
  Context context;
  const Cone cone;
  Model model;
  model.mesh = cone.mesh(1, 64);
  ThermoformPrintOptions options = test::plain_options(2 * cone.radius_mm, 150);
  options.colours = PrintColours::checker;
  options.pattern_mm = 30;
  const FormedSheet sheet = cone.sheet(30, 64);
  const TexturePrint print = make_texture_print(model, model.mesh, sheet, std::nullopt, options, context);
  const Model worn = read_model(formed_picture(sheet, print, 300, context), "formed.glb", context);
  REQUIRE(worn.textures.size() == 1u);
  REQUIRE(worn.mesh.face_count() == sheet.mesh.face_count());
  const Image texture = read_picture(worn.textures[0].bytes, "", "texture");
  CHECK(std::max(texture.width, texture.height) <= 300);
  const double scale = static_cast<double>(print.grid.width) / texture.width;
  CHECK(scale > 2);
  int compared = 0, agreed = 0;
  for (Eigen::Index f = 0; f < worn.mesh.F.rows(); ++f) {
    // Upright: machine z is up, and the machine's front (-y) towards the viewer (+z).
    const Vec3 a = worn.mesh.V.row(worn.mesh.F(f, 0)), machine = sheet.mesh.V.row(sheet.mesh.F(f, 0));
    CHECK_THAT((a - Vec3(machine.x(), machine.z(), -machine.y())).norm(), WithinAbs(0, 1e-3));
    const Vec2 uv = worn.UV.row(worn.FT(f, 0));
    const Vec2 texel(uv.x() * texture.width, (1 - uv.y()) * texture.height),
        pixel = print.grid.pixel(sheet.sheet_mm.row(sheet.mesh.F(f, 0)));
    CHECK_THAT((texel * std::ceil(scale) - pixel).norm(), WithinAbs(0, 0.01));
    const int x = std::clamp(static_cast<int>(texel.x()), 0, texture.width - 1),
              y = std::clamp(static_cast<int>(texel.y()), 0, texture.height - 1);
    const Rgba own = print.picture.at(std::clamp(static_cast<int>(pixel.x()), 0, print.grid.width - 1),
                                      std::clamp(static_cast<int>(pixel.y()), 0, print.grid.height - 1));
    ++compared;
    agreed += std::abs(texture.at(x, y)[0] - own[0]) < 20;
  }
  CHECK(agreed > 0.9 * compared);  // all but along the checker's edges
}

TEST_CASE("Print.BleedReachesAsFarAsItSays") {
  TriangleMesh plate = test::grid_mesh(20, 20, 4, 4);
  plate.V.col(2).array() = 5;
  FormedSheet sheet;
  sheet.mesh = test::grid_mesh(50, 50, 20, 20);
  sheet.sheet_mm = sheet.mesh.V.leftCols(2);
  sheet.mesh.V.col(2).array() = 5;
  test::fill_columns(sheet, 0);
  Model model;
  model.mesh = plate;
  ThermoformPrintOptions options = test::plain_options(100, 254);
  options.bleed_mm = 4;
  options.pattern_mm = 7;
  Context context;
  const TexturePrint print = make_texture_print(model, plate, sheet, std::nullopt, options, context);
  CHECK(print.colours == PrintColours::checker);
  int coloured = 0;
  for (const Rgba& p : print.picture.pixels) coloured += p != Rgba{255, 255, 255, 255};
  // A square with rounded corners, in mm^2.
  const double expected = 40 * 40 + 4 * 40 * 4 + std::numbers::pi * 16;
  CHECK_THAT(coloured * print.grid.pixel_mm() * print.grid.pixel_mm(), WithinAbs(expected, 0.01 * expected));
  CHECK_THAT(print.uncoloured_share(), WithinAbs(0, 1e-12));
  CHECK(print.sentences == std::vector<std::string>());
}

TEST_CASE("Print.IsMirroredAndMarkedAsAsked") {
  ThermoformPrintOptions options;
  const PrintGrid grid = print_grid(options);
  CHECK(grid.width == 2835);
  CHECK(grid.height == 3071);
  CHECK_THAT(grid.width * grid.pixel_mm(), WithinAbs(240, grid.pixel_mm() / 2));
  CHECK_THAT(grid.height * grid.pixel_mm(), WithinAbs(260, grid.pixel_mm() / 2));
  Image picture(grid.width, grid.height, {255, 255, 255, 255});
  picture.at(700, 800) = {200, 10, 10, 255};
  const Image plain = with_marks(picture, grid, options);
  options.mirror = true;
  Image mirrored = with_marks(picture, grid, options);
  mirror_left_right(mirrored);
  // Equal but for the word MIRRORED on the rim at the back.
  int different = 0;
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x)
      if (plain.at(x, y) != mirrored.at(x, y)) {
        ++different;
        CHECK(y < 118);
      }
  CHECK(different > 200);
  CHECK(plain.at(700, 800) == picture.at(700, 800));
  // Every cross is black in its middle, at the stated place, and in the clamp.
  const auto marks = registration_marks(options);
  REQUIRE(marks.size() == 8u);
  for (const RegistrationMark& mark : marks) {
    const Vec2 p = grid.pixel(mark.place_mm);
    {
      INFO(mark.name);
      CHECK(plain.at(static_cast<int>(p.x()), static_cast<int>(p.y()))[0] == 0);
    }
    CHECK((std::abs(mark.place_mm.x()) > 110 || std::abs(mark.place_mm.y()) > 120));
    CHECK((std::abs(mark.place_mm.x()) < 120 && std::abs(mark.place_mm.y()) < 130));
  }
  options.clamp_opening_x_mm = 236;
  CHECK(registration_marks(options).empty());
}

TEST_CASE("Print.TilesCoverTheSheetOnceAndOverlapAsAsked") {
  for (const Paper paper : {Paper::sheet, Paper::a4, Paper::a3, Paper::a2, Paper::letter, Paper::tabloid})
    for (const double side : {90.0, 240.0, 610.0}) {
      ThermoformPrintOptions options;
      options.paper = paper;
      options.sheet_x_mm = side;
      options.sheet_y_mm = 1.3 * side;
      const PageLayout layout = page_layout(options);
      REQUIRE(layout.tiles.size() == static_cast<std::size_t>(layout.columns * layout.rows));
      const Vec2 half(options.sheet_x_mm / 2, options.sheet_y_mm / 2);
      for (std::size_t i = 0; i < layout.tiles.size(); ++i) {
        const Tile& tile = layout.tiles[i];
        const int column = static_cast<int>(i) % layout.columns, row = static_cast<int>(i) / layout.columns;
        const Vec2 origin = layout.origin_mm(tile), lower = origin + tile.lower_mm, upper = origin + tile.upper_mm;
        const double margin = paper == Paper::sheet ? -1e-9 : options.paper_margin_mm;
        CHECK(lower.minCoeff() >= margin);
        CHECK(upper.x() <= layout.width_mm - margin);
        CHECK(upper.y() <= layout.height_mm - margin);
        const double from_x = column == 0 ? -half.x() : layout.tiles[i - 1].upper_mm.x() - options.overlap_mm;
        const double from_y =
            row == 0 ? half.y()
                     : layout.tiles[i - static_cast<std::size_t>(layout.columns)].lower_mm.y() + options.overlap_mm;
        CHECK_THAT(tile.lower_mm.x(), WithinAbs(from_x, 1e-9));
        CHECK_THAT(tile.upper_mm.y(), WithinAbs(from_y, 1e-9));
        const bool last_column = column + 1 == layout.columns, last_row = row + 1 == layout.rows;
        CHECK((std::abs(tile.upper_mm.x() - half.x()) < 1e-9) == last_column);
        CHECK((std::abs(tile.lower_mm.y() + half.y()) < 1e-9) == last_row);
      }
    }
  ThermoformPrintOptions options;
  options.paper = Paper::a4;
  CHECK(page_layout(options).tiles.size() == 2u);
  CHECK(page_layout(options).tiles.back().name == (page_layout(options).rows == 2 ? "B1" : "A2"));
  // A wide sheet turns the paper.
  options.sheet_x_mm = 270;
  options.sheet_y_mm = 150;
  CHECK(page_layout(options).landscape);
  CHECK(page_layout(options).tiles.size() == 1u);
  options.sheet_x_mm = options.sheet_y_mm = 3000;
  options.paper_margin_mm = options.overlap_mm = 50;
  try {
    page_layout(options);
    FAIL("more than 400 pages");
  } catch (const Error& error) {
    CHECK(error.where() == "paper");
  }
}

TEST_CASE("Print.AsksForWhatItNeeds") {
  Context context;
  Model model;
  model.mesh = test::grid_mesh(20, 20, 2, 2);
  const auto where = [&](PrintColours colours, const std::optional<Image>& picture, double dots) {
    ThermoformPrintOptions options = test::plain_options(100, dots);
    options.colours = colours;
    try {
      print_grid(options);
      ModelColours(model, model.mesh, picture, options, context);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      return error.where();
    }
    return std::string("accepted");
  };
  CHECK(where(PrintColours::picture, std::nullopt, 100) == "colours");
  CHECK(where(PrintColours::vertex_colours, std::nullopt, 100) == "colours");
  CHECK(where(PrintColours::material_colours, std::nullopt, 100) == "colours");
  CHECK(where(PrintColours::automatic, white(2), 100) == "texture");
  CHECK(where(PrintColours::contours, std::nullopt, 100) == "accepted");
  ThermoformPrintOptions large;
  large.sheet_x_mm = large.sheet_y_mm = 1000;
  large.dots_per_inch = 1200;
  CHECK_THROWS_AS(print_grid(large), Error);
}

}  // namespace
}  // namespace formwright
