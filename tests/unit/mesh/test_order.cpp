// Tets in another order: the same tets, with what belongs to them, near ones next to one another.
#include "mesh/order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/rng.h"
#include "shapes/shapes.h"

namespace argil::mesh {
namespace {

Vec3 find_centre(const TetMesh& mesh, int tet) {
  Vec3 sum = Vec3::Zero();
  for (const int v : mesh.tets.col(tet)) sum += mesh.vertices.col(v);
  return sum / 4.0;
}

/// Mean distance from one tet to the next.
double find_mean_jump(const TetMesh& mesh) {
  double sum = 0.0;
  for (int t = 1; t < mesh.num_tets(); ++t) sum += (find_centre(mesh, t) - find_centre(mesh, t - 1)).norm();
  return sum / (mesh.num_tets() - 1);
}

TetMesh make_shuffled_box() {
  TetMesh mesh = shapes::make_shape_mesh({shapes::ShapeKind::box, 1.0}, 6000);
  Rng rng(5);
  for (int t = mesh.num_tets() - 1; t > 0; --t)
    mesh.tets.col(t).swap(mesh.tets.col(static_cast<int>(rng.uniform() * (t + 1))));
  mesh.cell_fields["place"] = Field::LinSpaced(mesh.num_tets(), 0.0, mesh.num_tets() - 1.0);
  return mesh;
}

/// A lattice of 2ᵏ cells a side is gone through from neighbour to neighbour.
TEST(SortAlongCurve, GoesFromEachCellToANeighbour) {
  constexpr int kSide = 16;
  Points x(3, kSide * kSide * kSide);
  for (int n = 0; n < x.cols(); ++n) x.col(n) = Vec3(n % kSide, n / kSide % kSide, n / (kSide * kSide));
  std::vector<int> list(static_cast<std::size_t>(x.cols()));
  std::iota(list.begin(), list.end(), 0);
  sort_along_curve(x, list);
  for (std::size_t i = 1; i < list.size(); ++i)
    EXPECT_EQ((x.col(list[i]) - x.col(list[i - 1])).lpNorm<1>(), 1.0) << i;
  std::sort(list.begin(), list.end());
  for (std::size_t i = 0; i < list.size(); ++i) EXPECT_EQ(list[i], static_cast<int>(i));
}

TEST(SortTets, PutsNearOnesNextToOneAnother) {
  TetMesh mesh = make_shuffled_box();
  const double edge = std::cbrt(12.0 / mesh.num_tets());  // of cubes of twelve tets
  constexpr double kMeanDistance = 0.6617;                // of two random points of a unit cube (Robbins)
  EXPECT_NEAR(find_mean_jump(mesh), kMeanDistance, 0.02);
  sort_tets(mesh);
  EXPECT_LT(find_mean_jump(mesh), 0.8 * edge);
}

TEST(SortTets, KeepsTetsAndFieldsAndTheirNumbers) {
  const TetMesh before = make_shuffled_box();
  TetMesh mesh = before;
  sort_tets(mesh);
  EXPECT_TRUE((mesh.vertices.array() == before.vertices.array()).all());
  std::vector<int> numbers = mesh.numbers;
  for (int t = 0; t < mesh.num_tets(); ++t) {
    EXPECT_EQ(mesh.tets.col(t), before.tets.col(mesh.number(t)));
    EXPECT_EQ(mesh.cell_fields["place"](t), mesh.number(t));
  }
  EXPECT_TRUE((in_file_order(mesh, mesh.tets).array() == before.tets.array()).all());
  EXPECT_TRUE(
      (in_file_order(mesh, mesh.cell_fields["place"]).array() == before.cell_fields.at("place").array())
          .all());
  std::sort(numbers.begin(), numbers.end());
  std::vector<int> all(numbers.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(numbers, all);
}

TEST(SortTets, KeepsTheFirstNumbersWhenSortedAgain) {
  TetMesh mesh = make_shuffled_box();
  sort_tets(mesh);
  const std::vector<int> numbers = mesh.numbers;
  sort_tets(mesh);
  EXPECT_EQ(mesh.numbers, numbers);
}

TEST(SortTets, TakesOneTet) {
  TetMesh mesh;
  mesh.vertices = Points::Zero(3, 4);
  mesh.vertices.rightCols<3>().setIdentity();
  mesh.tets = Tets::Zero(4, 1);
  mesh.tets << 0, 1, 2, 3;
  sort_tets(mesh);
  EXPECT_EQ(mesh.number(0), 0);
}

}  // namespace
}  // namespace argil::mesh
