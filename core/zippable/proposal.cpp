// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/proposal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/paths/geodesic_distance.h"
#include "zippable/parts/handles.h"
#include "zippable/parts/limb_tips.h"
#include "zippable/parts/slit.h"
#include "zippable/parts/surface_split.h"
#include "zippable/curve/traversal.h"

namespace formwright {
namespace {

struct Seed {
  std::vector<int> vertices;  // one vertex, or all of an opening
  bool opening = false;
  double prominence = 0;  // mm of mean distance; openings stay whatever theirs
  double reach_mm = 0;    // along the limb, from the tip to where it ends
};

/// What a millimetre counts for where found borders are to run in valleys.
Eigen::VectorXd valley_slowness(const TriangleMesh& mesh, const Adjacency& adjacency, const ProposalOptions& options,
                                Context& context) {
  const FeatureLines lines = find_features(mesh, adjacency, options.features, context);
  return 1 + 4 * (lines.valley_rad.array() / options.features.min_rad).min(4).square();
}

std::vector<Seed> find_seeds(const TriangleMesh& mesh, const Adjacency& adjacency, const ProposalOptions& options,
                             const Eigen::VectorXd& slowness, Context& context) {
  std::vector<Seed> seeds;
  for (auto& loop : boundary_loops(adjacency))
    seeds.push_back({std::move(loop), true, std::numeric_limits<double>::infinity(), 0});
  if (!options.tips_mm.empty() || !options.cuts_mm.empty()) {
    for (const Vec3& tip : options.tips_mm) {
      Eigen::Index nearest = 0;
      (mesh.V.rowwise() - tip.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
      const bool taken = std::any_of(seeds.begin(), seeds.end(), [&](const Seed& seed) {
        return std::find(seed.vertices.begin(), seed.vertices.end(), nearest) != seed.vertices.end();
      });
      if (taken)
        throw Error(ErrorCode::invalid_input, "segments",
                    "Two holes lie on the same vertex or opening: move one, or subdivide the model.");
      seeds.push_back({{static_cast<int>(nearest)}, false, 0, 0});
    }
    if (seeds.size() < 2)
      throw Error(ErrorCode::invalid_input, "segments", "One hole does not make a cylinder: give at least two.");
    return seeds;
  }
  const Eigen::VectorXd mean = mean_distance_mm(mesh, adjacency, context);
  for (const LimbTip& tip : prominent_maxima(adjacency, mean, options.prominence * mean.maxCoeff())) {
    if (static_cast<int>(seeds.size()) >= std::max(options.parts_max, 2)) break;
    bool beside = adjacency.is_boundary_vertex(tip.vertex);
    for (const int w : adjacency.neighbours(tip.vertex)) beside |= adjacency.is_boundary_vertex(w);
    if (beside) continue;  // an opening is there already
    Seed seed{{tip.vertex}, false, tip.prominence, 0};
    if (tip.saddle >= 0) seed.reach_mm = geodesic_distance_mm(mesh, adjacency, seed.vertices, slowness)[tip.saddle];
    seeds.push_back(std::move(seed));
  }
  if (options.parts_max < 3 && seeds.size() > 2 && !seeds[1].opening) seeds.resize(2);
  while (seeds.size() < 2) {  // a ball: opposite ends
    std::vector<int> all;
    for (const Seed& seed : seeds) all.insert(all.end(), seed.vertices.begin(), seed.vertices.end());
    Eigen::VectorXd distance = geodesic_distance_mm(mesh, adjacency, all);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      bool beside = adjacency.is_boundary_vertex(v);
      for (const int w : adjacency.neighbours(v)) beside |= adjacency.is_boundary_vertex(w);
      if (beside || !std::isfinite(distance[v])) distance[v] = -1;
    }
    Eigen::Index farthest = 0;
    distance.maxCoeff(&farthest);
    seeds.push_back({{static_cast<int>(farthest)}, false, 0, 0});
  }
  return seeds;
}

void puncture_all(Proposal& proposal, LabelledSurface& surface, const std::vector<int>& places,
                  const ProposalOptions& options) {
  for (const int v : places) proposal.punctures.push_back(surface.mesh.V.row(v).transpose());
  proposal.puncture_radius_mm = puncture(surface, places, options.puncture_radius_mm);
}

/// Parts around the seeds by `distance` (n x seeds or more), less `reach_share` of each seed's reach; punctured at the
/// tips.
Proposal divide(const TriangleMesh& mesh, const std::vector<Seed>& seeds, const Eigen::MatrixXd& distance,
                double reach_share, const ProposalOptions& options) {
  LabelledSurface surface;
  const int parts = seeds.size() == 2 ? 1 : static_cast<int>(seeds.size());
  if (parts == 1) {
    surface = {mesh, std::vector<int>(mesh.face_count(), 0)};
  } else {
    Eigen::MatrixXd field = distance.leftCols(parts);
    for (int k = 0; k < parts; ++k) field.col(k).array() -= reach_share * seeds[k].reach_mm;
    std::vector<int> label(mesh.vertex_count());
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      Eigen::Index minimum = 0;
      field.row(v).minCoeff(&minimum);
      label[v] = static_cast<int>(minimum);
    }
    for (std::size_t k = 0; k < seeds.size(); ++k)
      for (const int v : seeds[k].vertices) label[v] = static_cast<int>(k);
    surface = split_by_smallest_field(mesh, label, field);
  }
  Proposal proposal;
  std::vector<int> places;
  for (const Seed& seed : seeds)
    if (!seed.opening) places.push_back(seed.vertices.front());
  puncture_all(proposal, surface, places, options);
  proposal.segmentation = make_segmentation(surface.mesh, surface.face_label);
  return proposal;
}

/// What the curves bound, punctured.
Proposal drawn(const TriangleMesh& mesh, const ProposalOptions& options, Context& context) {
  Proposal proposal;
  std::optional<SnapTargets> targets;
  if (std::any_of(options.curves.begin(), options.curves.end(),
                  [&](const DrawnCurve& c) { return c.snap.value_or(options.follow_creases); }))
    targets = SnapTargets{find_features(mesh, Adjacency(mesh), options.features, context), options.snap_reach_mm,
                          options.follow_creases};
  LabelledSurface surface = divide_along_curves(mesh, options.curves, targets ? &*targets : nullptr, context);
  const int parts = 1 + *std::max_element(surface.face_label.begin(), surface.face_label.end());
  const Adjacency adjacency(surface.mesh);
  std::vector<int> places;
  for (int part = 0; part < parts; ++part) {
    int place = puncture_place(surface, part);
    if (place < 0) continue;
    for (const Vec3& tip : options.tips_mm) {
      Eigen::Index nearest = 0;
      (surface.mesh.V.rowwise() - tip.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
      const int v = static_cast<int>(nearest);
      const auto faces = adjacency.outgoing(v);
      if (!faces.empty() &&
          std::all_of(faces.begin(), faces.end(), [&](int h) { return surface.face_label[h / 3] == part; }))
        place = v;
    }
    places.push_back(place);
  }
  puncture_all(proposal, surface, places, options);
  proposal.segmentation = make_segmentation(surface.mesh, surface.face_label);
  if (options.accept_all_parts) return proposal;
  std::string problems;
  for (int part = 0; part < proposal.segmentation.part_count(); ++part)
    if (!proposal.segmentation.problems[part].empty())
      problems += (problems.empty() ? "Part " : " Part ") + std::to_string(part + 1) +
                  " of the curves is not a cylinder. " + proposal.segmentation.problems[part];
  if (!problems.empty()) throw Error(ErrorCode::invalid_input, "segments", problems);
  if (traversals(proposal.segmentation, context, 1).empty())
    throw Error(ErrorCode::invalid_input, "segments",
                "The zipper cannot visit every drawn part once: let more of the parts share a border.");
  return proposal;
}

void note_cuts(Proposal& proposal, OpenedSurface& opened, const TriangleMesh& given) {
  for (const auto& loop : opened.cuts) {
    proposal.taped_cuts.push_back({{}, true});
    for (const int v : loop) proposal.taped_cuts.back().points_mm.push_back(given.V.row(v).transpose());
  }
  for (const auto& slit : opened.slits) proposal.taped_cuts.push_back({slit, false});
  proposal.handles_cut = static_cast<int>(opened.cuts.size());
  proposal.handle_cuts = std::move(opened.cuts);
  if (proposal.handles_cut > 0)
    proposal.notes.push_back(std::to_string(proposal.handles_cut) +
                             (proposal.handles_cut == 1 ? " handle was" : " handles were") +
                             " cut open: close the cut with hook-and-loop tape.");
  if (!opened.slits.empty())
    proposal.notes.push_back("Between openings " + std::to_string(opened.slits.size()) +
                             (opened.slits.size() == 1 ? " slit was" : " slits were") +
                             " cut, so that there are fewer of them: close these with hook-and-loop tape, too.");
}

/// Parts around openings and tips, the least prominent tips given up one by one; nothing when only openings are left to
/// give up.
std::optional<Proposal> automatic(const OpenedSurface& opened, const ProposalOptions& options, Context& context,
                                  std::string& problem) {
  const Adjacency adjacency(opened.mesh);
  Eigen::VectorXd slowness;
  if (options.follow_creases) slowness = valley_slowness(opened.mesh, adjacency, options, context);
  std::vector<Seed> seeds = find_seeds(opened.mesh, adjacency, options, slowness, context);
  const std::size_t found = seeds.size();
  Eigen::MatrixXd distance(opened.mesh.vertex_count(), static_cast<Eigen::Index>(found));
  parallel_for(found, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      distance.col(static_cast<Eigen::Index>(k)) =
          geodesic_distance_mm(opened.mesh, adjacency, seeds[k].vertices, slowness);
  });
  // Where limbs end first; but then one part may surround others and be no cylinder, which plain nearness seldom does.
  constexpr std::array reach_shares{1.0, 0.5, 0.25, 0.0};
  for (std::size_t attempt = 0;; ++attempt) {
    context.check_cancelled();
    problem = "no order visits every part once";
    try {
      Proposal proposal = divide(opened.mesh, seeds, distance, reach_shares[attempt % reach_shares.size()], options);
      if (proposal.segmentation.valid() && !traversals(proposal.segmentation, context, 1).empty()) {
        if (seeds.size() < found)
          proposal.notes.push_back("Of " + std::to_string(found) + " tips and openings " +
                                   std::to_string(seeds.size()) +
                                   " became parts; the others could not be made into cylinders.");
        return proposal;
      }
      for (const std::string& p : proposal.segmentation.problems)
        if (!p.empty()) problem = p;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::invalid_input) throw;
      problem = error.what();
    }
    if (attempt % reach_shares.size() + 1 < reach_shares.size() && seeds.size() > 2) continue;
    if (!options.tips_mm.empty() || !options.cuts_mm.empty())
      throw Error(ErrorCode::invalid_input, "segments",
                  "The given holes do not divide the model into cylinders (" + problem + "): move, add or drop some.");
    if (seeds.size() <= 2 || seeds.back().opening) return std::nullopt;
    seeds.pop_back();
  }
}

}  // namespace

