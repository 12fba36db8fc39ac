#include "linear/solver.h"

#include <cmath>
#include <limits>
#include <optional>

#include "linear/pcg.h"
#include "linear/short_iteration.h"

namespace argil::linear {
namespace {

constexpr double kNotPositive = std::numeric_limits<double>::infinity();

/// A direct solve has no tolerance; one this far off comes from a matrix that is singular in all but name.
constexpr double kUsable = 1e-3;

double count_entries(const BlockMatrix& matrix) {
  return 9.0 * matrix.num_blocks();
}

double compute_relative_residual(Operator& product, const Points& b, const Points& x, Points& work) {
  const double b_norm = b.norm();
  if (b_norm == 0.0) return 0.0;
  work.resize(3, b.cols());
  product.multiply(x, work);
  return (b - work).norm() / b_norm;
}

/// A factor and the values that it stands for.
class KnownFactor {
 public:
  explicit KnownFactor(FactorKind kind = FactorKind::simplicial) : m_kind(kind) {}

  bool exists() const { return m_factorised.cols() > 0; }
  bool is_of(const BlockMatrix& matrix) const {
    return m_factorised.size() == matrix.values.size() &&
           (m_factorised.array() == matrix.values.array()).all();
  }
  CholeskyFactor& factor() { return *m_factor; }
  /// False when the matrix is not positive definite; then there is none.
  bool factorise(const BlockMatrix& matrix) {
    if (!m_factor) m_factor.emplace(matrix, m_kind);
    if (!m_has_changed) m_committed.swap(m_factorised);
    m_has_changed = true;
    const bool is_positive = m_factor->factorise(matrix);
    if (is_positive)
      m_factorised = matrix.values;
    else
      m_factorised.resize(3, 0);
    return is_positive;
  }
  void serialize(Archive& archive, const std::string& prefix, const BlockMatrix& pattern) {
    archive.any_size(prefix + "factorised", m_factorised);
    if (archive.is_restoring()) make_anew(pattern);
  }
  void commit() { m_has_changed = false; }
  void roll_back(const BlockMatrix& pattern) {
    if (!m_has_changed) return;
    m_committed.swap(m_factorised);
    make_anew(pattern);
    m_has_changed = false;
  }

 private:
  /// From the values that it stands for: the same bits.
  void make_anew(const BlockMatrix& pattern) {
    if (!exists()) return;
    BlockMatrix matrix = pattern;
    matrix.values = m_factorised;
    if (!m_factor) m_factor.emplace(pattern, m_kind);
    if (!m_factor->factorise(matrix)) m_factorised.resize(3, 0);
  }

  FactorKind m_kind;
  std::optional<CholeskyFactor> m_factor;
  Eigen::Matrix3Xd m_factorised;  // none without a factor
  Eigen::Matrix3Xd m_committed;   // at the last commit, where that has changed
  bool m_has_changed = false;
};

/// A factor of the very matrix: renewed when any number in it changed.
class DirectSolver final : public Solver {
 public:
  explicit DirectSolver(FactorKind kind) : m_known(kind) {}

  SolveReport solve(const BlockMatrix& matrix, Operator& product, const Points& b, Points& x) override {
    if (!m_known.is_of(matrix)) {
      ++m_cost.factorisations;
      if (!m_known.factorise(matrix)) return {false, 0, kNotPositive};
    }
    m_known.factor().solve(b, x);
    ++m_cost.solves;
    m_cost.multiplications += 2.0 * m_known.factor().num_entries();
    const double residual = compute_relative_residual(product, b, x, m_work);
    return {residual <= kUsable, 0, residual};  // a NaN is not
  }

  void serialize(Archive& archive, const std::string& prefix, const BlockMatrix& pattern) override {
    Solver::serialize(archive, prefix, pattern);
    m_known.serialize(archive, prefix, pattern);
  }
  void commit() override {
    Solver::commit();
    m_known.commit();
  }
  void roll_back(const BlockMatrix& pattern) override {
    Solver::roll_back(pattern);
    m_known.roll_back(pattern);
  }

