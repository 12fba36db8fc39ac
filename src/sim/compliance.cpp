#include "sim/compliance.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "solid/response.h"

namespace argil::sim {

LocalCompliance::LocalCompliance(const ContactSurface& surface, int num_nodes)
    : m_row_of_node(static_cast<std::size_t>(num_nodes), -1),
      m_known_of_vertex(static_cast<std::size_t>(surface.num_vertices()), -1) {
  for (Eigen::Index i = 0; i < surface.triangles().size(); ++i)
    for (const int node : surface.nodes(surface.triangles().data()[i]))
      m_row_of_node[static_cast<std::size_t>(node)] = 0;
  for (int n = 0; n < num_nodes; ++n) {
    if (m_row_of_node[static_cast<std::size_t>(n)] < 0) continue;
    m_row_of_node[static_cast<std::size_t>(n)] = 3 * static_cast<int>(m_nodes.size());
    m_nodes.push_back(n);
  }
  m_displacement.setZero(3 * static_cast<Eigen::Index>(m_nodes.size()));
  m_own = m_displacement;
  m_load.setZero(3, num_nodes);
}

namespace {

/// Number of vertices whose columns one physics step solves for at most.
constexpr int kSolvedAStep = 4;

}  // namespace

void LocalCompliance::learn(const BodyBetweenSteps& body, int vertex) {
  if (m_known_of_vertex[static_cast<std::size_t>(vertex)] >= 0) return;
  const std::size_t place = m_state.known.size();
  const auto needed = 3 * static_cast<Eigen::Index>(place + 1);
  if (m_columns.cols() < needed) {
    m_columns.conservativeResize(m_displacement.size(), 2 * needed);
    m_between.conservativeResize(2 * needed, 2 * needed);
  }
  m_known_of_vertex[static_cast<std::size_t>(vertex)] = static_cast<int>(place);
  m_state.known.push_back(vertex);
  m_state.is_guess.push_back(1);
  m_state.force.push_back(Vec3::Zero());
  m_state.held.push_back(Vec3::Zero());
  guess_columns(body, place);
}

void LocalCompliance::guess_columns(const BodyBetweenSteps& body, std::size_t place) {
  if (!m_is_prepared) solid::prepare_response(body.solid, body.part, body.state, body.step_s);
  m_is_prepared = true;
  const std::span<const int> nodes = body.surface.nodes(m_state.known[place]);
  const std::span<const double> weights = body.surface.weights(m_state.known[place]);
  auto columns = m_columns.middleCols<3>(3 * static_cast<Eigen::Index>(place));
  columns.setZero();
  for (std::size_t k = 0; k < nodes.size(); ++k)
    columns.middleRows<3>(m_row_of_node[static_cast<std::size_t>(nodes[k])]) =
        weights[k] * m_state.guess_factor * solid::compute_local_response(body.solid, nodes[k]);
  update_between(body.surface, place);
}

StepStatus LocalCompliance::solve_columns(const BodyBetweenSteps& body, std::size_t place) {
  guess_columns(body, place);
  const double guessed = between(place, place).trace() / m_state.guess_factor;
  const std::span<const int> nodes = body.surface.nodes(m_state.known[place]);
  const std::span<const double> weights = body.surface.weights(m_state.known[place]);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < nodes.size(); ++k) m_load(axis, nodes[k]) = weights[k];
    ARGIL_TRY(solid::find_response(body.solid, body.part, m_load, body.tick, m_response));
    for (const int node : nodes) m_load(axis, node) = 0.0;
    auto column = m_columns.col(3 * static_cast<Eigen::Index>(place) + axis);
    for (std::size_t s = 0; s < m_nodes.size(); ++s)
      column.segment<3>(3 * static_cast<Eigen::Index>(s)) = m_response.col(m_nodes[s]);
  }
  m_state.is_guess[place] = 0;
  update_between(body.surface, place);
  const double solved = between(place, place).trace();
  if (guessed > 0.0) m_state.guess_factor = std::max(1.0, solved / guessed);
  return StepStatus::ok();
}

