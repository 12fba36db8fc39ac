#pragma once

#include "base/types.h"

namespace argil::material {

/// 6×6 orthogonal matrix that turns Mandel vectors as Q turns vectors: to_mandel(Q a Qᵀ) = turn ·
/// to_mandel(a).
Mat6 make_mandel_rotation(const Mat3& Q);

/// A stiffness that does not change when turned about axis 3 (Mandel), with that axis laid along `axis` (unit
/// length; its sign does not matter).
Mat6 lay_along(const Mat6& C, const Vec3& axis);

}  // namespace argil::material
