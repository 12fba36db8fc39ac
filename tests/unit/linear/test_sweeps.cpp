// Sweeps in floats against dense matrices of Eigen's, taken apart by hand.
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/rng.h"
#include "linear/pcg.h"
#include "linear/short_blocks.h"
#include "linear/short_iteration.h"

namespace argil::linear {
namespace {

/// Nodes of a box, each coupled with the 26 around it: blocks without any symmetry, and the diagonal so much
/// larger that the whole is positive definite, but not by far.
BlockMatrix make_box(int edge, std::uint64_t seed) {
  const auto number = [edge](int i, int j, int k) { return (i * edge + j) * edge + k; };
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(edge * edge * edge));
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j)
      for (int k = 0; k < edge; ++k)
        for (int a = std::max(0, i - 1); a <= std::min(edge - 1, i + 1); ++a)
          for (int b = std::max(0, j - 1); b <= std::min(edge - 1, j + 1); ++b)
            for (int c = std::max(0, k - 1); c <= std::min(edge - 1, k + 1); ++c)
              neighbours[static_cast<std::size_t>(number(i, j, k))].push_back(number(a, b, c));
  BlockMatrix matrix = make_block_matrix(neighbours);
  Rng rng(seed);
  for (int row = 0; row < matrix.num_rows(); ++row)
    for (const int column : neighbours[static_cast<std::size_t>(row)]) {
      if (column < row) continue;
      Mat3 block;
      for (int i = 0; i < 9; ++i) block(i) = rng.uniform(-1.0, 0.0);
      if (column == row) block = Mat3(block + block.transpose() + 46.0 * Mat3::Identity());
      matrix.block(find_block(matrix, row, column)) = block;
      matrix.block(find_block(matrix, column, row)) = block.transpose();
    }
  return matrix;
}

/// Its blocks of neighbouring rows alone.
BlockMatrix make_chain_of(const BlockMatrix& matrix) {
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(matrix.num_rows()));
  for (int row = 0; row < matrix.num_rows(); ++row)
    for (const int column : {row - 1, row, row + 1})
      if (column >= 0 && find_block(matrix, row, column) >= 0)
        neighbours[static_cast<std::size_t>(row)].push_back(column);
  BlockMatrix chain = make_block_matrix(neighbours);
  for (int row = 0; row < matrix.num_rows(); ++row)
    for (const int column : neighbours[static_cast<std::size_t>(row)])
      chain.block(find_block(chain, row, column)) = matrix.block(find_block(matrix, row, column));
  return chain;
}

Eigen::MatrixXd to_dense(const BlockMatrix& a) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * a.num_rows(), 3 * a.num_rows());
  for (int row = 0; row < a.num_rows(); ++row)
    for (int column = 0; column < a.num_rows(); ++column) {
      const int b = find_block(a, row, column);
      if (b >= 0) dense.block<3, 3>(3 * row, 3 * column) = a.block(b);
    }
  return dense;
}

Eigen::VectorXd make_random_vector(int rows, std::uint64_t seed) {
  Rng rng(seed);
  Eigen::VectorXd b(3 * rows);
  for (double& number : b) number = rng.uniform(-1.0, 1.0);
  return b;
}

/// A vector with four floats a row.
std::vector<float> to_fours(const Eigen::VectorXd& x) {
  std::vector<float> fours;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    fours.push_back(static_cast<float>(x(i)));
    if (i % 3 == 2) fours.push_back(0.0F);
  }
  return fours;
}
Eigen::VectorXd from_fours(const std::vector<float>& fours) {
  const Eigen::Map<const Eigen::Matrix4Xf> columns(fours.data(), 4,
                                                   static_cast<Eigen::Index>(fours.size()) / 4);
  EXPECT_TRUE(columns.row(3).isZero(0.0F));
  return columns.topRows<3>().cast<double>().reshaped();
}

std::vector<int> list_runs(int begin, int end) {
  std::vector<int> runs;
  for (int run = begin; run < end; ++run) runs.push_back(run);
  return runs;
}

/// The blocks of A that sweeps meet going forth: those of the rows gone over before.
Eigen::MatrixXd take_lower(const Eigen::MatrixXd& A, const SweepOrder& order) {
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(A.rows(), A.cols());
  for (std::size_t i = 0; i < order.rows().size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Eigen::Index row = 3 * order.rows()[i], column = 3 * order.rows()[k];
      lower.block<3, 3>(row, column) = A.block<3, 3>(row, column);
    }
  return lower;
}

