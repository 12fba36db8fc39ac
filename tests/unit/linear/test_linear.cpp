// Solvers against the closed-form solution of a 1-D Laplacian and against Eigen's dense LDLᵀ, which shares no
// code with them.
#include <cmath>
#include <limits>
#include <new>

#include <SuiteSparse_config.h>

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "base/rng.h"
#include "linear/pcg.h"
#include "linear/short_iteration.h"
#include "linear/solver.h"

namespace argil::linear {
namespace {

BlockMatrix make_chain(int rows) {
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(rows));
  for (int r = 0; r < rows; ++r)
    for (int c = std::max(0, r - 1); c <= std::min(rows - 1, r + 1); ++c)
      neighbours[static_cast<std::size_t>(r)].push_back(c);
  return make_block_matrix(neighbours);
}

/// −u'' = 1 on [0, 1] with u = 0 at both ends; the nodal values of u = x(1−x)/2 are exact.
BlockMatrix make_laplacian(int rows) {
  BlockMatrix a = make_chain(rows);
  const double h = 1.0 / (rows + 1);
  for (int r = 0; r < rows; ++r)
    for (int b = a.row_begin[static_cast<std::size_t>(r)]; b < a.row_begin[static_cast<std::size_t>(r) + 1];
         ++b)
      a.block(b) = Mat3::Identity() * ((a.column[static_cast<std::size_t>(b)] == r ? 2.0 : -1.0) / (h * h));
  return a;
}

/// Random symmetric diagonally dominant matrix, with every coupling between the three components present.
BlockMatrix make_random_spd(int rows, std::uint64_t seed) {
  BlockMatrix a = make_chain(rows);
  Rng rng(seed);
  for (int r = 0; r < rows; ++r) {
    for (int c = r; c <= std::min(rows - 1, r + 1); ++c) {
      Mat3 block;
      for (int i = 0; i < 9; ++i) block(i) = rng.uniform(-1.0, 1.0);
      if (c == r) block = Mat3(block + block.transpose()) + 12.0 * Mat3::Identity();
      a.block(find_block(a, r, c)) = block;
      a.block(find_block(a, c, r)) = block.transpose();
    }
  }
  return a;
}

Eigen::MatrixXd to_dense(const BlockMatrix& a) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * a.num_rows(), 3 * a.num_rows());
  for (int r = 0; r < a.num_rows(); ++r)
    for (int b = a.row_begin[static_cast<std::size_t>(r)]; b < a.row_begin[static_cast<std::size_t>(r) + 1];
         ++b)
      dense.block<3, 3>(3 * r, 3 * a.column[static_cast<std::size_t>(b)]) = a.block(b);
  return dense;
}

Points make_random_vector(int rows, std::uint64_t seed) {
  Rng rng(seed);
  Points b(3, rows);
  for (Eigen::Index i = 0; i < b.size(); ++i) b(i) = rng.uniform(-1.0, 1.0);
  return b;
}

SolveReport solve(ConjugateGradients& cg, const BlockMatrix& a, Preconditioner& preconditioner,
                  const Points& b, double tolerance, int max_iterations, int threads, Points& x) {
  MatrixOperator product(a, threads);
  return cg.solve(product, preconditioner, b, tolerance, max_iterations, x);
}

void update(BlockJacobi& jacobi, const BlockMatrix& a) {
  MatrixOperator product(a, 1);
  jacobi.update(a, product);
}

/// A stored matrix and u uᵀ, which is not stored and joins all rows.
class WithOuterProduct final : public Operator {
 public:
  WithOuterProduct(const BlockMatrix& stored, Points u) : m_stored(stored, 1), m_u(std::move(u)) {}
  double multiply(const Points& x, Points& y) override {
    const double dot = m_stored.multiply(x, y);
    const double along = m_u.cwiseProduct(x).sum();
    y += along * m_u;
    return dot + along * along;
  }
  bool has_unstored() const override { return true; }
  double add_unstored(const float* x, float* y) override {
    const Eigen::Map<const Eigen::Matrix4Xf> at(x, 4, m_u.cols());
    const Eigen::Matrix3Xf u = m_u.cast<float>();
    const float along = u.cwiseProduct(at.topRows<3>()).sum();
    Eigen::Map<Eigen::Matrix4Xf>(y, 4, m_u.cols()).topRows<3>() += along * u;
    return static_cast<double>(along * along);
  }
  void add_unstored_diagonal(Eigen::Matrix3Xd& blocks) override {
    for (Eigen::Index row = 0; row < m_u.cols(); ++row)
      blocks.middleCols<3>(3 * row) += m_u.col(row) * m_u.col(row).transpose();
  }

