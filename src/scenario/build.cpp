#include "scenario/build.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "contact/tool_shape.h"
#include "embed/cage.h"
#include "embed/skin_shape.h"
#include "mesh/order.h"
#include "mesh/quality.h"
#include "mesh/sliver.h"
#include "mesh_files/readers.h"
#include "scenario/cell_sizes.h"
#include "scenario/faults.h"
#include "scenario/fix_and_load.h"
#include "scenario/medium_check.h"
#include "scenario/scene_faults.h"
#include "scenario/true_surface.h"

namespace argil::scenario {
namespace {

/// A field of the mesh file, checked against a range.
Field take_field(const Scenario& s, const mesh::TetMesh& mesh, const std::string& name,
                 const std::string& pointer, double low, double high) {
  const auto found = mesh.cell_fields.find(name);
  if (found == mesh.cell_fields.end())
    throw InputError(s.body.file, "", "has no cell data named \"" + name + "\" that " + pointer + " asks for",
                     "correct the name or leave it empty");
  for (Eigen::Index t = 0; t < found->second.size(); ++t)
    if (!(found->second(t) >= low && found->second(t) <= high)) {
      std::ostringstream text;
      text << "cell data \"" << name << "\" is " << found->second(t) << ", outside [" << low << ", " << high
           << "]";
      throw InputError(s.body.file, "tet " + std::to_string(mesh.number(static_cast<int>(t))), text.str(),
                       "correct the file");
    }
  return found->second;
}

/// Unit axes of the pores from three components in the mesh file.
Points take_axes(const Scenario& s, const mesh::TetMesh& mesh) {
  constexpr double kLarge = 1e300;
  Points axes(3, mesh.num_tets());
  for (int k = 0; k < 3; ++k)
    axes.row(k) = take_field(s, mesh, s.body.pore_axis_field + "_" + "xyz"[k], "/body/mesh/pore_axis_field",
                             -kLarge, kLarge);
  for (Eigen::Index t = 0; t < axes.cols(); ++t) {
    const double length = axes.col(t).stableNorm();
    if (!(length > 0.0))
      throw InputError(s.body.file, "tet " + std::to_string(mesh.number(static_cast<int>(t))),
                       "cell data \"" + s.body.pore_axis_field + "\" has no length",
                       "give every tet an axis");
    axes.col(t) /= length;
  }
  return axes;
}

/// Fields of the mesh file.
void take_fields(const Scenario& s, sim::Body& body) {
  Faults faults(s.file);
  body.initial_saturation = Field::Constant(body.mesh.num_tets(), s.params.water.initial_saturation);
  if (const std::string& name = s.body.saturation_field; !name.empty())
    faults.check([&] {
      body.initial_saturation = take_field(s, body.mesh, name, "/body/mesh/saturation_field", 0.0, 1.0);
    });
  if (const std::string& name = s.body.modulus_field; !name.empty())
    faults.check([&] {
      body.youngs_modulus = take_field(s, body.mesh, name, "/body/mesh/youngs_modulus_field", 1e-6, 1e15);
    });
  if (!s.body.pore_axis_field.empty()) faults.check([&] { body.pore_axis = take_axes(s, body.mesh); });
  faults.throw_all();
}

/// What `make` refuses came from the scenario's `pointer`: say so.
template <class Make>
auto from_scenario(const Scenario& s, const char* pointer, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(s.file, pointer, error.what(), "");
  }
}

/// The file that the tets are from.
const std::string& name_origin(const Scenario& s) {
  if (s.body.kind == BodyKind::mesh) return s.body.file;
  return s.body.cage_file.empty() ? s.file : s.body.cage_file;
}

void add_note(std::string note, Scene& scene) {
  if (!note.empty()) scene.notes.push_back(std::move(note));
}

void add_file_note(std::string note, Scene& scene) {
  if (note.empty()) return;
  scene.file_notes.push_back(note);
  scene.notes.push_back(std::move(note));
}

/// The scenario's lists of vertices number those of this file.
void add_note_of_lists(const std::string& file, Scene& scene) {
  const std::string note = scene.file_vertices.describe(file, "tet");
  if (note.empty()) return;
  const bool has_gaps = scene.file_vertices.num_left_out() > 0;
  add_file_note(note + (has_gaps ? "; lists of vertices go on counting them" : ""), scene);
}

mesh::TriangleMesh read_surface(const std::string& file, double scale, Scene& scene) {
  mesh_files::FileVertices vertices;
  mesh::TriangleMesh surface = mesh_files::read_triangle_mesh(file, scale, &vertices);
  add_file_note(vertices.describe(file, "triangle"), scene);
  return surface;
}

bool bends_edges(const Scenario& s) {
  return s.params.solid.element == solid::ElementKind::p2;
}

void make_cage(const Scenario& s, int num_tets, const std::string& name, Scene& scene) {
  embed::CageOptions options{num_tets, s.body.fit};
  options.bends_edges = bends_edges(s);
  embed::Cage cage = embed::make_cage(scene.body.skin, options, name);
  scene.notes.push_back("cage: " + embed::describe(cage.report));
  scene.body.mesh = std::move(cage.mesh);
}

/// A cage and a surface of unlike size are in unlike units.
void require_one_size(const Scenario& s, const sim::Body& body) {
  constexpr double kMost = 3.0;  // a cage of a few tets is less than twice as large as what it holds
  const auto measure = [](const Points& x) {
    return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).maxCoeff();
  };
  const double cage = measure(body.mesh.vertices);
  const double skin = measure(body.skin.vertices);
  if (cage < kMost * skin && skin < kMost * cage) return;
  std::ostringstream problem;
  problem << "is " << cage << " m across, and the surface " << skin << " m by its scale of " << s.body.scale;
  std::ostringstream remedy;
  remedy << "make it by `argil cage --scale " << s.body.scale << "`, or correct /body/surface/scale";
  throw InputError(s.body.cage_file, "/body/surface/cage", problem.str(), remedy.str());
}

