#pragma once

#include "contact/contact.h"
#include "device/gate.h"
#include "device/passivity.h"
#include "device/sample.h"
#include "embed/embedding.h"
#include "mesh/topology.h"
#include "solid/loads.h"
#include "solid/solid.h"
#include "water/water.h"

namespace argil::sim {

/// The body as a scene gives it; nothing in it changes during a run.
struct Body {
  mesh::TetMesh mesh;
  mesh::Topology topology;
  std::vector<solid::Support> supports;  ///< where its motion is prescribed
  Field initial_saturation;              ///< per tet [–]
  Field youngs_modulus;                  ///< per tet, dry [Pa]; empty: the material's everywhere
  Points pore_axis;  ///< 3×tets, unit: of aligned pores; empty: the material's everywhere
  solid::Loads loads;
  mesh::TriangleMesh skin;  ///< empty without a skin
  embed::Embedding skin_embedding;
};

/// All that the hand's side changes. A checkpoint holds every field of both sides (snapshot.cpp).
struct HandState {
  // device
  contact::Pose tool;  ///< at the end of the last tick
  device::ToolMode mode = device::ToolMode::push;
  device::TickMotion motion;  ///< of the hand in the last tick
  device::Wrench withheld;    ///< what the passivity controller took off the last force
  // contact
  contact::Pose contact_tool;       ///< tool at the end of the last detection
  Points contact_x;                 ///< touched surface at the end of the last detection [m]
  Points surface_x;                 ///< and where it has moved to since; as long as has_moved
  bool has_moved = false;           ///< else it is still at contact_x
  Vec3 hand_force = Vec3::Zero();   ///< [N] that the hand feels
  Vec3 hand_torque = Vec3::Zero();  ///< [N m] about the hand's point
  int force_age = 0;                ///< [ticks] since it was computed
  int num_contacts = 0;             ///< of the last detection
  // ledgers
  double port_energy = 0.0;       ///< [J] work of the device's force on the hand since the start
  double passivity_energy = 0.0;  ///< [J] that the passivity controller has kept from the hand
};

/// All that the body's side changes, but for the water.
struct BodyState {
  Tick steps = 0;  ///< since the start
  solid::SolidState solid;
  bool is_at_rest = false;  ///< nothing acts on the body and it does not move: no need to solve
  int slow_steps = 0;       ///< physics steps in a row that were slower than rest_speed
  // ledgers
  double plastic_dissipation = 0.0;  ///< [J] since the start
  double contact_work = 0.0;         ///< [J] done on the body since the start
  double energy_given = 0.0;         ///< [J] to the body by hand, loads and supports, recoils not taken off
};

}  // namespace argil::sim