void expect_near(const Eigen::VectorXd& got, const Eigen::VectorXd& expected) {
  EXPECT_LT((got - expected).norm(), 2e-6 * expected.norm());
}

TEST(SweepOrder, HasEveryRowOnceAndGroupsThatDoNotCouple) {
  const BlockMatrix matrix = make_box(9, 1);
  const std::vector<int> part = list_runs(10, 80);
  SweepOrder order;
  order.prepare(matrix);
  for (const std::vector<int>* runs : {static_cast<const std::vector<int>*>(nullptr), &part}) {
    order.arrange(matrix, runs);
    const int num_rows = runs ? 8 * 70 : 729;
    EXPECT_EQ(std::set<int>(order.rows().begin(), order.rows().end()).size(),
              static_cast<std::size_t>(num_rows));
    ASSERT_EQ(order.end(SweepOrder::kLast), num_rows);
    EXPECT_NEAR(order.end(0) - order.begin(0), order.end(1) - order.begin(1), 0.1 * num_rows);
    EXPECT_LT(order.end(SweepOrder::kLast) - order.begin(SweepOrder::kLast), 0.25 * num_rows);
    for (int i = order.begin(0); i < order.end(0); ++i)
      for (int k = order.begin(1); k < order.end(1); ++k)
        ASSERT_EQ(find_block(matrix, order.rows()[static_cast<std::size_t>(i)],
                             order.rows()[static_cast<std::size_t>(k)]),
                  -1);
    for (std::size_t i = 1; i < order.rows().size(); ++i)
      EXPECT_TRUE(order.is_before(order.rows()[i - 1], order.rows()[i]));
  }
}

TEST(SweepOrder, LeavesFewRowsInOneGroup) {
  const BlockMatrix matrix = make_box(7, 1);
  SweepOrder order;
  order.prepare(matrix);
  order.arrange(matrix, nullptr);
  EXPECT_EQ(order.end(0), 343);
  EXPECT_EQ(order.end(SweepOrder::kLast), 343);
}

class ShortRowsOfABox : public testing::Test {
 protected:
  void SetUp() override {
    MatrixOperator product(m_matrix, 1);
    m_blocks.update(m_matrix, product, OrderedRuns(1));
    m_order = &m_blocks.order();
  }
  int num_rows() const { return m_matrix.num_rows(); }

  const BlockMatrix m_matrix = make_box(9, 2);
  const Eigen::MatrixXd m_dense = to_dense(m_matrix);
  ShortBlocks m_blocks;
  const SweepOrder* m_order = nullptr;
};

TEST_F(ShortRowsOfABox, MultiplyAsADenseMatrix) {
  const Eigen::VectorXd x[3] = {make_random_vector(num_rows(), 3), make_random_vector(num_rows(), 4),
                                make_random_vector(num_rows(), 5)};
  const std::vector<float> fours[3] = {to_fours(x[0]), to_fours(x[1]), to_fours(x[2])};
  std::vector<float> y[3] = {fours[0], fours[0], fours[0]};
  const double dot = multiply(m_blocks.rows(), 0, num_rows(), fours[0].data(), y[0].data());
  expect_near(from_fours(y[0]), m_dense * x[0]);
  EXPECT_NEAR(dot, x[0].dot(m_dense * x[0]), 1e-5 * dot);
  multiply_three(m_blocks.rows(), 0, num_rows(), {fours[0].data(), fours[1].data(), fours[2].data()},
                 {y[0].data(), y[1].data(), y[2].data()});
  for (int k = 0; k < 3; ++k) expect_near(from_fours(y[k]), m_dense * x[k]);
}