 private:
  MatrixOperator m_stored;
  Points m_u;
};

TEST(CholeskyFactor, SolvesTheOneDimensionalLaplacianExactly) {
  const int rows = 99;
  const BlockMatrix a = make_laplacian(rows);
  CholeskyFactor factor(a);
  ASSERT_TRUE(factor.factorise(a));
  Points u;
  factor.solve(Points::Ones(3, rows), u);
  for (int r = 0; r < rows; ++r) {
    const double x = (r + 1.0) / (rows + 1);
    EXPECT_NEAR(u(1, r), 0.5 * x * (1.0 - x), 1e-12) << r;  // rounding: condition number times ε
  }
}

TEST(CholeskyFactor, AgreesWithADenseFactorisation) {
  const BlockMatrix a = make_random_spd(40, 1);
  const Points b = make_random_vector(40, 2);
  const Eigen::VectorXd expected = to_dense(a).ldlt().solve(b.reshaped());
  CholeskyFactor factor(a);
  ASSERT_TRUE(factor.factorise(a));
  Points x;
  factor.solve(b, x);
  EXPECT_LT((x.reshaped() - expected).norm(), 1e-13 * expected.norm());
}

TEST(CholeskyFactor, RefusesAnIndefiniteMatrix) {
  BlockMatrix a = make_random_spd(10, 3);
  a.block(find_block(a, 4, 4))(1, 1) = -20.0;
  CholeskyFactor factor(a);
  EXPECT_FALSE(factor.factorise(a));
}

TEST(BlockMatrix, MultipliesAsADenseMatrixDoes) {
  for (const int rows : {1, 2, 31, 32, 33, 100}) {
    const BlockMatrix a = make_random_spd(rows, 21);
    const Points x = make_random_vector(rows, 22);
    Points y(3, rows);
    OrderedRuns runs(3);
    const double dot = multiply(a, x, y, runs);
    const Eigen::VectorXd expected = to_dense(a) * x.reshaped();
    EXPECT_LT((y.reshaped() - expected).norm(), 1e-14 * expected.norm()) << rows;
    EXPECT_NEAR(dot, expected.dot(x.reshaped()), 1e-13 * expected.norm() * x.norm()) << rows;
  }
}

TEST(ConjugateGradients, MeasuresTheResidualByThatOfTheFirstGuess) {
  // Gravity on a body that already flies fast: what is new is small beside b, and must not be lost.
  const BlockMatrix a = make_random_spd(50, 23);
  const Points before = 1e4 * make_random_vector(50, 24);
  const Points change = make_random_vector(50, 25);
  Points b(3, 50);
  b.reshaped() = to_dense(a) * (before + change).reshaped();
  BlockJacobi jacobi(1);
  update(jacobi, a);
  ConjugateGradients cg(1);
  Points x = before;
  const SolveReport report = solve(cg, a, jacobi, b, 1e-3, 100, 1, x);
  EXPECT_TRUE(report.converged);
  EXPECT_GT(report.iterations, 0);
  EXPECT_LT((x - before - change).norm(), 3e-3 * change.norm());  // condition number 3 of D⁻¹A
}

TEST(ConjugateGradients, StopsWhereRoundingLeavesNoMore) {
  const BlockMatrix a = make_random_spd(50, 26);
  Points x = make_random_vector(50, 27);
  Points b(3, 50);
  b.reshaped() = to_dense(a) * x.reshaped();
  BlockJacobi jacobi(1);
  update(jacobi, a);
  ConjugateGradients cg(1);
  const SolveReport report = solve(cg, a, jacobi, b, 1e-8, 100, 1, x);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
}

