#include "scenario/cell_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "contact/tool_solid.h"
#include "embed/triangle_tree.h"
#include "mesh/order.h"
#include "mesh/topology.h"
#include "scenario/covered_places.h"
#include "scenario/true_surface.h"
#include "sim/usual_error.h"

namespace argil::scenario {
namespace {

constexpr double kStep = 0.002;  // of a ball between two looks, over its radius
constexpr double kSteps = 10.0;  // that its deepest look is deep; else it is looked at in finer ones
constexpr double kFinestStep = 1e-7;
constexpr double kPlaceSpacing = 0.25;  // of touched places, over their radius
constexpr double kReach = 1.5;          // of the small cells, over the radius of a touched place
constexpr double kBestPower = 1.2;      // of the distance, for the least error of linear tets
constexpr double kGrowth = 2.4;         // of the size, per distance in contact radii, where it is linear
constexpr double kSteepest = 0.8;       // of the size per distance: steeper, halving makes no fewer tets
constexpr double kCellsPerRadius = 2.0;
constexpr double kPlainGrowth = 0.3;  // of the size per distance, where no radius of contact is known
constexpr double kMostTets = 5'000'000;

/// Adds a place to those of one ball, or makes the last one deeper.
void add_place(const sim::TouchedPlace& place, std::size_t first, std::vector<sim::TouchedPlace>& places) {
  if (places.size() > first) {
    sim::TouchedPlace& last = places.back();
    const double radius = std::max(last.radius, place.radius);
    if ((place.position - last.position).norm() <= kPlaceSpacing * radius) {
      if (place.radius > last.radius) last = place;
      return;
    }
  }
  places.push_back(place);
}

double find_largest_radius(const std::vector<sim::TouchedPlace>& places) {
  double radius = 0.0;
  for (const sim::TouchedPlace& place : places) radius = std::max(radius, place.radius);
  return radius;
}

/// A body's tets before they are halved.
struct Whole {
  const mesh::TetMesh& mesh;
  mesh::BoundaryPoint boundary_point;  ///< none: its boundary is flat
};

mesh::BisectedMesh bisect(const Whole& whole, const CellSizes& sizes, double most_tets) {
  return mesh::bisect(
      whole.mesh, [&sizes](const Vec3& x) { return sizes.find(x); },
      static_cast<int>(std::min(most_tets, kMostTets)), whole.boundary_point);
}

/// When a run of the scenario is at a sample of its motion.
bool is_run(const Scenario& s, const device::Trace& trace, std::size_t sample) {
  const double begin = trace.time.front() + s.trace.start;
  const double end = s.trace.duration > 0.0 ? begin + s.trace.duration : trace.time.back();
  return trace.time[sample] >= begin && trace.time[sample] <= end;
}

/// Adds the places that a motion takes a ball of a tool into, looked at in steps over its radius; how deep
/// the deepest look was [m]; negative: how near the ball came, as far as that was looked for.
double add_places_of_ball(const Scenario& s, const device::Trace& trace, const contact::InnerBall& ball,
                          const embed::TriangleTree& surface, double step,
                          std::vector<sim::TouchedPlace>& places) {
  const std::size_t first = places.size();
  const double beyond = (1.0 + kSteps * step) * ball.radius;
  double deepest = -std::numeric_limits<double>::infinity();
  Vec3 last = Vec3::Constant(std::numeric_limits<double>::infinity());  // looked at
  for (std::size_t i = 0; i < trace.samples.size(); ++i) {
    if (!is_run(s, trace, i)) continue;
    const device::DeviceSample& sample = trace.samples[i];
    const Vec3 centre = sample.position + sample.orientation * ball.centre;
    if ((centre - last).norm() < step * ball.radius) continue;
    last = centre;
    const bool is_inside = surface.compute_winding_number(centre) > 0.5;
    const double reach = is_inside ? std::numeric_limits<double>::infinity() : beyond;
    const embed::TriangleTree::Nearest nearest = surface.find_nearest(centre, reach);
    if (!is_inside && !(nearest.distance < reach)) continue;
    const double depth = ball.radius + (is_inside ? nearest.distance : -nearest.distance);
    deepest = std::max(deepest, depth);
    if (depth > 0.0)
      add_place({nearest.point, std::sqrt(ball.radius * std::min(depth, ball.radius))}, first, places);
  }
  return deepest;
}

/// Places of a body at rest that a motion takes balls in the tool into, each at the deepest and a quarter of
/// its radius from the next; in order of time for each of the balls.
std::vector<sim::TouchedPlace> find_places_of_balls(const Scenario& s, const device::Trace& trace,
                                                    const contact::ToolSolid& tool,
                                                    const mesh::TriangleMesh& touched) {
  const embed::TriangleTree surface(touched);
  std::vector<sim::TouchedPlace> places;
  for (const contact::InnerBall& ball : tool.inner_balls()) {
    const std::size_t first = places.size();
    for (double step = kStep; step > kFinestStep; step *= 0.1) {
      places.resize(first);
      const double deepest = add_places_of_ball(s, trace, ball, surface, step, places);
      if (std::abs(deepest) >= kSteps * step * ball.radius) break;
    }
  }
  return places;
}

}  // namespace

double CellSizes::find(const Vec3& x) const {
  double distance = std::numeric_limits<double>::infinity();
  double radii = std::numeric_limits<double>::infinity();  // of contact
  for (const sim::TouchedPlace& place : places) {
    const double d = std::max(0.0, (x - place.position).norm() - share * kReach * place.radius);
    distance = std::min(distance, d);
    radii = std::min(radii, d / (share * place.radius));
  }
  const bool is_linear = growth > 0.0;
  double size = near + (is_linear ? growth : kSteepest) * distance;
  if (!is_linear) size = std::min(size, near * std::pow(1.0 + radii, kBestPower));
  const double beside = is_linear ? growth : kPlainGrowth;
  for (const CellRegion& region : regions)
    size = std::min(size, region.size + beside * std::max(0.0, (x - region.centre).norm() - region.radius));
  return size;
}

namespace {

/// Halvings until some number of tets is met: of a size that makes more than are wanted and one that makes
/// less.
struct Search {
  static constexpr int kTries = 16;
  static constexpr double kCloseEnough = 0.02;
  double target = 0.0;
  double error = std::numeric_limits<double>::infinity();
  CellSizes sizes;
  mesh::BisectedMesh best;

