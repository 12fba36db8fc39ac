#pragma once

// A small made-up run whose every number is different, for the tests of this folder.

#include "mesh/tet_mesh.h"
#include "output/result_file.h"

namespace argil::output::test {

inline ResultHeader make_header(bool with_skin = true) {
  ResultHeader header;
  header.rest_position.resize(3, 5);
  header.rest_position << 0, 1, 0, 0, 1,  //
      0, 0, 1, 0, 1,                      //
      0, 0, 0, 1, 1;
  header.tets.resize(4, 2);
  header.tets << 0, 1,  //
      1, 2,             //
      2, 3,             //
      3, 4;
  header.surface_triangles.resize(3, 2);
  header.surface_triangles << 0, 1,  //
      2, 2,                          //
      1, 4;
  header.skin_triangles.resize(3, with_skin ? 1 : 0);
  if (with_skin) header.skin_triangles << 0, 1, 2;
  header.tool.vertices = Points::Identity(3, 3) * 0.01;
  header.tool.triangles.resize(3, 1);
  header.tool.triangles << 0, 1, 2;
  header.haptic_period = 0.001;
  header.estimates_error = true;
  header.provenance = {{"scenario", "{\"about\": \"ε\"}"}, {"numerics_tag", ""}};
  return header;
}

inline sim::HapticRecord make_haptic(Tick tick) {
  const double t = static_cast<double>(tick);
  sim::HapticRecord record;
  record.tick = tick;
  record.time = t * 0.001;
  record.tool_position = Vec3(t, t + 0.25, -t);
  record.tool_orientation = Quat(0.5, 0.5, -0.5, 0.5);  // w, x, y, z
  record.force = Vec3(1.0 / (t + 3.0), 2.0, 3.0 * t);
  record.torque = Vec3(0.1 * t, 0.2, 0.3);
  record.device_force = Vec3(0.0, -0.0, 0.5 * t);
  record.mode = static_cast<device::ToolMode>(tick % 4);
  record.force_age = static_cast<int>(tick % 14);
  record.num_contacts = static_cast<int>(tick % 7);
  record.gate_events = static_cast<std::uint8_t>(tick % 16);
  record.port_energy = 7.0 - t;
  record.passivity_energy = 8.0 + t;
  record.error = {0.5 * t, 0.25, -0.125 * t, 2.0, 0.0625};
  return record;
}

inline sim::PhysicsRecord make_physics(Tick tick) {
  const double t = static_cast<double>(tick);
  sim::PhysicsRecord record;
  record.tick = tick;
  record.time = t * 0.001;
  record.kinetic_energy = 1 + t;
  record.elastic_energy = 2 + t;
  record.plastic_dissipation = 3 + t;
  record.contact_work = 4 + t;
  record.water_mass = 5 + t;
  record.water_added = 6 + t;
  record.water_removed = 7 + t;
  record.newton_iterations = 3;
  record.iterations = 8;
  record.factorisations = 9;
  record.residual = 1e-10;
  record.active_nodes = 11;
  record.min_volume_ratio = 0.5;
  record.max_plastic_strain = 0.125;
  record.limited_tets = 12;
  record.limited_tet = 7;
  return record;
}

inline sim::Frame make_frame(Tick tick, bool with_skin = true) {
  const double t = static_cast<double>(tick);
  sim::Frame frame;
  frame.tick = tick;
  frame.time = t * 0.001;
  frame.position = make_header().rest_position.array() + 0.001 * t;
  frame.saturation = Field::LinSpaced(2, 0.25, 0.75);
  frame.plastic_strain.resize(6, 2);
  frame.plastic_strain << 1, 0, 2, 0, 2, 0, 4, 0, 4, 3, 8, 4;  // norms √105 and 5
  frame.skin_position = with_skin ? Points(Points::Identity(3, 3) * t) : Points(3, 0);
  frame.skin_saturation = Field::LinSpaced(with_skin ? 3 : 0, 0.1, 0.3);
  frame.skin_influence = Field::LinSpaced(with_skin ? 3 : 0, 0.4, 0.6);
  frame.state_hash = std::string(60, 'a') + std::to_string(1000 + tick);
  return frame;
}

/// Writes a run of `num_ticks` haptic ticks, physics every second, a frame every tenth tick.
inline void append_run(ResultFile& file, Tick begin, Tick end, bool with_skin = true) {
  for (Tick tick = begin; tick < end; ++tick) {
    file.append(make_haptic(tick));
    if (tick % 2 == 0) file.append(make_physics(tick));
    if (tick % 10 == 0) file.append(make_frame(tick, with_skin));
  }
}

inline void write_run(const std::string& name, Tick num_ticks, bool with_skin = true) {
  ResultFile file(name, make_header(with_skin));
  append_run(file, 0, num_ticks, with_skin);
  file.finish(std::nullopt);
}

}  // namespace argil::output::test
