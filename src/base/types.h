#pragma once

// The one way into Eigen for the whole project, and the array shapes every folder shares.
// Arrays hold one entity a column. Vertices, tets and triangles are numbered by plain int from 0.

#ifdef __FAST_MATH__
#error "argil's determinism does not survive -ffast-math; remove the flag"
#endif

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>

namespace argil {

using Vec3 = Eigen::Vector3d;
using Vec4 = Eigen::Vector4d;
using Mat3 = Eigen::Matrix3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;  ///< symmetric tensor, Mandel: 11 22 33 √2·23 √2·13 √2·12
using Mat6 = Eigen::Matrix<double, 6, 6>;  ///< fourth-order tensor with minor symmetry, Mandel
using Quat = Eigen::Quaterniond;

using Points = Eigen::Matrix3Xd;                     ///< 3×n, one point or vector a column
using Triangles = Eigen::Matrix3Xi;                  ///< 3×m vertex numbers, counter-clockwise from outside
using Tets = Eigen::Matrix<int, 4, Eigen::Dynamic>;  ///< 4×m vertex numbers, positive volume
using Field = Eigen::VectorXd;                       ///< one scalar per entity
using TensorField = Eigen::Matrix<double, 6, Eigen::Dynamic>;  ///< one symmetric tensor per entity, Mandel

/// Count of haptic periods since the start of the run. Ticks are numbered from 1 by the count at their end: a
/// clock that has made k ticks is about to make, or is making, tick k + 1.
using Tick = std::int64_t;

}  // namespace argil
