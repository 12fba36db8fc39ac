// Assembly in two passes, each writing one slot an item: tets compute what their corners get, then every node
// gathers its force, and its row of the matrix, from the tets around it in the order of their numbers.

#include <Eigen/LU>

#include "base/parallel.h"
#include "solid/element.h"
#include "solid/solid.h"

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
  if (m_params.model == StrainModel::neo_hookean) return true;
  return m_params.model == StrainModel::corotational &&
         (m_is_static || m_params.iteration == Iteration::newton);
}

Solid::MatrixShares Solid::shares() const {
  if (m_is_static) return needs_tangents() ? MatrixShares{0.0, 0.0, 1.0} : MatrixShares{0.0, 1.0, 0.0};
  const double elastic = m_tau * m_tau;
  const double viscous = m_tau * m_params.rayleigh_stiffness;
  const double mass = 1.0 + m_tau * m_params.rayleigh_mass;
  return needs_tangents() ? MatrixShares{mass, viscous, elastic} : MatrixShares{mass, elastic + viscous, 0.0};
}

template <int N>
void Solid::set_corner_forces() {
  const int Q = m_elements.points_per_tet;
  parallel_for(m_elements.num_tets(), m_threads, [&](std::ptrdiff_t t) {
    const Elasticity e = elasticity(static_cast<int>(t));
    Eigen::Matrix<double, 3, N> force = Eigen::Matrix<double, 3, N>::Zero();
    for (int q = 0; q < Q; ++q) {
      const std::ptrdiff_t p = Q * t + q;
      const Mat3 P = m_elements.weight(p) *
                     compute_piola(m_params.model, motion(static_cast<int>(p)), m_plastic_strain->col(p), e);
      force.noalias() += P * m_elements.gradient.middleCols<N>(N * p);
    }
    m_corner_force.middleCols<N>(N * t) = force;
  });
}

void Solid::gather(Points& force) const {
  parallel_for(force.cols(), m_threads, [&](std::ptrdiff_t v) {
    Vec3 sum = Vec3::Zero();
    for (int c = m_elements.node_begin[static_cast<std::size_t>(v)];
         c < m_elements.node_begin[static_cast<std::size_t>(v) + 1]; ++c)
      sum += m_corner_force.col(m_elements.node_corners[static_cast<std::size_t>(c)]);
    force.col(v) = sum;
  });
}

void Solid::assemble_internal_force() {
  update_volume_change(*m_plastic_strain);
  if (m_elements.nodes_per_tet == 4)
    set_corner_forces<4>();
  else
    set_corner_forces<10>();
  gather(m_internal_force);
}

/// Corner forces of K u, where K takes the kept-rotation stiffness `kept` times and the tangent `exact`
/// times.
template <int N>
void Solid::set_corner_products(const Points& u, double kept, double exact) {
  const int Q = m_elements.points_per_tet;
  const auto displacement_gradient = [&](std::ptrdiff_t p) {
    const int tet = m_elements.tet_of_point(static_cast<int>(p));
    Mat3 H = Mat3::Zero();
    for (int i = 0; i < N; ++i)
      H.noalias() += u.col(m_elements.nodes(i, tet)) * m_elements.gradient.col(N * p + i).transpose();
    return H;
  };
  Field mean_kept, mean_exact;  // p1_nodal: the nodes' mean volume change
  const auto average = [&](const auto& gradient_of, Field& mean) {
    Field change(m_elements.num_tets());
    for (int t = 0; t < m_elements.num_tets(); ++t)
      change(t) = gradient_of(t).cwiseProduct(displacement_gradient(t)).sum();
    m_nodal->average(change, mean);
  };
  if (m_nodal && kept != 0.0) average([&](int t) { return kept_rotation(t); }, mean_kept);
  if (m_nodal && exact != 0.0) average([&](int t) { return volume_gradient(t); }, mean_exact);
  parallel_for(m_elements.num_tets(), m_threads, [&](std::ptrdiff_t t) {
    const Elasticity e = elasticity(static_cast<int>(t));
    Eigen::Matrix<double, 3, N> force = Eigen::Matrix<double, 3, N>::Zero();
    for (int q = 0; q < Q; ++q) {
      const std::ptrdiff_t p = Q * t + q;
      const Mat3 H = displacement_gradient(p);
      Mat3 P = Mat3::Zero();
      if (kept != 0.0) {
        const Mat3 R = kept_rotation(static_cast<int>(p));
        const Mat3 turned = R.transpose() * H;
        Mat3 sigma = from_mandel(compute_stress(e, to_mandel(0.5 * (turned + turned.transpose()))));
        if (m_nodal) sigma.diagonal().array() += e.excess_bulk * mean_kept(t);
        P = kept * R * sigma;
      }
      if (exact != 0.0) {
        const Mat9 A = m_tangent.col(p).reshaped(9, 9);
        P += exact * (A * H.reshaped()).reshaped(3, 3);
        if (m_nodal) P += exact * e.excess_bulk * mean_exact(t) * volume_gradient(static_cast<int>(t));
      }
      force.noalias() += m_elements.weight(p) * P * m_elements.gradient.middleCols<N>(N * p);
    }
    m_corner_force.middleCols<N>(N * t) = force;
  });
}

