#include "linear/short_iteration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "linear/vectors.h"

namespace argil::linear {

SolveReport ShortIteration::solve(const BlockMatrix& matrix, Operator& whole, const Points& b,
                                  double tolerance, int max_iterations, Points& x, double goal) {
  constexpr double kRounding = 1e-14;  // of ‖b‖
  const std::ptrdiff_t num_rows = b.cols();
  prepare(matrix);
  if (m_is_changed) {
    clear_left_rows();
    m_blocks.restrict_to(m_list);
  }
  m_is_changed = false;
  m_sums.resize(static_cast<std::size_t>(m_runs.count_runs(num_rows)));

  const double first = find_residual(whole, b, x);
  const double squares_of_b = m_runs.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return compute_dot(b.data(), b.data(), begin, end);
  });
  const double rounding = kRounding * std::sqrt(squares_of_b);
  if (!std::isfinite(first)) return {false, 0, std::numeric_limits<double>::quiet_NaN()};
  if (first <= rounding) return {true, 0, 0.0};
  if (first <= goal) return {true, 0, 1.0, first};

  m_blocks.update(matrix, whole, m_runs);
  const double share = std::max({tolerance, rounding / first, goal / first});
  SolveReport report = iterate(whole, first, share, max_iterations, true);
  add_to(x, first);
  if (report.converged) m_last.keep(m_runs, num_rows, m_x.data(), first);
  // Rounding grows with the iterations: after many of them what is left is taken in double, and they go on
  // from there.
  constexpr int kTrusted = 50;
  constexpr double kWorthwhile = 0.5;  // of what was left, for another round
  constexpr double kAim = 0.4;         // of what is wanted: less than that, lest a round ends just short
  for (double before = std::numeric_limits<double>::infinity();
       report.converged && report.iterations > kTrusted;) {
    const double left = find_residual(whole, b, x);
    report.relative_residual = left / first;
    report.converged = report.relative_residual <= share;
    if (report.converged || !(left < kWorthwhile * before) || report.iterations >= max_iterations) break;
    before = left;
    const SolveReport more =
        iterate(whole, left, kAim * share * first / left, max_iterations - report.iterations, false);
    add_to(x, left);
    report.iterations += more.iterations;
    report.relative_residual = more.relative_residual * left / first;
    report.converged = more.converged;
  }
  if (!report.converged) m_last.clear(0, num_rows);
  report.first = first;
  return report;
}

/// ‖b − A x‖ in double, which m_product becomes.
double ShortIteration::find_residual(Operator& whole, const Points& b, const Points& x) {
  whole.multiply(x, m_product);
  return std::sqrt(m_runs.sum(b.cols(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    m_product.middleCols(begin, end - begin) =
        b.middleCols(begin, end - begin) - m_product.middleCols(begin, end - begin);
    return compute_dot(m_product.data(), m_product.data(), begin, end);
  }));
}

/// x += scale · what the iteration found.
void ShortIteration::add_to(Points& x, double scale) const {
  m_runs.each(x.cols(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 3; ++k)
        x.data()[3 * row + k] += scale * static_cast<double>(m_x.data()[4 * row + k]);
  });
}

void ShortIteration::serialize(Archive& archive, const std::string& prefix) {
  m_last.serialize(archive, prefix);
  if (archive.is_restoring()) m_is_changed = m_has_solved_all = true;
}

void ShortIteration::roll_back() {
  m_last.roll_back();
  m_is_changed = m_has_solved_all = true;
}

void ShortIteration::prepare(const BlockMatrix& pattern) {
  const auto num_rows = static_cast<std::size_t>(pattern.num_rows());
  for (std::vector<float>* vector : {&m_r, &m_t, &m_s, &m_p, &m_rho, &m_x}) vector->resize(4 * num_rows);
  const auto num_runs = static_cast<std::size_t>(OrderedRuns::count_all_runs(pattern.num_rows()));
  m_runs.prepare(pattern.num_rows());
  m_sums.reserve(num_runs);
  m_solved.reserve(num_runs);
  m_last.prepare(pattern.num_rows());
  m_product.resize(3, pattern.num_rows());
  m_blocks.prepare(pattern);
}

