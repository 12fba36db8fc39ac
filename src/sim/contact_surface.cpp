#include "sim/contact_surface.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/check.h"
#include "base/lanes.h"
#include "embed/fine_skin.h"
#include "mesh/quadratic.h"

namespace argil::sim {
namespace {

constexpr double kSkinOverCell = 1.0 / 3.0;  // longest edge of a touched triangle, over the cell

/// Does one tet have all the nodes of this stiffness?
bool shares_tet(const solid::PointStiffness& s, const solid::Elements& elements) {
  const auto first = static_cast<std::size_t>(s.vertex[0]);
  for (int c = elements.node_begin[first]; c < elements.node_begin[first + 1]; ++c) {
    const auto nodes =
        elements.nodes.col(elements.node_corners[static_cast<std::size_t>(c)] / elements.nodes_per_tet);
    bool has_all = true;
    for (std::size_t i = 1; has_all && i < s.count(); ++i) has_all = (nodes.array() == s.vertex[i]).any();
    if (has_all) return true;
  }
  return false;
}

}  // namespace

ContactSurface::ContactSurface(SurfaceKind kind, contact::ContactLaw law, const Body& body,
                               const solid::Elements& elements) {
  m_begin.push_back(0);
  const bool has_own = body.touched.num_triangles() > 0;
  if (kind == SurfaceKind::cage && !has_own) {
    take_boundary(body, elements);
    return;
  }
  const mesh::TriangleMesh& surface = has_own ? body.touched : body.skin;
  const embed::Embedding& embedding = has_own ? body.touched_embedding : body.skin_embedding;
  ARGIL_ASSERT(embedding.num_points() > 0);
  if (law == contact::ContactLaw::pairs) {
    take_skin(surface.triangles, embedding, elements);
    return;
  }
  const double nodes_per_edge = elements.nodes_per_tet == 4 ? 1.0 : 2.0;
  const bool is_new = has_own && body.epoch > 0;
  const embed::FineSkin fine = embed::split_to_cells(
      surface, embedding, body.mesh, (is_new ? kTouchedOverCell : kSkinOverCell) / nodes_per_edge);
  take_skin(fine.triangles, fine.embedding, elements);
}

void ContactSurface::add_node(int node, double weight) {
  m_node.push_back(node);
  m_weight.push_back(weight);
}

void ContactSurface::take_boundary(const Body& body, const solid::Elements& elements) {
  m_triangles = elements.surface;
  for (int v = 0; v < elements.num_nodes(); ++v) {
    add_node(v, 1.0);
    close_vertex();
  }
  m_is_corner.resize(static_cast<std::size_t>(elements.num_nodes()), 0);
  for (const int node : m_triangles.reshaped()) m_is_corner[static_cast<std::size_t>(node)] = 1;
  for (const int tet : body.topology.boundary_tet)
    m_tets.insert(m_tets.end(), static_cast<std::size_t>(elements.surface_per_face), tet);
  note_tets(elements);
}

void ContactSurface::take_skin(const Triangles& triangles, const embed::Embedding& embedding,
                               const solid::Elements& elements) {
  m_triangles = triangles;
  for (int v = 0; v < embedding.num_points(); ++v) {
    const auto nodes = elements.nodes.col(embedding.tet[static_cast<std::size_t>(v)]);
    Eigen::VectorXd shape = embedding.weights.col(v);
    if (nodes.size() == 10) shape = mesh::compute_quadratic_shape(embedding.weights.col(v));
    for (Eigen::Index k = 0; k < nodes.size(); ++k) add_node(nodes(k), shape(k));
    close_vertex();
  }
  m_tets_per_triangle = 3;
  for (Eigen::Index t = 0; t < m_triangles.cols(); ++t)
    for (Eigen::Index k = 0; k < 3; ++k)
      m_tets.push_back(embedding.tet[static_cast<std::size_t>(m_triangles(k, t))]);
  note_tets(elements);
}

void ContactSurface::note_tets(const solid::Elements& elements) {
  for (const auto& corners : m_triangles.colwise())
    m_is_of_one_tet.push_back(is_of_one_tet(std::array{corners(0), corners(1), corners(2)}, elements) ? 1
                                                                                                      : 0);
}

ARGIL_EVERY_PROCESSOR void ContactSurface::find_positions(const Points& x, Points& out) const {
  out.resize(3, num_vertices());
  // A quad reads and writes a number beyond its point: the next vertex writes its own over it, and the last
  // node and the last vertex have none.
  const int last_node = static_cast<int>(x.cols()) - 1;
  for (int v = 0; v < num_vertices(); ++v) {
    Quad sum = {};
    const auto i = static_cast<std::size_t>(v);
    for (auto k = static_cast<std::size_t>(m_begin[i]); k < static_cast<std::size_t>(m_begin[i + 1]); ++k) {
      const double* from = x.data() + 3 * static_cast<std::ptrdiff_t>(m_node[k]);
      Quad node;
      if (m_node[k] < last_node)
        read(from, node);
      else
        node = Quad{from[0], from[1], from[2], 0.0};
      sum += m_weight[k] * node;
    }
    if (v + 1 < num_vertices())
      write(sum, out.col(v).data());
    else
      out.col(v) = Vec3(sum[0], sum[1], sum[2]);
  }
}

bool ContactSurface::find_moved(const OrderedItems& nodes, const Points& x, std::vector<int>& vertices,
                                Points& places) const {
  const std::vector<int>* listed = nodes.list();
  if (!listed || m_is_corner.empty()) return false;
  vertices.clear();
  std::copy_if(listed->begin(), listed->end(), std::back_inserter(vertices),
               [this](int node) { return m_is_corner[static_cast<std::size_t>(node)] != 0; });
  for (std::size_t i = 0; i < vertices.size(); ++i)
    places.col(static_cast<Eigen::Index>(i)) = x.col(vertices[i]);
  return true;
}

void ContactSurface::add_force(const SurfaceForce& f, NodalForce& force) const {
  for (std::size_t c = 0; c < 3 && f.vertex[c] >= 0; ++c) {
    const Vec3 share = f.weight[c] * f.force;
    ARGIL_ASSERT(f.vertex[c] < num_vertices(), f.vertex[c]);  // of this surface, not of an earlier one
    const auto i = static_cast<std::size_t>(f.vertex[c]);
    for (auto k = static_cast<std::size_t>(m_begin[i]); k < static_cast<std::size_t>(m_begin[i + 1]); ++k)
      force.add(m_node[k], m_weight[k] * share);
  }
}

/// False when the nodes do not fit in.
bool ContactSurface::add_nodes(int vertex, double weight, solid::PointStiffness& out) const {
  constexpr double kNothing = 1e-9;  // weight of a node that a point on a face or corner of its tet rounds to
  const auto i = static_cast<std::size_t>(vertex);
  for (auto k = static_cast<std::size_t>(m_begin[i]); k < static_cast<std::size_t>(m_begin[i + 1]); ++k) {
    if (std::abs(m_weight[k]) < kNothing) continue;
    std::size_t place = 0;
    while (place < out.vertex.size() && out.vertex[place] >= 0 && out.vertex[place] != m_node[k]) ++place;
    if (place == out.vertex.size()) return false;
    out.vertex[place] = m_node[k];
    out.weight[place] += weight * m_weight[k];
  }
  return true;
}

bool ContactSurface::is_of_one_tet(std::span<const int> vertices, const solid::Elements& elements) const {
  solid::PointStiffness whole;
  const bool fits =
      std::all_of(vertices.begin(), vertices.end(), [&](int v) { return add_nodes(v, 1.0, whole); });
  return fits && shares_tet(whole, elements);
}

void ContactSurface::add_stiffness(const contact::Contact& contact, const Vec3& direction, double stiffness,
                                   const solid::Elements& elements,
                                   std::vector<solid::PointStiffness>& list) const {
  const auto start = [&](double share) -> solid::PointStiffness& {
    solid::PointStiffness& s = list.emplace_back();
    s.normal = direction;
    s.stiffness = share * stiffness;
    return s;
  };
  const auto end = std::find(contact.vertex.begin(), contact.vertex.end(), -1);
  const std::span<const int> vertices(contact.vertex.begin(), end);
  const auto triangle = static_cast<std::size_t>(contact.triangle);
  // The nodes of one vertex are those of one tet.
  const bool is_one = vertices.size() == 1 || (contact.triangle >= 0 ? m_is_of_one_tet[triangle] != 0
                                                                     : is_of_one_tet(vertices, elements));
  if (is_one) {
    solid::PointStiffness& whole = start(1.0);
    for (std::size_t c = 0; c < vertices.size(); ++c) add_nodes(vertices[c], contact.weight[c], whole);
    return;
  }
  for (std::size_t c = 0; c < vertices.size(); ++c) add_nodes(vertices[c], 1.0, start(contact.weight[c]));
}

void ContactSurface::find_touched_tets(const contact::Contacts& contacts, std::vector<int>& tet,
                                       std::vector<double>& area) const {
  tet.clear();
  area.clear();
  for (std::size_t i = 0; i < contacts.touched_triangle.size(); ++i)
    for (int k = 0; k < m_tets_per_triangle; ++k) {
      const int place = m_tets_per_triangle * contacts.touched_triangle[i] + k;
      tet.push_back(m_tets[static_cast<std::size_t>(place)]);
      area.push_back(contacts.touched_area[i] / m_tets_per_triangle);
    }
}

}  // namespace argil::sim
