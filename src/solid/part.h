#pragma once

#include "base/lanes.h"
#include "base/ordered_loops.h"
#include "solid/model.h"

namespace argil::solid {

/// The part of a body that a stage works on; without lists, all of it.
struct Part {
  explicit Part(const Model& model);

  OrderedRuns rows;       ///< of the system, that are solved for
  OrderedRuns near_rows;  ///< and those that tets around these rows pull at
  OrderedItems nodes;     ///< of tets that may move
  OrderedRuns batches;    ///< of kLanes tets that may move (each_points: their points)
};

static_assert(OrderedRuns::kLength == kLanes);

inline Part::Part(const Model& model)
    : rows(model.threads), near_rows(model.threads), nodes(model.threads), batches(model.threads) {
  rows.prepare(model.num_free());
  near_rows.prepare(model.num_free());
  nodes.prepare(model.elements.num_nodes());
  batches.prepare(model.elements.num_tets());
}

}  // namespace argil::solid
