#pragma once

namespace argil::contact {

struct ContactParams {
  double vertex_face_stiffness = 0.0;  ///< k_vf [N/m], eq. 7
  double edge_edge_stiffness = 0.0;    ///< k_ee [N/m], eq. 8
};

}  // namespace argil::contact