  /// Whether it is too many.
  bool look_at(const Whole& whole, const CellSizes& with) {
    mesh::BisectedMesh found = bisect(whole, with, 2.0 * target);
    const double more = found.mesh.num_tets() / target - 1.0;
    if (std::abs(more) < error) {
      error = std::abs(more);
      sizes = with;
      best = std::move(found);
    }
    return more > 0.0;
  }
};

bool flows(const material::Plasticity& law) {
  return law.enabled && (law.form == material::FlowForm::j2 || law.creep_per_s > 0.0);
}

/// `target_tets` 0: no number is wanted. `is_elastic`: the best sizes are known. Completes the sizes.
mesh::BisectedMesh halve(const Whole& whole, CellSizes& sizes, int target_tets, bool is_elastic) {
  if (sizes.places.empty()) {
    if (!(sizes.growth > 0.0)) sizes.growth = kPlainGrowth;
    return bisect(whole, sizes, kMostTets);
  }
  const double radius = find_largest_radius(sizes.places);
  const auto with_near = [&](double near) {
    CellSizes with = sizes;
    with.near = near;
    if (!(with.growth > 0.0) && (!is_elastic || target_tets == 0))
      with.growth = std::min(kSteepest, kGrowth * near / radius);
    return with;
  };
  if (target_tets == 0) {
    sizes = with_near(sizes.near > 0.0 ? sizes.near : radius / kCellsPerRadius);
    return bisect(whole, sizes, kMostTets);
  }
  Search search;
  search.target = target_tets;
  double low = 1e-3 * radius;
  double high = 1e3 * radius;
  for (int i = 0; i < Search::kTries && search.error > Search::kCloseEnough; ++i) {
    const double near = std::sqrt(low * high);
    (search.look_at(whole, with_near(near)) ? low : high) = near;
  }
  // Of a regular mesh many tets are halved at one size, all those around a place: then less of it.
  double small = 0.0;
  double large = 1.0;
  for (int i = 0; i < Search::kTries && search.error > Search::kCloseEnough; ++i) {
    CellSizes with = with_near(low);
    with.share = 0.5 * (small + large);
    (search.look_at(whole, with) ? large : small) = with.share;
  }
  sizes = search.sizes;
  return std::move(search.best);
}

std::string describe(const CellSizes& sizes, int before, int after) {
  std::ostringstream text;
  text << "cells: " << before << " tets become " << after;
  if (!sizes.places.empty())
    text << ", " << 1e3 * sizes.near << " mm where the tool comes, "
         << find_largest_radius(sizes.places) / sizes.near << " along the radius of contact";
  return text.str();
}

}  // namespace

int count_fewest_tets(const BodySpec& body) {
  const bool has_limbs = body.kind == BodyKind::surface || body.shape.kind == shapes::ShapeKind::dinosaur ||
                         body.shape.kind == shapes::ShapeKind::figure;
  return has_limbs ? 1500 : 300;
}

int count_first_tets(const BodySpec& body) {
  const int target = body.target_tets;
  if (body.cells.near_tool > 0.0) return target;
  return std::min(target, std::max(count_fewest_tets(body), target / 6));
}

mesh::TetMesh grade_cage(const embed::Cage& cage, embed::Fit fit, const mesh::TriangleMesh& surface,
                         const device::Trace& trace, double near) {
  constexpr double kFarthest = 10.0;
  const embed::TriangleTree skin(surface);
  CellSizes sizes{near, kPlainGrowth, {}, {}};
  for (const device::DeviceSample& sample : trace.samples) {
    const embed::TriangleTree::Nearest nearest = skin.find_nearest(sample.position, kFarthest * near);
    if (nearest.triangle >= 0) add_place({nearest.point, near}, 0, sizes.places);
  }
  if (sizes.places.empty())
    throw InputError(trace.file, "",
                     "never comes nearer to the surface than ten cells of " + std::to_string(near) + " m",
                     "give a motion in the surface's frame and unit, or larger cells");
  Whole whole{cage.mesh, {}};
  if (fit == embed::Fit::surface)
    whole.boundary_point = [&skin](const Vec3& a, const Vec3& b) { return find_on_skin(skin, a, b); };
  mesh::TetMesh mesh = bisect(whole, sizes, kMostTets).mesh;
  if (mesh.num_tets() > kMostTets)
    throw InputError("", "--near-size", "makes more than 5 million tets", "give larger cells");
  return mesh;
}

void Halvings::renumber(std::vector<int>& nodes) const {
  if (number.empty()) return;
  for (int& v : nodes) v = number[static_cast<std::size_t>(v)];
}

void Halvings::renumber_with_middles(std::vector<int>& nodes) const {
  if (nodes.empty() || number.empty()) return;
  std::vector<bool> is_listed(number.size(), false);
  for (const int v : nodes) is_listed[static_cast<std::size_t>(v)] = true;
  std::size_t middle = number.size() - ends.size();
  for (const auto& [a, b] : ends) {
    if (is_listed[static_cast<std::size_t>(a)] && is_listed[static_cast<std::size_t>(b)]) {
      is_listed[middle] = true;
      nodes.push_back(static_cast<int>(middle));
    }
    ++middle;
  }
  renumber(nodes);
}

namespace {

/// The surface that is touched, as it is before any step.
mesh::TriangleMesh make_touched_surface(const Scenario& s, const sim::Body& body) {
  if (body.skin.num_triangles() > 0 && s.params.contact_surface != sim::SurfaceKind::cage) return body.skin;
  return {body.mesh.vertices, mesh::make_topology(body.mesh).boundary};
}

/// Of the body at rest, that the motion takes the tool into. Round tools are known by balls along their axis;
/// those in a tool of triangles reach into none of its edges.
std::vector<sim::TouchedPlace> find_places(const Scenario& s, const device::Trace& trace,
                                           const mesh::TriangleMesh& tool_surface, const sim::Body& body) {
  if (trace.samples.empty()) return {};
  contact::ToolSolid tool = contact::make_tool_solid(s.params.contact.round_tool, tool_surface);
  const mesh::TriangleMesh surface = make_touched_surface(s, body);
  if (s.params.contact.round_tool) return find_places_of_balls(s, trace, tool, surface);
  std::vector<contact::Pose> poses;
  for (std::size_t i = 0; i < trace.samples.size(); ++i)
    if (is_run(s, trace, i)) poses.push_back({trace.samples[i].position, trace.samples[i].orientation});
  std::vector<sim::TouchedPlace> places = find_covered_places(poses, std::move(tool), surface);
  if (!places.empty()) return places;
  // All of it is in the body.
  return find_places_of_balls(s, trace, contact::ToolSolid(tool_surface), surface);
}

/// Mean size of the tets around the vertex that is nearest to x.
double find_cell_size(const mesh::TetMesh& mesh, const Vec3& x) {
  Eigen::Index nearest = 0;
  (mesh.vertices.colwise() - x).colwise().squaredNorm().minCoeff(&nearest);
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index t = 0; t < mesh.tets.cols(); ++t)
    if ((mesh.tets.col(t).array() == static_cast<int>(nearest)).any()) {
      sum += mesh::compute_cell_size(mesh::compute_volumes(mesh.vertices, mesh.tets.col(t))(0));
      ++count;
    }
  return sum / count;
}

std::string propose_smaller_cells(const Scenario& s, double radius) {
  if (s.body.cells.kind == CellKind::even) return "set /body/cells/kind to graded";
  std::ostringstream text;
  text.precision(2);
  text << "set /body/cells/near_tool_m to " << radius / 4.0 << ", or a larger target_tets";
  return text.str();
}

}  // namespace