/// Before its cells are graded: messages name the tets of the file.
void make_mesh(const Scenario& s, int num_tets, Scene& scene) {
  sim::Body& body = scene.body;
  switch (s.body.kind) {
    case BodyKind::mesh:
      body.mesh = mesh_files::read_tet_mesh(s.body.file, s.body.scale, &scene.file_vertices);
      add_note_of_lists(s.body.file, scene);
      break;
    case BodyKind::shape:
      if (s.body.skin_triangles > 0) body.skin = shapes::make_shape_skin(s.body.shape, s.body.skin_triangles);
      if (body.skin.num_triangles() > 0) {
        make_cage(s, num_tets, s.file, scene);
      } else {
        const auto count = num_tets == s.body.target_tets ? shapes::Count::wanted : shapes::Count::nearest;
        body.mesh = from_scenario(s, "/body/shape",
                                  [&] { return shapes::make_shape_mesh(s.body.shape, num_tets, count); });
      }
      if (s.body.sliver < 1.0)
        from_scenario(s, "/body/shape/sliver", [&] { mesh::flatten_tet(body.mesh, s.body.sliver); });
      break;
    case BodyKind::surface:
      body.skin = read_surface(s.body.file, s.body.scale, scene);
      if (s.body.cage_file.empty()) {
        make_cage(s, num_tets, s.body.file, scene);
      } else {
        body.mesh = mesh_files::read_tet_mesh(s.body.cage_file, 1.0, &scene.file_vertices);
        require_one_size(s, body);
        add_note_of_lists(s.body.cage_file, scene);
      }
      break;
  }
  const std::string& origin = name_origin(s);
  Faults faults(s.file);
  faults.check([&] {
    mesh::require_size(body.mesh.vertices, origin);
    add_note(mesh::require_usable(mesh::compute_quality(body.mesh), origin), scene);
  });
  faults.check([&] { take_fields(s, body); });
  faults.throw_all();
}

