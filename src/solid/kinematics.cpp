#include "solid/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

Kinematics::Kinematics(const Elements& elements, StrainModel model, bool has_lag, bool has_deformed_frames)
    : m_model(model), m_points_per_tet(elements.points_per_tet), m_has_deformed_frames(has_deformed_frames) {
  const Eigen::Index num_points = elements.num_points();
  if (!find_law(model).lanes.forces) m_deformation.resize(3, 3 * num_points);
  m_rotation.resize(3, 3 * num_points);
  m_strain.setZero(6, num_points);
  m_volume_ratio.setOnes(num_points);
  m_turned_gradient.setZero(3, elements.gradient.cols());
  m_frame.setZero(3, 3 * num_points);
  if (has_lag) {
    m_committed_frame.resize(3, 3 * num_points);
    m_changed_frames.resize(static_cast<std::size_t>(num_points));
  }
  const Eigen::Index num_batches = (elements.num_tets() + kLanes - 1) / kLanes;
  m_batch_volume_ratio.setOnes(num_batches);
  m_group_volume_ratio.setOnes((num_batches + kBatchGroup - 1) / kBatchGroup);
}

void Kinematics::update(const Elements& elements, const Eigen::Matrix3Xd& gradient, const Points& x,
                        const Update& how) {
  const PointArrays points{x.data(),
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
  const auto compute = elements.nodes_per_tet == 4 ? compute_motions : compute_quadratic_motions;
  const Eigen::Index Q = m_points_per_tet;
  how.batches.each(elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    each_points(elements, begin, end,
                [&](std::ptrdiff_t first, std::ptrdiff_t last) { compute(points, first, last); });
    m_batch_volume_ratio(begin / kLanes) = find_least(m_volume_ratio.segment(Q * begin, Q * (end - begin)));
    how.is_moved[static_cast<std::size_t>(begin / kLanes)] = 1;
  });
  m_min_volume_ratio = find_least_of_groups(how.batches.list());
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
  for (int point = m_points_per_tet * tet; point < m_points_per_tet * (tet + 1); ++point) {
    keep_committed_frame(point);
    m_frame.middleCols<3>(3 * static_cast<Eigen::Index>(point)).setZero();
  }
}

void Kinematics::renew_frame(int tet) {
  if (!m_has_deformed_frames) return;
  for (int point = m_points_per_tet * tet; point < m_points_per_tet * (tet + 1); ++point) {
    keep_committed_frame(point);
    m_frame.middleCols<3>(3 * static_cast<Eigen::Index>(point)) = at(point).F;
  }
}

void Kinematics::keep_committed_frame(int point) {
  const Eigen::Index first = 3 * static_cast<Eigen::Index>(point);
  if (has_lag() && m_changed_frames.set(static_cast<std::size_t>(point)))
    m_committed_frame.middleCols<3>(first) = m_frame.middleCols<3>(first);
}

void Kinematics::roll_back(const Eigen::Matrix3Xd& gradient) {
  for (std::size_t point = 0; point < m_changed_frames.size(); ++point) {
    if (!m_changed_frames.is_set(point)) continue;
    const auto p = static_cast<Eigen::Index>(point);
    const Mat3 Q = m_committed_frame.middleCols<3>(3 * p);
    m_frame.middleCols<3>(3 * p) = Q;
    if (m_has_deformed_frames) continue;
    for (Eigen::Index i = 4 * p; i < 4 * (p + 1); ++i)  // in the order of operations of compute_motions
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
