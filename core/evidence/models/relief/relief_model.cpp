// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/relief/relief_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace formwright {
namespace {

constexpr std::size_t min_relief_points = 30;
constexpr double shininess = 20;      // of gloss: Blinn and Phong's exponent
constexpr double usual_sigma = 0.01;  // of a brightness without one, of the brightest
constexpr double half_pixel = 0.5;    // steps along a ray of sight
constexpr int bisections = 30;
constexpr double distance_of_a_far_camera_mm = 1000;  // to which viewer_offset is a distance where none is given

enum Index {
  ambient,
  tilt_x,
  tilt_y,
  light_nearness,
  gloss,
  cast_shadow,
  printer_blur_mm,
  depth_shrinkage,
  viewer_x,
  viewer_y
};

ModelParameter declared(const char* name, const char* label, const char* unit, ParameterRole role, double nominal,
                        double low, double high, bool logarithmic, double sd, double probe) {
  ModelParameter p;
  p.name = name;
  p.label = label;
  p.unit = unit;
  p.role = role;
  p.nominal = nominal;
  p.low = low;
  p.high = high;
  p.logarithmic = logarithmic;
  p.prior_sd = sd;
  p.probe = probe;
  return p;
}

/// Brightness in shares of the picture's brightest point, places in shares of the relief's width and height.
Measurement measurement_of(const PhotographedRelief& picture) {
  double brightest = 0;
  for (const ShadedPoint& p : picture.points) brightest = std::max(brightest, p.brightness);
  if (!(brightest > 0))
    throw Error(ErrorCode::invalid_input, "object",
                picture.name + ": all brightnesses are 0, but shading.csv needs linear brightnesses above 0.");
  Measurement m;
  m.name = picture.name;
  const Vec2 size = picture.surface.size_mm();
  m.extent_mm = size.maxCoeff();
  const auto n = static_cast<Eigen::Index>(picture.points.size());
  m.place.resize(n, 2);
  m.measured.resize(n, 1);
  m.sigma.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ShadedPoint& p = picture.points[static_cast<std::size_t>(i)];
    m.place.row(i) = (p.place_mm - picture.surface.lower_mm).cwiseQuotient(size).transpose();
    m.measured(i, 0) = p.brightness / brightest;
    m.sigma[i] = p.sigma / brightest;
  }
  return m;
}

/// Where a camera sees the surface at a place of a picture that was straightened to the plane at `plane_mm`: the first
/// place on its ray, from above. The camera is `aside_mm` beside the place and `distance_mm` above the plane.
Vec2 seen_place(const ReliefSurface& surface, const Vec2& heights_mm, const Vec2& place_mm, double plane_mm,
                const Vec2& aside_mm, double distance_mm) {
  const double across = aside_mm.norm() / distance_mm;  // for each millimetre of height
  if (across * (heights_mm.y() - heights_mm.x()) < 1e-9 * surface.pixel_mm &&
      across * std::abs(heights_mm.x() - plane_mm) < 1e-9 * surface.pixel_mm)
    return place_mm;
  const auto place = [&](double height) -> Vec2 { return place_mm + (height - plane_mm) / distance_mm * aside_mm; };
  const auto above = [&](double height) { return height - surface.at(surface.height_mm, place(height)); };
  // Half a pixel across, but no more steps than a ray through all of the grid needs.
  const double max_steps = 2 / half_pixel * static_cast<double>(surface.height_mm.rows() + surface.height_mm.cols());
  const double step = std::max(half_pixel * surface.pixel_mm / std::max(across, 1e-12),
                               (heights_mm.y() - heights_mm.x()) / max_steps),
               lowest = heights_mm.x() - step;
  double high = heights_mm.y(), low = high;
  while (low > lowest && above(low) > 0) {
    high = low;
    low = std::max(lowest, low - step);
  }
  for (int k = 0; k < bisections; ++k) {
    const double middle = 0.5 * (low + high);
    (above(middle) > 0 ? high : low) = middle;
  }
  return place(0.5 * (low + high));
}

