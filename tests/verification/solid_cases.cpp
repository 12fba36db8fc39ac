#include "solid_cases.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <algorithm>
#include <limits>
#include <numbers>

#include "solid/loads.h"
#include "support/solid_scene.h"

namespace argil::verification {
namespace {

using solid::ElementKind;
using solid::Region;
using solid::SolidParams;
using solid::StrainModel;
using solid::Support;
using test::Scene;

constexpr double kPi = std::numbers::pi;

SolidParams make_static_params(ElementKind element, StrainModel model = StrainModel::linear) {
  SolidParams params;
  params.element = element;
  params.model = model;
  params.solver.kind = linear::SolverKind::supernodal;  // fast on the finest meshes, and digits suffice here
  return params;
}

Support hold_plane(int axis, double offset, std::array<bool, 3> fixes = {true, true, true}) {
  Support support;
  support.region.kind = Region::Kind::plane;
  support.region.normal = Vec3::Unit(axis);
  support.region.offset = offset;
  support.fixes = fixes;
  return support;
}

/// Consistent nodal forces of a uniform traction [Pa] on the boundary faces in the plane x = `offset`.
Points make_end_traction(const Scene& scene, double offset, const Vec3& traction) {
  solid::PressureLoad unit;
  unit.region = hold_plane(0, offset).region;
  unit.pressure = 1.0;
  solid::Loads loads;
  loads.pressure.push_back(unit);
  const Points inward =
      compute_load_force(scene.solid.model.elements, mesh::make_topology(scene.mesh).boundary, loads);
  return traction * inward.colwise().norm();
}

void expect(const StepStatus& status) {
  if (!status.is_ok()) ADD_FAILURE() << status.failure().quantity << ' ' << status.failure().value;
}

/// Sum over a tet's quadrature points of f(barycentric coordinates, weight): Gauss's four points in each of
/// the three coordinates of a collapsed cube, exact for polynomials up to degree 5.
template <typename F>
void integrate(double volume, F&& f) {
  constexpr double kPoint[4] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                                0.9305681557970263};
  constexpr double kWeight[4] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                 0.1739274225687269};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const double a = kPoint[i];
        const double b = kPoint[j] * (1.0 - a);
        const double c = kPoint[k] * (1.0 - a - b);
        const double jacobian = (1.0 - a) * (1.0 - a - b);
        f(Vec4(1.0 - a - b - c, a, b, c), 6.0 * volume * kWeight[i] * kWeight[j] * kWeight[k] * jacobian);
      }
}

/// u = a sin πx sin πy sin πz, its gradient, and the body force −div σ(u) [N/m³].
struct Manufactured {
  Vec3 a = {1e-3, -5e-4, 7e-4};
  double lambda = 0.0;
  double mu = 1.0;

  static Vec3 slope(const Vec3& x) {
    const Vec3 s = (kPi * x).array().sin();
    const Vec3 c = (kPi * x).array().cos();
    return kPi * Vec3(c(0) * s(1) * s(2), s(0) * c(1) * s(2), s(0) * s(1) * c(2));
  }
  static double shape(const Vec3& x) { return (kPi * x).array().sin().prod(); }
  static Mat3 curvature(const Vec3& x) {
    const Vec3 s = (kPi * x).array().sin();
    const Vec3 c = (kPi * x).array().cos();
    Mat3 h = -Mat3::Identity() * s.prod();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (i != j) h(i, j) = c(i) * c(j) * s(3 - i - j);
    return kPi * kPi * h;
  }
  Vec3 displacement(const Vec3& x) const { return a * shape(x); }
  Mat3 gradient(const Vec3& x) const { return a * slope(x).transpose(); }
  Vec3 force(const Vec3& x) const {
    return 3.0 * kPi * kPi * mu * displacement(x) - (lambda + mu) * curvature(x) * a;
  }
};

/// Values (first) and gradients of a tet's shape functions at barycentric coordinates L, by their definition.
struct Shapes {
  Eigen::VectorXd value;
  Eigen::Matrix3Xd gradient;
};

