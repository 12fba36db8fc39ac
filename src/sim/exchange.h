#pragma once

// All that passes between the hand's side of the loop and the body's.

#include <array>
#include <utility>
#include <vector>

#include "contact/contact.h"
#include "device/gate.h"
#include "device/passivity.h"
#include "device/sample.h"
#include "sim/nodal_force.h"
#include "solid/solid.h"

namespace argil::sim {

/// The hand as it is known outside: what a picture and its hash take from it.
struct HandPose {
  Tick ticks = 0;  ///< that it has made
  contact::Pose tool;
  device::Wrench felt;  ///< before passivity and gate
};

/// Where the force of an entry of ContactLoad::stiffness acts.
struct ContactYield {
  Vec3 point = Vec3::Zero();   ///< [m]
  double force_at_rest = 0.0;  ///< what the solve was told besides, for damping [N]
};

/// Contacts of several ticks that press on the same vertices and count as one.
struct ContactGroup {
  std::array<int, 3> vertex;  ///< of the surface
  std::size_t first;          ///< entry of ContactLoad::stiffness
  std::size_t pieces;         ///< and how many stand for a contact
};

/// What the hand gives the body for one step: the contacts of its ticks since the last one, each by its share
/// of the step.
struct ContactLoad {
  // When it is given.
  HandPose hand;       ///< at the end of the tick in which it is given
  int num_ticks = 0;   ///< since the last one
  int detections = 1;  ///< whose mean the body gets
  double scale = 1.0;  ///< by which forces and stiffnesses have yet to be multiplied for that
  device::ToolMode mode = device::ToolMode::push;
  std::vector<int> touched_tet;      ///< under a tool that wets or dries, in the steps that move water
  std::vector<double> touched_area;  ///< [m²] of each
  // Tick by tick.
  NodalForce force;            ///< on the body
  Vec3 centre = Vec3::Zero();  ///< of pressure of the last detection [m], valid while is_pressed
  bool is_pressed = false;     ///< a push or pull tool exerts a force on the body
  bool is_touched = false;     ///< some detection of the step found a force on the body
  std::vector<solid::PointStiffness> stiffness;
  std::vector<ContactYield> yields;  ///< of each of these
  std::vector<ContactGroup> groups;
  std::size_t last_detection = 0;  ///< entry of `stiffness` where the last detection's contacts begin

  explicit ContactLoad(Eigen::Index num_nodes);
  /// Ready for the ticks of another step; keeps its storage.
  void clear();
};

/// What a step of the body gives the hand.
struct BodyAnswer {
  Tick step = 0;           ///< number of the step, from 1
  bool has_moved = false;  ///< the body has; else its surface is where it was
  bool is_whole = true;    ///< all of its surface may have moved; else only these vertices have:
  std::vector<int> moved;
  Points surface_x;  ///< places of all vertices of the touched surface, or of these [m], where it has moved
  device::Wrench felt;  ///< what the hand felt, less what the body has yielded to it

  /// Takes storage for a touched surface of `num_vertices`.
  explicit BodyAnswer(Eigen::Index num_vertices) : surface_x(3, num_vertices) {
    moved.reserve(static_cast<std::size_t>(num_vertices));
  }
};

/// What a tick of the hand shares with the steps of the body. In batch a step takes no time: it begins and is
/// seen within one tick.
struct TickPlan {
  bool sees_step = false;    ///< at its begin, what the step under way has found
  bool begins_step = false;  ///< at its end, with what the hand has gathered
  device::HandFeed feed = device::HandFeed::fresh;
};

}  // namespace argil::sim
