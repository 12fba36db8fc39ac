#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "contact/bounding_tree.h"
#include "contact/contact.h"
#include "contact/surface_features.h"
#include "contact/tool_solid.h"
#include "mesh/box_tree.h"

namespace argil::contact {

/// Where a tool is nearest to a body's surface, or deepest in the body.
struct Approach {
  double distance = std::numeric_limits<double>::infinity();  ///< [m]; negative: so deep in the body
  Vec3 on_body = Vec3::Zero();                                ///< place of the body's surface [m]
  Vec3 to_body = Vec3::Zero();  ///< unit: the way that takes the tool nearer there, or deeper
  std::size_t pose = 0;         ///< which of the poses
};

/// Finds how near a tool comes to a body that keeps its shape. The distance is the least of the tool's signed
/// distance over the body's surface, which is the depth that the pressure law sees, and of what its inner
/// balls have: their middle's signed distance from the body less their radius. Outside the body the latter
/// are never the smaller ones; a tool whose middle is inside has its depth from them. Right to kTolerance of
/// the tool's thickness; for a tool that is a mesh, where its surface bends less than that within a sixteenth
/// of its thickness.
class ApproachFinder {
 public:
  static constexpr double kTolerance = 1e-6;

  /// `body`: a closed surface, outward.
  ApproachFinder(const mesh::TriangleMesh& body, ToolSolid tool);

  /// Of the tool in `poses`, each moved by `shift` [m]. Ends with the first one found that is at or below
  /// `enough`. At least one pose.
  Approach find(std::span<const Pose> poses, const Vec3& shift = Vec3::Zero(),
                double enough = -std::numeric_limits<double>::infinity());

  /// Moves the poses on along a unit direction, from `begin` [m], to where the tool is first `depth` [m] deep
  /// in the body. Returns by how much; nothing when that takes more than `most` [m].
  std::optional<double> find_shift(std::span<const Pose> poses, const Vec3& begin, const Vec3& direction,
                                   double depth, double most);

  /// How deep a point is in the tool [m]; negative outside.
  double find_depth(const Pose& pose, const Vec3& point) {
    return -m_tool.find_distance(pose.orientation.conjugate() * (point - pose.position), m_tool_face)
                .distance;
  }

  const ToolSolid& tool() const { return m_tool; }
  const mesh::Box& box() const { return m_box; }  ///< of the body

 private:
  using Piece = std::array<Vec3, 3>;  // of a triangle, in the tool frame

  double look(const Pose& pose, std::size_t number);
  double look_from_balls(bool has_one_side);
  double look_over_surface();
  double find_least(const mesh::Box& box);
  void look_at_triangle(int triangle);
  void offer(double distance, const Vec3& on_body, const Vec3& to_body);
  ToolDistance offer_from_surface(const Vec3& in_tool);
  bool may_be_nearer(double bound);

  mesh::TriangleMesh m_body;
  SurfaceFeatures m_features;
  BoundingTree m_nearest;         // what of the body is nearest to a point
  mesh::BoxTree<char> m_surface;  // the body's triangles
  mesh::Box m_box;
  ToolSolid m_tool;
  std::vector<int> m_face;   // near each inner ball
  int m_tool_face = 0;       // near the last point
  double m_tolerance = 0.0;  // [m]
  // Of the present search.
  Approach m_best;
  Pose m_pose;
  Mat3 m_turn = Mat3::Identity();  // tool to world
  std::size_t m_number = 0;        // of the pose
  double m_left_out = 0.0;         // nothing that was left out is nearer [m]
  std::vector<Piece> m_pieces;
};

}  // namespace argil::contact
