#include "sim/body_materials.h"

#include <algorithm>
#include <cmath>

#include "material/plasticity.h"
#include "solid/material_changes.h"

namespace argil::sim {

BodyMaterials::BodyMaterials(const Body& body, const Params& params, const water::PoreWater& water,
                             solid::Body& solid, solid::ActiveRegion& region)
    : m_body(body),
      m_params(params),
      m_water(water),
      m_solid(solid),
      m_region(region),
      m_moisture(params.elastic, material::compute_yield_strain(params.plasticity, params.elastic),
                 params.moisture, params.water.porosity),
      m_saturation_used(water.saturation()),
      m_needs_shape_stiffness(params.plasticity.enabled && params.plasticity.deviatoric) {
  m_changed.reserve(static_cast<std::size_t>(body.mesh.num_tets()));
  m_used_before.reserve(m_changed.capacity());
}

void BodyMaterials::set_all() {
  for (int t = 0; t < m_body.mesh.num_tets(); ++t) set(t, m_water.saturation()(t));
}

void BodyMaterials::set(int tet, double S) {
  m_saturation_used(tet) = S;
  const bool has_own_modulus = m_body.youngs_modulus.size() > 0;
  const double E = has_own_modulus ? m_body.youngs_modulus(tet) : m_params.elastic.youngs_modulus;
  const material::MoistState moist = has_own_modulus ? m_moisture.at(S, E) : m_moisture.at(S);
  // A strength is alike in tets of any modulus; a yield strain is alike too, and stronger where it is
  // stiffer.
  const double share =
      has_own_modulus && m_params.plasticity.strength > 0.0 ? m_params.elastic.youngs_modulus / E : 1.0;
  solid::set_material(m_solid, m_region, tet, {moist.lambda, moist.mu, share * moist.yield});
  if (m_params.water.swelling > 0.0) solid::set_swelling(m_solid, tet, 1.0 + m_params.water.swelling * S);
  if (m_params.water.adds_mass) solid::set_water_mass(m_solid, tet, m_water.capacity(tet) * S);
  if (m_moisture.is_isotropic()) return;
  const Vec3 axis =
      m_body.pore_axis.cols() > 0 ? Vec3(m_body.pore_axis.col(tet)) : m_params.moisture.medium.axis;
  const Mat6 C = has_own_modulus ? m_moisture.stiffness_at(S, axis, E) : m_moisture.stiffness_at(S, axis);
  solid::set_stiffness(m_solid, tet, C, m_needs_shape_stiffness ? material::compute_shape_stiffness(C) : 0.0);
}

std::span<const int> BodyMaterials::refresh(double tolerance) {
  const std::size_t first = m_changed.size();
  const auto collect = [&](std::span<const int> tets) {
    for (const int t : tets)
      if (std::abs(m_water.saturation()(t) - m_saturation_used(t)) > tolerance) m_changed.push_back(t);
  };
  collect(m_water.active());
  collect(m_water.dried());
  const auto begin = m_changed.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, m_changed.end());
  m_changed.erase(std::unique(begin, m_changed.end()), m_changed.end());  // dried, and wet again
  const std::span<const int> changed = std::span(m_changed).subspan(first);
  m_used_before.resize(first);
  for (const int t : changed) {
    m_used_before.push_back(m_saturation_used(t));
    set(t, m_water.saturation()(t));
  }
  return changed;
}

void BodyMaterials::roll_back() {
  for (std::size_t i = m_changed.size(); i-- > 0;) set(m_changed[i], m_used_before[i]);
  m_changed.clear();
}

void BodyMaterials::serialize(Archive& archive) {
  archive.array("materials/saturation", m_saturation_used);
  if (archive.is_restoring())
    for (int t = 0; t < m_body.mesh.num_tets(); ++t) set(t, m_saturation_used(t));
}

}  // namespace argil::sim
