// Points of 10-node tets, eight at a time, and what their nodes make of them, against shape functions whose
// slopes are found by differences and the law of a single point.
#include "solid/quadratic_lanes.h"

#include <Eigen/Geometry>

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/mandel.h"
#include "base/ordered_loops.h"
#include "base/rng.h"
#include "mesh/quadratic.h"
#include "solid/element.h"
#include "solid/elements.h"
#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

constexpr int kTets = 5;  // the last one alone in its lanes
constexpr int kPoints = 4 * kTets;
using NodeGradients = Eigen::Matrix<double, 3, 10>;

/// Tets of different shapes, each turned, stretched and bent.
struct QuadraticTets {
  StrainModel model;
  Elements elements;
  Points x{3, 10 * kTets};
  std::vector<NodeGradients> node_gradients;  // of each point
  Eigen::Matrix3Xd gradient{3, 4 * kPoints}, R{3, 3 * kPoints}, F{3, 3 * kPoints}, frame{3, 3 * kPoints},
      turned{3, 4 * kPoints};
  TensorField strain{6, kPoints}, plastic{6, kPoints};
  Field weight{kPoints}, lambda{kPoints}, mu{kPoints}, volume_ratio{kPoints};
  std::vector<char> is_turned = std::vector<char>(kTets, 0);

  explicit QuadraticTets(StrainModel of) : model(of) {
    elements.nodes_per_tet = 10;
    elements.points_per_tet = 4;
    elements.nodes.resize(10, kTets);
    frame.setZero();
    Rng rng(5);
    for (int t = 0; t < kTets; ++t) {
      Mat34 rest;
      rest << 0, 1, 0.1, 0.2, 0, 0.1, 1.2, 0.3, 0, -0.1, 0.2, 0.9;
      for (int i = 0; i < 12; ++i) rest(i) += rng.uniform(-0.1, 0.1);
      const TetGeometry tet = make_tet_geometry(rest);
      const Vec3 turn(rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0));
      Mat3 motion = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
      for (int k = 0; k < 9; ++k) motion(k) += rng.uniform(-0.15, 0.15);
      for (int i = 0; i < 10; ++i) {
        Vec3 place =
            i < 4 ? Vec3(rest.col(i))
                  : Vec3(0.5 * (rest.col(mesh::kTetEdges[i - 4][0]) + rest.col(mesh::kTetEdges[i - 4][1])));
        for (int k = 0; k < 3; ++k) place(k) += rng.uniform(-0.02, 0.02);
        elements.nodes(i, t) = 10 * t + i;
        x.col(10 * t + i) = motion * place;
      }
      for (int p = 4 * t; p < 4 * (t + 1); ++p) set_point(p, tet, rng);
    }
  }
  void set_point(int p, const TetGeometry& tet, Rng& rng) {
    gradient.middleCols<4>(4 * p) = tet.gradient;
    weight(p) = tet.volume / 4.0;
    lambda(p) = rng.uniform(1e3, 1e5);
    mu(p) = rng.uniform(1e3, 1e5);
    for (int k = 0; k < 6; ++k)
      plastic(k, p) = find_law(model).plastic_split == PlasticSplit::none ? 0.0 : rng.uniform(-0.1, 0.1);
    plastic.col(p).head<3>().array() -= plastic.col(p).head<3>().sum() / 3.0;
    Vec4 place = Vec4::Constant((5.0 - std::sqrt(5.0)) / 20.0);
    place(p % 4) = (5.0 + 3.0 * std::sqrt(5.0)) / 20.0;
    NodeGradients of_nodes = NodeGradients::Zero();
    constexpr double kStep = 0.1;  // of functions of degree 2 differences are exact
    for (int a = 0; a < 4; ++a) {
      const Vec4 step = kStep * Vec4::Unit(a);
      of_nodes +=
          tet.gradient.col(a) *
          ((mesh::compute_quadratic_shape(place + step) - mesh::compute_quadratic_shape(place - step)) /
           (2.0 * kStep))
              .transpose();
    }
    node_gradients.push_back(of_nodes);
  }
  void move() {
    const PointArrays points{x.data(),
                             elements.nodes.data(),
                             gradient.data(),
                             find_law(model).is_linear,
                             F.data(),
                             R.data(),
                             turned.data(),
                             frame.data(),
                             0.0,
                             strain.data(),
                             volume_ratio.data(),
                             is_turned.data()};
    OrderedRuns(1).each(kPoints, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      compute_quadratic_motions(points, begin, end);
    });
  }
  Mat3 find_deformation(int p) const {
    Mat3 sum = Mat3::Zero();
    for (int i = 0; i < 10; ++i)
      sum += x.col(elements.nodes(i, p / 4)) * node_gradients[static_cast<std::size_t>(p)].col(i).transpose();
    return sum;
  }
  Elasticity elasticity(int p) const { return {lambda(p), mu(p)}; }
};

