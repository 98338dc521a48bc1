// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/geometry/cgal/cgal_subdivide.h"

#include <CGAL/subdivision_method_3.h>

#include "bench/geometry/bench_tools.h"
#include "bench/geometry/cgal/cgal_mesh.h"

namespace formwright::bench {

TriangleMesh cgal_loop(const TriangleMesh& mesh, int levels, double& seconds) {
  CgalMesh work = to_cgal(mesh);
  const double before = cpu_seconds();
  CGAL::Subdivision_method_3::Loop_subdivision(work,
                                               CGAL::parameters::number_of_iterations(static_cast<unsigned>(levels)));
  seconds = cpu_seconds() - before;
  return from_cgal(work);
}

}  // namespace formwright::bench
