#pragma once

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "contact/parameters.h"
#include "mesh/tet_mesh.h"

namespace argil::contact {

/// Position and orientation of the tool frame; the origin is the hand's point.
struct Pose {
  Vec3 position = Vec3::Zero();         ///< [m]
  Quat orientation = Quat::Identity();  ///< tool to world
};

/// One pair in contact during the interval, seen from the body. Depth is ∫ nᵀ(p−q) dt over the penetration
/// intervals with t normalised to [0, 1] (eqs. 7 and 8 with unit stiffness, unit normals).
struct Contact {
  std::array<int, 3> vertex = {-1, -1, -1};  ///< body vertices that carry the force; −1 beyond the last
  std::array<double, 3> weight = {};         ///< their shares, sum 1 (weights at entry)
  int triangle = -1;                         ///< whose corners they are, where that is known
  Vec3 normal = Vec3::Zero();                ///< mean direction in which a push tool moves the body, unit
  Vec3 force =
      Vec3::Zero();  ///< k·∫ nᵀ(p−q) n dt: mean force of a push tool on the body over the interval [N]
  double stiffness = 0.0;  ///< k [N/m] × share of the tick in penetration: curvature for the implicit solve
  double end_force = 0.0;  ///< force along `normal` at t₁ [N]; 0 where the pair is apart again
  double end_stiffness = 0.0;  ///< k [N/m] of the pair at t₁; 0 likewise
  bool passes = false;         ///< apart at both ends: in and out again within the interval
  Vec3 resistance =
      Vec3::Zero();         ///< damping and friction on the body [N]; a pull tool does not reverse them
  double damping = 0.0;     ///< c of the damping force c n·v [N s/m]
  double body_speed = 0.0;  ///< n·v of the body [m/s], which that force counted with
  double sticking =
      0.0;  ///< stiffness along the surface [N/m]; −that: slides, and has it across its way alone
  // Of a pressure; see contact/surface_friction.h.
  double spring = 0.0;       ///< κ·area of the point [N/m], as long as it is in touch
  double begin_force = 0.0;  ///< force along `normal` at t₀ [N]
  double friction = 0.0;  ///< μ: `resistance` is what the spring along the surface would carry without limit
  Vec3 point =
      Vec3::Zero();  ///< where the force acts at the end of the tick [m], for the torque and the picture
};

/// What one detection over [t₀, t₁] found, in an order that depends on the meshes alone.
struct Contacts {
  std::vector<Contact> contacts;
  /// Of a pressure that a step solves for: points near the tool that press where the body comes to it, with
  /// `force` + `stiffness` · way. `force` is along −`normal` and does not act.
  std::vector<Contact> near;
  bool with_touched = true;                ///< asked by the caller: also find the touched area (costs time)
  std::vector<int> touched_triangle;       ///< body triangles with an inside point, increasing
  std::vector<double> touched_area;        ///< [m²] part of each that lies inside the tool
  Vec3 force_on_tool = Vec3::Zero();       ///< [N], push sense: −Σ force
  Vec3 torque_on_tool = Vec3::Zero();      ///< [N m] about the hand's point at t₁
  Vec3 resistance_on_tool = Vec3::Zero();  ///< [N]: −Σ resistance
  Vec3 resistance_torque_on_tool = Vec3::Zero();  ///< [N m] about the hand's point at t₁
  /// Sums the four above up from `contacts`, for a hand whose point is at `hand` [m].
  void sum_reactions(const Vec3& hand);
  void clear();  ///< of results; keeps with_touched
};

/// Which vertices lie inside at the end of an interval, increasing, and the face each of them presses on.
/// With friction also how far the springs of sticking are stretched [m], of vertices and of (tool edge, body
/// edge).
struct ContactState {
  std::vector<int> tool_vertex;
  std::vector<int> body_face;
  std::vector<int> body_vertex;
  std::vector<int> tool_face;
  std::vector<Vec3> tool_stretch;
  std::vector<Vec3> body_stretch;
  std::vector<std::pair<int, int>> edges;
  std::vector<Vec3> edge_stretch;
};

/// Detects contact between a deforming body surface and a rigidly moving tool, interval after interval, and
/// carries each pair's inside state from one interval to the next.
class ContactDetector {
 public:
  /// `surface`: 3×m triangles of body vertex numbers, outward; `tool`: closed surface in the tool frame [m].
  ContactDetector(const Triangles& surface, int num_body_vertices, const mesh::TriangleMesh& tool,
                  const ContactParams& params);
  ~ContactDetector();
  ContactDetector(ContactDetector&&) noexcept;
  ContactDetector& operator=(ContactDetector&&) noexcept;

  /// Makes for a body and a tool that are here what the next call would else make first, whose cost grows
  /// with the body.
  void prepare(const Points& x, const Pose& tool);
  /// Contacts while the body's vertices go linearly from x_t0 to x_t1 and the tool's vertices linearly
  /// between their places at the two poses. Successive calls must join: x_t0, pose_t0 equal the last x_t1,
  /// pose_t1. `body_motion` bounds how far any body vertex moves along any axis [m]; without it that is found
  /// by looking at all of them, the only part of the work that grows with the body. `seconds`: how long the
  /// interval lasts, for damping alone.
  void find_contacts(const Points& x_t0, const Points& x_t1, const Pose& pose_t0, const Pose& pose_t1,
                     Contacts& contacts, std::optional<double> body_motion = {}, double seconds = 0.0);

  /// Do the two solids have a point in common at one instant? (A start must have none.)
  bool overlaps(const Points& x, const Pose& pose) const;

  /// What the next interval needs to know of the past ones; for a checkpoint.
  ContactState state() const;
  /// From now on on so many threads, 1 before; the answers are the same bits. The next call may start
  /// anywhere.
  void share(int threads);

  /// What has been found since the last commit stays so; or is as it was then.
  void commit();
  void roll_back();

  /// Continues from a state taken from a detector of the same surface and tool. The next call may start
  /// anywhere.
  void restore(const ContactState& state);

  struct Impl;

 private:
  std::unique_ptr<Impl> m_impl;
};

}  // namespace argil::contact
