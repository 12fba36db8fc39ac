#include "sim/plastic_flow.h"

#include <algorithm>
#include <bit>

#include "base/lanes.h"
#include "material/plasticity.h"
#include "solid/hencky_lanes.h"

namespace argil::sim {

PlasticFlow::PlasticFlow(const Params& params, const solid::Body& solid, const solid::ActiveRegion& region)
    : m_params(params), m_solid(solid), m_region(region) {
  m_split = find_law(params.solid.model).plastic_split;
  m_rule = material::make_flow_rule(params.plasticity, params.rates.step_seconds());
  m_is_flowing.resize(static_cast<std::size_t>(solid.model.elements.num_tets() / kLanes + 1), 0);
  m_was_flowing = m_is_flowing;
}

void PlasticFlow::commit() {
  m_was_anywhere = m_is_anywhere;
  if (m_params.plasticity.enabled) m_was_flowing = m_is_flowing;
}

void PlasticFlow::roll_back() {
  m_is_anywhere = m_was_anywhere;
  m_is_flowing = m_was_flowing;
}

void PlasticFlow::serialize(Archive& archive) {
  archive.number("flow/is_anywhere", m_is_anywhere);
  if (!m_solid.model.params.flows_in_solve || m_split != solid::PlasticSplit::logarithmic) return;
  archive.list("flow/is_flowing", m_is_flowing);
}

double PlasticFlow::apply(TensorField& plastic_strain) {
  if (!m_params.plasticity.enabled || m_split == solid::PlasticSplit::none) return 0.0;
  const solid::Elements& elements = m_solid.model.elements;
  const double dissipated =
      m_region.part().batches.sum(elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        bool is_flowing = false;
        double of_run = 0.0;
        solid::each_points(elements, begin, end, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
          of_run += apply_to_points(first, last, plastic_strain, is_flowing);
        });
        m_is_flowing[static_cast<std::size_t>(begin / kLanes)] = is_flowing;
        return of_run;
      });
  m_is_anywhere = is_flowing_anywhere();
  return dissipated;
}

/// By the stress, not the strain?
bool PlasticFlow::is_driven() const {
  return m_split != solid::PlasticSplit::logarithmic && m_params.plasticity.deviatoric &&
         (!m_solid.materials.is_isotropic() || m_split == solid::PlasticSplit::multiplicative);
}

/// Does any run of tets that moves?
bool PlasticFlow::is_flowing_anywhere() const {
  const std::vector<int>* batches = m_region.part().batches.list();
  if (!batches) return std::any_of(m_is_flowing.begin(), m_is_flowing.end(), [](char c) { return c != 0; });
  return std::any_of(batches->begin(), batches->end(),
                     [&](int batch) { return m_is_flowing[static_cast<std::size_t>(batch)] != 0; });
}

/// Of at most kLanes points, which are not looked at one by one where none of them flows.
double PlasticFlow::apply_to_points(std::ptrdiff_t begin, std::ptrdiff_t end, TensorField& plastic_strain,
                                    bool& is_flowing) const {
  if (m_split == solid::PlasticSplit::logarithmic) return flow_by_law(begin, end, plastic_strain, is_flowing);
  unsigned flowing =
      is_driven() ? (1U << (end - begin)) - 1U
                  : material::find_flowing(m_solid.kinematics.strain().data(), plastic_strain.data(),
                                           m_solid.materials.yield().data(), m_params.plasticity, begin, end);
  is_flowing = is_flowing || flowing != 0;
  double dissipated = 0.0;
  for (; flowing != 0; flowing &= flowing - 1)
    dissipated += apply_to_point(static_cast<int>(begin) + std::countr_zero(flowing), plastic_strain);
  return dissipated;
}

/// Of a law that lets them flow itself. Shape alone is dissipated: μ V of the squares.
double PlasticFlow::flow_by_law(std::ptrdiff_t begin, std::ptrdiff_t end, TensorField& plastic_strain,
                                bool& is_flowing) const {
  double squares[kLanes];
  unsigned flowed =
      find_law(m_params.solid.model)
          .flow({m_solid.kinematics.strain().data(), plastic_strain.data(), m_solid.materials.yield().data(),
                 m_rule, m_solid.elastic.arrays(), m_solid.model.params.flows_in_solve},
                begin, end, squares);
  is_flowing = is_flowing || flowed != 0;
  double dissipated = 0.0;
  for (; flowed != 0; flowed &= flowed - 1) {
    const int lane = std::countr_zero(flowed);
    const int point = static_cast<int>(begin) + lane;
    dissipated += m_solid.materials.of(m_solid.model.elements.tet_of_point(point)).mu *
                  m_solid.materials.weight()(point) * squares[lane];
  }
  return dissipated;
}

/// Returns what flow dissipates [J]: at fixed strain, the elastic energy that it releases. Energy is no
/// quadratic function of ε_p in a multiplicative split: there a long step of flow is halved until it releases
/// energy.
double PlasticFlow::apply_to_point(int point, TensorField& plastic_strain) const {
  constexpr int kHalvings = 10;
  const Vec6 before = plastic_strain.col(point);
  Vec6 after = compute_flow(point, before);
  if ((after.array() == before.array()).all()) return 0.0;
  const solid::Strained body = m_solid.strained();
  const double energy = solid::compute_elastic_energy(body, point, before);
  double released = energy - solid::compute_elastic_energy(body, point, after);
  for (int k = 0; m_split == solid::PlasticSplit::multiplicative && released < 0.0 && k < kHalvings; ++k) {
    after = k + 1 < kHalvings ? Vec6(0.5 * (before + after)) : before;
    released = energy - solid::compute_elastic_energy(body, point, after);
  }
  plastic_strain.col(point) = after;
  return released;
}

/// ε_p of a point after a step's flow.
Vec6 PlasticFlow::compute_flow(int point, const Vec6& before) const {
  const int tet = m_solid.model.elements.tet_of_point(point);
  material::FlowPoint at{m_solid.materials.of(tet).yield};
  Vec6 drive;
  if (is_driven()) {
    const solid::Strained body = m_solid.strained();
    drive = solid::compute_flow_drive(body.law(), body.kinematics.at(point), before, body.elasticity(tet),
                                      body.materials.shape_stiffness(tet));
    at.drive = &drive;
  }
  return material::compute_plastic_strain(m_solid.kinematics.strain().col(point), before, at,
                                          m_params.plasticity, m_params.rates.step_seconds());
}

}  // namespace argil::sim
