// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/scan_registration.h"

#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "geometry/planar/plane.h"
#include "base/error.h"
#include "base/parallel.h"
#include "evidence/registration/picture_corners.h"
#include "evidence/registration/registered_points.h"
#include "evidence/registration/scan_picture.h"
#include "formats/shared/colour.h"
#include "imaging/picture/light.h"

namespace formwright {
namespace {

constexpr int first_side_px = 512, second_side_px = 1024;
constexpr double second_reach_px = 32, last_reach_px = 16;
constexpr double min_similarity = 0.7;  // of another pattern, however far bent: 0.5
constexpr int cells_across = 40;        // in which mean colours are compared once places are known

using Places = TextureCoordinates;

PlaneFrame sheet_frame(const CalibrationPattern& pattern, int side_px) {
  PlaneFrame frame;
  frame.pixel_mm = pattern.sheet_mm.maxCoeff() / side_px;
  frame.width = std::max(16, static_cast<int>(std::lround(pattern.sheet_mm.x() / frame.pixel_mm)));
  frame.height = std::max(16, static_cast<int>(std::lround(pattern.sheet_mm.y() / frame.pixel_mm)));
  return frame;
}

Vec2 relative(const PlaneFrame& frame, int x, int y) {
  return {(2.0 * x + 1) / frame.width - 1, (2.0 * y + 1) / frame.height - 1};
}

Vec3 colour_of(const Float4& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}
Vec3 light_of(const Rgba& p) {
  return Vec3(light_of_byte()[p[0]], light_of_byte()[p[1]], light_of_byte()[p[2]]) / light_levels;
}

/// Linear light to grey levels of sRGB, with the correction in between.
WeightedPicture corrected(const WeightedPicture& light, const ColourCorrection& correction, const PlaneFrame& frame,
                          const Context& context) {
  std::array<float, 4097> level{};
  for (std::size_t i = 0; i < level.size(); ++i)
    level[i] = static_cast<float>(255 * srgb_of_linear(std::pow(static_cast<double>(i) / 4096, 2)));
  WeightedPicture result(light.width, light.height);
  parallel_for(static_cast<std::size_t>(light.height), 32, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < light.width; ++x) {
        const Float4& p = light.at(x, y);
        if (!(p[3] > 0)) continue;
        const Vec3 c = correction(colour_of(p), relative(frame, x, y));
        Float4& out = result.at(x, y);
        for (int k = 0; k < 3; ++k) {
          const double place =
              4096 * std::sqrt(std::clamp(c[k], 0.0, 1.0));  // the table is even in the root, as levels nearly are
          const auto i = std::min<std::size_t>(4095, static_cast<std::size_t>(place));
          const float t = static_cast<float>(place - static_cast<double>(i));
          out[k] = level[i] + t * (level[i + 1] - level[i]);
        }
        out[3] = p[3];
      }
  });
  return result;
}

std::vector<ColourSample> patch_samples(const CalibrationPattern& pattern, const WeightedPicture& light,
                                        const PlaneFrame& frame) {
  std::vector<ColourSample> samples;
  for (const ColourPatch& patch : pattern.patches) {
    const Vec2 middle = frame.pixel(patch.centre_mm);
    const int reach = std::max(0, static_cast<int>(0.25 * patch.side_mm / frame.pixel_mm));
    std::array<std::vector<double>, 3> values;
    for (int y = static_cast<int>(middle.y()) - reach; y <= middle.y() + reach; ++y)
      for (int x = static_cast<int>(middle.x()) - reach; x <= middle.x() + reach; ++x) {
        if (x < 0 || y < 0 || x >= frame.width || y >= frame.height || !(light.at(x, y)[3] > 0)) continue;
        for (int c = 0; c < 3; ++c)
          values[static_cast<std::size_t>(c)].push_back(static_cast<double>(light.at(x, y)[c]));
      }
    if (values[0].empty()) continue;
    Vec3 seen;
    for (std::size_t c = 0; c < 3; ++c) seen[static_cast<int>(c)] = median(std::move(values[c]));
    samples.push_back(
        {relative(frame, static_cast<int>(middle.x()), static_cast<int>(middle.y())), seen, light_of(patch.colour)});
  }
  return samples;
}

