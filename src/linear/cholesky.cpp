#include "linear/cholesky.h"

#include <cholmod.h>

#include <algorithm>
#include <utility>

#include "base/check.h"

namespace argil::linear {

struct CholeskyFactor::Impl {
  cholmod_common common;
  cholmod_sparse* lower = nullptr;  // lower triangle, compressed columns
  cholmod_factor* factor = nullptr;
  cholmod_dense* rhs = nullptr;
  cholmod_dense* solution = nullptr;
  cholmod_dense* work_y = nullptr;
  cholmod_dense* work_e = nullptr;
  std::vector<int> source;  // for each stored scalar: its place in BlockMatrix::values

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
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

CholeskyFactor::~CholeskyFactor() = default;
CholeskyFactor::CholeskyFactor(CholeskyFactor&&) noexcept = default;
CholeskyFactor& CholeskyFactor::operator=(CholeskyFactor&&) noexcept = default;

CholeskyFactor::CholeskyFactor(const BlockMatrix& pattern, FactorKind kind)
    : m_impl(std::make_unique<Impl>(kind)) {
  Impl& impl = *m_impl;
  const int rows = pattern.num_rows();
  // Block row r of the stored matrix is block column r of the lower triangle because the matrix is symmetric.
  std::size_t count = 0;
  for (int r = 0; r < rows; ++r)
    for (int b = pattern.row_begin[static_cast<std::size_t>(r)];
         b < pattern.row_begin[static_cast<std::size_t>(r) + 1]; ++b) {
      const int c = pattern.column[static_cast<std::size_t>(b)];
      count += c > r ? 9U : (c == r ? 6U : 0U);
    }
  const auto n = static_cast<std::size_t>(3 * rows);
  impl.lower = cholmod_allocate_sparse(n, n, count, 1, 1, -1, CHOLMOD_REAL, &impl.common);
  int* begin = static_cast<int*>(impl.lower->p);
  int* row_of = static_cast<int*>(impl.lower->i);
  impl.source.reserve(count);
  begin[0] = 0;
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k < 3; ++k) {  // scalar column 3r+k holds A(3c+i, 3r+k) = block(r, c)(k, i)
      for (int b = pattern.row_begin[static_cast<std::size_t>(r)];
           b < pattern.row_begin[static_cast<std::size_t>(r) + 1]; ++b) {
        const int c = pattern.column[static_cast<std::size_t>(b)];
        if (c < r) continue;
        for (int i = (c == r ? k : 0); i < 3; ++i) {
          row_of[impl.source.size()] = 3 * c + i;
          impl.source.push_back(9 * b + 3 * i + k);
        }
      }
      begin[3 * r + k + 1] = static_cast<int>(impl.source.size());
    }
  }
  impl.factor = cholmod_analyze(impl.lower, &impl.common);
  ARGIL_ASSERT(impl.factor != nullptr && impl.common.status == CHOLMOD_OK, impl.common.status);
  impl.rhs = cholmod_allocate_dense(n, 1, n, CHOLMOD_REAL, &impl.common);
}

bool CholeskyFactor::factorise(const BlockMatrix& matrix) {
  Impl& impl = *m_impl;
  double* values = static_cast<double*>(impl.lower->x);
  const double* from = matrix.values.data();
  for (std::size_t s = 0; s < impl.source.size(); ++s) values[s] = from[impl.source[s]];
  cholmod_factorize(impl.lower, impl.factor, &impl.common);
  if (impl.common.status != CHOLMOD_OK || impl.factor->minor != impl.factor->n) return false;
  if (impl.factor->is_super) return true;
  // LDLᵀ of an indefinite matrix succeeds; its D shows it.
  const double* l = static_cast<double*>(impl.factor->x);
  const int* p = static_cast<int*>(impl.factor->p);
  for (std::size_t j = 0; j < impl.factor->n; ++j)
    if (!(l[p[j]] > 0.0)) return false;
  return true;
}

void CholeskyFactor::solve(const Points& b, Points& x) {
  Impl& impl = *m_impl;
  std::copy_n(b.data(), b.size(), static_cast<double*>(impl.rhs->x));
  const int solved = cholmod_solve2(CHOLMOD_A, impl.factor, impl.rhs, nullptr, &impl.solution, nullptr,
                                    &impl.work_y, &impl.work_e, &impl.common);
  ARGIL_ASSERT(solved == 1, impl.common.status);
  x.resize(3, b.cols());
  std::copy_n(static_cast<const double*>(impl.solution->x), b.size(), x.data());
}

double CholeskyFactor::num_entries() const {
  return m_impl->common.lnz;
}

}  // namespace argil::linear
