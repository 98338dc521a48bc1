// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>
#include <numbers>
#include <set>

#include "base/error.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

const Polygon rig_outline{{0, 0}, {200, 0}, {200, 14}, {0, 14}};

TEST_CASE("ThickLines.AreasAreThoseOfStadiumsAndDiscs") {
  const auto one = outlines_of({{{{0, 0}, {30, 0}, {50, 0}}, 4}});
  REQUIRE(one.size() == 1u);
  CHECK_THAT(signed_area_mm2(one[0]), WithinAbs(50 * 4 + std::numbers::pi * 4, 0.05));
  const auto disc = outlines_of({{{{3, 4}}, 10}});
  REQUIRE(disc.size() == 1u);
  CHECK_THAT(signed_area_mm2(disc[0]), WithinAbs(std::numbers::pi * 25, 0.1));
  // A ring has an inner edge, which runs the other way.
  const auto ring = outlines_of({{{{0, 0}, {20, 0}, {20, 20}, {0, 20}, {0, 0}}, 2}});
  REQUIRE(ring.size() == 2u);
  CHECK_THAT(signed_area_mm2(ring[0]) + signed_area_mm2(ring[1]), WithinAbs(80 * 2 - 4 + std::numbers::pi, 0.05));
}

TEST_CASE("RigTracks.OfAStripRunBesideItsEdges") {
  const RigSizes sizes;
  const RigTracks rig = rig_tracks(rig_outline, {{{0, 0}, {200, 0}}, {{200, 14}, {0, 14}}}, {1, 0}, sizes);
  REQUIRE(rig.tracks.size() == 2u);
  CHECK_THAT(rig.left_out_mm, WithinAbs(0, 1e-9));
  for (const RigTrack& track : rig.tracks) {
    CHECK_THAT(track.along_cloth_mm, WithinAbs(200, 1e-9));
    REQUIRE(track.openings_mm.size() == 2u);
    for (const Vec2& p : track.middle_mm)
      if (p.x() > -1e-9 && p.x() < 200 + 1e-9) {
        CHECK_THAT(p.y(), WithinAbs(track.left ? -sizes.offset_mm : 14 + sizes.offset_mm, 1e-9));
      }
    for (const Vec2& p : track.slot_mm)
      if (p.x() > -1e-9 && p.x() < 200 + 1e-9) {
        CHECK_THAT(std::abs(p.y() - 7), WithinAbs(7 + sizes.offset_mm - sizes.track_mm / 2 + sizes.slot_mm / 2, 1e-9));
      }
    for (const Vec2& opening : track.openings_mm)
      CHECK(nearest_on_line(rig_outline, true, opening).distance_mm > sizes.opening_mm / 2);
  }
}

TEST_CASE("RigTracks.KeepOffTheClothInItsHollows") {
  // An edge with a bay narrower than the offset reaches: the track passes by its mouth.
  const Polygon cloth{{0, 0}, {40, 0}, {41, 10}, {42, 0}, {100, 0}, {100, 20}, {0, 20}};
  const RigSizes sizes;
  const RigTracks rig = rig_tracks(cloth, {{{0, 0}, {40, 0}, {41, 10}, {42, 0}, {100, 0}}}, {1}, sizes);
  REQUIRE(rig.tracks.size() == 1u);
  for (const Vec2& p : rig.tracks[0].middle_mm)
    CHECK(nearest_on_line(cloth, true, p).distance_mm > sizes.offset_mm - 0.02);
}

TEST_CASE("RigTracks.OfTwoEdgesThatFaceEachOtherOneGivesWay") {
  const RigSizes sizes;
  const double near = 2 * sizes.offset_mm + 1;
  const Polygon cloth{{0, 0},          {100, 0},         {100, 10},        {10, 10},
                      {10, 10 + near}, {100, 10 + near}, {100, 20 + near}, {0, 20 + near}};
  const RigTracks rig = rig_tracks(cloth, {{{100, 10}, {10, 10}}, {{10, 10 + near}, {100, 10 + near}}}, {1, 0}, sizes);
  REQUIRE(rig.tracks.size() == 1u);
  CHECK(rig.left_out_mm > 80);
}

