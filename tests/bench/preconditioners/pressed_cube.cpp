#include "preconditioners/pressed_cube.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/check.h"
#include "linear/pcg.h"
#include "mesh/order.h"
#include "mesh/topology.h"
#include "shapes/shapes.h"
#include "solid/element.h"
#include "solid/material_changes.h"
#include "solid/move.h"
#include "solid/step_solver.h"

namespace argil::bench {
namespace {

constexpr double kEdge = 0.06;                    // [m]
constexpr double kYoung = 140e3, kPoisson = 0.3;  // [Pa], [–]
constexpr double kMu = kYoung / (2.0 * (1.0 + kPoisson));
constexpr double kLambda = 2.0 * kMu * kPoisson / (1.0 - 2.0 * kPoisson);
constexpr double kStep = 1e-3;                    // [s]
constexpr double kGrowth = 100.0, kSpot = 0.006;  // [N/s], [m] deviation
constexpr int kSteps = 60, kEarlier = 40;

/// Numbers of the free nodes in the order in which the solid has them, and the pattern of their matrix.
struct Rows {
  std::vector<int> node, of_node;
  linear::BlockMatrix pattern;
};

Rows number_rows(const solid::Body& solid) {
  const solid::Elements& elements = solid.model.elements;
  std::vector<int> nodes(static_cast<std::size_t>(elements.num_nodes()));
  std::iota(nodes.begin(), nodes.end(), 0);
  mesh::sort_along_curve(elements.rest, nodes);
  Rows rows;
  rows.of_node.assign(nodes.size(), -1);
  for (const int node : nodes) {
    if (!solid.model.constraints.is_free(node)) continue;
    rows.of_node[static_cast<std::size_t>(node)] = static_cast<int>(rows.node.size());
    rows.node.push_back(node);
  }
  const std::vector<std::vector<int>> neighbours = solid::find_node_neighbours(elements);
  std::vector<std::vector<int>> lists;
  for (const int node : rows.node) {
    std::vector<int>& list = lists.emplace_back();
    for (const int near : neighbours[static_cast<std::size_t>(node)])
      if (const int row = rows.of_node[static_cast<std::size_t>(near)]; row >= 0) list.push_back(row);
    std::sort(list.begin(), list.end());
  }
  rows.pattern = linear::make_block_matrix(lists);
  return rows;
}

/// A = M + h² K with the rotations at x; h f_int (a column a row) besides.
linear::BlockMatrix assemble(const solid::Body& solid, const Rows& rows, const Points& x, Points& impulse) {
  const solid::Elements& elements = solid.model.elements;
  const Mat6 C = solid::make_isotropic_stiffness(kLambda, kMu);
  const solid::Elasticity elasticity{kLambda, kMu};
  linear::BlockMatrix matrix = rows.pattern;
  impulse.setZero(3, matrix.num_rows());
  for (int t = 0; t < elements.num_tets(); ++t) {
    const solid::TetGeometry tet{elements.gradient.middleCols<4>(4 * t), elements.weight(t)};
    solid::Mat34 corners;
    for (int i = 0; i < 4; ++i) corners.col(i) = x.col(elements.nodes(i, t));
    const solid::PointMotion motion = solid::make_motion(
        solid::StrainModel::corotational, solid::compute_deformation_gradient(corners, tet.gradient));
    const solid::Mat12 K = solid::compute_element_stiffness(tet, motion.R, C);
    const solid::Mat34 force =
        solid::compute_element_force(tet, solid::StrainModel::corotational, motion, Vec6::Zero(), elasticity);
    for (int i = 0; i < 4; ++i) {
      const int row = rows.of_node[static_cast<std::size_t>(elements.nodes(i, t))];
      if (row < 0) continue;
      impulse.col(row) += kStep * force.col(i);
      for (int j = 0; j < 4; ++j) {
        const int column = rows.of_node[static_cast<std::size_t>(elements.nodes(j, t))];
        if (column < 0) continue;
        matrix.block(linear::find_block(matrix, row, column)) += kStep * kStep * K.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
  for (int row = 0; row < matrix.num_rows(); ++row)
    matrix.block(matrix.diagonal[static_cast<std::size_t>(row)]).diagonal().array() +=
        solid.materials.mass()(rows.node[static_cast<std::size_t>(row)]);
  return matrix;
}

/// Share of each node in the load.
Field weigh(const Points& rest) {
  Field weight = Field::Zero(rest.cols());
  for (Eigen::Index n = 0; n < rest.cols(); ++n)
    if (rest(2, n) > 0.999 * kEdge)
      weight(n) = std::exp(-rest.col(n).head<2>().squaredNorm() / (2.0 * kSpot * kSpot));
  return weight / weight.sum();
}

StepStatus step(solid::Body& solid, solid::ActiveRegion& region, const solid::StepLoads& loads, int k,
                solid::SolidState& state) {
  ARGIL_TRY(solid::begin_step(solid, region, state, loads, {kStep, k * kStep, k}));
  for (bool solved = false; !solved;) {
    solved = solid::assemble(solid, region, loads);
    if (!solved) ARGIL_TRY(solid::solve(solid, region, loads, k, solved));
  }
  solid::take_velocity(solid, region.part(), state);
  solid::move(solid, region.part(), state);
  return solid::update_kinematics(solid, region, state.x, k);
}

Points rows_of(const Rows& rows, const Points& of_nodes) {
  Points of_rows(3, rows.pattern.num_rows());
  for (std::size_t row = 0; row < rows.node.size(); ++row)
    of_rows.col(static_cast<Eigen::Index>(row)) = of_nodes.col(rows.node[row]);
  return of_rows;
}

/// ‖x − change‖ / ‖x‖ for A x = b.
double compare(const StepSystem& system, const Points& change) {
  linear::MatrixOperator product(system.matrix, 1);
  linear::BlockJacobi jacobi(1);
  jacobi.update(system.matrix, product);
  Points x = Points::Zero(3, system.b.cols());
  const linear::SolveReport report =
      linear::ConjugateGradients(1).solve(product, jacobi, system.b, 1e-10, 1000, x);
  ARGIL_ASSERT(report.converged);
  return (x - change).norm() / x.norm();
}

}  // namespace

StepSystem make_pressed_cube(int target_tets) {
  const shapes::Shape cube{shapes::ShapeKind::box, kEdge, 1.0};
  mesh::TetMesh mesh = shapes::make_shape_mesh(cube, target_tets);
  mesh::sort_tets(mesh);  // as scenarios do
  solid::SolidParams params;
  params.solver.tolerance = 1e-10;
  solid::Support bottom;
  bottom.region.kind = solid::Region::Kind::plane;
  solid::Body solid(mesh, mesh::make_topology(mesh), {bottom}, params, 1);
  solid::ActiveRegion region(solid);
  for (int t = 0; t < mesh.num_tets(); ++t) solid::set_material(solid, region, t, {kLambda, kMu, 0.0});

  const Rows rows = number_rows(solid);
  const Field weight = weigh(solid.model.elements.rest);
  solid::SolidState state = solid::make_rest_state(solid.model);
  Points force = Points::Zero(3, state.x.cols());
  Points impulse;
  StepSystem system;
  system.num_tets = mesh.num_tets();
  system.rest = rows_of(rows, solid.model.elements.rest);
  StepStatus status = solid::update_kinematics(solid, region, state.x, 0);
  for (int k = 1; k <= kSteps && status.is_ok(); ++k) {
    force.row(2) = -kGrowth * k * kStep * weight.transpose();
    if (k == kSteps - kEarlier) system.before = assemble(solid, rows, state.x, impulse);
    if (k == kSteps) {  // b = h (f − f_int − h K v)
      system.matrix = assemble(solid, rows, state.x, impulse);
      const Points speed = rows_of(rows, state.v);
      Points product(3, speed.cols());
      linear::MatrixOperator(system.matrix, 1).multiply(speed, product);
      for (Eigen::Index row = 0; row < speed.cols(); ++row)
        product.col(row) -= solid.materials.mass()(rows.node[static_cast<std::size_t>(row)]) * speed.col(row);
      system.b = kStep * rows_of(rows, force) - impulse - product;
    }
    const Points speed = state.v;
    status = step(solid, region, {force}, k, state);
    if (k == kSteps) system.off = compare(system, rows_of(rows, state.v - speed));
  }
  ARGIL_ASSERT(status.is_ok());
  return system;
}

}  // namespace argil::bench
