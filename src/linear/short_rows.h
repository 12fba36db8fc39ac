#pragma once

#include <cstddef>

namespace argil::linear {

/// Where a row's pairs of blocks are: below the diagonal begin … middle−1, above middle … end−1.
struct RowParts {
  int begin, middle, end;
};

/// A matrix A = D (L + 1 + U) in floats, D its diagonal blocks, L what is before them in the order of sweeps,
/// U what is after. Blocks of L and U lie in pairs, column by column side by side, so that six numbers of two
/// blocks meet those of x at once. Vectors have four numbers a row, the last of them 0.
struct ShortRows {
  static constexpr int kPair = 18;  ///< numbers of a pair
  const RowParts* parts;
  const int* column;      ///< two a pair; those of U fall: what a sweep found last comes last
  const float* values;    ///< kPair a pair, and two more
  const float* diagonal;  ///< D, 3 columns of four a row
  const float* inverse;   ///< of D, or of D and what is not stored, likewise
};

// Over the rows `rows[begin]` … `rows[end − 1]`, forwards or backwards:

struct Substituted {
  double squares = 0.0;  ///< r·r
  double scaled = 0.0;   ///< ρ·D ρ
};
/// ρ = (1+L)⁻¹ D⁻¹ r.
Substituted substitute(const ShortRows& a, const int* rows, int begin, int end, const float* r, float* rho);
/// p = ρ + β p, t = (1+U)⁻¹ p; backwards.
void sweep_back(const ShortRows& a, const int* rows, int begin, int end, float beta, const float* rho,
                float* p, float* t);
/// s = (1+L)⁻¹ (p − t); returns p·D (t + s), which is t·A t.
double sweep_forth(const ShortRows& a, const int* rows, int begin, int end, const float* p, const float* t,
                   float* s);

// Over rows begin … end−1:

/// ‖D (1+L) ρ‖².
double compute_squares(const ShortRows& a, std::ptrdiff_t begin, std::ptrdiff_t end, const float* rho);
/// x += α t, ρ −= α (t + s); returns ρ·D ρ.
double advance(const ShortRows& a, std::ptrdiff_t begin, std::ptrdiff_t end, float alpha, const float* t,
               const float* s, float* x, float* rho);
/// y = A x; returns x·y.
double multiply(const ShortRows& a, std::ptrdiff_t begin, std::ptrdiff_t end, const float* x, float* y);
/// yₖ = A xₖ of three x, for which the matrix is read once.
void multiply_three(const ShortRows& a, std::ptrdiff_t begin, std::ptrdiff_t end, const float* const (&x)[3],
                    float* const (&y)[3]);

/// What an iteration of conjugate gradients over the diagonal blocks changes.
struct ShortIterate {
  float* p = nullptr;  ///< direction
  float* q = nullptr;  ///< A p
  float* x = nullptr;
  float* r = nullptr;  ///< b − A x
};
struct ShortSums {
  double rr = 0.0;  ///< r·r
  double rz = 0.0;  ///< r·z
};
/// p = z + β p, q = w + β q, x += α p, r −= α q; then z = `inverse` r in the place of w.
ShortSums advance_blocks(const ShortRows& a, std::ptrdiff_t begin, std::ptrdiff_t end, float alpha,
                         float beta, const float* z, float* w, const ShortIterate& to);

/// One row's pairs from its blocks in double, times the inverse of the diagonal block: `source` holds a
/// block's place in `from` for each column, −1 for none.
void take_pairs(const double* from, const int* source, int begin, int end, const float* inverse,
                float* values);

}  // namespace argil::linear
