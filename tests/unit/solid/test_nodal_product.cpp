// The nodes' stiffness by its factors against its sum over the nodes, term by term.
#include "solid/nodal_product.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/rng.h"
#include "support/block_mesh.h"

namespace argil::solid {
namespace {

/// Σ G_a (G_a·x) / D_a with G_a = D_a ∂θ_a/∂x; a column a row.
Points sum_over_nodes(const NodalVolume& nodal, const std::vector<int>& row_of_node, const Points& x) {
  Points y = Points::Zero(3, x.cols());
  for (Eigen::Index a = 0; a < nodal.stiffness().size(); ++a) {
    const double stiffness = nodal.stiffness()(a);
    if (stiffness == 0.0) continue;
    const int begin = nodal.ring_begin()[static_cast<std::size_t>(a)];
    const int end = nodal.ring_begin()[static_cast<std::size_t>(a) + 1];
    const auto each_row = [&](auto body) {
      for (int place = begin; place < end; ++place) {
        const int row = row_of_node[static_cast<std::size_t>(nodal.ring()[static_cast<std::size_t>(place)])];
        if (row >= 0) body(row, Eigen::Map<const Vec3>(nodal.ring_gradient(place)));
      }
    };
    double change = 0.0;
    each_row([&](int row, const Vec3& gradient) { change += gradient.dot(x.col(row)); });
    each_row([&](int row, const Vec3& gradient) { y.col(row) += change / stiffness * gradient; });
  }
  return y;
}

/// Tets whose Poisson's ratio rises one after the other, as they do while water spreads, and falls again.
/// Some nodes are held, so that rows and nodes are not numbered alike.
TEST(NodalProduct, IsTheSumOverTheNodesWhileTetsBecomeLockingFreeAndPlainAgain) {
  const mesh::TetMesh mesh = test::make_block(22, 1, 1, Vec3(22.0, 1.0, 1.0));
  const Elements elements = make_elements(mesh, mesh::make_topology(mesh), ElementKind::p1_nodal);
  Support held;
  held.region.kind = Region::Kind::nodes;
  held.region.nodes = {0, 1, 2};
  std::vector<int> node_of_row, row_of_node(3, -1);
  for (int node = 3; node < elements.num_nodes(); ++node) {
    row_of_node.push_back(static_cast<int>(node_of_row.size()));
    node_of_row.push_back(node);
  }
  NodalVolume nodal(elements, row_of_node, 1);
  NodalProduct product(nodal, node_of_row, row_of_node, find_constraints(elements, {&held, 1}), false, 1);
  const auto num_rows = static_cast<Eigen::Index>(node_of_row.size());
  Rng rng(5);
  Points x(3, num_rows);
  for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = rng.uniform(-1.0, 1.0);

  const auto expect_sum = [&](const std::string& when) {
    nodal.update_stiffness();
    nodal.collect_gradients(elements.gradient);
    product.update(1.0);
    Points y = Points::Zero(3, num_rows);
    const double along = product.add(x, y);
    const Points expected = sum_over_nodes(nodal, row_of_node, x);
    EXPECT_LE((y - expected).norm(), 1e-12 * (1.0 + expected.norm())) << when;
    EXPECT_NEAR(along, x.cwiseProduct(expected).sum(), 1e-12 * (1.0 + expected.squaredNorm())) << when;
    Eigen::Matrix3Xd blocks = Eigen::Matrix3Xd::Zero(3, 3 * num_rows);
    product.add_diagonal(blocks);
    for (const Eigen::Index row : {Eigen::Index{0}, num_rows / 2, num_rows - 1})
      for (int k = 0; k < 3; ++k) {
        Points unit = Points::Zero(3, num_rows);
        unit(k, row) = 1.0;
        const Vec3 column = sum_over_nodes(nodal, row_of_node, unit).col(row);
        EXPECT_LE((blocks.col(3 * row + k) - column).norm(), 1e-12 * (1.0 + column.norm())) << when;
      }
  };
  expect_sum("all plain");
  for (int tet = 0; tet < elements.num_tets(); ++tet) {
    nodal.set_excess(tet, 2.0, elements.weight(tet));
    expect_sum("with tet " + std::to_string(tet));
  }
  for (int tet = 0; tet < elements.num_tets(); ++tet) {
    nodal.set_excess(tet, 0.0, elements.weight(tet));
    expect_sum("without tet " + std::to_string(tet));
  }
}

}  // namespace
}  // namespace argil::solid
