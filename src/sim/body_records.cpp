// What a body side tells of itself: records of its steps, frames and the hash of its state.

#include "base/hash.h"
#include "mesh/order.h"
#include "sim/body_side.h"

namespace argil::sim {

PhysicsRecord BodySide::make_record() const {
  PhysicsRecord record;
  record.tick = m_state.hand.ticks;
  record.time = static_cast<double>(m_state.hand.ticks) * m_params.rates.haptic_period;
  record.kinetic_energy = m_solid.compute_kinetic_energy(m_state.solid);
  const bool is_at_rest = m_state.is_at_rest;
  const solid::StrainSummary strain =
      is_at_rest ? m_economy.rest_strain() : m_solid.summarise(m_state.solid.plastic_strain);
  record.elastic_energy = strain.elastic_energy;
  record.plastic_dissipation = m_state.plastic_dissipation;
  record.contact_work = m_state.contact_work;
  record.water_mass = m_water.mass();
  record.water_added = m_water.ledger().added;
  record.water_removed = m_water.ledger().removed;
  record.iterations = m_solid.counters().linear_iterations;
  record.newton_iterations = m_solid.counters().newton_iterations;
  record.factorisations = m_solid.solver_cost().factorisations;
  record.residual = m_solid.counters().residual;
  record.active_nodes = is_at_rest ? 0 : m_solid.num_active();
  record.min_volume_ratio = m_solid.min_volume_ratio();
  record.max_plastic_strain = strain.largest_plastic_strain;
  record.fidelity = m_economy.record();
  return record;
}

/// ε_p of each tet: the mean of its points, whose weights are equal.
TensorField BodySide::mean_plastic_strain() const {
  const TensorField& at_points = m_state.solid.plastic_strain;
  const int Q = m_solid.elements().points_per_tet;
  if (Q == 1) return at_points;
  TensorField mean(6, m_body.mesh.num_tets());
  for (Eigen::Index t = 0; t < mean.cols(); ++t)
    mean.col(t) = at_points.middleCols(Q * t, Q).rowwise().mean();
  return mean;
}

Frame BodySide::make_frame(const HandPose& hand) const {
  Frame frame;
  frame.tick = hand.ticks;
  frame.time = static_cast<double>(hand.ticks) * m_params.rates.haptic_period;
  frame.position = m_state.solid.x.leftCols(m_body.mesh.num_vertices());
  frame.saturation = mesh::in_file_order(m_body.mesh, m_water.saturation());
  frame.plastic_strain = mesh::in_file_order(m_body.mesh, mean_plastic_strain());
  if (m_body.skin_embedding.num_points() > 0) {
    embed::interpolate_positions(m_body.skin_embedding, m_solid.elements().nodes, m_state.solid.x,
                                 frame.skin_position);
    embed::interpolate_tet_field(m_body.skin_embedding, m_water.saturation(), frame.skin_saturation);
    if (m_params.kernel.form == material::KernelForm::off)
      frame.skin_influence.setZero(frame.skin_position.cols());
    else
      embed::compute_region_of_influence(frame.skin_position, hand.tool.position, m_params.kernel.radius,
                                         frame.skin_influence);
  }
  frame.state_hash = make_hash(hand);
  return frame;
}

std::string BodySide::make_hash(const HandPose& hand) const {
  Sha256 hash;
  const auto add = [&hash](const auto& array) {
    hash.add(array.data(), static_cast<std::size_t>(array.size()));
  };
  const double tick = static_cast<double>(hand.ticks);
  hash.add(&tick, 1);
  add(hand.tool.position);
  add(hand.tool.orientation.coeffs());
  add(hand.felt.force);
  add(hand.felt.torque);
  add(m_state.solid.x);
  add(m_state.solid.v);
  add(m_state.solid.plastic_strain);
  add(m_state.solid.x_before);
  add(m_state.solid.v_before);
  add(m_water.saturation());
  return hash.hex_digest();
}

}  // namespace argil::sim
