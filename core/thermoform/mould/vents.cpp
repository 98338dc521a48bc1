// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/vents.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"

namespace formwright {
namespace {

constexpr double same_time_s = 1e-6;
constexpr int probes_around = 8;

struct Candidate {
  Vent vent;
  double hollow_mm;  // how far the neighbours of the sheet's vertex lie above it, on average
  int vertex;
};

/// Per vertex: does it belong to a patch of equal lateness that nothing around is later than?
std::vector<char> latest_patches(const Adjacency& adjacency, const Eigen::VectorXd& lateness) {
  std::vector<char> latest(static_cast<std::size_t>(lateness.size()), 0), seen(latest);
  for (int start = 0; start < static_cast<int>(lateness.size()); ++start) {
    if (seen[static_cast<std::size_t>(start)]) continue;
    seen[static_cast<std::size_t>(start)] = 1;
    std::vector<int> patch{start};
    bool highest = true;
    for (std::size_t i = 0; i < patch.size(); ++i)
      for (const int w : adjacency.neighbours(patch[i])) {
        const double difference = lateness[w] - lateness[patch[i]];
        if (difference > same_time_s) highest = false;
        if (std::abs(difference) > same_time_s || seen[static_cast<std::size_t>(w)]) continue;
        seen[static_cast<std::size_t>(w)] = 1;
        patch.push_back(w);
      }
    if (highest)
      for (const int v : patch) latest[static_cast<std::size_t>(v)] = 1;
  }
  return latest;
}

}  // namespace

FormedSheet about_the_model(FormedSheet sheet, const Placement& nominal, const Placement& real) {
  if (real.linear == nominal.linear && real.translation == nominal.translation) return sheet;
  const Eigen::Matrix3d back = nominal.linear * real.linear.inverse();
  const Vec3 shift = nominal.translation - back * real.translation;
  sheet.mesh.V = ((sheet.mesh.V * back.transpose()).rowwise() + shift.transpose()).eval();
  return sheet;
}

std::vector<Vent> find_vents(const TriangleMesh& solid, const FormedSheet& sheet, int count, double diameter_mm,
                             double spacing_mm, Context& context) {
  std::vector<Vent> vents;
  if (count == 0 || solid.F.rows() == 0) return vents;
  const Adjacency adjacency(sheet.mesh);
  const RayCaster caster(solid);
  const double top = std::max(bounding_box(solid).upper.z(), bounding_box(sheet.mesh).upper.z()) + 1;
  const auto ground = [&](double x, double y) {
    const auto hit = caster.first_hit(Vec3(x, y, top), -Vec3::UnitZ(), 0, 2 * top);
    return hit ? top - hit->distance : 0.0;
  };
  const Eigen::Index n = sheet.mesh.V.rows();
  // Lateness: the time of contact; what was never reached comes after everything, the wider the gap the later.
  std::vector<Vent> below(static_cast<std::size_t>(n));
  Eigen::VectorXd lateness(n);
  const double last_s = n > 0 ? std::max(0.0, sheet.contact_s.maxCoeff()) : 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i % 1024 == 0) context.check_cancelled();
    const Vec3 p = sheet.mesh.V.row(i);
    Vent& vent = below[static_cast<std::size_t>(i)];
    vent.position_mm = {p.x(), p.y(), ground(p.x(), p.y())};
    vent.contact_s = sheet.contact_s[i];
    vent.gap_mm = std::max(0.0, p.z() - vent.position_mm.z() - sheet.thickness_mm[i] / 2);
    lateness[i] = vent.contact_s < 0 ? last_s + 1 + vent.gap_mm : vent.contact_s;
  }
  const double clear_mm = 1.5 * diameter_mm;  // around the axis there must be model
  const std::vector<char> latest = latest_patches(adjacency, lateness);
  std::vector<Candidate> candidates;
  for (int v = 0; v < static_cast<int>(n); ++v) {
    const Vent& vent = below[static_cast<std::size_t>(v)];
    if (adjacency.is_boundary_vertex(v) || vent.position_mm.z() <= 0) continue;  // the plate has its own holes
    const auto ring = adjacency.neighbours(v);
    if (!latest[static_cast<std::size_t>(v)]) continue;
    double hollow = 0;
    for (const int w : ring) hollow += (sheet.mesh.V(w, 2) - sheet.mesh.V(v, 2)) / static_cast<double>(ring.size());
    bool within = true;
    for (int k = 0; k < probes_around && within; ++k) {
      const double angle = 2 * std::numbers::pi * k / probes_around;
      within = ground(vent.position_mm.x() + clear_mm * std::cos(angle),
                      vent.position_mm.y() + clear_mm * std::sin(angle)) > 0;
    }
    if (within) candidates.push_back({vent, hollow, v});
  }
  // Times closer than a millisecond are one event; then hollows before plains.
  std::ranges::sort(candidates, {}, [&](const Candidate& c) {
    return std::tuple(-std::round(lateness[c.vertex] * 1e3), -c.hollow_mm, c.vertex);
  });
  const double apart_mm = std::max(spacing_mm, 2 * diameter_mm);
  for (const Candidate& candidate : candidates) {
    if (static_cast<int>(vents.size()) == count) break;
    const auto near = [&](const Vent& other) {
      return (other.position_mm - candidate.vent.position_mm).head<2>().norm() < apart_mm;
    };
    if (std::ranges::none_of(vents, near)) vents.push_back(candidate.vent);
  }
  return vents;
}

}  // namespace formwright