void Solid::compute_stiffness_product(const Points& u, double kept, double exact, Points& force) {
  if (m_elements.nodes_per_tet == 4)
    set_corner_products<4>(u, kept, exact);
  else
    set_corner_products<10>(u, kept, exact);
  gather(force);
}

Mat3 Solid::volume_gradient(int tet) const {
  return compute_volume_gradient(m_params.model, motion(tet), m_plastic_strain->col(tet));
}

/// Frame of the stiffness whose rotation is kept: the present one, or that of the step's start.
Mat3 Solid::kept_rotation(int point) const {
  const Eigen::Matrix3Xd& R = m_kept_rotation.size() > 0 ? m_kept_rotation : m_rotation;
  return R.middleCols<3>(3 * static_cast<Eigen::Index>(point));
}

void Solid::assemble_tangents() {
  if (!needs_tangents()) return;
  m_tangent.resize(81, m_elements.num_points());
  parallel_for(m_elements.num_points(), m_threads, [&](std::ptrdiff_t p) {
    const int tet = m_elements.tet_of_point(static_cast<int>(p));
    const Mat9 A = compute_tangent(m_params.model, motion(static_cast<int>(p)), m_plastic_strain->col(p),
                                   elasticity(tet));
    m_tangent.col(p) = (m_is_projected ? make_positive(A) : A).reshaped();
  });
}

void Solid::assemble_matrix(std::span<const PointStiffness> contacts) {
  assemble_tangents();
  if (m_elements.nodes_per_tet == 4)
    assemble_rows<4>();
  else
    assemble_rows<10>();
  if (m_nodal) {
    add_nodal_stiffness(m_turned_gradient, shares().kept);
    if (shares().exact != 0.0) {
      Eigen::Matrix3Xd gradient(3, m_elements.gradient.cols());
      for (int t = 0; t < m_elements.num_tets(); ++t)
        gradient.middleCols<4>(4 * static_cast<Eigen::Index>(t)) =
            volume_gradient(t) * m_elements.gradient.middleCols<4>(4 * static_cast<Eigen::Index>(t));
      add_nodal_stiffness(gradient, shares().exact);
    }
  }
  if (m_params.implicit_contact) add_contacts(contacts);
  mask_rows();
}

void Solid::add_nodal_stiffness(const Eigen::Matrix3Xd& gradient, double scale) {
  if (scale == 0.0) return;
  if (has_only_diagonal())
    m_nodal->add_diagonal(gradient, scale, m_matrix);
  else
    m_nodal->add_stiffness(gradient, scale, m_threads, m_matrix);
}

