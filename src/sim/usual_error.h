#pragma once

#include "solid/parameters.h"

namespace argil::sim {

/// The error of an elastic force falls as the size of cells to this power: a pressure has a rim.
inline constexpr double kContactOrder = 1.5;

/// By how much of itself an elastic force is usually off on so many cells along the radius of contact: with
/// linear tets a sphere or cone is felt 18, 6 and 2 % too hard at 2, 4 and 8 (results/contact), with ten-node
/// tets it is 3 and 1 % off at 1 and 2 (results/accuracy). Below one cell a face of the size h bears as E h,
/// where Hertz's patch bears as E a.
double find_usual_error(solid::ElementKind element, double cells);

}  // namespace argil::sim