double find_contact_radius(const Scenario& s, const device::Trace& trace,
                           const mesh::TriangleMesh& tool_surface, const sim::Body& body) {
  return find_largest_radius(find_places(s, trace, tool_surface, body));
}

std::string describe_contact_cells(const Scenario& s, const device::Trace& trace,
                                   const mesh::TriangleMesh& tool_surface, const sim::Body& body) {
  constexpr double kEnough = 2.0;
  const std::vector<sim::TouchedPlace> places =
      body.touched_places.empty() ? find_places(s, trace, tool_surface, body) : body.touched_places;
  const double largest = find_largest_radius(places);
  double fewest = std::numeric_limits<double>::infinity();
  double radius = 0.0;
  for (const sim::TouchedPlace& place : places) {
    if (place.radius < 0.5 * largest) continue;
    const double cells = place.radius / find_cell_size(body.mesh, place.position);
    if (!(cells < fewest)) continue;
    fewest = cells;
    radius = place.radius;
  }
  if (!(radius > 0.0)) return "";
  const double error = sim::find_usual_error(s.params.solid.element, fewest);
  std::ostringstream text;
  text.precision(2);
  text << "cells: " << fewest << " along the radius of contact, " << 1e3 * radius
       << " mm: an elastic force comes out some ";
  if (error < 1.0)
    text << 100.0 * error << " % too large";
  else
    text << 1.0 + error << " times as large as it is";
  if (fewest < kEnough) text << "; " << propose_smaller_cells(s, radius);
  return text.str();
}

