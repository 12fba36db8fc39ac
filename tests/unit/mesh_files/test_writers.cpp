// What is written reads back to the bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/rng.h"
#include "mesh_files/readers.h"
#include "sample_files.h"
#include "support/temp_folder.h"

namespace argil::mesh_files {
namespace {

// Numbers whose shortest text is long, subnormal, huge, or negative zero.
void roughen(Eigen::Ref<Eigen::MatrixXd> values) {
  Rng rng(7, "writers");
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values.data()[i] = rng.uniform(-1.0, 1.0) * std::pow(10.0, rng.uniform(-300.0, 300.0));
  values.data()[0] = -0.0;
  values.data()[1] = std::numeric_limits<double>::max();
}

bool has_equal_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

TEST(Writers, GmshReadsBackToTheBit) {
  const test::TempFolder folder;
  mesh::TetMesh mesh = test::make_two_tets();
  roughen(mesh.vertices);
  mesh.cell_fields["E \"quoted\" [Pa]"] = Field::LinSpaced(2, 0.1, 1.0 / 3.0);
  mesh.cell_fields["S"] = Field::Constant(2, 5e-324);
  write_gmsh(mesh, folder / "out.msh");
  const mesh::TetMesh back = read_tet_mesh(folder / "out.msh");
  EXPECT_TRUE(has_equal_bits(mesh.vertices, back.vertices));
  EXPECT_TRUE(mesh.tets == back.tets);
  ASSERT_EQ(back.cell_fields.size(), 2U);
  for (const auto& [name, field] : mesh.cell_fields)
    EXPECT_TRUE(has_equal_bits(field, back.cell_fields.at(name)));
}

TEST(Readers, ObjOfSeventeenDigitsReadsBackToTheBit) {
  const test::TempFolder folder;
  mesh::TriangleMesh mesh;
  mesh.vertices.resize(3, 200);
  roughen(mesh.vertices);
  mesh.triangles.resize(3, 198);
  for (int t = 0; t < 198; ++t) mesh.triangles.col(t) << t, t + 1, t + 2;
  std::ostringstream text;
  text.precision(17);
  for (const auto& x : mesh.vertices.colwise()) text << "v " << x.transpose() << '\n';
  for (const auto& t : mesh.triangles.colwise()) text << "f " << (t.array() + 1).transpose() << '\n';
  const mesh::TriangleMesh back = read_triangle_mesh(folder.write("out.obj", text.str()));
  EXPECT_TRUE(has_equal_bits(mesh.vertices, back.vertices));
  EXPECT_TRUE(mesh.triangles == back.triangles);
}

TEST(Writers, AFolderThatIsNotThereIsAnIoError) {
  const test::TempFolder folder;
  ARGIL_EXPECT_THROW_WITH(write_gmsh(test::make_two_tets(), folder / "none/out.msh"), IoError,
                          "cannot be written");
}

TEST(Writers, AFullDiskIsAnIoError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  ARGIL_EXPECT_THROW_WITH(write_gmsh(test::make_two_tets(), "/dev/full"), IoError, "No space left");
}

}  // namespace
}  // namespace argil::mesh_files
