// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/contact/point_contacts.h"

#include <algorithm>
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "geometry/queries/point_distance.h"

namespace formwright {
namespace {

constexpr double offset_cells = 1 << 19;
constexpr double share_beside = 0.02;  // of a slid contact's stiffness along the face: about the sheet's own
constexpr char met = 1, settled = 2;   // of points: in the step that is being tried, or before it

std::uint64_t key(int x, int y, int z) {
  return static_cast<std::uint64_t>(z & 0xfffff) << 40 | static_cast<std::uint64_t>(y & 0xfffff) << 20 |
         static_cast<std::uint64_t>(x & 0xfffff);
}
int cell_of(double value, double size) {
  return static_cast<int>(std::clamp(std::floor(value / size) + offset_cells, 0.0, 2 * offset_cells - 1));
}

/// First moment at which a triangle, its corners going straight from a to b, comes within `radius` of `q`.
struct Touch {
  double fraction;
  Vec3 barycentric;
};
Vec3 on_face(const PointContact& contact, const Triangles& F, const Positions& x) {
  Vec3 here = Vec3::Zero();
  for (int k = 0; k < 3; ++k) here += contact.barycentric[k] * x.row(F(contact.face, k)).transpose();
  return here;
}
Vec3 face_normal(int face, const Triangles& F, const Positions& x) {
  const Vec3 a = x.row(F(face, 0)), b = x.row(F(face, 1)), c = x.row(F(face, 2));
  return (b - a).cross(c - a).normalized();
}
std::optional<Touch> first_touch(const Vec3& q, const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b,
                                 double radius, double tolerance) {
  double speed = 0;
  for (std::size_t k = 0; k < 3; ++k) speed = std::max(speed, (b[k] - a[k]).norm());
  double t = 0;
  for (;;) {
    const Vec3 c[3] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
    const NearestPoint nearest = nearest_on_triangle(q, c[0], c[1], c[2]);
    const double clear = nearest.distance - radius;
    if (clear <= tolerance) return Touch{t, nearest.barycentric};
    if (clear - tolerance > speed * (1 - t)) return std::nullopt;
    t = std::min(1.0, t + 0.999 * clear / speed);
  }
}

/// A disc about a triangle: nearer to a point than the triangle, and sooner asked.
class Disc {
 public:
  explicit Disc(const std::array<Vec3, 3>& corner)
      : middle_((corner[0] + corner[1] + corner[2]) / 3),
        normal_((corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized()) {
    for (const Vec3& c : corner) radius_ = std::max(radius_, (c - middle_).norm());
  }
  double distance(const Vec3& q) const {
    const Vec3 away = q - middle_;
    const double height = away.dot(normal_),
                 beside = std::max(0.0, std::sqrt(std::max(0.0, away.squaredNorm() - height * height)) - radius_);
    return std::sqrt(height * height + beside * beside);
  }

 private:
  Vec3 middle_, normal_;
  double radius_ = 0;
};

}  // namespace

PointContacts::PointContacts(std::vector<Vec3> points, double cell_mm, double stiffness)
    : points_(std::move(points)), used_(points_.size()), cell_mm_(cell_mm), stiffness_(stiffness) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3& p = points_[i];
    cells_.push_back(
        {key(cell_of(p.x(), cell_mm_), cell_of(p.y(), cell_mm_), cell_of(p.z(), cell_mm_)), static_cast<int>(i)});
  }
  std::sort(cells_.begin(), cells_.end(),
            [](const Cell& a, const Cell& b) { return a.key != b.key ? a.key < b.key : a.point < b.point; });
}

template <class Visit>
void PointContacts::collect(const Vec3& lower, const Vec3& upper, Visit&& visit) const {
  const int x0 = cell_of(lower.x(), cell_mm_), x1 = cell_of(upper.x(), cell_mm_);
  for (int z = cell_of(lower.z(), cell_mm_); z <= cell_of(upper.z(), cell_mm_); ++z)
    for (int y = cell_of(lower.y(), cell_mm_); y <= cell_of(upper.y(), cell_mm_); ++y) {
      const std::uint64_t last = key(x1, y, z);
      for (auto it = std::lower_bound(cells_.begin(), cells_.end(), key(x0, y, z),
                                      [](const Cell&c, std::uint64_t k) { return c.key < k; });
           it != cells_.end() && it->key <= last; ++it) {
        const Vec3& q = points_[static_cast<std::size_t>(it->point)];
        if ((q.array() >= lower.array()).all() && (q.array() <= upper.array()).all()) visit(it->point);
      }
    }
}

void PointContacts::survey(const std::array<Vec3, 3>& corner, double reach_mm, Neighbourhood& around) const {
  around.place = corner;
  around.reach_mm = reach_mm;
  around.points.clear();
  const Disc disc(corner);
  const Vec3 lower = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]),
             upper = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
  collect(lower.array() - reach_mm, upper.array() + reach_mm, [&](int point) {
    if (used_[static_cast<std::size_t>(point)] == settled) return;
    const double distance = disc.distance(points_[static_cast<std::size_t>(point)]);
    if (distance < reach_mm) around.points.push_back({distance, point});
  });
  std::sort(around.points.begin(), around.points.end(), [](const auto& a, const auto& b) {
    return a.distance_mm != b.distance_mm ? a.distance_mm < b.distance_mm : a.point < b.point;
  });
}

