#pragma once

#include <memory>
#include <vector>

#include "solid/law.h"
#include "solid/model.h"
#include "solid/nodal_volume.h"

namespace argil::solid {

/// Stiffness and strength of one tet as the water left them.
struct TetMaterial {
  double lambda = 0.0;  ///< [Pa]
  double mu = 0.0;      ///< [Pa]
  double yield = 0.0;   ///< elastic strain norm [–]
};

/// All that water changes in a body: moduli, yield, size and mass. No other place holds them.
class Materials {
 public:
  /// `model` must outlive it.
  explicit Materials(const Model& model);

  void set_moduli(int tet, const TetMaterial& material);
  /// C (Mandel) [Pa] of an anisotropic law; set_moduli makes the tet isotropic again. `shape_stiffness`: 2μ*
  /// of C [Pa] (material/plasticity.h); 0 where no flow asks for it.
  void set_stiffness(int tet, const Mat6& C, double shape_stiffness = 0.0);
  /// Rest volume of a tet over what it was made with (> 0): its shape at rest grows alike in all directions.
  void set_swelling(int tet, double volume_ratio);
  /// Mass [kg] of water in a tet, shared among its nodes like that of the clay.
  void set_water_mass(int tet, double mass);

  TetMaterial of(int tet) const;
  /// For p1_nodal split into the tet's own part and what acts on the nodes' mean volume change, which is not
  /// set.
  Elasticity elasticity(int tet) const;
  /// 2μ* [Pa] of the isotropic law nearest to a tet's.
  double shape_stiffness(int tet) const {
    return m_C.empty() ? 2.0 * m_mu(tet) : m_shape_stiffness[static_cast<std::size_t>(tet)];
  }
  bool is_isotropic() const { return m_C.empty(); }  ///< every tet

  const Field& lambda() const { return m_lambda; }  ///< of each tet [Pa]
  const Field& mu() const { return m_mu; }          ///< of each tet [Pa]
  /// Of each point [Pa]; λ that a tet keeps to itself: without p1_nodal's excess, which is κ [Pa].
  const Field& point_lambda() const {
    return m_nodal ? m_own_lambda : m_point_lambda.size() > 0 ? m_point_lambda : m_lambda;
  }
  const Field& point_mu() const { return m_point_mu.size() > 0 ? m_point_mu : m_mu; }
  const Field& excess_bulk() const { return m_excess_bulk; }
  const Field& yield() const { return m_yield; }  ///< of each point: elastic strain norm [–]

  // Of the shape at rest as it has grown; forces and energy are those of it.
  /// ∇λ [1/m] of the barycentric coordinates, four columns a point (find_node_gradients).
  const Eigen::Matrix3Xd& gradient() const {
    return m_swollen_weight.size() > 0 ? m_swollen_gradient : m_model.elements.gradient;
  }
  const Field& weight() const {  ///< volume of each point [m³]
    return m_swollen_weight.size() > 0 ? m_swollen_weight : m_model.elements.weight;
  }

  const Field& mass() const { return m_mass; }                ///< lumped, per node [kg]
  const Field& static_mass() const { return m_static_mass; }  ///< carries gravity in statics, per node [kg]

  /// p1_nodal: stiffness of the nodes' volume changes; else null.
  NodalVolume* nodal() const { return m_nodal.get(); }

 private:
  const Model& m_model;
  Field m_lambda, m_mu, m_yield;
  Field m_point_lambda, m_point_mu;   // where a tet has several
  Field m_own_lambda, m_excess_bulk;  // p1_nodal
  std::vector<Mat6> m_C;              // empty while every tet is isotropic, as is the next
  std::vector<double> m_shape_stiffness;
  Eigen::Matrix3Xd m_swollen_gradient;
  Field m_swollen_weight;  // empty without swelling
  Field m_mass, m_static_mass;
  Field m_water_mass;  // of each tet; empty without
  std::unique_ptr<NodalVolume> m_nodal;
};

}  // namespace argil::solid
