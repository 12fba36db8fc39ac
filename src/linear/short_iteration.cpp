#include "linear/short_iteration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linear/vectors.h"

namespace argil::linear {

SolveReport ShortIteration::solve(const BlockMatrix& matrix, Operator& whole, const Points& b,
                                  double tolerance, int max_iterations, Points& x, double goal) {
  constexpr double kRounding = 1e-14;  // of ‖b‖
  const std::ptrdiff_t num_rows = b.cols();
  prepare(matrix);
  if (m_is_changed) clear_left_rows();
  m_is_changed = false;
  m_products.resize(static_cast<std::size_t>(m_runs.count_runs(num_rows)));
  m_sums.resize(m_products.size());

  whole.multiply(x, m_product);
  const double first = std::sqrt(m_runs.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    m_product.middleCols(begin, end - begin) =
        b.middleCols(begin, end - begin) - m_product.middleCols(begin, end - begin);
    return compute_dot(m_product.data(), m_product.data(), begin, end);
  }));
  const double squares_of_b = m_runs.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return compute_dot(b.data(), b.data(), begin, end);
  });
  const double rounding = kRounding * std::sqrt(squares_of_b);
  if (first <= rounding) return {true, 0, 0.0};
  if (first <= goal) return {true, 0, 1.0, first};
  if (!std::isfinite(first)) return {false, 0, std::numeric_limits<double>::quiet_NaN()};

  m_blocks.update(matrix, whole, m_runs);
  const double share = std::max({tolerance, rounding / first, goal / first});
  SolveReport report = iterate(whole, first, share, max_iterations);
  report.first = first;
  m_runs.each(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 3; ++k)
        x.data()[3 * row + k] += first * static_cast<double>(m_x.data()[4 * row + k]);
  });
  if (!report.converged) std::fill(m_x.begin(), m_x.end(), 0.0F);
  return report;
}

void ShortIteration::exchange_state(Archive& archive, const std::string& prefix) {
  archive.list(prefix + "last_change", m_x);
  archive.number(prefix + "rest", m_rest);
  if (archive.is_restoring()) m_is_changed = m_has_solved_all = true;
}

void ShortIteration::prepare(const BlockMatrix& pattern) {
  const auto num_rows = static_cast<std::size_t>(pattern.num_rows());
  for (std::vector<float>* vector : {&m_r, &m_z, &m_w, &m_p, &m_q, &m_x}) vector->resize(4 * num_rows);
  m_product.resize(3, pattern.num_rows());
  m_blocks.prepare(pattern);
}

void ShortIteration::visit(const std::vector<int>* runs) {
  m_runs.visit(runs);
  m_visited = runs;
  m_is_changed = true;
}

/// Rows beside those that are visited are read: what the last solve left there goes.
void ShortIteration::clear_left_rows() {
  const auto length = 4 * OrderedRuns::kLength;
  const auto size = static_cast<std::ptrdiff_t>(m_z.size());
  const auto clear = [&](int run) {
    for (std::vector<float>* vector : {&m_z, &m_x})
      std::fill(vector->begin() + run * length, vector->begin() + std::min((run + 1) * length, size), 0.0F);
  };
  const auto is_visited = [&](int run) {
    return !m_visited || std::binary_search(m_visited->begin(), m_visited->end(), run);
  };
  for (const int run : m_solved)
    if (!is_visited(run)) clear(run);
  for (int run = 0; m_has_solved_all && m_visited && run * length < size; ++run)
    if (!is_visited(run)) clear(run);
  m_has_solved_all = m_visited == nullptr;
  m_solved.clear();
  if (m_visited) m_solved = *m_visited;
}

/// z holds what the last solve found: the share of it that takes most of the error's energy away, z·r over
/// z·A z.
ShortIteration::FirstStep ShortIteration::find_first_step(Operator& whole, std::ptrdiff_t num_rows) {
  m_runs.each_run(num_rows, [&](std::ptrdiff_t i, std::ptrdiff_t begin, std::ptrdiff_t end) {
    const auto run = static_cast<std::size_t>(i);
    m_products[run] = m_blocks.multiply(begin, end, m_z.data(), m_w.data());
    m_sums[run].rz = ShortBlocks::compute_dot(begin, end, m_r.data(), m_z.data());
  });
  double curvature = whole.add_unstored(m_z.data(), m_w.data());
  for (const double run : m_products) curvature += run;
  double along = 0.0;
  for (const ShortBlocks::Sums& run : m_sums) along += run.rz;
  if (!(curvature > 0.0)) return {};
  return {along / curvature, along * along / curvature};
}

/// A x = r / `first`, which has the norm 1, until what is left of it is below `goal`.
SolveReport ShortIteration::iterate(Operator& whole, double first, double goal, int max_iterations) {
  const std::ptrdiff_t num_rows = m_product.cols();
  const ShortBlocks::Iterate to{m_p.data(), m_q.data(), m_x.data(), m_r.data(), m_z.data()};
  ShortBlocks::Sums sums;
  const auto advance = [&](double alpha, double beta) {
    m_runs.each_run(num_rows, [&](std::ptrdiff_t i, std::ptrdiff_t begin, std::ptrdiff_t end) {
      m_sums[static_cast<std::size_t>(i)] =
          m_blocks.advance(begin, end, static_cast<float>(alpha), static_cast<float>(beta), m_w.data(), to);
    });
    sums = {};
    for (const ShortBlocks::Sums& run : m_sums) {
      sums.rr += run.rr;
      sums.rz += run.rz;
    }
  };
  m_runs.each(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 4; ++k) {
        const std::ptrdiff_t i = 4 * row + k;
        m_z.data()[i] = m_x.data()[i];
        m_p.data()[i] = m_q.data()[i] = m_w.data()[i] = m_x.data()[i] = 0.0F;
        m_r.data()[i] = k < 3 ? static_cast<float>(m_product.data()[3 * row + k] / first) : 0.0F;
      }
  });
  constexpr double kUseful = 0.5;  // share of the energy that a solve takes away
  constexpr int kRest = 4;         // solves without the last solution after one that it was of less use to
  const bool tries_last = m_rest == 0;
  const FirstStep first_step = tries_last ? find_first_step(whole, num_rows) : FirstStep{};
  advance(first_step.share, 0.0);  // z = D⁻¹ r
  double residual = std::sqrt(sums.rr);
  double energy = first_step.energy;
  double last_rz = std::numeric_limits<double>::infinity();  // later directions know nothing of the first
  double curvature = 0.0;  // p·A p, by the recurrence that holds while directions are conjugate
  int iterations = first_step.share != 0.0 ? 1 : 0;
  bool is_positive = true;
  // Written so that a NaN residual leaves the loop as not converged.
  while (residual > goal && iterations < max_iterations) {
    m_runs.each_run(num_rows, [&](std::ptrdiff_t i, std::ptrdiff_t begin, std::ptrdiff_t end) {
      m_products[static_cast<std::size_t>(i)] = m_blocks.multiply(begin, end, m_z.data(), m_w.data());
    });
    double product = whole.add_unstored(m_z.data(), m_w.data());
    for (const double run : m_products) product += run;
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
  if (!tries_last)
    --m_rest;
  else if (first_step.share != 0.0 && first_step.energy < kUseful * energy)
    m_rest = kRest;
  return {is_positive && residual <= goal, iterations,
          is_positive ? residual : std::numeric_limits<double>::infinity()};
}

}  // namespace argil::linear