/// Mean colours of small cells, once flow says where they are seen.
std::vector<ColourSample> cell_samples(const Image& reference, const WeightedPicture& light, const Flow& flow,
                                       const PlaneFrame& frame) {
  std::vector<ColourSample> samples;
  const int side = std::max(4, frame.width / cells_across);
  for (int y0 = 0; y0 + side <= frame.height; y0 += side)
    for (int x0 = 0; x0 + side <= frame.width; x0 += side) {
      Vec3 seen = Vec3::Zero(), expected = Vec3::Zero();
      int count = 0;
      for (int y = y0; y < y0 + side; ++y)
        for (int x = x0; x < x0 + side; ++x) {
          const std::size_t i = flow.index(x, y);
          const float px = static_cast<float>(x) + flow.u[i], py = static_cast<float>(y) + flow.v[i];
          if (!(px >= 0 && py >= 0 && px <= static_cast<float>(frame.width - 1) &&
                py <= static_cast<float>(frame.height - 1)))
            continue;
          const Float4 p = bilinear(light, px, py);
          if (p[3] < 0.999f) continue;
          seen += colour_of(p);
          expected += light_of(reference.at(x, y));
          ++count;
        }
      if (4 * count < 3 * side * side) continue;
      samples.push_back({relative(frame, x0 + side / 2, y0 + side / 2), seen / count, expected / count});
    }
  return samples;
}

/// Each vertex to the sheet point that the flow sees where it was drawn: s + w(s) = q.
Places carried(const Places& places, const Flow& flow, const PlaneFrame& frame) {
  Places result = places;
  parallel_for(static_cast<std::size_t>(places.rows()), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec2 q = places.row(static_cast<Eigen::Index>(v));
      Vec2 s = q;
      for (int k = 0; k < 40; ++k) {
        const Vec2 miss = s + displacement_mm(flow, frame, s) - q;
        s -= 0.6 * miss;  // converges where lengths change by less than 3.3 times
        if (miss.squaredNorm() < 1e-10) break;
      }
      result.row(static_cast<Eigen::Index>(v)) = s;
    }
  });
  return result;
}

double displacement_rms_mm(const Flow& flow, const WeightedPicture& seen, double pixel_mm) {
  double squared = 0, count = 0;
  for (std::size_t i = 0; i < flow.u.size(); ++i)
    if (seen.pixels[i][3] > 0) {
      squared += static_cast<double>(flow.u[i] * flow.u[i] + flow.v[i] * flow.v[i]);
      ++count;
    }
  return count > 0 ? pixel_mm * std::sqrt(squared / count) : 0;
}

/// Standard deviation of the blur, in pixels, after which the reference looks most like the scan.
double best_blur_px(const WeightedPicture& reference, const WeightedPicture& scan, const Flow& flow,
                    const Context& context) {
  double best = 0, minimum = 1e300;
  for (const double sigma : {0.0, 0.5, 0.8, 1.2, 1.7, 2.4, 3.4}) {
    const FlowEvidence e = flow_evidence(smoothed(reference, sigma, context), scan, flow, context);
    double sum = 0;
    for (const float r : e.residual_squared) sum += std::min(static_cast<double>(r), 10000.0);
    if (sum >= minimum) break;
    minimum = sum;
    best = sigma;
  }
  return best;
}

Image bytes_of(const WeightedPicture& picture) {
  Image image(picture.width, picture.height, {0, 0, 0, 0});
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const Float4& p = picture.pixels[i];
    if (!(p[3] > 0)) continue;
    for (std::size_t c = 0; c < 3; ++c)
      image.pixels[i][c] = static_cast<std::uint8_t>(std::lround(std::clamp(p[static_cast<int>(c)], 0.0f, 255.0f)));
    image.pixels[i][3] = 255;
  }
  return image;
}

/// Hue for the direction, saturation for the length (Baker et al. 2011 show flow so); what is not known stays
/// transparent.
void draw_displacement(ScanRegistration& result, const Triangles& faces, const Places& last,
                       const Places& after_corners, const CalibrationPattern& pattern) {
  const PlaneFrame frame = sheet_frame(pattern, 512);
  const PlaneLookup lookup(faces, last);
  std::vector<Vec2> moved(static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height),
                          Vec2(NAN, NAN));
  std::vector<double> lengths;
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const Vec2 s = frame.place(x, y);
      const PlaneLookup::Found found = lookup.find(s);
      if (found.face < 0) continue;
      Vec2 before = Vec2::Zero();
      for (int k = 0; k < 3; ++k) before += found.barycentric[k] * after_corners.row(faces(found.face, k)).transpose();
      moved[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(x)] =
          before - s;
      lengths.push_back((before - s).norm());
    }
  result.displacement = Image(frame.width, frame.height, {0, 0, 0, 0});
  if (lengths.empty()) return;
  result.displacement_full_mm = std::max(1e-6, value_of_rank(lengths, lengths.size() * 98 / 100));
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (!std::isfinite(moved[i].x())) continue;
    const double share = std::min(1.0, moved[i].norm() / result.displacement_full_mm),
                 hue = std::atan2(moved[i].y(), moved[i].x()) / (2 * 3.14159265358979324) + 1;
    Rgba& pixel = result.displacement.pixels[i];
    for (std::size_t c = 0; c < 3; ++c) {
      const double wheel = std::abs(std::fmod(6 * hue + 6 - 2 * static_cast<double>(c), 6.0) - 3) - 1;
      pixel[c] = static_cast<std::uint8_t>(std::lround(255 * (1 - share * (1 - std::clamp(wheel, 0.0, 1.0)))));
    }
    pixel[3] = 255;
  }
}

}  // namespace

