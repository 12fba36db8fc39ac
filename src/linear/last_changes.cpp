#include "linear/last_changes.h"

#include <algorithm>

#include "linear/short_vectors.h"

namespace argil::linear {
namespace {

/// The a for which g·a − ½ aᵀG a is largest. What hardly adds to those before it is left out: rounding would
/// speak for it.
Vec3 find_shares(Mat3 G, Vec3 g) {
  constexpr double kDistinct = 1e-6;  // of the square of a direction's length
  const Vec3 length = G.diagonal();
  Vec3 pivot = Vec3::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (!(G(k, k) > kDistinct * length(k))) continue;
    pivot(k) = G(k, k);
    for (Eigen::Index i = k + 1; i < 3; ++i) {
      const double factor = G(i, k) / pivot(k);
      for (Eigen::Index j = i; j < 3; ++j) G(j, i) -= factor * G(j, k);
      g(i) -= factor * g(k);
    }
  }
  Vec3 a = Vec3::Zero();
  for (Eigen::Index k = 2; k >= 0; --k) {
    if (pivot(k) == 0.0) continue;
    double rest = g(k);
    for (Eigen::Index i = k + 1; i < 3; ++i) rest -= G(i, k) * a(i);
    a(k) = rest / pivot(k);
  }
  return a;
}

constexpr int kKept = LastChanges::kKept;

ARGIL_EVERY_PROCESSOR void compute_products(const float* const (&d)[kKept], const float* const (&y)[kKept],
                                            const float* r, std::ptrdiff_t begin, std::ptrdiff_t end,
                                            LastChanges::Products& products) {
  Quad dy[kKept][kKept] = {};
  Quad dr[kKept] = {};
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4)
    for (int k = 0; k < kKept; ++k) {
      for (int j = k; j < kKept; ++j) add_up(*four_at(d[j] + i) * *four_at(y[k] + i), dy[k][j]);
      add_up(*four_at(d[k] + i) * *four_at(r + i), dr[k]);
    }
  for (int k = 0; k < kKept; ++k) {
    for (int j = k; j < kKept; ++j) products.dy[k][j] = add_lanes(dy[k][j]);
    products.dr[k] = add_lanes(dr[k]);
  }
}

/// x = Σ aₖ dₖ, r −= Σ aₖ yₖ.
ARGIL_EVERY_PROCESSOR void combine(const float (&a)[kKept], const float* const (&d)[kKept],
                                   const float* const (&y)[kKept], std::ptrdiff_t begin, std::ptrdiff_t end,
                                   float* x, float* r) {
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4) {
    Floats4 of_d = {}, of_y = {};
    for (int k = 0; k < kKept; ++k) {
      of_d += a[k] * *four_at(d[k] + i);
      of_y += a[k] * *four_at(y[k] + i);
    }
    *four_at(x + i) = of_d;
    *four_at(r + i) -= of_y;
  }
}

}  // namespace

void LastChanges::prepare(std::ptrdiff_t num_rows) {
  for (auto* vectors : {&m_d, &m_product, &m_committed_d})
    for (std::vector<float>& vector : *vectors) vector.resize(4 * static_cast<std::size_t>(num_rows));
  m_changed_runs.resize(static_cast<std::size_t>(OrderedRuns::count_all_runs(num_rows)));
  m_products.reserve(static_cast<std::size_t>(OrderedRuns::count_all_runs(num_rows)));
}

