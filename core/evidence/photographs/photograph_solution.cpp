// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/photographs/photograph_solution.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/index.h"
#include "base/statistics.h"
#include "evidence/photographs/camera_start.h"

namespace formwright {
namespace {

constexpr int min_board_marks_seen = 4;
constexpr int min_strips_seen = 2;
constexpr std::array<double, 4> usual_focal_lengths{0.75, 0.55, 1.1, 2.0};  // of the picture's longer side
constexpr int start_iterations = 15, iterations = 60;
constexpr double outlier_distance = 4.5;      // usual distances
constexpr double min_start_angle_rad = 0.01;  // between two rays of a point
constexpr double worst_start_px = 0.01;       // of the longer side: what a point may be off before the adjustment
constexpr double worst_camera_px = 0.004;     // of the longer side: RMS of a photograph in which the board has moved

const char* const board_in_view = "keep the strips on the clamp frame in view, all four if possible";

/// A photograph's view of the board as a map from the machine's x and y to pixels from the picture's middle; marks that
/// do not fit it are left out.
std::optional<PlaneMap> board_map(const ReadPhotograph& read, const Bundle& bundle,
                                  const std::vector<BundleObservation>& seen) {
  std::vector<Vec2> from, to;
  for (const BundleObservation& o : seen) {
    from.push_back(bundle.strip_origin_mm[index(o.strip)] + o.from_origin_mm);
    to.push_back(o.picture_px - 0.5 * Vec2(read.width, read.height));
  }
  for (int round = 0; round < 4; ++round) {
    const auto map = fit_plane_map(from, to);
    if (!map) return std::nullopt;
    std::vector<double> distance(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) distance[i] = ((*map)(from[i]) - to[i]).norm();
    const double limit = std::max(0.01 * std::max(read.width, read.height), 4 * median(distance));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < from.size(); ++i)
      if (distance[i] <= limit) {
        from[kept] = from[i];
        to[kept++] = to[i];
      }
    if (kept == from.size()) return map;
    from.resize(kept);
    to.resize(kept);
  }
  return fit_plane_map(from, to);
}

/// Sets lenses and poses; false where a photograph has none with these focal lengths.
bool start_cameras(Bundle& bundle, const std::vector<PlaneMap>& maps, const std::vector<double>& focal_px) {
  for (std::size_t i = 0; i < bundle.lenses.size(); ++i) {
    Lens& lens = bundle.lenses[i];
    lens.focal_px = focal_px[i];
    lens.centre_px = 0.5 * Vec2(lens.width, lens.height);
    lens.k1 = lens.k2 = 0;
  }
  for (std::size_t i = 0; i < bundle.cameras.size(); ++i) {
    const auto pose = pose_of_map(maps[i], focal_px[index(bundle.cameras[i].lens)], bundle.board_z_mm);
    if (!pose) return false;
    bundle.cameras[i].pose = *pose;
  }
  return true;
}

/// The board alone, from several focal lengths; the best fit is kept.
void solve_board(Bundle& bundle, const std::vector<PlaneMap>& maps, const Context& context) {
  std::vector<std::vector<double>> starts;
  std::vector<double> found;
  for (std::size_t k = 0; k < bundle.lenses.size(); ++k) {
    std::vector<PlaneMap> own;
    for (std::size_t i = 0; i < maps.size(); ++i)
      if (bundle.cameras[i].lens == static_cast<int>(k)) own.push_back(maps[i]);
    const double scale = bundle.lenses[k].scale_px();
    found.push_back(focal_of_maps(own, scale).value_or(usual_focal_lengths[0] * scale));
  }
  starts.push_back(found);
  for (const double usual : usual_focal_lengths) {
    starts.emplace_back();
    for (const Lens& lens : bundle.lenses) starts.back().push_back(usual * lens.scale_px());
  }
  std::optional<Bundle> best;
  double best_noise = 0;
  for (const std::vector<double>& start : starts) {
    Bundle trial = bundle;
    if (!start_cameras(trial, maps, start)) continue;
    try {
      const BundleFit fit = adjust_bundle(trial, true, false, start_iterations, context);
      if (std::isfinite(fit.noise) && (!best || fit.noise < 0.999 * best_noise)) {
        best_noise = fit.noise;
        best = trial;
      }
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
    }
  }
  if (!best)
    throw Error(
        ErrorCode::could_not_solve, "photograph",
        "The cameras could not be found from the board: lay the strips as board.pdf says and take more photographs, from all sides.");
  bundle = *best;
}

std::vector<SightRay> rays_of(const Bundle& bundle, const std::vector<const BundleObservation*>& seen) {
  std::vector<SightRay> rays;
  for (const BundleObservation* o : seen) {
    const BundleCamera& camera = bundle.cameras[index(o->camera)];
    if (const auto ray = bundle.lenses[index(camera.lens)].ray(o->picture_px))
      rays.push_back({camera.pose.centre(), (camera.pose.rotation.transpose() * *ray).normalized()});
  }
  return rays;
}

double distance_px(const Bundle& bundle, const BundleObservation& o, const Vec3& point) {
  const BundleCamera& camera = bundle.cameras[index(o.camera)];
  const auto at = project(bundle.lenses[index(camera.lens)], camera.pose, point);
  return at ? (*at - o.picture_px).norm() : 1e9;
}

/// The point that most of its observations agree on; others of them are put out of use. None with fewer than two left.
std::optional<Vec3> start_point(const Bundle& bundle, std::vector<BundleObservation*> seen) {
  while (seen.size() >= 2) {
    const auto point = nearest_point(rays_of(bundle, {seen.begin(), seen.end()}));
    if (!point) return std::nullopt;
    std::size_t worst = 0;
    double most = -1;
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (const double d = distance_px(bundle, *seen[i], *point); d > most) {
        most = d;
        worst = i;
      }
    if (most <= worst_start_px * bundle.lenses[0].scale_px()) return point;
    if (seen.size() == 2) return std::nullopt;
    seen[worst]->used = false;
    seen.erase(seen.begin() + static_cast<std::ptrdiff_t>(worst));
  }
  return std::nullopt;
}

/// Removes points that fewer than two photographs see, and their observations.
void drop_weak_points(PhotographSolution& solution) {
  Bundle& b = solution.bundle;
  std::vector<std::set<int>> cameras(b.points.size());
  for (const BundleObservation& o : b.observations)
    if (o.used && o.point >= 0) cameras[index(o.point)].insert(o.camera);
  std::vector<int> renumbered(b.points.size(), -1);
  std::vector<Vec3> points;
  for (std::size_t p = 0; p < b.points.size(); ++p)
    if (cameras[p].size() >= 2) {
      renumbered[p] = static_cast<int>(points.size());
      points.push_back(b.points[p]);
    }
  b.points = std::move(points);
  std::erase_if(b.observations,
                [&](const BundleObservation& o) { return o.point >= 0 && renumbered[index(o.point)] < 0; });
  for (BundleObservation& o : b.observations)
    if (o.point >= 0) o.point = renumbered[index(o.point)];
  for (int& p : solution.point_of_corner)
    if (p >= 0) p = renumbered[index(p)];
}

/// Puts observations out of use that are far off by the usual distance. Returns how many.
int drop_outliers(Bundle& bundle, double noise) {
  int count = 0;
  for (BundleObservation& o : bundle.observations)
    if (o.used && whitened_distance(bundle, o) > outlier_distance * noise) {
      o.used = false;
      ++count;
    }
  return count;
}

struct BoardView {
  int photograph;
  std::vector<BundleObservation> seen;
  PlaneMap map;
};

std::vector<BundleObservation> board_observations(const ReadPhotograph& read, const MarkSheet& sheet, double scale) {
  std::vector<BundleObservation> list;
  for (const ReadPhotograph::OnBoard& m : read.board) {
    const BoardStrip& strip = sheet.strips[index(m.strip)];
    for (int c = 0; c < 4; ++c) {
      BundleObservation o;
      o.strip = m.strip;
      o.from_origin_mm = scale * (strip.machine_mm(strip.marks[index(m.mark)].corner_mm(c)) - strip.origin_mm);
      o.picture_px = m.corners.corner_px[index(c)];
      o.covariance_px2 = m.corners.covariance_px2[index(c)];
      list.push_back(o);
    }
  }
  return list;
}

/// Photographs that show enough of the board.
std::vector<BoardView> board_views(const std::vector<ReadPhotograph>& photographs, const MarkSheet& sheet,
                                   const Bundle& bundle, double scale, std::vector<std::string>& notes) {
  std::vector<BoardView> views;
  std::string first_without;
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const ReadPhotograph& read = photographs[i];
    std::set<int> strips;
    for (const ReadPhotograph::OnBoard& m : read.board) strips.insert(m.strip);
    BoardView view{static_cast<int>(i), board_observations(read, sheet, scale), {}};
    std::optional<PlaneMap> map;
    if (static_cast<int>(read.board.size()) >= min_board_marks_seen &&
        static_cast<int>(strips.size()) >= min_strips_seen)
      map = board_map(read, bundle, view.seen);
    if (!map) {
      if (first_without.empty()) first_without = read.file_name;
      notes.push_back(read.file_name + " was left out, because it shows " + std::to_string(read.board.size()) +
                      " marks of " + std::to_string(strips.size()) + " strips of the board: " + board_in_view + ".");
      continue;
    }
    view.map = *map;
    views.push_back(std::move(view));
  }
  if (views.size() < 2)
    throw Error(ErrorCode::invalid_input, "photograph",
                std::string(views.empty() ? "None of the photographs shows" : "Only one of the photographs shows") +
                    " enough of the printed board, four marks on two strips at least (see " + first_without +
                    "): " + board_in_view + ".");
  return views;
}

