// Implicit diffusion: backward Euler of the two-point flow by a kept Cholesky factor. The correction makes
// the system unsymmetric; it is solved by GMRES [Saad1986] over the same factor, and limited like the
// explicit one.

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/QR>

#include "base/check.h"
#include "water/implicit_system.h"
#include "water/water.h"

namespace argil::water {

/// Pattern of the lower triangle: every tet and its higher-numbered neighbours.
void PoreWater::make_system() {
  const int num_tets = static_cast<int>(m_capacity.size());
  std::vector<int> begin = {0}, row, column, corner_of;
  for (int t = 0; t < num_tets; ++t) {
    std::vector<std::pair<int, int>> entries = {{t, -1}};
    for (int corner = 0; corner < 4; ++corner)
      if (m_stencil.neighbours(corner, t) > t) entries.emplace_back(m_stencil.neighbours(corner, t), corner);
    std::sort(entries.begin(), entries.end());
    for (const auto& [other, corner] : entries) {
      row.push_back(other);
      column.push_back(t);
      corner_of.push_back(corner);
    }
    begin.push_back(static_cast<int>(row.size()));
  }
  const Field zero = Field::Zero(num_tets);
  m_system = std::make_unique<ImplicitSystem>(ImplicitSystem{
      linear::SparseCholesky(begin, row), row, column, corner_of, 0.0, zero, zero, m_stencil.conductance});
}

/// V + h L with the D of the step's start; kept as long as neither changes.
void PoreWater::factorise(double step_s) {
  constexpr double kNearlyEqual = 1e-6;
  ImplicitSystem& system = *m_system;
  const bool is_constant = m_params.diffusivity_exponent == 0.0;
  if (is_constant && system.step == step_s) return;
  if (!is_constant)
    for (const int t : m_active)
      for (int corner = 0; corner < 4; ++corner) {
        const int other = m_stencil.neighbours(corner, t);
        if (other < 0) continue;
        const double rise = m_state.saturation(other) - m_state.saturation(t);
        // Mean D between the two; that of nearly equal ones, whose difference would cancel, in the middle.
        const double beta = m_params.diffusivity_exponent;
        const double mean = std::abs(beta * rise) > kNearlyEqual
                                ? (m_potential(other) - m_potential(t)) / rise
                                : std::exp(0.5 * beta * (m_state.saturation(other) + m_state.saturation(t)));
        system.conductance(corner, t) = m_stencil.conductance(corner, t) * mean;
      }
  const std::span<double> values = system.factor.values();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const int t = system.column[k];
    values[k] = system.corner[k] < 0 ? m_stencil.volume(t) + step_s * system.conductance.col(t).sum()
                                     : -step_s * system.conductance(system.corner[k], t);
  }
  const bool positive = system.factor.factorise();
  ARGIL_ASSERT(positive, step_s);
  system.step = step_s;
}

/// m_change: the two-point flow of the low-order solution; m_correction: what the corrected one flows beyond
/// it.
void PoreWater::set_implicit_flow(double step_s) {
  const ImplicitSystem& system = *m_system;
  const bool corrected = m_params.flux == FluxForm::corrected;
  for (const int t : m_active) {
    double flow = 0.0;
    for (int corner = 0; corner < 4; ++corner) {
      const int other = m_stencil.neighbours(corner, t);
      if (other < 0) continue;
      const double conductance = step_s * system.conductance(corner, t);
      const double low = conductance * (system.low_order(other) - system.low_order(t));
      flow += low;
      if (corrected)
        m_correction(corner, t) += conductance * (system.solution(other) - system.solution(t)) - low;
    }
    m_change(t) = flow / m_stencil.volume(t);
  }
}

/// m_correction: what the correction brings across each face if S is that at the step's end; D is its
/// start's.
void PoreWater::set_implicit_correction(double step_s, const Field& S) {
  m_potential = S;
  for (const int t : m_active) set_gradient(t);
  for (const int t : m_active) set_correction(t, step_s);
  if (m_params.diffusivity_exponent == 0.0) return;
  for (const int t : m_active)
    for (int corner = 0; corner < 4; ++corner)
      if (m_stencil.neighbours(corner, t) >= 0)
        m_correction(corner, t) *= m_system->conductance(corner, t) / m_stencil.conductance(corner, t);
}

/// x ← A⁻¹ x with A = V + h L, the two-point system.
void PoreWater::solve_two_point(Field& x) {
  const auto n = static_cast<std::size_t>(x.size());
  m_system->factor.solve({x.data(), n}, {x.data(), n});
}

/// Adds to the low-order S₀ = A⁻¹V S what solves (A − N) S = V S, N the correction: GMRES on (1 − A⁻¹N) δ =
/// A⁻¹N S₀, which keeps the smallest residual of all its steps. Returns the number of solves.
int PoreWater::solve_corrected(double step_s) {
  constexpr int kMostSteps = 60;
  constexpr double kConverged = 1e-12;  // of S
  ImplicitSystem& system = *m_system;
  const auto apply = [&](const Field& S) {  // A⁻¹N S
    set_implicit_correction(step_s, S);
    Field image = m_correction.colwise().sum().transpose();
    solve_two_point(image);
    return image;
  };
  system.solution = system.low_order;
  std::vector<Field> basis = {apply(system.low_order)};
  const double size = basis[0].norm();
  const double wanted = kConverged * std::sqrt(static_cast<double>(m_capacity.size()));
  if (!(size > wanted)) return 1;
  basis[0] /= size;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(kMostSteps + 1, kMostSteps);
  Field y;
  for (int k = 0; k < kMostSteps; ++k) {
    Field next = basis.back() - apply(basis.back());
    for (int i = 0; i <= k; ++i) {
      H(i, k) = basis[static_cast<std::size_t>(i)].dot(next);
      next -= H(i, k) * basis[static_cast<std::size_t>(i)];
    }
    H(k + 1, k) = next.norm();
    const Eigen::MatrixXd small = H.topLeftCorner(k + 2, k + 1);
    const Field target = size * Field::Unit(k + 2, 0);
    y = small.householderQr().solve(target);
    if ((small * y - target).norm() <= wanted || !(H(k + 1, k) > 0.0)) break;
    basis.push_back(next / H(k + 1, k));
  }
  for (Eigen::Index k = 0; k < y.size(); ++k) system.solution += y(k) * basis[static_cast<std::size_t>(k)];
  set_implicit_correction(step_s, system.solution);
  return static_cast<int>(y.size()) + 1;
}

