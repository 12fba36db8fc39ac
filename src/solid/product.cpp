#include "solid/product.h"

#include "base/ordered_sum.h"
#include "base/parallel.h"
#include "solid/body.h"
#include "solid/matrix.h"

namespace argil::solid {
namespace {

/// Corner forces of K u, which forces.corner becomes.
template <int N>
class CornerProduct {
 public:
  CornerProduct(Body& body, const Points& u, double kept, double exact)
      : m_body(body),
        m_strained(body.strained()),
        m_u(u),
        m_kept(kept),
        m_exact(exact),
        m_nodal(body.materials.nodal()) {}

  void set() {
    auto& nodal = m_body.scratch.nodal;
    if (m_nodal && m_kept != 0.0) average([&](int t) { return kept_rotation(m_body, t); }, nodal.mean_kept);
    if (m_nodal && m_exact != 0.0)
      average([&](int t) { return m_strained.volume_gradient(t); }, nodal.mean_exact);
    parallel_for(m_body.model.elements.num_tets(), m_body.model.threads,
                 [&](std::ptrdiff_t t) { set_tet(t); });
  }

 private:
  Mat3 displacement_gradient(std::ptrdiff_t p) const {
    return find_gradient<N>(m_body.model.elements, m_body.materials.gradient(), m_u, static_cast<int>(p));
  }
  /// p1_nodal: the nodes' mean volume change.
  template <class Gradient>
  void average(const Gradient& gradient_of, Field& mean) {
    Field& change = m_body.scratch.nodal.change;
    change.resize(m_body.model.elements.num_tets());
    for (int t = 0; t < change.size(); ++t)
      change(t) = gradient_of(t).cwiseProduct(displacement_gradient(t)).sum();
    m_nodal->average(change, mean);
  }
  Mat3 compute_piola(std::ptrdiff_t t, std::ptrdiff_t p, const Elasticity& e) const {
    const Mat3 H = displacement_gradient(p);
    Mat3 P = Mat3::Zero();
    if (m_kept != 0.0) {
      const Mat3 R = kept_rotation(m_body, static_cast<int>(p));
      const Mat3 turned = R.transpose() * H;
      Mat3 sigma = from_mandel(compute_stress(e, to_mandel(0.5 * (turned + turned.transpose()))));
      if (m_nodal) sigma.diagonal().array() += e.excess_bulk * m_body.scratch.nodal.mean_kept(t);
      P = m_kept * R * sigma;
    }
    if (m_exact != 0.0) {
      const Mat9 A = m_body.system.tangent.col(p).reshaped(9, 9);
      P += m_exact * (A * H.reshaped()).reshaped(3, 3);
      if (m_nodal)
        P += m_exact * e.excess_bulk * m_body.scratch.nodal.mean_exact(t) *
             m_strained.volume_gradient(static_cast<int>(t));
    }
    return P;
  }
  void set_tet(std::ptrdiff_t t) {
    const int Q = m_body.model.elements.points_per_tet;
    const Elasticity e = m_strained.elasticity(static_cast<int>(t));
    Eigen::Matrix<double, 3, N> force = Eigen::Matrix<double, 3, N>::Zero();
    for (int q = 0; q < Q; ++q) {
      const std::ptrdiff_t p = Q * t + q;
      const Mat3 P = compute_piola(t, p, e);
      force.noalias() +=
          m_body.materials.weight()(p) * P * find_node_gradients<N>(m_body.materials.gradient(), p);
    }
    m_body.forces.corner.middleCols<N>(N * t) = force;
  }

  Body& m_body;
  Strained m_strained;
  const Points& m_u;
  double m_kept, m_exact;
  NodalVolume* m_nodal;
};

/// K u with the present rotations where those of the stored matrix lag: of nodes of the part, for isotropic
/// laws of 4-node tets.
void compute_present_product(Body& body, const Part& part, const Points& u, Points& force) {
  const std::ptrdiff_t num_tets = body.model.elements.num_tets();
  auto& change = body.scratch.change;
  const StrainArrays strains{u.data(), body.model.elements.nodes.data(), body.materials.gradient().data(),
                             body.kinematics.rotation().data(), change.strain.data()};
  part.batches.each(num_tets,
                    [&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_strains(strains, begin, end); });
  ForceArrays forces = make_force_arrays(body.strained(change.strain), change.corner_force.data());
  forces.strain = change.strain.data();
  forces.plastic_strain = nullptr;
  if (NodalVolume* nodal = body.materials.nodal()) {
    change.volume = change.strain.topRows<3>().colwise().sum().transpose();
    nodal->average(change.volume, change.pressure);
    change.pressure.array() *= body.materials.excess_bulk().array();
    forces.pressure = change.pressure.data();
  }
  part.batches.each(
      num_tets, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_corner_forces(forces, begin, end); });
  gather(body.model, part, change.corner_force, force);
}

}  // namespace

