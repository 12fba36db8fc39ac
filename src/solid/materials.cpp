#include "solid/materials.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace argil::solid {

Materials::Materials(const Model& model)
    : m_model(model),
      m_mass(model.params.density * model.elements.node_volume),
      m_static_mass(model.params.density * model.elements.shape_volume) {
  const Eigen::Index num_tets = model.elements.num_tets();
  m_lambda.setZero(num_tets);
  m_mu.setZero(num_tets);
  m_yield.setZero(model.elements.num_points());
  if (model.elements.points_per_tet > 1) {
    m_point_lambda.setZero(m_yield.size());
    m_point_mu.setZero(m_yield.size());
  }
  if (!model.has_nodal_volume()) return;
  m_own_lambda.setZero(num_tets);
  m_excess_bulk.setZero(num_tets);
  m_nodal = std::make_unique<NodalVolume>(model.elements, model.row_of_node, model.threads);
}

void Materials::set_moduli(int tet, const TetMaterial& material) {
  m_lambda(tet) = material.lambda;
  m_mu(tet) = material.mu;
  const Eigen::Index Q = m_model.elements.points_per_tet;
  m_yield.segment(Q * tet, Q).setConstant(material.yield);
  if (Q > 1) {
    m_point_lambda.segment(Q * tet, Q).setConstant(material.lambda);
    m_point_mu.segment(Q * tet, Q).setConstant(material.mu);
  }
  if (!m_C.empty()) {
    m_C[static_cast<std::size_t>(tet)] = make_isotropic_stiffness(material.lambda, material.mu);
    m_shape_stiffness[static_cast<std::size_t>(tet)] = 2.0 * material.mu;
  }
  if (!m_nodal) return;
  const double own_bulk = NodalVolume::kOwnBulkOverShear * material.mu;
  m_excess_bulk(tet) = std::max(0.0, material.lambda + 2.0 / 3.0 * material.mu - own_bulk);
  m_own_lambda(tet) = material.lambda - m_excess_bulk(tet);
  m_nodal->set_excess(tet, m_excess_bulk(tet), weight()(tet));
}

void Materials::set_stiffness(int tet, const Mat6& C, double shape_stiffness) {
  ARGIL_ASSERT(find_law(m_model.params.model).takes_full_stiffness && !m_nodal);
  if (m_C.empty())
    for (Eigen::Index t = 0; t < m_lambda.size(); ++t) {
      m_C.push_back(make_isotropic_stiffness(m_lambda(t), m_mu(t)));
      m_shape_stiffness.push_back(2.0 * m_mu(t));
    }
  m_C[static_cast<std::size_t>(tet)] = C;
  m_shape_stiffness[static_cast<std::size_t>(tet)] = shape_stiffness;
}

void Materials::set_swelling(int tet, double volume_ratio) {
  ARGIL_ASSERT(volume_ratio > 0.0, tet, volume_ratio);
  const Elements& dry = m_model.elements;
  if (m_swollen_weight.size() == 0) {
    m_swollen_gradient = dry.gradient;
    m_swollen_weight = dry.weight;
  }
  const Eigen::Index Q = dry.points_per_tet;
  const Eigen::Index columns = 4 * Q;
  m_swollen_gradient.middleCols(columns * tet, columns) =
      dry.gradient.middleCols(columns * tet, columns) / std::cbrt(volume_ratio);
  m_swollen_weight.segment(Q * tet, Q) = volume_ratio * dry.weight.segment(Q * tet, Q);
  if (m_nodal) m_nodal->set_excess(tet, m_excess_bulk(tet), m_swollen_weight(tet));
}

/// Sums each of the tet's nodes anew, so that masses are a function of the water alone, not of its history.
void Materials::set_water_mass(int tet, double mass) {
  const Elements& elements = m_model.elements;
  if (m_water_mass.size() == 0) m_water_mass.setZero(elements.num_tets());
  m_water_mass(tet) = mass;
  const int N = elements.nodes_per_tet;
  for (const int node : elements.nodes.col(tet)) {
    double moving = 0.0, at_rest = 0.0;
    for (int c = elements.node_begin[static_cast<std::size_t>(node)];
         c < elements.node_begin[static_cast<std::size_t>(node) + 1]; ++c) {
      const int corner = elements.node_corners[static_cast<std::size_t>(c)];
      moving += m_water_mass(corner / N) * elements.mass_share(corner % N);
      at_rest += m_water_mass(corner / N) * elements.shape_share(corner / N, corner % N);
    }
    m_mass(node) = m_model.params.density * elements.node_volume(node) + moving;
    m_static_mass(node) = m_model.params.density * elements.shape_volume(node) + at_rest;
  }
}

TetMaterial Materials::of(int tet) const {
  return {m_lambda(tet), m_mu(tet),
          m_yield(static_cast<Eigen::Index>(m_model.elements.points_per_tet) * tet)};
}

Elasticity Materials::elasticity(int tet) const {
  Elasticity e{m_lambda(tet), m_mu(tet)};
  if (!m_C.empty()) e.C = &m_C[static_cast<std::size_t>(tet)];
  if (!m_nodal) return e;
  e.excess_bulk = m_excess_bulk(tet);
  e.lambda = m_own_lambda(tet);
  return e;
}

}  // namespace argil::solid
