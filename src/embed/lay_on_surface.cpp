#include "embed/lay_on_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "embed/triangle_tree.h"
#include "mesh/quality.h"

namespace argil::embed {
namespace {

constexpr int kSweeps = 6;
constexpr double kLeastShape = 0.25;
constexpr double kClose = 0.02;  // of an edge: nearer to the surface a vertex stays
constexpr int kHalvings = 3;     // of a way that tets do not bear

class Mover {
 public:
  Mover(const mesh::Topology& topology, mesh::TetMesh& body) : m_topology(topology), m_body(body) {}

  /// Towards `place`, as far as the tets around bear it. Of one that gets no better for its shape, so far as
  /// the worst tet does not get worse.
  void move(int v, const Vec3& place, bool for_shape) {
    const Vec3 before = m_body.vertices.col(v);
    const double worst = find_worst(v);
    const double least = for_shape ? worst : std::min(worst, kLeastShape);
    double share = 1.0;
    for (int i = 0; i <= kHalvings; ++i, share *= 0.5) {
      m_body.vertices.col(v) = before + share * (place - before);
      const double found = find_worst(v);
      if (for_shape ? found > least : found >= least) return;
    }
    m_body.vertices.col(v) = before;
  }

  /// Mean of the corners of the tets around, and of their edges at v.
  Vec3 find_middle(int v, double& edge) const {
    Vec3 sum = Vec3::Zero();
    double length = 0.0;
    int count = 0;
    each_tet(v, [&](const auto& corners) {
      for (const int other : corners) {
        if (other == v) continue;
        sum += m_body.vertices.col(other);
        length += (m_body.vertices.col(other) - m_body.vertices.col(v)).norm();
        ++count;
      }
    });
    edge = length / std::max(count, 1);
    return sum / std::max(count, 1);
  }

 private:
  template <class Use>
  void each_tet(int v, Use use) const {
    const auto first = static_cast<std::size_t>(v);
    for (int c = m_topology.vertex_begin[first]; c < m_topology.vertex_begin[first + 1]; ++c)
      use(m_body.tets.col(m_topology.vertex_corners[static_cast<std::size_t>(c)] / 4));
  }
  double find_worst(int v) const {
    double worst = 1.0;
    each_tet(v, [&](const auto& t) {
      const std::array<Vec3, 4> x = {m_body.vertices.col(t(0)), m_body.vertices.col(t(1)),
                                     m_body.vertices.col(t(2)), m_body.vertices.col(t(3))};
      worst = std::min(worst, mesh::compute_shape(x));
    });
    return worst;
  }

  const mesh::Topology& m_topology;
  mesh::TetMesh& m_body;
};

}  // namespace

void lay_on_surface(const mesh::TriangleMesh& surface, const mesh::Topology& topology, mesh::TetMesh& body) {
  const TriangleTree tree(surface);
  std::vector<char> is_outside(static_cast<std::size_t>(body.num_vertices()), 0);
  for (const int v : topology.boundary.reshaped()) is_outside[static_cast<std::size_t>(v)] = 1;
  Mover mover(topology, body);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int v = 0; v < body.num_vertices(); ++v) {
      const Vec3 x = body.vertices.col(v);
      double edge = 0.0;
      const Vec3 middle = mover.find_middle(v, edge);
      if (is_outside[static_cast<std::size_t>(v)] == 0) {
        mover.move(v, middle, true);
        continue;
      }
      const TriangleTree::Nearest nearest = tree.find_nearest(x, std::numeric_limits<double>::infinity());
      if (nearest.distance > kClose * edge) mover.move(v, nearest.point, false);
    }
}

}  // namespace argil::embed
