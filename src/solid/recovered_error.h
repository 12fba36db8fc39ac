#pragma once

#include "solid/strained.h"

namespace argil::solid {

/// What a mesh of this size adds to the work of a body's deformation.
struct MeshError {
  double error = 0.0;   ///< Σ V (ε* − ε):C:(ε* − ε), ε* the recovered strain [J]
  double stress = 0.0;  ///< Σ V σ:ε [J], twice an elastic body's energy, all of what flow dissipates
  double work = 0.0;    ///< that the deformation took: Σ V (½ σ:ε_e + σ:(ε − ε_e)) [J]
};

/// How much too stiff a mesh is, from the strain that it finds [Zienkiewicz1987]. ε* is linear in a tet
/// between means of the tets around its corners, which is nearer to the true strain than ε. For a tool that
/// goes where the hand takes it, F_h d − F d = a(e, e) and F_h d = a(u_h, u_h): the found displacement is its
/// own dual solution, so that error/stress is by how much of itself the force is too large.
///
/// Strain counts from a reference on. C is the secant stiffness: flow counts as if the clay were softer and
/// elastic. An anisotropic law counts as the isotropic one of its bulk and shape stiffness. p1_nodal's shared
/// volume change counts in `stress` alone.
class RecoveredError {
 public:
  /// Takes its memory here. `flows`: no more strain is elastic than the yield allows.
  RecoveredError(const Model& model, bool flows);

  /// Strain counts from the present one on.
  void set_reference(const Kinematics& kinematics) { m_reference = kinematics.strain(); }
  TensorField& reference() { return m_reference; }

  MeshError find(const Strained& body);

 private:
  /// Of C, and how much of the strain's deviator is elastic.
  struct Secant {
    double bulk = 0.0;   // K [Pa]
    double shape = 0.0;  // 2μ [Pa], less of what flows
    double elastic_share = 1.0;
    double square(const Vec6& a) const;  // a:C:a
  };
  Secant find_secant(const Strained& body, Eigen::Index tet, const Vec6& strain) const;
  void set_strains(const Strained& body, Eigen::Index tet);
  void average(const Strained& body, std::ptrdiff_t node);
  Vec6 at_corner(const Elements& elements, Eigen::Index tet, int corner) const;
  void add_tet(const Strained& body, Eigen::Index tet, MeshError& sum) const;

  bool m_is_bounded;        // ε_e of a law that knows it by a logarithm, which ε − ε_p nearly is
  TensorField m_reference;  // ε of each point, in the frame of R
  TensorField m_strain;     // ε less that, in that of the world
  TensorField m_mean;       // of the tets around each node
  Field m_volume;           // of each tet [m³]
  std::vector<MeshError> m_of_batch;
};

}  // namespace argil::solid
