#pragma once

#include "embed/triangle_tree.h"

namespace argil::embed {

/// Where the middle of an edge between a and b of a boundary that follows a surface belongs: as far off the
/// surface as a and b are in the mean. The middle itself where one of them is more than a tenth of the edge
/// off.
Vec3 find_bent_middle(const TriangleTree& surface, const Vec3& a, const Vec3& b);

}  // namespace argil::embed