class QuadraticLanes : public testing::TestWithParam<StrainModel> {
 protected:
  QuadraticLanes() { tets.move(); }
  const NodeGradients& gradients(int p) const { return tets.node_gradients[static_cast<std::size_t>(p)]; }
  PointMotion motion(int p) const { return make_motion(GetParam(), tets.find_deformation(p)); }
  QuadraticTets tets{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Laws, QuadraticLanes,
                         testing::Values(StrainModel::corotational, StrainModel::linear, StrainModel::hencky,
                                         StrainModel::curnier),
                         [](const auto& law) { return std::string(find_law(law.param).name); });

TEST_P(QuadraticLanes, MoveAsShapeFunctionsDo) {
  for (int p = 0; p < kPoints; ++p) {
    const PointMotion expected = motion(p);
    EXPECT_LT((tets.F.middleCols<3>(3 * p) - expected.F).norm(), 1e-13) << p;
    EXPECT_LT((tets.R.middleCols<3>(3 * p) - expected.R).norm(), 1e-13) << p;
    EXPECT_LT((tets.strain.col(p) - compute_strain(expected.F, expected.R)).norm(), 1e-13) << p;
    EXPECT_NEAR(tets.volume_ratio(p), expected.F.determinant(), 1e-13) << p;
    EXPECT_LT((find_node_gradients<10>(tets.gradient, p) - gradients(p)).norm(), 1e-13) << p;
  }
  EXPECT_EQ(tets.is_turned, std::vector<char>(kTets, 1));
}

TEST_P(QuadraticLanes, PressTheirNodesByTheWorkOfThePoints) {
  Eigen::Matrix3Xd of_points(3, 4 * kPoints), of_nodes(3, 10 * kTets);
  const ForceArrays points{tets.gradient.data(),
                           tets.R.data(),
                           tets.strain.data(),
                           tets.plastic.data(),
                           tets.weight.data(),
                           tets.lambda.data(),
                           tets.mu.data(),
                           nullptr,
                           find_law(GetParam()).is_linear,
                           of_points.data()};
  OrderedRuns(1).each(kPoints, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    find_law(GetParam()).lanes.forces(points, begin, end);
  });
  set_node_forces(of_points.data(), 0, kTets, of_nodes.data());
  for (int t = 0; t < kTets; ++t) {
    NodeGradients expected = NodeGradients::Zero();
    for (int p = 4 * t; p < 4 * (t + 1); ++p)
      expected += tets.weight(p) *
                  compute_piola(GetParam(), motion(p), tets.plastic.col(p), tets.elasticity(p)) *
                  gradients(p);
    EXPECT_LT((of_nodes.middleCols<10>(10 * t) - expected).norm(), 1e-12 * expected.norm()) << t;
  }
}

TEST_P(QuadraticLanes, AreAsStiffAsTheirPoints) {
  const ElasticLaw& law = find_law(GetParam());
  const double exact = law.is_quadratic ? 0.0 : 0.7, kept = 0.2;
  Eigen::Matrix<double, 9, Eigen::Dynamic> of_points(9, kPairBlocks * kPoints),
      of_nodes(9, kQuadraticPairs * kTets);
  const TangentArrays points{tets.gradient.data(),
                             law.is_quadratic ? tets.R.data() : tets.F.data(),
                             tets.plastic.data(),
                             tets.weight.data(),
                             tets.lambda.data(),
                             tets.mu.data(),
                             exact,
                             kept,
                             of_points.data(),
                             nullptr};
  OrderedRuns(1).each(
      kPoints, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { law.lanes.stiffness(points, begin, end); });
  set_node_pairs(of_points.data(), 0, kTets, of_nodes.data());
  for (int t = 0; t < kTets; ++t) {
    Eigen::Matrix<double, 30, 30> expected = Eigen::Matrix<double, 30, 30>::Zero();
    for (int p = 4 * t; p < 4 * (t + 1); ++p) {
      const Elasticity e = tets.elasticity(p);
      const Mat9 A = exact == 0.0
                         ? Mat9::Zero()
                         : Mat9(compute_positive_tangent(GetParam(), motion(p), tets.plastic.col(p), e));
      // The rest's own stiffness in the frame of R: that of a law that is linear in the turned strain.
      const Mat6 C = make_isotropic_stiffness(e.lambda, e.mu);
      const Mat3 rotation = motion(p).R;
      for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j) {
          Mat3 block = exact * compute_tangent_block(gradients(p).col(i), A, gradients(p).col(j));
          for (int s = 0; s < 3; ++s) {
            const Mat3 H = rotation.transpose() * Vec3::Unit(s) * gradients(p).col(j).transpose();
            const Mat3 stress = from_mandel(C * to_mandel(0.5 * (H + H.transpose())));
            block.col(s) += kept * rotation * stress * gradients(p).col(i);
          }
          expected.block<3, 3>(3 * i, 3 * j) += tets.weight(p) * block;
        }
    }
    for (int i = 0; i < 10; ++i)
      for (int j = i + 1; j < 10; ++j) {
        const Mat3 block = of_nodes.col(kQuadraticPairs * t + find_pair<10>(i, j)).reshaped(3, 3);
        EXPECT_LT((block - expected.block<3, 3>(3 * i, 3 * j)).norm(), 1e-12 * expected.norm())
            << t << i << j;
      }
  }
}

TEST(FindPair, NumbersThePairsOfTheNodesOnce) {
  int next = 0;
  for (int i = 0; i < 10; ++i)
    for (int j = i + 1; j < 10; ++j, ++next) {
      EXPECT_EQ(find_pair<10>(i, j), next);
      EXPECT_EQ(find_pair<10>(j, i), next);
    }
  EXPECT_EQ(next, kQuadraticPairs);
}

}  // namespace
}  // namespace argil::solid
