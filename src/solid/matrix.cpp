// The matrix of a step: each row is gathered from the tets around its node, in the order of their numbers.

#include <Eigen/LU>

#include <algorithm>

#include "base/parallel.h"
#include "solid/element.h"
#include "solid/solid.h"
#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

/// λ cᵢ⊗cⱼ + μ cⱼ⊗cᵢ + μ cᵢ·cⱼ 1: the block of an isotropic point with turned gradients c, times `scale`.
Mat3 compute_isotropic_block(const Vec3& ci, const Vec3& cj, double lambda_scaled, double mu_scaled) {
  Mat3 block = (lambda_scaled * ci) * cj.transpose() + (mu_scaled * cj) * ci.transpose();
  block.diagonal().array() += mu_scaled * ci.dot(cj);
  return block;
}

/// The same for any stiffness: R (gᵢ·C·gⱼ) Rᵀ with g in the turned frame.
Mat3 compute_anisotropic_block(const Vec3& gi, const Vec3& gj, const Mat3& R, const Mat6& C) {
  Mat3 block;
  for (int s = 0; s < 3; ++s) {
    const Mat3 dF = Vec3::Unit(s) * gj.transpose();
    block.col(s) = from_mandel(C * to_mandel(0.5 * (dF + dF.transpose()))) * gi;
  }
  return R * block * R.transpose();
}

}  // namespace

/// Does the matrix need ∂P/∂F? The one-step linear and corotational models keep their rotation instead.
bool Solid::needs_tangents() const {
  const ElasticLaw& law = find_law(m_params.model);
  if (!law.is_quadratic) return true;
  return !law.is_linear && (m_is_static || m_params.iteration == Iteration::newton);
}

Solid::MatrixShares Solid::shares() const {
  if (m_is_static) return needs_tangents() ? MatrixShares{0.0, 0.0, 1.0} : MatrixShares{0.0, 1.0, 0.0};
  const double elastic = m_tau * m_tau;
  const double viscous = m_tau * m_params.rayleigh_stiffness;
  const double mass = 1.0 + m_tau * m_params.rayleigh_mass;
  return needs_tangents() ? MatrixShares{mass, viscous, elastic} : MatrixShares{mass, elastic + viscous, 0.0};
}

void Solid::assemble_tangents() {
  if (!needs_tangents()) return;
  m_tangent.resize(81, m_elements.num_points());
  parallel_for(m_elements.num_points(), m_threads, [&](std::ptrdiff_t p) {
    const int tet = m_elements.tet_of_point(static_cast<int>(p));
    const Mat9 A = compute_tangent(m_params.model, m_kinematics.at(static_cast<int>(p)),
                                   m_plastic_strain->col(p), elasticity(tet));
    m_tangent.col(p) = (m_is_projected ? make_positive(A) : A).reshaped();
  });
}

void Solid::assemble_matrix(std::span<const PointStiffness> contacts) {
  assemble_tangents();
  assemble_rows();
  if (m_nodal) update_nodal_stiffness();
  if (m_params.implicit_contact) add_contacts(contacts);
  mask_rows();
}

/// Does the matrix leave out the nodes' stiffness of p1_nodal, to begin with? Its factors take a third of the
/// memory and no assembly; but a Cholesky factor of the rest alone is no exact one, and Newton's matrix may
/// need two sets of factors, for elasticity and damping.
bool Solid::keeps_nodal_factors() const {
  using linear::SolverKind;
  const SolverKind kind = m_params.solver.kind;
  return (kind == SolverKind::pcg || kind == SolverKind::pcg_jacobi) &&
         m_params.iteration == Iteration::one && find_law(m_params.model).is_quadratic;
}

/// From now on the matrix holds it after all: where a factor is needed, or more exactness than floats have.
void Solid::store_nodal_stiffness() {
  if (!m_nodal_product) return;
  m_nodal_product.reset();
  make_pattern();
  m_stored_shares = {};
  std::fill(m_is_row_stale.begin(), m_is_row_stale.end(), char{1});
}