TEST(ConjugateGradients, BlockJacobiReachesTheToleranceOfATrueResidual) {
  const BlockMatrix a = make_random_spd(200, 4);
  const Points b = make_random_vector(200, 5);
  BlockJacobi jacobi(1);
  update(jacobi, a);
  ConjugateGradients cg(1);
  Points x = Points::Zero(3, 200);
  const SolveReport report = solve(cg, a, jacobi, b, 1e-10, 200, 1, x);
  EXPECT_TRUE(report.converged);
  EXPECT_LT((to_dense(a) * x.reshaped() - b.reshaped()).norm(), 1.01e-10 * b.norm());
}

TEST(ConjugateGradients, ExactFactorConvergesInOneIterationAndAStaleOneInFew) {
  const BlockMatrix a = make_random_spd(100, 6);
  BlockMatrix later = a;
  later.values *= 1.0 + 1e-3;
  for (int r = 0; r < 100; r += 7) later.block(later.diagonal[static_cast<std::size_t>(r)]) *= 1.05;
  const Points b = make_random_vector(100, 7);
  CholeskyFactor factor(a);
  ASSERT_TRUE(factor.factorise(a));
  OrderedRuns rows(1);
  StaleCholesky stale(factor, rows);
  ConjugateGradients cg(1);
  Points x = Points::Zero(3, 100);
  EXPECT_EQ(solve(cg, a, stale, b, 1e-10, 50, 1, x).iterations, 1);
  x.setZero();
  EXPECT_LE(solve(cg, later, stale, b, 1e-10, 50, 1, x).iterations, 8);
  EXPECT_LT((to_dense(later) * x.reshaped() - b.reshaped()).norm(), 1.01e-10 * b.norm());
}

TEST(ConjugateGradients, ReportsWhenItDoesNotConverge) {
  const BlockMatrix a = make_laplacian(300);
  BlockJacobi jacobi(1);
  update(jacobi, a);
  ConjugateGradients cg(1);
  Points x = Points::Zero(3, 300);
  const SolveReport report = solve(cg, a, jacobi, Points::Ones(3, 300), 1e-12, 5, 1, x);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 5);
}

TEST(ConjugateGradients, GivesEqualBitsOnAnyNumberOfThreads) {
  const BlockMatrix a = make_laplacian(500);
  BlockJacobi jacobi(1);
  update(jacobi, a);
  const Points b = make_random_vector(500, 8);
  Points first = Points::Zero(3, 500);
  ConjugateGradients cg(1);
  static_cast<void>(solve(cg, a, jacobi, b, 1e-10, 700, 1, first));
  for (const int threads : {2, 4, 7}) {
    Points x = Points::Zero(3, 500);
    static_cast<void>(solve(cg, a, jacobi, b, 1e-10, 700, threads, x));
    EXPECT_TRUE((x.array() == first.array()).all()) << threads << " threads";
  }
}

class EverySolver : public testing::TestWithParam<SolverKind> {};

TEST_P(EverySolver, SolvesAgainAndAgainWhileTheMatrixChanges) {
  if (GetParam() == SolverKind::pcg_matrix_free) GTEST_SKIP() << "its matrix holds diagonal blocks only";
  SolverParams params;
  params.kind = GetParam();
  params.tolerance = 1e-12;
  const auto solver = make_solver(params);
  BlockMatrix a = make_random_spd(120, 9);
  for (int step = 0; step < 6; ++step) {
    for (int r = 0; r < 120; ++r) a.block(a.diagonal[static_cast<std::size_t>(r)]) *= 1.0 + 0.1 * (r % 3);
    const Points b = make_random_vector(120, 10 + static_cast<std::uint64_t>(step));
    MatrixOperator product(a, 1);
    Points x = Points::Zero(3, 120);
    const SolveReport report = solver->solve(a, product, b, x);
    ASSERT_TRUE(report.converged) << step;
    EXPECT_LT((to_dense(a) * x.reshaped() - b.reshaped()).norm(), 2e-12 * b.norm()) << step;
    EXPECT_LT(report.relative_residual, 1.01e-12);
  }
  EXPECT_EQ(solver->cost().solves, 6);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySolver,
                         testing::Values(SolverKind::pcg, SolverKind::pcg_cholesky, SolverKind::pcg_jacobi,
                                         SolverKind::cholesky, SolverKind::supernodal));

