// SPDX-License-Identifier: GPL-3.0-or-later
// compare_cholesky MATRIX METHOD [rounds [threads]]: one factorisation of one matrix (cholesky_methods.h), as a line of
// JSON. On one thread in processor time, on several in wall-clock time. One run a method, so that the peak of the
// memory is that method's own.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#ifdef __EMSCRIPTEN__
#include <unistd.h>
#else
#include <sys/resource.h>
#endif

#include "base/data/json.h"
#include "base/parallel.h"
#include "cholesky_methods.h"
#include "matrix_file.h"

namespace {
using namespace formwright;

#ifdef __EMSCRIPTEN__
constexpr bool has_processor_time = false;
#else
constexpr bool has_processor_time = true;
#endif

/// Processor time, which other programs do not lengthen, where one thread works alone; else wall-clock time.
double seconds_now(int threads) {
  timespec now{};
  clock_gettime(has_processor_time && threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Of the process: natively the peak of resident memory, in WebAssembly how far the heap has grown.
double peak_memory_mb() {
#ifdef __EMSCRIPTEN__
  return 1e-6 * static_cast<double>(reinterpret_cast<std::uintptr_t>(sbrk(0)));
#else
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1.024e-3 * static_cast<double>(usage.ru_maxrss);
#endif
}

template <class Work>
double shortest_run_seconds(int rounds, int threads, const Work& work) {
  double minimum = std::numeric_limits<double>::infinity();
  for (int k = 0; k < rounds; ++k) {
    const double before = seconds_now(threads);
    work();
    minimum = std::min(minimum, seconds_now(threads) - before);
  }
  return minimum;
}

/// |b - A x| / (|A| |x| + |b|), all in the norm of the largest entry (the normwise backward error: Rigal, Gaches 1967).
double backward_error(const SparseMatrix& lower, const Eigen::VectorXd& x, const Eigen::VectorXd& b) {
  const Eigen::VectorXd residual = b - lower.selfadjointView<Eigen::Lower>() * x;
  const Eigen::VectorXd rows =
      lower.cwiseAbs().selfadjointView<Eigen::Lower>() * Eigen::VectorXd::Ones(lower.rows()).eval();
  return residual.lpNorm<Eigen::Infinity>() /
         (rows.maxCoeff() * x.lpNorm<Eigen::Infinity>() + b.lpNorm<Eigen::Infinity>());
}

}  // namespace

int main(int argc, char** argv) {
  const auto method = argc > 2 ? bench::cholesky_method(argv[2]) : nullptr;
  if (!method) {
    std::fprintf(
        stderr,
        "compare_cholesky MATRIX ours|eigen-amd|eigen-ours|cholmod-amd|cholmod-metis|cholmod-ours [rounds [threads]]\n");
    return 2;
  }
  try {
    const int rounds = argc > 3 ? std::stoi(argv[3]) : 3;
    const int threads = argc > 4 ? std::stoi(argv[4]) : 1;
    const ThreadLimit limit(threads);
    const SparseMatrix lower = bench::read_matrix(argv[1]);
    std::mt19937 random(1);
    Eigen::VectorXd b(lower.rows());
    for (double& value : b) value = static_cast<double>(random()) / 4294967296.0 - 0.5;
    const double memory_before = peak_memory_mb();
    Json report{{"method", argv[2]}, {"unknowns", lower.rows()}, {"entries", lower.nonZeros()}};
    Eigen::VectorXd x;
    report["seconds_analyze"] =
        shortest_run_seconds(threads == 1 ? 1 : rounds, threads, [&] { method->analyze(lower); });
    report["seconds_factorize"] = shortest_run_seconds(rounds, threads, [&] { method->factorize(lower); });
    report["seconds_solve"] = shortest_run_seconds(rounds, threads, [&] { x = method->solve(b); });
    report["peak_memory_mb"] = peak_memory_mb() - memory_before;
    report["factor_entries"] = method->stored_entries();
    report["backward_error"] = backward_error(lower, x, b);
    std::cout << report.dump() << "\n";
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compare_cholesky: %s\n", error.what());
    return 3;
  }
}