Shapes compute_shapes(int num_nodes, const Vec4& L, const Eigen::Matrix<double, 3, 4>& g) {
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  Shapes s{Eigen::VectorXd(num_nodes), Eigen::Matrix3Xd(3, num_nodes)};
  for (int i = 0; i < 4; ++i) {
    s.value(i) = num_nodes == 4 ? L(i) : L(i) * (2.0 * L(i) - 1.0);
    s.gradient.col(i) = (num_nodes == 4 ? 1.0 : 4.0 * L(i) - 1.0) * g.col(i);
  }
  for (int k = 4; k < num_nodes; ++k) {
    const auto [i, j] = kEdges[k - 4];
    s.value(k) = 4.0 * L(i) * L(j);
    s.gradient.col(k) = 4.0 * (L(i) * g.col(j) + L(j) * g.col(i));
  }
  return s;
}

/// Calls f(tet, point, weight, shapes) at every quadrature point of a body.
template <typename F>
void for_each_point(const solid::Elements& e, F&& f) {
  for (int t = 0; t < e.num_tets(); ++t) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = e.rest.col(e.nodes(k + 1, t)) - e.rest.col(e.nodes(0, t));
    Eigen::Matrix<double, 3, 4> g;
    g.rightCols<3>() = edges.inverse().transpose();
    g.col(0) = -g.rightCols<3>().rowwise().sum();
    integrate(edges.determinant() / 6.0, [&](const Vec4& L, double weight) {
      Vec3 x = Vec3::Zero();
      for (int i = 0; i < 4; ++i) x += L(i) * e.rest.col(e.nodes(i, t));
      f(t, x, weight, compute_shapes(e.nodes_per_tet, L, g));
    });
  }
}

}  // namespace

double compute_timoshenko_deflection(double nu) {
  const double inertia = std::pow(0.2, 4) / 12.0;
  const double G = 1e6 / (2.0 * (1.0 + nu));
  return 1.0 / (3.0 * 1e6 * inertia) + 1.0 / (5.0 / 6.0 * G * 0.04);
}

double solve_cantilever(ElementKind element, double nu, int n, StrainModel model) {
  Scene scene(test::make_block(5 * n, n, n, Vec3(1.0, 0.2, 0.2)), std::vector{hold_plane(0, 0.0)},
              make_static_params(element, model), 1e6, nu);
  scene.load = make_end_traction(scene, 1.0, Vec3::UnitZ());
  scene.load /= scene.load.row(2).sum();
  expect(scene.find_equilibrium());
  return scene.load.row(2).dot(scene.displacement().row(2));  // the mean that the load sees
}

double solve_torsion(ElementKind element, int n) {
  const double twist = 1e-3;
  const mesh::TetMesh mesh = test::make_block(2 * n, n, n, Vec3(2.0, 1.0, 1.0));
  std::vector<Support> supports;
  const Points rest = make_elements(mesh, mesh::make_topology(mesh), element).rest;
  bool is_first = true;
  for (int v = 0; v < rest.cols(); ++v) {
    const double x = rest(0, v);
    if (std::abs(x) > 1e-9 && std::abs(x - 2.0) > 1e-9) continue;
    Support support = test::hold_nodes({v}, {is_first, true, true});
    is_first = false;
    const double angle = 0.5 * twist * (x - 1.0);
    support.displacement = angle * Vec3(0.0, -(rest(2, v) - 0.5), rest(1, v) - 0.5);
    supports.push_back(support);
  }
  Scene scene(mesh, supports, make_static_params(element), 2.6, 0.3);  // G = 1
  expect(scene.find_equilibrium());
  double torque = 0.0;
  for (int v = 0; v < rest.cols(); ++v)
    if (rest(0, v) > 2.0 - 1e-9) {
      const Vec3 f = scene.solid.forces.internal.col(v);
      torque += (rest(1, v) - 0.5) * f(2) - (rest(2, v) - 0.5) * f(1);
    }
  return torque / (0.5 * twist);  // rate of twist: the ends turn by ±twist/2 over the length 2
}

double solve_twisted_beam(ElementKind element, TipForce force, int n) {
  const double length = 12.0, width = 1.1, thickness = 0.32;
  mesh::TetMesh mesh = test::make_block(12 * n, 2 * n, n, Vec3(length, width, thickness));
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Vec3 x = mesh.vertices.col(v);
    const double angle = 0.5 * kPi * x(0) / length;
    const double y = x(1) - 0.5 * width;
    const double z = x(2) - 0.5 * thickness;
    mesh.vertices.col(v) << x(0), std::cos(angle) * y - std::sin(angle) * z,
        std::sin(angle) * y + std::cos(angle) * z;
  }
  Scene scene(std::move(mesh), std::vector{hold_plane(0, 0.0)}, make_static_params(element), 29e6, 0.22);
  const int axis = force == TipForce::along_width ? 2 : 1;  // the tip's width lies along z
  scene.load = make_end_traction(scene, length, Vec3::Unit(axis));
  scene.load /= scene.load.row(axis).sum();
  expect(scene.find_equilibrium());
  return scene.load.row(axis).dot(scene.displacement().row(axis));  // the mean that the load sees
}

