#include "embed/fine_skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/check.h"
#include "embed/tet_locator.h"

namespace argil::embed {
namespace {

constexpr double kOutside = 1e-6;     // weight of a vertex outside, beyond rounding
constexpr double kMostBeyond = 0.25;  // of a tet's height, by which a point may lie outside of it

/// Mean edge of every tet [m].
Field compute_cell_sizes(const mesh::TetMesh& cage) {
  Field size(cage.num_tets());
  for (int t = 0; t < cage.num_tets(); ++t) {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j)
        sum += (cage.vertices.col(cage.tets(i, t)) - cage.vertices.col(cage.tets(j, t))).norm();
    size(t) = sum / 6.0;
  }
  return size;
}

/// Halves edges and the triangles at them. What becomes of an edge hangs on its ends alone.
class Splitter {
 public:
  Splitter(const mesh::TriangleMesh& skin, const Embedding& embedding, const mesh::TetMesh& cage,
           double size_over_cell)
      : m_locator(cage),
        m_longest(size_over_cell * compute_cell_sizes(cage)),
        m_shortest(m_longest.minCoeff()),
        m_tet(embedding.tet) {
    for (int v = 0; v < skin.num_vertices(); ++v) {
      m_x.push_back(skin.vertices.col(v));
      m_weights.push_back(embedding.weights.col(v));
    }
    if (embedding.weights.minCoeff() < -kOutside) m_boundary.emplace(cage);
    m_halvings.resize(m_x.size(), 0);
    double longest = m_shortest;
    for (const auto& v : skin.triangles.colwise())
      for (int k = 0; k < 3; ++k) longest = std::max(longest, (x(v(k)) - x(v((k + 1) % 3))).norm());
    m_most_halvings = 1 + static_cast<int>(std::ceil(std::log2(longest / m_shortest)));
  }

  void split(const std::array<int, 3>& v) {
    // From the corner whose edges, to the next and from the one before, are alike in being halved or not.
    std::array<int, 3> middle{};
    for (std::size_t k = 0; k < 3; ++k) middle[k] = find_middle(v[k], v[(k + 1) % 3]);
    const auto halved = 3 - std::count(middle.begin(), middle.end(), kNone);
    if (halved == 0) {
      m_triangles.push_back(v);
      return;
    }
    std::size_t k = 0;  // the edge that is alone in being halved or in not being so
    while (halved < 3 && (middle[k] == kNone) != (halved == 2)) ++k;
    const int a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
    const int ab = middle[k], bc = middle[(k + 1) % 3], ca = middle[(k + 2) % 3];
    if (halved == 3) {
      for (const std::array<int, 3>& part :
           {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
        split(part);
    } else if (halved == 1) {
      split({a, ab, c});
      split({ab, b, c});
    } else {
      split({c, ca, bc});
      const bool from_a = is_shorter(a, bc, b, ca);
      split(from_a ? std::array{a, bc, ca} : std::array{a, b, ca});
      split(from_a ? std::array{a, b, bc} : std::array{b, bc, ca});
    }
  }

  FineSkin take() {
    FineSkin fine;
    fine.triangles.resize(3, static_cast<Eigen::Index>(m_triangles.size()));
    for (std::size_t t = 0; t < m_triangles.size(); ++t)
      fine.triangles.col(static_cast<Eigen::Index>(t)) = Eigen::Vector3i::Map(m_triangles[t].data());
    fine.embedding.tet = std::move(m_tet);
    fine.embedding.weights.resize(4, static_cast<Eigen::Index>(m_weights.size()));
    for (std::size_t v = 0; v < m_weights.size(); ++v)
      fine.embedding.weights.col(static_cast<Eigen::Index>(v)) = m_weights[v];
    return fine;
  }

 private:
  static constexpr int kNone = -1;

  const Vec3& x(int v) const { return m_x[static_cast<std::size_t>(v)]; }
  int tet(int v) const { return m_tet[static_cast<std::size_t>(v)]; }

  /// The vertex that halves an edge; kNone where it is not halved.
  int find_middle(int a, int b) {
    const double length = (x(a) - x(b)).norm();
    const int halvings =
        1 + std::max(m_halvings[static_cast<std::size_t>(a)], m_halvings[static_cast<std::size_t>(b)]);
    if (!(length > m_shortest) || halvings > m_most_halvings) return kNone;
    const auto [found, is_new] = m_middle.try_emplace(std::minmax(a, b), kNone);
    if (!is_new) return found->second;
    const Vec3 place = 0.5 * (x(a) + x(b));
    TetLocator::Place in = m_locator.find_near(place, kMostBeyond);
    if (in.tet < 0 && m_boundary)
      in = m_boundary->find(place, kMostBeyondFitted, std::numeric_limits<double>::infinity());
    if (in.tet < 0) return kNone;
    if (!(length > std::min({m_longest(tet(a)), m_longest(tet(b)), m_longest(in.tet)}))) return kNone;
    found->second = static_cast<int>(m_x.size());
    m_x.push_back(place);
    m_halvings.push_back(halvings);
    m_tet.push_back(in.tet);
    m_weights.push_back(in.weights);
    return found->second;
  }

  /// Is a–b shorter than c–d? Of two alike, that which has the lowest of the four ends, by its place.
  bool is_shorter(int a, int b, int c, int d) const {
    const double first = (x(a) - x(b)).squaredNorm();
    const double second = (x(c) - x(d)).squaredNorm();
    constexpr double kAlike = 1e-9;
    if (std::abs(first - second) > kAlike * (first + second)) return first < second;
    const auto is_lower = [this](int one, int other) {
      return std::lexicographical_compare(x(one).begin(), x(one).end(), x(other).begin(), x(other).end());
    };
    const int low = is_lower(a, b) ? a : b;
    return is_lower(low, c) && is_lower(low, d);
  }

  TetLocator m_locator;
  std::optional<BoundaryTets> m_boundary;  // where some of the skin's vertices are outside
  Field m_longest;                         // edge of a triangle, by the tet beneath [m]
  double m_shortest;
  std::vector<Vec3> m_x;
  // Of each vertex, how many times edges were halved to come to it. An edge that has to stay as it is would
  // else have the triangle beside it halved for ever, whose other edges are together longer than that one.
  std::vector<int> m_halvings;
  int m_most_halvings = 0;  // after so many the longest edge is shorter than any cell asks for
  std::vector<int> m_tet;
  std::vector<Vec4> m_weights;
  std::map<std::pair<int, int>, int> m_middle;  // of edges that were looked at
  std::vector<std::array<int, 3>> m_triangles;
};

}  // namespace

FineSkin split_to_cells(const mesh::TriangleMesh& skin, const Embedding& embedding, const mesh::TetMesh& cage,
                        double size_over_cell) {
  ARGIL_ASSERT(size_over_cell > 0.0, size_over_cell);
  ARGIL_ASSERT(embedding.num_points() == skin.num_vertices());
  Splitter splitter(skin, embedding, cage, size_over_cell);
  for (Eigen::Index t = 0; t < skin.triangles.cols(); ++t)
    splitter.split({skin.triangles(0, t), skin.triangles(1, t), skin.triangles(2, t)});
  return splitter.take();
}

}  // namespace argil::embed
