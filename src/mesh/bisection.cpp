#include "mesh/bisection.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "mesh/quality.h"

namespace argil::mesh {
namespace {

constexpr double kTetsPerCube = 12.0;
constexpr double kSoundAngle = 18.0;  // [degrees] that a new vertex on the boundary may take it to

struct Edge {
  double length2 = -1.0;  // [m²]
  int a = -1, b = -1;     // a < b
  bool is_longer_than(const Edge& other) const {
    if (length2 != other.length2) return length2 > other.length2;
    return a != other.a ? a < other.a : b < other.b;
  }
  bool operator==(const Edge& other) const { return a == other.a && b == other.b; }
};

class Bisector {
 public:
  Bisector(const TetMesh& mesh, const SizeField& wanted_size, int most_tets,
           const BoundaryPoint& boundary_point)
      : m_wanted_size(wanted_size), m_most_tets(most_tets), m_boundary_point(boundary_point) {
    m_x.reserve(static_cast<std::size_t>(mesh.num_vertices()));
    for (int v = 0; v < mesh.num_vertices(); ++v) m_x.push_back(mesh.vertices.col(v));
    m_around.resize(m_x.size());
    for (int t = 0; t < mesh.num_tets(); ++t) {
      const Eigen::Vector4i tet = mesh.tets.col(t);
      m_parent.push_back(t);
      m_tets.push_back({tet(0), tet(1), tet(2), tet(3)});
      m_longest.push_back(find_longest(m_tets.back()));
      for (const int v : m_tets.back()) m_around[static_cast<std::size_t>(v)].push_back(t);
    }
  }

  void run() {
    // A tet keeps its number for one of its halves; the other is looked at later.
    for (int t = 0; t < num_tets(); ++t)
      while (is_too_large(t) && num_tets() <= m_most_tets) halve(t);
  }

  BisectedMesh take(const TetMesh& before) {
    BisectedMesh result;
    result.mesh.vertices.resize(3, static_cast<Eigen::Index>(m_x.size()));
    for (std::size_t v = 0; v < m_x.size(); ++v)
      result.mesh.vertices.col(static_cast<Eigen::Index>(v)) = m_x[v];
    result.mesh.tets.resize(4, num_tets());
    for (int t = 0; t < num_tets(); ++t)
      result.mesh.tets.col(t) = Eigen::Vector4i(m_tets[static_cast<std::size_t>(t)].data());
    for (const auto& [name, field] : before.cell_fields) {
      Field& children = result.mesh.cell_fields[name];
      children.resize(num_tets());
      for (int t = 0; t < num_tets(); ++t) children(t) = field(m_parent[static_cast<std::size_t>(t)]);
    }
    result.parent = std::move(m_parent);
    result.halved_edge = std::move(m_halved_edge);
    return result;
  }

 private:
  using Tet = std::array<int, 4>;

  int num_tets() const { return static_cast<int>(m_tets.size()); }

  Edge find_longest(const Tet& tet) const {
    Edge longest;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const auto [a, b] = std::minmax(tet[i], tet[j]);
        const Edge edge{(m_x[static_cast<std::size_t>(b)] - m_x[static_cast<std::size_t>(a)]).squaredNorm(),
                        a, b};
        if (edge.is_longer_than(longest)) longest = edge;
      }
    return longest;
  }

  std::array<Vec3, 4> corners_of(int t) const {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i)
      x[i] = m_x[static_cast<std::size_t>(m_tets[static_cast<std::size_t>(t)][i])];
    return x;
  }

  bool is_too_large(int t) const {
    const std::array<Vec3, 4> x = corners_of(t);
    const double size = compute_cell_size(compute_tet_volume(x[0], x[1], x[2], x[3]));
    return size > m_wanted_size(0.25 * (x[0] + x[1] + x[2] + x[3]));
  }

  /// Halves t, and before it the tets at whose longest edges the way to its own leads: each of them is longer
  /// than the one before.
  void halve(int t) {
    const Edge wanted = m_longest[static_cast<std::size_t>(t)];
    while (m_longest[static_cast<std::size_t>(t)] == wanted) {
      Edge edge = wanted;
      find_around(edge);
      for (std::size_t i = 0; i < m_ring.size();) {
        const Edge& other = m_longest[static_cast<std::size_t>(m_ring[i++])];
        if (other == edge) continue;
        edge = other;
        find_around(edge);
        i = 0;
      }
      split(edge);
    }
  }

