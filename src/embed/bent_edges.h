#pragma once

#include "embed/triangle_tree.h"

namespace argil::embed {

/// Where the middle of an edge between a and b belongs on a surface that was moved out by `level` [m], as
/// both its ends were; the middle itself where one of them is elsewhere.
Vec3 find_bent_middle(const TriangleTree& surface, double level, const Vec3& a, const Vec3& b);

}  // namespace argil::embed
