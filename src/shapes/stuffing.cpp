#include "shapes/stuffing.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/check.h"

namespace argil::shapes {
namespace {

using Side = CutLattice::Side;

// Nodes of one lattice tet. Corners 0–1 and 2–3 are its two long edges, the other four edges are short.
struct LatticeTet {
  std::array<int, 4> node;
  std::array<LatticePlace, 4> place;
};

bool is_long_edge(int corner_a, int corner_b) {
  return corner_a / 2 == corner_b / 2;
}

int find_direction(const LatticePlace& from, const LatticePlace& to) {
  const LatticePlace step = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
  for (int i = 0; i < 2 * kForwardEdges; ++i)
    if (kLatticeEdges[static_cast<std::size_t>(i)] == step) return i;
  ARGIL_ASSERT(false, step[0], step[1], step[2]);
  return -1;
}

class Stuffer {
 public:
  explicit Stuffer(const CutLattice& cut_lattice)
      : m_cut_lattice(cut_lattice),
        m_node_vertex(static_cast<std::size_t>(cut_lattice.lattice().num_nodes()), -1),
        m_cut_vertex(static_cast<std::size_t>(cut_lattice.num_cuts()), -1) {}

  void add_lattice_tet(const LatticeTet& tet, StuffingPart part);
  StuffedLattice take();

 private:
  void add_two_inside(const LatticeTet& tet, const std::array<int, 4>& corners, int num_outside);
  void add_three_inside(const LatticeTet& tet, const std::array<int, 4>& corners);
  bool starts_at_first(const LatticeTet& tet, int a, int b, int c) const;
  int node_vertex(const LatticeTet& tet, int corner);
  int cut_vertex(const LatticeTet& tet, int inside, int outside);
  int add_vertex(const Vec3& position, int node, bool on_surface);
  void add_tet(int a, int b, int c, int d);

