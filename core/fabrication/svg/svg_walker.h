// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Walks an SVG document and gathers the lines that are painted.
#include <map>
#include <string>
#include <vector>

#include "fabrication/svg/svg_notes.h"
#include "fabrication/svg/style/svg_paint.h"
#include "fabrication/svg/svg_reader.h"
#include "fabrication/svg/svg_state.h"

namespace formwright {

class SvgWalker {
 public:
  /// The document must outlive it.
  SvgWalker(const pugi::xml_node& root, double flatness_mm, DrawingLimits& limits);

  void walk(const PageFrame& page);

  std::vector<CutPath> paths;  // y down
  SvgNotes notes;

 private:
  using Subpath = CurveFlattener::Subpath;

  void index();
  bool is_svg(const pugi::xml_node& node) const;
  bool conditions_hold(const pugi::xml_node& node);
  pugi::xml_node referenced(const pugi::xml_node& node);

  void children(const pugi::xml_node& node, const SvgState& state);
  void element(const pugi::xml_node& node, const SvgState& outer);
  void container(const pugi::xml_node& node, std::string_view name, const SvgValues& values, SvgState& state);
  void use(const pugi::xml_node& node, const SvgValues& values, SvgState& state);
  /// A nested <svg> or a <symbol>; `user`, the <use> that shows it, may say its size.
  void viewport(const pugi::xml_node& node, const SvgValues& values, const SvgValues* user, SvgState& state);
  void shape(const pugi::xml_node& node, const SvgValues& values, const SvgState& state);
  void keep(std::vector<Subpath> subpaths, CutLayer layer, const std::string& id);

  /// What the element itself sets: inherited properties, transform, clip.
  std::unique_ptr<SvgState> within(const pugi::xml_node& node, const SvgValues& values, const SvgState& outer);
  Eigen::Affine2d transform_of(const pugi::xml_node& node, const SvgValues& values, const SvgState& state);
  void enter_clip(const pugi::xml_node& node, const SvgValues& values, SvgState& state);
  std::vector<ClipRegion::Shape> clip_shapes(const pugi::xml_node& clip, const SvgState& user);
  void clip_to(std::vector<ClipRegion::Shape> shapes, SvgState& state);
  void clip_to_viewport(SvgState& state);
  /// The box of an element's lines in its own user space; empty when it has none.
  Eigen::AlignedBox2d box_of(const pugi::xml_node& node, const SvgValues& values, const SvgState& state);

  SvgPaint stroke_of(const SvgState& state);
  CutLayer layer_of(const SvgPaint& paint, const SvgState& state);
  std::vector<Subpath> dashed(const pugi::xml_node& node, const SvgValues& values, const SvgState& state,
                              std::vector<Subpath> subpaths);

  const pugi::xml_node root_;
  double flatness_mm_;
  DrawingLimits& limits_;
  StyleSheet style_;
  SvgIds ids_;
  std::map<std::string, int> names_;
  /// A clip that many elements share is made once; as it was last used.
  struct KeptClip {
    Eigen::Matrix3d to_mm;
    ViewportSize viewport;
    std::shared_ptr<const ClipRegion> region;
  };
  std::map<const void*, KeptClip> clips_;
  Eigen::AlignedBox2d* measured_ = nullptr;                // instead of paths: their box
  std::vector<ClipRegion::Shape>* clip_shapes_ = nullptr;  // instead of paths: what they enclose
};

}  // namespace formwright