void ShortIteration::restrict_to(const std::vector<int>* runs) {
  m_runs.restrict_to(runs);
  m_list = runs;
  m_is_changed = true;
}

/// Rows beside those that are listed are read: what the last solve left there goes.
void ShortIteration::clear_left_rows() {
  constexpr std::ptrdiff_t length = OrderedRuns::kLength;
  const auto size = static_cast<std::ptrdiff_t>(m_t.size() / 4);
  const auto clear = [&](int run) {
    const std::ptrdiff_t begin = run * length;
    const std::ptrdiff_t end = std::min(begin + length, size);
    for (std::vector<float>* vector : {&m_t, &m_s, &m_rho})
      std::fill(vector->begin() + 4 * begin, vector->begin() + 4 * end, 0.0F);
    m_last.clear(begin, end);
  };
  const auto is_listed = [&](int run) {
    return !m_list || std::binary_search(m_list->begin(), m_list->end(), run);
  };
  for (const int run : m_solved)
    if (!is_listed(run)) clear(run);
  for (int run = 0; m_has_solved_all && m_list && run * length < size; ++run)
    if (!is_listed(run)) clear(run);
  m_has_solved_all = m_list == nullptr;
  m_solved.clear();
  if (m_list) m_solved = *m_list;
}

/// A x = r / `first`, which has the norm 1, until what is left of it is below `goal`.
/// `begins`: with what the last solves added.
SolveReport ShortIteration::iterate(Operator& whole, double first, double goal, int max_iterations,
                                    bool begins) {
  const std::ptrdiff_t num_rows = m_product.cols();
  m_runs.each(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 4; ++k)
        m_r.data()[4 * row + k] = k < 3 ? static_cast<float>(m_product.data()[3 * row + k] / first) : 0.0F;
    for (std::vector<float>* vector : {&m_x, &m_t, &m_p, &m_rho, &m_s})
      std::fill(vector->begin() + 4 * begin, vector->begin() + 4 * end, 0.0F);
  });
  LastChanges::Start start;
  if (begins) start = m_last.begin(m_blocks.rows(), whole, m_runs, num_rows, m_x.data(), m_r.data());
  return whole.has_unstored() ? iterate_over_blocks(whole, start, goal, max_iterations)
                              : sweep(start, goal, max_iterations);
}

/// body(group) of those that do not couple, each by itself.
template <class Body>
void ShortIteration::each_group(Body body) {
  const SweepOrder& order = m_blocks.order();
  const bool is_shared = order.begin(1) < order.end(1);
  parallel_for(SweepOrder::kGroups, is_shared ? m_threads : 1,
               [&](std::ptrdiff_t group) { body(static_cast<int>(group)); });
}

Substituted ShortIteration::substitute_groups() {
  const ShortRows a = m_blocks.rows();
  const SweepOrder& order = m_blocks.order();
  Substituted sums[SweepOrder::kGroups + 1];
  const auto substitute_group = [&](int group) {
    sums[group] =
        substitute(a, order.rows().data(), order.begin(group), order.end(group), m_r.data(), m_rho.data());
  };
  each_group(substitute_group);
  substitute_group(SweepOrder::kLast);
  Substituted total;
  for (const Substituted& sum : sums) {
    total.squares += sum.squares;
    total.scaled += sum.scaled;
  }
  return total;
}

/// p = ρ + β p, t = (1+U)⁻¹ p, s = (1+L)⁻¹ (p − t); returns t·A t. A group goes back and forth at once: it
/// meets no other but the last, which has gone back before and goes forth after.
double ShortIteration::sweep_groups(float beta) {
  const ShortRows a = m_blocks.rows();
  const SweepOrder& order = m_blocks.order();
  const int* rows = order.rows().data();
  const auto go_back = [&](int group) {
    sweep_back(a, rows, order.begin(group), order.end(group), beta, m_rho.data(), m_p.data(), m_t.data());
  };
  const auto go_forth = [&](int group) {
    return sweep_forth(a, rows, order.begin(group), order.end(group), m_p.data(), m_t.data(), m_s.data());
  };
  double curvatures[SweepOrder::kGroups];
  go_back(SweepOrder::kLast);
  each_group([&](int group) {
    go_back(group);
    curvatures[group] = go_forth(group);
  });
  double curvature = go_forth(SweepOrder::kLast);
  for (const double of_group : curvatures) curvature += of_group;
  return curvature;
}