template <int N>
void Solid::assemble_rows() {
  const MatrixShares share = shares();
  const int Q = m_elements.points_per_tet;
  const bool is_isotropic = m_stiffness.empty();
  parallel_for(num_free(), m_threads, [&](std::ptrdiff_t row) {
    const auto r = static_cast<std::size_t>(row);
    const int begin = m_matrix.row_begin[r];
    m_matrix.values
        .middleCols(3 * static_cast<Eigen::Index>(begin),
                    3 * static_cast<Eigen::Index>(m_matrix.row_begin[r + 1] - begin))
        .setZero();
    const int node = m_node_of_row[r];
    for (int c = m_elements.node_begin[static_cast<std::size_t>(node)];
         c < m_elements.node_begin[static_cast<std::size_t>(node) + 1]; ++c) {
      const int corner = m_elements.node_corners[static_cast<std::size_t>(c)];
      const Eigen::Index t = corner / N;
      const int i = corner % N;
      const int* blocks = &m_block_of_corner_pair[static_cast<std::size_t>(N * corner)];
      const Elasticity e = elasticity(static_cast<int>(t));
      for (Eigen::Index p = Q * t; p < Q * (t + 1); ++p) {
        const double weight = m_elements.weight(p);
        if (share.kept != 0.0 && is_isotropic) {
          const Vec3 ci = m_turned_gradient.col(N * p + i);
          const double lambda = share.kept * weight * e.lambda;
          const double mu = share.kept * weight * e.mu;
          for (int j = 0; j < N; ++j)
            if (blocks[j] >= 0)
              m_matrix.block(blocks[j]) +=
                  compute_isotropic_block(ci, m_turned_gradient.col(N * p + j), lambda, mu);
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
    m_matrix.block(m_matrix.diagonal[r]).diagonal().array() += share.mass * m_mass(node);
  });
}

void Solid::add_contacts(std::span<const PointStiffness> contacts) {
  for (const PointStiffness& contact : contacts) {
    const Mat3 block = m_tau * m_tau * contact.stiffness * contact.normal * contact.normal.transpose();
    for (std::size_t i = 0; i < contact.count(); ++i)
      for (std::size_t j = 0; j < contact.count(); ++j) {
        const int row = m_row_of_node[static_cast<std::size_t>(contact.vertex[i])];
        const int column = m_row_of_node[static_cast<std::size_t>(contact.vertex[j])];
        if (row < 0 || column < 0) continue;
        const int place = linear::find_block(m_matrix, row, column);
        if (place >= 0) m_matrix.block(place) += contact.weight[i] * contact.weight[j] * block;
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

double Solid::compute_contact_change(const PointStiffness& contact) const {
  if (!m_params.implicit_contact || is_explicit()) return 0.0;
  // Newmark's step takes the mean of both ends.
  const double share = m_params.integrator == Integrator::newmark ? 0.5 : 1.0;
  return -share * contact.stiffness * compute_gap_change(contact, m_x, m_x_start);
}

void Solid::apply_contact_stiffness(std::span<const PointStiffness> contacts, Points& force) const {
  for (const PointStiffness& contact : contacts) {
    const double change = compute_contact_change(contact);
    for (std::size_t i = 0; i < contact.count(); ++i)
      force.col(contact.vertex[i]) += contact.weight[i] * change * contact.normal;
  }
}

/// scale · Σ k n n·(to − from): how contact forces change on the way.
void Solid::add_contact_change(const Points& to, const Points& from, std::span<const PointStiffness> contacts,
                               double scale, Points& force) const {
  for (const PointStiffness& contact : contacts) {
    const Vec3 change = scale * contact.stiffness * compute_gap_change(contact, to, from) * contact.normal;
    for (std::size_t i = 0; i < contact.count(); ++i)
      force.col(contact.vertex[i]) += contact.weight[i] * change;
  }
}

double Solid::compute_gap_change(const PointStiffness& contact, const Points& to, const Points& from) {
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < contact.count(); ++i)
    mean += contact.weight[i] * (to.col(contact.vertex[i]) - from.col(contact.vertex[i]));
  return contact.normal.dot(mean);
}

}  // namespace argil::solid
