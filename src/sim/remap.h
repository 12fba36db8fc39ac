#pragma once

#include "sim/state.h"
#include "solid/body.h"

namespace argil::sim {

/// What a body of new cells takes over from one of the same shape, besides what its Body says.
struct RemappedState {
  Points v;             ///< 3×nodes [m/s]
  TensorField elastic;  ///< 6×points: logarithmic elastic strain ½ ln FₑFₑᵀ in space, Mandel
  TensorField flow;     ///< 6×tets: plastic strain so far, turned with the clay, Mandel; for pictures
};

/// ½ ln FₑFₑᵀ at each point in space, Mandel. Of Hencky's law.
TensorField find_elastic_strain(const solid::Body& solid);

/// Takes what the clay of `solid` is like now to the cells of `to`, which lie where its own lie at x: water,
/// moduli, pores' axes and supports go into `to`, the rest is returned. A four-node tet gets the mean over
/// its places, a point of a ten-node tet and a node what is there. A tet is at rest
/// where its volume is without pressure. A node is held where nodes that are held carry its place by kHeld
/// and more. Water keeps its mass to rounding: so does the saturation, but for what the sizes of both bodies
/// differ by.
///
/// `to`: mesh, topology and skin are made. The cells' shape at rest is the present one. `flow`: of each old
/// tet, in its shape at rest.
RemappedState remap(const Body& from, const solid::Body& solid, const Points& x, const Field& saturation,
                    const TensorField& flow, Body& to);

}  // namespace argil::sim