  const CutLattice& m_cut_lattice;
  std::vector<int> m_node_vertex;  // output vertex of each node, −1: not used yet
  std::vector<int> m_cut_vertex;   // the same for cuts
  std::vector<Vec3> m_position;
  std::vector<int> m_origin;  // node of each vertex, −1: a cut
  std::vector<bool> m_on_surface;
  std::vector<std::array<int, 4>> m_tets;
};

int Stuffer::add_vertex(const Vec3& position, int node, bool on_surface) {
  m_position.push_back(position);
  m_origin.push_back(node);
  m_on_surface.push_back(on_surface);
  return static_cast<int>(m_position.size()) - 1;
}

int Stuffer::node_vertex(const LatticeTet& tet, int corner) {
  const int node = tet.node[static_cast<std::size_t>(corner)];
  int& vertex = m_node_vertex[static_cast<std::size_t>(node)];
  if (vertex < 0)
    vertex = add_vertex(m_cut_lattice.position(node), node, m_cut_lattice.side(node) == Side::surface);
  return vertex;
}

int Stuffer::cut_vertex(const LatticeTet& tet, int inside, int outside) {
  const auto from = static_cast<std::size_t>(inside);
  const auto to = static_cast<std::size_t>(outside);
  const int cut = m_cut_lattice.find_cut(tet.node[from], find_direction(tet.place[from], tet.place[to]));
  ARGIL_ASSERT(cut >= 0, tet.node[from], tet.node[to]);
  int& vertex = m_cut_vertex[static_cast<std::size_t>(cut)];
  if (vertex < 0) vertex = add_vertex(m_cut_lattice.cut_position(cut), -1, true);
  return vertex;
}

void Stuffer::add_tet(int a, int b, int c, int d) {
  const auto at = [this](int vertex) -> const Vec3& { return m_position[static_cast<std::size_t>(vertex)]; };
  const double volume = mesh::compute_tet_volume(at(a), at(b), at(c), at(d));
  if (volume < 0.0) std::swap(c, d);
  m_tets.push_back({a, b, c, d});
}

// A face with inside corners a, b and outside corner c leaves a quadrilateral a, b, cut(bc), cut(ac), which
// both tets at the face must halve alike. True: by the diagonal from a. When ac or bc is long, the diagonal
// starts where two short edges meet. When ab is long, parity decides: from the end that has an even number of
// coordinates greater than c's, so that the two faces at ab in one tet start at different ends.
bool Stuffer::starts_at_first(const LatticeTet& tet, int a, int b, int c) const {
  if (!is_long_edge(a, b)) return !is_long_edge(a, c);
  int num_greater = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (tet.place[static_cast<std::size_t>(a)][axis] > tet.place[static_cast<std::size_t>(c)][axis])
      ++num_greater;
  return num_greater % 2 == 0;
}

void Stuffer::add_two_inside(const LatticeTet& tet, const std::array<int, 4>& corners, int num_outside) {
  int a = corners[0];
  int b = corners[1];
  int c = corners[2];
  const int d = corners[3];
  if (num_outside == 1) {  // d lies on the surface: a pyramid with tip d
    if (!starts_at_first(tet, a, b, c)) std::swap(a, b);
    const int A = node_vertex(tet, a);
    const int tip = node_vertex(tet, d);
    const int bc = cut_vertex(tet, b, c);
    add_tet(tip, A, node_vertex(tet, b), bc);
    add_tet(tip, A, bc, cut_vertex(tet, a, c));
    return;
  }
  // A wedge. Its two face diagonals start at different ends of ab, so a third one closes three tets.
  const bool c_face_from_a = starts_at_first(tet, a, b, c);
  ARGIL_ASSERT(c_face_from_a != starts_at_first(tet, a, b, d), tet.node[0]);
  if (!c_face_from_a) std::swap(a, b);
  const int A = node_vertex(tet, a);
  const int B = node_vertex(tet, b);
  const int bc = cut_vertex(tet, b, c);
  const int ad = cut_vertex(tet, a, d);
  add_tet(A, cut_vertex(tet, a, c), ad, bc);
  add_tet(A, B, bc, ad);
  add_tet(B, bc, cut_vertex(tet, b, d), ad);
}

void Stuffer::add_three_inside(const LatticeTet& tet, const std::array<int, 4>& corners) {
  const int out = corners[3];
  int a = corners[0];
  int b = corners[1];
  int c = corners[2];
  if (is_long_edge(b, out)) std::swap(a, b);
  if (is_long_edge(c, out)) std::swap(a, c);
  if (!starts_at_first(tet, b, c, out)) std::swap(b, c);
  // The faces at a both start from their other end and meet in the cut of a; the quadrilateral b, c is left.
  const int B = node_vertex(tet, b);
  const int C = node_vertex(tet, c);
  const int a_cut = cut_vertex(tet, a, out);
  const int c_cut = cut_vertex(tet, c, out);
  add_tet(node_vertex(tet, a), B, C, a_cut);
  add_tet(a_cut, B, C, c_cut);
  add_tet(a_cut, B, c_cut, cut_vertex(tet, b, out));
}

void Stuffer::add_lattice_tet(const LatticeTet& tet, StuffingPart part) {
  std::array<int, 4> corners{};  // inside first, then outside, then surface
  std::array<int, 3> count{};
  int next = 0;
  for (const Side wanted : {Side::inside, Side::outside, Side::surface})
    for (int corner = 0; corner < 4; ++corner)
      if (m_cut_lattice.side(tet.node[static_cast<std::size_t>(corner)]) == wanted) {
        corners[static_cast<std::size_t>(next++)] = corner;
        ++count[static_cast<std::size_t>(static_cast<int>(wanted) + 1)];
      }
  const int num_inside = count[0];
  const int num_outside = count[2];
  if (num_inside == 0 || (part == StuffingPart::surface_layer && num_inside == 4)) return;
  if (num_inside == 1 || num_outside == 0) {
    std::array<int, 4> vertex{};
    for (int i = 0; i < 4; ++i) {
      const bool is_outside = i >= num_inside && i < num_inside + num_outside;
      const int corner = corners[static_cast<std::size_t>(i)];
      vertex[static_cast<std::size_t>(i)] =
          is_outside ? cut_vertex(tet, corners[0], corner) : node_vertex(tet, corner);
    }
    add_tet(vertex[0], vertex[1], vertex[2], vertex[3]);
  } else if (num_inside == 2) {
    add_two_inside(tet, corners, num_outside);
  } else {
    add_three_inside(tet, corners);
  }
}

StuffedLattice Stuffer::take() {
  StuffedLattice result;
  result.mesh.vertices.resize(3, static_cast<Eigen::Index>(m_position.size()));
  for (std::size_t i = 0; i < m_position.size(); ++i)
    result.mesh.vertices.col(static_cast<Eigen::Index>(i)) = m_position[i];
  result.mesh.tets.resize(4, static_cast<Eigen::Index>(m_tets.size()));
  for (std::size_t i = 0; i < m_tets.size(); ++i)
    result.mesh.tets.col(static_cast<Eigen::Index>(i)) = Eigen::Vector4i(m_tets[i].data());
  result.node = std::move(m_origin);
  result.on_surface = std::move(m_on_surface);
  return result;
}

// Corners of the cube face between two centres, counter-clockwise about `axis`, relative to the first centre.
std::array<LatticePlace, 4> face_corners(std::size_t axis) {
  constexpr std::array<std::array<int, 2>, 4> kRound = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  std::array<LatticePlace, 4> corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i][axis] = 1;
    corners[i][(axis + 1) % 3] = kRound[i][0];
    corners[i][(axis + 2) % 3] = kRound[i][1];
  }
  return corners;
}

