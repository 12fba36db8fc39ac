#pragma once

#include "base/types.h"

namespace argil::linear {

struct SolveReport {
  bool converged = false;
  int iterations = 0;              ///< 0: solved by a factor
  double relative_residual = 0.0;  ///< ‖b − A x‖₂ over its value at the first guess, by recurrence; of a
                                   ///< factor over ‖b‖₂; infinite: A was seen not to be positive definite
  double first = 0.0;         ///< ‖b − A x‖₂ of the first guess, of an iteration
  bool wants_stored = false;  ///< not converged, and may with a factor of all of A, were it stored
};

/// A symmetric positive definite matrix by its product alone.
class Operator {
 public:
  virtual ~Operator() = default;
  /// y = A x; returns x·y. y has the shape of x.
  virtual double multiply(const Points& x, Points& y) = 0;

  // Where A is a stored matrix and something that is not stored:
  virtual bool has_unstored() const { return false; }
  /// y += the latter times x; returns x · what was added. Rows of four floats, the last of
  /// them 0.
  virtual double add_unstored(const float* x, float* y);
  /// Adds its diagonal blocks, 3×3 side by side.
  virtual void add_unstored_diagonal(Eigen::Matrix3Xd&) {}
};

inline double Operator::add_unstored(const float* /*x*/, float* /*y*/) {
  return 0.0;
}

}  // namespace argil::linear
