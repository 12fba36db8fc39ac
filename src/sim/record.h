#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "base/types.h"
#include "device/sample.h"
#include "sim/fidelity.h"

namespace argil::sim {

/// By how much the force at the hand is off, part by part [N]. What has a known sign has it: above 0 the
/// found force is the larger one.
struct ForceErrorParts {
  double mesh = 0.0;      ///< ≥ 0: cells of this size are too stiff
  double step = 0.0;      ///< by the length of the steps, and by a force that is held between them
  double contact = 0.0;   ///< ≤ 0: the contact's stiffness κ lets the tool sink in
  double solver = 0.0;    ///< by what the linear solve left
  double left_out = 0.0;  ///< by what the step left out: a region at rest, or all of the body

  /// By how much the found force may be the larger one, and the smaller one [N].
  double most_above() const { return std::max(0.0, mesh + contact) + step + solver + left_out; }
  double most_below() const { return std::max(0.0, -mesh - contact) + step + solver + left_out; }
  double total() const { return std::abs(mesh + contact) + step + solver + left_out; }
};

/// One haptic tick, as written to /haptic.
struct HapticRecord {
  Tick tick = 0;
  double time = 0.0;                  ///< [s]
  Vec3 tool_position = Vec3::Zero();  ///< [m]
  Quat tool_orientation = Quat::Identity();
  Vec3 force = Vec3::Zero();         ///< [N] on the hand, before passivity and gate
  Vec3 torque = Vec3::Zero();        ///< [N m] about the hand's point, likewise
  Vec3 device_force = Vec3::Zero();  ///< [N] after the output gate
  device::ToolMode mode = device::ToolMode::push;
  int force_age = 0;  ///< [ticks] since the force was computed
  int num_contacts = 0;
  std::uint8_t gate_events = 0;
  double port_energy = 0.0;       ///< [J] given to the hand since the start; above 0: made by the simulation
  double passivity_energy = 0.0;  ///< [J] kept from the hand since the start by the passivity controller
  ForceErrorParts error;          ///< of `force`; zero where nothing is estimated
};

/// One physics step, as written to /physics.
struct PhysicsRecord {
  Tick tick = 0;
  double time = 0.0;
  double kinetic_energy = 0.0;       ///< [J]
  double elastic_energy = 0.0;       ///< [J]
  double plastic_dissipation = 0.0;  ///< [J] since the start
  double contact_work = 0.0;         ///< [J] by contact forces at the ends of steps, since the start
  double water_mass = 0.0;           ///< [kg]
  double water_added = 0.0;          ///< [kg] since the start
  double water_removed = 0.0;        ///< [kg] since the start
  int newton_iterations = 0;         ///< linearisations of the last physics step
  int iterations = 0;                ///< of the linear solver
  int factorisations = 0;            ///< since the start
  double residual = 0.0;             ///< relative, of the linear solve
  int active_nodes = 0;              ///< vertices that were solved for
  double min_volume_ratio = 1.0;     ///< smallest det F
  double max_plastic_strain = 0.0;   ///< largest ‖ε_p‖_F
  int epoch = 0;                     ///< how often the body has got new cells before the step
  int limited_tets = 0;              ///< whose motion was limited in the step; all: the whole body's was
  int limited_tet = -1;     ///< the worst of them, as the mesh file numbers it; −1: none, or no tet's
  FidelityRecord fidelity;  ///< but in `full`
};

/// One picture of the body, as written to /frames/NNNNNN.
struct Frame {
  Tick tick = 0;
  double time = 0.0;
  Points position;             ///< 3×n cage vertices [m]
  Field saturation;            ///< per tet
  TensorField plastic_strain;  ///< per tet, Mandel
  Points skin_position;        ///< 3×k, empty without a skin
  Field skin_saturation;       ///< k
  Field skin_influence;        ///< k, region of influence
  /// SHA-256 of all that a tick takes from earlier ones. In a session the first frame, and a last one that no
  /// step made, have this; the others hash what a step takes, the body's side alone.
  std::string state_hash;
};

}  // namespace argil::sim