Proposal propose_segmentation(const TriangleMesh& mesh, const ProposalOptions& options, Context& context) {
  const Adjacency given(mesh);
  if (!given.is_manifold())
    throw Error(ErrorCode::invalid_input, "mesh", "The mesh is not a manifold: repair it first.");
  if (face_components(given).count != 1)
    throw Error(ErrorCode::invalid_input, "mesh",
                "The model is in several separate pieces: make each a zippable of its own.");
  context.progress(0, "Looking for limbs");
  OpenedSurface opened = cut_handles(mesh, context);
  const auto slits = cut_slits(opened, options.cuts_mm, context);
  if (!options.curves.empty()) {
    Proposal proposal = drawn(opened.mesh, options, context);
    note_cuts(proposal, opened, mesh);
    proposal.slits = slits;
    return proposal;
  }
  // One cylinder has two openings at most; slits between openings make fewer of them.
  const auto maximum = static_cast<std::size_t>(std::max(2, options.parts_max));
  while (boundary_loops(Adjacency(opened.mesh)).size() > maximum && join_nearest_openings(opened, context)) {}
  for (;;) {
    std::string problem;
    if (std::optional<Proposal> proposal = automatic(opened, options, context, problem)) {
      note_cuts(*proposal, opened, mesh);
      proposal->slits = slits;
      return std::move(*proposal);
    }
    if (boundary_loops(Adjacency(opened.mesh)).size() < 3 || !join_nearest_openings(opened, context))
      throw Error(ErrorCode::invalid_input, "mesh",
                  "The model could not be divided into cylinders (" + problem +
                      "): close its holes, or give the parts in segments.json.");
  }
}

}  // namespace formwright