void Solid::update_nodal_stiffness() {
  add_nodal_stiffness(m_kinematics.turned_gradient(), shares().kept);
  if (shares().exact == 0.0) return;
  Eigen::Matrix3Xd& gradient = m_of_nodal.gradient;
  gradient.resize(3, m_elements.gradient.cols());
  for (int t = 0; t < m_elements.num_tets(); ++t)
    gradient.middleCols<4>(4 * static_cast<Eigen::Index>(t)) =
        volume_gradient(t) * m_elements.gradient.middleCols<4>(4 * static_cast<Eigen::Index>(t));
  add_nodal_stiffness(gradient, shares().exact);
}

void Solid::add_nodal_stiffness(const Eigen::Matrix3Xd& gradient, double scale) {
  if (scale == 0.0) return;
  m_nodal->collect_gradients(gradient);
  if (m_nodal_product)
    m_nodal_product->update(scale);
  else if (has_only_diagonal())
    m_nodal->add_diagonal(scale, m_matrix);
  else
    m_nodal->add_stiffness(scale, m_matrix);
}

/// Gathers the rows that need it: all of them, or, where a matrix of kept rotations stays the same but for a
/// few tets, the rows of those tets and the rows that contacts were added to.
void Solid::assemble_rows() {
  const MatrixShares share = shares();
  const bool keeps_rest = m_elements.nodes_per_tet == 4 && (!m_nodal || m_nodal_product) &&
                          share == m_stored_shares && share.exact == 0.0;
  mark_rows(!keeps_rest);
  m_stored_shares = share;
  const bool is_simple = has_isotropic_tets() && share.exact == 0.0;
  const RowArrays rows{m_kinematics.turned_gradient().data(),
                       m_elements.weight.data(),
                       m_lambda.data(),
                       m_mu.data(),
                       share.kept,
                       m_elements.node_corners.data(),
                       m_block_of_corner_pair.data(),
                       m_matrix.values.data()};
  const auto assemble_row = [&](std::ptrdiff_t row) {
    const auto r = static_cast<std::size_t>(row);
    if (!m_is_row_stale[r]) return 0;
    m_is_row_stale[r] = 0;
    const auto node = static_cast<std::size_t>(m_node_of_row[r]);
    const int begin = m_matrix.row_begin[r];
    const int num_blocks = m_matrix.row_begin[r + 1] - begin;
    if (is_simple && num_blocks <= kLongestRow)
      set_isotropic_row(rows, m_elements.node_begin[node], m_elements.node_begin[node + 1], begin,
                        num_blocks);
    else if (m_elements.nodes_per_tet == 4)
      gather_row<4>(static_cast<int>(row), share);
    else
      gather_row<10>(static_cast<int>(row), share);
    ++m_matrix.revision[r];
    m_matrix.block(m_matrix.diagonal[r]).diagonal().array() += share.mass * m_mass(m_node_of_row[r]);
    return 1;
  };
  m_counters.assembled_rows +=
      static_cast<int>(m_near_rows.sum(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        int assembled = 0;
        for (std::ptrdiff_t row = begin; row < end; ++row) assembled += assemble_row(row);
        return assembled;
      }));
}

/// Rows of tets that have changed, which all lie in runs that move. Takes note of the changes.
void Solid::mark_rows(bool all) {
  if (all) {
    std::fill(m_is_row_stale.begin(), m_is_row_stale.end(), char{1});
    std::fill(m_is_tet_changed.begin(), m_is_tet_changed.end(), char{0});
    return;
  }
  const auto mark = [this](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t t = begin; t < end; ++t) {
      if (!m_is_tet_changed[static_cast<std::size_t>(t)]) continue;
      m_is_tet_changed[static_cast<std::size_t>(t)] = 0;
      for (const int node : m_elements.nodes.col(t))
        if (const int row = m_row_of_node[static_cast<std::size_t>(node)]; row >= 0)
          m_is_row_stale[static_cast<std::size_t>(row)] = 1;
    }
  };
  constexpr int kOneThread = 1;  // tets share rows
  if (m_region)
    for_batches(m_region->batches(), m_elements.num_tets(), kOneThread, mark);
  else
    mark(0, m_elements.num_tets());
}

