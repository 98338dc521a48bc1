// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/plan/rig.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "base/error.h"
#include "fabrication/sheet/contours.h"
#include "fabrication/sheet/word_paths.h"

namespace formwright {
namespace {

constexpr const char* rig_title = "Zippable rig";
constexpr double mark_mm = 2, clear_mm = 0.3;

double rim_width_mm(const PlanOptions& options) { return 3 * options.screw_mm; }

/// The cloth's edge along one run of tape, cloth to its left.
std::vector<Vec2> edge_of(const FlatDesign& design, const OffsetRibbon& ribbon, const TapeRun& run) {
  std::vector<Vec2> points;
  const auto& vertex = run.left ? design.left_vertex : design.right_vertex;
  for (const int sample : design.pieces[std::size_t(run.zipper_piece)])
    if (const double along = design.arclength_mm[sample]; along >= run.from_mm && along <= run.to_mm)
      points.push_back(ribbon.flat_mm[vertex[sample]]);
  if (!run.left) std::reverse(points.begin(), points.end());
  return points;
}

class PlateMaker {
 public:
  PlateMaker(const PlanPiece& piece, int number, const PlanOptions& options, const RigSizes& sizes, Rig& rig)
      : piece_(piece), number_(number), options_(options), sizes_(sizes), rig_(rig) {}

  void make(const FlatDesign& design, const OffsetRibbon& ribbon, const Markers& markers,
            const std::vector<TapeRun>& runs) {
    std::vector<std::vector<Vec2>> edges;
    std::vector<char> left;
    for (const TapeRun& run : runs)
      if (run.piece == number_)
        if (std::vector<Vec2> edge = edge_of(design, ribbon, run); edge.size() > 1) {
          edges.push_back(std::move(edge));
          left.push_back(run.left);
        }
    tracks_ = rig_tracks(piece_.outline_mm, edges, left, sizes_);
    for (const RigTrack& track : tracks_.tracks) {
      cut_out_.push_back({track.middle_mm, sizes_.track_mm});
      for (const Vec2& opening : track.openings_mm) cut_out_.push_back({{opening}, sizes_.opening_mm});
    }
    for (const TapeRun& run : runs)
      if (run.piece == number_)
        for (int m = run.first_marker; m <= run.last_marker; ++m) mark(markers.markers[m], run.left);
    outline_cloth();
    lay_on_plates();
    count();
  }

 private:
  /// Is there room for something as large as this around a place, off all tracks and openings?
  bool clear(const Vec2& p, double radius_mm) const {
    return std::all_of(cut_out_.begin(), cut_out_.end(), [&](const ThickLine& line) {
      return nearest_on_line(line.points_mm, false, p).distance_mm > line.width_mm / 2 + radius_mm;
    });
  }

  void mark(const Marker& marker, bool left) {
    const SideMark& side = left ? marker.left : marker.right;
    const double reach = sizes_.offset_mm + sizes_.track_mm / 2 + 2 * clear_mm;
    Vec2 from = side.flat_mm - reach * side.inward, to = from - mark_mm * side.inward;
    const bool beside = clear((from + to) / 2, mark_mm / 2) && !contains_cloth(from) && !contains_cloth(to);
    if (!beside) {
      from = side.flat_mm, to = from + mark_mm * side.inward;
      ++rig_.hidden_markers;
    }
    cover_.push_back(
        {CutLayer::mark, {from, to}, false, "marker-" + std::to_string(marker.number) + (left ? "-left" : "-right")});
    const std::string words = std::to_string(marker.number);
    const double height = options_.text_height_mm, width = words_width_mm(words, height),
                 radius = std::hypot(width, height) / 2;
    const Vec2 centre = to + (beside ? -1 : 1) * (height / 2 + 0.6) * side.inward;
    const bool meets = std::any_of(texts_.begin(), texts_.end(), [&](const auto& other) {
      return (other.first - centre).norm() < radius + other.second;
    });
    if (!clear(centre, radius) || meets) return;
    texts_.emplace_back(centre, radius);
    for (CutPath& path : word_paths(words, centre, side.along, height, CutLayer::engrave))
      cover_.push_back(std::move(path));
  }

  bool contains_cloth(const Vec2& p) const { return contains(piece_.outline_mm, p); }

  /// Where the cloth lies, drawn where it does not run over a slot.
  void outline_cloth() {
    std::vector<Vec2> stretch;
    int drawn = 0;
    const auto finish = [&] {
      if (stretch.size() > 1)
        cover_.push_back({CutLayer::mark, stretch, false, "cloth-" + piece_.name + "-" + std::to_string(++drawn)});
      stretch.clear();
    };
    std::vector<ThickLine> slots;
    for (const RigTrack& track : tracks_.tracks) {
      slots.push_back({track.slot_mm, sizes_.slot_mm});
      for (const Vec2& opening : track.openings_mm) slots.push_back({{opening}, sizes_.opening_mm});
    }
    const Polygon& cloth = piece_.outline_mm;
    for (std::size_t i = 0; i < cloth.size(); ++i) {
      const Vec2 segment = cloth[(i + 1) % cloth.size()] - cloth[i];
      const int parts = std::max(1, static_cast<int>(std::ceil(segment.norm() / 1)));
      for (int k = i == 0 ? 0 : 1; k <= parts; ++k) {
        const Vec2 p = cloth[i] + segment * k / parts;
        const bool off = std::all_of(slots.begin(), slots.end(), [&](const ThickLine& slot) {
          return nearest_on_line(slot.points_mm, false, p).distance_mm > slot.width_mm / 2 + 0.1;
        });
        if (off) stretch.push_back(p);
        else finish();
      }
    }
    finish();
  }