/// A goal ends an iteration early, at a residual that is no larger; a first guess that has reached it stays.
TEST(IterativeSolver, StopsAtAGoalBeforeItsTolerance) {
  const Points b = make_random_vector(300, 43);
  for (const double tolerance : {1e-3, 1e-8}) {  // in floats, in double
    for (const SolverKind kind : {SolverKind::pcg_jacobi, SolverKind::pcg_cholesky}) {
      BlockMatrix a;
      Points x;
      const auto solve = [&](double goal) {
        a = make_random_spd(300, 41);
        MatrixOperator product(a, 1);
        const auto solver = make_solver({.kind = kind, .tolerance = tolerance});
        x = Points::Zero(3, 300);
        solver->solve(a, product, make_random_vector(300, 42), x);  // pcg_cholesky: a factor of this matrix
        for (std::size_t r = 0; r < 300; ++r) {
          a.block(a.diagonal[r]) *= 1.0 + 0.5 * static_cast<double>(r % 3);
          ++a.revision[r];
        }
        solver->set_goal(goal * b.norm());
        x.setZero();
        return solver->solve(a, product, b, x);
      };
      const SolveReport early = solve(0.1);
      EXPECT_TRUE(early.converged);
      EXPECT_LE((to_dense(a) * x.reshaped() - b.reshaped()).norm(), 0.1001 * b.norm());
      EXPECT_NEAR(early.first, b.norm(), 1e-12 * b.norm());
      const SolveReport whole = solve(0.0);
      EXPECT_LT(early.iterations, whole.iterations);
      EXPECT_LE(whole.relative_residual, tolerance);
      const SolveReport none = solve(1.0001);
      EXPECT_TRUE(none.converged);
      EXPECT_EQ(none.iterations, 0);
      EXPECT_TRUE(x.isZero(0.0));
    }
  }
}

TEST(IterativeSolver, TakesWhatTheMatrixDoesNotStore) {
  const BlockMatrix a = make_random_spd(60, 28);
  const Points u = 2.0 * make_random_vector(60, 29);
  const Points b = make_random_vector(60, 30);
  const Eigen::MatrixXd whole = to_dense(a) + u.reshaped() * u.reshaped().transpose();
  WithOuterProduct product(a, u);
  for (const SolverKind kind : {SolverKind::pcg, SolverKind::pcg_jacobi})
    for (const double tolerance : {1e-3, 1e-10})  // in floats and in double
      for (const int jacobi_iterations : {150, 2}) {
        const auto solver =
            make_solver({.kind = kind, .tolerance = tolerance, .jacobi_iterations = jacobi_iterations});
        Points x = Points::Zero(3, 60);
        const SolveReport report = solver->solve(a, product, b, x);
        const bool wants_factor = kind == SolverKind::pcg && jacobi_iterations == 2;  // of all of it
        EXPECT_EQ(report.wants_stored, wants_factor);
        ASSERT_EQ(report.converged, !wants_factor);
        if (wants_factor) continue;
        EXPECT_LT((whole * x.reshaped() - b.reshaped()).norm(), 1.01 * tolerance * b.norm());
      }
}

TEST(ShortIteration, TakesTheRowsThatChangedAndGivesEqualBitsOnAnyNumberOfThreads) {
  const Points b = make_random_vector(500, 31);
  Points first;
  for (const int threads : {1, 2, 4, 7}) {
    BlockMatrix a = make_random_spd(500, 32);
    ShortIteration iteration(threads);
    Points x;
    for (int step = 0; step < 4; ++step) {
      for (std::size_t r = static_cast<std::size_t>(step); r < 500; r += 5) {
        a.block(a.diagonal[r]) *= 1.5;
        ++a.revision[r];
      }
      MatrixOperator product(a, threads);
      x = Points::Zero(3, 500);
      ASSERT_TRUE(iteration.solve(a, product, b, 1e-5, 100, x).converged);
      EXPECT_LT((to_dense(a) * x.reshaped() - b.reshaped()).norm(), 1.1e-5 * b.norm()) << step;
    }
    if (threads == 1) first = x;
    EXPECT_TRUE((x.array() == first.array()).all()) << threads;
  }
}

