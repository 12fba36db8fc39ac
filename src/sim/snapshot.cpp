// Everything that a tick takes from earlier ones, each field named once for both ways.

#include "base/check.h"
#include "sim/force_error.h"
#include "sim/simulation.h"
#include "solid/committed.h"
#include "solid/step_solver.h"

namespace argil::sim {

Snapshot Simulation::take_snapshot() {
  Snapshot snapshot;
  Archive archive = Archive::make_saving(snapshot);
  serialize(archive);
  return snapshot;
}

void Simulation::restore(const Snapshot& snapshot, const std::string& origin) {
  Archive archive = Archive::make_restoring(snapshot, origin);
  serialize(archive);
}

void Simulation::restore_without_history(const Snapshot& snapshot, const std::string& origin) {
  Archive archive = Archive::make_restoring_without_history(snapshot, origin);
  serialize(archive);
}

std::string Simulation::state_hash() {
  Sha256 hash;
  Archive archive = Archive::make_hashing(hash);
  serialize(archive);
  return hash.hex_digest();
}

void Simulation::serialize(Archive& archive) {
  hand().serialize(archive);
  body_side().serialize(archive);
}

void HandSide::serialize(Archive& archive) {
  archive.number("tick", m_state.clock.tick);
  archive.number("steps_begun", m_state.steps_begun);
  archive.number("ticks_since_step", m_state.ticks_since_step);
  archive.number("has_felt_anew", m_state.has_felt_anew);
  archive.array("tool/position", m_state.tool.position);
  archive.quaternion("tool/orientation", m_state.tool.orientation);
  archive.number("tool/mode", m_state.mode);
  archive.array("tool/path", m_state.motion.path);
  archive.array("tool/turn", m_state.motion.turn);
  serialize_contacts(archive);
  archive.number("ledger/port_energy", m_state.port_energy);
  archive.number("ledger/passivity_energy", m_state.passivity_energy);
  if (m_params.estimates_error) {
    serialize_rates(archive, "hand/error_", m_state.error);
    archive.number("hand/force_jump", m_state.force_jump);
    archive.array("hand/last_answer", m_state.last_answer);
  }
  if (!archive.is_restoring()) return;
  m_still_detections = 0;  // m_contacts are of another state
  commit();
}

/// Kinematics are a function of what was saved and are found again.
void BodySide::serialize(Archive& archive) {
  archive.number("steps", m_state.steps);
  archive.number("step/tick", m_state.hand.ticks);
  archive.array("step/tool_position", m_state.hand.tool.position);
  archive.quaternion("step/tool_orientation", m_state.hand.tool.orientation);
  archive.array("step/felt_force", m_state.hand.felt.force);
  archive.array("step/felt_torque", m_state.hand.felt.torque);
  archive.number("ledger/plastic_dissipation", m_state.plastic_dissipation);
  archive.number("ledger/contact_work", m_state.contact_work);
  archive.number("ledger/energy_given", m_state.energy_given);
  archive.number("solid/is_at_rest", m_state.is_at_rest);
  if (m_params.carries_force_on()) archive.array("contact/compliance", m_state.compliance);
  serialize_water(archive);
  m_materials.serialize(archive);
  solid::serialize(archive, m_solid, m_region, m_state.solid);
  m_flow.serialize(archive);
  if (m_solid.model.params.flows_in_solve && !m_solid.elastic.is_empty())
    archive.list("flow/unloads", m_solid.system.unloads);
  if (m_body.epoch > 0) archive.any_size("flow/earlier", m_earlier_flow);
  m_economy.serialize(archive);
  m_error.serialize(archive);
  if (!archive.is_restoring()) return;
  if (!archive.keeps_history()) m_region.wake_all();
  const StepStatus status =
      archive.keeps_history()
          ? solid::restore_kinematics(m_solid, m_region, m_state.solid.x, m_state.hand.ticks)
          : solid::update_kinematics(m_solid, m_region, m_state.solid.x, m_state.hand.ticks);
  ARGIL_ASSERT(status.is_ok());
  solid::commit(m_solid, m_region, m_state.solid);
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
  m_state.chatter.serialize(archive);
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
  m_collector.serialize(archive);
  serialize_springs(archive);
  m_compliance.serialize(archive, m_surface);
  if (m_pressure) {
    archive.number("contact/yielding", m_state.yielding);
    archive.array("contact/stiffness_per_area", m_pressure->stiffness().per_area);
    archive.array("contact/modulus", m_pressure->stiffness().modulus);
    m_pressure->serialize(archive);
    m_grip.serialize(archive);
    if (m_friction) m_friction->serialize(archive);
    if (m_between) m_between->serialize(archive);
  }
  if (!archive.is_restoring()) return;
  if (m_pressure) m_pressure->forget();
  m_has_met_surface = false;
  m_state.gate.restore(gate_count, gate_force, gate_withdrawn);
  inside.edges.clear();
  for (std::size_t i = 0; i < tool_edge.size(); ++i) inside.edges.emplace_back(tool_edge[i], body_edge.at(i));
  m_detector.restore(inside);
}

void HandSide::serialize_springs(Archive& archive) {
  archive.records("contact/springs", m_springs, list_spring_fields);
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
