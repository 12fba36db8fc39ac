#include "linear/pcg.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/vectors.h"

namespace argil::linear {
void BlockJacobi::prepare(Eigen::Index num_rows) {
  m_rows.prepare(num_rows);
  m_inverse.resize(3, 3 * num_rows + 1);
}

void BlockJacobi::update(const BlockMatrix& matrix, Operator& whole) {
  prepare(matrix.num_rows());
  m_inverse.rightCols<1>().setZero();
  m_rows.each(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      m_inverse.middleCols<3>(3 * row) = matrix.block(matrix.diagonal[static_cast<std::size_t>(row)]);
  });
  whole.add_unstored_diagonal(m_inverse);
  m_rows.each(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      m_inverse.middleCols<3>(3 * row) = invert_block(m_inverse.middleCols<3>(3 * row));
  });
}

double BlockJacobi::apply(const Points& r, Points& z) {
  return m_rows.sum(r.cols(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return apply_blocks(m_inverse.data(), r.data(), begin, end, z.data());
  });
}

double StaleCholesky::apply(const Points& r, Points& z) {
  m_factor.solve(r, z);
  return m_rows.sum(r.cols(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return compute_dot(r.data(), z.data(), begin, end);
  });
}

double ConjugateGradients::compute_squares(const Points& a) {
  return m_rows.sum(a.cols(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return compute_dot(a.data(), a.data(), begin, end);
  });
}

/// r = b − w; returns r·r.
double ConjugateGradients::set_residual(const Points& b) {
  return m_rows.sum(b.cols(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    m_r.middleCols(begin, end - begin) =
        b.middleCols(begin, end - begin) - m_w.middleCols(begin, end - begin);
    return compute_dot(m_r.data(), m_r.data(), begin, end);
  });
}

/// p = z + β p, q = w + β q, x += α p, r −= α q; returns r·r.
double ConjugateGradients::advance(double alpha, double beta, Points& x) {
  const Iterate to{m_p.data(), m_q.data(), x.data(), m_r.data()};
  return m_rows.sum(x.cols(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return linear::advance(alpha, beta, m_z.data(), m_w.data(), begin, end, to);
  });
}

void ConjugateGradients::prepare(Eigen::Index num_rows) {
  m_rows.prepare(num_rows);
  for (Points* vector : {&m_r, &m_z, &m_p, &m_q, &m_w}) vector->resize(3, num_rows);
}

SolveReport ConjugateGradients::solve(Operator& matrix, Preconditioner& preconditioner, const Points& b,
                                      double tolerance, int max_iterations, Points& x, double goal) {
  prepare(b.cols());
  constexpr double kRounding = 1e-14;  // of ‖b‖
  SolveReport report;
  matrix.multiply(x, m_w);
  const double first = std::sqrt(set_residual(b));
  if (!std::isfinite(first)) return {false, 0, std::numeric_limits<double>::quiet_NaN()};
  const double rounding = kRounding * std::sqrt(compute_squares(b));
  goal = std::max({tolerance * first, rounding, goal});
  double residual = first;
  m_p.setZero();
  m_q.setZero();
  double rz = 1.0;
  double curvature = 0.0;  // p·A p, by the recurrence that holds while directions are conjugate
  // Written so that a NaN residual leaves the loop as not converged.
  while (residual > goal && report.iterations < max_iterations) {
    const double rz_next = preconditioner.apply(m_r, m_z);
    const double beta = rz_next / rz;
    curvature = matrix.multiply(m_z, m_w) - beta * beta * curvature;
    if (curvature <= 0.0) {
      report.relative_residual = std::numeric_limits<double>::infinity();
      return report;
    }
    residual = std::sqrt(advance(rz_next / curvature, beta, x));
    rz = rz_next;
    ++report.iterations;
  }
  report.converged = residual <= goal;
  report.first = first;
  report.relative_residual = first > rounding ? residual / first : 0.0;
  return report;
}

}  // namespace argil::linear
