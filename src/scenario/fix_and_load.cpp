#include "scenario/fix_and_load.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/print.h"
#include "embed/triangle_tree.h"
#include "scenario/faults.h"
#include "solid/rigid_motion.h"

namespace argil::scenario {
namespace {

/// Numbers in the body, before its cells were graded, of vertices that the scenario numbers as the mesh file
/// has them. `num_given`: vertices of the body then.
std::vector<int> find_vertices(const Scenario& s, const std::string& pointer, std::vector<int> nodes,
                               const mesh_files::FileVertices& file, int num_given) {
  const int num = file.kept.empty() ? num_given : file.num_in_file;
  for (int& v : nodes) {
    if (v >= num)
      throw InputError(s.file, pointer, std::to_string(v) + " is no vertex of the mesh",
                       "give numbers from 0 to " + std::to_string(num - 1));
    const int found = file.find(v);
    if (found < 0)
      throw InputError(s.file, pointer, std::to_string(v) + " is a vertex that no tet of the mesh uses",
                       "take it out of the list");
    v = found;
  }
  return nodes;
}

solid::Region find_region(const Scenario& s, const std::string& pointer, solid::Region region,
                          const mesh_files::FileVertices& file, int num_given) {
  region.nodes = find_vertices(s, pointer + "/nodes", std::move(region.nodes), file, num_given);
  return region;
}

/// Where the body's vertices lie, and, of a body that is fitted to a surface, where that is nearest to those
/// of its boundary: cells follow a flat face to a share of their size, a region means the face.
class VertexPlaces {
 public:
  VertexPlaces(const Scenario& s, const sim::Body& body) : m_own(body.mesh.vertices) {
    const bool is_fitted =
        body.skin.num_triangles() > 0 && s.body.fit == embed::Fit::surface && s.body.cage_file.empty();
    if (!is_fitted || body.topology.boundary.cols() == 0) return;
    const embed::TriangleTree surface(body.skin);
    m_on_surface = m_own;
    for (const int v : body.topology.boundary.reshaped())
      m_on_surface.col(v) = surface.find_nearest(m_own.col(v), std::numeric_limits<double>::infinity()).point;
  }
  /// By either of their places.
  std::vector<int> find_in(const solid::Region& region) const {
    std::vector<int> found = solid::find_nodes(m_own, std::span(&region, 1));
    if (m_on_surface.cols() == 0) return found;
    const std::vector<int> more = solid::find_nodes(m_on_surface, std::span(&region, 1));
    found.insert(found.end(), more.begin(), more.end());
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }
  /// The same vertices, as a list where a surface has a say in which they are.
  solid::Region resolve(const solid::Region& region) const {
    if (m_on_surface.cols() == 0) return region;
    solid::Region list;
    list.kind = solid::Region::Kind::nodes;
    list.nodes = find_in(region);
    return list;
  }

 private:
  const Points& m_own;
  Points m_on_surface;  // empty: of no body that is fitted
};

/// Adds the supports to the body as they are before its cells are graded.
void take_supports(const Scenario& s, const Scene& scene, int num_given, std::vector<solid::Support>& out,
                   Faults& faults) {
  const Points& vertices = scene.body.mesh.vertices;
  const VertexPlaces places(s, scene.body);
  for (std::size_t i = 0; i < s.body.fixed.size(); ++i)
    faults.check([&] {
      const std::string pointer = "/body/fixed/" + std::to_string(i);
      solid::Support support = s.body.fixed[i];
      support.region = find_region(s, pointer, std::move(support.region), scene.file_vertices, num_given);
      out.push_back(support);
      if (!places.find_in(support.region).empty()) return;
      const Vec3 low = vertices.rowwise().minCoeff();
      const Vec3 high = vertices.rowwise().maxCoeff();
      throw InputError(
          s.file, pointer, "holds no vertex of the body",
          "move it into the body's box, " + print_place(low) + " to " + print_place(high) + " m");
    });
}

}  // namespace

void check_supports_of_vertices(const Scenario& s, const Scene& scene) {
  Faults faults(s.file);
  std::vector<solid::Support> supports;
  take_supports(s, scene, scene.body.mesh.num_vertices(), supports, faults);
  faults.throw_all();
}

void fix_and_load(const Scenario& s, const Halvings& halvings, Scene& scene) {
  sim::Body& body = scene.body;
  const int num_given = body.mesh.num_vertices() - static_cast<int>(halvings.ends.size());
  Faults faults(s.file);
  body.supports.clear();
  take_supports(s, scene, num_given, body.supports, faults);
  const VertexPlaces places(s, body);
  for (solid::Support& support : body.supports) {
    halvings.renumber_with_middles(support.region.nodes);
    support.region = places.resolve(support.region);
  }
  body.loads = s.body.loads;
  for (std::size_t i = 0; i < s.body.loads.nodal.size(); ++i)
    faults.check([&] {
      std::vector<int>& nodes = body.loads.nodal[i].nodes;
      nodes = find_vertices(s, "/body/loads/nodal/" + std::to_string(i) + "/nodes", nodes,
                            scene.file_vertices, num_given);
      halvings.renumber(nodes);
    });
  for (std::size_t i = 0; i < s.body.loads.pressure.size(); ++i)
    faults.check([&] {
      const std::string pointer = "/body/loads/pressure/" + std::to_string(i);
      solid::Region& region = body.loads.pressure[i].region;
      region = find_region(s, pointer, region, scene.file_vertices, num_given);
      halvings.renumber_with_middles(region.nodes);
      region = places.resolve(region);
      if (solid::find_faces(body.mesh.vertices, body.topology.boundary, region).empty())
        throw InputError(s.file, pointer, "holds no boundary face of the body",
                         "widen it so that all three corners of a face lie in it");
    });
  faults.throw_all();
}

namespace {

/// The body's elements and what its supports hold of them.
struct Held {
  Held(const Scenario& s, const sim::Body& body)
      : elements(solid::make_elements(body.mesh, body.topology, s.params.solid.element)),
        constraints(solid::find_constraints(elements, body.supports)) {}

  bool is_whole() const {
    int node = 0;
    while (node < elements.rest.cols() && constraints.is_held(node)) ++node;
    return node == elements.rest.cols();
  }

  solid::Elements elements;
  solid::Constraints constraints;
};

}  // namespace

void check_equilibrium_supports(const Scenario& s, const sim::Body& body) {
  const Held held(s, body);
  const std::string motion = solid::find_rigid_motion(held.elements, body.topology, held.constraints);
  if (!motion.empty())
    throw InputError(s.file, "/body/fixed", "does not hold the body: " + motion,
                     "hold at least three vertices of it that are not on a line");
}

std::string describe_free_motion(const Scenario& s, const sim::Body& body) {
  if (body.supports.empty()) return "";  // which is a doubt of the scenario
  const Held held(s, body);
  if (held.is_whole())
    return "supports: /body/fixed holds every vertex: the body cannot give way; hold its foot alone, "
           "and check that places are in metres";
  const std::string motion = solid::find_rigid_motion(held.elements, body.topology, held.constraints);
  if (motion.empty()) return "";
  return "supports: " + motion +
         ", held by its mass alone; where that is not meant, hold at least three vertices of it that are not "
         "on "
         "a line by /body/fixed";
}

}  // namespace argil::scenario