void set_up_cameras(PhotographSolution& solution, const std::vector<ReadPhotograph>& photographs,
                    const std::vector<BoardView>& views) {
  Bundle& b = solution.bundle;
  b.lenses.clear();
  b.cameras.clear();
  b.observations.clear();
  solution.photograph_of_camera.clear();
  for (const BoardView& view : views) {
    const ReadPhotograph& read = photographs[index(view.photograph)];
    auto lens = std::find_if(b.lenses.begin(), b.lenses.end(),
                             [&](const Lens& l) { return l.width == read.width && l.height == read.height; });
    if (lens == b.lenses.end()) {
      b.lenses.push_back({read.width, read.height});
      lens = b.lenses.end() - 1;
    }
    b.cameras.push_back({static_cast<int>(lens - b.lenses.begin()), {}});
    for (BundleObservation o : view.seen) {
      o.camera = static_cast<int>(b.cameras.size()) - 1;
      b.observations.push_back(o);
    }
    solution.photograph_of_camera.push_back(view.photograph);
  }
}

/// Photographs in which the board does not lie as in the others.
std::vector<int> moved_cameras(const Bundle& bundle) {
  std::vector<std::vector<double>> distance(bundle.cameras.size());
  for (const BundleObservation& o : bundle.observations)
    distance[index(o.camera)].push_back(distance_px(bundle, o, bundle.place_mm(o)));
  std::vector<int> moved;
  for (std::size_t i = 0; i < distance.size(); ++i)
    if (median(distance[i]) > worst_camera_px * bundle.lenses[index(bundle.cameras[i].lens)].scale_px())
      moved.push_back(static_cast<int>(i));
  return moved;
}

