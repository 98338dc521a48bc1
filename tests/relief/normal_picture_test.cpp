// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/seen/normal_picture.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <cmath>

#include "base/parallel.h"
#include "geometry/test_meshes.h"
#include "relief/seen/seen_difference.h"

namespace formwright::normal_picture_tests {
namespace {
using Catch::Matchers::WithinAbs;

ViewFrame frame_of(const TriangleMesh& mesh, Projection projection, double field_of_view_deg = 30) {
  ReliefOptions options;
  options.projection = projection;
  options.field_of_view_deg = field_of_view_deg;
  return make_view_frame(mesh, options);
}

/// Root mean square distance between drawn normals and those of the ball, where they are not seen edge-on.
double ball_error(int levels, Projection projection) {
  const TriangleMesh mesh = test::icosphere(levels);
  const ViewFrame frame = frame_of(mesh, projection);
  PictureGrid grid = eye_grid(frame, 4);
  Context context;
  const NormalPicture picture = draw_normals(frame, frame.P, mesh.F, grid, context);
  const double radius = frame.scale;  // of a unit ball, in widths
  Vec3 centre = frame.axes * (Vec3::Zero() - frame.centre) * frame.scale;
  double sum = 0, count = 0;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const Vec3 plate((column + 0.5 - 0.5 * grid.columns) * grid.pixel, (row + 0.5 - 0.5 * grid.rows) * grid.pixel, 0);
      // From the viewpoint through the plate to the ball.
      const Vec3 origin = frame.kappa > 0 ? Vec3(0, 0, -1 / frame.kappa) : Vec3(plate.x(), plate.y(), -2);
      const Vec3 ray = (plate - origin).normalized(), to_centre = centre - origin;
      const double along = ray.dot(to_centre), miss2 = to_centre.squaredNorm() - along * along;
      if (miss2 > 0.9 * 0.9 * radius * radius) continue;
      const Vec3 hit = origin + (along - std::sqrt(radius * radius - miss2)) * ray;
      const Vec3 normal = (hit - centre) / radius;  // outwards, z away from the viewer
      const std::size_t p = picture.at(row, column);
      CHECK(picture.covered[p] == 1);
      sum += (Vec3(static_cast<double>(picture.x[p]), static_cast<double>(picture.y[p]),
                   static_cast<double>(picture.z[p])) -
              Vec3(normal.x(), normal.y(), -normal.z()))
                 .squaredNorm();
      ++count;
    }
  return std::sqrt(sum / count);
}

TEST_CASE("NormalPicture.OfABallConverges") {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const double coarse = ball_error(2, projection), middle = ball_error(3, projection),
                 fine = ball_error(4, projection);
    CHECK(fine < 3e-3);
    // Area-weighted normals are of second order where the triangles change smoothly and of first order along the edges
    // of the icosahedron, which take a share of the picture that halves with the triangles: 3/2 in the mean square.
    CHECK_THAT(std::log2(coarse / middle), WithinAbs(1.5, 0.3));
    CHECK_THAT(std::log2(middle / fine), WithinAbs(1.5, 0.3));
  }
}

TEST_CASE("NormalPicture.OfWavesConvergesWithSecondOrder") {
  const auto error_at = [](int cells) {
    TriangleMesh mesh = test::grid(cells, cells);
    const auto slope = [](double x) { return 0.5 * std::cos(5 * x); };
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 2) = 0.1 * std::sin(5 * mesh.V(i, 0));
    const ViewFrame frame = frame_of(mesh, Projection::orthographic);
    Context context;
    const NormalPicture picture = draw_normals(frame, frame.P, mesh.F, eye_grid(frame, 8), context);
    const double left = mesh.V.col(0).minCoeff(), width = mesh.V.col(0).maxCoeff() - left;
    double worst = 0;
    for (int row = picture.grid.rows / 4; row < 3 * picture.grid.rows / 4; ++row)
      for (int column = picture.grid.columns / 4; column < 3 * picture.grid.columns / 4; ++column) {
        const double x = left + width * (0.5 + (column + 0.5 - 0.5 * picture.grid.columns) * picture.grid.pixel);
        const Vec3 normal = Vec3(-slope(x), 0, 1).normalized();
        const std::size_t p = picture.at(row, column);
        worst = std::max(worst, (Vec3(static_cast<double>(picture.x[p]), static_cast<double>(picture.y[p]),
                                      static_cast<double>(picture.z[p])) -
                                 normal)
                                    .norm());
      }
    return worst;
  };
  const double coarse = error_at(20), middle = error_at(40), fine = error_at(80);
  CHECK_THAT(std::log2(coarse / middle), WithinAbs(2, 0.4));
  CHECK_THAT(std::log2(middle / fine), WithinAbs(2, 0.4));
}