/// The factor that brings `predicted` nearest to what was measured.
double exposure_of(const Measurement& m, const Eigen::VectorXd& predicted) {
  double with = 0, of_itself = 0;
  for (Eigen::Index i = 0; i < predicted.size(); ++i) {
    const double weight = m.sigma[i] > 0 ? 1 / (m.sigma[i] * m.sigma[i]) : 1 / (usual_sigma * usual_sigma);
    with += weight * predicted[i] * m.measured(i, 0);
    of_itself += weight * predicted[i] * predicted[i];
  }
  return of_itself > 0 && with > 0 ? with / of_itself : 1;
}
}  // namespace

ReliefModel::ReliefModel(std::vector<PhotographedRelief> pictures) : pictures_(std::move(pictures)) {
  using enum ParameterRole;
  for (PhotographedRelief& picture : pictures_) {
    points_beside_ += static_cast<int>(
        std::erase_if(picture.points, [&](const ShadedPoint& p) { return !picture.surface.holds(p.place_mm); }));
    if (picture.points.size() < min_relief_points)
      throw Error(ErrorCode::invalid_input, "object",
                  picture.name + ": shading.csv has " + std::to_string(picture.points.size()) +
                      " points on the relief; at least " + std::to_string(min_relief_points) + " are needed.");
    const Vec2 heights = picture.surface.height_range_mm();
    const double camera = picture.setup.camera_height_mm,
                 above = 0.5 * heights.sum() + camera -
                         std::max(heights.y(), picture.setup.straightened_at_mm.value_or(heights.y()));
    if (camera > 0 && !(above > 0))
      throw Error(ErrorCode::invalid_input, "object",
                  picture.name +
                      ": the camera is not above the relief and the plane that the picture shows true: correct " +
                      "“camera_height_mm” or “straightened_at_mm” in setup.json.");
    measurements_.push_back(measurement_of(picture));
  }
  parameters_ = {
      declared("ambient", "Ambient light", "", base, 0.1, 0, 0.9, false, 0.15, 0.05),
      declared("light_tilt_x_deg", "Light turned in x", "°", effect, 0, -60, 60, false, 10, 3),
      declared("light_tilt_y_deg", "Light turned in y", "°", effect, 0, -60, 60, false, 10, 3),
      declared("light_nearness_per_m", "Light nearer", "1/m", effect, 0, -20, 20, false, 2, 0.5),
      declared("gloss", "Gloss", "", effect, 0, 0, 2, false, 0.3, 0.1),
      declared("cast_shadow", "Cast shadow", "", effect, 0, 0, 1, false, 0.5, 0.3),
      declared("printer_blur_mm", "Printer's blur", "mm", effect, 0, 0, 5, false, 0.5, 0.3),
      declared("depth_shrinkage", "Depth lost", "", effect, 0, -0.8, 0.8, false, 0.2, 0.08),
      declared("viewer_offset_x_mm", "Camera too far to the right by", "mm", effect, 0, -2000, 2000, false, 60, 20),
      declared("viewer_offset_y_mm", "Viewer higher by", "mm", effect, 0, -2000, 2000, false, 60, 20)};
  causes_ = {{"light_direction",
              "Light from another direction",
              "The light came from another direction than stated.",
              "Measure the light's place again, or fix it to the stand.",
              {tilt_x, tilt_y},
              "°",
              0,
              FaultOf::measurement},
             {"light_distance",
              "Light at another distance",
              "The light stood nearer or farther than stated: brightness falls off over the relief.",
              "Move the light farther away, or measure its distance.",
              {light_nearness},
              "1/m",
              0,
              FaultOf::measurement},
             {"gloss",
              "Gloss",
              "The surface shines.",
              "Make the surface matt with primer or fine sanding, or photograph it with crossed polarisers.",
              {gloss},
              ""},
             {"cast_shadow",
              "Cast shadows",
              "Parts of the relief throw shadows on others.",
              "Raise the light, or design for less depth.",
              {cast_shadow},
              "",
              0,
              FaultOf::simulation},
             {"printer_blur",
              "Machine blurs detail",
              "The printer's nozzle or the cutter rounded fine detail.",
              "Use a finer nozzle, layer or tool, or a larger relief.",
              {printer_blur_mm},
              "mm"},
             {"depth_shrinkage",
              "Less depth than designed",
              "The relief came out shallower or deeper than its model.",
              "Measure the depth and correct the machine's z scale or the material's shrinkage.",
              {depth_shrinkage},
              ""},
             {"viewer_offset",
              "Seen from beside the viewpoint",
              "The camera stood beside the viewpoint.",
              "Put the camera where the relief was made to be seen from.",
              {viewer_x, viewer_y},
              "mm",
              0,
              FaultOf::measurement}};
}

