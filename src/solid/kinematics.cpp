#include "solid/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

/// Of all numbers, NaN where any of them is not finite.
template <class Numbers>
double find_least(const Numbers& numbers) {
  double least = std::numeric_limits<double>::infinity();
  double nothing = 0.0;  // 0·x: NaN where x is not finite
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    least = std::min(least, numbers(i));
    nothing += 0.0 * numbers(i);
  }
  return least + nothing;
}

}  // namespace

Kinematics::Kinematics(const Elements& elements, StrainModel model, bool has_lag, bool has_deformed_frames,
                       int threads)
    : m_model(model), m_threads(threads), m_has_deformed_frames(has_deformed_frames) {
  const Eigen::Index num_points = elements.num_points();
  const bool is_linear_tet = elements.nodes_per_tet == 4;
  if (!is_linear_tet || !find_law(model).lanes.forces) m_deformation.resize(3, 3 * num_points);
  m_rotation.resize(3, 3 * num_points);
  m_strain.setZero(6, num_points);
  m_volume_ratio.setOnes(num_points);
  m_turned_gradient.setZero(3, elements.gradient.cols());
  m_frame.setZero(3, is_linear_tet ? 3 * num_points : 0);
  if (has_lag && is_linear_tet) {
    m_committed_frame.resize(3, 3 * num_points);
    m_changed_frames.resize(static_cast<std::size_t>(num_points));
  }
  const Eigen::Index num_batches = (elements.num_tets() + kLanes - 1) / kLanes;
  m_batch_volume_ratio.setOnes(num_batches);
  m_group_volume_ratio.setOnes((num_batches + kBatchGroup - 1) / kBatchGroup);
}

void Kinematics::update(const Elements& elements, const Eigen::Matrix3Xd& gradient, const Points& x,
                        const Update& how) {
  if (elements.nodes_per_tet == 4) {
    set_tets(elements, gradient, x, how);
    m_min_volume_ratio = find_least_of_groups(how.batches.list());
  } else {
    set_quadratic(elements, gradient, x, how.keeps_frames);
    m_min_volume_ratio = find_least(m_volume_ratio);
  }
}

void Kinematics::set_tets(const Elements& elements, const Eigen::Matrix3Xd& gradient, const Points& x,
                          const Update& how) {
  const TetArrays tets{x.data(),
                       elements.nodes.data(),
                       gradient.data(),
                       find_law(m_model).is_linear,
                       keeps_deformation() ? m_deformation.data() : nullptr,
                       m_rotation.data(),
                       how.keeps_frames || m_has_deformed_frames ? nullptr : m_turned_gradient.data(),
                       m_frame.data(),
                       how.frame_tolerance,
                       m_strain.data(),
                       m_volume_ratio.data(),
                       how.is_turned.data(),
                       has_lag() ? &m_changed_frames : nullptr,
                       m_committed_frame.data(),
                       m_has_deformed_frames && !how.keeps_frames};
  const auto set = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    compute_motions(tets, begin, end);
    m_batch_volume_ratio(begin / kLanes) = find_least(m_volume_ratio.segment(begin, end - begin));
    how.is_moved[static_cast<std::size_t>(begin / kLanes)] = 1;
  };
  how.batches.each(elements.num_tets(), set);
}

void Kinematics::set_quadratic(const Elements& elements, const Eigen::Matrix3Xd& rest_gradient,
                               const Points& x, bool keeps_frames) {
  constexpr int N = 10;
  parallel_for(elements.num_points(), m_threads, [&](std::ptrdiff_t p) {
    const int tet = elements.tet_of_point(static_cast<int>(p));
    const Eigen::Matrix<double, 3, N> gradient = rest_gradient.middleCols<N>(N * p);
    Eigen::Matrix<double, 3, N> corners;
    for (int i = 0; i < N; ++i) corners.col(i) = x.col(elements.nodes(i, tet));
    const Mat3 F = corners * gradient.transpose();
    const PointMotion motion = make_motion(m_model, F);
    m_deformation.middleCols<3>(3 * p) = F;
    m_rotation.middleCols<3>(3 * p) = motion.R;
    if (!keeps_frames) m_turned_gradient.middleCols<N>(N * p) = motion.R * gradient;
    m_strain.col(p) = compute_strain(F, motion.R);
    m_volume_ratio(p) = F.determinant();
  });
}

/// Of groups of batches in which none has moved it is known.
double Kinematics::find_least_of_groups(const std::vector<int>* batches) {
  const Eigen::Index num_batches = m_batch_volume_ratio.size();
  const auto renew = [&](Eigen::Index group) {
    const Eigen::Index begin = kBatchGroup * group;
    m_group_volume_ratio(group) =
        find_least(m_batch_volume_ratio.segment(begin, std::min(kBatchGroup, num_batches - begin)));
  };
  if (!batches) {
    for (Eigen::Index group = 0; group < m_group_volume_ratio.size(); ++group) renew(group);
  } else {
    Eigen::Index last = -1;
    for (const int batch : *batches)
      if (batch / kBatchGroup != last) renew(last = batch / kBatchGroup);
  }
  return find_least(m_group_volume_ratio);
}

void Kinematics::drop_frame(int tet) {
  if (m_frame.size() == 0) return;
  keep_committed_frame(tet);
  m_frame.middleCols<3>(3 * static_cast<Eigen::Index>(tet)).setZero();
}

void Kinematics::renew_frame(int tet) {
  if (m_frame.size() == 0 || !m_has_deformed_frames) return;
  keep_committed_frame(tet);
  m_frame.middleCols<3>(3 * static_cast<Eigen::Index>(tet)) = at(tet).F;
}

void Kinematics::keep_committed_frame(int tet) {
  const Eigen::Index first = 3 * static_cast<Eigen::Index>(tet);
  if (has_lag() && m_changed_frames.set(static_cast<std::size_t>(tet)))
    m_committed_frame.middleCols<3>(first) = m_frame.middleCols<3>(first);
}

void Kinematics::roll_back(const Eigen::Matrix3Xd& gradient) {
  for (std::size_t tet = 0; tet < m_changed_frames.size(); ++tet) {
    if (!m_changed_frames.is_set(tet)) continue;
    const auto t = static_cast<Eigen::Index>(tet);
    const Mat3 Q = m_committed_frame.middleCols<3>(3 * t);
    m_frame.middleCols<3>(3 * t) = Q;
    if (m_has_deformed_frames) continue;
    for (Eigen::Index i = 4 * t; i < 4 * (t + 1); ++i)  // in the order of operations of compute_motions
      m_turned_gradient.col(i) =
          (Q.col(0) * gradient(0, i) + Q.col(1) * gradient(1, i)) + Q.col(2) * gradient(2, i);
  }
  m_changed_frames.clear();
}

PointMotion Kinematics::at(int point) const {
  const auto first = 3 * static_cast<Eigen::Index>(point);
  const Mat3 R = m_rotation.middleCols<3>(first);
  if (keeps_deformation()) return {m_deformation.middleCols<3>(first), R};
  return {R * (Mat3::Identity() + from_mandel(m_strain.col(point))), R};
}

int Kinematics::find_worst_point() const {
  Eigen::Index worst = 0;
  if (std::isfinite(m_min_volume_ratio))
    m_volume_ratio.minCoeff(&worst);
  else
    while (std::isfinite(m_volume_ratio(worst))) ++worst;
  return static_cast<int>(worst);
}

void Kinematics::serialize_frames(Archive& archive) {
  archive.array("solid/frame", m_frame);
  if (!m_has_deformed_frames) archive.array("solid/turned_gradient", m_turned_gradient);
}

}  // namespace argil::solid