double most_beyond(const Scenario& s) {
  return s.body.fit == embed::Fit::surface ? embed::kMostBeyondFitted : 0.0;
}

bool holds_skin(const Scenario& s, const sim::Body& body) {
  return body.skin.num_triangles() == 0 || embed::can_embed(body.mesh, body.skin.vertices, most_beyond(s));
}

/// How well graded cells follow the skin.
std::string describe_fit(const sim::Body& body) {
  const mesh::QualityReport quality = mesh::compute_quality(body.mesh);
  std::ostringstream text;
  text.precision(4);
  if (embed::is_closed(body.skin))
    text << ", volume " << quality.volume / embed::compute_skin_volume(body.skin) << " of the surface's";
  text << ", dihedral angles " << quality.min_dihedral_degrees << " to " << quality.max_dihedral_degrees
       << " degrees";
  return text.str();
}

Halvings make_cells(const Scenario& s, const std::vector<sim::TouchedPlace>* places, Scene& scene) {
  if (s.body.cells.kind == CellKind::even) {
    make_mesh(s, s.body.target_tets, scene);
    return {};
  }
  // A sharp tip that the first cells cut off may be far outside the small ones below it: then others are
  // tried.
  constexpr double kMore = 1.5;
  const std::vector<std::string> notes = scene.notes;
  const double most = std::max(s.body.target_tets, count_first_tets(s.body));
  for (double count = count_first_tets(s.body);; count *= kMore) {
    scene.notes = notes;
    scene.file_notes.clear();
    make_mesh(s, static_cast<int>(count), scene);
    std::optional<Halvings> halvings =
        grade_cells(s, scene.trace, scene.tool, places, scene.body, scene.notes, bends_edges(s));
    if (!halvings) break;
    if (!holds_skin(s, scene.body) && kMore * count <= most) continue;
    if (scene.body.skin.num_triangles() > 0 && !bends_edges(s))
      scene.notes.back() += describe_fit(scene.body);
    return *std::move(halvings);
  }
  const std::string reason = scene.notes.back();
  scene.notes = notes;
  scene.notes.push_back(reason);
  scene.file_notes.clear();
  make_mesh(s, s.body.target_tets, scene);
  return {};
}

/// What of the skin is outside a fitted body is carried by the tets below it.
void embed_skin(const Scenario& s, Scene& scene) {
  sim::Body& body = scene.body;
  body.skin_embedding = embed::make_embedding(body.mesh, body.skin.vertices, name_origin(s), most_beyond(s));
  if (s.body.fit != embed::Fit::surface) return;
  std::ostringstream text;
  text << "skin: carried with weights " << body.skin_embedding.weights.minCoeff() << " to "
       << body.skin_embedding.weights.maxCoeff() << " of the cells' vertices";
  scene.notes.push_back(text.str());
}

/// The effective medium over the mesh's own fields.
void check_medium(const Scenario& s, Scene& scene) {
  scene.medium_status = s.medium_status;
  if (!needs_fields(s)) return;
  const Field& E = scene.body.youngs_modulus;
  const double uniform = s.params.elastic.youngs_modulus;
  const MediumCheck check =
      check_effective_medium(s, {E.size() > 0 ? E.minCoeff() : uniform, E.size() > 0 ? E.maxCoeff() : uniform,
                                 scene.body.initial_saturation.maxCoeff()});
  scene.medium_status = check.status;
  if (!check.warning.empty()) scene.notes.push_back(check.warning);
}

