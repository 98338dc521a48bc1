// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/point_contacts.h"

#include <algorithm>
#include <Eigen/Dense>
#include <cmath>

#include "geometry/point_distance.h"

namespace formwright {
namespace {

constexpr double offset_cells = 1 << 19;
constexpr double share_beside = 0.02;  // of a slid contact's stiffness along the face: about the sheet's own

std::uint64_t key(int x, int y, int z) {
  return static_cast<std::uint64_t>(z & 0xfffff) << 40 | static_cast<std::uint64_t>(y & 0xfffff) << 20 | static_cast<std::uint64_t>(x & 0xfffff);
}
int cell_of(double value, double size) { return static_cast<int>(std::clamp(std::floor(value / size) + offset_cells, 0.0, 2 * offset_cells - 1)); }

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
std::optional<Touch> first_touch(const Vec3& q, const Vec3 (&a)[3], const Vec3 (&b)[3], double radius, double tolerance) {
  double speed = 0;
  for (int k = 0; k < 3; ++k) speed = std::max(speed, (b[k] - a[k]).norm());
  double t = 0;
  for (;;) {
    const Vec3 c[3] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
    const NearestPoint nearest = nearest_on_triangle(q, c[0], c[1], c[2]);
    const double clear = nearest.distance - radius;
    if (clear <= tolerance) return Touch{t, nearest.barycentric};
    if (t >= 1 || speed == 0) return std::nullopt;
    t = std::min(1.0, t + 0.999 * clear / speed);
  }
}

}  // namespace

PointContacts::PointContacts(std::vector<Vec3> points, double cell_mm, double stiffness)
    : points_(std::move(points)), used_(points_.size()), cell_mm_(cell_mm), margin_mm_(0.5 * cell_mm), stiffness_(stiffness) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3& p = points_[i];
    cells_.push_back({key(cell_of(p.x(), cell_mm_), cell_of(p.y(), cell_mm_), cell_of(p.z(), cell_mm_)), static_cast<int>(i)});
  }
  std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) { return a.key != b.key ? a.key < b.key : a.point < b.point; });
}

void PointContacts::collect(const Vec3& lower, const Vec3& upper, std::vector<int>& points) const {
  points.clear();
  const int x0 = cell_of(lower.x(), cell_mm_), x1 = cell_of(upper.x(), cell_mm_);
  for (int z = cell_of(lower.z(), cell_mm_); z <= cell_of(upper.z(), cell_mm_); ++z)
    for (int y = cell_of(lower.y(), cell_mm_); y <= cell_of(upper.y(), cell_mm_); ++y) {
      const std::uint64_t last = key(x1, y, z);
      for (auto it = std::lower_bound(cells_.begin(), cells_.end(), key(x0, y, z), [](const Cell& c, std::uint64_t k) { return c.key < k; });
           it != cells_.end() && it->key <= last; ++it) {
        const Vec3& q = points_[static_cast<std::size_t>(it->point)];
        if ((q.array() >= lower.array()).all() && (q.array() <= upper.array()).all()) points.push_back(it->point);
      }
    }
}

