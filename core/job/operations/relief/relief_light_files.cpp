// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/relief_light_files.h"

#include <algorithm>
#include <cmath>

#include "formats/container/zip.h"
#include "formats/mesh_io.h"
#include "formats/png/png16.h"
#include "imaging/picture/light.h"
#include "imaging/picture/png_writer.h"

namespace formwright {
namespace {

constexpr double lithophane_background = 0.5;
constexpr double pixels_of_16_bits = 65535;
constexpr double mm_a_metre = 1000;
constexpr int walk_step_deg = 5, walk_end_deg = 60;

/// Pictures start at the top, pixels of a view at the bottom.
std::size_t from_bottom(const PictureView& view, int x, int y) {
  return static_cast<std::size_t>(view.rows - 1 - y) * static_cast<std::size_t>(view.columns) +
         static_cast<std::size_t>(x);
}

}  // namespace

Bytes light_picture(const PictureView& view, const std::vector<char>& covered, const std::vector<double>& light,
                    double exposure, Context& context) {
  Image image(view.columns, view.rows, Rgba{0, 0, 0, 0});
  for (int y = 0; y < view.rows; ++y)
    for (int x = 0; x < view.columns; ++x) {
      const std::size_t pixel = from_bottom(view, x, y);
      if (!covered[pixel]) continue;
      const double brightness = std::clamp(exposure * light[pixel], 0.0, 1.0);
      const std::uint8_t grey = byte_of_light()[static_cast<std::size_t>(std::lround(brightness * light_levels))];
      image.at(x, y) = {grey, grey, grey, 255};
    }
  return write_png(image, static_cast<int>(std::lround(mm_a_metre / view.pixel_mm)), context);
}

Bytes picture_of_relief(const KeptLight& kept, const PictureView& view, const std::vector<double>& light,
                        double exposure, Context& context) {
  const LitScene& scene = *kept.scene;
  const SeenRelief seen = see_relief(view, scene.solid(), context);
  return light_picture(view, seen.covered, seen.values(scene.relief(), light), exposure, context);
}

Bytes walk_past(const KeptLight& kept, const std::vector<double>& light, double exposure, Context& context) {
  ZipWriter zip;
  int number = 0;
  for (int angle = -walk_end_deg; angle <= walk_end_deg; angle += walk_step_deg) {
    const PictureView view = picture_around(kept.scene->solid(), kept.scene->view().pixel_mm, kept.distance_mm, angle);
    const std::string place = angle == 0  ? "front"
                              : angle < 0 ? "left_" + std::to_string(-angle) + "_deg"
                                          : "right_" + std::to_string(angle) + "_deg";
    ++number;
    const std::string name = (number < 10 ? "0" : "") + std::to_string(number) + "_" + place + ".png";
    zip.add_stored(name, picture_of_relief(kept, view, light, exposure, context));
  }
  return zip.finish();
}

Bytes lit_front(const KeptLight& kept, double width_mm, const std::vector<double>& light, double exposure,
                Context& context) {
  Model model;
  model.mesh = front_mesh(kept.scene->relief());
  Positions in_view = model.mesh.V / width_mm;
  in_view.col(2) *= -1;
  model.mesh.V = kept.frame.to_model(in_view, width_mm);
  Eigen::VectorXd brightness(static_cast<Eigen::Index>(light.size()));
  for (Eigen::Index i = 0; i < brightness.size(); ++i)
    brightness[i] = std::clamp(exposure * light[static_cast<std::size_t>(i)], 0.0, 1.0);
  const std::vector<VertexColumn> columns{{"brightness", brightness, ColumnKind::float32}};
  WriteOptions write;
  write.columns = columns;
  return write_model(model, MeshFormat::ply, write, context);
}

Bytes lithophane_picture(const PictureView& view, const SeenModel& model, const std::vector<double>& light,
                         double exposure, const Lithophane& plate, Context& context) {
  Grey16Image image;
  image.width = view.columns;
  image.height = view.rows;
  image.pixel_width_mm = image.pixel_height_mm = view.pixel_mm;
  image.levels.reserve(view.pixels());
  for (int y = 0; y < view.rows; ++y)
    for (int x = 0; x < view.columns; ++x) {
      const int place = model.place_of_pixel[from_bottom(view, x, y)];
      const double brightness = place < 0 ? lithophane_background : exposure * light[static_cast<std::size_t>(place)];
      const double share = (lithophane_thickness_mm(plate, brightness) - plate.min_mm) / (plate.max_mm - plate.min_mm);
      image.levels.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.0, 1.0) * pixels_of_16_bits)));
    }
  return write_png16(image, context);
}

}  // namespace formwright