/// Explicit diffusion needs so many substeps that the run would never end?
void check_diffusion(const Scenario& s, const sim::Body& body) {
  constexpr double kMostSubsteps = 10000.0;
  const water::WaterParams& w = s.params.water;
  if (!(w.diffusivity > 0.0) || w.scheme == water::DiffusionScheme::implicit_euler) return;
  const double limit =
      water::make_stencil(body.mesh, body.topology, w.diffusivity, water::FluxForm::two_point).monotone_step /
      std::exp(std::max(0.0, w.diffusivity_exponent));
  const double step = s.params.rates.haptic_period * s.params.rates.water_period_ticks;
  if (step / limit <= kMostSubsteps) return;
  std::ostringstream text;
  text << "needs " << step / limit << " explicit substeps a water step: the mesh allows " << limit
       << " s each, and a water step is " << step << " s";
  throw InputError(s.file, "/water/diffusivity_m2_per_s", text.str(),
                   "set /water/diffusion to implicit, or give a smaller diffusivity or a coarser mesh");
}

mesh::TriangleMesh make_tool(const Scenario& s, Scene& scene) {
  switch (s.tool.kind) {
    case ToolKind::sphere:
      return contact::make_sphere_tool(s.tool.radius, s.tool.subdivisions);
    case ToolKind::capsule:
      return contact::make_capsule_tool(s.tool.radius, s.tool.length, s.tool.segments);
    case ToolKind::stylus:
      return contact::make_stylus_tool(s.tool.tip_radius, s.tool.radius, s.tool.length, s.tool.segments);
    case ToolKind::mesh:
      break;
  }
  mesh::TriangleMesh tool = read_surface(s.tool.file, s.tool.scale, scene);
  mesh::require_size(tool.vertices, s.tool.file);
  contact::require_closed_surface(tool, s.tool.file);
  return tool;
}

void check_skin(const Scenario& s, const mesh::TriangleMesh& skin) {
  if (s.params.contact_surface != sim::SurfaceKind::skin) return;
  if (skin.num_triangles() == 0)
    throw InputError(s.file, "/contact/surface", "is \"skin\" but the body has none",
                     "give /body/surface or /body/shape/skin_triangles, or set \"cage\"");
  try {
    contact::require_closed_surface(skin, s.body.kind == BodyKind::surface ? s.body.file : s.file);
  } catch (const InputError& error) {
    throw InputError(s.file, "/contact/surface", std::string("is \"skin\": ") + error.what(),
                     "or set \"cage\": the tool then meets the boundary of the solid");
  }
}

/// A pulling tool's grip bears what the clay does, unless it is given.
void check_grip(const Scenario& s, const device::Trace& trace) {
  const contact::ContactParams& c = s.params.contact;
  if (c.law == contact::ContactLaw::pairs || c.grip_strength > 0.0) return;
  const auto pulls = [](const device::DeviceSample& sample) { return sample.mode == device::ToolMode::pull; };
  if (s.tool.mode == ModeChoice::pull ||
      (s.tool.mode == ModeChoice::trace && std::any_of(trace.samples.begin(), trace.samples.end(), pulls)))
    throw InputError(s.file, "/contact/grip_strength_Pa",
                     "is missing: the tool pulls, and elastic clay has no strength",
                     "give the mean traction at which the tool lets go");
}

void check_reach(const Scenario& s, const device::Trace& trace) {
  for (const device::DeviceSample& sample : trace.samples)
    if (!device::is_within_reach(sample.position)) {
      std::ostringstream problem;
      problem << "takes the motion to " << sample.position.stableNorm() << " m from the origin, more than "
              << device::kFarthestPlace << " m";
      throw InputError(s.file, "/trace/device_to_world", problem.str(), "correct scale and translation_m");
    }
}

void check_stretch(const Scenario& s, const device::Trace& trace) {
  if (!(s.trace.start < trace.duration()))
    throw InputError(s.file, "/trace/start_s",
                     "lies past the trace's end, " + std::to_string(trace.duration()) + " s",
                     "give an earlier start");
  if (s.trace.duration > trace.duration() - s.trace.start + 1e-9)
    throw InputError(s.file, "/trace/duration_s",
                     "asks for more than the " + std::to_string(trace.duration() - s.trace.start) +
                         " s that the trace has",
                     "give less, or 0 for all of it");
}

