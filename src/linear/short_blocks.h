#pragma once

#include <cstdint>
#include <vector>

#include "linear/block_matrix.h"
#include "linear/operator.h"

namespace argil::linear {

/// A matrix and the inverses of its diagonal blocks in floats, for products that read half the memory: off by
/// 1e-7 of Σ|A||x|. Vectors have four numbers a row, the last of them 0.
class ShortBlocks {
 public:
  /// Takes the memory for matrices of this pattern; update does the same.
  void prepare(const BlockMatrix& pattern);
  /// Takes the rows that have changed since the last update; the inverses hold what `whole` does not store,
  /// too.
  void update(const BlockMatrix& matrix, Operator& whole, const OrderedRuns& runs);

  /// What an iteration of conjugate gradients changes.
  struct Iterate {
    float* p = nullptr;  ///< direction
    float* q = nullptr;  ///< A p
    float* x = nullptr;
    float* r = nullptr;  ///< b − A x
  };
  struct Sums {
    double rr = 0.0;  ///< r·r
    double rz = 0.0;  ///< r·D⁻¹ r
  };

  // Rows begin … end−1:
  double multiply(std::ptrdiff_t begin, std::ptrdiff_t end, const float* x,
                  float* y) const;  ///< y = A x, x·y
  /// yₖ = A xₖ of several x, for which the matrix is read once.
  static constexpr int kSeveral = 3;
  void multiply_several(std::ptrdiff_t begin, std::ptrdiff_t end, const float* const (&x)[kSeveral],
                        float* const (&y)[kSeveral]) const;
  /// Of several x and y with one another, i ≥ k, and of x with r.
  struct Products {
    double xy[kSeveral][kSeveral] = {};  ///< [k][i]: xᵢ·yₖ
    double xr[kSeveral] = {};
  };
  static Products compute_products(std::ptrdiff_t begin, std::ptrdiff_t end,
                                   const float* const (&x)[kSeveral], const float* const (&y)[kSeveral],
                                   const float* r);
  /// x = Σ aₖ dₖ, r −= Σ aₖ yₖ.
  static void combine(std::ptrdiff_t begin, std::ptrdiff_t end, const float (&a)[kSeveral],
                      const float* const (&d)[kSeveral], const float* const (&y)[kSeveral], float* x,
                      float* r);
  /// p = z + β p, q = w + β q, x += α p, r −= α q; then D⁻¹ r in the place of w.
  Sums advance(std::ptrdiff_t begin, std::ptrdiff_t end, float alpha, float beta, const float* z, float* w,
               const Iterate& to) const;

 private:
  void set_inverse(std::ptrdiff_t row, const Mat3& block);

  const BlockMatrix* m_pattern = nullptr;
  std::vector<float> m_values;            // 9 a block
  std::vector<std::uint32_t> m_revision;  // of the rows that they are
  Eigen::Matrix3Xd m_diagonal;
  std::vector<float> m_inverse;  // of the diagonal blocks, 3 columns of four a row
};

}  // namespace argil::linear