/// Systems of successive steps have like solutions: a solve begins with the best of what the last three
/// added.
class BeginsWithTheLastChanges : public testing::Test {
 protected:
  int count_iterations(const Points& b) {
    Points x = Points::Zero(3, 60);
    const SolveReport report = m_iteration.solve(m_matrix, m_product, b, kTolerance, 100, x);
    EXPECT_TRUE(report.converged);
    EXPECT_NEAR(report.first, b.norm(), 1e-12 * b.norm());
    EXPECT_LT((to_dense(m_matrix) * x.reshaped() - b.reshaped()).norm(), 1.1 * kTolerance * b.norm());
    return report.iterations;
  }
  static constexpr double kTolerance = 1e-4;
  static constexpr int kProducts = 3;

 private:
  const BlockMatrix m_matrix = make_laplacian(60);
  MatrixOperator m_product{m_matrix, 1};
  ShortIteration m_iteration{1};
};

TEST_F(BeginsWithTheLastChanges, OfASolutionThatIsLikeTheLast) {
  const Points b = make_random_vector(60, 36);
  const int cold = count_iterations(b);
  EXPECT_GT(cold, 20);
  EXPECT_EQ(count_iterations(-3.0 * b), kProducts);   // the very direction
  EXPECT_EQ(count_iterations(1e-50 * b), kProducts);  // beyond what a float holds
  EXPECT_EQ(count_iterations(1e60 * b), kProducts);
  for (const double size : {1e40, 1e20, 1e10, 1.0})  // each change small beside the one before
    EXPECT_EQ(count_iterations(size * b), kProducts) << size;
  EXPECT_LT(count_iterations(b + 0.001 * make_random_vector(60, 37)), cold - 10);
  EXPECT_LE(count_iterations(make_random_vector(60, 38)), cold + kProducts);  // of no use, in no one's way
}

TEST_F(BeginsWithTheLastChanges, OfSolutionsThatGoOnAsASquareOfTime) {
  const Points b = make_random_vector(60, 36);
  const Points speed = make_random_vector(60, 37);
  const Points acceleration = make_random_vector(60, 38);
  std::vector<int> iterations;
  for (const double t : {1.0, 1.1, 1.2, 1.3, 1.4, 1.5})
    iterations.push_back(count_iterations(b + t * speed + t * t * acceleration));
  EXPECT_GT(iterations[0], 20);
  for (std::size_t i = 3; i < iterations.size(); ++i) EXPECT_LE(iterations[i], 10) << i;
}

TEST(ShortIteration, TakesNumbersOfAnySize) {
  const BlockMatrix a = make_random_spd(50, 33);
  for (const double size : {1e-60, 1e60}) {  // beyond what a float holds
    const Points b = size * make_random_vector(50, 34);
    MatrixOperator product(a, 1);
    ShortIteration iteration(1);
    Points x = Points::Zero(3, 50);
    ASSERT_TRUE(iteration.solve(a, product, b, 1e-4, 100, x).converged);
    EXPECT_LT((to_dense(a) * x.reshaped() - b.reshaped()).norm(), 1.1e-4 * b.norm());
  }
}

TEST(DirectSolver, FactorisesOnlyWhenTheMatrixChanged) {
  const auto solver = make_solver({SolverKind::cholesky});
  BlockMatrix a = make_random_spd(30, 11);
  MatrixOperator product(a, 1);
  Points x = Points::Zero(3, 30);
  const Points b = make_random_vector(30, 12);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(solver->solve(a, product, b, x).converged);
  EXPECT_EQ(solver->cost().factorisations, 1);
  a.block(a.diagonal[7])(0, 0) = std::nextafter(a.block(a.diagonal[7])(0, 0), 100.0);
  ASSERT_TRUE(solver->solve(a, product, b, x).converged);
  EXPECT_EQ(solver->cost().factorisations, 2);
}

TEST(DirectSolver, RefusesAnIndefiniteMatrixInBothForms) {
  BlockMatrix a = make_random_spd(30, 13);
  a.block(a.diagonal[4])(1, 1) = -20.0;
  for (const SolverKind kind : {SolverKind::cholesky, SolverKind::supernodal, SolverKind::pcg_cholesky}) {
    const auto solver = make_solver({kind});
    MatrixOperator product(a, 1);
    Points x = Points::Zero(3, 30);
    EXPECT_FALSE(solver->solve(a, product, make_random_vector(30, 14), x).converged);
  }
}