void add_sheet_points(PhotographSolution& solution, const std::vector<ReadPhotograph>& photographs,
                      const MarkSheet& sheet) {
  Bundle& b = solution.bundle;
  std::vector<std::vector<BundleObservation>> of_corner(4 * sheet.marks.size());
  for (std::size_t i = 0; i < b.cameras.size(); ++i)
    for (const ReadPhotograph::OnSheet& m : photographs[index(solution.photograph_of_camera[i])].sheet)
      for (std::size_t c = 0; c < 4; ++c) {
        BundleObservation o;
        o.camera = static_cast<int>(i);
        o.picture_px = m.corners.corner_px[c];
        o.covariance_px2 = m.corners.covariance_px2[c];
        o.shared_px = m.corners.shared_px[c];
        of_corner[4 * index(m.mark) + c].push_back(o);
      }
  solution.point_of_corner.assign(of_corner.size(), -1);
  for (std::size_t corner = 0; corner < of_corner.size(); ++corner) {
    std::vector<BundleObservation*> seen;
    for (BundleObservation& o : of_corner[corner]) seen.push_back(&o);
    const auto point = start_point(b, seen);
    if (!point) continue;
    // Photographs from one place say nothing about distance, and would make the equations singular.
    std::vector<const BundleObservation*> kept;
    for (const BundleObservation& o : of_corner[corner])
      if (o.used) kept.push_back(&o);
    if (widest_angle_rad(rays_of(b, kept)) < min_start_angle_rad) {
      solution.narrow_marks.insert(static_cast<int>(corner / 4));
      continue;
    }
    solution.point_of_corner[corner] = static_cast<int>(b.points.size());
    for (BundleObservation& o : of_corner[corner]) {
      o.point = static_cast<int>(b.points.size());
      b.observations.push_back(o);
      solution.outliers += o.used ? 0 : 1;
    }
    b.points.push_back(*point);
  }
}