  void find_around(const Edge& edge) {
    m_ring.clear();
    for (const int t : m_around[static_cast<std::size_t>(edge.a)]) {
      const Tet& tet = m_tets[static_cast<std::size_t>(t)];
      if (std::find(tet.begin(), tet.end(), edge.b) != tet.end()) m_ring.push_back(t);
    }
  }

  /// Of the edge that m_ring is around: round one inside, every other corner is met twice.
  bool is_on_boundary(const Edge& edge) {
    m_others.clear();
    for (const int t : m_ring)
      for (const int v : m_tets[static_cast<std::size_t>(t)])
        if (v != edge.a && v != edge.b) m_others.push_back(v);
    std::sort(m_others.begin(), m_others.end());
    for (std::size_t i = 0; i < m_others.size(); i += 2)
      if (i + 1 == m_others.size() || m_others[i] != m_others[i + 1]) return true;
    return false;
  }

  Vec3 place_middle(const Edge& edge) {
    const Vec3& a = m_x[static_cast<std::size_t>(edge.a)];
    const Vec3& b = m_x[static_cast<std::size_t>(edge.b)];
    const Vec3 middle = 0.5 * (a + b);
    if (!m_boundary_point || !is_on_boundary(edge)) return middle;
    const Vec3 way = m_boundary_point(a, b) - middle;
    const double worst = find_worst_angle(edge, middle);
    for (double share = 1.0; share > 0.1; share *= 0.5)
      if (find_worst_angle(edge, middle + share * way) >= std::min(kSoundAngle, worst))
        return middle + share * way;
    return middle;
  }

  /// Of the halves with a corner at `point`: the smallest dihedral angle or what the largest leaves of 180
  /// degrees; −1 where one is turned over.
  double find_worst_angle(const Edge& edge, const Vec3& point) const {
    double worst = 180.0;
    for (const int t : m_ring)
      for (const int end : {edge.a, edge.b}) {
        std::array<Vec3, 4> half = corners_of(t);
        for (std::size_t i = 0; i < 4; ++i)
          if (m_tets[static_cast<std::size_t>(t)][i] == end) half[i] = point;
        if (!(compute_tet_volume(half[0], half[1], half[2], half[3]) > 0.0)) return -1.0;
        const DihedralAngles angles = compute_dihedral_angles(half);
        worst = std::min({worst, angles.smallest_degrees, 180.0 - angles.largest_degrees});
      }
    return worst;
  }

  /// Halves all tets of m_ring at an edge of theirs.
  void split(const Edge& edge) {
    const int middle = static_cast<int>(m_x.size());
    m_x.push_back(place_middle(edge));
    m_halved_edge.push_back({edge.a, edge.b});
    m_around.emplace_back();
    for (const int t : m_ring) {
      const int half = num_tets();
      Tet other = m_tets[static_cast<std::size_t>(t)];
      std::replace(other.begin(), other.end(), edge.a, middle);
      Tet& tet = m_tets[static_cast<std::size_t>(t)];
      std::replace(tet.begin(), tet.end(), edge.b, middle);
      m_longest[static_cast<std::size_t>(t)] = find_longest(tet);
      for (const int v : other) {
        std::vector<int>& around = m_around[static_cast<std::size_t>(v)];
        if (v == edge.b)
          std::replace(around.begin(), around.end(), t, half);
        else
          around.push_back(half);
      }
      m_around.back().push_back(t);
      m_tets.push_back(other);
      m_longest.push_back(find_longest(other));
      m_parent.push_back(m_parent[static_cast<std::size_t>(t)]);
    }
  }

  const SizeField& m_wanted_size;
  int m_most_tets;
  const BoundaryPoint& m_boundary_point;
  std::vector<Vec3> m_x;
  std::vector<Tet> m_tets;
  std::vector<Edge> m_longest;             // of each tet
  std::vector<int> m_parent;               // of each tet
  std::vector<std::vector<int>> m_around;  // tets at each vertex
  std::vector<std::array<int, 2>> m_halved_edge;
  std::vector<int> m_ring;    // tets around the edge that is looked at
  std::vector<int> m_others;  // their other corners
};

}  // namespace

double compute_cell_size(double volume) {
  return std::cbrt(kTetsPerCube * volume);
}

BisectedMesh bisect(const TetMesh& mesh, const SizeField& wanted_size, int most_tets,
                    const BoundaryPoint& boundary_point) {
  ARGIL_ASSERT(most_tets > 0, most_tets);
  Bisector bisector(mesh, wanted_size, most_tets, boundary_point);
  bisector.run();
  return bisector.take(mesh);
}

}  // namespace argil::mesh