LatticePlace sum(const LatticePlace& a, const LatticePlace& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

}  // namespace

StuffedLattice stuff_lattice(const CutLattice& cut_lattice, StuffingPart part) {
  const BccLattice& lattice = cut_lattice.lattice();
  const std::array<int, 3>& cells = lattice.num_cells();
  Stuffer stuffer(cut_lattice);
  LatticeTet tet{};
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        tet.place[0] = {2 * i + 1, 2 * j + 1, 2 * k + 1};
        tet.node[0] = lattice.node(tet.place[0]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          tet.place[1] = tet.place[0];
          tet.place[1][axis] += 2;
          if (!lattice.contains(tet.place[1])) continue;
          tet.node[1] = lattice.node(tet.place[1]);
          const std::array<LatticePlace, 4> round = face_corners(axis);
          for (std::size_t edge = 0; edge < 4; ++edge) {
            tet.place[2] = sum(tet.place[0], round[edge]);
            tet.place[3] = sum(tet.place[0], round[(edge + 1) % 4]);
            tet.node[2] = lattice.node(tet.place[2]);
            tet.node[3] = lattice.node(tet.place[3]);
            stuffer.add_lattice_tet(tet, part);
          }
        }
      }
  return stuffer.take();
}

Triangles find_surface_faces(const StuffedLattice& stuffed) {
  // Corners of the face opposite to corner i, counter-clockwise from outside.
  static constexpr std::array<std::array<int, 3>, 4> kOppositeFace = {
      {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  struct Face {
    std::array<int, 3> key;  // sorted vertex numbers
    int corner;              // 4·tet + opposite corner
  };
  std::vector<Face> faces;
  const Tets& tets = stuffed.mesh.tets;
  const auto corner_face = [&tets](int corner) -> std::array<int, 3> {
    const auto& local = kOppositeFace[static_cast<std::size_t>(corner % 4)];
    const auto tet = tets.col(corner / 4);
    return {tet(local[0]), tet(local[1]), tet(local[2])};
  };
  for (int corner = 0; corner < static_cast<int>(tets.size()); ++corner) {
    Face face = {corner_face(corner), corner};
    if (!std::all_of(face.key.begin(), face.key.end(),
                     [&stuffed](int v) { return stuffed.on_surface[static_cast<std::size_t>(v)]; }))
      continue;
    std::sort(face.key.begin(), face.key.end());
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.key < b.key; });
  std::vector<int> single;  // corners of faces that only one tet has
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool like_before = i > 0 && faces[i - 1].key == faces[i].key;
    const bool like_after = i + 1 < faces.size() && faces[i + 1].key == faces[i].key;
    if (!like_before && !like_after) single.push_back(faces[i].corner);
  }
  std::sort(single.begin(), single.end());
  Triangles triangles(3, static_cast<Eigen::Index>(single.size()));
  for (std::size_t i = 0; i < single.size(); ++i)
    triangles.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3i(corner_face(single[i]).data());
  return triangles;
}

}  // namespace argil::shapes
