#include "scenario/renew_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/error.h"
#include "embed/curved_split.h"
#include "embed/skin_shape.h"
#include "mesh/order.h"
#include "mesh/quality.h"
#include "scenario/cell_sizes.h"

namespace argil::scenario {
namespace {

constexpr int kFewestTets = 100;  // that a body may be made of

/// What the tool has pressed round, in facets as large as cells, lies on it.
void lay_on_tool(const PresentShape& now, const Scenario& s, mesh::TriangleMesh& surface) {
  constexpr double kNear = 0.3;    // of an edge, to both sides
  constexpr double kDepth = 1e-3;  // of an edge: contacts press with about the clay's strength then
  if (!now.touching) return;
  Field edge = Field::Zero(surface.num_vertices());
  for (const auto& v : surface.triangles.colwise())
    for (Eigen::Index k = 0; k < 3; ++k)
      edge(v(k)) =
          std::max(edge(v(k)), (surface.vertices.col(v(k)) - surface.vertices.col(v((k + 1) % 3))).norm());
  contact::ToolSolid tool = contact::make_tool_solid(s.params.contact.round_tool, now.tool);
  const contact::Pose& pose = *now.touching;
  int face = 0;
  for (int v = 0; v < surface.num_vertices(); ++v) {
    const Vec3 in_tool = pose.orientation.conjugate() * (surface.vertices.col(v) - pose.position);
    const contact::ToolDistance found = tool.find_distance(in_tool, face);
    if (std::abs(found.distance) < kNear * edge(v))
      surface.vertices.col(v) -= (found.distance + kDepth * edge(v)) * (pose.orientation * found.outward);
  }
}

/// Moves the boundary out or in, everywhere alike, until it encloses as much as the surface that it follows.
/// Where that is more than a cell gives, the surface is not closed, and nothing moves.
void match_volume(const mesh::TriangleMesh& surface, const Triangles& boundary, Points& x) {
  constexpr int kTimes = 2;
  constexpr double kMost = 0.1;  // of the mean edge of the boundary
  const double wanted = embed::compute_skin_volume(surface);
  for (int i = 0; i < kTimes; ++i) {
    Points normal = Points::Zero(3, x.cols());
    double area = 0.0, edge = 0.0;
    for (const auto& v : boundary.colwise()) {
      const Vec3 n = 0.5 * Vec3(x.col(v(1)) - x.col(v(0))).cross(Vec3(x.col(v(2)) - x.col(v(0))));
      for (const int corner : v) normal.col(corner) += n;
      area += n.norm();
      edge += (x.col(v(1)) - x.col(v(0))).norm() / static_cast<double>(boundary.cols());
    }
    const double offset = (wanted - embed::compute_skin_volume({x, boundary})) / area;
    if (!(std::abs(offset) < kMost * edge)) return;
    for (Eigen::Index v = 0; v < x.cols(); ++v)
      if (!normal.col(v).isZero(0.0)) x.col(v) += offset * normal.col(v).normalized();
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
    Eigen::Index nearest = 0;
    (rest.colwise() - place.position).colwise().squaredNorm().minCoeff(&nearest);
    place.position += moved.col(nearest) - rest.col(nearest);
  }
  return places;
}

embed::Embedding embed_in(const mesh::TetMesh& mesh, const Points& points, const std::string& file) {
  return embed::make_embedding(mesh, points, file, embed::kMostBeyondFitted);
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
  body.touched_embedding = embed_in(body.mesh, body.touched.vertices, s.file);
  if (body.skin.num_triangles() > 0) body.skin_embedding = embed_in(body.mesh, body.skin.vertices, s.file);
  return body;
}

/// Of a surface with thin parts, finer ones all over until they have all of its vertices.
mesh::TetMesh make_first_cells(const mesh::TriangleMesh& surface, int num_tets, const Points& skin,
                               const std::string& file) {
  constexpr int kTries = 4;
  for (int i = 0; i < kTries; ++i) {
    mesh::TetMesh mesh = embed::make_cage(surface, {num_tets << i, embed::Fit::surface}, file).mesh;
    try {
      embed_in(mesh, surface.vertices, file);
      embed_in(mesh, skin, file);
      return mesh;
    } catch (const InputError&) {
      if (i + 1 == kTries) throw;
    }
  }
  return {};
}

sim::Body make_new_cells(const Scenario& s, const PresentShape& now) {
  const Scenario of_surface = make_scenario_of_surface(s, now.body);
  sim::Body body;
  const bool is_boundary = now.body.skin.num_triangles() == 0 && now.body.touched.num_triangles() == 0;
  body.touched = is_boundary ? embed::split_where_curved(now.touched) : now.touched;
  if (is_boundary) lay_on_tool(now, s, body.touched);
  body.loads = now.body.loads;
  body.first_tets = now.body.first_tets > 0 ? now.body.first_tets : now.body.mesh.num_tets();
  Points skin;
  if (now.body.skin.num_triangles() > 0)
    embed::interpolate_positions(now.body.skin_embedding, now.nodes, now.x, skin);
  const std::vector<sim::TouchedPlace> places = move_places(now, skin);
  const bool is_graded = !places.empty() || !s.body.cells.regions.empty();
  const int num_tets = is_graded ? count_first_tets(of_surface.body) : of_surface.body.target_tets;
  body.mesh = make_first_cells(body.touched, num_tets, skin, s.file);
  if (is_graded) {
    std::swap(body.skin, body.touched);  // that the cells follow
    std::vector<std::string> notes;
    grade_cells(of_surface, {}, {}, &places, body, notes);
    std::swap(body.skin, body.touched);
    body.touched_places = places;
  }
  mesh::sort_tets(body.mesh);
  body.mesh.numbers.clear();
  body.topology = mesh::make_topology(body.mesh);
  match_volume(body.touched, body.topology.boundary, body.mesh.vertices);
  mesh::require_usable(mesh::compute_quality(body.mesh), s.file);
  body.touched_embedding = embed_in(body.mesh, body.touched.vertices, s.file);
  if (skin.size() == 0) return body;
  body.skin = {skin, now.body.skin.triangles};
  body.skin_embedding = embed_in(body.mesh, skin, s.file);
  return body;
}

}  // namespace argil::scenario
