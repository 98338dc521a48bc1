// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/base/relief_pieces.h"

#include <algorithm>
#include <array>
#include <map>

#include "relief/base/piece_list.h"

namespace formwright {
namespace {

/// A corner of a triangle that is being cut: a vertex of the mesh (b < 0), or the place on an edge where a border
/// crosses it.
struct Corner {
  int a = -1, b = -1, border = -1;
  int origin = -1;
  double t = 0;  // on the plate, against the borders
  Vec3 place = Vec3::Zero();
  Vec2 limits = Vec2::Zero();  // nearest and farthest depth, of a vertex
  Vec2 room = Vec2::Zero();    // how far they are before and behind the base, where that is painted
  bool bounded = true;
  std::array<int, 3> key() const { return {a, b, border}; }
};

class Cutter {
 public:
  Cutter(const ViewFrame& frame, const Positions& joint, const Eigen::VectorXd& m, const DepthBounds& bounds,
         const GroupBorders& borders)
      : frame_(frame), joint_(joint), m_(m), bounds_(bounds), borders_(borders) {
    for (int k = 0; k + 1 < borders.bands(); ++k) border_t_.push_back(borders.border(k));
  }

  void cut(int a, int b, int c) {
    std::vector<Corner> rest{corner(a), corner(b), corner(c)};
    for (int band = 0; band < borders_.bands() && rest.size() >= 3; ++band) {
      std::vector<Corner> here, beyond;
      if (band + 1 == borders_.bands()) here.swap(rest);
      else split(rest, band, here, beyond);
      if (borders_.group(band) >= 0)
        for (std::size_t k = 2; k < here.size(); ++k) add(here[0], here[k - 1], here[k], band);
      rest.swap(beyond);
    }
  }

  ReliefPieces pieces() { return list_.pieces(bounds_.painted()); }

 private:
  Corner corner(int vertex) const {
    Corner c;
    c.a = c.origin = vertex;
    c.place = joint_.row(vertex).transpose();
    // Of the model, where the ray is the same: which side it is on does not hang on the solution's last digit.
    c.t = borders_.place(frame_.P.row(vertex).transpose());
    c.limits = {bounds_.nearest_allowed(vertex), bounds_.farthest[vertex]};
    if (bounds_.painted()) c.room = {bounds_.above_of[vertex], bounds_.below_of[vertex]};
    c.bounded = bounds_.bounded[static_cast<std::size_t>(vertex)] != 0;
    return c;
  }

  /// The part of a convex polygon before a border, and the part behind it.
  void split(const std::vector<Corner>& polygon, int border, std::vector<Corner>& before, std::vector<Corner>& behind) {
    const double at = border_t_[static_cast<std::size_t>(border)];
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Corner &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
      (p.t < at ? before : behind).push_back(p);
      if ((p.t < at) == (q.t < at)) continue;
      const Corner& first = std::less<>()(p.key(), q.key()) ? p : q;  // the same place from both sides of the edge
      const Corner& second = &first == &p ? q : p;
      Corner on;
      on.a = first.b < 0 ? first.a : id_of(first);
      on.b = second.b < 0 ? second.a : id_of(second);
      on.border = border;
      const double d = borders_.off(border, first.place), e = borders_.off(border, second.place),
                   share = d == e ? 0.5 : std::clamp(d / (d - e), 0.0, 1.0);
      on.place = first.place + share * (second.place - first.place);
      on.t = at;
      on.origin = share < 0.5 ? first.origin : second.origin;
      on.bounded = first.bounded && second.bounded;
      on.room = first.room + share * (second.room - first.room);
      before.push_back(on);
      behind.push_back(on);
    }
  }

  /// Each place on a border gets a number above those of the vertices, so that edges that end there have a name.
  int id_of(const Corner& c) {
    return ids_.emplace(c.key(), static_cast<int>(joint_.rows() + static_cast<Eigen::Index>(ids_.size())))
        .first->second;
  }

  void add(const Corner& a, const Corner& b, const Corner& c, int band) {
    Eigen::Vector3i face;
    face[0] = vertex(a, band);  // one after the other: the arguments of one call have no order
    face[1] = vertex(b, band);
    face[2] = vertex(c, band);
    list_.add_face(face, band);
  }

  int vertex(const Corner& c, int band) {
    const std::array<int, 4> key{c.a, c.b, c.border, band};
    const auto [found, is_new] = vertices_.try_emplace(key, list_.vertex_count());
    if (is_new) list_.add_vertex(brought_back(c, band), c.origin, c.room);
    return found->second;
  }

  /// Scaled about the viewpoint by 1 / mu; straight on, shifted in depth.
  Vec3 brought_back(const Corner& c, int band) const {
    const double m = m_[borders_.group(band)], kappa = frame_.kappa;
    Vec3 p = c.place;
    if (kappa == 0) p.z() -= m;
    else {
      const Vec3 viewpoint(0, 0, -1 / kappa);
      p = viewpoint + (p - viewpoint) / (1 + kappa * m);
    }
    std::optional<Vec2> limits;
    if (c.border >= 0) {
      limits = borders_.limits(band, c.border, p, c.bounded);
      // Counted from the base, on which the borders' limits are `above` and `below`.
      if (limits && bounds_.painted()) *limits += Vec2(bounds_.above - c.room[0], c.room[1] - bounds_.below);
    } else if (c.bounded) limits = c.limits;
    if (!limits) return p;
    const double z = std::clamp(p.z(), (*limits)[0], (*limits)[1]);
    const double stretch = (1 + kappa * z) / (1 + kappa * p.z());
    return {p.x() * stretch, p.y() * stretch, z};
  }

  const ViewFrame& frame_;
  const Positions& joint_;
  const Eigen::VectorXd& m_;
  const DepthBounds& bounds_;
  const GroupBorders& borders_;
  std::vector<double> border_t_;
  std::map<std::array<int, 3>, int> ids_;
  std::map<std::array<int, 4>, int> vertices_;
  PieceList list_;
};

}  // namespace

ReliefPieces cut_into_bands(const ViewFrame& frame, const Triangles& F, const Eigen::VectorXd& joint,
                            const Eigen::VectorXd& m, const DepthBounds& bounds, const GroupBorders& borders,
                            Context& context) {
  const Positions places = frame.moved(joint);
  Cutter cutter(frame, places, m, bounds, borders);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (f % 65536 == 0) context.check_cancelled();
    cutter.cut(F(f, 0), F(f, 1), F(f, 2));
  }
  return cutter.pieces();
}

}  // namespace formwright