  void lay_on_plates() {
    std::vector<Vec2> all = piece_.outline_mm;
    const auto reach = [&](const Vec2& p, double radius) {
      for (const Vec2& corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
        all.push_back(p + radius * corner);
    };
    for (const ThickLine& line : cut_out_)
      for (const Vec2& p : line.points_mm) reach(p, line.width_mm / 2);
    for (const CutPath& path : cover_)
      for (const Vec2& p : path.points_mm) reach(p, 0);
    const Polygon hull = convex_hull(all);
    const double around = rim_width_mm(options_) + options_.kerf_mm;
    const double free_x = options_.bed_x_mm - 2 * (options_.margin_mm + around) - 3 * cell_mm(),
                 free_y = options_.bed_y_mm - 2 * (options_.margin_mm + around) - 3 * cell_mm();
    const std::vector<double> turns = fitting_turns(hull, free_x, free_y, false);
    if (turns.empty())
      throw Error(ErrorCode::invalid_input, "bed_x_mm",
                  "The rig of " + piece_.name +
                      " does not fit the bed: give a larger bed, smaller openings or a smaller model.");
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(turns.front()).toRotationMatrix();
    Vec2 lower = Vec2::Constant(1e300), upper = -lower;
    for (const Vec2& p : hull) lower = lower.cwiseMin(turn * p), upper = upper.cwiseMax(turn * p);
    size_ = upper - lower + Vec2::Constant(2 * rim_width_mm(options_));
    const auto place = [&](CutPath path) {
      for (Vec2& p : path.points_mm) p = turn * p - lower + Vec2::Constant(rim_width_mm(options_));
      return path;
    };
    for (const RigLayer layer : {RigLayer::base, RigLayer::tracks, RigLayer::cover}) {
      RigPlate plate{layer, number_, size_, {}};
      frame(plate);
      if (layer != RigLayer::base) {
        const bool cover = layer == RigLayer::cover;
        for (std::size_t i = 0; i < tracks_.tracks.size(); ++i) {
          const RigTrack& track = tracks_.tracks[i];
          const std::string name = piece_.name + "-" + std::to_string(i + 1);
          std::vector<ThickLine> lines{
              {cover ? track.slot_mm : track.middle_mm, (cover ? sizes_.slot_mm : sizes_.track_mm) - options_.kerf_mm}};
          for (const Vec2& opening : track.openings_mm)
            lines.push_back({{opening}, sizes_.opening_mm - options_.kerf_mm});
          const std::vector<Polygon> edges = outlines_of(lines);
          for (std::size_t k = 0; k < edges.size(); ++k)
            plate.paths.push_back(
                place({CutLayer::cut, edges[k], true,
                       (cover ? "slot-" : "track-") + name + (k > 0 ? "-" + std::to_string(k + 1) : "")}));
          if (!cover) plate.paths.push_back(place({CutLayer::note, track.middle_mm, false, "middle-" + name}));
        }
        if (cover)
          for (const CutPath& path : cover_) plate.paths.push_back(place(path));
      }
      rig_.plates.push_back(std::move(plate));
    }
  }

  double cell_mm() const {
    return nesting_cell_mm({options_.bed_x_mm, options_.bed_y_mm, options_.margin_mm, options_.spacing_mm});
  }

  /// Outline, screw holes along the rim, and the plate's name.
  void frame(RigPlate& plate) {
    constexpr const char* names[rig_layer_count] = {"base", "tracks", "cover"};
    const std::string layer = names[static_cast<int>(plate.layer)];
    const double k = options_.kerf_mm / 2, rim = rim_width_mm(options_);
    plate.paths.push_back({CutLayer::cut,
                           {{-k, -k}, {size_.x() + k, -k}, {size_.x() + k, size_.y() + k}, {-k, size_.y() + k}},
                           true,
                           layer + "-" + piece_.name});
    constexpr double longest_mm = 120;
    const int along_x = std::max(1, static_cast<int>(std::ceil((size_.x() - rim) / longest_mm))),
              along_y = std::max(1, static_cast<int>(std::ceil((size_.y() - rim) / longest_mm)));
    int made = 0;
    const auto screw = [&](double x, double y) {
      plate.paths.push_back({CutLayer::cut, outlines_of({{{Vec2(x, y)}, options_.screw_mm - options_.kerf_mm}}).front(),
                             true, "screw-" + layer + "-" + piece_.name + "-" + std::to_string(++made)});
    };
    for (int i = 0; i <= along_x; ++i)
      for (const double y : {rim / 2, size_.y() - rim / 2}) screw(rim / 2 + (size_.x() - rim) * i / along_x, y);
    for (int j = 1; j < along_y; ++j)
      for (const double x : {rim / 2, size_.x() - rim / 2}) screw(x, rim / 2 + (size_.y() - rim) * j / along_y);
    screws_ = made;
    std::string words = piece_.name + " " + layer;
    for (char& c : words) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    // In the rim, between the first two screws, or as wide as there is room.
    const double room = (size_.x() - rim) / along_x - 2 * options_.screw_mm,
                 height = std::min(0.5 * rim, 0.5 * rim * room / words_width_mm(words, 0.5 * rim));
    for (CutPath& path : word_paths(words, Vec2(rim / 2 + (size_.x() - rim) / along_x / 2, rim / 2), Vec2::UnitX(),
                                    height, CutLayer::engrave))
      plate.paths.push_back(std::move(path));
  }

  void count() {
    rig_.screws += screws_;
    rig_.left_out_mm += tracks_.left_out_mm;
    for (const RigTrack& track : tracks_.tracks) {
      ++rig_.tracks;
      rig_.blind_tracks += track.openings_mm.empty();
      rig_.openings += static_cast<int>(track.openings_mm.size());
      rig_.track_mm += track.along_cloth_mm;
    }
  }

  const PlanPiece& piece_;
  int number_;
  const PlanOptions& options_;
  const RigSizes& sizes_;
  Rig& rig_;
  RigTracks tracks_;
  std::vector<ThickLine> cut_out_;              // tracks and openings
  std::vector<CutPath> cover_;                  // what is drawn on the cover, in the piece's plane
  std::vector<std::pair<Vec2, double>> texts_;  // centre and radius
  Vec2 size_{0, 0};
  int screws_ = 0;
};

void lay_on_sheets(Rig& rig, const PlanOptions& options, Context& context) {
  std::vector<Polygon> outlines;
  for (const RigPlate& plate : rig.plates) outlines.push_back(plate.paths.front().points_mm);
  const Nesting nesting =
      nest(outlines, {options.bed_x_mm, options.bed_y_mm, options.margin_mm, options.spacing_mm, false}, context);
  rig.sheets.assign(std::size_t(nesting.sheet_count),
                    CutSheet{rig_title, options.bed_x_mm, options.bed_y_mm, {}, options.kerf_mm});
  for (std::size_t i = 0; i < rig.plates.size(); ++i) {
    auto& paths = rig.sheets[nesting.places[i].sheet].paths;
    // What is inside is cut before the outline.
    const std::vector<CutPath>& mine = rig.plates[i].paths;
    for (std::size_t k = 0; k < mine.size(); ++k) {
      CutPath path = mine[(k + 1) % mine.size()];
      for (Vec2& p : path.points_mm) p = nesting.places[i](p);
      paths.push_back(std::move(path));
    }
  }
}

}  // namespace

RigSizes rig_sizes(const PlanOptions& options, const ZipperModel& zipper) {
  if (!(zipper.tape_width_mm > 0))
    throw Error(ErrorCode::invalid_input, "rig",
                "The fastening rig needs a zipper: choose a zipper size or a tape width, or switch the rig off.");
  RigSizes sizes;
  sizes.track_mm = options.track_width_mm, sizes.slot_mm = options.slot_width_mm;
  sizes.opening_mm = options.rig_opening_mm, sizes.offset_mm = zipper.offset_mm();
  if (sizes.track_mm / 2 > sizes.offset_mm - 0.2)
    throw Error(ErrorCode::invalid_input, "track_width_mm",
                "The tracks would run under the cloth's edge: choose narrower tracks or a larger gap.");
  if (sizes.slot_mm >= sizes.track_mm)
    throw Error(ErrorCode::invalid_input, "slot_width_mm",
                "The slots must be narrower than the tracks, so that the cover holds the teeth down.");
  if (sizes.slot_mm <= options.kerf_mm || options.screw_mm <= options.kerf_mm)
    throw Error(ErrorCode::invalid_input, "kerf_mm",
                "The cut is wider than the rig's slots or screw holes: choose wider ones.");
  if (sizes.opening_mm < sizes.track_mm)
    throw Error(ErrorCode::invalid_input, "rig_opening_mm", "The openings must be at least as wide as the tracks.");
  return sizes;
}

double rig_rim_mm(const PlanOptions& options, const RigSizes& sizes) {
  return rig_reach_mm(sizes) + rim_width_mm(options) + options.text_height_mm;
}

Rig make_rig(const FlatDesign& design, const OffsetRibbon& ribbon, const Markers& markers, const PlanPieces& pieces,
             const std::vector<TapeRun>& runs, const PlanOptions& options, const RigSizes& sizes, Context& context) {
  Rig rig;
  for (std::size_t i = 0; i < pieces.pieces.size(); ++i) {
    context.progress(static_cast<double>(i) / static_cast<double>(pieces.pieces.size()), "Laying out the rig");
    PlateMaker(pieces.pieces[i], static_cast<int>(i), options, sizes, rig).make(design, ribbon, markers, runs);
  }
  lay_on_sheets(rig, options, context);
  return rig;
}

}  // namespace formwright
