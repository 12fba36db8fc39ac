#pragma once

#include "solid/body.h"
#include "solid/part.h"

namespace argil::solid {

/// Points at their yield resist a step as they flow, but those that it takes back from there, which do so as
/// elastic ones. Does the present iterate take n : dε of them, n along their elastic strain, below zero? At a
/// step's start, by the speed of the last one. Elastic strains must be known.
void begin_unloading(Body& body, const Part& part);

/// Of a point at its yield, dev ε_e over its norm, Mandel, in the frame of R; zero of others, and where its
/// elastic strain is not known.
Vec6 find_flow_direction(const Body& body, Eigen::Index point);

/// By a solution. True where it takes points back that were to flow, and what they resist with as elastic
/// ones is more than `enough`, as residuals are measured: the same step is to be solved anew. Those that were
/// not to flow stay elastic for this step.
bool find_unloading(Body& body, const Part& part, double enough);

}  // namespace argil::solid