std::optional<Halvings> grade_cells(const Scenario& s, const device::Trace& trace,
                                    const mesh::TriangleMesh& tool_surface,
                                    const std::vector<sim::TouchedPlace>* touched_places, sim::Body& body,
                                    std::vector<std::string>& notes, bool bends_edges) {
  CellSizes sizes{s.body.cells.near_tool, s.body.cells.growth, {}, s.body.cells.regions};
  sizes.places = touched_places ? *touched_places : find_places(s, trace, tool_surface, body);
  if (sizes.places.empty() && sizes.regions.empty()) {
    notes.emplace_back("cells: even, as the motion does not reach the body at rest");
    return std::nullopt;
  }
  const bool has_target = s.body.kind != BodyKind::mesh && s.body.cage_file.empty() && !(sizes.near > 0.0);
  if (has_target && !sizes.places.empty() && body.mesh.num_tets() >= s.body.target_tets) {
    notes.push_back("cells: even, as " + std::to_string(s.body.target_tets) + " tets leave none to halve");
    return std::nullopt;
  }
  Whole whole{body.mesh, {}};
  const TrueSurface surface(s.body, body.skin);
  whole.boundary_point = bends_edges ? surface.make_edge_point() : surface.make_vertex_point();
  mesh::BisectedMesh bisected =
      halve(whole, sizes, has_target ? s.body.target_tets : 0, !flows(s.params.plasticity));
  if (bisected.mesh.num_tets() > kMostTets)
    throw InputError(s.file, "/body/cells", "asks for cells that make more than 5 million tets",
                     "give a larger near_tool_m or size_m, or a larger growth");
  notes.push_back(describe(sizes, body.mesh.num_tets(), bisected.mesh.num_tets()));
  body.mesh = std::move(bisected.mesh);
  body.touched_places = std::move(sizes.places);
  return Halvings{std::move(bisected.halved_edge), mesh::sort_vertices(body.mesh)};
}

}  // namespace argil::scenario
