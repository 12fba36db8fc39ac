#include "linear/cholesky.h"

#include <cholmod.h>

#include <algorithm>
#include <new>

#include "base/check.h"

namespace argil::linear {

struct SparseCholesky::Impl {
  cholmod_common common;
  cholmod_sparse* lower = nullptr;  // lower triangle, compressed columns
  cholmod_factor* factor = nullptr;
  cholmod_dense* rhs = nullptr;
  cholmod_dense* solution = nullptr;
  cholmod_dense* work_y = nullptr;
  cholmod_dense* work_e = nullptr;

  explicit Impl(FactorKind kind) {
    cholmod_start(&common);
    common.supernodal = kind == FactorKind::supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    common.final_ll = 0;
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
  }
  ~Impl() {
    cholmod_free_dense(&work_e, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&rhs, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&lower, &common);
    cholmod_finish(&common);
  }
  /// Throws bad_alloc when the last call wanted more memory than there is, or than an int can count.
  void check_memory() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) throw std::bad_alloc();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

SparseCholesky::SparseCholesky(const std::vector<int>& column_begin, const std::vector<int>& row,
                               FactorKind kind)
    : m_impl(std::make_unique<Impl>(kind)) {
  Impl& impl = *m_impl;
  const std::size_t n = column_begin.size() - 1;
  impl.lower = cholmod_allocate_sparse(n, n, row.size(), 1, 1, -1, CHOLMOD_REAL, &impl.common);
  impl.check_memory();
  std::copy(column_begin.begin(), column_begin.end(), static_cast<int*>(impl.lower->p));
  std::copy(row.begin(), row.end(), static_cast<int*>(impl.lower->i));
  impl.factor = cholmod_analyze(impl.lower, &impl.common);
  impl.check_memory();
  ARGIL_ASSERT(impl.factor != nullptr && impl.common.status == CHOLMOD_OK, impl.common.status);
  impl.rhs = cholmod_allocate_dense(n, 1, n, CHOLMOD_REAL, &impl.common);
  impl.check_memory();
}

std::span<double> SparseCholesky::values() {
  return {static_cast<double*>(m_impl->lower->x), m_impl->lower->nzmax};
}

bool SparseCholesky::factorise() {
  Impl& impl = *m_impl;
  cholmod_factorize(impl.lower, impl.factor, &impl.common);
  impl.check_memory();
  if (impl.common.status != CHOLMOD_OK || impl.factor->minor != impl.factor->n) return false;
  if (impl.factor->is_super) return true;
  // LDLᵀ of an indefinite matrix succeeds; its D shows it.
  const double* l = static_cast<double*>(impl.factor->x);
  const int* p = static_cast<int*>(impl.factor->p);
  for (std::size_t j = 0; j < impl.factor->n; ++j)
    if (!(l[p[j]] > 0.0)) return false;
  return true;
}

void SparseCholesky::solve(std::span<const double> b, std::span<double> x) {
  Impl& impl = *m_impl;
  ARGIL_ASSERT(b.size() == impl.factor->n && x.size() == b.size(), b.size(), x.size());
  std::copy(b.begin(), b.end(), static_cast<double*>(impl.rhs->x));
  const int solved = cholmod_solve2(CHOLMOD_A, impl.factor, impl.rhs, nullptr, &impl.solution, nullptr,
                                    &impl.work_y, &impl.work_e, &impl.common);
  impl.check_memory();
  ARGIL_ASSERT(solved == 1, impl.common.status);
  std::copy_n(static_cast<const double*>(impl.solution->x), x.size(), x.begin());
}

double SparseCholesky::num_entries() const {
  return m_impl->common.lnz;
}

/// Numbers of the lower triangle of a block matrix, and where each is found in it.
struct CholeskyFactor::Pattern {
  std::vector<int> column_begin = {0};
  std::vector<int> row;
  std::vector<int> source;

  /// Block row r of the stored matrix is block column r of the lower triangle because the matrix is
  /// symmetric.
  explicit Pattern(const BlockMatrix& matrix) {
    for (int r = 0; r < matrix.num_rows(); ++r)
      for (int k = 0; k < 3; ++k) {  // scalar column 3r+k holds A(3c+i, 3r+k) = block(r, c)(k, i)
        for (int b = matrix.row_begin[static_cast<std::size_t>(r)];
             b < matrix.row_begin[static_cast<std::size_t>(r) + 1]; ++b) {
          const int c = matrix.column[static_cast<std::size_t>(b)];
          if (c < r) continue;
          for (int i = (c == r ? k : 0); i < 3; ++i) {
            row.push_back(3 * c + i);
            source.push_back(9 * b + 3 * i + k);
          }
        }
        column_begin.push_back(static_cast<int>(row.size()));
      }
  }
};

CholeskyFactor::CholeskyFactor(const BlockMatrix& pattern, FactorKind kind)
    : CholeskyFactor(Pattern(pattern), kind) {}

CholeskyFactor::CholeskyFactor(const Pattern& pattern, FactorKind kind)
    : m_sparse(pattern.column_begin, pattern.row, kind), m_source(pattern.source) {}

bool CholeskyFactor::factorise(const BlockMatrix& matrix) {
  const std::span<double> values = m_sparse.values();
  const double* from = matrix.values.data();
  for (std::size_t s = 0; s < m_source.size(); ++s) values[s] = from[m_source[s]];
  return m_sparse.factorise();
}

void CholeskyFactor::solve(const Points& b, Points& x) {
  const auto n = static_cast<std::size_t>(b.size());
  x.resize(3, b.cols());
  m_sparse.solve({b.data(), n}, {x.data(), n});
}

}  // namespace argil::linear
