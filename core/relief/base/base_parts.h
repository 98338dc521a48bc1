// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A base of several parts that do not hang together: what is seen of each from the viewpoint. Rays that meet different
// parts move in groups of their own, thesis eq. (3.11) and Fig. 3.7.
#include <memory>
#include <optional>
#include <vector>

#include "base/context.h"
#include "geometry/planar/region.h"
#include "geometry/queries/ray_caster.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// How many connected parts a base has; a hollow within a solid belongs to it.
int count_base_parts(const TriangleMesh& base);

class BaseParts {
 public:
  /// `base`: in view coordinates; manifold and oriented. Throws Error{invalid_input, "base_mesh"}: more than 200 parts;
  /// parts that reach into each other; a base that reaches to the viewpoint. Error{cancelled}.
  BaseParts(const TriangleMesh& base, double kappa, Context& context);

  int count() const { return static_cast<int>(parts_.size()); }
  /// In view coordinates.
  const TriangleMesh& mesh(int part) const { return parts_[static_cast<std::size_t>(part)].mesh; }
  bool is_closed(int part) const { return parts_[static_cast<std::size_t>(part)].closed; }
  double kappa() const { return kappa_; }

  /// The places on the plate's front, z = 0, through which those faces of a part are seen, with nothing before them,
  /// that carry a relief: which the ray meets at more than 11.5 degrees.
  const Region& seen(int part) const { return parts_[static_cast<std::size_t>(part)].seen; }

  struct Hit {
    int part;
    double depth;  // z
    bool carries;  // not a face seen nearly from its edge
  };
  /// The foremost part on the ray that crosses the plate's front at a place.
  std::optional<Hit> foremost(const Vec2& on_plate) const;
  /// Where that ray meets one part first, and where it first leaves it, z. The second is infinite for a part that is
  /// not closed. Beside the part's outline by a rounding error it counts as met.
  struct Passage {
    double enters, leaves;
  };
  std::optional<Passage> passage(int part, const Vec2& on_plate) const;
  /// Nearest and farthest depth z of a relief there that may stand `above` before the part and be carved `below` into
  /// it, both along z; into a closed one at most half-way.
  static Vec2 limits(const Passage& passage, double above, double below);

 private:
  struct Part {
    TriangleMesh mesh;
    bool closed = false;
    Region seen;
    std::unique_ptr<RayCaster> caster;  // straightened
  };
  double kappa_ = 0;
  double front_ = 0, far_ = 0;  // before everything, and a distance beyond everything, straightened
  std::vector<Part> parts_;
  std::vector<int> part_of_face_;  // of the base
  std::vector<char> carries_;      // of each face
  std::unique_ptr<RayCaster> caster_;
};

}  // namespace formwright
