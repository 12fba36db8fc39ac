#include "linear/pcg.h"

#include <cmath>
#include <limits>

#include "base/ordered_sum.h"

namespace argil::linear {
namespace {

double dot(const Points& a, const Points& b) {
  const double* p = a.data();
  const double* q = b.data();
  return ordered_sum(a.size(), [=](std::ptrdiff_t i) { return p[i] * q[i]; });
}

}  // namespace

void BlockJacobi::update(const BlockMatrix& matrix) {
  m_inverse.resize(3, 3 * static_cast<Eigen::Index>(matrix.num_rows()));
  for (int row = 0; row < matrix.num_rows(); ++row) {
    const Mat3 block = matrix.block(matrix.diagonal[static_cast<std::size_t>(row)]);
    const Mat3 cofactor_transposed =
        (Mat3() << block.col(1).cross(block.col(2)).transpose(), block.col(2).cross(block.col(0)).transpose(),
         block.col(0).cross(block.col(1)).transpose())
            .finished();
    m_inverse.middleCols<3>(3 * static_cast<Eigen::Index>(row)) =
        cofactor_transposed / block.col(0).dot(block.col(1).cross(block.col(2)));
  }
}

void BlockJacobi::apply(const Points& r, Points& z) {
  for (Eigen::Index i = 0; i < r.cols(); ++i) z.col(i).noalias() = m_inverse.middleCols<3>(3 * i) * r.col(i);
}

SolveReport ConjugateGradients::solve(Operator& matrix, Preconditioner& preconditioner, const Points& b,
                                      double tolerance, int max_iterations, Points& x) {
  m_r.resize(3, b.cols());
  m_z.resize(3, b.cols());
  m_p.resize(3, b.cols());
  m_q.resize(3, b.cols());
  const double b_norm = std::sqrt(dot(b, b));
  SolveReport report;
  if (b_norm == 0.0) {
    x.setZero();
    report.converged = true;
    return report;
  }
  matrix.multiply(x, m_q);
  m_r.noalias() = b - m_q;
  report.relative_residual = std::sqrt(dot(m_r, m_r)) / b_norm;
  double rz = 0.0;
  // Written so that a NaN residual leaves the loop as not converged.
  while (report.relative_residual > tolerance && report.iterations < max_iterations) {
    preconditioner.apply(m_r, m_z);
    const double rz_next = dot(m_r, m_z);
    if (report.iterations == 0)
      m_p = m_z;
    else
      m_p = m_z + (rz_next / rz) * m_p;
    rz = rz_next;
    matrix.multiply(m_p, m_q);
    const double curvature = dot(m_p, m_q);
    if (curvature <= 0.0) {
      report.relative_residual = std::numeric_limits<double>::infinity();
      return report;
    }
    const double alpha = rz / curvature;
    x.noalias() += alpha * m_p;
    m_r.noalias() -= alpha * m_q;
    report.relative_residual = std::sqrt(dot(m_r, m_r)) / b_norm;
    ++report.iterations;
  }
  report.converged = report.relative_residual <= tolerance;
  return report;
}

}  // namespace argil::linear
