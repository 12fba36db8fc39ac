#pragma once

#include "contact/contact.h"
#include "contact/pressure.h"
#include "device/chatter_watch.h"
#include "device/gate.h"
#include "device/passivity.h"
#include "device/sample.h"
#include "embed/embedding.h"
#include "mesh/topology.h"
#include "sim/clock.h"
#include "solid/active_region.h"
#include "solid/loads.h"
#include "water/water.h"

namespace argil::sim {

struct Params;

/// A place of the body at rest that the tool's motion takes it into.
struct TouchedPlace {
  Vec3 position = Vec3::Zero();  ///< on the surface, nearest to the middle of the tool [m]
  double radius = 0.0;           ///< √(R d) of a ball of radius R that is d deep: Hertz's patch [m]
};

/// The body as a scene gives it, or as it got new cells; nothing in it changes until it does. Steps change
/// BodyState and what water, materials, economy and flow keep.
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
  mesh::TriangleMesh touched;  ///< what the tool meets, where that is finer than the skin; else empty
  embed::Embedding touched_embedding;
  /// Of each tet: volume at rest over that of the mesh, where cells were made of clay under pressure;
  /// empty: 1.
  Field rest_volume_ratio;
  std::vector<TouchedPlace> touched_places;  ///< by which its cells were graded; empty: they are even
  int first_tets = 0;                        ///< of its first epoch; 0: this is it
  int epoch = 0;                             ///< how often it has got new cells
  Tick epoch_tick = 0;                       ///< after which it got these
};

/// The hand at the end of some tick, as it is known outside: what a picture and its hash take from it.
struct HandPose {
  Tick ticks = 0;  ///< that it has made
  contact::Pose tool;
  device::Wrench felt;  ///< before passivity and gate
};

/// How the body's side expects the force at the hand to be off, from one step to the next.
struct ForceErrorRates {
  double mesh = 0.0;      ///< of the force [–]
  double step = 0.0;      ///< likewise
  double contact = 0.0;   ///< likewise
  double solver = 0.0;    ///< [N]
  double left_out = 0.0;  ///< [N]
};

/// What the hand's side changes in every tick. The touched surface, the contacts and the gathered load, whose
/// size is the scene's, keep their own.
struct HandState {
  Clock clock;
  Tick steps_begun = 0;        ///< of the body
  int ticks_since_step = 0;    ///< since the last of these began
  bool has_felt_anew = false;  ///< some detection since then has found the force anew
  // device
  contact::Pose tool;  ///< at the end of the last tick
  device::ToolMode mode = device::ToolMode::push;
  device::TickMotion motion;  ///< of the hand in the last tick
  device::Wrench withheld;    ///< what the passivity controller took off the last force
  device::ChatterWatch chatter;
  device::OutputGate gate;
  device::GatedForce gated;
  // contact
  contact::Pose contact_tool;       ///< tool at the end of the last detection
  Vec3 hand_force = Vec3::Zero();   ///< [N] that the hand feels, before passivity and gate
  Vec3 hand_torque = Vec3::Zero();  ///< [N m] about the hand's point
  int force_age = 0;                ///< [ticks] since it was computed
  int num_contacts = 0;             ///< of the last detection
  contact::Yielding yielding = contact::Yielding::yes;  ///< pressure: of the body, since the tool touches it
  // ledgers
  ForceErrorRates error;            ///< of the last step
  double force_jump = 0.0;          ///< [N] by which a step's answer was off what the hand felt before it
  Vec3 last_answer = Vec3::Zero();  ///< of a step [N]
  double port_energy = 0.0;         ///< [J] work of the device's force on the hand since the start
  double passivity_energy = 0.0;    ///< [J] that the passivity controller has kept from the hand

  explicit HandState(const Params& params);
};

/// How far the body's side has come, and its ledgers.
struct BodyProgress {
  Tick steps = 0;                    ///< since the start
  HandPose hand;                     ///< when it handed over the load of the last step
  bool is_at_rest = false;           ///< nothing acts on the body and it does not move: no need to solve
  double plastic_dissipation = 0.0;  ///< [J] since the start
  double contact_work = 0.0;         ///< [J] done on the body since the start
  double energy_given = 0.0;         ///< [J] to the body by hand, loads and supports, recoils not taken off
  Mat3 compliance = Mat3::Zero();    ///< PressedPatch::compliance of the last step
};

/// Positions, velocities and ledgers, which the body's side changes in a step. Water, materials, economy and
/// flow keep their own.
struct BodyState : BodyProgress {
  solid::SolidState solid;
};

}  // namespace argil::sim
