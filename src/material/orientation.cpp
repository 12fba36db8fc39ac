#include "material/orientation.h"

#include <cmath>

#include "base/mandel.h"

namespace argil::material {

Mat6 make_mandel_rotation(const Mat3& Q) {
  Mat6 turn;
  for (int j = 0; j < 6; ++j) turn.col(j) = to_mandel(Q * from_mandel(Vec6::Unit(j)) * Q.transpose());
  return turn;
}

Mat6 lay_along(const Mat6& C, const Vec3& axis) {
  // Any frame with `axis` as its third vector does; the coordinate that is farthest from it gives the first.
  Eigen::Index farthest = 0;
  axis.cwiseAbs().minCoeff(&farthest);
  Mat3 Q;
  Q.col(2) = axis;
  Q.col(0) = axis.cross(Vec3::Unit(farthest)).normalized();
  Q.col(1) = axis.cross(Q.col(0));
  const Mat6 turn = make_mandel_rotation(Q);
  const Mat6 turned = turn * C * turn.transpose();
  return 0.5 * (turned + turned.transpose());  // symmetric but for rounding
}

}  // namespace argil::material