void compute_stiffness_product(Body& body, const Part& part, const Points& u, double kept, double exact,
                               Points& force) {
  if (body.model.elements.nodes_per_tet == 4)
    CornerProduct<4>(body, u, kept, exact).set();
  else
    CornerProduct<10>(body, u, kept, exact).set();
  gather(body.model, part, body.forces.corner, force);
}

double Product::multiply(const Points& x, Points& y) {
  if (m_body.model.has_only_diagonal()) return multiply_tets(x, y);
  const double stored = linear::multiply(m_body.system.matrix, x, y, m_part.rows);
  return stored + (has_unstored() ? m_body.system.nodal_product->add(x, y) : 0.0);
}

double Product::multiply_tets(const Points& x, Points& y) {
  const Model& model = m_body.model;
  const MatrixShares share = compute_shares(m_body);
  Points& u = m_body.scratch.direction;
  Points& force = m_body.scratch.product;
  u.setZero(3, model.elements.num_nodes());
  for (int row = 0; row < model.num_free(); ++row)
    u.col(model.node_of_row[static_cast<std::size_t>(row)]) = x.col(row);
  clear_held(model, u);
  force.setZero(3, u.cols());
  compute_stiffness_product(m_body, m_part, u, share.kept, share.exact, force);
  if (!m_body.prediction.is_static && model.params.implicit_contact)
    add_contact_product(m_body.step_contacts(m_contacts), m_body.contacts, u, find_contact_scale(m_body),
                        force);
  for (int row = 0; row < model.num_free(); ++row) {
    const int n = model.node_of_row[static_cast<std::size_t>(row)];
    y.col(row) = share.mass * m_body.materials.mass()(n) * x.col(row) + force.col(n);
  }
  const linear::BlockMatrix& matrix = m_body.system.matrix;
  for (const int row : model.held_rows) {
    const int n = model.node_of_row[static_cast<std::size_t>(row)];
    for (int k = 0; k < 3; ++k)
      if (model.constraints.support(k, n) >= 0)
        y(k, row) = matrix.block(matrix.diagonal[static_cast<std::size_t>(row)])(k, k) * x(k, row);
  }
  return ordered_sum(x.size(), [&](std::ptrdiff_t i) { return x(i) * y(i); });
}

void Product::multiply_present(const Points& x, Points& y) {
  const Model& model = m_body.model;
  const MatrixShares share = compute_shares(m_body);
  Points& u = m_body.scratch.direction;
  Points& force = m_body.scratch.product;
  m_part.nodes.each(u.cols(), [&](std::ptrdiff_t n) {
    const int row = model.row_of_node[static_cast<std::size_t>(n)];
    u.col(n) = row < 0 ? Vec3::Zero() : Vec3(x.col(row));
  });
  clear_held(model, u);
  compute_present_product(m_body, m_part, u, force);
  if (model.params.implicit_contact)
    add_contact_product(m_body.step_contacts(m_contacts), m_body.contacts, u,
                        find_contact_scale(m_body) / share.kept, force);
  clear_held(model, force);
  m_part.rows.each(model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      const int n = model.node_of_row[static_cast<std::size_t>(row)];
      y.col(row) = share.mass * m_body.materials.mass()(n) * x.col(row) + share.kept * force.col(n);
    }
  });
  // For nodes that wake within a step.
  m_part.nodes.each(force.cols(), [&](std::ptrdiff_t n) { force.col(n).setZero(); });
}

bool Product::has_unstored() const {
  return m_body.system.nodal_product != nullptr;
}

double Product::add_unstored(const float* x, float* y) {
  return has_unstored() ? m_body.system.nodal_product->add(x, y) : 0.0;
}

void Product::add_unstored_diagonal(Eigen::Matrix3Xd& blocks) {
  if (has_unstored()) m_body.system.nodal_product->add_diagonal(blocks);
}

}  // namespace argil::solid