TEST_CASE("Rig.TracksKeepTheirWidthAndApart") {
  for (const char* sample : {"star", "t_shape"}) {
    const FlatDesign design = test::designed(sample, 30, 250);
    Context context;
    PlanOptions options;
    options.rig = true, options.kerf_mm = 0;
    options.method = ZipperOffset::gluing;
    options.bed_x_mm = 600, options.bed_y_mm = 400;
    const ZippablePlan plan = plan_zippable(design, options, context);
    REQUIRE(plan.rig.has_value());
    CHECK(plan.marker_spacing_mm == 50);
    CHECK(plan.rig->plates.size() == 3 * plan.pieces.pieces.size());
    const RigSizes sizes = rig_sizes(options, plan.zipper);
    std::set<std::string> markers;
    for (const RigPlate& plate : plan.rig->plates) {
      std::vector<std::pair<std::string, Polygon>> cuts;
      for (const CutPath& path : plate.paths) {
        if (path.name.starts_with("marker-")) {
          CHECK(markers.insert(path.name).second);
        }
        for (const Vec2& p : path.points_mm) {
          INFO(path.name);
          CHECK(p.minCoeff() >= -1e-6);
          CHECK((p - plate.size_mm).maxCoeff() <= 1e-6);
        }
        if (path.layer == CutLayer::cut && path.name.find("-P") != std::string::npos &&
            !path.name.starts_with("base") && !path.name.starts_with("tracks") && !path.name.starts_with("cover"))
          cuts.emplace_back(path.name, path.points_mm);
      }
      for (std::size_t i = 0; i < cuts.size(); ++i) {
        {
          INFO(cuts[i].first << " encloses board that would fall out");
          CHECK(signed_area_mm2(cuts[i].second) > 0);
        }
        for (std::size_t k = 0; k < i; ++k)
          for (const Vec2& p : cuts[i].second) {
            INFO(sample << ' ' << cuts[i].first << ' ' << cuts[k].first);
            CHECK(nearest_on_line(cuts[k].second, true, p).distance_mm > sizes.wall_mm - 0.05);
          }
      }
    }
    for (const Marker& marker : plan.markers.markers)
      for (const char* side : {"-left", "-right"}) {
        INFO(sample);
        CHECK(markers.contains("marker-" + std::to_string(marker.number) + side));
      }
    INFO(sample);
    CHECK(plan.rig->track_mm > 0.8 * (plan.ribbon.left_mm + plan.ribbon.right_mm));
    CHECK(plan.rig->blind_tracks < 0.2 * plan.rig->tracks + 1);
  }
}

TEST_CASE("Rig.SaysWhatDoesNotGoTogether") {
  const FlatDesign design = test::designed("star", 30, 250);
  Context context;
  const auto where = [&](auto change) -> std::string {
    PlanOptions options;
    options.rig = true;
    change(options);
    try {
      plan_zippable(design, options, context);
    } catch (const Error& error) {
      return error.where();
    }
    return "made";
  };
  CHECK(where([](PlanOptions& o) { o.coil = ZipperCoil::none; }) == "rig");
  CHECK(where([](PlanOptions& o) { o.track_width_mm = 6; }) == "track_width_mm");
  CHECK(where([](PlanOptions& o) { o.slot_width_mm = 4; }) == "slot_width_mm");
  CHECK(where([](PlanOptions& o) { o.rig_opening_mm = 3; }) == "rig_opening_mm");
}

TEST_CASE("Plan.FabricsLieOnSheetsOfTheirOwn") {
  Context context;
  ZippableOptions design_options;
  design_options.width_mm = 20, design_options.size_mm = 200;
  design_options.fabrics = RibbonFabrics::two;
  design_options.measure_distances = false;
  const ParameterisedModel model =
      parameterise_model(make_sample("star", 3000, context).mesh, {}, design_options, context);
  const ZippableDesign designed = design_zippable(model, design_options, context);
  const FlatDesign design = read_flat_design(write_design_json(model, designed));
  CHECK(design.fabrics == 2);
  CHECK(design.fabric_of_face == designed.fabrics->of_face);
  PlanOptions options;
  options.coil = ZipperCoil::none;
  const ZippablePlan plan = plan_zippable(design, options, context);
  double area[2]{};
  for (std::size_t i = 0; i < plan.pieces.pieces.size(); ++i) {
    area[plan.fabric_of_piece[i]] += plan.pieces.pieces[i].ribbon_area_mm2;
    CHECK(plan.fabric_of_sheet[plan.nesting.places[i].sheet] == plan.fabric_of_piece[i]);
  }
  for (Eigen::Index f = 0; f < design.F.rows(); ++f)
    CHECK(design.fabric_of_face[f] == plan.fabric_of_piece[plan.splitting.piece_of_face[f]]);
  for (int fabric = 0; fabric < 2; ++fabric)
    CHECK_THAT(area[fabric], WithinAbs(designed.fabrics->area_mm2[fabric], 1e-6 * area[fabric]));
  CHECK(plan.fabric_of_sheet.size() == plan.sheets.size());
  CHECK(plan.sheets.back().title == "Zippable plan, Colour 2");
}

}  // namespace
}  // namespace formwright
