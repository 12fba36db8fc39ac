#include "embed/cage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/error.h"
#include "embed/tet_locator.h"
#include "embed/triangle_tree.h"
#include "mesh/implicit.h"
#include "mesh/topology.h"

namespace argil::embed {
namespace {

// All lengths in cube edges of the lattice.
constexpr double kBaseOffset = 0.1;   // covers what flat facets cut off a curved skin
constexpr double kOffsetStep = 0.15;  // added where a vertex is still outside
constexpr double kLargestOffset =
    1.2;                       // at 0.56 every skin point has an inside node, hence this is never needed
constexpr double kBand = 1.5;  // beyond this distance only the side matters
constexpr int kRounds = 40;
constexpr int kGuesses = 3;  // rounds that look for the lattice alone
constexpr double kTetsPerCube = 12.0;
constexpr double kCountTolerance = 0.15;

// The surface with a triangle of three equal corners for every vertex that no triangle uses.
mesh::TriangleMesh with_all_vertices(const mesh::TriangleMesh& surface) {
  std::vector<bool> is_used(static_cast<std::size_t>(surface.num_vertices()), false);
  for (Eigen::Index i = 0; i < surface.triangles.size(); ++i)
    is_used[static_cast<std::size_t>(surface.triangles.data()[i])] = true;
  mesh::TriangleMesh all = surface;
  const auto num_loose = std::count(is_used.begin(), is_used.end(), false);
  all.triangles.conservativeResize(3, surface.num_triangles() + num_loose);
  Eigen::Index next = surface.num_triangles();
  for (int v = 0; v < surface.num_vertices(); ++v)
    if (!is_used[static_cast<std::size_t>(v)]) all.triangles.col(next++).setConstant(v);
  return all;
}

void require_usable_input(const mesh::TriangleMesh& surface, const CageOptions& options,
                          const std::string& name) {
  if (surface.num_vertices() == 0 || surface.num_triangles() == 0)
    throw InputError(name, "", "the surface has no triangles", "give a triangle surface");
  for (int v = 0; v < surface.num_vertices(); ++v)
    if (!surface.vertices.col(v).allFinite())
      throw InputError(name, "vertex " + std::to_string(v) + " (counted from 0)",
                       "a coordinate is not a finite number", "repair the surface file");
  const Vec3 extent = surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff();
  if (!(extent.maxCoeff() > 0.0))
    throw InputError(name, "", "all vertices lie in one point", "give a surface with an extent");
  constexpr int kFewest = 100;
  constexpr int kMost = 20'000'000;
  if (options.target_tets < kFewest || options.target_tets > kMost)
    throw InputError(name, "target_tets", std::to_string(options.target_tets) + " is outside [100, 20000000]",
                     "ask for a number of tets in this range");
}

// Zero at the boundary of the union of the thickened skin and of what it winds round. The second part alone
// closes holes; both are continuous where the union's boundary can lie.
mesh::ImplicitSurface make_thick_surface(const TriangleTree& tree, const Points& vertices, double reach,
                                         double cell_size) {
  mesh::ImplicitSurface thick;
  thick.lower = vertices.rowwise().minCoeff() - Vec3::Constant(reach);
  thick.upper = vertices.rowwise().maxCoeff() + Vec3::Constant(reach);
  thick.value = [&tree, cell_size](const Vec3& x) {
    const double distance = tree.compute_distance(x, kBand * cell_size);
    if (distance < 0.0) return distance;
    const double winding =
        std::abs(tree.compute_winding_number(x));  // a surface turned inside out counts as well
    return std::min(distance, (0.5 - winding) * cell_size);
  };
  return thick;
}

// Numbers the parts of a tet mesh that hang together by faces.
std::vector<int> label_parts(const mesh::TetMesh& mesh) {
  const mesh::Topology topology = mesh::make_topology(mesh);
  std::vector<int> part(static_cast<std::size_t>(mesh.num_tets()), -1);
  std::vector<int> open;
  int num_parts = 0;
  for (int start = 0; start < mesh.num_tets(); ++start) {
    if (part[static_cast<std::size_t>(start)] >= 0) continue;
    part[static_cast<std::size_t>(start)] = num_parts;
    open.push_back(start);
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (int i = 0; i < 4; ++i) {
        const int n = topology.neighbours(i, t);
        if (n < 0 || part[static_cast<std::size_t>(n)] >= 0) continue;
        part[static_cast<std::size_t>(n)] = num_parts;
        open.push_back(n);
      }
    }
    ++num_parts;
  }
  return part;
}

// Skin vertices where the cage must grow: those outside, and the corners of triangles that reach from one
// part of the cage to another.
std::vector<int> find_bad_vertices(const mesh::TriangleMesh& skin, const mesh::TetMesh& cage) {
  if (cage.num_tets() == 0) {
    std::vector<int> all(static_cast<std::size_t>(skin.num_vertices()));
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  const TetLocator locator(cage);
  const std::vector<int> part = label_parts(cage);
  std::vector<int> where(static_cast<std::size_t>(skin.num_vertices()), -1);
  std::vector<int> bad;
  for (int v = 0; v < skin.num_vertices(); ++v) {
    const int tet = locator.find(skin.vertices.col(v)).tet;
    if (tet < 0)
      bad.push_back(v);
    else
      where[static_cast<std::size_t>(v)] = part[static_cast<std::size_t>(tet)];
  }
  for (int t = 0; t < skin.num_triangles(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = skin.triangles(i, t);
      const int b = skin.triangles((i + 1) % 3, t);
      const int part_a = where[static_cast<std::size_t>(a)];
      const int part_b = where[static_cast<std::size_t>(b)];
      if (part_a < 0 || part_b < 0 || part_a == part_b) continue;
      bad.push_back(a);
      bad.push_back(b);
    }
  std::sort(bad.begin(), bad.end());
  bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
  return bad;
}

[[noreturn]] void give_up(const std::string& name, const CageOptions& options, std::size_t num_bad,
                          int num_tets) {
  std::ostringstream problem;
  if (num_bad > 0)
    problem << num_bad << " skin vertices stay outside or apart in a cage of about " << options.target_tets
            << " tets";
  else
    problem << "no cage within 15 % of " << options.target_tets << " tets found; the last had " << num_tets;
  throw InputError(name, "target_tets", problem.str(), "ask for more tets");
}

// Smallest and largest angle between two faces of a tet [degrees].
std::pair<double, double> compute_dihedral_range(const mesh::TetMesh& mesh) {
  double largest_cosine = -1.0;
  double smallest_cosine = 1.0;
  for (int t = 0; t < mesh.num_tets(); ++t) {
    const Vec3 a = mesh.vertices.col(mesh.tets(0, t));
    const Vec3 u = mesh.vertices.col(mesh.tets(1, t)) - a;
    const Vec3 v = mesh.vertices.col(mesh.tets(2, t)) - a;
    const Vec3 w = mesh.vertices.col(mesh.tets(3, t)) - a;
    const std::array<Vec3, 4> normal = {(v - u).cross(w - u).normalized(), w.cross(v).normalized(),
                                        u.cross(w).normalized(), v.cross(u).normalized()};  // outward
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double cosine = std::clamp(-normal[i].dot(normal[j]), -1.0, 1.0);
        largest_cosine = std::max(largest_cosine, cosine);
        smallest_cosine = std::min(smallest_cosine, cosine);
      }
  }
  const double degrees = 180.0 / std::numbers::pi;
  return {std::acos(largest_cosine) * degrees, std::acos(smallest_cosine) * degrees};
}

Cage finish(mesh::TetMesh mesh, double cell_size, const Field& offset, int num_vertices) {
  const auto [min_dihedral, max_dihedral] = compute_dihedral_range(mesh);
  Cage cage;
  cage.report.num_tets = mesh.num_tets();
  cage.report.cell_size = cell_size;
  cage.report.offset = kBaseOffset * cell_size;
  cage.report.max_offset = offset.maxCoeff() * cell_size;
  cage.report.min_dihedral_degrees = min_dihedral;
  cage.report.max_dihedral_degrees = max_dihedral;
  cage.report.enclosed_vertices = num_vertices;
  cage.mesh = std::move(mesh);
  return cage;
}

}  // namespace

Cage make_cage(const mesh::TriangleMesh& surface, const CageOptions& options, const std::string& name) {
  require_usable_input(surface, options, name);
  const mesh::TriangleMesh skin = with_all_vertices(surface);
  TriangleTree tree(skin);
  Field offset = Field::Constant(skin.num_vertices(), kBaseOffset);  // in cube edges
  const Vec3 extent = skin.vertices.rowwise().maxCoeff() - skin.vertices.rowwise().minCoeff();
  // First guess: a tenth of the box is full. A sheet has no volume, hence the longest edge has a say.
  double cell_size = std::cbrt(std::max(0.1 * extent.prod(), 1e-4 * std::pow(extent.maxCoeff(), 3)) *
                               kTetsPerCube / options.target_tets);
  std::vector<int> bad;
  int num_tets = 0;
  for (int round = 0; round < kRounds; ++round) {
    tree.set_radius(offset * cell_size);
    const mesh::ImplicitSurface thick =
        make_thick_surface(tree, skin.vertices, offset.maxCoeff() * cell_size, cell_size);
    mesh::TetMesh mesh = mesh::stuff_isosurface(thick, cell_size);
    num_tets = mesh.num_tets();
    const double ratio = static_cast<double>(std::max(num_tets, 1)) / options.target_tets;
    bad.clear();
    // The first guesses of the lattice may be far off and tell nothing about the offset.
    const bool is_telling = round < kGuesses ? std::abs(ratio - 1.0) < 0.5 : ratio < 3.0;
    if (is_telling) bad = find_bad_vertices(skin, mesh);
    const double count_error = std::abs(ratio - 1.0);
    const double wanted = round < kRounds / 2 ? 0.5 * kCountTolerance : kCountTolerance;
    if (is_telling && bad.empty() && count_error <= wanted)
      return finish(std::move(mesh), cell_size, offset, skin.num_vertices());
    for (const int v : bad) offset(v) += kOffsetStep;
    if (offset.maxCoeff() > kLargestOffset) break;
    if (count_error > (bad.empty() ? wanted : 0.8 * kCountTolerance))
      cell_size *= std::clamp(std::cbrt(ratio), 0.5, 2.0);
  }
  give_up(name, options, bad.size(), num_tets);
}

}  // namespace argil::embed
