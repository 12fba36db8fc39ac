#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/types.h"
#include "mesh/tet_mesh.h"

namespace argil::contact {

/// A ball of `tip_radius` around the origin that widens towards +z, the exact form of the tools that
/// contact/tool_shape.h draws as triangles:
/// sphere: length 0; capsule: ends in a ball of the same radius; stylus: ends flat.
struct RoundTool {
  double tip_radius = 0.0;  ///< [m] > 0
  double length = 0.0;      ///< [m] from the tip's centre to the other end's: 0: a sphere
  double end_radius = 0.0;  ///< [m] at z = length; that of the tip for sphere and capsule
  bool is_flat = false;     ///< the other end is a disc at z = length
};

/// Where a point lies from a tool.
struct ToolDistance {
  double distance = 0.0;        ///< from the surface, negative inside [m]
  Vec3 outward = Vec3::Zero();  ///< its gradient, unit: the way out of the tool
};

/// A ball inside a tool, in the tool frame.
struct InnerBall {
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;  ///< [m] > 0: its distance from the tool's surface
};

/// Signed distance from a closed tool, in the tool frame. It changes by no more than the point moves.
class ToolSolid {
 public:
  /// The exact shape.
  explicit ToolSolid(const RoundTool& shape);
  /// What the closed surface encloses: by its nearest face, edge or corner [Baerentzen2005].
  explicit ToolSolid(const mesh::TriangleMesh& surface);
  ~ToolSolid();
  ToolSolid(ToolSolid&&) noexcept;

  /// Of a point in the tool frame. `face`: a guess for the nearest face of a mesh, kept up to date.
  ToolDistance find_distance(const Vec3& p, int& face);

  /// A distance that is found sooner and is never the larger one.
  double find_least_distance(const Vec3& p) const;

  /// The same looks from everywhere; then the frame does not matter.
  bool is_ball() const { return m_round && m_round->length == 0.0; }
  ToolDistance find_from_ball(const Vec3& p) const {
    const double length = p.norm();
    return {length - m_radius, length > 0.0 ? Vec3(p / length) : Vec3(-Vec3::UnitZ())};
  }

  /// Known to be convex, as the distance from it then is.
  bool is_convex() const { return m_round.has_value(); }

  const Vec3& centre() const { return m_centre; }              ///< of a ball that holds the tool
  double radius() const { return m_radius; }                   ///< of that ball [m]
  double reach() const { return m_centre.norm() + m_radius; }  ///< from the origin, at most [m]
  /// Radius of a ball that the tool is not thinner than, as a rule [m].
  double thickness() const { return m_thickness; }
  /// A few balls along its middle; a sphere's is itself.
  const std::vector<InnerBall>& inner_balls() const { return m_inner_balls; }

 private:
  struct Mesh;

  void list_balls_on_axis();
  void list_balls_in_mesh();
  void add_ball(const Vec3& centre);

  std::optional<RoundTool> m_round;
  Eigen::Vector2d m_cone_normal = Eigen::Vector2d::UnitX();  // stylus: away from the axis, along it
  std::unique_ptr<Mesh> m_mesh;
  Vec3 m_centre = Vec3::Zero();
  double m_radius = 0.0;
  double m_thickness = 0.0;
  std::vector<InnerBall> m_inner_balls;
};

/// By its exact shape where it has one, else what its triangles enclose.
inline ToolSolid make_tool_solid(const std::optional<RoundTool>& round, const mesh::TriangleMesh& triangles) {
  return round ? ToolSolid(*round) : ToolSolid(triangles);
}

}  // namespace argil::contact