LastChanges::Start LastChanges::begin(const ShortRows& matrix, Operator& whole, const OrderedRuns& runs,
                                      std::ptrdiff_t num_rows, float* x, float* r) {
  if (m_use.rest > 0) {
    --m_use.rest;
    return {};
  }
  const float* const d[kKept] = {m_d[0].data(), m_d[1].data(), m_d[2].data()};
  float* const Ad[kKept] = {m_product[0].data(), m_product[1].data(), m_product[2].data()};
  m_products.resize(static_cast<std::size_t>(runs.count_runs(num_rows)));
  runs.each(num_rows,
            [&](std::ptrdiff_t begin, std::ptrdiff_t end) { multiply_three(matrix, begin, end, d, Ad); });
  for (int k = 0; k < kKept; ++k) whole.add_unstored(d[k], Ad[k]);
  runs.each_run(num_rows, [&](std::ptrdiff_t i, std::ptrdiff_t begin, std::ptrdiff_t end) {
    compute_products(d, Ad, r, begin, end, m_products[static_cast<std::size_t>(i)]);
  });
  Mat3 G = Mat3::Zero();
  Vec3 g = Vec3::Zero();
  for (const Products& run : m_products) {
    for (int k = 0; k < kKept; ++k) {
      for (int i = k; i < kKept; ++i) G(i, k) += run.dy[k][i];
      g(k) += run.dr[k];
    }
  }
  if (!(G(0, 0) > 0.0)) return {};  // nothing is kept
  const Vec3 a = find_shares(G, g);
  const float share[kKept] = {static_cast<float>(a(0)), static_cast<float>(a(1)), static_cast<float>(a(2))};
  runs.each(num_rows,
            [&](std::ptrdiff_t begin, std::ptrdiff_t end) { combine(share, d, Ad, begin, end, x, r); });
  return {g.dot(a), kKept};
}

void LastChanges::judge(const Start& start, double energy) {
  constexpr double kUseful = 0.5;  // share of the energy
  constexpr int kLongestRest = 16;
  if (start.products == 0) return;
  const bool is_useful = start.energy >= kUseful * energy;
  m_use.rest = is_useful ? 0 : m_use.next_rest;
  m_use.next_rest = is_useful ? 1 : std::min(2 * m_use.next_rest, kLongestRest);
}

void LastChanges::keep(const OrderedRuns& runs, std::ptrdiff_t num_rows, const float* x, double scale) {
  constexpr double kLargest = 1e6;  // beside which the new change is lost in rounding
  const double ratio = m_use.scale / scale;
  const float old = ratio < kLargest ? static_cast<float>(ratio) : 0.0F;
  m_use.scale = scale;
  float* const d[kKept] = {m_d[0].data(), m_d[1].data(), m_d[2].data()};
  runs.each(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    remember(begin, end);
    for (std::ptrdiff_t i = 4 * begin; i < 4 * end; ++i) {
      const float growth = x[i] - old * d[0][i];
      d[2][i] = growth - old * d[1][i];
      d[1][i] = growth;
      d[0][i] = x[i];
    }
  });
}

void LastChanges::clear(std::ptrdiff_t begin, std::ptrdiff_t end) {
  constexpr std::ptrdiff_t length = OrderedRuns::kLength;
  for (std::ptrdiff_t first = begin; first < end; first += length)
    remember(first, std::min(first + length, end));
  for (std::vector<float>& d : m_d) std::fill(d.begin() + 4 * begin, d.begin() + 4 * end, 0.0F);
}

/// Keeps what the rows of one run were at the last commit, when they first change.
void LastChanges::remember(std::ptrdiff_t begin, std::ptrdiff_t end) {
  if (!m_changed_runs.set(static_cast<std::size_t>(begin / OrderedRuns::kLength))) return;
  for (int k = 0; k < kKept; ++k)
    std::copy(m_d[k].begin() + 4 * begin, m_d[k].begin() + 4 * end, m_committed_d[k].begin() + 4 * begin);
}

void LastChanges::commit() {
  m_committed_use = m_use;
  m_changed_runs.clear();
}

void LastChanges::roll_back() {
  m_use = m_committed_use;
  constexpr std::size_t length = 4 * OrderedRuns::kLength;
  for (std::size_t run = 0; run < m_changed_runs.size(); ++run) {
    if (!m_changed_runs.is_set(run)) continue;
    for (int k = 0; k < kKept; ++k) {
      const std::size_t begin = length * run;
      const std::size_t count = std::min(length, m_d[k].size() - begin);
      std::copy_n(m_committed_d[k].data() + begin, count, m_d[k].data() + begin);
    }
  }
  m_changed_runs.clear();
}

void LastChanges::serialize(Archive& archive, const std::string& prefix) {
  for (int k = 0; k < kKept; ++k) archive.list(prefix + "last_change_" + std::to_string(k), m_d[k]);
  archive.number(prefix + "last_scale", m_use.scale);
  archive.number(prefix + "rest", m_use.rest);
  archive.number(prefix + "next_rest", m_use.next_rest);
}

}  // namespace argil::linear