TEST_CASE("NormalPicture.PixelsAreOneArcMinute") {
  const TriangleMesh mesh = test::icosphere(2);
  for (const double angle : {5.0, 20.0}) {
    const ViewFrame frame = frame_of(mesh, Projection::perspective, angle);
    const PictureGrid grid = eye_grid(frame);
    CHECK_THAT(grid.arc_minutes_per_pixel, WithinAbs(1, 1e-12));
    INFO("about 60 a degree");
    CHECK_THAT(grid.columns, WithinAbs(60 * angle, 0.03 * 60 * angle));
  }
  INFO("a far view is looked at from where it fills 20 degrees");
  CHECK(eye_grid(frame_of(mesh, Projection::orthographic)).columns == 1213);
}

TEST_CASE("NormalPicture.StaysWithinItsLimits") {
  TriangleMesh mesh = test::icosphere(2);
  CHECK(eye_grid(frame_of(mesh, Projection::perspective, 0.1)).columns == 100);
  mesh.V.col(1) *= 1e6;  // a needle
  const PictureGrid grid = eye_grid(frame_of(mesh, Projection::orthographic));
  CHECK(static_cast<double>(grid.columns) * grid.rows <= 4.1e6);
}

TEST_CASE("NormalPicture.ShowsWhatIsInFront") {
  // Two parallel squares; the nearer one, tilted, hides the other.
  const TriangleMesh back = test::grid(4, 4);
  TriangleMesh front = test::moved(back, Vec3(0, 0, 1));
  for (Eigen::Index i = 0; i < front.V.rows(); ++i) front.V(i, 2) += 0.5 * front.V(i, 0);
  const TriangleMesh mesh = test::joined(back, front);
  const ViewFrame frame = frame_of(mesh, Projection::orthographic);
  Context context;
  const NormalPicture picture = draw_normals(frame, frame.P, mesh.F, eye_grid(frame, 8), context);
  const std::size_t middle = picture.at(picture.grid.rows / 2, picture.grid.columns / 2);
  CHECK_THAT(static_cast<double>(picture.z[middle]), WithinAbs(1 / std::sqrt(1.25), 1e-6));
}

TEST_CASE("SeenDifference.OfTheModelItselfIsNone") {
  const TriangleMesh mesh = test::icosphere(4);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const ViewFrame frame = frame_of(mesh, projection);
    Context context;
    const SeenComparison comparison(frame, mesh.F, 4, context);
    const SeenDifference same = comparison.with(frame.P, context);
    CHECK(same.similarity == 1);
    CHECK(same.false_edges_percent == 0);
    INFO("nor does a uniform scaling from the viewpoint change what is seen");
    const SeenDifference scaled = comparison.with(frame.moved(Eigen::VectorXd::Constant(mesh.V.rows(), 0.3)), context);
    CHECK_THAT(scaled.similarity, WithinAbs(1, 1e-5));
    CHECK(scaled.false_edges_percent == 0);
  }
}

TEST_CASE("SeenDifference.ConvergesAsPixelsShrink") {
  // The window shrinks with the pixels, so that the similarity of a smooth surface tends to that of single points; what
  // one step of the pixels changes must become less and less.
  const TriangleMesh mesh = test::icosphere(5);
  const ViewFrame frame = frame_of(mesh, Projection::orthographic);
  Positions flatter = frame.P;
  flatter.col(2) *= 0.3;
  Context context;
  std::vector<double> values;
  for (const double pixels : {8.0, 4.0, 2.0})
    values.push_back(SeenComparison(frame, mesh.F, pixels, context).with(flatter, context).similarity);
  CHECK(std::abs(values[2] - values[1]) < 0.7 * std::abs(values[1] - values[0]));
  CHECK(std::abs(values[2] - values[1]) < 0.05);
}

TEST_CASE("NormalPicture.HasTheSameBitsWithOneThread") {
  const TriangleMesh mesh = test::icosphere(3);
  const ViewFrame frame = frame_of(mesh, Projection::perspective);
  Context context;
  const NormalPicture several = draw_normals(frame, frame.P, mesh.F, eye_grid(frame, 2), context);
  const ThreadLimit one(1);
  const NormalPicture single = draw_normals(frame, frame.P, mesh.F, eye_grid(frame, 2), context);
  CHECK(several.x == single.x);
  CHECK(several.covered == single.covered);
}

}  // namespace
}  // namespace formwright::normal_picture_tests