/// Takes the limit back wherever S stays within its range without. A long step's corrections are large and
/// nearly cancel in every tet, so that limits for each flow by itself would stop most of them. The limited
/// tets only become more; with all of them limited nothing leaves its range.
void PoreWater::relax_limits() {
  constexpr double kRounding = 1e-15;
  const Eigen::Matrix2Xd limits = m_share;
  std::vector<char> is_limited(m_is_active.size(), 0);
  m_share.setOnes();
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    std::vector<int> leaving;
    for (const int t : m_active) {
      if (is_limited[static_cast<std::size_t>(t)]) continue;
      const auto [lowest, highest] = find_range(t);
      const double S = m_state.saturation(t) + m_change(t) + compute_let_through(t);
      if (!(S >= lowest - kRounding && S <= highest + kRounding)) leaving.push_back(t);
    }
    for (const int t : leaving) {
      is_limited[static_cast<std::size_t>(t)] = 1;
      m_share.col(t) = limits.col(t);
      has_changed = true;
    }
  }
}

/// S of (V + h L + h G) S' = V S + h (G w + q): backward Euler of the two-point flow with walls that conduct
/// G from w, or pass the tool's flux q where that is less. Conjugate gradients over the factor of V + h L,
/// which stays.
Field PoreWater::solve_wall_system(double step_s) {
  constexpr int kMostSteps = 200;
  constexpr double kConverged = 1e-14;
  Field diagonal = Field::Zero(m_capacity.size());
  Field b = m_stencil.volume.cwiseProduct(m_state.saturation);
  for (const WallTet& wall : m_wall) {
    if (!wall.is_limited) diagonal(wall.tet) = step_s * wall.conductance;
    b(wall.tet) += step_s * (wall.is_limited ? (2.0 * m_wall_saturation - 1.0) * m_wall_flux * wall.area
                                             : wall.conductance * m_wall_saturation);
  }
  // A p follows from p's own recurrence, as A z is the residual.
  Field x = Field::Zero(b.size());
  Field residual = b;
  Field z = residual;
  solve_two_point(z);
  Field p = z, image_of_p = residual;  // A p
  double product = residual.dot(z);
  const double wanted = kConverged * kConverged * product;
  for (int k = 0; k < kMostSteps && product > wanted; ++k) {
    const Field q = image_of_p + diagonal.cwiseProduct(p);
    const double step = product / p.dot(q);
    x += step * p;
    residual -= step * q;
    z = residual;
    solve_two_point(z);
    const double before = std::exchange(product, residual.dot(z));
    p = z + product / before * p;
    image_of_p = residual + product / before * image_of_p;
  }
  return x;
}

/// The low-order solution and each wall's uptake. All walls conduct at first; those that would pass more than
/// the tool's flux pass that, which leaves the others more: none of them goes back.
void PoreWater::solve_with_wall(double step_s) {
  for (WallTet& wall : m_wall) {
    wall.conductance = compute_wall_conductance(wall, step_s);
    wall.is_limited = false;
  }
  for (bool has_changed = !m_wall.empty(); has_changed;) {
    has_changed = false;
    const Field S = solve_wall_system(step_s);
    for (WallTet& wall : m_wall) {
      if (wall.is_limited) continue;
      const double largest = m_wall_flux * wall.area;
      const double flow = wall.conductance * (m_wall_saturation - S(wall.tet));
      wall.is_limited = std::abs(flow) > largest;
      has_changed = has_changed || wall.is_limited;
      wall.uptake = step_s * std::clamp(flow, -largest, largest);
    }
  }
  Field& S = m_system->low_order;
  S = m_stencil.volume.cwiseProduct(m_state.saturation);
  for (const WallTet& wall : m_wall) S(wall.tet) += wall.uptake;
  solve_two_point(S);
}

int PoreWater::diffuse_implicitly(double step_s) {
  for (int t = 0; t < static_cast<int>(m_capacity.size()); ++t) activate(t);
  sort_active();
  if (!m_system) make_system();
  factorise(step_s);
  const bool corrected = m_params.flux == FluxForm::corrected;
  solve_with_wall(step_s);
  const int solves = corrected ? 1 + solve_corrected(step_s) : 1;
  set_implicit_flow(step_s);
  for (const WallTet& wall : m_wall) m_change(wall.tet) += wall.uptake / m_stencil.volume(wall.tet);
  if (corrected) {
    for (const int t : m_active) limit_correction(t);
    relax_limits();
    for (const int t : m_active) m_change(t) += compute_let_through(t);
  }
  for (const int t : m_active) add(t, m_change(t));
  book_uptake(step_s);
  return solves;
}

}  // namespace argil::water
