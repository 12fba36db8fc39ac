// The keys of a body: its mesh, supports, loads and cells.

#include "scenario/parameter_sections.h"

namespace argil::scenario {
namespace {

void describe_region(Binder& b, solid::Region& r) {
  using Kind = solid::Region::Kind;
  b.choice<Kind>("/kind", r.kind,
                 {{Kind::box, "box"},
                  {Kind::sphere, "sphere"},
                  {Kind::half_space, "half_space"},
                  {Kind::plane, "plane"},
                  {Kind::nodes, "nodes"}},
                 "Which vertices at rest are meant.")
      .required = true;
  const auto only = [&r](Kind kind) { return [&r, kind] { return r.kind == kind; }; };
  b.vector("/lower_m", r.lower, "m", "box: lowest corner.").applies = only(Kind::box);
  b.vector("/upper_m", r.upper, "m", "box: highest corner.").applies = only(Kind::box);
  b.vector("/centre_m", r.centre, "m", "sphere: centre.").applies = only(Kind::sphere);
  b.number("/radius_m", r.radius, not_negative(), "m", "sphere: radius.").applies = only(Kind::sphere);
  const auto has_normal = [&r] { return r.kind == Kind::half_space || r.kind == Kind::plane; };
  b.vector("/normal", r.normal, "",
           "half_space: vertices with n·x ≤ offset, n the normal at unit length; plane: with both equal.")
      .applies = has_normal;
  b.number("/offset_m", r.offset, any_finite(), "m", "half_space, plane: offset along the normal.").applies =
      has_normal;
  b.number("/thickness_m", r.thickness, not_negative(), "m", "plane: how far off a vertex may lie.").applies =
      only(Kind::plane);
  b.integers("/nodes", r.nodes, not_negative(), "nodes: vertex numbers of the mesh file from 0.").applies =
      only(Kind::nodes);
}

void describe_support(Binder& b, solid::Support& support) {
  describe_region(b, support.region);
  b.boolean("/fixes_x", support.fixes[0], "Hold the x component; false: it is free.");
  b.boolean("/fixes_y", support.fixes[1], "Hold the y component.");
  b.boolean("/fixes_z", support.fixes[2], "Hold the z component.");
  b.vector("/displacement_m", support.displacement, "m", "Where the held components go, from rest.");
  b.number("/ramp_start_s", support.ramp_start, not_negative(), "s", "When they start to.");
  b.number("/ramp_end_s", support.ramp_end, not_negative(), "s",
           "When they are there; not after the start: at once.");
}

void describe_cell_region(Binder& b, CellRegion& region) {
  b.vector("/centre_m", region.centre, "m", "Centre of a ball.").required = true;
  b.number("/radius_m", region.radius, not_negative(), "m", "Its radius.").required = true;
  b.number("/size_m", region.size, size_range(), "m",
           "Largest size of cells in it, the edge of a cube of twelve tets.")
      .required = true;
}

void describe_pressure(Binder& b, solid::PressureLoad& load) {
  describe_region(b, load.region);
  b.number("/pressure_Pa", load.pressure, any_finite(), "Pa",
           "Pressure on boundary faces whose corners all lie in the region, inward positive.")
      .required = true;
}

void describe_load(Binder& b, solid::NodalLoad& load) {
  b.integers("/nodes", load.nodes, not_negative(), "Vertex numbers of the mesh file from 0.").required = true;
  b.vector("/force_N", load.force, "N", "Force on each of them.").required = true;
}

}  // namespace

void bind_body(Binder& b, BodySpec& body, sim::Params& p, const std::string& folder) {
  const auto only = [&body](BodyKind kind) { return [&body, kind] { return body.kind == kind; }; };
  b.path("/body/mesh/file", body.file, folder, "Tetrahedral mesh: Gmsh, Medit, TetGen, VTK, VTU or Vega.")
      .applies = only(BodyKind::mesh);
  b.number("/body/mesh/scale", body.scale, size_range(), "", "Metres per unit of the file.").applies =
      only(BodyKind::mesh);
  b.text("/body/mesh/saturation_field", body.saturation_field,
         "Cell data with the initial saturation; empty: uniform.")
      .applies = only(BodyKind::mesh);
  b.text("/body/mesh/youngs_modulus_field", body.modulus_field,
         "Cell data with Young's modulus of the dry clay [Pa], in the place of the material's; empty: that.")
      .applies = only(BodyKind::mesh);
  b.text("/body/mesh/pore_axis_field", body.pore_axis_field,
         "Cell data NAME_x, NAME_y, NAME_z along the aligned pores of each tet, any length; empty: "
         "/material/effective_medium/axis.")
      .applies = only(BodyKind::mesh);
  b.choice<shapes::ShapeKind>("/body/shape/kind", body.shape.kind,
                              {{shapes::ShapeKind::sphere, "sphere"},
                               {shapes::ShapeKind::cylinder, "cylinder"},
                               {shapes::ShapeKind::box, "box"},
                               {shapes::ShapeKind::dinosaur, "dinosaur"},
                               {shapes::ShapeKind::figure, "figure"}},
                              "Body that argil makes itself.")
      .applies = only(BodyKind::shape);
  b.number("/body/shape/size_m", body.shape.size, size_range(), "m",
           "Diameter of the sphere, length of the dinosaur, height of the others.")
      .applies = only(BodyKind::shape);
  b.number("/body/shape/slenderness", body.shape.slenderness, between(0.1, 10), "",
           "box: height over the edge of its square base.")
      .applies = [&body] {
    return body.kind == BodyKind::shape && body.shape.kind == shapes::ShapeKind::box;
  };
  b.integer("/body/shape/target_tets", body.target_tets, between(100, 5e6),
            "Wanted number of tets, reached within 15 %.")
      .applies = only(BodyKind::shape);
  b.integer("/body/shape/skin_triangles", body.skin_triangles, between(0, 5e6),
            "Skin with at least so many triangles; 0: none.")
      .applies = only(BodyKind::shape);
  const auto fit_words = std::vector<std::pair<embed::Fit, std::string>>{{embed::Fit::surface, "surface"},
                                                                         {embed::Fit::enclose, "enclose"}};
  b.choice<embed::Fit>("/body/shape/fit", body.fit, fit_words,
                       "Of a shape with a skin: the cells' boundary lies on it, or encloses it (the paper).")
      .applies = only(BodyKind::shape);
  b.number("/body/shape/sliver", body.sliver, {0.0, 1.0, true, false}, "",
           "Height of one tet near the top as a share of what it was, to see what a bad tet does; 1: none.")
      .applies = only(BodyKind::shape);
  b.path("/body/surface/file", body.file, folder,
         "Triangle surface (OBJ, OFF, PLY, STL); it becomes the skin in a cage.")
      .applies = only(BodyKind::surface);
  b.number("/body/surface/scale", body.scale, size_range(), "", "Metres per unit of the file.").applies =
      only(BodyKind::surface);
  b.path("/body/surface/cage", body.cage_file, folder, "Cage made before by `argil cage`; empty: made now.")
      .applies = only(BodyKind::surface);
  b.choice<embed::Fit>("/body/surface/fit", body.fit, fit_words,
                       "The cells' boundary lies on the surface, or encloses it (the paper).")
      .applies = only(BodyKind::surface);
  b.integer("/body/surface/target_tets", body.target_tets, between(100, 5e6),
            "Wanted number of tets of a cage made now.")
      .applies = only(BodyKind::surface);
  b.choice<CellKind>(
      "/body/cells/kind", body.cells.kind, {{CellKind::even, "even"}, {CellKind::graded, "graded"}},
      "Cells of one size, or smaller ones where the tool's motion meets the body. Where it is not given: "
      "even with the pairs' law, in statics, of clay with a yield strain and of cells from a file.");
  const auto is_graded = [&body] { return body.cells.kind == CellKind::graded; };
  b.number("/body/cells/near_tool_m", body.cells.near_tool, not_negative(), "m",
           "graded: size of the cells where the tool comes, the edge of a cube of twelve tets; 0: chosen.")
      .applies = is_graded;
  b.number("/body/cells/growth", body.cells.growth, between(0, 10), "",
           "graded: how much larger they become per distance from there; 0: chosen.")
      .applies = is_graded;
  b.objects("/body/cells/regions", body.cells.regions, describe_cell_region,
            "graded: balls with small cells, whether the tool comes there or not.")
      .applies = is_graded;
  b.choice<RemeshWhen>(
      "/body/cells/remesh", body.cells.remesh,
      {{RemeshWhen::never, "never"}, {RemeshWhen::when_spoilt, "when_spoilt"}},
      "New cells between two steps where flow has spoilt those there are: of hencky clay with a strength, by "
      "the pressure law, in backward_euler's steps; not live.");
  b.number("/body/initial_saturation", p.water.initial_saturation, between(0, 1), "",
           "Saturation of every tet at the start.");
  b.objects("/body/fixed", body.fixed, describe_support,
            "Vertices that are held or moved; where two overlap, the later one counts.");
  b.vector("/body/loads/gravity_m_per_s2", p.solid.gravity, "m/s²", "Acceleration of gravity.");
  b.objects("/body/loads/nodal", body.loads.nodal, describe_load, "Constant forces on vertices.");
  b.objects("/body/loads/pressure", body.loads.pressure, describe_pressure, "Constant pressures.");
}

}  // namespace argil::scenario
