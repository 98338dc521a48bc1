// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The sheet in time: implicit Euler, each step solved by projected Newton with contact found along the way.
// Everything is described from the platform, on which mould and plate rest; the clamp moves.
#include <functional>
#include <memory>
#include <vector>

#include "base/context.h"
#include "thermoform/solver/block_cg.h"
#include "thermoform/contact/contact_chill.h"
#include "thermoform/solver/face_strips.h"
#include "thermoform/sheet/clamp_slip.h"
#include "thermoform/sheet/hinge_bending.h"
#include "thermoform/sheet/membrane.h"
#include "thermoform/contact/mould_contact.h"
#include "thermoform/contact/point_contacts.h"
#include "thermoform/contact/sheet_friction.h"
#include "thermoform/sheet/sheet_mesh.h"

namespace formwright {

/// What acts on the sheet during one step.
struct StepLoad {
  double gravity_mm_per_s2 = 9806.65;
  double pressure_mpa = 0;  // difference across the sheet at the end of the step, pushing against the faces' normals
  Vec3 clamp_shift = Vec3::Zero();  // mm, of the rim in this step
  double clamp_slip_mm = 0;         // by which the rim comes in where the sheet pulls hardest
  bool settling = false;            // nothing grows any more: what slides is to come to rest (SheetFriction::decide)
  bool quasi_static = false;        // leave inertia out
};

struct DynamicsStatistics {
  int steps = 0, rejected_steps = 0, newton_iterations = 0, cg_iterations = 0;
  double seconds_assembly = 0, seconds_linear = 0, seconds_contact = 0;
};

class SheetDynamics {
 public:
  /// The sheet lies flat at height `height_mm` above the plate. `contact` may be null. Throws Error{invalid_input}.
  SheetDynamics(const SheetMesh& sheet, const ThermoformOptions& options, double height_mm,
                std::shared_ptr<const MouldContact> contact);

  enum class Outcome { done, moved_too_far, not_converged };
  /// Tries one step; unless done, nothing has changed. No free vertex may move farther than `max_move_mm` beside the
  /// clamp's shift.
  Outcome step(double dt_s, const StepLoad& load, double max_move_mm, Context& context);

  /// Adds to the velocities of vertices that are not held: the platform's change of speed.
  void add_velocity(const Vec3& mm_per_s);
  /// Starts the next step's Newton iteration from here (free vertices only).
  void guess(const Positions& x) { guess_ = x; }
  /// Where Newton's iteration stood when a step was given up as not converged: a guess to go on from.
  const Positions& last_iterate() const { return last_iterate_; }

  const Positions& x() const { return x_; }
  const Positions& velocity() const { return v_; }
  const HeldVertices& held() const { return held_; }
  const std::vector<double>& contact_time_s() const { return contact_time_; }  // -1 where none
  double time_s() const { return time_; }
  double last_step_s() const { return last_step_; }
  double step_limit_mm() const { return step_limit_mm_; }  // options.step_mm, or what it is automatically
  double last_move_mm() const { return last_move_; }       // farthest, beside the clamp's shift
  int free_count() const;                                  // vertices that touch nothing
  bool all_stuck() const { return free_.empty(); }
  const Membrane& membrane() const { return membrane_; }
  const SheetMesh& sheet() const { return sheet_; }
  const PointContacts& point_contacts() const { return points_; }
  const DynamicsStatistics& statistics() const { return statistics_; }
  /// n: thickness of the triangles around a vertex, weighted by area.
  std::vector<double> vertex_thickness_mm(const Positions& x) const;
  /// n x 3, in N: everything but inertia, at `x`, for a step of `dt_s`.
  Positions forces(const Positions& x, double dt_s, const StepLoad& load, BlockMatrix* matrix);
  double total_mass_t() const { return mass_total_; }

 private:
  /// Of `matrix`, only the rows of free vertices are cleared and so mean anything afterwards.
  void assemble(const Positions& x, double dt_s, const StepLoad& load, Positions& force, BlockMatrix* matrix);
  int find_contacts(const Positions& from, Positions& to, const std::vector<double>& radius_mm);
  void collect_free();
  void begin_membrane_step();
  /// How far a sliding vertex gets that wants to go `wanted`.
  Vec3 slide(int vertex, const Vec3& from, const Vec3& wanted, double radius_mm);

  SheetMesh sheet_;
  ThermoformOptions options_;
  std::shared_ptr<const MouldContact> contact_;
  Membrane membrane_;
  FaceStrips strips_;
  std::unique_ptr<HingeBending> bending_;
  std::unique_ptr<ContactChill> chill_;      // null without cooling
  std::unique_ptr<SheetFriction> friction_;  // null where what touches sticks
  std::unique_ptr<ClampSlip> clamp_slip_;    // null where the clamp holds
  PointContacts points_;
  BlockMatrix matrix_;
  BlockCg cg_;
  Positions x_, v_, guess_, last_iterate_;
  std::vector<double> mass_, contact_time_, until_;
  std::vector<double> point_radius_mm_;  // per face: as near as sharp points come in this step
  HeldVertices held_, none_held_;        // values: HeldState
  std::vector<int> free_;
  std::vector<MouldContact::Known> known_;
  double time_ = 0, mass_total_ = 0, last_move_ = 0, last_step_ = 0, edge_mm_ = 1, step_limit_mm_ = 1;
  DynamicsStatistics statistics_;
};

}  // namespace formwright
