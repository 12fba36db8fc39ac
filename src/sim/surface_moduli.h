#pragma once

#include <span>
#include <utility>
#include <vector>

#include "contact/pressure.h"
#include "sim/contact_surface.h"
#include "solid/body.h"

namespace argil::sim {

/// How stiff the body is under each triangle of the touched surface, for the pressure law.
///
/// Of the tet below with Young's modulus E, Poisson's ratio ν and the edge h of a regular tet of its size,
/// per node: E* = E/(1 − ν²), and κ = kChosenStiffness E*/h unless one is given. A patch of radius a yields
/// by some E*/a, so that κ is stiff against the body where a is two cells and more.
class SurfaceModuli {
 public:
  /// All are kept by reference.
  SurfaceModuli(const ContactSurface& surface, const solid::Body& solid,
                const contact::ContactParams& params);

  contact::SurfaceStiffness find_all() const;
  /// Appends what now holds for the triangles above these tets.
  void find_above(std::span<const int> tets, std::vector<contact::StiffnessOfTriangle>& out) const;

 private:
  double find_cell(int tet) const;
  contact::StiffnessOfTriangle find(int triangle, int tet) const;
  bool is_held(int triangle) const;

  const ContactSurface& m_surface;
  const solid::Body& m_solid;
  const contact::ContactParams& m_params;
  std::vector<std::pair<int, int>> m_above;  // tet and triangle, increasing
};

}  // namespace argil::sim
