#include "embed/join_fine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/check.h"

namespace argil::embed {
namespace {

constexpr double kLongest = 2.0;     // edge that may come about, over the shortest that is wanted
constexpr double kOff = 1.0 / 12.0;  // of that, by which the surface may come to lie off
constexpr double kTurn = 0.866;      // cosine of the angle by which a face may turn
constexpr double kLeastShape = 0.3;  // of a face that comes about; 1: all edges alike
constexpr int kRounds = 8;

/// Sum of the squares of the distances from planes, as a function of the place.
struct Planes {
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0.0;
  void add(const Vec3& normal, const Vec3& at) {
    const double d = -normal.dot(at);
    A += normal * normal.transpose();
    b += d * normal;
    c += d * d;
  }
  void add(const Planes& other) {
    A += other.A;
    b += other.b;
    c += other.c;
  }
  double find(const Vec3& x) const { return x.dot(A * x) + 2.0 * b.dot(x) + c; }
};

double compute_shape(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return squares > 0.0 ? 2.0 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / squares : 0.0;
}

class Joiner {
 public:
  Joiner(const mesh::TriangleMesh& surface, const Field& shortest)
      : m_surface(surface),
        m_x(surface.vertices.colwise() - surface.vertices.rowwise().mean()),
        m_shortest(shortest),
        m_faces(static_cast<std::size_t>(surface.num_vertices())),
        m_planes(m_faces.size()) {
    for (const auto& t : surface.triangles.colwise()) {
      const int number = static_cast<int>(m_triangles.size());
      m_triangles.push_back({t(0), t(1), t(2)});
      const Vec3 normal = find_normal(m_triangles.back()).normalized();
      for (const int v : t) {
        faces(v).push_back(number);
        m_planes[static_cast<std::size_t>(v)].add(normal, m_x.col(v));
      }
    }
  }

  void run() {
    for (int round = 0; round < kRounds; ++round) {
      bool has_joined = false;
      for (int v = 0; v < static_cast<int>(m_faces.size()); ++v) has_joined = try_to_drop(v) || has_joined;
      if (!has_joined) return;
    }
  }

  mesh::TriangleMesh take() const {
    std::vector<int> number(m_faces.size(), -1);
    int count = 0;
    for (std::size_t v = 0; v < m_faces.size(); ++v)
      if (!m_faces[v].empty()) number[v] = count++;
    mesh::TriangleMesh made{Points(3, count), Triangles(3, 0)};
    for (std::size_t v = 0; v < m_faces.size(); ++v)
      if (number[v] >= 0) made.vertices.col(number[v]) = m_surface.vertices.col(static_cast<Eigen::Index>(v));
    std::vector<std::array<int, 3>> left;
    for (const auto& t : m_triangles)
      if (t[0] >= 0) left.push_back(t);
    made.triangles.resize(3, static_cast<Eigen::Index>(left.size()));
    for (std::size_t t = 0; t < left.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        made.triangles(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)) =
            number[static_cast<std::size_t>(left[t][k])];
    return made;
  }

 private:
  using Triangle = std::array<int, 3>;

  std::vector<int>& faces(int v) { return m_faces[static_cast<std::size_t>(v)]; }
  const std::vector<int>& faces(int v) const { return m_faces[static_cast<std::size_t>(v)]; }
  const Triangle& triangle(int t) const { return m_triangles[static_cast<std::size_t>(t)]; }
  Vec3 find_normal(const Triangle& t) const { return mesh::compute_area_vector(m_x, t); }

  /// Around v, in increasing order; each is listed twice where the surface is closed there.
  void list_ring(int v, std::vector<int>& ring) const {
    ring.clear();
    for (const int t : faces(v))
      for (const int other : triangle(t))
        if (other != v) ring.push_back(other);
    std::sort(ring.begin(), ring.end());
  }

  bool try_to_drop(int v) {
    if (faces(v).empty() || !(m_shortest(v) > 0.0)) return false;
    list_ring(v, m_ring);
    for (std::size_t i = 0; i < m_ring.size(); i += 2)  // a surface that is one sheet around v
      if (i + 1 == m_ring.size() || m_ring[i] != m_ring[i + 1] || (i > 0 && m_ring[i] == m_ring[i - 1]))
        return false;
    int to = -1;
    double length = m_shortest(v);
    for (const int u : m_ring) {
      const double found = (m_x.col(u) - m_x.col(v)).norm();
      if (!(found < length) || (m_shortest(u) > 0.0 && !(found < m_shortest(u)))) continue;
      to = u;
      length = found;
    }
    if (to < 0 || !can_go(v, to)) return false;
    go(v, to);
    return true;
  }

  bool can_go(int v, int to) {
    list_ring(to, m_other_ring);
    m_common.clear();
    std::set_intersection(m_ring.begin(), m_ring.end(), m_other_ring.begin(), m_other_ring.end(),
                          std::back_inserter(m_common));
    if (m_common.size() != 4) return false;  // two, each of them twice
    const double most = kOff * m_shortest(v);
    Planes planes = m_planes[static_cast<std::size_t>(v)];
    planes.add(m_planes[static_cast<std::size_t>(to)]);
    if (!(planes.find(m_x.col(to)) <= most * most)) return false;
    for (const int u : m_ring)
      if (u != to && (m_x.col(u) - m_x.col(to)).norm() > kLongest * m_shortest(v)) return false;
    for (const int t : faces(v)) {
      Triangle moved = triangle(t);
      if (std::find(moved.begin(), moved.end(), to) != moved.end()) continue;
      const Vec3 before = find_normal(moved);
      std::replace(moved.begin(), moved.end(), v, to);
      const Vec3 after = find_normal(moved);
      if (!(before.dot(after) > kTurn * before.norm() * after.norm())) return false;
      if (compute_shape(m_x.col(moved[0]), m_x.col(moved[1]), m_x.col(moved[2])) < kLeastShape) return false;
    }
    return true;
  }

  void go(int v, int to) {
    for (const int t : faces(v)) {
      Triangle& moved = m_triangles[static_cast<std::size_t>(t)];
      if (std::find(moved.begin(), moved.end(), to) != moved.end()) {
        for (const int u : moved)
          if (u != v) std::erase(faces(u), t);
        moved = {-1, -1, -1};
        continue;
      }
      std::replace(moved.begin(), moved.end(), v, to);
      faces(to).push_back(t);
    }
    faces(v).clear();
    m_planes[static_cast<std::size_t>(to)].add(m_planes[static_cast<std::size_t>(v)]);
  }

  const mesh::TriangleMesh& m_surface;
  Points m_x;  // from the middle, for the planes' sake
  const Field& m_shortest;
  std::vector<Triangle> m_triangles;      // −1: gone
  std::vector<std::vector<int>> m_faces;  // of each vertex
  std::vector<Planes> m_planes;           // of the faces that each vertex lay on, and those that came to it
  std::vector<int> m_ring, m_other_ring, m_common;
};

}  // namespace

mesh::TriangleMesh join_fine(const mesh::TriangleMesh& surface, const Field& shortest) {
  ARGIL_ASSERT(shortest.size() == surface.num_vertices());
  Joiner joiner(surface, shortest);
  joiner.run();
  return joiner.take();
}

}  // namespace argil::embed
