#pragma once

#include <span>

#include "linear/operator.h"
#include "solid/part.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

/// force = K u, where K takes the stiffness with kept rotations `kept` times and the tangent `exact` times;
/// 3×n both.
void compute_stiffness_product(Body& body, const Part& part, const Points& u, double kept, double exact,
                               Points& force);

/// A x for the matrix of a step: by its blocks, or tet by tet where the solver wants none stored.
class Product final : public linear::Operator {
 public:
  Product(Body& body, const Part& part, std::span<const PointStiffness> contacts)
      : m_body(body), m_part(part), m_contacts(contacts) {}

  double multiply(const Points& x, Points& y) override;
  /// y = A x with the present rotations, where those of the stored matrix lag; rows of the part. For
  /// isotropic laws of 4-node tets.
  void multiply_present(const Points& x, Points& y);

  bool has_unstored() const override;
  double add_unstored(const float* x, float* y) override;
  void add_unstored_diagonal(Eigen::Matrix3Xd& blocks) override;

 private:
  double multiply_tets(const Points& x, Points& y);

  Body& m_body;
  const Part& m_part;
  std::span<const PointStiffness> m_contacts;
};

}  // namespace argil::solid