 private:
  KnownFactor m_known;
  Points m_work;
};

/// Conjugate gradients over the diagonal blocks, in floats where the tolerance leaves room for their rounding
/// and the matrix is stored.
class JacobiIteration {
 public:
  JacobiIteration(const SolverParams& params, int threads)
      : m_tolerance(params.tolerance),
        m_is_short(params.tolerance >= kRoomForFloats && params.kind != SolverKind::pcg_matrix_free),
        m_short(threads),
        m_jacobi(threads),
        m_iteration(threads) {}

  SolveReport solve(const BlockMatrix& matrix, Operator& product, const Points& b, int max_iterations,
                    double goal, Points& x) {
    if (m_is_short) return m_short.solve(matrix, product, b, m_tolerance, max_iterations, x, goal);
    m_jacobi.update(matrix, product);
    return m_iteration.solve(product, m_jacobi, b, m_tolerance, max_iterations, x, goal);
  }
  void prepare(const BlockMatrix& pattern) {
    if (m_is_short) {
      m_short.prepare(pattern);
    } else {
      m_jacobi.prepare(pattern.num_rows());
      m_iteration.prepare(pattern.num_rows());
    }
  }
  /// Does it round the matrix to floats?
  bool is_short() const { return m_is_short; }
  bool restrict_to(const std::vector<int>* runs) {
    if (m_is_short) m_short.restrict_to(runs);
    return m_is_short;
  }
  void serialize(Archive& archive, const std::string& prefix) {
    if (m_is_short) m_short.serialize(archive, prefix);
  }
  void commit() { m_short.commit(); }
  void roll_back() { m_short.roll_back(); }

 private:
  double m_tolerance;
  bool m_is_short;
  ShortIteration m_short;
  BlockJacobi m_jacobi;
  ConjugateGradients m_iteration;
};

class JacobiSolver final : public Solver {
 public:
  JacobiSolver(const SolverParams& params, int threads) : m_params(params), m_iteration(params, threads) {}

  SolveReport solve(const BlockMatrix& matrix, Operator& product, const Points& b, Points& x) override {
    const SolveReport report = m_iteration.solve(matrix, product, b, m_params.max_iterations, m_goal, x);
    ++m_cost.solves;
    m_cost.iterations += report.iterations;
    m_cost.multiplications += (report.iterations + 1.0) * count_entries(matrix);
    return report;
  }
  void prepare(const BlockMatrix& pattern) override { m_iteration.prepare(pattern); }
  bool restrict_to(const std::vector<int>* runs) override { return m_iteration.restrict_to(runs); }
  void serialize(Archive& archive, const std::string& prefix, const BlockMatrix& pattern) override {
    Solver::serialize(archive, prefix, pattern);
    m_iteration.serialize(archive, prefix);
  }
  void commit() override {
    Solver::commit();
    m_iteration.commit();
  }
  void roll_back(const BlockMatrix& pattern) override {
    Solver::roll_back(pattern);
    m_iteration.roll_back();
  }

 private:
  SolverParams m_params;
  JacobiIteration m_iteration;
};

/// The factor of an earlier matrix preconditions; it is renewed when the last solve with it was slow, for
/// then the matrix has moved away from it, and at once when a solve with it fails. `pcg` does without a
/// factor until a solve is long, below which its triangular solves cost more than they save, or meets a
/// matrix that is not positive definite once it is rounded to floats.
class KeptFactorSolver final : public Solver {
 public:
  KeptFactorSolver(const SolverParams& params, int threads)
      : m_params(params), m_rows(threads), m_jacobi(params, threads), m_iteration(threads) {
    m_use.has_factor = params.kind == SolverKind::pcg_cholesky;
    m_committed_use = m_use;
  }