/// Symmetric, as solves are but for their tolerance. A guess moves its own nodes alone, so that between a
/// guess and a solution there is nothing: with either kind by itself the whole is positive semidefinite.
void LocalCompliance::update_between(const ContactSurface& surface, std::size_t place) {
  const auto moved = [&](std::size_t i, std::size_t j) {
    const std::span<const int> nodes = surface.nodes(m_state.known[i]);
    const std::span<const double> weights = surface.weights(m_state.known[i]);
    Mat3 sum = Mat3::Zero();
    for (std::size_t k = 0; k < nodes.size(); ++k)
      sum += weights[k] * m_columns.block<3, 3>(m_row_of_node[static_cast<std::size_t>(nodes[k])],
                                                3 * static_cast<Eigen::Index>(j));
    return sum;
  };
  for (std::size_t i = 0; i < m_state.known.size(); ++i) {
    Mat3 block = Mat3::Zero();
    if (m_state.is_guess[i] == m_state.is_guess[place])
      block = 0.5 * (moved(i, place) + moved(place, i).transpose());
    const auto row = 3 * static_cast<Eigen::Index>(i), column = 3 * static_cast<Eigen::Index>(place);
    m_between.block<3, 3>(row, column) = block;
    m_between.block<3, 3>(column, row) = block.transpose();
  }
}

/// The last known vertex takes the place of the one that is forgotten.
void LocalCompliance::forget(std::size_t place) {
  const std::size_t last = m_state.known.size() - 1;
  m_known_of_vertex[static_cast<std::size_t>(m_state.known[place])] = -1;
  if (place != last) {
    m_known_of_vertex[static_cast<std::size_t>(m_state.known[last])] = static_cast<int>(place);
    m_columns.middleCols<3>(3 * static_cast<Eigen::Index>(place)) =
        m_columns.middleCols<3>(3 * static_cast<Eigen::Index>(last));
    const auto from = 3 * static_cast<Eigen::Index>(last), to = 3 * static_cast<Eigen::Index>(place);
    m_between.middleCols<3>(to) = m_between.middleCols<3>(from);
    m_between.middleRows<3>(to) = m_between.middleRows<3>(from);
    m_state.known[place] = m_state.known[last];
    m_state.is_guess[place] = m_state.is_guess[last];
    m_state.force[place] = m_state.force[last];
    m_state.held[place] = m_state.held[last];
  }
  m_state.known.pop_back();
  m_state.is_guess.pop_back();
  m_state.force.pop_back();
  m_state.held.pop_back();
}

StepStatus LocalCompliance::begin_frame(const BodyBetweenSteps& body, const Points& x_before) {
  m_has_begun_frame = true;
  m_columns_before = m_columns.leftCols(3 * static_cast<Eigen::Index>(m_state.known.size()));
  m_is_prepared = false;
  // What acted is what was held less what the body yielded to it in the step.
  for (std::size_t s = 0; s < m_nodes.size(); ++s)
    m_own.segment<3>(3 * static_cast<Eigen::Index>(s)) =
        body.state.x.col(m_nodes[s]) - x_before.col(m_nodes[s]);
  std::fill(m_state.held.begin(), m_state.held.end(), Vec3::Zero());
  for (const auto& [spring, share, group] : m_acting) {
    if (!body.solid.contacts.is_acting(group)) continue;
    const double yielded = spring.normal.dot(compute_mean(body.surface, spring, m_own));
    const Vec3 acted = share * (spring.force - spring.stiffness * yielded) * spring.normal;
    for (std::size_t i = 0; i < 3 && spring.vertex[i] >= 0; ++i) {
      learn(body, spring.vertex[i]);
      m_state.held[place_of(spring.vertex[i])] += spring.weight[i] * acted;
    }
  }
  for (std::size_t i = m_state.known.size(); i-- > 0;)
    if (m_state.held[i].isZero(0.0) && m_state.force[i].isZero(0.0)) forget(i);
  ARGIL_TRY(solve_due_columns(body));
  update_displacement();
  return StepStatus::ok();
}

StepStatus LocalCompliance::solve_due_columns(const BodyBetweenSteps& body) {
  int solved = 0;
  for (int guess = find_most_pressed_guess(); guess >= 0 && solved < kSolvedAStep; ++solved) {
    ARGIL_TRY(solve_columns(body, static_cast<std::size_t>(guess)));
    guess = find_most_pressed_guess();
  }
  if (solved < kSolvedAStep && !m_state.known.empty())
    ARGIL_TRY(solve_columns(body, m_state.next_renewed++ % m_state.known.size()));
  for (std::size_t i = 0; i < m_state.known.size(); ++i)
    if (m_state.is_guess[i]) guess_columns(body, i);
  return StepStatus::ok();
}

/// By what held it in the last step; −1: there is none.
int LocalCompliance::find_most_pressed_guess() const {
  int most = -1;
  for (std::size_t i = 0; i < m_state.known.size(); ++i)
    if (m_state.is_guess[i] && (most < 0 || m_state.held[i].squaredNorm() >
                                                m_state.held[static_cast<std::size_t>(most)].squaredNorm()))
      most = static_cast<int>(i);
  return most;
}

