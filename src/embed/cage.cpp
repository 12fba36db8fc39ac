#include "embed/cage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/error.h"
#include "embed/bent_edges.h"
#include "embed/embedding.h"
#include "embed/lay_on_surface.h"
#include "embed/mesh_parts.h"
#include "embed/skin_shape.h"
#include "embed/tet_locator.h"
#include "embed/triangle_tree.h"
#include "mesh/curved.h"
#include "mesh/quality.h"
#include "mesh/topology.h"
#include "shapes/implicit.h"

namespace argil::embed {
namespace {

// All lengths in cube edges of the lattice.
constexpr double kBaseOffset = 0.1;   // covers what flat facets cut off a curved skin
constexpr double kMostOutside = 0.8;  // of a vertex of a surface that the body is fitted to
constexpr double kFirstOffset = 0.3;  // of what is thinner than a cell, then
constexpr double kOffsetStep = 0.15;  // added where a vertex is still outside
constexpr double kLargestOffset =
    1.2;                       // at 0.56 every skin point has an inside node, hence this is never needed
constexpr double kBand = 1.5;  // beyond this distance only the side matters
constexpr int kRounds = 40;
constexpr double kTetsPerCube = 12.0;
constexpr double kCountTolerance = 0.15;
constexpr double kLargestCountError = 0.5;  // where the number of tets leaps with the lattice's size
constexpr double kMostAbove = 0.3;          // of tets, before parts are looked for that are lost
constexpr double kMostThin = 0.05;          // of a body's volume, that is left out

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

double find_distance_to_box(const Vec3& x, const Vec3& lower, const Vec3& upper) {
  return (lower - x).cwiseMax(x - upper).maxCoeff();  // stacked sheets wind far round
}

// Zero at the boundary of the union of the thickened skin and of what it winds round. The second part alone
// closes holes; both are continuous where the union's boundary can lie.
double compute_enclosing(const TriangleTree& tree, const Vec3& x, double cell_size, const Vec3& lower,
                         const Vec3& upper) {
  const double distance = tree.compute_distance(x, kBand * cell_size);
  if (distance < 0.0) return distance;
  const double winding =
      std::abs(tree.compute_winding_number(x));  // a surface turned inside out counts as well
  return std::min(distance, std::max((0.5 - winding) * cell_size, find_distance_to_box(x, lower, upper)));
}

// Distance from the skin, thickened where it is thin; negative in what it winds round.
double compute_fitted(const TriangleTree& tree, const Vec3& x, double cell_size, const Vec3& lower,
                      const Vec3& upper) {
  const double distance = tree.compute_distance(x, kBand * cell_size);
  if (distance < 0.0) return distance;
  const bool is_inside =
      !(find_distance_to_box(x, lower, upper) > 0.0) && std::abs(tree.compute_winding_number(x)) > 0.5;
  return is_inside ? -tree.find_nearest(x, kBand * cell_size).distance : distance;
}

// The body's boundary.
shapes::ImplicitSurface make_implicit(const TriangleTree& tree, const Points& vertices, Fit fit, double reach,
                                      double cell_size) {
  shapes::ImplicitSurface surface;
  surface.lower = vertices.rowwise().minCoeff() - Vec3::Constant(reach);
  surface.upper = vertices.rowwise().maxCoeff() + Vec3::Constant(reach);
  const Vec3 lower = surface.lower;
  const Vec3 upper = surface.upper;
  const auto compute = fit == Fit::surface ? compute_fitted : compute_enclosing;
  surface.value = [&tree, compute, cell_size, lower, upper](const Vec3& x) {
    return compute(tree, x, cell_size, lower, upper);
  };
  return surface;
}

// Skin vertices where the body must grow: those outside, or of a fitted body farther than `most_outside` [m],
// and the corners of triangles that reach from one part of the body to another.
std::vector<int> find_bad_vertices(const mesh::TriangleMesh& skin, const mesh::TetMesh& cage,
                                   double most_outside) {
  if (cage.num_tets() == 0) {
    std::vector<int> all(static_cast<std::size_t>(skin.num_vertices()));
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  const TetLocator locator(cage);
  const BoundaryTets boundary(cage);
  const std::vector<int> part = label_parts(cage);
  std::vector<int> where(static_cast<std::size_t>(skin.num_vertices()), -1);
  std::vector<int> bad;
  for (int v = 0; v < skin.num_vertices(); ++v) {
    const Vec3 x = skin.vertices.col(v);
    int tet = locator.find(x).tet;
    if (tet < 0 && most_outside > 0.0) tet = boundary.find(x, kMostBeyondFitted, most_outside).tet;
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

std::vector<double> list_distances(const Points& points, const TriangleTree& from) {
  std::vector<double> distances;
  for (const auto& x : points.colwise())
    distances.push_back(from.find_nearest(x, std::numeric_limits<double>::infinity()).distance);
  std::sort(distances.begin(), distances.end());
  return distances;
}

/// Their corners, the middles of their edges and their centres.
Points sample_triangles(const Points& vertices, const Triangles& triangles) {
  std::vector<int> corners(triangles.reshaped().begin(), triangles.reshaped().end());
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  const auto num_corners = static_cast<Eigen::Index>(corners.size());
  Points samples(3, num_corners + 4 * triangles.cols());
  samples.leftCols(num_corners) = vertices(Eigen::all, corners);
  Eigen::Index next = num_corners;
  for (const auto& t : triangles.colwise()) {
    const Vec3 a = vertices.col(t(0));
    const Vec3 b = vertices.col(t(1));
    const Vec3 c = vertices.col(t(2));
    for (const Vec3& x :
         {Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a)), Vec3((a + b + c) / 3.0)})
      samples.col(next++) = x;
  }
  return samples;
}

/// How far body and surface are apart, either way.
void measure_distances(const mesh::TetMesh& mesh, const mesh::TriangleMesh& surface, const TriangleTree& tree,
                       CageReport& report) {
  const Triangles boundary = mesh::make_topology(mesh).boundary;
  const std::vector<double> distances = list_distances(sample_triangles(mesh.vertices, boundary), tree);
  report.median_distance = distances[distances.size() / 2];
  report.max_distance = distances.back();
  const mesh::TriangleMesh fine = split_long_edges(surface, 0.5 * report.cell_size);
  report.max_skin_distance =
      list_distances(sample_triangles(fine.vertices, fine.triangles), TriangleTree({mesh.vertices, boundary}))
          .back();
}

Cage finish(mesh::TetMesh mesh, double cell_size, const mesh::TriangleMesh& surface) {
  const mesh::QualityReport quality = mesh::compute_quality(mesh);
  Cage cage;
  CageReport& report = cage.report;
  report.num_tets = mesh.num_tets();
  report.cell_size = cell_size;
  report.min_dihedral_degrees = quality.min_dihedral_degrees;
  report.max_dihedral_degrees = quality.max_dihedral_degrees;
  if (is_closed(surface))
    report.volume_ratio = mesh::compute_rest_volumes(mesh).sum() / compute_skin_volume(surface);
  report.num_vertices = surface.num_vertices();
  const TetLocator locator(mesh);
  for (const auto& x : surface.vertices.colwise())
    report.enclosed_vertices += locator.find(x).tet >= 0 ? 1 : 0;
  mesh.edge_nodes.clear();
  cage.mesh = std::move(mesh);
  return cage;
}

// Lattice on which body and thickened skin together take about the wanted number of tets: the root h of
// N h³ = 12 (V + c A h), with the volume V and the area A that the triangles enclose and have. `covered`, c:
// of a cell's size, what lies over the skin.
double guess_cell_size(const mesh::TriangleMesh& skin, int target_tets, double covered) {
  const Vec3 lower = skin.vertices.rowwise().minCoeff();
  const Vec3 extent = skin.vertices.rowwise().maxCoeff() - lower;
  double area = 0.0;
  for (const auto& t : skin.triangles.colwise()) {
    const Vec3 a = skin.vertices.col(t(0)) - lower;
    const Vec3 b = skin.vertices.col(t(1)) - lower;
    const Vec3 c = skin.vertices.col(t(2)) - lower;
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  const double volume = std::min(compute_skin_volume(skin), extent.prod());
  double high = extent.maxCoeff();
  double low = 0.0;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double h = 0.5 * (low + high);
    (target_tets * h * h * h > kTetsPerCube * (volume + covered * area * h) ? high : low) = h;
  }
  return high;
}

void require_room(const shapes::ImplicitSurface& thick, double cell_size, double most_cubes,
                  const std::string& name) {
  const double num_cubes = ((thick.upper - thick.lower).array() / cell_size + 4.0).prod();
  if (num_cubes <= most_cubes) return;
  std::ostringstream problem;
  problem << "the surface is so thin in its box that the lattice needs more than " << most_cubes << " cubes";
  throw InputError(name, "target_tets", problem.str(), "ask for fewer tets or cut the surface into parts");
}

/// A lattice and how far the skin is thickened, by which a body gets the wanted number of tets and holds the
/// skin.
class CageSearch {
 public:
  CageSearch(const mesh::TriangleMesh& surface, const CageOptions& options, const std::string& name)
      : m_options(options),
        m_name(name),
        m_surface(with_all_vertices(surface)),
        m_cell_size(guess_cell_size(m_surface, options.target_tets, is_fitted() ? 0.0 : 0.5)),
        m_skin(is_fitted() ? split_long_edges(m_surface, m_cell_size) : m_surface),
        m_tree(m_skin),
        m_offset(Field::Constant(m_skin.num_vertices(), is_fitted() ? 0.0 : kBaseOffset)) {}

  Cage run() {
    std::vector<int> bad;
    int num_tets = 0;
    for (int round = 0; round < kRounds; ++round) {
      mesh::TetMesh mesh = stuff();
      num_tets = mesh.num_tets();
      const double ratio = static_cast<double>(std::max(num_tets, 1)) / m_options.target_tets;
      const double count_error = std::abs(ratio - 1.0);
      bad = find_bad(mesh);
      const double wanted = round < kRounds / 2 ? 0.5 * kCountTolerance : kCountTolerance;
      if (bad.empty() && count_error <= wanted) return finish_body(std::move(mesh));
      if (bad.empty() && count_error < m_least_error) {
        m_least_error = count_error;
        m_best_size = m_cell_size;
        m_best_offset = m_offset;
      }
      // Of a fitted body, what is too coarse loses parts, and what has lost parts has too few tets.
      const bool is_too_fine = is_fitted() && ratio > 1.0 + kMostAbove;
      if (!is_too_fine)
        for (const int v : bad) m_offset(v) += m_offset(v) > 0.0 ? kOffsetStep : kFirstOffset;
      if (m_offset.maxCoeff() > kLargestOffset) break;
      const bool is_growing = is_fitted() && !bad.empty() && !is_too_fine;
      if (!is_growing && count_error > (bad.empty() ? wanted : 0.8 * kCountTolerance))
        m_cell_size *= std::clamp(std::cbrt(ratio), 0.8, 1.5);
    }
    if (m_least_error > kLargestCountError) give_up(m_name, m_options, bad.size(), num_tets);
    m_cell_size = m_best_size;
    m_offset = m_best_offset;
    Cage nearest = finish_body(stuff());
    nearest.report.wanted_tets = m_options.target_tets;
    return nearest;
  }

 private:
  Cage finish_body(mesh::TetMesh mesh) {
    if (leaves_thin())
      require_most(mesh);
    else if (is_fitted())
      lay(mesh);
    Cage cage = finish(std::move(mesh), m_cell_size, m_surface);
    if (!leaves_thin()) measure_distances(cage.mesh, m_surface, m_tree, cage.report);
    return cage;
  }

  bool is_fitted() const { return m_options.fit == Fit::surface; }
  bool leaves_thin() const { return is_fitted() && m_options.leaves_thin; }

  /// Where the body must grow.
  std::vector<int> find_bad(const mesh::TetMesh& mesh) const {
    if (leaves_thin() && mesh.num_tets() > 0) return {};
    return find_bad_vertices(m_skin, mesh, is_fitted() ? kMostOutside * m_cell_size : 0.0);
  }

  mesh::TetMesh stuff() {
    m_tree.set_radius(m_offset * m_cell_size);
    const shapes::ImplicitSurface surface =
        make_implicit(m_tree, m_skin.vertices, m_options.fit, m_offset.maxCoeff() * m_cell_size, m_cell_size);
    require_room(surface, m_cell_size, m_options.most_cubes, m_name);
    mesh::TetMesh mesh = shapes::stuff_isosurface(surface, m_cell_size);
    return leaves_thin() ? take_largest_part(mesh) : mesh;
  }

  void require_most(const mesh::TetMesh& mesh) const {
    const double wanted = compute_skin_volume(m_surface);
    const double volume = mesh::compute_volumes(mesh.vertices, mesh.tets).sum();
    if (is_closed(m_surface) && !(std::abs(volume - wanted) < kMostThin * wanted))
      throw InputError(m_name, "target_tets", "much of the surface is thinner than a cell",
                       "ask for more tets");
  }

  /// Sharp edges that the lattice cut off and parts that were thickened come to lie on the surface, as far as
  /// tets bear it, and the body gets its volume.
  void lay(mesh::TetMesh& mesh) const {
    const mesh::Topology topology = mesh::make_topology(mesh);
    lay_on_surface(m_surface, topology, m_options.bends_edges, mesh);
    if (is_closed(m_surface)) {
      const double straight = mesh::compute_volumes(mesh.vertices, mesh.tets).sum();
      bend(topology, mesh);
      const double bent = mesh::compute_rest_volumes(mesh).sum();
      match_volume(compute_skin_volume(m_surface) + straight - bent, topology, mesh);
    }
    bend(topology, mesh);
  }

  /// Its edges as they are to be, for the volume alone.
  void bend(const mesh::Topology& topology, mesh::TetMesh& mesh) const {
    if (m_options.bends_edges)
      mesh::curve_boundary([this](const Vec3& a, const Vec3& b) { return find_bent_middle(m_tree, a, b); },
                           topology, mesh);
  }

  CageOptions m_options;
  std::string m_name;
  mesh::TriangleMesh m_surface;
  double m_cell_size;         // [m]
  mesh::TriangleMesh m_skin;  // the same surface; of a fitted body with triangles no larger than cells
  TriangleTree m_tree;
  Field m_offset;  // of each vertex of the skin, in cube edges
  // Of the body that holds the skin with the number nearest to the wanted one.
  double m_least_error = std::numeric_limits<double>::infinity();  // of that number, as a share
  double m_best_size = 0.0;                                        // [m]
  Field m_best_offset;
};

bool winds_round_something(const mesh::TriangleMesh& surface) {
  const Vec3 extent = surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff();
  return compute_skin_volume(surface) > 1e-6 * std::pow(extent.maxCoeff(), 3);
}

}  // namespace

std::string describe(const CageReport& r) {
  std::ostringstream text;
  text.precision(4);
  text << r.num_tets << " tets";
  if (r.wanted_tets > 0)
    text << " (for the " << r.wanted_tets << " wanted: on this surface the number goes in leaps)";
  text << ", cells of " << 1e3 * r.cell_size << " mm";
  if (r.volume_ratio > 0.0) text << ", volume " << r.volume_ratio << " of the surface's";
  text << "; boundary off the surface by " << 1e3 * r.median_distance << " mm in the median, "
       << 1e3 * r.max_distance << " mm at most, surface off the boundary by " << 1e3 * r.max_skin_distance
       << " mm at most; " << r.enclosed_vertices << " of its " << r.num_vertices
       << " vertices inside; dihedral angles " << r.min_dihedral_degrees << " to " << r.max_dihedral_degrees
       << " degrees";
  return text.str();
}

Cage make_cage(const mesh::TriangleMesh& surface, const CageOptions& options, const std::string& name) {
  require_usable_input(surface, options, name);
  CageOptions used = options;
  if (!winds_round_something(surface)) used.fit = Fit::enclose;
  return CageSearch(surface, used, name).run();
}

}  // namespace argil::embed
