// Everything that a tick takes from earlier ones, each field named once for both ways.

#include "base/check.h"
#include "sim/simulation.h"

namespace argil::sim {

Snapshot Simulation::take_snapshot() {
  ARGIL_ASSERT(m_hand.is_between_steps(), clock().tick);
  Snapshot snapshot;
  Archive archive = Archive::make_saving(snapshot);
  serialize(archive);
  return snapshot;
}

void Simulation::restore(const Snapshot& snapshot, const std::string& origin) {
  Archive archive = Archive::make_restoring(snapshot, origin);
  serialize(archive);
  m_hand.restore_surface();
}

void Simulation::serialize(Archive& archive) {
  m_hand.serialize(archive);
  m_body_side.serialize(archive);
}

void HandSide::serialize(Archive& archive) {
  archive.number("tick", m_state.clock.tick);
  archive.number("steps_begun", m_state.steps_begun);
  archive.array("tool/position", m_state.tool.position);
  archive.quaternion("tool/orientation", m_state.tool.orientation);
  archive.number("tool/mode", m_state.mode);
  archive.array("tool/path", m_state.motion.path);
  archive.array("tool/turn", m_state.motion.turn);
  serialize_contacts(archive);
  archive.number("ledger/port_energy", m_state.port_energy);
  archive.number("ledger/passivity_energy", m_state.passivity_energy);
}

void HandSide::restore_surface() {
  m_touched.restore(m_body.state().solid.x);
  commit();
}

/// Kinematics are a function of what was saved and are found again.
void BodySide::serialize(Archive& archive) {
  archive.number("steps", m_state.steps);
  archive.number("tick_of_step", m_state.hand.ticks);
  archive.array("solid/x", m_state.solid.x);
  archive.array("solid/v", m_state.solid.v);
  archive.array("solid/plastic_strain", m_state.solid.plastic_strain);
  archive.any_size("solid/x_before", m_state.solid.x_before);
  archive.any_size("solid/v_before", m_state.solid.v_before);
  archive.number("solid/is_at_rest", m_state.is_at_rest);
  m_economy.serialize_rest(archive);
  m_solid.exchange_state(archive);
  serialize_water(archive);
  archive.number("ledger/plastic_dissipation", m_state.plastic_dissipation);
  archive.number("ledger/contact_work", m_state.contact_work);
  archive.number("ledger/energy_given", m_state.energy_given);
  m_materials.serialize(archive);
  m_solid.exchange_frames(archive);
  m_flow.serialize(archive);
  m_economy.serialize(archive);
  if (!archive.is_restoring()) return;
  const StepStatus status = m_solid.restore_kinematics(m_state.solid.x, m_state.hand.ticks);
  ARGIL_ASSERT(status.is_ok());
  commit();
}

void HandSide::serialize_contacts(Archive& archive) {
  archive.array("contact/tool_position", m_state.contact_tool.position);
  archive.quaternion("contact/tool_orientation", m_state.contact_tool.orientation);
  m_touched.serialize(archive);
  archive.number("contact/num_contacts", m_state.num_contacts);
  archive.number("contact/force_age", m_state.force_age);
  archive.array("hand/force", m_state.hand_force);
  archive.array("hand/torque", m_state.hand_torque);
  archive.array("hand/withheld_force", m_state.withheld.force);
  archive.array("hand/withheld_torque", m_state.withheld.torque);
  archive.array("hand/gated_force", m_state.gated.force);
  archive.array("hand/gated_torque", m_state.gated.torque);
  archive.number("hand/gate_events", m_state.gated.events);
  m_state.chatter.exchange_state(archive);
  Tick gate_count = m_state.gate.count();
  Vec3 gate_force = m_state.gate.last_force();
  archive.number("hand/gate_count", gate_count);
  archive.array("hand/gate_last_force", gate_force);
  Tick gate_withdrawn = m_state.gate.withdrawn();
  archive.number("hand/gate_withdrawn", gate_withdrawn);

  contact::ContactState inside = m_detector.state();
  archive.list("contact/tool_vertex", inside.tool_vertex);
  archive.list("contact/body_face", inside.body_face);
  archive.list("contact/body_vertex", inside.body_vertex);
  archive.list("contact/tool_face", inside.tool_face);
  archive.list("contact/tool_stretch", inside.tool_stretch);
  archive.list("contact/body_stretch", inside.body_stretch);
  std::vector<int> tool_edge, body_edge;
  for (const auto& [of_tool, of_body] : inside.edges) {
    tool_edge.push_back(of_tool);
    body_edge.push_back(of_body);
  }
  archive.list("contact/tool_edge", tool_edge);
  archive.list("contact/body_edge", body_edge);
  archive.list("contact/edge_stretch", inside.edge_stretch);
  serialize_springs(archive);
  m_compliance.serialize(archive, m_surface);
  if (!archive.is_restoring()) return;
  m_state.gate.restore(gate_count, gate_force, gate_withdrawn);
  inside.edges.clear();
  for (std::size_t i = 0; i < tool_edge.size(); ++i) inside.edges.emplace_back(tool_edge[i], body_edge.at(i));
  m_detector.restore(inside);
}

/// A spring is a column: vertices, weights, normal, stiffness, force, point.
void HandSide::serialize_springs(Archive& archive) {
  Eigen::Matrix<double, 14, Eigen::Dynamic> table(14, m_springs.size());
  for (std::size_t i = 0; i < m_springs.size(); ++i) {
    const ContactSpring& s = m_springs[i];
    auto column = table.col(static_cast<Eigen::Index>(i));
    for (std::size_t k = 0; k < 3; ++k) {
      column(static_cast<Eigen::Index>(k)) = s.vertex[k];
      column(static_cast<Eigen::Index>(3 + k)) = s.weight[k];
    }
    column.segment<3>(6) = s.normal;
    column(9) = s.stiffness;
    column(10) = s.force;
    column.segment<3>(11) = s.point;
  }
  archive.any_size("contact/springs", table);
  if (!archive.is_restoring()) return;
  m_springs.assign(static_cast<std::size_t>(table.cols()), {});
  for (std::size_t i = 0; i < m_springs.size(); ++i) {
    const auto column = table.col(static_cast<Eigen::Index>(i));
    ContactSpring& s = m_springs[i];
    for (std::size_t k = 0; k < 3; ++k) {
      s.vertex[k] = static_cast<int>(column(static_cast<Eigen::Index>(k)));
      s.weight[k] = column(static_cast<Eigen::Index>(3 + k));
    }
    s.normal = column.segment<3>(6);
    s.stiffness = column(9);
    s.force = column(10);
    s.point = column.segment<3>(11);
  }
}

void BodySide::serialize_water(Archive& archive) {
  water::WaterState water = m_water.state();
  archive.array("water/saturation", water.saturation);
  archive.array("water/carry", water.carry);
  archive.number("water/initial", water.initial);
  archive.number("water/added", water.added.sum);
  archive.number("water/added_error", water.added.error);
  archive.number("water/removed", water.removed.sum);
  archive.number("water/removed_error", water.removed.error);
  if (archive.is_restoring()) m_water.restore(water);
}

}  // namespace argil::sim
