#include "preconditioners/double_designs.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "base/check.h"

namespace argil::bench {
namespace {

double dot(const Points& a, const Points& b) {
  return a.cwiseProduct(b).sum();
}

/// Lower triangle of the matrix of numbers with the blocks' pattern; for each, the place of its block.
struct ScalarPattern {
  std::vector<int> column_begin = {0};
  std::vector<int> row, place;
  explicit ScalarPattern(const linear::BlockMatrix& matrix) {
    for (std::size_t r = 0; r < matrix.diagonal.size(); ++r) {
      for (int b = matrix.diagonal[r]; b < matrix.row_begin[r + 1]; ++b) {
        row.push_back(matrix.column[static_cast<std::size_t>(b)]);
        place.push_back(b);
      }
      column_begin.push_back(static_cast<int>(row.size()));
    }
  }
};

}  // namespace

ScalarFactor::ScalarFactor(const linear::BlockMatrix& matrix)
    : m_factor([&matrix] {
        const ScalarPattern pattern(matrix);
        linear::SparseCholesky factor(pattern.column_begin, pattern.row);
        for (std::size_t i = 0; i < pattern.place.size(); ++i)
          factor.values()[i] = matrix.block(pattern.place[i]).trace() / 3.0;
        ARGIL_ASSERT(factor.factorise());
        return factor;
      }()),
      m_in(matrix.diagonal.size()),
      m_out(matrix.diagonal.size()) {}

double ScalarFactor::apply(const Points& r, Points& z) {
  for (Eigen::Index k = 0; k < 3; ++k) {
    for (Eigen::Index i = 0; i < r.cols(); ++i) m_in[static_cast<std::size_t>(i)] = r(k, i);
    m_factor.solve(m_in, m_out);
    for (Eigen::Index i = 0; i < r.cols(); ++i) z(k, i) = m_out[static_cast<std::size_t>(i)];
  }
  return dot(r, z);
}

Chebyshev::Chebyshev(const linear::BlockMatrix& matrix, int steps)
    : m_product(matrix, 1), m_jacobi(1), m_steps(steps) {
  constexpr int kPowers = 10;
  constexpr double kAbove = 1.1;  // what so many powers may leave
  m_jacobi.update(matrix, m_product);
  m_r.resize(3, matrix.num_rows());
  m_w.resize(3, matrix.num_rows());
  m_d.resize(3, matrix.num_rows());
  for (Eigen::Index i = 0; i < m_d.size(); ++i) m_d(i) = (i * 7919) % 13 < 6 ? 1.0 : -1.0;
  for (int k = 0; k < kPowers; ++k) {
    const double before = m_d.norm();
    m_product.multiply(m_d, m_w);
    m_jacobi.apply(m_w, m_d);
    m_largest = kAbove * m_d.norm() / before;
  }
}

double Chebyshev::apply(const Points& r, Points& z) {
  constexpr double kShare = 0.1;  // of 0.02, 0.05, 0.1, 0.3 the best or near it at all sizes
  const double theta = 0.5 * m_largest * (1.0 + kShare);
  const double delta = 0.5 * m_largest * (1.0 - kShare);
  const double sigma = theta / delta;
  double rho = 1.0 / sigma;
  m_jacobi.apply(r, m_d);
  m_d /= theta;
  z = m_d;
  m_r = r;
  for (int k = 1; k < m_steps; ++k) {
    m_product.multiply(m_d, m_w);
    m_r -= m_w;
    m_jacobi.apply(m_r, m_w);
    const double next = 1.0 / (2.0 * sigma - rho);
    m_d = next * rho * m_d + 2.0 * next / delta * m_w;
    z += m_d;
    rho = next;
  }
  return dot(r, z);
}

BlockFactor::BlockFactor(const linear::BlockMatrix& matrix, Kind kind) {
  std::vector<Mat3> product;  // L D
  for (std::size_t row = 0; row < matrix.diagonal.size(); ++row) {
    const auto first = static_cast<std::size_t>(m_begin.back());
    Mat3 D = matrix.block(matrix.diagonal[row]);
    for (int b = matrix.row_begin[row]; b < matrix.diagonal[row]; ++b) {
      const auto j = static_cast<std::size_t>(matrix.column[static_cast<std::size_t>(b)]);
      Mat3 LD = matrix.block(b);
      if (kind == Kind::incomplete) {  // A_ij − Σ (L D)_ik L_jkᵀ over the k < j that both rows have
        std::size_t i_k = first;
        auto j_k = static_cast<std::size_t>(m_begin[j]);
        while (i_k < m_column.size() && j_k < static_cast<std::size_t>(m_begin[j + 1])) {
          if (m_column[i_k] == m_column[j_k]) LD -= product[i_k] * m_lower[j_k].transpose();
          const int i_column = m_column[i_k];
          const int j_column = m_column[j_k];
          i_k += i_column <= j_column ? 1 : 0;
          j_k += j_column <= i_column ? 1 : 0;
        }
      }
      m_column.push_back(static_cast<int>(j));
      product.push_back(LD);
      m_lower.push_back(LD * m_inverse[j]);
      if (kind == Kind::incomplete) D -= LD * m_lower.back().transpose();
    }
    m_begin.push_back(static_cast<int>(m_column.size()));
    ARGIL_ASSERT(D.llt().info() == Eigen::Success, row);
    m_inverse.push_back(linear::invert_block(D));
  }
}

double BlockFactor::apply(const Points& r, Points& z) {
  const auto num_rows = static_cast<int>(m_inverse.size());
  const auto each_block = [this](int row, const auto& body) {
    for (int b = m_begin[static_cast<std::size_t>(row)]; b < m_begin[static_cast<std::size_t>(row) + 1]; ++b)
      body(m_lower[static_cast<std::size_t>(b)], m_column[static_cast<std::size_t>(b)]);
  };
  for (int row = 0; row < num_rows; ++row) {
    Vec3 sum = r.col(row);
    each_block(row, [&](const Mat3& L, int column) { sum -= L * z.col(column); });
    z.col(row) = sum;
  }
  for (int row = 0; row < num_rows; ++row)
    z.col(row) = (m_inverse[static_cast<std::size_t>(row)] * z.col(row)).eval();
  for (int row = num_rows - 1; row >= 0; --row) {
    const Vec3 known = z.col(row);
    each_block(row, [&](const Mat3& L, int column) { z.col(column) -= L.transpose() * known; });
  }
  return dot(r, z);
}

/// Rows in runs, their rigid motions, and Pᵀ A P.
struct TwoLevel::Coarse {
  std::vector<int> run;
  std::vector<Mat36> motion;
  std::vector<int> column_begin = {0}, row;
  std::vector<double> values;

