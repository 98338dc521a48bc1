// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "base/error.h"
#include "base/json.h"
#include "zippable/zipping/ribbon_pattern.h"

namespace formwright {
namespace {

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::invalid_input, "design", sentence); }

/// `count` finite numbers of a place in mm.
template <class Vector>
bool read_numbers(const Json& json, int count, Vector& out) {
  if (!json.is_array() || static_cast<int>(json.size()) != count) return false;
  for (int k = 0; k < count; ++k) {
    if (!json[static_cast<std::size_t>(k)].is_number()) return false;
    out[k] = json[static_cast<std::size_t>(k)].get<double>();
    if (!(std::abs(out[k]) < 1e9)) return false;
  }
  return true;
}

}  // namespace

RibbonDesign read_ribbon_design(ByteView design_json) {
  const Json json = Json::parse(as_text(design_json), nullptr, false);
  if (!json.is_object() || json.value("format", Json()) != "formwright zippable design")
    refuse("This is no design.json of a zippable: make one with zippable-design.");
  const Json ribbon = json.value("ribbon", Json());
  const bool whole = ribbon.is_object() && ribbon.contains("boundary") && ribbon.contains("triangles") && ribbon["boundary"].is_array() &&
                     ribbon["triangles"].is_array() && json.contains("pieces") && json["pieces"].is_array();
  if (!whole) refuse("design.json lacks the ribbon or the zipper's pieces: make it with this version of zippable-design.");
  if (ribbon["boundary"].size() > 1'000'000 || ribbon["triangles"].size() > 1'000'000)
    refuse("design.json has more than a million places or triangles: design a wider ribbon.");
  std::vector<int> piece_of(ribbon["boundary"].size(), -1);  // per sample; there are fewer samples than places
  int piece = 0;
  for (const Json& samples : json["pieces"]) {
    if (!samples.is_array()) refuse("design.json: pieces must be lists of samples.");
    for (const Json& sample : samples) {
      if (!sample.is_number_integer() || sample.get<double>() < 0 || sample.get<double>() >= static_cast<double>(piece_of.size()))
        refuse("design.json: piece " + std::to_string(piece) + " names a sample that is not there: make the design again.");
      piece_of[sample.get<std::size_t>()] = piece;
    }
    ++piece;
  }
  RibbonDesign design;
  for (const Json& item : ribbon["boundary"]) {
    RibbonEdgePlace place;
    const std::string which = "design.json: place " + std::to_string(design.places.size()) + " of the ribbon's boundary ";
    if (!item.is_object() || !read_numbers(item.value("position_mm", Json()), 3, place.predicted_mm) ||
        !read_numbers(item.value("flat_mm", Json()), 2, place.flat_mm))
      refuse(which + "needs position_mm [x, y, z] and flat_mm [x, y].");
    const Json sample = item.value("zipper_sample", Json()), side = item.value("side", Json());
    if (!sample.is_number_integer() || !(side == "left" || side == "right" || side == "opening"))
      refuse(which + "needs zipper_sample and side: left, right or opening.");
    if (side != "opening") {
      if (sample.get<double>() < 0 || sample.get<double>() >= static_cast<double>(piece_of.size()) || piece_of[sample.get<std::size_t>()] < 0)
        refuse(which + "has a zipper_sample that no piece names: make the design again.");
      place.sample = sample.get<int>();
      place.piece = piece_of[sample.get<std::size_t>()];
      place.left = side == "left";
    }
    design.places.push_back(place);
  }
  design.triangles.resize(static_cast<Eigen::Index>(ribbon["triangles"].size()), 3);
  for (std::size_t f = 0; f < ribbon["triangles"].size(); ++f) {
    Vec3 corners;
    if (!read_numbers(ribbon["triangles"][f], 3, corners) || corners != corners.array().round().matrix())
      refuse("design.json: triangle " + std::to_string(f) + " must be three numbers of places.");
    design.triangles.row(static_cast<Eigen::Index>(f)) = corners.transpose().cast<int>();
  }
  return design;
}

}  // namespace formwright