void finish_report(PhotographSolution& solution) {
  const Bundle& b = solution.bundle;
  std::vector<std::vector<const BundleObservation*>> of_point(b.points.size());
  std::vector<double> squares(b.cameras.size()), count(b.cameras.size());
  for (const BundleObservation& o : b.observations) {
    if (!o.used) continue;
    if (o.point >= 0) of_point[index(o.point)].push_back(&o);
    const double d = distance_px(b, o, b.place_mm(o));
    squares[index(o.camera)] += d * d / 2;
    count[index(o.camera)] += 1;
  }
  for (const auto& seen : of_point) {
    solution.angle_rad.push_back(widest_angle_rad(rays_of(b, seen)));
    double sum = 0;
    for (const BundleObservation* o : seen) sum += o->shared_px;
    solution.shared_px.push_back(seen.empty() ? 0 : sum / static_cast<double>(seen.size()));
  }
  for (std::size_t i = 0; i < squares.size(); ++i)
    solution.camera_rms_px.push_back(count[i] > 0 ? std::sqrt(squares[i] / count[i]) : 0);
}

}  // namespace

PhotographSolution solve_photographs(const std::vector<ReadPhotograph>& photographs, const MarkSheet& sheet,
                                     double board_scale, double board_z_mm, std::vector<std::string>& notes,
                                     Context& context) {
  PhotographSolution solution;
  Bundle& b = solution.bundle;
  b.board_z_mm = board_z_mm;
  for (std::size_t k = 0; k < 4; ++k) b.strip_origin_mm[k] = sheet.strips[k].origin_mm;
  std::vector<BoardView> views = board_views(photographs, sheet, b, board_scale, notes);
  context.progress(0.05, "Finding the cameras");
  for (bool again = true; again;) {
    again = false;
    set_up_cameras(solution, photographs, views);
    std::vector<PlaneMap> maps;
    for (const BoardView& view : views) maps.push_back(view.map);
    b.strips = {};
    solve_board(b, maps, context);
    const std::vector<int> moved = moved_cameras(b);
    if (moved.empty()) break;
    if (views.size() - moved.size() < 2)
      throw Error(
          ErrorCode::could_not_solve, "photograph",
          "The strips of the board do not lie alike in the photographs: fix them with tape, keep them flat, and take the photographs again.");
    for (auto camera = moved.rbegin(); camera != moved.rend(); ++camera) {
      notes.push_back(photographs[index(views[index(*camera)].photograph)].file_name +
                      " was left out, because the board does not lie in it as in the others, or was misread.");
      views.erase(views.begin() + *camera);
    }
    again = true;
  }
  context.progress(0.3, "Finding points and cameras together");
  add_sheet_points(solution, photographs, sheet);
  drop_weak_points(solution);
  solution.fit = adjust_bundle(b, true, false, iterations, context);
  for (int round = 0; round < 3; ++round) {
    context.progress(0.6 + 0.1 * round);
    const int dropped = drop_outliers(b, std::max(solution.fit.noise, 1e-9));
    solution.outliers += dropped;
    drop_weak_points(solution);
    solution.fit = adjust_bundle(b, false, false, iterations, context);
    if (dropped == 0) break;
  }
  if (b.points.empty())
    throw Error(ErrorCode::could_not_solve, "photograph",
                "No mark of the sheet was seen in two photographs: take more of them, with much of the sheet in each.");
  context.progress(0.9, "How sure the points are");
  solution.fit = adjust_bundle(b, false, true, iterations, context);
  finish_report(solution);
  return solution;
}

}  // namespace formwright
