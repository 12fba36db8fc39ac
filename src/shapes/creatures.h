#pragma once

#include "shapes/implicit.h"

namespace argil::shapes {

/// A striding tyrannosaur of `length` [m] from snout (+x) to tail, soles at z = 0, symmetric in y.
ImplicitSurface make_dinosaur(double length);

/// A standing person of `height` [m] who looks along +x, soles at z = 0, symmetric in y.
ImplicitSurface make_figure(double height);

}  // namespace argil::shapes
