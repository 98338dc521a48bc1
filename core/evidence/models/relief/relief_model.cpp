// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/relief/relief_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/data/json_text.h"
#include "base/data/number_table.h"
#include "geometry/queries/ray_caster.h"

namespace formwright {
namespace {

constexpr std::size_t min_relief_points = 30;
constexpr double shininess = 20;     // of gloss: Blinn and Phong's exponent
constexpr double penumbra_mm = 0.3;  // over which a shadow's edge fades

enum Index {
  exposure,
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

double bilinear(const Eigen::MatrixXd& grid, double column, double row) {
  const double c = std::clamp(column, 0.0, static_cast<double>(grid.cols() - 1)),
               r = std::clamp(row, 0.0, static_cast<double>(grid.rows() - 1));
  const auto c0 = std::min(static_cast<Eigen::Index>(c), std::max<Eigen::Index>(0, grid.cols() - 2)),
             r0 = std::min(static_cast<Eigen::Index>(r), std::max<Eigen::Index>(0, grid.rows() - 2));
  const Eigen::Index c1 = std::min(c0 + 1, grid.cols() - 1), r1 = std::min(r0 + 1, grid.rows() - 1);
  const double s = c - static_cast<double>(c0), t = r - static_cast<double>(r0);
  return (1 - t) * ((1 - s) * grid(r0, c0) + s * grid(r0, c1)) + t * ((1 - s) * grid(r1, c0) + s * grid(r1, c1));
}

}  // namespace

ReliefSurface ReliefSurface::of(const TriangleMesh& mesh, int pixels, Context& context) {
  ReliefSurface surface;
  const Vec3 lower = mesh.V.colwise().minCoeff().transpose(), upper = mesh.V.colwise().maxCoeff().transpose();
  const Vec3 size = upper - lower;
  if (!(size.x() > 0) || !(size.y() > 0))
    throw Error(ErrorCode::invalid_input, "object", "The relief has no extent in x and y: z must point at the viewer.");
  surface.pixel_mm = std::max(size.x(), size.y()) / pixels;
  surface.lower_mm = lower.head<2>() + Vec2::Constant(0.5 * surface.pixel_mm);
  const auto columns = std::max<Eigen::Index>(2, static_cast<Eigen::Index>(size.x() / surface.pixel_mm)),
             rows = std::max<Eigen::Index>(2, static_cast<Eigen::Index>(size.y() / surface.pixel_mm));
  surface.height_mm.setConstant(rows, columns, lower.z());
  const RayCaster rays(mesh);
  for (Eigen::Index r = 0; r < rows; ++r) {
    context.check_cancelled();
    for (Eigen::Index c = 0; c < columns; ++c) {
      const Vec3 above(surface.lower_mm.x() + surface.pixel_mm * static_cast<double>(c),
                       surface.lower_mm.y() + surface.pixel_mm * static_cast<double>(r), upper.z() + 1);
      if (const auto hit = rays.first_hit(above, -Vec3::UnitZ(), 0, size.z() + 2))
        surface.height_mm(r, c) = above.z() - hit->distance;
    }
  }
  return surface;
}

Eigen::MatrixXd blurred(const Eigen::MatrixXd& height, double sigma_pixels) {
  if (!(sigma_pixels > 0.05)) return height;
  const int reach = static_cast<int>(std::ceil(4 * sigma_pixels));
  Eigen::VectorXd kernel(2 * reach + 1);
  for (int i = -reach; i <= reach; ++i) kernel[i + reach] = std::exp(-0.5 * i * i / (sigma_pixels * sigma_pixels));
  kernel /= kernel.sum();
  const auto along_rows = [&](const Eigen::MatrixXd& in) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(in.rows(), in.cols());
    for (Eigen::Index c = 0; c < in.cols(); ++c)
      for (int i = -reach; i <= reach; ++i)
        out.col(c) += kernel[i + reach] * in.col(std::clamp<Eigen::Index>(c + i, 0, in.cols() - 1));
    return out;
  };
  return along_rows(along_rows(height).transpose()).transpose();
}

Eigen::MatrixXd lit(const ReliefSurface& surface, const Vec3& light) {
  const Eigen::MatrixXd& z = surface.height_mm;
  Eigen::MatrixXd result = Eigen::MatrixXd::Ones(z.rows(), z.cols());
  const double across = light.head<2>().norm();
  if (across < 1e-6 || light.z() <= 0) return result;
  const Vec2 step = light.head<2>() / across;
  const double rise = light.z() / across * surface.pixel_mm, highest = z.maxCoeff();
  for (Eigen::Index r = 0; r < z.rows(); ++r)
    for (Eigen::Index c = 0; c < z.cols(); ++c) {
      double blocked = -1e9;
      for (int k = 1;; ++k) {
        const double ray = z(r, c) + k * rise, column = static_cast<double>(c) + k * step.x(),
                     row = static_cast<double>(r) + k * step.y();
        if (ray > highest + penumbra_mm || column < 0 || row < 0 || column > static_cast<double>(z.cols() - 1) ||
            row > static_cast<double>(z.rows() - 1))
          break;
        blocked = std::max(blocked, bilinear(z, column, row) - ray);
      }
      result(r, c) = std::clamp(1 - blocked / penumbra_mm, 0.0, 1.0);
    }
  return result;
}

ReliefModel::ReliefModel(std::vector<PhotographedRelief> reliefs) : reliefs_(std::move(reliefs)) {
  using enum ParameterRole;
  double brightest = 0;
  for (const PhotographedRelief& relief : reliefs_) {
    if (relief.points.size() < min_relief_points)
      throw Error(ErrorCode::invalid_input, "object",
                  relief.name + ": shading.csv has " + std::to_string(relief.points.size()) + " points; at least " +
                      std::to_string(min_relief_points) + " are needed.");
    for (const ShadedPoint& p : relief.points) brightest = std::max(brightest, p.brightness);
  }
  if (!(brightest > 0))
    throw Error(ErrorCode::invalid_input, "object",
                "All brightnesses are 0: shading.csv needs linear brightnesses above 0.");
  parameters_ = {
      declared("exposure", "Exposure", "", base, brightest, 1e-3 * brightest, 1e2 * brightest, true, 0.7, 0.1),
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
  for (const PhotographedRelief& relief : reliefs_) {
    Measurement m;
    m.name = relief.name;
    const ReliefSurface& s = relief.surface;
    const double width = s.pixel_mm * static_cast<double>(s.height_mm.cols()),
                 height = s.pixel_mm * static_cast<double>(s.height_mm.rows());
    m.extent_mm = std::max(width, height);
    const auto n = static_cast<Eigen::Index>(relief.points.size());
    m.place.resize(n, 2);
    m.measured.resize(n, 1);
    m.sigma.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const ShadedPoint& p = relief.points[static_cast<std::size_t>(i)];
      m.place.row(i) << (p.place_mm.x() - s.lower_mm.x()) / width, (p.place_mm.y() - s.lower_mm.y()) / height;
      m.measured(i, 0) = p.brightness / brightest;
      m.sigma[i] = p.sigma / brightest;
    }
    measurements_.push_back(std::move(m));
  }
  // Brightness counts in shares of the brightest point from here on.
  parameters_[exposure].nominal = 1;
  parameters_[exposure].low = 1e-3;
  parameters_[exposure].high = 1e2;
}

Eigen::MatrixXd ReliefModel::predict(int object, const Eigen::VectorXd& u, const Context& context) const {
  const PhotographedRelief& relief = reliefs_[static_cast<std::size_t>(object)];
  const auto value = [&](Index i) { return parameters_[static_cast<std::size_t>(i)].value(u[i]); };
  ReliefSurface s = relief.surface;
  s.height_mm = blurred(s.height_mm, value(printer_blur_mm) / s.pixel_mm) * (1 - value(depth_shrinkage));
  context.check_cancelled();

  constexpr double degree = 0.017453292519943295;
  const Vec3 towards =
      (Eigen::AngleAxisd(value(tilt_y) * degree, Vec3::UnitX()) *
       Eigen::AngleAxisd(value(tilt_x) * degree, Vec3::UnitY()) * relief.setup.light_direction.normalized())
          .normalized();
  const Eigen::MatrixXd& z = s.height_mm;
  const Vec3 middle(s.lower_mm.x() + 0.5 * s.pixel_mm * static_cast<double>(z.cols()),
                    s.lower_mm.y() + 0.5 * s.pixel_mm * static_cast<double>(z.rows()),
                    0.5 * (z.maxCoeff() + z.minCoeff()));
  const double nearness_per_mm =
      (relief.setup.light_distance_mm > 0 ? 1 / relief.setup.light_distance_mm : 0) + 1e-3 * value(light_nearness);
  const double camera_mm = relief.setup.camera_height_mm;
  const Vec3 viewer = middle + Vec3(value(viewer_x), value(viewer_y), camera_mm > 0 ? camera_mm : 1000);
  const Eigen::MatrixXd reached = value(cast_shadow) > 0 ? lit(s, towards) : Eigen::MatrixXd();
  const double surroundings = value(ambient);

  Eigen::MatrixXd brightness(z.rows(), z.cols());
  for (Eigen::Index r = 0; r < z.rows(); ++r)
    for (Eigen::Index c = 0; c < z.cols(); ++c) {
      const Eigen::Index left = std::max<Eigen::Index>(0, c - 1), right = std::min(z.cols() - 1, c + 1),
                         below = std::max<Eigen::Index>(0, r - 1), above = std::min(z.rows() - 1, r + 1);
      const Vec3 normal = Vec3(-(z(r, right) - z(r, left)) / (s.pixel_mm * static_cast<double>(right - left)),
                               -(z(above, c) - z(below, c)) / (s.pixel_mm * static_cast<double>(above - below)), 1)
                              .normalized();
      const Vec3 place(s.lower_mm.x() + s.pixel_mm * static_cast<double>(c),
                       s.lower_mm.y() + s.pixel_mm * static_cast<double>(r), z(r, c));
      // With nearness e = 1 / distance the light is at l / e: (l - e p) has its direction, and its length the fall-off,
      // down to e = 0.
      const Vec3 to_light = towards - nearness_per_mm * (place - middle);
      const double distance = to_light.norm(), facing = std::max(0.0, normal.dot(to_light) / distance),
                   falloff = 1 / (distance * distance);
      const Vec3 to_viewer =
          camera_mm > 0 || value(viewer_x) != 0 || value(viewer_y) != 0 ? (viewer - place).normalized() : Vec3::UnitZ();
      const Vec3 half = (to_light / distance + to_viewer).normalized();
      const double shine = value(gloss) * (facing > 0 ? std::pow(std::max(0.0, normal.dot(half)), shininess) : 0);
      const double direct =
          (facing + shine) * falloff * (reached.size() > 0 ? 1 - value(cast_shadow) * (1 - reached(r, c)) : 1);
      brightness(r, c) = value(exposure) * (surroundings + (1 - surroundings) * direct);
    }

  Eigen::MatrixXd result(static_cast<Eigen::Index>(relief.points.size()), 1);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    // The picture was rectified for a camera over the middle: one beside it sees what stands high elsewhere.
    Vec2 at = relief.points[static_cast<std::size_t>(i)].place_mm;
    const Vec2 offset(value(viewer_x), value(viewer_y));
    for (int k = 0; k < 3 && offset.squaredNorm() > 0; ++k) {
      const double height =
          bilinear(z, (at.x() - s.lower_mm.x()) / s.pixel_mm, (at.y() - s.lower_mm.y()) / s.pixel_mm) - middle.z();
      at = relief.points[static_cast<std::size_t>(i)].place_mm + height / (viewer.z() - middle.z()) * offset;
    }
    result(i, 0) = bilinear(brightness, (at.x() - s.lower_mm.x()) / s.pixel_mm, (at.y() - s.lower_mm.y()) / s.pixel_mm);
  }
  if (!result.allFinite()) throw Error(ErrorCode::could_not_solve, "", "The shading has no finite value there.");
  return result;
}

