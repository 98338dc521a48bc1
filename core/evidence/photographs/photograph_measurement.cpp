// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/photograph_measurement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/error.h"
#include "base/format.h"
#include "base/index.h"
#include "base/statistics.h"
#include "evidence/photographs/photograph_solution.h"

namespace formwright {
namespace {

constexpr double far_strip_mm = 5;              // a strip farther off than this deserves a word
constexpr double other_scale_tolerance = 0.25;  // of spacing against size of marks, with which a sheet is another

double printed_scale(const MarkSheet& sheet, const PhotographOptions& options) {
  if (options.board_check_mm <= 0) return 1;
  const double scale = options.board_check_mm / sheet.check_mm;
  if (!(scale > 0.9 && scale < 1.1))
    throw Error(ErrorCode::invalid_input, "board_check_mm",
                "The check length of this board is " + with_max_decimals(sheet.check_mm, 2) +
                    " mm when printed at 100 %, and " + with_max_decimals(options.board_check_mm, 2) +
                    " mm is too far from that: measure it again, in millimetres, or print at 100 %.");
  return scale;
}

/// A photograph's marks do not say which sheet they are on, but size and spacing grow alike where a sheet stretches.
void check_spacing(const MarkSheet& sheet, const PhotographSolution& solution) {
  std::vector<double> ratios;
  const auto place = [&](std::size_t mark, int corner) -> const Vec3* {
    const int p = solution.point_of_corner[4 * mark + index(corner)];
    return p < 0 ? nullptr : &solution.bundle.points[index(p)];
  };
  for (std::size_t i = 0; i + 1 < sheet.marks.size(); ++i) {
    const PlacedMark &a = sheet.marks[i], &b = sheet.marks[i + 1];
    const Vec3 *a0 = place(i, 0), *a1 = place(i, 1), *b0 = place(i + 1, 0);
    if (!a0 || !a1 || !b0 || std::abs(a.centre_mm.y() - b.centre_mm.y()) > 1e-6) continue;
    const double side = (*a1 - *a0).norm() / a.side_mm,
                 spacing = (*b0 - *a0).norm() / std::abs(b.centre_mm.x() - a.centre_mm.x());
    if (side > 0) ratios.push_back(spacing / side);
  }
  if (ratios.size() < 5) return;
  const double ratio = median(ratios);
  if (std::abs(ratio - 1) > other_scale_tolerance)
    throw Error(
        ErrorCode::invalid_input, "pattern",
        "The marks lie " + with_max_decimals(ratio, 2) +
            " times as far apart as pattern.json says: give the one that was written with the print on this sheet.");
}

/// The size of a pixel at a point, in mm across the line of sight; the mean over the cameras.
double pixel_at(const Bundle& bundle, const Vec3& place) {
  double sum = 0;
  for (const BundleCamera& camera : bundle.cameras)
    sum += (place - camera.pose.centre()).norm() / bundle.lenses[index(camera.lens)].focal_px;
  return sum / static_cast<double>(bundle.cameras.size());
}

void add_points_of(PhotographMeasurement& m, const PhotographSolution& solution, const MarkSheet& sheet,
                   const PhotographOptions& options) {
  const double min_angle = options.min_angle_deg * std::numbers::pi / 180;
  const double scale_sigma = options.board_check_sigma_mm / sheet.check_mm;
  const Vec3 middle(0, 0, options.board_height_mm);
  for (std::size_t corner = 0; corner < solution.point_of_corner.size(); ++corner) {
    const int p = solution.point_of_corner[corner];
    if (p < 0) continue;
    MarkSight& sight = m.sights[corner / 4];
    if (solution.angle_rad[index(p)] < min_angle) {
      if (sight > MarkSight::small_angle) sight = MarkSight::small_angle;
      continue;
    }
    const Vec3& place = solution.bundle.points[index(p)];
    // A board of another size makes everything larger about its middle.
    const double systematic = scale_sigma * (place - middle).norm();
    const double shared = solution.shared_px[index(p)] * pixel_at(solution.bundle, place);
    const double variance =
        (solution.fit.covariance_mm2[index(p)].trace() + systematic * systematic) / 3 + shared * shared;
    const double sigma = std::sqrt(std::max(variance, 1e-12));
    if (!(sigma <= options.max_sigma_mm) || !place.allFinite()) {
      if (sight > MarkSight::uncertain) sight = MarkSight::uncertain;
      continue;
    }
    sight = MarkSight::measured;
    const int mark = static_cast<int>(corner / 4), k = static_cast<int>(corner % 4);
    m.points.push_back({mark, k, sheet.marks[index(mark)].corner_mm(k), place, sigma});
  }
}

void note_sights(PhotographMeasurement& m) {
  const auto count = [&](MarkSight sight) { return std::count(m.sights.begin(), m.sights.end(), sight); };
  const auto all = m.sights.size();
  const auto note = [&](MarkSight sight, const std::string& what) {
    if (const auto n = count(sight); n > 0)
      m.notes.push_back(std::to_string(n) + " of " + std::to_string(all) + " marks " + what);
  };
  note(
      MarkSight::not_seen,
      "were not found in any photograph: they are hidden, in glare, or stretched beyond reading. Take photographs that look at these places.");
  note(
      MarkSight::seen_once,
      "were found in one photograph only, which gives no depth: take another one of these places from a different side.");
  note(MarkSight::unclear, "were read but are not clear enough to measure: hold the camera still and go nearer.");
  note(MarkSight::small_angle, "were seen from nearly the same direction only: take photographs from farther apart.");
  note(MarkSight::uncertain,
       "are less certain than asked for and were left out: take more and nearer photographs of them.");
}

}  // namespace

PhotographMeasurement measure_photographs(std::span<const Photograph> photographs, const MarkSheet& sheet,
                                          const PhotographOptions& options, Context& context) {
  PhotographMeasurement m;
  m.board_scale = printed_scale(sheet, options);
  Stopwatch watch;
  std::vector<ReadPhotograph> read;
  {
    const auto span = context.span(0, 0.75, "Finding marks");
    read = read_photographs(photographs, sheet, m.notes, context);
  }
  m.seconds_find = watch.lap();
  PhotographSolution solution;
  {
    const auto span = context.span(0.75, 1, "Finding the cameras");
    solution = solve_photographs(read, sheet, m.board_scale, options.board_height_mm, m.notes, context);
  }
  check_spacing(sheet, solution);
  m.sights.assign(sheet.marks.size(), MarkSight::not_seen);
  m.photographs_of.assign(sheet.marks.size(), 0);
  for (const ReadPhotograph& r : read) {
    m.cameras.push_back(
        {r.file_name, r.width, r.height, static_cast<int>(r.sheet.size()), static_cast<int>(r.board.size())});
    for (const int mark : r.unclear) m.sights[index(mark)] = MarkSight::unclear;
  }
  for (std::size_t i = 0; i < solution.photograph_of_camera.size(); ++i) {
    const auto photograph = index(solution.photograph_of_camera[i]);
    CameraReport& camera = m.cameras[photograph];
    camera.used = true;
    camera.rms_px = solution.camera_rms_px[i];
    camera.centre_mm = solution.bundle.cameras[i].pose.centre();
    camera.lens = solution.bundle.cameras[i].lens;
    for (const ReadPhotograph::OnSheet& seen : read[photograph].sheet) ++m.photographs_of[index(seen.mark)];
  }
  for (std::size_t i = 0; i < m.sights.size(); ++i)
    if (m.photographs_of[i] == 1) m.sights[i] = MarkSight::seen_once;
    else if (m.photographs_of[i] > 1) m.sights[i] = MarkSight::uncertain;
  for (const int mark : solution.narrow_marks) m.sights[index(mark)] = MarkSight::small_angle;
  add_points_of(m, solution, sheet, options);
  if (m.points.empty())
    throw Error(ErrorCode::could_not_solve, "photograph",
                "No mark of the sheet could be measured from two sides: take more photographs, from farther apart.");
  m.lenses = solution.bundle.lenses;
  m.rms_px = solution.fit.rms_px;
  m.noise = solution.fit.noise;
  m.outliers = solution.outliers;
  for (const BundleObservation& o : solution.bundle.observations) m.observations += o.used ? 1 : 0;
  double squares = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const StripPlace& s = solution.bundle.strips[k];
    squares += s.shift_mm.squaredNorm() / 4;
    if (s.shift_mm.norm() > far_strip_mm)
      m.notes.push_back(
          "The " + sheet.strips[k].name + " strip lies " + with_max_decimals(s.shift_mm.norm(), 1) +
          " mm from where it should: lay its edge along the opening and its tick at the bar's middle, or the points are shifted.");
  }
  m.board_misfit_mm = std::sqrt(squares);
  note_sights(m);
  m.seconds_solve = watch.lap();
  return m;
}