  Coarse(const linear::BlockMatrix& matrix, const Points& rest) {
    constexpr int kRows = 16;
    const int num_rows = matrix.num_rows();
    const int num_runs = std::max(1, num_rows / kRows);
    for (int r = 0; r < num_rows; ++r) run.push_back(static_cast<int>(std::int64_t{r} * num_runs / num_rows));
    add_motions(rest, num_runs);

    std::map<std::pair<int, int>, Mat6> blocks;  // by column, then row
    for (std::size_t r = 0; r < run.size(); ++r)
      for (int b = matrix.row_begin[r]; b < matrix.row_begin[r + 1]; ++b) {
        const auto c = static_cast<std::size_t>(matrix.column[static_cast<std::size_t>(b)]);
        if (run[r] < run[c]) continue;
        Mat6& block = blocks.try_emplace({run[c], run[r]}, Mat6::Zero()).first->second;
        block += motion[r].transpose() * matrix.block(b) * motion[c];
      }
    for (auto first = blocks.begin(); first != blocks.end();) {
      const auto last = blocks.upper_bound({first->first.first, num_runs});
      for (int k = 0; k < 6; ++k) {
        for (auto at = first; at != last; ++at)
          for (int i = at == first ? k : 0; i < 6; ++i) {
            row.push_back(6 * at->first.second + i);
            values.push_back(at->second(i, k));
          }
        column_begin.push_back(static_cast<int>(row.size()));
      }
      first = last;
    }
  }

  /// Three translations, and turns about the middle of a run by as much as move its rows about as far.
  void add_motions(const Points& rest, int num_runs) {
    Points middle = Points::Zero(3, num_runs);
    Field count = Field::Zero(num_runs), size = Field::Zero(num_runs);
    for (std::size_t r = 0; r < run.size(); ++r) {
      middle.col(run[r]) += rest.col(static_cast<Eigen::Index>(r));
      count(run[r]) += 1.0;
    }
    middle.array().rowwise() /= count.array().transpose();
    for (std::size_t r = 0; r < run.size(); ++r)
      size(run[r]) += (rest.col(static_cast<Eigen::Index>(r)) - middle.col(run[r])).norm() / count(run[r]);
    for (std::size_t r = 0; r < run.size(); ++r) {
      const Vec3 arm = (rest.col(static_cast<Eigen::Index>(r)) - middle.col(run[r])) / size(run[r]);
      Mat36& of_row = motion.emplace_back();
      of_row.leftCols<3>().setIdentity();
      for (int k = 0; k < 3; ++k) of_row.col(3 + k) = Vec3::Unit(k).cross(arm);
    }
  }
};

TwoLevel::TwoLevel(const linear::BlockMatrix& matrix, const Points& rest)
    : TwoLevel(matrix, Coarse(matrix, rest)) {}

TwoLevel::TwoLevel(const linear::BlockMatrix& matrix, const Coarse& coarse)
    : m_jacobi(1),
      m_run(coarse.run),
      m_motion(coarse.motion),
      m_factor(coarse.column_begin, coarse.row),
      m_in(coarse.column_begin.size() - 1),
      m_out(m_in.size()) {
  linear::MatrixOperator product(matrix, 1);
  m_jacobi.update(matrix, product);
  std::copy(coarse.values.begin(), coarse.values.end(), m_factor.values().begin());
  ARGIL_ASSERT(m_factor.factorise());
}

double TwoLevel::apply(const Points& r, Points& z) {
  using Vec6Map = Eigen::Map<Vec6>;
  m_jacobi.apply(r, z);
  std::fill(m_in.begin(), m_in.end(), 0.0);
  for (std::size_t row = 0; row < m_run.size(); ++row)
    Vec6Map(&m_in[6 * static_cast<std::size_t>(m_run[row])]) +=
        m_motion[row].transpose() * r.col(static_cast<Eigen::Index>(row));
  m_factor.solve(m_in, m_out);
  for (std::size_t row = 0; row < m_run.size(); ++row)
    z.col(static_cast<Eigen::Index>(row)) +=
        m_motion[row] * Vec6Map(&m_out[6 * static_cast<std::size_t>(m_run[row])]);
  return dot(r, z);
}

}  // namespace argil::bench