TEST_F(ShortRowsOfABox, SolveTheirTrianglesBySweeps) {
  const Eigen::MatrixXd lower = take_lower(m_dense, *m_order);
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(m_dense.rows(), m_dense.cols());
  for (int row = 0; row < num_rows(); ++row)
    D.block<3, 3>(3 * row, 3 * row) = m_dense.block<3, 3>(3 * row, 3 * row);
  ASSERT_TRUE((lower + D + lower.transpose()).isApprox(m_dense, 1e-15));
  const auto order_of = [&](int group) { return std::pair(m_order->begin(group), m_order->end(group)); };
  const int* rows = m_order->rows().data();

  const Eigen::VectorXd r = make_random_vector(num_rows(), 6);
  std::vector<float> rho(to_fours(r).size());
  Substituted sums;
  for (const int group : {1, 0, SweepOrder::kLast}) {  // the two do not see one another
    const auto [begin, end] = order_of(group);
    const Substituted sum = substitute(m_blocks.rows(), rows, begin, end, to_fours(r).data(), rho.data());
    sums.squares += sum.squares;
    sums.scaled += sum.scaled;
  }
  const Eigen::VectorXd expected_rho = (D + lower).partialPivLu().solve(r);
  expect_near(from_fours(rho), expected_rho);
  EXPECT_NEAR(sums.squares, r.squaredNorm(), 1e-5 * sums.squares);
  EXPECT_NEAR(sums.scaled, expected_rho.dot(D * expected_rho), 1e-5 * sums.scaled);
  EXPECT_NEAR(compute_squares(m_blocks.rows(), 0, num_rows(), rho.data()), r.squaredNorm(),
              1e-5 * r.squaredNorm());

  const Eigen::VectorXd old_p = make_random_vector(num_rows(), 7);
  std::vector<float> p = to_fours(old_p), t(p.size()), s(p.size()), x(p.size());
  for (const int group : {SweepOrder::kLast, 0, 1})
    sweep_back(m_blocks.rows(), rows, order_of(group).first, order_of(group).second, 0.5F, rho.data(),
               p.data(), t.data());
  double curvature = 0.0;
  for (const int group : {0, 1, SweepOrder::kLast})
    curvature += sweep_forth(m_blocks.rows(), rows, order_of(group).first, order_of(group).second, p.data(),
                             t.data(), s.data());
  const Eigen::VectorXd expected_p = expected_rho + 0.5 * old_p;
  const Eigen::VectorXd expected_t = (D + lower.transpose()).partialPivLu().solve(D * expected_p);
  expect_near(from_fours(p), expected_p);
  expect_near(from_fours(t), expected_t);
  EXPECT_NEAR(curvature, expected_t.dot(m_dense * expected_t), 1e-5 * curvature);

  const double scaled =
      advance(m_blocks.rows(), 0, num_rows(), 0.25F, t.data(), s.data(), x.data(), rho.data());
  const Eigen::VectorXd next = (D + lower).partialPivLu().solve(r - 0.25 * (m_dense * expected_t));
  expect_near(from_fours(x), 0.25 * expected_t);
  expect_near(from_fours(rho), next);
  EXPECT_NEAR(scaled, next.dot(D * next), 1e-5 * scaled);
}

TEST(ShortIteration, SweepsNeedHalfTheIterationsOfDiagonalBlocks) {
  const BlockMatrix matrix = make_box(9, 8);
  const Points b = make_random_vector(matrix.num_rows(), 9).reshaped(3, matrix.num_rows());
  MatrixOperator product(matrix, 1);
  BlockJacobi jacobi(1);
  jacobi.update(matrix, product);
  Points x = Points::Zero(3, b.cols());
  const SolveReport by_blocks = ConjugateGradients(1).solve(product, jacobi, b, 1e-4, 200, x);
  x.setZero();
  const SolveReport by_sweeps = ShortIteration(1).solve(matrix, product, b, 1e-4, 200, x);
  ASSERT_TRUE(by_blocks.converged && by_sweeps.converged);
  EXPECT_GT(by_blocks.iterations, 8);
  EXPECT_LT(by_sweeps.iterations, 0.7 * by_blocks.iterations);
  EXPECT_LT((to_dense(matrix) * x.reshaped() - b.reshaped()).norm(), 1.001e-4 * b.norm());
}

