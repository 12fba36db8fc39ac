#include "scenario/renew_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "contact/nearest.h"
#include "embed/curved_split.h"
#include "embed/join_fine.h"
#include "embed/lay_on_surface.h"
#include "embed/skin_shape.h"
#include "embed/triangle_tree.h"
#include "mesh/order.h"
#include "mesh/quality.h"
#include "scenario/cell_sizes.h"
#include "sim/contact_surface.h"

namespace argil::scenario {
namespace {

constexpr int kFewestTets = 100;  // that a body may be made of

/// That begin at each vertex [m]; 0: none do.
Field find_longest_edges(const Triangles& triangles, const Points& x) {
  Field longest = Field::Zero(x.cols());
  for (const auto& v : triangles.colwise())
    for (Eigen::Index k = 0; k < 3; ++k)
      longest(v(k)) = std::max(longest(v(k)), (x.col(v(k)) - x.col(v((k + 1) % 3))).norm());
  return longest;
}

/// What the tool has pressed round, in facets as large as cells, lies on it.
void lay_on_tool(const PresentShape& now, const Scenario& s, mesh::TriangleMesh& surface) {
  constexpr double kNear = 0.3;    // of an edge, to both sides,
  constexpr double kRound = 1.5;   // and of its square over the tool's radius: twelve times what facets miss
  constexpr double kFlat = 0.01;   // of an edge, of a tool without a curve
  constexpr double kDepth = 1e-3;  // of an edge: contacts press with about the clay's strength then
  if (!now.touching) return;
  const Field edge = find_longest_edges(surface.triangles, surface.vertices);
  contact::ToolSolid tool = contact::make_tool_solid(s.params.contact.round_tool, now.tool);
  const contact::Pose& pose = *now.touching;
  int face = 0;
  for (int v = 0; v < surface.num_vertices(); ++v) {
    const Vec3 in_tool = pose.orientation.conjugate() * (surface.vertices.col(v) - pose.position);
    const contact::ToolDistance found = tool.find_distance(in_tool, face);
    if (std::abs(found.distance) < std::min(kNear, kFlat + kRound * edge(v) / tool.radius()) * edge(v))
      surface.vertices.col(v) -= (found.distance + kDepth * edge(v)) * (pose.orientation * found.outward);
  }
}

/// A body that is that surface, with about as many cells.
Scenario make_scenario_of_surface(const Scenario& s, const sim::Body& body) {
  Scenario of_surface = s;
  of_surface.body.kind = BodyKind::surface;
  of_surface.body.cage_file.clear();
  of_surface.body.fit = embed::Fit::surface;
  const bool has_target =
      s.body.kind != BodyKind::mesh && s.body.cage_file.empty() && !(s.body.cells.near_tool > 0.0);
  const int first_tets = body.first_tets > 0 ? body.first_tets : body.mesh.num_tets();
  if (!has_target) of_surface.body.target_tets = std::max(kFewestTets, first_tets);
  of_surface.body.cells.near_tool = 0.0;
  return of_surface;
}

std::vector<sim::TouchedPlace> move_places(const PresentShape& now, const Points& skin) {
  const sim::Body& body = now.body;
  const bool has_skin = body.skin.num_triangles() > 0;
  const Points& rest = has_skin ? body.skin.vertices : body.mesh.vertices;
  const Points& moved = has_skin ? skin : now.x;
  std::vector<sim::TouchedPlace> places = body.touched_places;
  for (sim::TouchedPlace& place : places) {
    const int nearest = contact::find_nearest_point(rest, place.position);
    place.position += moved.col(nearest) - rest.col(nearest);
  }
  return places;
}

embed::Embedding embed_in(const mesh::TetMesh& mesh, const Points& points, const std::string& file) {
  return embed::make_embedding(mesh, points, file, embed::kMostBeyondFitted);
}

/// What was torn off hangs on as a part of the skin.
void embed_surfaces(const Scenario& s, sim::Body& body) {
  body.touched_embedding = embed_in(body.mesh, body.touched.vertices, s.file);
  if (body.skin.num_triangles() > 0)
    body.skin_embedding = embed::make_embedding(body.mesh, body.skin.vertices, s.file, embed::kAnyBeyond);
}

}  // namespace

std::string find_remesh_obstacle(const Scenario& s) {
  const sim::Params& p = s.params;
  if (s.body.cells.remesh == RemeshWhen::never) return "/body/cells/remesh is \"never\"";
  if (p.solid.model != solid::StrainModel::hencky || !p.plasticity.enabled)
    return "only hencky clay that flows is";
  if (p.plasticity.form != material::FlowForm::j2) return "only von Mises's flow has a strength";
  if (p.solid.integrator != solid::Integrator::backward_euler)
    return "only backward_euler begins from one state";
  if (p.contact.law != contact::ContactLaw::pressure) return "pairs belong to their triangles";
  if (p.fidelity.mode == sim::FidelityMode::check) return "a full run goes beside";
  if (p.water.swelling > 0.0) return "clay that swells has another size at rest";
  if (!s.body.pore_axis_field.empty()) return "aligned pores are not turned";
  if (!s.body.loads.nodal.empty() || !s.body.loads.pressure.empty()) return "loads belong to vertices";
  for (const solid::Support& support : s.body.fixed)
    if (!support.displacement.isZero(0.0)) return "supports that move are not";
  return "";
}

sim::Body complete_cells(const Scenario& s, sim::Body body) {
  body.initial_saturation = Field::Zero(body.mesh.num_tets());
  for (std::size_t i = 0; i < body.supports.size(); ++i) {
    solid::Support support = s.body.fixed.at(i);
    support.region = std::move(body.supports[i].region);
    body.supports[i] = std::move(support);
  }
  embed_surfaces(s, body);
  return body;
}

namespace {

/// How far boundary and surface are from one another.
struct Off {
  double farthest = 0.0;  ///< vertex of the one from the other [m]
  double edges = 0.0;     ///< the same over the edges there, at most
  void add(double distance, double edge) {
    farthest = std::max(farthest, distance);
    edges = std::max(edges, distance / edge);
  }
};

Off find_off(const Points& x, const Triangles& faces, const mesh::TriangleMesh& touched) {
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  const embed::TriangleTree surface(touched), boundary({x, faces});
  const Field edge = find_longest_edges(faces, x);
  Off off;
  for (Eigen::Index v = 0; v < x.cols(); ++v)
    if (edge(v) > 0.0) off.add(surface.find_nearest(x.col(v), kAnywhere).distance, edge(v));
  const Field of_touched = find_longest_edges(touched.triangles, touched.vertices);
  for (int v = 0; v < touched.num_vertices(); ++v) {
    if (!(of_touched(v) > 0.0)) continue;  // inside the body
    const embed::TriangleTree::Nearest found = boundary.find_nearest(touched.vertices.col(v), kAnywhere);
    off.add(found.distance, edge(faces(0, found.triangle)));
  }
  return off;
}

/// Small edges that the tool does not touch are joined: `surface` is split again where it is coarser than
/// half a cell.
void join_far_from_tool(const PresentShape& now, const Scenario& s, const sim::Body& body,
                        mesh::TriangleMesh& surface) {
  constexpr double kShortest = 0.5 * sim::kTouchedOverCell;  // edge, over the mean one of the tet beneath
  constexpr double kNear = 2.0;                              // such edges, from the tool
  const double per_edge = s.params.solid.element == solid::ElementKind::p2 ? 2.0 : 1.0;
  const embed::Embedding embedding = embed_in(body.mesh, surface.vertices, s.file);
  std::optional<contact::ToolSolid> tool;
  if (now.touching) tool.emplace(contact::make_tool_solid(s.params.contact.round_tool, now.tool));
  Field shortest(surface.num_vertices());
  int face = 0;
  for (int v = 0; v < surface.num_vertices(); ++v) {
    const auto corners = body.mesh.tets.col(embedding.tet[static_cast<std::size_t>(v)]);
    double edges = 0.0;
    for (Eigen::Index i = 0; i < 4; ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        edges += (body.mesh.vertices.col(corners(i)) - body.mesh.vertices.col(corners(j))).norm();
    shortest(v) = kShortest * edges / (6.0 * per_edge);
    if (!tool) continue;
    const contact::Pose& pose = *now.touching;
    const Vec3 in_tool = pose.orientation.conjugate() * (surface.vertices.col(v) - pose.position);
    if (tool->find_distance(in_tool, face).distance < kNear * shortest(v)) shortest(v) = 0.0;
  }
  surface = embed::join_fine(surface, shortest);
}

}  // namespace

namespace {

/// Of so many tets to begin with. `is_torn`: they leave out what is thinner than a cell, where that is
/// little.
sim::Body make_cells(const Scenario& s, const Scenario& of_surface, const PresentShape& now, int first_tets,
                     bool is_torn) {
  sim::Body body;
  const bool is_boundary = now.body.skin.num_triangles() == 0 && now.body.touched.num_triangles() == 0;
  body.touched = embed::join_fine(now.touched, Field::Zero(now.touched.num_vertices()));  // none is loose
  if (is_boundary) {
    body.touched = embed::split_where_curved(body.touched);
    lay_on_tool(now, s, body.touched);
  }
  body.loads = now.body.loads;
  body.first_tets = now.body.first_tets > 0 ? now.body.first_tets : now.body.mesh.num_tets();
  Points skin;
  if (now.body.skin.num_triangles() > 0)
    embed::interpolate_positions(now.body.skin_embedding, now.nodes, now.x, skin);
  const std::vector<sim::TouchedPlace> places = move_places(now, skin);
  const bool is_graded = !places.empty() || !s.body.cells.regions.empty();
  constexpr double kMostCubes = 300.0;  // a tet: of clay that is drawn out across a wide box
  const embed::CageOptions options{first_tets, embed::Fit::surface, is_torn, kMostCubes * first_tets};
  body.mesh = embed::make_cage(body.touched, options, s.file).mesh;
  if (is_graded) {
    std::swap(body.skin, body.touched);   // that the cells follow
    constexpr double kLeastHalved = 1.5;  // tets, over those that the surface needs
    Scenario graded = of_surface;
    graded.body.target_tets =
        std::max(of_surface.body.target_tets, static_cast<int>(kLeastHalved * body.mesh.num_tets()));
    std::vector<std::string> notes;
    grade_cells(graded, {}, {}, &places, body, notes);
    std::swap(body.skin, body.touched);
    body.touched_places = places;
  }
  mesh::sort_tets(body.mesh);
  body.mesh.numbers.clear();
  body.topology = mesh::make_topology(body.mesh);
  // Once more: the vertices that grading has added let the boundary come nearer.
  if (!is_torn && is_graded) {
    embed::draw_to_surface(body.touched, body.topology, body.mesh);
    embed::lay_on_surface(body.touched, body.topology, false, body.mesh);
  }
  const bool has_own_boundary = skin.size() == 0 && s.params.solid.element != solid::ElementKind::p2;
  const double wanted = has_own_boundary ? embed::compute_skin_volume({now.x, now.body.topology.boundary})
                                         : embed::compute_skin_volume(body.touched);
  embed::match_volume(wanted, body.topology, body.mesh);
  mesh::require_usable(mesh::compute_quality(body.mesh), s.file);
  if (is_torn) {
    body.touched = embed::split_where_curved(embed::join_fine({body.mesh.vertices, body.topology.boundary},
                                                              Field::Zero(body.mesh.num_vertices())));
    lay_on_tool(now, s, body.touched);
  } else {
    join_far_from_tool(now, s, body, body.touched);
  }
  if (skin.size() > 0) body.skin = {skin, now.body.skin.triangles};
  embed_surfaces(s, body);
  return body;
}

}  // namespace

/// Of those that follow the surface, or do so as well as the present ones, the ones with the fewest tets;
/// else those that come nearest to it. A finer lattice leaves fewer tets for where the tool is.
NewCells make_new_cells(const Scenario& s, const PresentShape& now) {
  constexpr double kMostTets = 1.5;  // of those wanted, where thin parts need them
  constexpr double kFollows = 0.4;   // of an edge, off at most, or as now
  const Scenario of_surface = make_scenario_of_surface(s, now.body);
  const int wanted = of_surface.body.target_tets;
  const bool is_graded = !now.body.touched_places.empty() || !s.body.cells.regions.empty();
  int tets = is_graded ? count_first_tets(of_surface.body) : wanted;
  const double follows = std::max(kFollows, find_off(now.x, now.body.topology.boundary, now.touched).edges);
  std::optional<sim::Body> nearest;
  double farthest = std::numeric_limits<double>::infinity();
  for (bool is_last = false; !is_last; tets *= 2) {
    is_last = 2.0 * tets > kMostTets * wanted;
    try {
      sim::Body body = make_cells(s, of_surface, now, tets, false);
      const Off off = find_off(body.mesh.vertices, body.topology.boundary, body.touched);
      if (off.farthest < farthest) nearest = std::move(body);
      farthest = std::min(farthest, off.farthest);
      if (off.edges < follows) break;
    } catch (const InputError&) {
      if (is_last && !nearest) return {make_cells(s, of_surface, now, tets, true), true};
    }
  }
  return {std::move(*nearest), false};
}

}  // namespace argil::scenario
