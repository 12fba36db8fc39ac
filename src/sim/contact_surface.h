#pragma once

#include <array>
#include <span>
#include <vector>

#include "contact/contact.h"
#include "sim/nodal_force.h"
#include "sim/params.h"
#include "sim/state.h"

namespace argil::sim {

/// Longest edge of a triangle that the tool meets, over the mean edge of the tet beneath, in a body that has
/// got new cells; a half of that with ten nodes.
inline constexpr double kTouchedOverCell = 0.5;

/// A force on vertices of the touched surface, shared by weights of sum 1.
struct SurfaceForce {
  std::array<int, 3> vertex = {-1, -1, -1};  ///< −1 beyond the last
  std::array<double, 3> weight = {};
  Vec3 force = Vec3::Zero();  ///< [N]
};

/// What the tool touches: the boundary of the solid, or the skin embedded in it. Its vertices lie at x_s = W
/// x, and what acts on them acts on the nodes as f = Wᵀ f_s: the same weights, so that force, torque and work
/// are the same on both.
///
/// By the pressure law a skin's triangles that are larger than the body's cells are split, so that what is
/// touched follows the body everywhere and the force does not hang on how many triangles the skin has. The
/// skin that is written and drawn stays as it is.
class ContactSurface {
 public:
  ContactSurface(SurfaceKind kind, contact::ContactLaw law, const Body& body,
                 const solid::Elements& elements);

  const Triangles& triangles() const { return m_triangles; }
  int num_vertices() const { return static_cast<int>(m_begin.size()) - 1; }

  /// The nodes that carry a vertex, and N of each.
  std::span<const int> nodes(int vertex) const { return slice(m_node, vertex); }
  std::span<const double> weights(int vertex) const { return slice(m_weight, vertex); }

  /// Positions of the vertices [m] for nodes at x.
  void find_positions(const Points& x, Points& out) const;

  /// The vertices that go with these nodes, and their places, into columns that are there. False: all of them
  /// have to be found.
  bool find_moved(const OrderedItems& nodes, const Points& x, std::vector<int>& vertices,
                  Points& places) const;

  /// Adds Wᵀ f to the nodes' forces [N].
  void add_force(const SurfaceForce& f, NodalForce& force) const;

  /// Appends a contact's stiffness [N/m] along a direction, between nodes. What hangs on nodes that share no
  /// tet is taken as one stiffness for each vertex of the contact, in proportion to its weight: no softer, as
  /// Σ wᵢ (n·uᵢ)² ≥ (n·Σ wᵢ uᵢ)², and the same where they move alike.
  void add_stiffness(const contact::Contact& contact, const Vec3& direction, double stiffness,
                     const solid::Elements& elements, std::vector<solid::PointStiffness>& list) const;

  /// A tet under a triangle: of a skin, under its first corner.
  int tet_under(int triangle) const {
    return m_tets[static_cast<std::size_t>(triangle) * static_cast<std::size_t>(m_tets_per_triangle)];
  }

  /// Tets under the touched area and how much of it each has [m²], triangle by triangle; a skin's triangle
  /// gives a third to the tet of each of its corners.
  void find_touched_tets(const contact::Contacts& contacts, std::vector<int>& tet,
                         std::vector<double>& area) const;

 private:
  void add_node(int node, double weight);
  void close_vertex() { m_begin.push_back(static_cast<int>(m_node.size())); }
  void take_boundary(const Body& body, const solid::Elements& elements);
  void take_skin(const Triangles& triangles, const embed::Embedding& embedding,
                 const solid::Elements& elements);
  void note_tets(const solid::Elements& elements);
  template <class Value>
  std::span<const Value> slice(const std::vector<Value>& list, int vertex) const {
    const auto begin = static_cast<std::size_t>(m_begin[static_cast<std::size_t>(vertex)]);
    const auto end = static_cast<std::size_t>(m_begin[static_cast<std::size_t>(vertex) + 1]);
    return std::span(list).subspan(begin, end - begin);
  }
  bool add_nodes(int vertex, double weight, solid::PointStiffness& out) const;
  bool is_of_one_tet(std::span<const int> vertices, const solid::Elements& elements) const;

  Triangles m_triangles;
  std::vector<char> m_is_corner;     // of a triangle, where vertices are nodes; else empty
  std::vector<int> m_begin, m_node;  // nodes that carry each vertex
  std::vector<double> m_weight;      // N of each
  std::vector<int> m_tets;           // the tets under each triangle, m_tets_per_triangle of them
  int m_tets_per_triangle = 1;
  std::vector<char> m_is_of_one_tet;  // of each triangle: its corners hang on nodes of one tet
};

}  // namespace argil::sim
