#include "mesh/quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <sstream>

#include "base/error.h"
#include "base/ordered_sum.h"
#include "mesh/topology.h"

namespace argil::mesh {
namespace {

constexpr int kListed = 10;  // how many numbers a message lists
// The products behind a volume or an area each round a few times; corners are exact to half a unit of their
// own size.
constexpr double kRoundOff = 8.0 * std::numeric_limits<double>::epsilon();

// Corners of the face opposite to corner i, counter-clockwise seen from outside a positive tet.
constexpr std::array<std::array<int, 3>, 4> kOppositeFace = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct Face {
  std::array<int, 3> key;  // sorted vertex numbers
  bool is_even;            // whether sorting took an even permutation: the side that the tet lies on
  int corner;              // 4·tet + opposite corner
};

std::vector<Face> make_sorted_faces(const Tets& tets) {
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(tets.size()));
  for (int corner = 0; corner < static_cast<int>(tets.size()); ++corner) {
    const auto tet = tets.col(corner / 4);
    const auto& local = kOppositeFace[static_cast<std::size_t>(corner % 4)];
    std::array<int, 3> key = {tet(local[0]), tet(local[1]), tet(local[2])};
    bool is_even = true;
    for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 1}})
      if (key[i] > key[j]) {
        std::swap(key[i], key[j]);
        is_even = !is_even;
      }
    faces.push_back({key, is_even, corner});
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.key != b.key ? a.key < b.key : a.corner < b.corner;
  });
  return faces;
}

void sort_unique(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

// Sets of tets joined face to face.
class Components {
 public:
  explicit Components(int count) : m_parent(static_cast<std::size_t>(count)), m_count(count) {
    std::iota(m_parent.begin(), m_parent.end(), 0);
  }
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    at(std::max(a, b)) = std::min(a, b);
    --m_count;
  }
  int count() const { return m_count; }

 private:
  int& at(int i) { return m_parent[static_cast<std::size_t>(i)]; }
  int root(int i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  std::vector<int> m_parent;
  int m_count;
};

// Each edge of the triangles as (lower vertex, higher vertex, whether it runs upwards), sorted. A triangle
// that names a vertex twice has none: its two edges would cancel each other.
std::vector<std::array<int, 3>> make_sorted_edges(const Triangles& triangles) {
  std::vector<std::array<int, 3>> edges;
  edges.reserve(static_cast<std::size_t>(triangles.size()));
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i v = triangles.col(t);
    if (v(0) == v(1) || v(1) == v(2) || v(2) == v(0)) continue;
    for (int i = 0; i < 3; ++i) {
      const int a = v(i);
      const int b = v((i + 1) % 3);
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : 0});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Calls use(begin, end) for every run of edges between the same two vertices.
template <class Use>
void for_each_edge(const std::vector<std::array<int, 3>>& edges, Use use) {
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin + 1;
    while (end < edges.size() && edges[end][0] == edges[begin][0] && edges[end][1] == edges[begin][1]) ++end;
    use(begin, end);
    begin = end;
  }
}

void measure_tet(const TetMesh& mesh, int t, double volume, QualityReport& report) {
  std::array<Vec3, 4> x;
  for (int c = 0; c < 4; ++c) x[static_cast<std::size_t>(c)] = mesh.vertices.col(mesh.tets(c, t));
  double longest = 0.0;
  double farthest = 0.0;
  for (std::size_t a = 0; a < 4; ++a) {
    farthest = std::max(farthest, x[a].norm());
    for (std::size_t b = a + 1; b < 4; ++b) longest = std::max(longest, (x[b] - x[a]).norm());
  }
  constexpr double kLeastVolume = 1e-45;  // [m³] of the millionth part of the smallest body, each way
  const double round_off = std::max(kLeastVolume, kRoundOff * (farthest + longest) * longest * longest);
  if (!(std::abs(volume) > round_off)) {
    report.flat.push_back(t);
  } else if (volume < 0.0) {
    report.inverted.push_back(t);
  }
  const DihedralAngles angles = compute_dihedral_angles(x);
  report.min_dihedral_degrees = std::min(report.min_dihedral_degrees, angles.smallest_degrees);
  report.max_dihedral_degrees = std::max(report.max_dihedral_degrees, angles.largest_degrees);
}

void find_orphans(const TetMesh& mesh, QualityReport& report) {
  std::vector<bool> is_used(static_cast<std::size_t>(mesh.num_vertices()), false);
  for (Eigen::Index i = 0; i < mesh.tets.size(); ++i)
    is_used[static_cast<std::size_t>(mesh.tets.data()[i])] = true;
  for (int v = 0; v < mesh.num_vertices(); ++v)
    if (!is_used[static_cast<std::size_t>(v)]) report.orphan_vertices.push_back(v);
}

// Faces that do not fit together, parts, and the boundary: every face that stands alone, in order of tets.
Triangles find_boundary(const TetMesh& mesh, QualityReport& report) {
  const std::vector<Face> faces = make_sorted_faces(mesh.tets);
  Components components(mesh.num_tets());
  std::vector<int> alone;
  for (std::size_t begin = 0; begin < faces.size();) {
    std::size_t end = begin + 1;
    while (end < faces.size() && faces[end].key == faces[begin].key) ++end;
    const bool is_overfull =
        end - begin > 2 || (end - begin == 2 && faces[begin].is_even == faces[begin + 1].is_even);
    for (std::size_t i = begin; i < end; ++i) {
      components.join(faces[begin].corner / 4, faces[i].corner / 4);
      if (is_overfull) report.overfull_faces.push_back(faces[i].corner / 4);
    }
    if (end - begin == 1) alone.push_back(faces[begin].corner);
    begin = end;
  }
  sort_unique(report.overfull_faces);
  report.num_components = components.count();
  std::sort(alone.begin(), alone.end());
  Triangles boundary(3, static_cast<Eigen::Index>(alone.size()));
  for (std::size_t i = 0; i < alone.size(); ++i)
    for (int c = 0; c < 3; ++c)
      boundary(c, static_cast<Eigen::Index>(i)) = mesh.tets(
          kOppositeFace[static_cast<std::size_t>(alone[i] % 4)][static_cast<std::size_t>(c)], alone[i] / 4);
  return boundary;
}