template <int N>
void Solid::gather_row(int row, const MatrixShares& share) {
  const int Q = m_elements.points_per_tet;
  const bool is_isotropic = m_stiffness.empty();
  const auto r = static_cast<std::size_t>(row);
  const int first = m_matrix.row_begin[r];
  m_matrix.values
      .middleCols(3 * static_cast<Eigen::Index>(first),
                  3 * static_cast<Eigen::Index>(m_matrix.row_begin[r + 1] - first))
      .setZero();
  const auto node = static_cast<std::size_t>(m_node_of_row[r]);
  for (int c = m_elements.node_begin[node]; c < m_elements.node_begin[node + 1]; ++c) {
    const int corner = m_elements.node_corners[static_cast<std::size_t>(c)];
    const Eigen::Index t = corner / N;
    const int i = corner % N;
    const int* blocks = &m_block_of_corner_pair[static_cast<std::size_t>(N * corner)];
    const Elasticity e = elasticity(static_cast<int>(t));
    for (Eigen::Index p = Q * t; p < Q * (t + 1); ++p) {
      const double weight = m_elements.weight(p);
      if (share.kept != 0.0 && is_isotropic) {
        const Vec3 ci = m_kinematics.turned_gradient().col(N * p + i);
        const double lambda = share.kept * weight * e.lambda;
        const double mu = share.kept * weight * e.mu;
        for (int j = 0; j < N; ++j)
          if (blocks[j] >= 0)
            m_matrix.block(blocks[j]) +=
                compute_isotropic_block(ci, m_kinematics.turned_gradient().col(N * p + j), lambda, mu);
      } else if (share.kept != 0.0) {
        const Mat3 R = kept_rotation(static_cast<int>(p));
        for (int j = 0; j < N; ++j)
          if (blocks[j] >= 0)
            m_matrix.block(blocks[j]) +=
                share.kept * weight *
                compute_anisotropic_block(m_elements.gradient.col(N * p + i),
                                          m_elements.gradient.col(N * p + j), R, *e.C);
      }
      if (share.exact == 0.0) continue;
      const Mat9 A = share.exact * weight * m_tangent.col(p).reshaped(9, 9);
      for (int j = 0; j < N; ++j)
        if (blocks[j] >= 0)
          m_matrix.block(blocks[j]) += compute_tangent_block(m_elements.gradient.col(N * p + i), A,
                                                             m_elements.gradient.col(N * p + j));
    }
  }
}

void Solid::add_contacts(std::span<const PointStiffness> contacts) {
  for (const PointStiffness& contact : contacts) {
    if (!acts(contact.group)) continue;
    const Mat3 block = m_tau * m_tau * contact.stiffness * contact.normal * contact.normal.transpose();
    for (std::size_t i = 0; i < contact.count(); ++i)
      for (std::size_t j = 0; j < contact.count(); ++j) {
        const int row = m_row_of_node[static_cast<std::size_t>(contact.vertex[i])];
        const int column = m_row_of_node[static_cast<std::size_t>(contact.vertex[j])];
        if (row < 0 || column < 0) continue;
        const int place = linear::find_block(m_matrix, row, column);
        if (place < 0) continue;
        m_matrix.block(place) += contact.weight[i] * contact.weight[j] * block;
        m_is_row_stale[static_cast<std::size_t>(row)] = 1;
        ++m_matrix.revision[static_cast<std::size_t>(row)];
      }
  }
}

/// Held components leave the system: their rows and columns become those of a diagonal matrix.
void Solid::mask_rows() {
  for (const int row : m_held_rows) {
    const auto r = static_cast<std::size_t>(row);
    const auto held = m_constraints.support.col(m_node_of_row[r]).array() >= 0;
    for (int b = m_matrix.row_begin[r]; b < m_matrix.row_begin[r + 1]; ++b) {
      const int column = m_matrix.column[static_cast<std::size_t>(b)];
      const int transposed = linear::find_block(m_matrix, column, row);
      for (int k = 0; k < 3; ++k) {
        if (!held(k)) continue;
        const double diagonal = m_matrix.block(b)(k, k);
        m_matrix.block(b).row(k).setZero();
        m_matrix.block(transposed).col(k).setZero();
        if (column == row) m_matrix.block(b)(k, k) = diagonal;
      }
    }
  }
}

}  // namespace argil::solid
