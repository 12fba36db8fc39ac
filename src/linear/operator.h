#pragma once

#include "base/types.h"

namespace argil::linear {

struct SolveReport {
  bool converged = false;
  int iterations = 0;              ///< 0: solved by a factor
  double relative_residual = 0.0;  ///< ‖b − A x‖₂ over its value at the first guess, by recurrence; of a
                                   ///< factor over ‖b‖₂; infinite: A was seen not to be positive definite
};

/// A symmetric positive definite matrix by its product alone.
class Operator {
 public:
  virtual ~Operator() = default;
  /// y = A x; returns x·y. y has the shape of x.
  virtual double multiply(const Points& x, Points& y) = 0;

  // Where A is a stored matrix and something that is not stored:
  /// y += the latter times x; returns x · what was added.
  virtual double add_unstored(const Points&, Points&) { return 0.0; }
  /// Adds its diagonal blocks, 3×3 side by side.
  virtual void add_unstored_diagonal(Eigen::Matrix3Xd&) {}
};

}  // namespace argil::linear
