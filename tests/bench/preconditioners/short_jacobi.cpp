#include "preconditioners/short_jacobi.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/pcg.h"

namespace argil::bench {

void ShortJacobi::update(const linear::BlockMatrix& matrix) {
  linear::MatrixOperator whole(matrix, 1);
  m_blocks.update(matrix, whole, m_runs);
  const auto num_rows = static_cast<std::size_t>(matrix.num_rows());
  for (std::vector<float>* vector : {&m_r, &m_z, &m_w, &m_p, &m_q, &m_x}) vector->resize(4 * num_rows);
  m_sums.resize(static_cast<std::size_t>(m_runs.count_runs(matrix.num_rows())));
}

ShortJacobi::Report ShortJacobi::solve(const Points& b, double tolerance, int max_iterations, Points& x) {
  const std::ptrdiff_t num_rows = b.cols();
  const double first = b.norm();
  const linear::ShortIterate to{m_p.data(), m_q.data(), m_x.data(), m_r.data()};
  linear::ShortSums sums;
  const auto advance = [&](double alpha, double beta) {
    m_runs.each_run(num_rows, [&](std::ptrdiff_t i, std::ptrdiff_t begin, std::ptrdiff_t end) {
      m_sums[static_cast<std::size_t>(i)] =
          linear::advance_blocks(m_blocks.rows(), begin, end, static_cast<float>(alpha),
                                 static_cast<float>(beta), m_z.data(), m_w.data(), to);
    });
    m_z.swap(m_w);
    sums = {};
    for (const linear::ShortSums& run : m_sums) {
      sums.rr += run.rr;
      sums.rz += run.rz;
    }
  };
  m_runs.each(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 4; ++k)
        to.r[4 * row + k] = k < 3 ? static_cast<float>(b(k, row) / first) : 0.0F;
    for (std::vector<float>* vector : {&m_x, &m_z, &m_p, &m_q, &m_w})
      std::fill(vector->begin() + 4 * begin, vector->begin() + 4 * end, 0.0F);
  });
  advance(0.0, 0.0);  // z = D⁻¹ r
  Report report;
  double last_rz = std::numeric_limits<double>::infinity();
  double curvature = 0.0;
  while (sums.rr > tolerance * tolerance && report.iterations < max_iterations) {
    const double product = m_runs.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      return linear::multiply(m_blocks.rows(), begin, end, m_z.data(), m_w.data());
    });
    const double beta = sums.rz / last_rz;
    last_rz = sums.rz;
    curvature = product - beta * beta * curvature;
    if (!(curvature > 0.0)) return report;
    advance(last_rz / curvature, beta);
    ++report.iterations;
  }
  report.converged = sums.rr <= tolerance * tolerance;
  x.resize(3, num_rows);
  m_runs.each(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 3; ++k) x(k, row) = first * static_cast<double>(to.x[4 * row + k]);
  });
  return report;
}

}  // namespace argil::bench