void LocalCompliance::update_displacement() {
  m_displacement.setZero();
  for (std::size_t i = 0; i < m_state.known.size(); ++i) {
    const Vec3 change = m_state.force[i] - m_state.held[i];
    for (int axis = 0; axis < 3; ++axis)
      if (change(axis) != 0.0)
        m_displacement += change(axis) * m_columns.col(3 * static_cast<Eigen::Index>(i) + axis);
  }
}

void LocalCompliance::release() {
  std::fill(m_state.force.begin(), m_state.force.end(), Vec3::Zero());
  update_displacement();
}

void LocalCompliance::commit() {
  if (m_has_begun_frame) m_acting.clear();
  m_has_begun_frame = false;
  m_committed = m_state;
  m_committed_acting = m_acting.size();
}

/// Ticks append columns; only the begin of a frame changes those that were there.
void LocalCompliance::roll_back(const ContactSurface& surface) {
  for (const int vertex : m_state.known) m_known_of_vertex[static_cast<std::size_t>(vertex)] = -1;
  m_state = m_committed;
  m_acting.resize(m_committed_acting);
  if (m_has_begun_frame) m_columns = m_columns_before;
  m_has_begun_frame = false;
  m_is_prepared = false;
  find_places(surface);
}

/// All that follows from what is known.
void LocalCompliance::find_places(const ContactSurface& surface) {
  for (std::size_t i = 0; i < m_state.known.size(); ++i)
    m_known_of_vertex.at(static_cast<std::size_t>(m_state.known[i])) = static_cast<int>(i);
  m_between.setZero(m_columns.cols(), m_columns.cols());
  for (std::size_t i = 0; i < m_state.known.size(); ++i) update_between(surface, i);
  update_displacement();
}

void LocalCompliance::serialize(Archive& archive, const ContactSurface& surface) {
  archive.records("compliance/acting", m_acting, [](Acting& acting, auto field) {
    list_spring_fields(acting.spring, field), field(acting.share), field(acting.group);
  });
  archive.list("compliance/known", m_state.known);
  archive.list("compliance/force", m_state.force);
  archive.list("compliance/held", m_state.held);
  archive.list("compliance/is_guess", m_state.is_guess);
  archive.number("compliance/guess_factor", m_state.guess_factor);
  archive.number("compliance/next_renewed", m_state.next_renewed);
  const auto num_columns = 3 * static_cast<Eigen::Index>(m_state.known.size());
  Eigen::MatrixXd columns(m_displacement.size(), archive.is_restoring() ? 0 : num_columns);
  if (columns.cols() > 0) columns = m_columns.leftCols(num_columns);
  archive.any_size("compliance/columns", columns);
  if (!archive.is_restoring()) return;
  m_columns = columns;
  find_places(surface);
  commit();
}

Vec3 LocalCompliance::compute_mean(const ContactSurface& surface, const ContactSpring& spring,
                                   const Eigen::VectorXd& displacement) const {
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < 3 && spring.vertex[i] >= 0; ++i) {
    const std::span<const int> nodes = surface.nodes(spring.vertex[i]);
    const std::span<const double> weights = surface.weights(spring.vertex[i]);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      mean += spring.weight[i] * weights[k] *
              displacement.segment<3>(m_row_of_node[static_cast<std::size_t>(nodes[k])]);
  }
  return mean;
}

double LocalCompliance::compute_deflection(const ContactSurface& surface, const ContactSpring& spring) const {
  return spring.normal.dot(compute_mean(surface, spring, m_displacement));
}

void LocalCompliance::displace(const Points& x, Points& displaced) const {
  displaced = x;
  for (std::size_t s = 0; s < m_nodes.size(); ++s)
    displaced.col(m_nodes[s]) += m_displacement.segment<3>(3 * static_cast<Eigen::Index>(s));
}

/// Row by row, for springs c and d: how far d's unit force moves the body at c along c's normal, and 1/k_c on
/// the diagonal. The right side is f_in/k and what the present forces F have moved already.
void LocalCompliance::assemble_balance(const std::vector<ContactSpring>& springs) {
  const std::size_t m = springs.size();
  m_balance.assign(m * m, 0.0);
  m_right.assign(m, 0.0);
  for (std::size_t c = 0; c < m; ++c) {
    const ContactSpring& at = springs[c];
    m_right[c] = at.force / at.stiffness;
    for (std::size_t i = 0; i < 3 && at.vertex[i] >= 0; ++i) {
      const std::size_t place = place_of(at.vertex[i]);
      const Vec3 direction = at.weight[i] * at.normal;
      for (std::size_t k = 0; k < m_state.known.size(); ++k)
        if (!m_state.force[k].isZero(0.0)) m_right[c] += direction.dot(between(place, k) * m_state.force[k]);
      for (std::size_t d = 0; d <= c; ++d)
        for (std::size_t j = 0; j < 3 && springs[d].vertex[j] >= 0; ++j)
          m_balance[c * m + d] +=
              springs[d].weight[j] *
              direction.dot(between(place, place_of(springs[d].vertex[j])) * springs[d].normal);
    }
    for (std::size_t d = 0; d < c; ++d) m_balance[d * m + c] = m_balance[c * m + d];
    m_balance[c * m + c] += 1.0 / at.stiffness;
  }
}