double solve_cook(ElementKind element, double nu, bool is_plane_strain, int n) {
  mesh::TetMesh mesh = test::make_block(n, n, 1, Vec3::Ones());
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Vec3 x = mesh.vertices.col(v);
    mesh.vertices.col(v) = Vec3(48.0 * x(0), 44.0 * x(0) + x(1) * (44.0 - 28.0 * x(0)), x(2));
  }
  Support all;
  all.region.upper = Vec3(100, 100, 100);
  all.region.lower = Vec3(-1, -1, -1);
  all.fixes = {false, false, true};
  std::vector<Support> supports;
  if (is_plane_strain) supports.push_back(all);
  supports.push_back(hold_plane(0, 0.0, {true, true, is_plane_strain}));
  if (!is_plane_strain) supports.push_back(test::hold_nodes({0}));
  Scene scene(std::move(mesh), supports, make_static_params(element), 1.0, nu);
  scene.load = make_end_traction(scene, 48.0, Vec3::UnitY());
  scene.load /= scene.load.row(1).sum();
  expect(scene.find_equilibrium());
  Eigen::Index tip = 0;
  (scene.rest().colwise() - Vec3(48.0, 52.0, 0.0)).colwise().norm().minCoeff(&tip);
  return scene.displacement()(1, tip);
}

FieldErrors solve_manufactured(ElementKind element, double nu, int n) {
  Manufactured exact;
  exact.lambda = 2.0 * exact.mu * nu / (1.0 - 2.0 * nu);
  std::vector<Support> supports;
  for (int axis = 0; axis < 3; ++axis)
    for (const double offset : {0.0, 1.0}) supports.push_back(hold_plane(axis, offset));
  Scene scene(test::make_irregular_block(n, n, n, Vec3::Ones(), 0.12), supports, make_static_params(element),
              2.0 * exact.mu * (1.0 + nu), nu);
  const solid::Elements& e = scene.solid.model.elements;
  for_each_point(e, [&](int t, const Vec3& x, double weight, const Shapes& s) {
    for (int i = 0; i < e.nodes_per_tet; ++i)
      scene.load.col(e.nodes(i, t)) += weight * s.value(i) * exact.force(x);
  });
  expect(scene.find_equilibrium());
  const Points u = scene.displacement();
  double l2 = 0.0, h1 = 0.0, u_norm = 0.0, h_norm = 0.0;
  for_each_point(e, [&](int t, const Vec3& x, double weight, const Shapes& s) {
    Vec3 value = Vec3::Zero();
    Mat3 gradient = Mat3::Zero();
    for (int i = 0; i < e.nodes_per_tet; ++i) {
      value += s.value(i) * u.col(e.nodes(i, t));
      gradient += u.col(e.nodes(i, t)) * s.gradient.col(i).transpose();
    }
    l2 += weight * (value - exact.displacement(x)).squaredNorm();
    h1 += weight * (gradient - exact.gradient(x)).squaredNorm();
    u_norm += weight * exact.displacement(x).squaredNorm();
    h_norm += weight * exact.gradient(x).squaredNorm();
  });
  return {std::sqrt(l2 / u_norm), std::sqrt(h1 / h_norm)};
}

std::vector<double> find_frequencies(ElementKind element, double nu, int n, int count) {
  SolidParams params = make_static_params(element);
  params.density = 1.0;
  Scene scene(test::make_irregular_block(n, n, n, Vec3::Ones(), 0.1), {}, params, 1.0, nu);
  const Eigen::Index size = 3 * scene.num_nodes();
  Eigen::MatrixXd A(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    Points x = scene.rest();
    x(j % 3, j / 3) += 1e-3;
    const Points f = 1e3 * scene.compute_force(x);
    for (Eigen::Index i = 0; i < size; ++i)
      A(i, j) = f(i % 3, i / 3) /
                std::sqrt(scene.solid.materials.mass()(i / 3) * scene.solid.materials.mass()(j / 3));
  }
  const Eigen::VectorXd squares = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues();
  std::vector<double> found;
  for (int i = 0; i < count; ++i) found.push_back(std::sqrt(std::max(0.0, squares(6 + i))));
  return found;
}

