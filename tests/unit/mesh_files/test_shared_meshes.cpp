// Public meshes that no one here made: counts are those their folder's README states, volumes those of an
// independent reader (numpy on the raw text), closedness as its table says.
#include <gtest/gtest.h>

#include "base/error.h"
#include "mesh/quality.h"
#include "mesh_files/readers.h"
#include "support/shared_data.h"
#include "support/surface_report.h"
#include "support/temp_folder.h"

namespace argil::mesh_files {
namespace {

struct Body {
  const char* file;
  int num_vertices;
  int num_tets;
  double volume;
};

TEST(SharedTets, CountsAndVolumesAreThoseOfTheirSource) {
  ARGIL_NEED_SHARED_DATA("tets");
  constexpr double kPrinted = 1e-14;  // the reference sums in another order
  for (const Body& body :
       {Body{"dinosaur.msh", 13270, 49973, 0.025442424809419932},
        Body{"alien.msh", 12531, 48643, 1.4991703387526532},
        Body{"Armadillo13K.msh", 13230, 54985, 237516.00909540182},
        Body{"sphere5K.msh", 7034, 27792, 0.5226639195600145},
        Body{"torus.msh", 200, 491, 0.07265444757418155}, Body{"bar-2523.msh", 886, 2523, 5.0},
        Body{"pbd_armadillo_4k.node", 1180, 3717, 1.8596000544456586},
        Body{"turtle-volumetric-homogeneous.veg", 347, 1185, 45.18704525221653}}) {
    SCOPED_TRACE(body.file);
    const mesh::TetMesh mesh = read_tet_mesh(test::shared_data(std::string("tets/") + body.file));
    const mesh::QualityReport report = mesh::compute_quality(mesh);
    EXPECT_EQ(report.num_vertices, body.num_vertices);
    EXPECT_EQ(report.num_tets, body.num_tets);
    EXPECT_NEAR(report.volume, body.volume, 100.0 * kPrinted * body.volume);
    EXPECT_EQ(mesh::require_usable(report, body.file), "");
    EXPECT_EQ(report.num_components, 1);
  }
}

TEST(SharedTets, OneMeshInFourGmshEncodingsIsOneMesh) {
  ARGIL_NEED_SHARED_DATA("tets/22_ascii.msh");
  const mesh::TetMesh first = read_tet_mesh(test::shared_data("tets/22_ascii.msh"));
  EXPECT_EQ(first.num_vertices(), 8);
  EXPECT_EQ(first.num_tets(), 5);
  for (const char* file : {"tets/22_binary.msh", "tets/41_ascii.msh", "tets/41_binary.msh"}) {
    const mesh::TetMesh mesh = read_tet_mesh(test::shared_data(file));
    EXPECT_TRUE(mesh.vertices == first.vertices) << file;
    EXPECT_TRUE(mesh.tets == first.tets) << file;
  }
}

struct Skin {
  const char* file;
  int num_vertices;
  int num_triangles;
  bool is_closed;
  int num_degenerate;
};

TEST(SharedSurfaces, CountsAndClosednessAreThoseOfTheirSource) {
  ARGIL_NEED_SHARED_DATA("surface");
  for (const Skin& skin :
       {Skin{"surface/Animated_Human.obj", 791, 1578, true, 0},
        Skin{"surface/Stegosaurus.obj", 1141, 2290, false, 8},
        Skin{"surface/sword.obj", 22293, 44582, true, 0}, Skin{"surface/vega_comb.obj", 4910, 9816, true, 0},
        Skin{"surface/gc_moebius.obj", 280, 448, false, 0},
        Skin{"surface/trimesh_negative_indices.obj", 8, 12, true, 0},
        Skin{"surface/trimesh_polygonfaces.obj", 5, 3, false, 0},
        Skin{"surface/trimesh_soup.stl", 300, 100, false, 0},
        Skin{"surface/igl_cube_with_fold.ply", 26, 48, true, 0},
        Skin{"tets/turtle.obj", 1961, 3654, false, 0}}) {
    SCOPED_TRACE(skin.file);
    const test::SurfaceReport report =
        test::compute_surface_report(read_triangle_mesh(test::shared_data(skin.file)));
    EXPECT_EQ(report.num_vertices, skin.num_vertices);
    EXPECT_EQ(report.num_triangles, skin.num_triangles);
    EXPECT_EQ(report.is_closed(), skin.is_closed);
    EXPECT_EQ(report.num_degenerate, skin.num_degenerate);
  }
}

TEST(SharedSurfaces, TheStegosaurusHasEightNonManifoldEdgesAndTheMoebiusStripCannotBeOriented) {
  ARGIL_NEED_SHARED_DATA("surface/gc_moebius.obj");
  const auto report = [](const char* file) {
    return test::compute_surface_report(read_triangle_mesh(test::shared_data(file)));
  };
  EXPECT_EQ(report("surface/Stegosaurus.obj").num_non_manifold_edges, 8);
  EXPECT_GT(report("surface/gc_moebius.obj").num_non_manifold_edges, 0);
}

TEST(SharedSurfaces, TooFewIndicesAreRefusedWithTheirLine) {
  ARGIL_NEED_SHARED_DATA("surface/trimesh_notenoughindices.obj");
  ARGIL_EXPECT_THROW_WITH(read_triangle_mesh(test::shared_data("surface/trimesh_notenoughindices.obj")),
                          InputError, "line 9: a face of 2 vertices");
}

}  // namespace
}  // namespace argil::mesh_files