void PointContacts::look(const Triangles& F, int face, const Positions& from, const Positions& to, double radius_mm,
                         const HeldVertices& held, double tolerance_mm, const std::function<double(int)>& clear_mm,
                         std::vector<Candidate>& found) {
  const auto at = static_cast<std::size_t>(face);
  bool all_held = true;
  for (int k = 0; k < 3; ++k) all_held &= held[static_cast<std::size_t>(F(face, k))] != 0;
  if (all_held) return;
  std::array<Vec3, 3> a, b;
  double motion_mm = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = from.row(F(face, static_cast<int>(k)));
    b[k] = to.row(F(face, static_cast<int>(k)));
    motion_mm = std::max(motion_mm, (b[k] - a[k]).squaredNorm());
  }
  motion_mm = std::sqrt(motion_mm);
  const double reach = radius_mm + tolerance_mm;
  Vec3 lower = a[0].cwiseMin(b[0]), upper = a[0].cwiseMax(b[0]);
  for (std::size_t k = 1; k < 3; ++k) {
    lower = lower.cwiseMin(a[k]).cwiseMin(b[k]);
    upper = upper.cwiseMax(a[k]).cwiseMax(b[k]);
  }
  lower.array() -= reach;
  upper.array() += reach;
  std::optional<Disc> disc;
  const auto try_point = [&](int point) {
    const Vec3& q = points_[static_cast<std::size_t>(point)];
    if (used_[static_cast<std::size_t>(point)] || (q.array() < lower.array()).any() ||
        (q.array() > upper.array()).any())
      return;
    if (!disc) disc.emplace(a);
    if (disc->distance(q) > motion_mm + reach) return;
    const auto touch = first_touch(q, a, b, radius_mm, tolerance_mm);
    if (!touch) return;
    Vec3 place = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(k);
      place += touch->barycentric[k] * (a[corner] + touch->fraction * (b[corner] - a[corner]));
    }
    found.push_back({touch->fraction, {point, face, touch->barycentric, place, touch->fraction}});
  };
  // Half a thickness more than it takes today: the face may become thicker until it is looked at again.
  const auto due_at = [&](double distance_mm) { due_mm_[at] = travelled_mm_ + distance_mm - reach - radius_mm; };

  Neighbourhood& around = around_[at];
  double moved = 0;
  for (std::size_t k = 0; k < 3; ++k) moved = std::max(moved, (a[k] - around.place[k]).squaredNorm());
  moved = std::sqrt(moved);
  if (around.reach_mm < moved + motion_mm + reach) {
    // Nowhere is a triangle farther from its corners than its longest side over the root of three.
    const double side = std::max({(a[1] - a[0]).norm(), (a[2] - a[1]).norm(), (a[0] - a[2]).norm()});
    const double clear = std::min({clear_mm(F(face, 0)), clear_mm(F(face, 1)), clear_mm(F(face, 2))}) - 0.58 * side;
    if (clear > motion_mm + reach) return due_at(clear);
    if (motion_mm > cell_mm_) {  // too far for a list to be of use again
      due_at(0);
      return collect(lower, upper, try_point);
    }
    survey(a, motion_mm + 2 * reach + cell_mm_, around);
    moved = 0;
  }
  due_at((around.points.empty() ? around.reach_mm : around.points.front().distance_mm) - moved);
  for (const Neighbourhood::Near& near : around.points) {
    if (near.distance_mm > moved + motion_mm + reach) break;
    try_point(near.point);
  }
}

int PointContacts::find(const Triangles& F, const Positions& from, const Positions& to,
                        std::span<const double> radius_mm, const HeldVertices& held, double tolerance_mm,
                        const std::function<double(int)>& clear_mm) {
  if (points_.empty()) return 0;
  const auto faces = static_cast<std::size_t>(F.rows());
  if (around_.size() != faces) {
    around_.assign(faces, {});
    due_mm_.assign(faces, -std::numeric_limits<double>::infinity());
    last_from_ = from;
  }
  if (const double motion_mm = std::sqrt((from - last_from_).rowwise().squaredNorm().maxCoeff()); motion_mm > 0) {
    // A new step: what was found in the one before was accepted.
    travelled_mm_ += motion_mm;
    last_from_ = from;
    for (const PointContact& contact : contacts_) used_[static_cast<std::size_t>(contact.point)] = settled;
  }
  const double travel = travelled_mm_ + std::sqrt((to - from).rowwise().squaredNorm().maxCoeff());
  constexpr std::size_t grain = 1024;
  std::vector<std::vector<Candidate>> lists((faces + grain - 1) / grain);
  parallel_for(faces, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      if (due_mm_[f] <= travel)
        look(F, static_cast<int>(f), from, to, radius_mm[f], held, tolerance_mm, clear_mm, lists[begin / grain]);
  });
  std::vector<Candidate> found;
  for (const auto& list : lists) found.insert(found.end(), list.begin(), list.end());
  // A point met by several faces belongs to the one that met it first.
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    if (a.contact.point != b.contact.point) return a.contact.point < b.contact.point;
    return a.fraction != b.fraction ? a.fraction < b.fraction : a.contact.face < b.contact.face;
  });
  int added = 0;
  for (const Candidate& candidate : found) {
    char& used = used_[static_cast<std::size_t>(candidate.contact.point)];
    if (used) continue;
    used = met;
    contacts_.push_back(candidate.contact);
    ++added;
  }
  return added;
}