/// Balance of the pressed springs alone, by Cholesky's factor. False when it is not positive definite.
bool LocalCompliance::solve_balance(std::size_t m) {
  const std::size_t n = m_pressed.size();
  m_factor.resize(m * m);
  m_trial.assign(m, 0.0);
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return m_factor[i * m + j]; };
  const auto spring_of = [&](std::size_t i) { return static_cast<std::size_t>(m_pressed[i]); };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = m_balance[spring_of(i) * m + spring_of(j)];
      for (std::size_t k = 0; k < j; ++k) sum -= at(i, k) * at(j, k);
      if (i == j && !(sum > 0.0)) return false;
      at(i, j) = i == j ? std::sqrt(sum) : sum / at(j, j);
    }
  for (std::size_t i = 0; i < n; ++i) {
    double sum = m_right[spring_of(i)];
    for (std::size_t k = 0; k < i; ++k) sum -= at(i, k) * m_trial[spring_of(k)];
    m_trial[spring_of(i)] = sum / at(i, i);
  }
  for (std::size_t i = n; i-- > 0;) {
    double sum = m_trial[spring_of(i)];
    for (std::size_t k = i + 1; k < n; ++k) sum -= at(k, i) * m_trial[spring_of(k)];
    m_trial[spring_of(i)] = sum / at(i, i);
  }
  return true;
}

/// Springs that would draw are let go, those let go that would press again are taken back one by one, the
/// one that presses most first.
StepStatus LocalCompliance::press(const BodyBetweenSteps& body, std::vector<ContactSpring>& springs) {
  for (const ContactSpring& spring : springs) {
    ARGIL_DCHECK(spring.stiffness > 0.0);
    for (std::size_t i = 0; i < 3 && spring.vertex[i] >= 0; ++i) learn(body, spring.vertex[i]);
  }
  assemble_balance(springs);
  const std::size_t m = springs.size();
  m_pressed.clear();
  for (std::size_t c = 0; c < m; ++c)
    if (m_right[c] > 0.0) m_pressed.push_back(static_cast<int>(c));
  bool is_balanced = false;
  for (std::size_t round = 0; round <= 3 * m && !is_balanced; ++round) {
    if (!solve_balance(m))
      return StepStatus::failed(
          {body.tick, "contact", -1, "compliance is not positive definite, pivot", 0.0, 0.0});
    const auto draws = [this](int c) { return m_trial[static_cast<std::size_t>(c)] < 0.0; };
    if (std::erase_if(m_pressed, draws) > 0) continue;
    double largest = 0.0;
    int taken = -1;
    for (std::size_t c = 0; c < m; ++c) {
      if (std::binary_search(m_pressed.begin(), m_pressed.end(), static_cast<int>(c))) continue;
      double gap = m_right[c];
      for (std::size_t d = 0; d < m; ++d) gap -= m_balance[c * m + d] * m_trial[d];
      if (gap <= largest) continue;
      largest = gap;
      taken = static_cast<int>(c);
    }
    constexpr double kTouching = 1e-12;  // [m] rounding of positions
    is_balanced = largest <= kTouching;
    if (!is_balanced) m_pressed.insert(std::lower_bound(m_pressed.begin(), m_pressed.end(), taken), taken);
  }
  if (!is_balanced)
    return StepStatus::failed({body.tick, "contact", -1, "rounds in which the compliance finds no balance",
                               static_cast<double>(3 * m + 1), static_cast<double>(3 * m)});
  std::fill(m_state.force.begin(), m_state.force.end(), Vec3::Zero());
  for (std::size_t c = 0; c < m; ++c) {
    springs[c].force = std::max(0.0, m_trial[c]);
    for (std::size_t i = 0; i < 3 && springs[c].vertex[i] >= 0; ++i)
      m_state.force[place_of(springs[c].vertex[i])] +=
          springs[c].weight[i] * springs[c].force * springs[c].normal;
  }
  update_displacement();
  return StepStatus::ok();
}

}  // namespace argil::sim
