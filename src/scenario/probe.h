#pragma once

#include <string>

namespace argil::scenario {

/// One law at a point: reads {"cases": [{…}]} and returns {"results": [{…}]}, same order, 17 digits, computed
/// by the code that a simulation runs. Kernels: effective_medium, eshelby, vertex_face, edge_edge, polar,
/// element, plastic_update, clay_kernel; what each takes and gives stands in this folder's README. Throws
/// InputError (kernel, case, key).
std::string run_probe(const std::string& kernel, const std::string& text);

}  // namespace argil::scenario
