#include "sim/usual_error.h"

#include <cmath>

namespace argil::sim {

double find_usual_error(solid::ElementKind element, double cells) {
  constexpr double kOfLinearTets = 0.5, kOfQuadraticTets = 0.03;  // on one cell
  const double scale = element == solid::ElementKind::p2 ? kOfQuadraticTets : kOfLinearTets;
  return scale * (cells < 1.0 ? 1.0 / cells : std::pow(cells, -kContactOrder));
}

}  // namespace argil::sim