namespace {

/// A free bar spinning about its centre, and what it has of energy and angular momentum.
const Vec3 kSpin(0, 0, 8.0);  // [rad/s]
const Vec3 kSpinCentre(0.1, 0.05, 0.05);

Scene make_spinning_bar(solid::Integrator integrator, solid::Iteration iteration, double youngs_modulus) {
  SolidParams params = make_static_params(ElementKind::p1, StrainModel::corotational);
  params.integrator = integrator;
  params.iteration = iteration;
  Scene scene(test::make_block(4, 2, 2, Vec3(0.2, 0.1, 0.1)), {}, params, youngs_modulus, 0.3);
  for (int v = 0; v < scene.num_nodes(); ++v)
    scene.state.v.col(v) = kSpin.cross(scene.rest().col(v) - kSpinCentre);
  return scene;
}

double compute_energy(const Scene& scene) {
  return solid::compute_kinetic_energy(scene.solid.materials, scene.region.part(), scene.state.v) +
         scene.compute_elastic_energy();
}

Vec3 compute_momentum(const Scene& scene) {
  Vec3 sum = Vec3::Zero();
  for (int v = 0; v < scene.num_nodes(); ++v)
    sum += scene.solid.materials.mass()(v) * (scene.state.x.col(v) - kSpinCentre).cross(scene.state.v.col(v));
  return sum;
}

/// Moves a bar through one turn; `step` may fail by returning false.
template <typename Step>
SpinDrift turn_once(Scene& scene, int steps, Step&& step) {
  const double energy = compute_energy(scene);
  const Vec3 momentum = compute_momentum(scene);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < steps; ++k)
    if (!step(2.0 * kPi / kSpin.norm() / steps) || !(compute_energy(scene) < 10.0 * energy))
      return {kNone, kNone};
  return {std::abs(compute_energy(scene) / energy - 1.0),
          (compute_momentum(scene) - momentum).norm() / momentum.norm()};
}

}  // namespace

SpinDrift solve_spin(solid::Integrator integrator, solid::Iteration iteration, int steps,
                     double youngs_modulus) {
  Scene scene = make_spinning_bar(integrator, iteration, youngs_modulus);
  return turn_once(scene, steps, [&](double h) { return scene.step(h).is_ok(); });
}

SpinDrift compute_rigid_spin(int steps) {
  Scene scene = make_spinning_bar(solid::Integrator::backward_euler, solid::Iteration::one, 1.0);
  const Points arm = scene.rest().colwise() - kSpinCentre;
  return turn_once(scene, steps, [&](double h) {
    const Points aim = (scene.state.x + h * scene.state.v).colwise() - kSpinCentre;
    const Eigen::JacobiSVD<Mat3> svd(aim * scene.solid.materials.mass().asDiagonal() * arm.transpose(),
                                     Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Points next = (svd.matrixU() * svd.matrixV().transpose() * arm).colwise() + kSpinCentre;
    scene.state.v = (next - scene.state.x) / h;
    scene.state.x = next;
    return true;
  });
}

double solve_swing(solid::Integrator integrator, int steps) {
  const auto run = [](solid::Integrator kind, int count) {
    SolidParams params = make_static_params(ElementKind::p1, StrainModel::neo_hookean);
    params.integrator = kind;
    params.iteration = solid::Iteration::newton;
    Scene scene(test::make_block(3, 1, 1, Vec3(0.3, 0.1, 0.1)), std::vector{hold_plane(0, 0.0)}, params, 3e4,
                0.3);
    for (int n = 0; n < scene.num_nodes(); ++n)
      scene.state.v.col(n) = scene.rest()(0, n) / 0.3 * Vec3(-0.9, 1.5, 3.0);
    for (int k = 0; k < count; ++k) expect(scene.step(0.05 / count));
    Points result(3, 2 * scene.num_nodes());
    result << scene.displacement(), 0.01 * scene.state.v;
    return result;
  };
  static const Points reference = run(solid::Integrator::newmark, 6400);
  return (run(integrator, steps) - reference).norm() / reference.norm();
}

}  // namespace argil::verification