TEST(DirectSolver, DoesNotCallASolutionConvergedThatIsNone) {
  const BlockMatrix a = make_random_spd(30, 17);
  MatrixOperator product(a, 1);
  Points b = make_random_vector(30, 18);
  b(1, 3) = std::nan("");
  for (const SolverKind kind : {SolverKind::cholesky, SolverKind::supernodal}) {
    Points x = Points::Zero(3, 30);
    EXPECT_FALSE(make_solver({kind})->solve(a, product, b, x).converged);
  }
}

TEST(Iterations, DoNotCallASolutionConvergedWhoseRightHandSideIsInfinite) {
  const BlockMatrix a = make_random_spd(30, 17);
  MatrixOperator product(a, 1);
  Points b = make_random_vector(30, 18);
  b(1, 3) = std::numeric_limits<double>::infinity();
  for (const SolverKind kind : {SolverKind::pcg, SolverKind::pcg_jacobi, SolverKind::pcg_cholesky})
    for (const double tolerance : {1e-2, 1e-8}) {
      SolverParams params;
      params.kind = kind;
      params.tolerance = tolerance;
      Points x = Points::Zero(3, 30);
      const SolveReport report = make_solver(params)->solve(a, product, b, x);
      EXPECT_FALSE(report.converged) << static_cast<int>(kind) << ' ' << tolerance;
      EXPECT_TRUE(std::isnan(report.relative_residual)) << static_cast<int>(kind) << ' ' << tolerance;
    }
}

TEST(SparseCholesky, SaysThatMemoryIsTooLittleAndNotThatTheMatrixIsIndefinite) {
  const BlockMatrix a = make_random_spd(300, 41);
  const auto fail = [](std::size_t) -> void* { return nullptr; };
  const auto fail_again = [](void*, std::size_t) -> void* { return nullptr; };
  CholeskyFactor factor(a);
  EXPECT_TRUE(factor.factorise(a));
  const auto kept = SuiteSparse_config;
  SuiteSparse_config.malloc_func = fail;
  SuiteSparse_config.realloc_func = fail_again;
  EXPECT_THROW(CholeskyFactor{a}, std::bad_alloc);
  EXPECT_THROW((void)factor.factorise(a), std::bad_alloc);
  SuiteSparse_config = kept;
}

TEST(JacobiSolver, SeesThatAMatrixIsNotPositiveDefinite) {
  // −A is solved as well as A by the same recurrence; its pᵀAp alone tells them apart.
  BlockMatrix a = make_random_spd(30, 19);
  a.values *= -1.0;
  MatrixOperator product(a, 1);
  Points x = Points::Zero(3, 30);
  const SolveReport report =
      make_solver({SolverKind::pcg_jacobi})->solve(a, product, make_random_vector(30, 20), x);
  EXPECT_FALSE(report.converged);
  EXPECT_TRUE(std::isinf(report.relative_residual));
}

TEST(Iterations, GoOnWhereManyOfThemInFloatsHaveLeftMoreThanTheyKnow) {
  const BlockMatrix a = make_laplacian(400);  // condition 6.5e4
  MatrixOperator product(a, 1);
  const Points b = Points::Ones(3, 400);
  SolverParams params;
  params.kind = SolverKind::pcg_jacobi;
  params.tolerance = kRoomForFloats;
  Points x = Points::Zero(3, 400);
  const SolveReport report = make_solver(params)->solve(a, product, b, x);
  Points Ax(3, 400);
  product.multiply(x, Ax);
  EXPECT_TRUE(report.converged);
  EXPECT_GT(report.iterations, 50);
  EXPECT_LE((b - Ax).norm(), params.tolerance * b.norm());
  EXPECT_NEAR(report.relative_residual, (b - Ax).norm() / b.norm(), 1e-3 * params.tolerance);
}

