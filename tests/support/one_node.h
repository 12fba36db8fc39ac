#pragma once

#include <numbers>

#include "sim/simulation.h"

namespace argil::test {

// A body that moves in one node alone: a tet whose base is held, pressed at its apex by a flat plate. Force
// and depth obey closed forms.

inline constexpr double kEdge = 0.02;      ///< of the base [m]
inline constexpr double kHeight = 0.02;    ///< of the apex [m]
inline constexpr double kPenalty = 500.0;  ///< [N/m]

/// Stiffness of the apex along z, V (λ + 2μ) |∇N|² with |∇N| = 1/height [N/m].
inline double compute_apex_stiffness(const material::Elastic& elastic) {
  const double E = elastic.youngs_modulus;
  const double nu = elastic.poissons_ratio;
  const double base = 0.25 * std::numbers::sqrt3 * kEdge * kEdge;
  return base / (3.0 * kHeight) * E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
}

inline double compute_series(double a, double b) {
  return a * b / (a + b);
}

/// Elastic and nearly without mass, so that it follows at once; discrete penalty: force of the place alone.
inline sim::Params make_one_node_params() {
  sim::Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.enabled = false;
  p.kernel.form = material::KernelForm::off;
  p.contact.vertex_face_stiffness = kPenalty;
  p.contact.edge_edge_stiffness = kPenalty;
  p.contact.penalty = contact::PenaltyKind::discrete;
  p.solid.model = solid::StrainModel::linear;
  p.solid.solver.kind = linear::SolverKind::cholesky;
  p.solid.density = 1e-3;
  p.rates.water_period_ticks = 14;
  p.device.max_force = 1e3;
  p.device.max_force_rate = 1e9;
  return p;
}

inline sim::Body make_one_node_body() {
  sim::Body body;
  body.mesh.vertices.resize(3, 4);
  body.mesh.vertices.col(0) << 0.0, 0.0, 0.0;
  body.mesh.vertices.col(1) << kEdge, 0.0, 0.0;
  body.mesh.vertices.col(2) << 0.5 * kEdge, 0.5 * std::numbers::sqrt3 * kEdge, 0.0;
  body.mesh.vertices.col(3) << 0.5 * kEdge, kEdge / (2.0 * std::numbers::sqrt3), kHeight;
  body.mesh.tets.resize(4, 1);
  body.mesh.tets << 0, 1, 2, 3;
  body.topology = mesh::make_topology(body.mesh);
  solid::Support base;
  base.region.kind = solid::Region::Kind::half_space;
  base.region.offset = 1e-9;
  body.supports.push_back(base);
  body.initial_saturation = Field::Zero(1);
  return body;
}

/// Box with the hand in the middle of its lower face.
inline mesh::TriangleMesh make_plate_tool() {
  mesh::TriangleMesh tool;
  tool.vertices.resize(3, 8);
  for (int v = 0; v < 8; ++v)
    tool.vertices.col(v) << 0.1 * ((v & 1) - 0.5), 0.1 * ((v >> 1 & 1) - 0.5), 0.05 * (v >> 2);
  tool.triangles.resize(3, 12);
  tool.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      3, 2, 5, 7, 5, 1, 7, 3, 6, 4, 3, 7,                //
      1, 3, 7, 6, 4, 5, 6, 7, 2, 6, 7, 5;
  return tool;
}

/// The plate `depth` below the apex at rest; the apex is off the plate's diagonals.
inline device::DeviceSample press_apex(double depth, device::ToolMode mode = device::ToolMode::push) {
  device::DeviceSample sample;
  sample.position = {0.5 * kEdge - 0.013, 0.5 * kEdge + 0.004, kHeight - depth};
  sample.mode = mode;
  return sample;
}

inline sim::Simulation make_one_node_simulation(const sim::Params& params) {
  return sim::Simulation(make_one_node_body(), make_plate_tool(), params, press_apex(-1e-3));
}

}  // namespace argil::test