void PointContacts::roll_back(std::size_t count) {
  for (std::size_t i = count; i < contacts_.size(); ++i) used_[static_cast<std::size_t>(contacts_[i].point)] = 0;
  contacts_.resize(count);
}

void PointContacts::add_forces(const Triangles& F, const Positions& x, Positions& force, BlockMatrix* matrix) const {
  for (const PointContact& contact : contacts_) {
    const Vec3 pull = pull_of(contact, F, x);
    for (int a = 0; a < 3; ++a) {
      force.row(F(contact.face, a)) += contact.barycentric[a] * pull.transpose();
      if (!matrix) continue;
      for (int b = 0; b < 3; ++b) {
        const double stiffness = stiffness_ * contact.barycentric[a] * contact.barycentric[b];
        const auto value = static_cast<float>(stiffness);
        auto& block = matrix->block(matrix->slot(F(contact.face, a), F(contact.face, b)));
        for (int j = 0; j < 3; ++j) {
          block[static_cast<std::size_t>(j)][j] += contact.slid ? static_cast<float>(share_beside * stiffness) : value;
          if (!contact.slid) continue;
          for (int i = 0; i < 3; ++i)
            block[static_cast<std::size_t>(j)][i] +=
                static_cast<float>((1 - share_beside) * stiffness * contact.normal[i] * contact.normal[j]);
        }
      }
    }
  }
}

Vec3 PointContacts::pull_of(const PointContact& contact, const Triangles& F, const Positions& x) const {
  const Vec3 pull = stiffness_ * (contact.place - on_face(contact, F, x));
  return contact.slid ? Vec3(share_beside * pull + (1 - share_beside) * pull.dot(contact.normal) * contact.normal)
                      : pull;
}

PointContacts::Pull PointContacts::pull_apart(const PointContact& contact, const Triangles& F,
                                              const Positions& x) const {
  const Vec3 pull = pull_of(contact, F, x), normal = contact.slid ? contact.normal : face_normal(contact.face, F, x);
  const double across = pull.dot(normal);
  return {normal, pull - across * normal, across};
}

void PointContacts::let_go(const Triangles& F, const Positions& x, double friction,
                           const std::function<bool(int)>& carried) {
  std::erase_if(contacts_, [&](const PointContact& contact) {
    return carried(contact.face) && pull_apart(contact, F, x).slides(friction);
  });
}

void PointContacts::slide(const Triangles& F, const Positions& x, double friction,
                          const std::vector<std::vector<int>>& faces_of) {
  for (PointContact& contact : contacts_) {
    const Pull pull = pull_apart(contact, F, x);
    if (!pull.slides(friction)) continue;
    const Vec3 here = on_face(contact, F, x);
    const double maximum = friction * std::abs(pull.across);
    // Which place of the sheet lies over the point now? It is held as far from the point as the old one was.
    const Vec3& point = points_[static_cast<std::size_t>(contact.point)];
    const double stretched_mm = std::clamp(pull.across / stiffness_, -0.05 * cell_mm_, 0.05 * cell_mm_);
    const double reach_mm = (here - point).dot(pull.normal) + stretched_mm;
    NearestPoint best;
    best.distance = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k)
      for (const int face : faces_of[static_cast<std::size_t>(F(contact.face, k))]) {
        NearestPoint candidate = nearest_on_triangle(point, x.row(F(face, 0)), x.row(F(face, 1)), x.row(F(face, 2)));
        if (candidate.distance > best.distance || (candidate.distance == best.distance && face >= best.face)) continue;
        candidate.face = face;
        best = candidate;
      }
    contact.slid = true;
    contact.face = best.face;
    contact.barycentric = best.barycentric;
    contact.normal = face_normal(best.face, F, x);
    const Vec3 now = on_face(contact, F, x), beside = pull.along - pull.along.dot(contact.normal) * contact.normal;
    contact.place = now + (reach_mm - (now - point).dot(contact.normal)) * contact.normal;
    if (beside.norm() > 0)
      contact.place += std::min(maximum, pull.along.norm()) / (share_beside * stiffness_ * beside.norm()) * beside;
  }
}

}  // namespace formwright