std::vector<ShadedPoint> read_shaded_points(ByteView csv) {
  std::vector<ShadedPoint> points;
  for (const std::vector<double>& row :
       read_number_table(csv, "shading.csv", "object", {{"x_mm"}, {"y_mm"}, {"brightness"}, {"sigma", false}})) {
    if (row[2] < 0 || row[3] < 0)
      throw Error(
          ErrorCode::invalid_input, "object",
          "shading.csv, point " + std::to_string(points.size() + 1) + ": brightness and sigma must not be negative.");
    points.push_back({Vec2(row[0], row[1]), row[2], row[3]});
  }
  return points;
}

ShadingSetup read_shading_setup(ByteView bytes) {
  const auto refuse = [](const std::string& sentence) {
    throw Error(ErrorCode::invalid_input, "object", "setup.json: " + sentence);
  };
  const Json json = parse_json_text(as_text(bytes));
  if (!json.is_object()) refuse("this is not a JSON object; see docs/evidence.md for one.");
  ShadingSetup setup;
  const auto length = [&](const char* key, double& value) {
    if (!json.contains(key)) return;
    if (!json[key].is_number() || !(json[key].get<double>() >= 0))
      refuse("“" + std::string(key) + "” must be a number of millimetres, 0 or more.");
    value = json[key].get<double>();
  };
  length("light_distance_mm", setup.light_distance_mm);
  length("camera_height_mm", setup.camera_height_mm);
  if (!json.contains("light_direction"))
    refuse("“light_direction” is missing: three numbers, from the relief towards the light, z towards the viewer.");
  const Json& direction = json["light_direction"];
  if (!direction.is_array() || direction.size() != 3 ||
      !std::all_of(direction.begin(), direction.end(), [](const Json& v) { return v.is_number(); }))
    refuse("“light_direction” must be three numbers, such as [-1, 1, 1].");
  for (int k = 0; k < 3; ++k) setup.light_direction[k] = direction[static_cast<std::size_t>(k)].get<double>();
  if (!(setup.light_direction.z() > 0) || !setup.light_direction.allFinite())
    refuse("“light_direction” must point towards the viewer's side: its third number above 0.");
  return setup;
}

}  // namespace formwright
