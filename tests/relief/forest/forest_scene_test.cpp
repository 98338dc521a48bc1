// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that cannot be made are refused in one sentence that names what is wrong.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "relief/forest/forest_fixture.h"

namespace formwright {
namespace {
using Catch::Matchers::ContainsSubstring;
using test::square_pillar;
using test::viewpoint;

ForestScene good() {
  ForestScene scene;
  scene.viewpoints = {viewpoint({0, -300, 50}, {0, 0, 50}, 40)};
  scene.pillars = {square_pillar(-8, 0, 12), square_pillar(8, 0, 12), square_pillar(24, 10, 12)};
  return scene;
}

void is_refused(const ForestScene& scene, const std::string& words) {
  try {
    check_viewpoints(scene);
    check_forest(scene, 3);
    FAIL("not refused: " << words);
  } catch (const Error& error) {
    const std::string sentence = error.what();
    INFO(sentence);
    CHECK(error.code() == ErrorCode::invalid_input);
    CHECK(error.where() == "scene");
    CHECK_THAT(sentence, ContainsSubstring(words));
    CHECK(sentence.back() == '.');
    CHECK(sentence.find('\n') == std::string::npos);
  }
}

TEST_CASE("ForestScene.GoodOnesPass") { CHECK_NOTHROW(check_forest(good(), 3)); }

TEST_CASE("ForestScene.BadOnesAreRefusedBySentence") {
  ForestScene scene;
  is_refused(scene, "no viewpoint");
  scene = good();
  scene.pillars.clear();
  is_refused(scene, "no pillars");
  scene = good();
  scene.viewpoints[0].eye_mm = {8, 0, 50};
  scene.viewpoints[0].look_at_mm = {8, 100, 50};
  is_refused(scene, "Viewpoint 1 stands inside pillar 2");
  scene = good();
  scene.viewpoints[0].look_at_mm = {0, -600, 50};
  is_refused(scene, "All pillars stand behind viewpoint 1");
  scene = good();
  scene.viewpoints[0].look_at_mm = {0, -300, 0};
  is_refused(scene, "straight up or down");
  scene = good();
  scene.viewpoints[0].look_at_mm = scene.viewpoints[0].eye_mm;
  is_refused(scene, "straight up or down, or nowhere");
  scene = good();
  scene.viewpoints[0].width_mm = 0;
  is_refused(scene, "Viewpoint 1 has a model of 0 mm");
  scene = good();
  scene.viewpoints[0].eye_mm.x() = NAN;
  is_refused(scene, "Viewpoint 1 has a place");
  scene = good();
  scene.pillars[1] = square_pillar(0, 0, 12);
  is_refused(scene, "Pillars 1 and 2 overlap");
  scene = good();
  scene.pillars[2] = square_pillar(8, 0, 4);
  is_refused(scene, "Pillars 2 and 3 overlap");
  scene = good();
  scene.pillars[1] = square_pillar(5, 0, 12);
  is_refused(scene, "Pillars 1 and 2 stand 1 mm apart");
  scene = good();
  scene.pillars[0].outline_mm.resize(2);
  is_refused(scene, "Pillar 1 has an outline of 2 corners");
  scene = good();
  scene.pillars[0].outline_mm = {{-10, 0}, {0, 10}, {0, 0}, {-10, 10}};
  is_refused(scene, "Pillar 1 has an outline that crosses itself");
  scene = good();
  scene.pillars[0].outline_mm = {{-10, 0}, {0, 0}, {-5, 0}};
  is_refused(scene, "Pillar 1 ");
  scene = good();
  scene.pillars[0].outline_mm[1] = scene.pillars[0].outline_mm[0];
  is_refused(scene, "Pillar 1 has two corners at the same place");
  scene = good();
  scene.pillars[0].height_mm = NAN;
  is_refused(scene, "Pillar 1 has a place or height");
}

TEST_CASE("ForestScene.OutlinesAreTurnedCounterClockwise") {
  ForestScene scene = good();
  std::ranges::reverse(scene.pillars[1].outline_mm);
  orient_outlines(scene);
  for (const Pillar& pillar : scene.pillars) CHECK(outline_area_mm2(pillar.outline_mm) > 0);
}

TEST_CASE("ForestScene.APinIsPlacedWhereThereIsRoom") {
  // The centroid of this L lies outside it.
  const Outline l{{0, 0}, {40, 0}, {40, 6}, {6, 6}, {6, 40}, {0, 40}};
  const Vec2 pin = place_of_pin(l);
  CHECK(is_inside(l, pin));
  CHECK(distance_to_outline(l, pin) > 2.5);
  CHECK_THROWS_WITH(checked_pin_place({l, 100}, 4, {8, 5}), ContainsSubstring("Pillar 4 is too narrow"));
  CHECK_NOTHROW(checked_pin_place({l, 100}, 4, {4, 5}));
}

}  // namespace
}  // namespace formwright
