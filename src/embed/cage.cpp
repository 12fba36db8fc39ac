#include "embed/cage.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/error.h"
#include "embed/tet_locator.h"
#include "embed/triangle_tree.h"
#include "mesh/quality.h"
#include "mesh/topology.h"
#include "shapes/implicit.h"

namespace argil::embed {
namespace {

// All lengths in cube edges of the lattice.
constexpr double kBaseOffset = 0.1;   // covers what flat facets cut off a curved skin
constexpr double kOffsetStep = 0.15;  // added where a vertex is still outside
constexpr double kLargestOffset =
    1.2;                       // at 0.56 every skin point has an inside node, hence this is never needed
constexpr double kBand = 1.5;  // beyond this distance only the side matters
constexpr int kRounds = 40;
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
  mesh::require_size(surface.vertices, name);
  constexpr int kFewest = 100;
  constexpr int kMost = 20'000'000;
  if (options.target_tets < kFewest || options.target_tets > kMost)
    throw InputError(name, "target_tets", std::to_string(options.target_tets) + " is outside [100, 20000000]",
                     "ask for a number of tets in this range");
}

// Zero at the boundary of the union of the thickened skin and of what it winds round. The second part alone
// closes holes; both are continuous where the union's boundary can lie.
shapes::ImplicitSurface make_thick_surface(const TriangleTree& tree, const Points& vertices, double reach,
                                           double cell_size) {
  shapes::ImplicitSurface thick;
  thick.lower = vertices.rowwise().minCoeff() - Vec3::Constant(reach);
  thick.upper = vertices.rowwise().maxCoeff() + Vec3::Constant(reach);
  const Vec3 lower = thick.lower;
  const Vec3 upper = thick.upper;
  thick.value = [&tree, cell_size, lower, upper](const Vec3& x) {
    const double distance = tree.compute_distance(x, kBand * cell_size);
    if (distance < 0.0) return distance;
    const double outside_box = (lower - x).cwiseMax(x - upper).maxCoeff();  // stacked sheets wind far round
    const double winding =
        std::abs(tree.compute_winding_number(x));  // a surface turned inside out counts as well
    return std::min(distance, std::max((0.5 - winding) * cell_size, outside_box));
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

Cage finish(mesh::TetMesh mesh, double cell_size, const Field& offset, int num_vertices) {
  const mesh::QualityReport quality = mesh::compute_quality(mesh);
  Cage cage;
  cage.report.num_tets = mesh.num_tets();
  cage.report.cell_size = cell_size;
  cage.report.offset = kBaseOffset * cell_size;
  cage.report.max_offset = offset.maxCoeff() * cell_size;
  cage.report.min_dihedral_degrees = quality.min_dihedral_degrees;
  cage.report.max_dihedral_degrees = quality.max_dihedral_degrees;
  cage.report.enclosed_vertices = num_vertices;
  cage.mesh = std::move(mesh);
  return cage;
}

// Lattice on which body and thickened skin together take about the wanted number of tets: the root h of
// N h³ = 12 (V + A h/2), with the volume V and the area A that the triangles enclose and have.
double guess_cell_size(const mesh::TriangleMesh& skin, int target_tets) {
  const Vec3 lower = skin.vertices.rowwise().minCoeff();
  const Vec3 extent = skin.vertices.rowwise().maxCoeff() - lower;
  double volume = 0.0;
  double area = 0.0;
  for (int t = 0; t < skin.num_triangles(); ++t) {
    const Vec3 a = skin.vertices.col(skin.triangles(0, t)) - lower;
    const Vec3 b = skin.vertices.col(skin.triangles(1, t)) - lower;
    const Vec3 c = skin.vertices.col(skin.triangles(2, t)) - lower;
    volume += a.dot(b.cross(c)) / 6.0;
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  volume = std::min(std::abs(volume), extent.prod());
  double high = extent.maxCoeff();
  double low = 0.0;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double h = 0.5 * (low + high);
    (target_tets * h * h * h > kTetsPerCube * (volume + 0.5 * area * h) ? high : low) = h;
  }
  return high;
}

void require_room(const shapes::ImplicitSurface& thick, double cell_size, const std::string& name) {
  constexpr double kMostCubes = 1e8;
  const double num_cubes = ((thick.upper - thick.lower).array() / cell_size + 4.0).prod();
  if (!(num_cubes <= kMostCubes))
    throw InputError(name, "target_tets",
                     "the surface is so thin in its box that the lattice needs more than 1e8 cubes",
                     "ask for fewer tets or cut the surface into parts");
}

}  // namespace

Cage make_cage(const mesh::TriangleMesh& surface, const CageOptions& options, const std::string& name) {
  require_usable_input(surface, options, name);
  const mesh::TriangleMesh skin = with_all_vertices(surface);
  TriangleTree tree(skin);
  Field offset = Field::Constant(skin.num_vertices(), kBaseOffset);  // in cube edges
  double cell_size = guess_cell_size(skin, options.target_tets);
  std::vector<int> bad;
  int num_tets = 0;
  for (int round = 0; round < kRounds; ++round) {
    tree.set_radius(offset * cell_size);
    const shapes::ImplicitSurface thick =
        make_thick_surface(tree, skin.vertices, offset.maxCoeff() * cell_size, cell_size);
    require_room(thick, cell_size, name);
    mesh::TetMesh mesh = shapes::stuff_isosurface(thick, cell_size);
    num_tets = mesh.num_tets();
    const double ratio = static_cast<double>(std::max(num_tets, 1)) / options.target_tets;
    const double count_error = std::abs(ratio - 1.0);
    bad = find_bad_vertices(skin, mesh);
    const double wanted = round < kRounds / 2 ? 0.5 * kCountTolerance : kCountTolerance;
    if (bad.empty() && count_error <= wanted)
      return finish(std::move(mesh), cell_size, offset, skin.num_vertices());
    for (const int v : bad) offset(v) += kOffsetStep;
    if (offset.maxCoeff() > kLargestOffset) break;
    if (count_error > (bad.empty() ? wanted : 0.8 * kCountTolerance))
      cell_size *= std::clamp(std::cbrt(ratio), 0.8, 1.5);
  }
  give_up(name, options, bad.size(), num_tets);
}

}  // namespace argil::embed
