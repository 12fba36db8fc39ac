#pragma once

#include <cstddef>

namespace argil::linear {

// Rows begin … end−1 of vectors with three numbers a row.

/// a·b
double compute_dot(const double* a, const double* b, std::ptrdiff_t begin, std::ptrdiff_t end);

/// What an iteration of conjugate gradients changes.
struct Iterate {
  double* p = nullptr;  ///< direction
  double* q = nullptr;  ///< A p
  double* x = nullptr;
  double* r = nullptr;  ///< b − A x
};

/// p = z + β p, q = w + β q, x += α p, r −= α q; returns r·r.
double advance(double alpha, double beta, const double* z, const double* w, std::ptrdiff_t begin,
               std::ptrdiff_t end, const Iterate& to);

/// z = D⁻¹ r with the 3×3 blocks of D⁻¹ column by column, one number after the last; returns r·z.
double apply_blocks(const double* inverse, const double* r, std::ptrdiff_t begin, std::ptrdiff_t end,
                    double* z);

}  // namespace argil::linear