  SolveReport solve(const BlockMatrix& matrix, Operator& product, const Points& b, Points& x) override {
    if (!m_is_part) m_guess = x;
    ++m_cost.solves;
    if (!m_use.has_factor) {
      const int max_iterations = m_is_part ? m_params.max_iterations : m_params.jacobi_iterations;
      const SolveReport report = m_jacobi.solve(matrix, product, b, max_iterations, m_goal, x);
      m_cost.iterations += report.iterations;
      m_cost.multiplications += (report.iterations + 1.0) * count_entries(matrix);
      // What doubles call indefinite a factor does, too; and nothing solves for what is no number.
      const bool is_indefinite = std::isinf(report.relative_residual) && !m_jacobi.is_short();
      const bool is_no_number = std::isnan(report.relative_residual) && report.iterations == 0;
      if (report.converged || m_is_part || is_indefinite || is_no_number) return report;
      if (product.has_unstored())
        return {false, report.iterations, report.relative_residual, report.first, true};
      m_use.has_factor = true;
      x = m_guess;
    }
    const bool is_slow = m_use.last_iterations > m_params.refactor_iterations;
    if ((!m_known.exists() || is_slow) && !factorise(matrix)) return {false, 0, kNotPositive};
    const bool was_fresh = m_use.is_fresh;
    SolveReport report = iterate(product, b, x);
    if (!report.converged && !was_fresh) {
      if (!factorise(matrix)) return {false, 0, kNotPositive};
      x = m_guess;
      report = iterate(product, b, x);
    }
    m_cost.multiplications +=
        (report.iterations + 1.0) * (count_entries(matrix) + 2.0 * m_known.factor().num_entries());
    m_cost.iterations += report.iterations;
    return report;
  }

  void prepare(const BlockMatrix& pattern) override {
    m_guess.resize(3, pattern.num_rows());
    if (!m_use.has_factor) m_jacobi.prepare(pattern);
  }

  bool restrict_to(const std::vector<int>* runs) override {
    const bool is_restricted = m_jacobi.restrict_to(runs);
    m_is_part = runs != nullptr && !m_use.has_factor && is_restricted;
    return m_is_part;
  }

  void serialize(Archive& archive, const std::string& prefix, const BlockMatrix& pattern) override {
    Solver::serialize(archive, prefix, pattern);
    archive.number(prefix + "has_factor", m_use.has_factor);
    if (!m_use.has_factor) m_jacobi.serialize(archive, prefix);
    archive.number(prefix + "last_iterations", m_use.last_iterations);
    archive.number(prefix + "is_fresh", m_use.is_fresh);
    m_known.serialize(archive, prefix, pattern);
  }
  void commit() override {
    Solver::commit();
    m_jacobi.commit();
    m_known.commit();
    m_committed_use = m_use;
  }
  void roll_back(const BlockMatrix& pattern) override {
    Solver::roll_back(pattern);
    m_jacobi.roll_back();
    m_known.roll_back(pattern);
    m_use = m_committed_use;
  }

 private:
  bool factorise(const BlockMatrix& matrix) {
    ++m_cost.factorisations;
    m_use.is_fresh = true;
    return m_known.factorise(matrix);
  }
  SolveReport iterate(Operator& product, const Points& b, Points& x) {
    StaleCholesky kept(m_known.factor(), m_rows);
    const SolveReport report =
        m_iteration.solve(product, kept, b, m_params.tolerance, m_params.max_iterations, x, m_goal);
    m_use.last_iterations = report.iterations;
    m_use.is_fresh = false;
    return report;
  }

  SolverParams m_params;
  OrderedRuns m_rows;
  JacobiIteration m_jacobi;
  KnownFactor m_known;
  ConjugateGradients m_iteration;
  Points m_guess;
  bool m_is_part = false;  // of the system is solved; a factor is of the whole
  struct Use {
    bool has_factor = false;  // or does without as yet
    bool is_fresh = false;    // the factor: no solve has gone by it
    int last_iterations = 0;
  };
  Use m_use, m_committed_use;
};

}  // namespace

void Solver::serialize(Archive& archive, const std::string& prefix, const BlockMatrix&) {
  archive.number(prefix + "solves", m_cost.solves);
  archive.number(prefix + "iterations", m_cost.iterations);
  archive.number(prefix + "factorisations", m_cost.factorisations);
  archive.number(prefix + "multiplications", m_cost.multiplications);
}

std::unique_ptr<Solver> make_solver(const SolverParams& params, int threads) {
  switch (params.kind) {
    case SolverKind::cholesky:
      return std::make_unique<DirectSolver>(FactorKind::simplicial);
    case SolverKind::supernodal:
      return std::make_unique<DirectSolver>(FactorKind::supernodal);
    case SolverKind::pcg_jacobi:
    case SolverKind::pcg_matrix_free:
      return std::make_unique<JacobiSolver>(params, threads);
    case SolverKind::pcg:
    case SolverKind::pcg_cholesky:
      break;
  }
  return std::make_unique<KeptFactorSolver>(params, threads);
}

}  // namespace argil::linear