TEST(ShortIteration, SolvesForSomeRowsAsIfThereWereNoOthers) {
  const BlockMatrix matrix = make_box(9, 10);
  const Eigen::MatrixXd dense = to_dense(matrix);
  const Points b = make_random_vector(matrix.num_rows(), 11).reshaped(3, matrix.num_rows());
  std::vector<Points> of_one_thread;
  for (const int threads : {1, 2, 3}) {
    ShortIteration iteration(threads);
    std::size_t number = 0;
    for (const auto& [first, last] :
         {std::pair(0, 92), std::pair(0, 30), std::pair(12, 84), std::pair(0, 92)}) {
      const std::vector<int> runs = list_runs(first, last);
      const Eigen::Index begin = 24 * first;
      const Eigen::Index size = std::min(Eigen::Index{24} * last, dense.rows()) - begin;
      iteration.restrict_to(&runs);
      MatrixOperator product(matrix, 1);
      Points x = Points::Zero(3, b.cols());
      ASSERT_TRUE(iteration.solve(matrix, product, b, 1e-4, 100, x).converged);
      const Eigen::VectorXd inside = x.reshaped().segment(begin, size);
      Points outside = x;
      outside.reshaped().segment(begin, size).setZero();
      EXPECT_TRUE(outside.isZero(0.0));
      const Eigen::VectorXd rest =
          b.reshaped().segment(begin, size) - dense.block(begin, begin, size, size) * inside;
      EXPECT_LT(rest.norm(), 1.001e-4 * b.reshaped().segment(begin, size).norm());
      if (threads == 1) of_one_thread.push_back(x);
      EXPECT_TRUE((x.array() == of_one_thread[number++].array()).all()) << threads;
    }
  }
}

TEST(ShortIteration, TakesAMatrixWhosePatternHasGrown) {
  BlockMatrix matrix = make_chain_of(make_box(9, 17));
  const Points b = make_random_vector(matrix.num_rows(), 18).reshaped(3, matrix.num_rows());
  ShortIteration iteration(1);
  for (int step = 0; step < 2; ++step) {
    MatrixOperator product(matrix, 1);
    Points x = Points::Zero(3, b.cols());
    ASSERT_TRUE(iteration.solve(matrix, product, b, 1e-4, 100, x).converged);
    EXPECT_LT((to_dense(matrix) * x.reshaped() - b.reshaped()).norm(), 1.001e-4 * b.norm());
    matrix = make_box(9, 17);
  }
}

/// Stored blocks and a far larger u uᵀ: what the stored ones give of the curvature is what is
/// left when the large ones cancel.
class WithStiffPart final : public Operator {
 public:
  WithStiffPart(const BlockMatrix& stored, Eigen::MatrixXd stiff)
      : m_stored(stored, 1), m_stiff(std::move(stiff)) {}
  double multiply(const Points& x, Points& y) override {
    m_stored.multiply(x, y);
    y.reshaped() += m_stiff * (m_stiff.transpose() * x.reshaped());
    return x.cwiseProduct(y).sum();
  }
  bool has_unstored() const override { return true; }
  double add_unstored(const float* x, float* y) override {
    const Eigen::Index num_rows = m_stiff.rows() / 3;
    const Eigen::Map<const Eigen::Matrix4Xf> at(x, 4, num_rows);
    const Eigen::VectorXd along = m_stiff.transpose() * at.topRows<3>().cast<double>().reshaped();
    const Eigen::VectorXf added = (m_stiff * along).cast<float>();
    Eigen::Map<Eigen::Matrix4Xf>(y, 4, num_rows).topRows<3>() += added.reshaped(3, num_rows);
    return along.squaredNorm();
  }
  void add_unstored_diagonal(Eigen::Matrix3Xd& blocks) override {
    for (Eigen::Index row = 0; row < m_stiff.rows() / 3; ++row)
      blocks.middleCols<3>(3 * row) +=
          m_stiff.middleRows<3>(3 * row) * m_stiff.middleRows<3>(3 * row).transpose();
  }

 private:
  MatrixOperator m_stored;
  Eigen::MatrixXd m_stiff;
};

TEST(ShortIteration, TakesAPartThatIsNotStoredAndFarLarger) {
  const BlockMatrix matrix = make_box(9, 12);
  const int num_rows = matrix.num_rows();
  Eigen::MatrixXd stiff(3 * num_rows, 3);
  for (int k = 0; k < 3; ++k)
    stiff.col(k) = 30.0 * make_random_vector(num_rows, 13 + static_cast<unsigned>(k));
  const Points b = make_random_vector(num_rows, 16).reshaped(3, num_rows);
  WithStiffPart product(matrix, stiff);
  ShortIteration iteration(1);
  for (int solve = 0; solve < 2; ++solve) {
    Points x = Points::Zero(3, num_rows);
    const SolveReport report = iteration.solve(matrix, product, b, 1e-2, 400, x);
    ASSERT_TRUE(report.converged) << report.iterations << " " << report.relative_residual;
    Points y(3, num_rows);
    product.multiply(x, y);
    EXPECT_LT((y - b).norm(), 1.5e-2 * b.norm());
  }
}

}  // namespace
}  // namespace argil::linear
