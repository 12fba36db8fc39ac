// What a body side tells of itself: records of its steps, frames and the hash of its state.

#include "base/hash.h"
#include "mesh/order.h"
#include "mesh/quality.h"
#include "sim/body_side.h"

namespace argil::sim {

PhysicsRecord BodySide::make_record() {
  PhysicsRecord record;
  record.tick = m_state.hand.ticks;
  record.time = static_cast<double>(m_state.hand.ticks) * m_params.rates.haptic_period;
  record.kinetic_energy = solid::compute_kinetic_energy(m_solid.materials, m_region.part(), m_state.solid.v);
  const bool is_at_rest = m_state.is_at_rest;
  const solid::StrainSummary strain = is_at_rest
                                          ? m_economy.rest_strain()
                                          : solid::summarise(m_solid.strained(m_state.solid.plastic_strain),
                                                             m_solid.energies, m_solid.scratch.nodal.change);
  record.elastic_energy = strain.elastic_energy;
  record.plastic_dissipation = m_state.plastic_dissipation;
  record.contact_work = m_state.contact_work;
  record.water_mass = m_water.mass();
  record.water_added = m_water.ledger().added;
  record.water_removed = m_water.ledger().removed;
  record.iterations = m_solid.history.counters.linear_iterations;
  record.newton_iterations = m_solid.history.counters.newton_iterations;
  record.factorisations = m_solid.history.solver->cost().factorisations;
  record.residual = m_solid.history.counters.residual;
  record.active_nodes = is_at_rest ? 0 : m_region.num_active();
  record.min_volume_ratio = m_solid.kinematics.min_volume_ratio();
  record.max_plastic_strain =
      m_earlier_flow.size() == 0 ? strain.largest_plastic_strain : find_flow().colwise().norm().maxCoeff();
  record.epoch = m_body.epoch;
  record.limited_tets = m_limit.num_tets;
  record.limited_tet = m_limit.worst_tet;
  record.fidelity = m_economy.record();
  return record;
}

double BodySide::find_worst_shape() const {
  const Points& x = m_state.solid.x;
  const auto find_shape = [&x](int a, int b, int c, int d) {
    return mesh::compute_shape({x.col(a), x.col(b), x.col(c), x.col(d)});
  };
  double worst = 1.0;
  m_region.part().batches.each_in_order(
      m_solid.model.elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        for (std::ptrdiff_t tet = begin; tet < end; ++tet) {
          const auto n = m_solid.model.elements.nodes.col(tet);
          worst = std::min(worst, find_shape(n(0), n(1), n(2), n(3)));
          if (n.size() == 4) continue;
          worst = std::min({worst, find_shape(n(0), n(4), n(6), n(7)), find_shape(n(4), n(1), n(5), n(8)),
                            find_shape(n(6), n(5), n(2), n(9)), find_shape(n(7), n(8), n(9), n(3))});
        }
      });
  return worst;
}

/// ε_p of each tet: the mean of its points, whose weights are equal.
TensorField BodySide::mean_plastic_strain() const {
  const TensorField& at_points = m_state.solid.plastic_strain;
  const int Q = m_solid.model.elements.points_per_tet;
  if (Q == 1) return at_points;
  TensorField mean(6, m_body.mesh.num_tets());
  for (Eigen::Index t = 0; t < mean.cols(); ++t)
    mean.col(t) = at_points.middleCols(Q * t, Q).rowwise().mean();
  return mean;
}

TensorField BodySide::find_flow() const {
  if (m_earlier_flow.size() == 0) return mean_plastic_strain();
  return m_earlier_flow + mean_plastic_strain();
}

void BodySide::set_flow(const TensorField& flow) {
  m_earlier_flow = flow - mean_plastic_strain();
}

Frame BodySide::make_frame(const HandPose& hand) const {
  Frame frame;
  frame.tick = hand.ticks;
  frame.time = static_cast<double>(hand.ticks) * m_params.rates.haptic_period;
  frame.position = m_state.solid.x.leftCols(m_body.mesh.num_vertices());
  frame.saturation = mesh::in_file_order(m_body.mesh, m_water.saturation());
  frame.plastic_strain = mesh::in_file_order(m_body.mesh, find_flow());
  if (m_body.skin_embedding.num_points() > 0) {
    embed::interpolate_positions(m_body.skin_embedding, m_solid.model.elements.nodes, m_state.solid.x,
                                 frame.skin_position);
    embed::interpolate_tet_field(m_body.skin_embedding, m_water.saturation(), frame.skin_saturation);
    if (m_params.kernel.form == material::KernelForm::off)
      frame.skin_influence.setZero(frame.skin_position.cols());
    else
      embed::compute_region_of_influence(frame.skin_position, hand.tool.position, m_params.kernel.radius,
                                         frame.skin_influence);
  }
  return frame;
}

Frame BodySide::make_frame_of_step() {
  Frame frame = make_frame(m_state.hand);
  Sha256 hash;
  Archive archive = Archive::make_hashing(hash);
  serialize(archive);
  frame.state_hash = hash.hex_digest();
  return frame;
}

}  // namespace argil::sim