/// A path of springs that all but floats: the rounding of its diagonal to floats outweighs what holds it.
BlockMatrix make_floating_chain(int rows, std::uint64_t seed) {
  constexpr double kHeld = 1e-9;
  BlockMatrix a = make_chain(rows);
  a.values.setZero();
  for (const int b : a.diagonal) a.block(b) = Mat3::Identity() * kHeld;
  Rng rng(seed);
  for (int r = 0; r + 1 < rows; ++r) {
    const Mat3 spring = Mat3::Identity() * (1.0 + rng.uniform());
    a.block(a.diagonal[static_cast<std::size_t>(r)]) += spring;
    a.block(a.diagonal[static_cast<std::size_t>(r) + 1]) += spring;
    a.block(a.diagonal[static_cast<std::size_t>(r)] + 1) -= spring;
    a.block(a.diagonal[static_cast<std::size_t>(r) + 1] - 1) -= spring;
  }
  return a;
}

TEST(KeptFactorSolver, BringsInAFactorWhereTheRoundingOfFloatsMakesTheMatrixIndefinite) {
  SolverParams in_floats;
  in_floats.kind = SolverKind::pcg_jacobi;
  int indefinite = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const BlockMatrix a = make_floating_chain(30, seed);
    MatrixOperator product(a, 1);
    const Points b = Points::Ones(3, 30);  // rigid motion: x = 1 / kHeld
    Points x = Points::Zero(3, 30);
    indefinite += std::isinf(make_solver(in_floats)->solve(a, product, b, x).relative_residual) ? 1 : 0;
    x.setZero();
    EXPECT_TRUE(make_solver({})->solve(a, product, b, x).converged) << seed;
    EXPECT_NEAR(x(1, 7), 1e9, 1e9 * SolverParams{}.tolerance) << seed;
  }
  EXPECT_GE(indefinite, 5);
}

TEST(KeptFactorSolver, DoesNotFactoriseWhatDoublesCallIndefinite) {
  BlockMatrix a = make_random_spd(30, 19);
  a.values *= -1.0;
  MatrixOperator product(a, 1);
  SolverParams params;
  params.tolerance = 1e-8;
  const std::unique_ptr<Solver> solver = make_solver(params);
  Points x = Points::Zero(3, 30);
  EXPECT_TRUE(std::isinf(solver->solve(a, product, make_random_vector(30, 3), x).relative_residual));
  EXPECT_EQ(solver->cost().factorisations, 0);
}

TEST(KeptFactorSolver, BringsInAFactorWithTheFirstLongSolve) {
  SolverParams params;
  params.tolerance = 1e-8;
  params.jacobi_iterations = 40;
  const auto solver = make_solver(params);
  const auto iterations = [&](const BlockMatrix& a) {
    MatrixOperator product(a, 1);
    Points x = Points::Zero(3, 300);
    const SolveReport report = solver->solve(a, product, make_random_vector(300, 28), x);
    EXPECT_TRUE(report.converged);
    return report.iterations;
  };
  EXPECT_GT(iterations(make_random_spd(300, 29)), 1);
  EXPECT_EQ(solver->cost().factorisations, 0);
  EXPECT_LE(iterations(make_laplacian(300)), 1);  // over its diagonal: hundreds
  EXPECT_EQ(solver->cost().factorisations, 1);
  const std::int64_t before = solver->cost().iterations;
  EXPECT_LE(iterations(make_laplacian(300)), 1);
  EXPECT_LE(solver->cost().iterations, before + 1);  // and none over the diagonal any more
}

TEST(KeptFactorSolver, RenewsItsFactorAfterASlowSolveOnly) {
  SolverParams params;
  params.kind = SolverKind::pcg_cholesky;
  params.tolerance = 1e-8;
  params.refactor_iterations = 3;
  const auto solver = make_solver(params);
  BlockMatrix a = make_random_spd(100, 15);
  MatrixOperator product(a, 1);
  const Points b = make_random_vector(100, 16);
  Points x = Points::Zero(3, 100);
  for (int i = 0; i < 4; ++i) {
    x.setZero();
    ASSERT_TRUE(solver->solve(a, product, b, x).converged);
  }
  EXPECT_EQ(solver->cost().factorisations, 1);
  for (int r = 0; r < 100; r += 2) a.block(a.diagonal[static_cast<std::size_t>(r)]) *= 10.0;
  x.setZero();
  EXPECT_GT(solver->solve(a, product, b, x).iterations, 3);
  x.setZero();
  EXPECT_LE(solver->solve(a, product, b, x).iterations, 1);
  EXPECT_EQ(solver->cost().factorisations, 2);
}

}  // namespace
}  // namespace argil::linear