ScanRegistration register_scan(const Model& scan, const CalibrationPattern& pattern,
                               const ScanRegistrationOptions& options, Context& context) {
  ScanRegistration result;
  Stopwatch watch;
  ScanPart part = sheet_part(scan);
  Model& model = part.model;
  model.mesh.V *= options.scan_unit_mm;
  result.notes = std::move(part.notes);
  result.holes = part.holes;
  result.scan_faces = model.mesh.face_count();
  result.other_parts = part.other_parts;
  const ScanColours colours(model, context);
  {
    const auto span = context.span(0, 0.2, "Laying the scan flat");
    result.flat = flatten(model.mesh, options.flatten_iterations, context);
  }
  Places& flat = result.flat.place_mm;
  result.seconds_flatten = watch.lap();

  // The corners.
  if (options.corners.empty()) {
    const auto span = context.span(0.2, 0.3, "Looking for the corner marks");
    const Vec2 low = flat.colwise().minCoeff(), high = flat.colwise().maxCoeff();
    PlaneFrame frame;
    frame.pixel_mm = std::max(pattern.marks[0].radius_mm / 12, (high - low).maxCoeff() / 1500);
    frame.centre_mm = (low + high) / 2;
    frame.width = static_cast<int>(std::ceil((high - low).x() / frame.pixel_mm)) + 2;
    frame.height = static_cast<int>(std::ceil((high - low).y() / frame.pixel_mm)) + 2;
    result.marks = find_marks(pattern, draw_scan(model, colours, flat, frame, context), frame, context);
    if (*std::min_element(result.marks.similarity.begin(), result.marks.similarity.end()) == 0)
      result.notes.push_back("One corner mark was not found; its place follows from the other three.");
  } else {
    result.marks.place_mm = plane_corners(options.corners, model, colours, flat);
    const auto& p = result.marks.place_mm;
    const Vec2 a = p[2] - p[0], b = p[3] - p[1];
    result.marks.mirrored = cross(a, b) < 0;
  }
  if (result.marks.mirrored) {
    flat.col(0) *= -1;
    for (Vec2& p : result.marks.place_mm) p.x() *= -1;
    model.mesh.F.col(1).swap(model.mesh.F.col(2));
    if (model.FT.rows() > 0) model.FT.col(1).swap(model.FT.col(2));
    result.notes.push_back("The scan's faces pointed away from the print and were flipped.");
  }
  result.corner_px = picture_corners(result.marks.place_mm, model, colours, flat);
  std::array<Vec2, 4> targets;
  double here_mm = 0, there_mm = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    targets[k] = pattern.marks[k].centre_mm;
    here_mm += (result.marks.place_mm[k] - result.marks.place_mm[(k + 1) % 4]).norm();
    there_mm += (pattern.marks[k].centre_mm - pattern.marks[(k + 1) % 4].centre_mm).norm();
  }
  result.plane_scale = there_mm / std::max(here_mm, 1e-9);
  const Eigen::Matrix3d by_corners = homography(result.marks.place_mm, targets);
  Places after_corners = flat;
  for (Eigen::Index v = 0; v < flat.rows(); ++v) after_corners.row(v) = mapped(by_corners, flat.row(v).transpose());
  result.seconds_marks = watch.lap();

  // Coarse to fine; after each flow the scan is laid down anew where it says, so that the next has little left to find.
  Places places = after_corners;
  PlaneFrame frame;
  WeightedPicture reference, seen;
  Flow flow;
  const std::array<int, 3> sides{std::min(first_side_px, options.picture_px),
                                 std::min(second_side_px, options.picture_px), options.picture_px};
  for (std::size_t round = 0; round < 3; ++round) {
    const auto span = context.span(round == 0   ? 0.3
                                   : round == 1 ? 0.4
                                                : 0.55,
                                   round == 0   ? 0.4
                                   : round == 1 ? 0.55
                                                : 0.95,
                                   "Comparing with the pattern");
    frame = sheet_frame(pattern, sides[round]);
    const Image drawn = draw_calibration_pattern(pattern, frame.width, frame.height, frame.pixel_mm, context);
    reference = weighted_picture(drawn);
    const WeightedPicture light = draw_scan(model, colours, places, frame, context);
    if (round == 0) {
      std::vector<ColourSample> samples = patch_samples(pattern, light, frame);
      if (samples.size() < 8)
        samples = cell_samples(drawn, light,
                               {frame.width, frame.height, std::vector<float>(drawn.pixels.size(), 0),
                                std::vector<float>(drawn.pixels.size(), 0)},
                               frame);
      result.colours = fit_colour_correction(samples);
    }
    seen = corrected(light, result.colours, frame, context);
    result.seconds_draw += watch.lap();
    if (round == 0) {
      flow = variational_flow(reference, seen, options, context);
      result.first_displacement_rms_mm = displacement_rms_mm(flow, seen, frame.pixel_mm);
    } else {
      if (result.blur_px > 0) reference = smoothed(reference, result.blur_px * sides[round] / sides[1], context);
      const Flow none{frame.width, frame.height, std::vector<float>(drawn.pixels.size(), 0),
                      std::vector<float>(drawn.pixels.size(), 0)};
      flow = refined_flow(reference, seen, none, round == 1 ? second_reach_px : last_reach_px, options, context);
    }
    result.seconds_flow += watch.lap();
    if (round == 2) break;
    if (std::vector<ColourSample> samples = cell_samples(drawn, light, flow, frame); samples.size() >= 100) {
      result.colours = fit_colour_correction(samples);
      result.colour_samples = static_cast<int>(samples.size());
    }
    if (round == 1)
      result.blur_px = best_blur_px(reference, corrected(light, result.colours, frame, context), flow, context);
    places = carried(places, flow, frame);
  }
  result.blur_px *= static_cast<double>(sides[2]) / sides[1];
  result.last_displacement_rms_mm = displacement_rms_mm(flow, seen, frame.pixel_mm);

  const FlowEvidence evidence = flow_evidence(reference, seen, flow, context);
  double squared = 0, weight = 0;
  for (std::size_t i = 0; i < evidence.weight.size(); ++i) {
    squared += static_cast<double>(evidence.residual_squared[i]);
    weight += static_cast<double>(evidence.weight[i]);
  }
  if (weight < 0.05 * static_cast<double>(evidence.weight.size()))
    throw Error(ErrorCode::could_not_solve, "scan",
                "The scan hardly covers the place of the pattern: check the corners and the pattern.");
  result.colour_error_levels = std::sqrt(squared / (3 * weight));
  const MatchStatistics match = match_statistics(reference, seen, flow);
  result.similarity = match.similarity;
  result.residual_correlation_px = match.residual_alike_px;
  if (match.similarity < min_similarity)
    throw Error(
        ErrorCode::could_not_solve, "pattern",
        "The scan does not look like this pattern: give the pattern.json of the print that was formed, and check the corners.");
  add_points(result, model.mesh, places, frame, flow, evidence, pattern, options);
  if (result.points.empty())
    throw Error(
        ErrorCode::could_not_solve, "scan",
        "No point of the scan could be matched with the pattern: check that it is the one that was printed, and the corners.");

  const PlaneLookup lookup(model.mesh.F, places);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 s = pattern.marks[k].centre_mm;
    const PlaneLookup::Found found = lookup.find(s + displacement_mm(flow, frame, s));
    result.corner_residual_mm[k] = -1;
    if (found.face < 0) continue;
    Vec2 there = Vec2::Zero();
    for (int i = 0; i < 3; ++i) there += found.barycentric[i] * flat.row(model.mesh.F(found.face, i)).transpose();
    result.corner_residual_mm[k] = (there - result.marks.place_mm[k]).norm();
  }
  context.progress(0.96, "Drawing the result");
  draw_displacement(result, model.mesh.F, carried(places, flow, frame), after_corners, pattern);
  result.aligned = bytes_of(seen);
  align_by_rim(result, pattern, options);
  result.seconds_points = watch.lap();
  return result;
}

}  // namespace formwright