/// By sweeps. Iterations know ‖ρ‖ in the norm of D; when that is so small that the residual should be, by
/// what the two were at last, the residual is taken: half a product.
SolveReport ShortIteration::sweep(const LastChanges::Start& start, double goal, int max_iterations) {
  const std::ptrdiff_t num_rows = m_product.cols();
  const ShortRows a = m_blocks.rows();
  const auto compute_residual = [&] {
    return std::sqrt(m_runs.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      return compute_squares(a, begin, end, m_rho.data());
    }));
  };
  const Substituted substituted = substitute_groups();
  double scaled = substituted.scaled;  // ρ·D ρ
  double residual = std::sqrt(substituted.squares);
  double ratio = residual / std::sqrt(scaled);
  double last_scaled = std::numeric_limits<double>::infinity();  // later directions know nothing of the first
  double energy = start.energy;
  int iterations = start.products;
  bool is_positive = true;
  // Written so that a NaN residual leaves the loop as not converged.
  while (residual > goal && iterations < max_iterations) {
    const double curvature = sweep_groups(static_cast<float>(scaled / last_scaled));
    is_positive = curvature > 0.0;
    if (!is_positive) break;
    const double alpha = scaled / curvature;
    last_scaled = scaled;
    scaled = m_runs.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      return advance(a, begin, end, static_cast<float>(alpha), m_t.data(), m_s.data(), m_x.data(),
                     m_rho.data());
    });
    energy += alpha * last_scaled;
    ++iterations;
    residual = ratio * std::sqrt(scaled);
    if (residual > goal && iterations < max_iterations) continue;
    residual = compute_residual();
    ratio = residual / std::sqrt(scaled);
  }
  m_last.judge(start, energy);
  return {is_positive && residual <= goal, iterations,
          is_positive ? residual : std::numeric_limits<double>::infinity()};
}

/// Over the diagonal blocks; goes over the rows twice an iteration.
SolveReport ShortIteration::iterate_over_blocks(Operator& whole, const LastChanges::Start& start, double goal,
                                                int max_iterations) {
  const std::ptrdiff_t num_rows = m_product.cols();
  const ShortRows a = m_blocks.rows();
  const ShortIterate to{m_p.data(), m_rho.data(), m_x.data(), m_r.data()};
  ShortSums sums;
  const auto advance = [&](double alpha, double beta) {
    m_runs.each_run(num_rows, [&](std::ptrdiff_t i, std::ptrdiff_t begin, std::ptrdiff_t end) {
      m_sums[static_cast<std::size_t>(i)] = advance_blocks(
          a, begin, end, static_cast<float>(alpha), static_cast<float>(beta), m_t.data(), m_s.data(), to);
    });
    // What other threads have read is written anew only when the next product passes over it.
    m_t.swap(m_s);
    sums = {};
    for (const ShortSums& run : m_sums) {
      sums.rr += run.rr;
      sums.rz += run.rz;
    }
  };
  advance(0.0, 0.0);  // z = D⁻¹ r
  double residual = std::sqrt(sums.rr);
  double energy = start.energy;
  double last_rz = std::numeric_limits<double>::infinity();
  double curvature = 0.0;  // p·A p, by the recurrence that holds while directions are conjugate
  int iterations = start.products;
  bool is_positive = true;
  while (residual > goal && iterations < max_iterations) {
    double product = m_runs.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      return multiply(a, begin, end, m_t.data(), m_s.data());
    });
    product += whole.add_unstored(m_t.data(), m_s.data());
    const double beta = sums.rz / last_rz;
    last_rz = sums.rz;
    curvature = product - beta * beta * curvature;
    is_positive = curvature > 0.0;
    if (!is_positive) break;
    advance(last_rz / curvature, beta);
    energy += last_rz * last_rz / curvature;
    residual = std::sqrt(sums.rr);
    ++iterations;
  }
  m_last.judge(start, energy);
  return {is_positive && residual <= goal, iterations,
          is_positive ? residual : std::numeric_limits<double>::infinity()};
}

}  // namespace argil::linear