void read_motion(const Scenario& s, Scene& scene, Faults& faults) {
  const bool is_read = faults.check([&] { scene.trace = device::read_trace(s.trace.file, s.trace.options); });
  if (!is_read) return;
  faults.check([&] { check_grip(s, scene.trace); });
  faults.check([&] { check_reach(s, scene.trace); });
  faults.check([&] { check_stretch(s, scene.trace); });
  for (const std::string& note : scene.trace.notes) scene.notes.push_back("trace: " + note);
}

/// What a whole mesh is given beside its cells, each checked by itself.
void complete_body(const Scenario& s, const Halvings& halvings, Scene& scene, Faults& faults) {
  sim::Body& body = scene.body;
  mesh::sort_tets(body.mesh);
  take_fields(s, body);
  body.topology = mesh::make_topology(body.mesh);
  if (bends_edges(s)) bend_edges(s.body, body, scene.notes);
  const bool has_motion = faults.empty();
  if (body.skin.num_triangles() > 0) faults.check([&] { embed_skin(s, scene); });
  if (has_motion) scene.contact_cells = describe_contact_cells(s, scene.trace, scene.tool, body);
  faults.check([&] { check_medium(s, scene); });
  faults.check([&] { check_diffusion(s, body); });
  const bool is_held = faults.check([&] { fix_and_load(s, halvings, scene); });
  if (s.mode == Mode::dynamic) faults.check([&] { check_skin(s, body.skin); });
  if (!is_held) return;
  if (s.mode == Mode::equilibrium) {
    faults.check([&] { check_equilibrium_supports(s, body); });
  } else {
    scene.free_motion = describe_free_motion(s, body);
    add_note(scene.free_motion, scene);
  }
}

/// Of the body with the cells that no motion has graded: messages name its vertices, which stay.
void find_body_faults(const Scenario& s, Scene& scene, Faults& faults) {
  const bool is_made = faults.check([&] { make_mesh(s, s.body.target_tets, scene); });
  sim::Body& body = scene.body;
  if (is_made && faults.check([&] { body.topology = mesh::make_topology(body.mesh); }))
    faults.check([&] { fix_and_load(s, {}, scene); });
  else if (body.mesh.num_vertices() > 0)
    faults.check([&] { check_supports_of_vertices(s, scene); });
}

}  // namespace

void find_scene_faults(const Scenario& s, Faults& faults) {
  Scene scene;
  if (!faults.concerns("/tool")) faults.check([&] { scene.tool = make_tool(s, scene); });
  if (s.mode == Mode::dynamic && !s.trace.file.empty() && !faults.concerns("/trace") &&
      faults.check([&] { scene.trace = device::read_trace(s.trace.file, s.trace.options); })) {
    faults.check([&] { check_reach(s, scene.trace); });
    faults.check([&] { check_stretch(s, scene.trace); });
  }
  if (!faults.concerns("/body")) find_body_faults(s, scene, faults);
}

Scene build_scene(const Scenario& s, const std::vector<sim::TouchedPlace>* places) {
  Scene scene;
  scene.notes = s.warnings;
  Faults faults(s.file);
  faults.check([&] { scene.tool = make_tool(s, scene); });
  if (s.mode == Mode::dynamic && !s.trace.file.empty()) read_motion(s, scene, faults);
  if (!faults.empty() && s.body.cells.kind != CellKind::even) {  // cells are graded by tool and motion
    find_body_faults(s, scene, faults);
    faults.throw_all();
  }
  Halvings halvings;
  if (faults.check([&] { halvings = make_cells(s, places, scene); }))
    complete_body(s, halvings, scene, faults);
  else if (scene.body.mesh.num_vertices() > 0)
    faults.check([&] { check_supports_of_vertices(s, scene); });
  faults.throw_all();
  return scene;
}

}  // namespace argil::scenario