Image draw_sights(const MarkSheet& sheet, const PhotographMeasurement& m, double pixel_mm) {
  static constexpr std::array<Rgba, 6> colours{{{46, 125, 50, 255},
                                                {240, 173, 40, 255},
                                                {240, 173, 40, 255},
                                                {230, 120, 30, 255},
                                                {200, 50, 45, 255},
                                                {200, 50, 45, 255}}};
  const auto pixels = [&](double mm) { return std::max(1, static_cast<int>(std::lround(mm / pixel_mm))); };
  Image image(pixels(sheet.sheet_mm.x()), pixels(sheet.sheet_mm.y()), {250, 250, 248, 255});
  for (std::size_t i = 0; i < sheet.marks.size(); ++i) {
    const PlacedMark& mark = sheet.marks[i];
    const MarkSight sight = m.sights[i];
    const Vec2 from = mark.corner_mm(0) / pixel_mm, to = mark.corner_mm(2) / pixel_mm;
    const int x0 = static_cast<int>(std::lround(0.5 * image.width + from.x())),
              x1 = static_cast<int>(std::lround(0.5 * image.width + to.x())),
              y0 = static_cast<int>(std::lround(0.5 * image.height - from.y())),
              y1 = static_cast<int>(std::lround(0.5 * image.height - to.y()));
    const int frame = std::max(1, (x1 - x0) / 6);
    for (int y = std::max(0, y0); y < std::min(image.height, y1); ++y)
      for (int x = std::max(0, x0); x < std::min(image.width, x1); ++x) {
        // Full: measured. A frame: not. Crossed: not seen at all. So that colours are not needed to tell.
        const bool rim = x - x0 < frame || x1 - 1 - x < frame || y - y0 < frame || y1 - 1 - y < frame;
        const bool crossed = sight == MarkSight::not_seen && std::abs((x - x0) - (y - y0)) <= frame / 2;
        if (sight == MarkSight::measured || rim || crossed) image.at(x, y) = colours[static_cast<std::size_t>(sight)];
      }
  }
  return image;
}

}  // namespace formwright
