// Assembly in two passes, each writing one slot an item: tets compute their corner forces, then every free
// vertex gathers its row of the matrix and its force from the tets around it, in the order of their numbers.

#include "base/parallel.h"
#include "solid/solid.h"

namespace argil::solid {
namespace {

/// V (λ cᵢ⊗cⱼ + μ cⱼ⊗cᵢ + μ cᵢ·cⱼ 1): the block of an isotropic tet with turned gradients c, times `scale`.
Mat3 compute_isotropic_block(const Vec3& ci, const Vec3& cj, double lambda_scaled, double mu_scaled) {
  Mat3 block = (lambda_scaled * ci) * cj.transpose() + (mu_scaled * cj) * ci.transpose();
  block.diagonal().array() += mu_scaled * ci.dot(cj);
  return block;
}

}  // namespace

void Solid::assemble(const SolidState& state, const Points& external_force,
                     std::span<const PointStiffness> contacts, double step_s) {
  assemble_tets(state);
  assemble_rows(state, external_force, step_s);
  if (m_params.implicit_contact) add_contacts(contacts, step_s);
}

void Solid::assemble_tets(const SolidState& state) {
  parallel_for(m_tets.cols(), m_threads, [&](std::ptrdiff_t t) {
    const Vec6 elastic = m_strain.col(t) - state.plastic_strain.col(t);
    const Mat3 sigma = from_mandel(compute_stress(static_cast<std::size_t>(t), elastic));
    const Mat3 P = m_volume(t) * (m_rotation.middleCols<3>(3 * t) * sigma);
    m_corner_force.middleCols<4>(4 * t).noalias() = P * m_gradient.middleCols<4>(4 * t);
  });
  parallel_for(m_internal_force.cols(), m_threads, [&](std::ptrdiff_t v) {
    Vec3 sum = Vec3::Zero();
    for (int c = m_vertex_begin[static_cast<std::size_t>(v)];
         c < m_vertex_begin[static_cast<std::size_t>(v) + 1]; ++c)
      sum += m_corner_force.col(m_vertex_corners[static_cast<std::size_t>(c)]);
    m_internal_force.col(v) = sum;
  });
}

void Solid::assemble_rows(const SolidState& state, const Points& external_force, double step_s) {
  const double h = step_s;
  const double stiffness_factor = h * h + h * m_params.rayleigh_stiffness;
  const double mass_factor = 1.0 + h * m_params.rayleigh_mass;
  parallel_for(num_free(), m_threads, [&](std::ptrdiff_t row) {
    const auto r = static_cast<std::size_t>(row);
    const int begin = m_matrix.row_begin[r];
    m_matrix.values
        .middleCols(3 * static_cast<Eigen::Index>(begin),
                    3 * static_cast<Eigen::Index>(m_matrix.row_begin[r + 1] - begin))
        .setZero();
    const int v = m_vertex_of_row[r];
    for (int c = m_vertex_begin[static_cast<std::size_t>(v)];
         c < m_vertex_begin[static_cast<std::size_t>(v) + 1]; ++c) {
      const int corner = m_vertex_corners[static_cast<std::size_t>(c)];
      const int t = corner / 4;
      const int i = corner % 4;
      const int* blocks = &m_block_of_corner_pair[static_cast<std::size_t>(16 * t + 4 * i)];
      const double scale = stiffness_factor * m_volume(t);
      if (m_stiffness.empty()) {
        const TetMaterial& material = m_material[static_cast<std::size_t>(t)];
        const Vec3 ci = m_turned_gradient.col(corner);
        for (int j = 0; j < 4; ++j)
          if (blocks[j] >= 0)
            m_matrix.block(blocks[j]) += compute_isotropic_block(
                ci, m_turned_gradient.col(4 * t + j), scale * material.lambda, scale * material.mu);
      } else {
        const TetGeometry tet{m_gradient.middleCols<4>(4 * static_cast<Eigen::Index>(t)), m_volume(t)};
        const Mat12 K =
            compute_element_stiffness(tet, m_rotation.middleCols<3>(3 * static_cast<Eigen::Index>(t)),
                                      m_stiffness[static_cast<std::size_t>(t)]);
        for (int j = 0; j < 4; ++j)
          if (blocks[j] >= 0) m_matrix.block(blocks[j]) += stiffness_factor * K.block<3, 3>(3 * i, 3 * j);
      }
    }
    m_matrix.block(m_matrix.diagonal[r]).diagonal().array() += mass_factor * m_mass(v);
    m_rhs.col(row) = m_mass(v) * (state.v.col(v) + h * m_params.gravity) +
                     h * (external_force.col(v) - m_internal_force.col(v));
  });
}

void Solid::add_contacts(std::span<const PointStiffness> contacts, double step_s) {
  for (const PointStiffness& contact : contacts) {
    const Mat3 block = step_s * step_s * contact.stiffness * contact.normal * contact.normal.transpose();
    for (std::size_t i = 0; i < 3 && contact.vertex[i] >= 0; ++i)
      for (std::size_t j = 0; j < 3 && contact.vertex[j] >= 0; ++j) {
        const int row = m_row_of_vertex[static_cast<std::size_t>(contact.vertex[i])];
        const int column = m_row_of_vertex[static_cast<std::size_t>(contact.vertex[j])];
        if (row < 0 || column < 0) continue;
        const int place = linear::find_block(m_matrix, row, column);
        m_matrix.block(place) += contact.weight[i] * contact.weight[j] * block;
      }
  }
}

void Solid::apply_contact_stiffness(const Points& velocity, std::span<const PointStiffness> contacts,
                                    double step_s, Points& force) const {
  if (!m_params.implicit_contact) return;
  for (const PointStiffness& contact : contacts) {
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < 3 && contact.vertex[i] >= 0; ++i)
      mean += contact.weight[i] * velocity.col(contact.vertex[i]);
    const Vec3 change = -step_s * contact.stiffness * contact.normal.dot(mean) * contact.normal;
    for (std::size_t i = 0; i < 3 && contact.vertex[i] >= 0; ++i)
      force.col(contact.vertex[i]) += contact.weight[i] * change;
  }
}

}  // namespace argil::solid
