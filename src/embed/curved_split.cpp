#include "embed/curved_split.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace argil::embed {
namespace {

constexpr double kSmooth = 0.766;   // cos 40°: between the normals of faces that are one smooth surface
constexpr double kStraight = 0.01;  // of an edge's length, that its middle may lie off

using Edge = std::pair<int, int>;

Edge make_edge(int a, int b) {
  return std::minmax(a, b);
}

class Surface {
 public:
  explicit Surface(const mesh::TriangleMesh& surface) : m_surface(surface) {
    const Eigen::Index n = surface.triangles.cols();
    m_normal.resize(3, n);
    m_around.resize(static_cast<std::size_t>(surface.num_vertices()));
    for (Eigen::Index t = 0; t < n; ++t) {
      const auto v = surface.triangles.col(t);
      m_normal.col(t) = mesh::compute_area_vector(surface.vertices, v);
      for (Eigen::Index k = 0; k < 3; ++k) {
        m_around[static_cast<std::size_t>(v(k))].push_back(static_cast<int>(t));
        m_faces[make_edge(v(k), v((k + 1) % 3))].push_back(static_cast<int>(t));
      }
    }
  }

  /// Of the edges that are curved, how far off the middle is.
  std::map<Edge, Vec3> find_curved() const {
    std::map<Edge, Vec3> offsets;
    for (const auto& [edge, faces] : m_faces) {
      if (faces.size() != 2) continue;
      const Vec3 n1 = m_normal.col(faces[0]).normalized(), n2 = m_normal.col(faces[1]).normalized();
      if (!(n1.dot(n2) > kSmooth)) continue;
      const Vec3 mean = (n1 + n2).normalized();
      const Vec3 way = x(edge.second) - x(edge.first);
      const Vec3 na = find_normal(edge.first, mean), nb = find_normal(edge.second, mean);
      const Vec3 off = -0.125 * (way.dot(na) * na - way.dot(nb) * nb);
      if (off.norm() > kStraight * way.norm()) offsets[edge] = off;
    }
    return offsets;
  }

  /// Vertices that have gone the other way by the mean of their edges.
  Points place_back(const std::map<Edge, Vec3>& offsets) const {
    Points sum = Points::Zero(3, m_surface.num_vertices());
    Field count = Field::Zero(m_surface.num_vertices());
    for (const auto& [edge, off] : offsets)
      for (const int v : {edge.first, edge.second}) sum.col(v) += off;
    for (const auto& [edge, faces] : m_faces)
      for (const int v : {edge.first, edge.second}) count(v) += 1.0;
    Points placed = m_surface.vertices;
    for (int v = 0; v < m_surface.num_vertices(); ++v)
      if (count(v) > 0.0) placed.col(v) -= sum.col(v) / count(v);
    return placed;
  }

 private:
  Vec3 x(int v) const { return m_surface.vertices.col(v); }
  /// Mean of the faces around a vertex that are smooth with `of`.
  Vec3 find_normal(int v, const Vec3& of) const {
    Vec3 sum = Vec3::Zero();
    for (const int t : m_around[static_cast<std::size_t>(v)])
      if (m_normal.col(t).dot(of) > kSmooth * m_normal.col(t).norm()) sum += m_normal.col(t);
    return sum.isZero(0.0) ? of : Vec3(sum.normalized());
  }

  const mesh::TriangleMesh& m_surface;
  Points m_normal;
  std::vector<std::vector<int>> m_around;
  std::map<Edge, std::vector<int>> m_faces;
};

/// Triangles with one, two or three of their edges halved, in as many parts and one more.
class Halves {
 public:
  Halves(const mesh::TriangleMesh& surface, const std::map<Edge, Vec3>& offsets) {
    for (const Vec3 p : surface.vertices.colwise()) m_x.push_back(p);
    for (const auto& [edge, off] : offsets) {
      m_middle[edge] = static_cast<int>(m_x.size());
      m_x.push_back(0.5 * (surface.vertices.col(edge.first) + surface.vertices.col(edge.second)) + off);
    }
    for (const auto& v : surface.triangles.colwise()) split({v(0), v(1), v(2)});
  }
  mesh::TriangleMesh take() const {
    mesh::TriangleMesh made{Points(3, static_cast<Eigen::Index>(m_x.size())),
                            Triangles(3, static_cast<Eigen::Index>(m_triangles.size()))};
    for (std::size_t i = 0; i < m_x.size(); ++i) made.vertices.col(static_cast<Eigen::Index>(i)) = m_x[i];
    for (std::size_t i = 0; i < m_triangles.size(); ++i)
      made.triangles.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3i::Map(m_triangles[i].data());
    return made;
  }

 private:
  /// By one halved edge after the other, the longest first.
  void split(const std::array<int, 3>& v) {
    int longest = -1;
    double length = 0.0;
    for (int k = 0; k < 3; ++k) {
      const int a = v[static_cast<std::size_t>(k)], b = v[static_cast<std::size_t>((k + 1) % 3)];
      const double found =
          (m_x[static_cast<std::size_t>(a)] - m_x[static_cast<std::size_t>(b)]).squaredNorm();
      if (!m_middle.contains(make_edge(a, b)) || found <= length) continue;
      longest = k;
      length = found;
    }
    if (longest < 0) {
      m_triangles.push_back(v);
      return;
    }
    const auto k = static_cast<std::size_t>(longest);
    const int a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
    const int middle = m_middle.at(make_edge(a, b));
    split({a, middle, c});
    split({middle, b, c});
  }

  std::vector<Vec3> m_x;
  std::map<Edge, int> m_middle;
  std::vector<std::array<int, 3>> m_triangles;
};

}  // namespace

mesh::TriangleMesh split_where_curved(const mesh::TriangleMesh& surface) {
  constexpr int kTimes = 2;
  mesh::TriangleMesh made = surface;
  const Surface coarse(surface);
  made.vertices = coarse.place_back(coarse.find_curved());
  for (int i = 0; i < kTimes; ++i) made = Halves(made, Surface(made).find_curved()).take();
  return made;
}

}  // namespace argil::embed