int PointContacts::find(const Triangles& F, const Positions& from, const Positions& to, std::span<const double> thickness_mm, const HeldVertices& held,
                        double tolerance_mm) {
  if (points_.empty()) return 0;
  struct Candidate {
    double fraction;
    PointContact contact;
  };
  if (listed_at_.rows() != F.rows()) {
    listed_at_.setConstant(F.rows(), 9, 1e30);
    listed_.assign(static_cast<std::size_t>(F.rows()), {});
  }
  std::vector<Candidate> found;
  for (int f = 0; f < static_cast<int>(F.rows()); ++f) {
    bool all_held = true, still_listed = true;
    for (int k = 0; k < 3; ++k) {
      const int v = F(f, k);
      all_held &= held[static_cast<std::size_t>(v)] != 0;
      still_listed &= (to.row(v) - listed_at_.block<1, 3>(f, 3 * k)).squaredNorm() < 0.99 * margin_mm_ * margin_mm_;
    }
    std::vector<int>& list = listed_[static_cast<std::size_t>(f)];
    if (all_held || (still_listed && list.empty())) continue;
    const double radius = 0.5 * thickness_mm[static_cast<std::size_t>(f)], reach = radius + tolerance_mm;
    Vec3 a[3], b[3], lower = Vec3::Constant(1e300), upper = Vec3::Constant(-1e300);
    for (int k = 0; k < 3; ++k) {
      a[k] = from.row(F(f, k));
      b[k] = to.row(F(f, k));
      lower = lower.cwiseMin(a[k]).cwiseMin(b[k]);
      upper = upper.cwiseMax(a[k]).cwiseMax(b[k]);
    }
    if (!still_listed) {
      // The reach may grow with the thickness: half of the margin is for movement, the rest is ample for that.
      collect(lower.array() - 2 * reach - 2 * margin_mm_, upper.array() + 2 * reach + 2 * margin_mm_, list);
      for (int k = 0; k < 3; ++k) listed_at_.block<1, 3>(f, 3 * k) = b[k].transpose();
    }
    for (const int point : list) {
      const Vec3& q = points_[static_cast<std::size_t>(point)];
      if (used_[static_cast<std::size_t>(point)] || (q.array() < lower.array() - reach).any() || (q.array() > upper.array() + reach).any()) continue;
      const auto touch = first_touch(q, a, b, radius, tolerance_mm);
      if (!touch) continue;
      Vec3 place = Vec3::Zero();
      for (int k = 0; k < 3; ++k) place += touch->barycentric[k] * (a[k] + touch->fraction * (b[k] - a[k]));
      found.push_back({touch->fraction, {point, f, touch->barycentric, place, touch->fraction}});
    }
  }
  // A point met by several faces belongs to the one that met it first.
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    if (a.contact.point != b.contact.point) return a.contact.point < b.contact.point;
    return a.fraction != b.fraction ? a.fraction < b.fraction : a.contact.face < b.contact.face;
  });
  int added = 0;
  for (const Candidate& candidate : found) {
    char& used = used_[static_cast<std::size_t>(candidate.contact.point)];
    if (used) continue;
    used = 1;
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
            block[static_cast<std::size_t>(j)][i] += static_cast<float>((1 - share_beside) * stiffness * contact.normal[i] * contact.normal[j]);
        }
      }
    }
  }
}

Vec3 PointContacts::pull_of(const PointContact& contact, const Triangles& F, const Positions& x) const {
  const Vec3 pull = stiffness_ * (contact.place - on_face(contact, F, x));
  return contact.slid ? Vec3(share_beside * pull + (1 - share_beside) * pull.dot(contact.normal) * contact.normal) : pull;
}

void PointContacts::slide(const Triangles& F, const Positions& x, double friction, const std::vector<std::vector<int>>& faces_of) {
  for (PointContact& contact : contacts_) {
    const Vec3 here = on_face(contact, F, x), pull = pull_of(contact, F, x);
    const Vec3 normal = contact.slid ? contact.normal : face_normal(contact.face, F, x);
    const double across = pull.dot(normal), most = friction * std::abs(across);
    const Vec3 along = pull - across * normal;
    if (along.norm() <= most || along.norm() == 0) continue;
    // Which place of the sheet lies over the point now? It is held as far from the point as the old one was.
    const Vec3& point = points_[static_cast<std::size_t>(contact.point)];
    const double stretched_mm = std::clamp(across / stiffness_, -0.05 * cell_mm_, 0.05 * cell_mm_);
    const double reach_mm = (here - point).dot(normal) + stretched_mm;
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
    const Vec3 now = on_face(contact, F, x), beside = along - along.dot(contact.normal) * contact.normal;
    contact.place = now + (reach_mm - (now - point).dot(contact.normal)) * contact.normal;
    if (beside.norm() > 0) contact.place += std::min(most, along.norm()) / (share_beside * stiffness_ * beside.norm()) * beside;
  }
}

}  // namespace formwright