Eigen::MatrixXd ReliefModel::predict(int object, const Eigen::VectorXd& u, const Context& context) const {
  const PhotographedRelief& picture = pictures_[static_cast<std::size_t>(object)];
  const auto value = [&](Index i) { return parameters_[static_cast<std::size_t>(i)].value(u[i]); };
  const ReliefSurface s = picture.surface.made_with(value(printer_blur_mm), value(depth_shrinkage));
  context.check_cancelled();

  constexpr double degree = 0.017453292519943295;
  const Vec3 towards =
      (Eigen::AngleAxisd(value(tilt_y) * degree, Vec3::UnitX()) *
       Eigen::AngleAxisd(value(tilt_x) * degree, Vec3::UnitY()) * picture.setup.light_direction.normalized())
          .normalized();
  const Vec2 heights = s.height_range_mm(), centre = s.lower_mm + 0.5 * (s.size_mm() - Vec2::Constant(s.pixel_mm));
  const Vec3 middle(centre.x(), centre.y(), 0.5 * heights.sum());
  const double nearness_per_mm =
      (picture.setup.light_distance_mm > 0 ? 1 / picture.setup.light_distance_mm : 0) + 1e-3 * value(light_nearness);
  const double camera_mm = picture.setup.camera_height_mm;
  const Vec2 offset(value(viewer_x), value(viewer_y));
  const Vec3 far_viewer = Vec3(offset.x(), offset.y(), distance_of_a_far_camera_mm).normalized(),
             viewer = middle + Vec3(offset.x(), offset.y(), camera_mm);
  const Eigen::MatrixXd reached = value(cast_shadow) > 0 ? lit(s, towards) : Eigen::MatrixXd();
  const double surroundings = value(ambient);

  Eigen::MatrixXd brightness(s.height_mm.rows(), s.height_mm.cols());
  for (Eigen::Index r = 0; r < brightness.rows(); ++r)
    for (Eigen::Index c = 0; c < brightness.cols(); ++c) {
      const Vec3 normal = s.normal(r, c);
      const Vec3 place(s.lower_mm.x() + s.pixel_mm * static_cast<double>(c),
                       s.lower_mm.y() + s.pixel_mm * static_cast<double>(r), s.height_mm(r, c));
      // With nearness e = 1 / distance the light is at l / e: (l - e p) has its direction, and its length the fall-off,
      // down to e = 0.
      const Vec3 to_light = towards - nearness_per_mm * (place - middle);
      const double distance = to_light.norm(), facing = std::max(0.0, normal.dot(to_light) / distance),
                   falloff = 1 / (distance * distance);
      const Vec3 to_viewer = camera_mm > 0 ? Vec3((viewer - place).normalized()) : far_viewer;
      const Vec3 half = (to_light / distance + to_viewer).normalized();
      const double shine = value(gloss) * (facing > 0 ? std::pow(std::max(0.0, normal.dot(half)), shininess) : 0);
      const double direct =
          (facing + shine) * falloff * (reached.size() > 0 ? 1 - value(cast_shadow) * (1 - reached(r, c)) : 1);
      brightness(r, c) = surroundings + (1 - surroundings) * direct;
    }

  // Markers on the plane keep their places in the picture wherever the camera stands; what is higher or lower moves.
  const double plane_mm = picture.setup.straightened_at_mm.value_or(middle.z());
  Eigen::VectorXd result(static_cast<Eigen::Index>(picture.points.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const Vec2& at = picture.points[static_cast<std::size_t>(i)].place_mm;
    const Vec2 aside = camera_mm > 0 ? Vec2(viewer.head<2>() - at) : offset;
    const double above_plane_mm = camera_mm > 0 ? viewer.z() - plane_mm : distance_of_a_far_camera_mm;
    result[i] = s.at(brightness, seen_place(s, heights, at, plane_mm, aside, above_plane_mm));
  }
  result *= exposure_of(measurements_[static_cast<std::size_t>(object)], result);
  if (!result.allFinite()) throw Error(ErrorCode::could_not_solve, "", "The shading has no finite value there.");
  return result;
}

}  // namespace formwright