void refuse(const std::string& file, const std::vector<int>& found, int total, const std::string& things,
            const std::string& problem, const std::string& remedy) {
  if (found.empty()) return;
  std::string list;
  for (std::size_t i = 0; i < found.size() && i < kListed; ++i)
    list += (i == 0 ? "" : ", ") + std::to_string(found[i]);
  throw InputError(file, things,
                   std::to_string(found.size()) + " of " + std::to_string(total) + " " + problem + ": " +
                       list + (found.size() > kListed ? ", …" : "") + " (counted from 0)",
                   remedy);
}

}  // namespace

DihedralAngles compute_dihedral_angles(const std::array<Vec3, 4>& x) {
  std::array<Vec3, 4> normal;  // outward, or all inward
  for (std::size_t f = 0; f < 4; ++f) {
    const auto corner = [&](std::size_t i) { return x[static_cast<std::size_t>(kOppositeFace[f][i])]; };
    normal[f] = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  double smallest = 1.0, largest = -1.0;  // cosine
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b) {
      const double areas = std::sqrt(normal[a].squaredNorm() * normal[b].squaredNorm());
      if (!(areas > 0.0)) return {0.0, 180.0};
      const double cosine = -normal[a].dot(normal[b]) / areas;
      smallest = std::min(smallest, cosine);
      largest = std::max(largest, cosine);
    }
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  return {kDegrees * std::acos(std::min(largest, 1.0)), kDegrees * std::acos(std::max(smallest, -1.0))};
}

QualityReport compute_quality(const TetMesh& mesh) {
  QualityReport report;
  report.num_vertices = mesh.num_vertices();
  report.num_tets = mesh.num_tets();
  const Field volumes = compute_volumes(mesh.vertices, mesh.tets);
  report.volume = ordered_sum(volumes.size(), [&](Eigen::Index t) { return volumes(t); });
  report.min_dihedral_degrees = 180.0;
  for (int t = 0; t < mesh.num_tets(); ++t) measure_tet(mesh, t, volumes(t), report);
  find_orphans(mesh, report);
  const Triangles boundary = find_boundary(mesh, report);
  report.non_manifold_vertices = find_non_manifold_vertices(boundary, mesh.num_vertices());
  for_each_edge(make_sorted_edges(boundary), [&](std::size_t begin, std::size_t end) {
    if (end - begin != 2) ++report.num_non_manifold_edges;
  });
  return report;
}

void require_size(const Points& vertices, const std::string& file) {
  const double size = (vertices.rowwise().maxCoeff() - vertices.rowwise().minCoeff()).maxCoeff();
  const double farthest = vertices.cwiseAbs().maxCoeff();
  if (size >= kSmallestSize && farthest <= kLargestSize) return;
  std::ostringstream text;
  text << "is " << size << " m across and reaches " << farthest << " m off the origin; bodies and tools are ["
       << kSmallestSize << ", " << kLargestSize << "] m";
  throw InputError(file, "vertices", text.str(),
                   "give it in metres, by the scale of the scenario's /…/scale");
}

std::string require_usable(const QualityReport& report, const std::string& file) {
  const bool is_mirrored = static_cast<int>(report.inverted.size()) == report.num_tets;
  refuse(file, report.inverted, report.num_tets, "tets", "have negative volume",
         is_mirrored ? "the whole mesh is mirrored: swap two corners of every tet, or mirror one axis back"
                     : "mesh again; corner 3 must lie where the normal (x1−x0)×(x2−x0) points");
  refuse(file, report.flat, report.num_tets, "tets", "have no volume beyond round-off",
         "remove slivers or mesh again");
  refuse(file, report.orphan_vertices, report.num_vertices, "vertices", "belong to no tet", "remove them");
  refuse(file, report.overfull_faces, report.num_tets, "tets",
         "have a face that three or more tets share, or two from the same side",
         "remove the tets that overlap");
  if (report.non_manifold_vertices.empty() && report.num_non_manifold_edges == 0) return {};
  std::string line =
      file + ": the boundary is not manifold: " + std::to_string(report.non_manifold_vertices.size()) +
      " vertices and " + std::to_string(report.num_non_manifold_edges) + " edges where parts only touch";
  if (!report.non_manifold_vertices.empty())
    line += ", first vertex " + std::to_string(report.non_manifold_vertices.front()) + " (counted from 0)";
  return line;
}

double compute_shape(const std::array<Vec3, 4>& corners) {
  const Vec3 a = corners[1] - corners[0];
  const Vec3 b = corners[2] - corners[0];
  const Vec3 c = corners[3] - corners[0];
  const double edges = a.squaredNorm() + b.squaredNorm() + c.squaredNorm() + (b - a).squaredNorm() +
                       (c - a).squaredNorm() + (c - b).squaredNorm();
  const double thrice_volume = std::max(0.0, 0.5 * a.cross(b).dot(c));
  return 12.0 * std::cbrt(thrice_volume * thrice_volume) / edges;
}

}  // namespace argil::mesh
