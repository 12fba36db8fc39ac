#pragma once

#include <string>

#include "scenario/json_document.h"
#include "scenario/probe.h"

namespace argil::scenario {

/// The result of one case, given as JSON.
inline Json probe_one(const std::string& kernel, const std::string& probe_case) {
  return parse_json(run_probe(kernel, "{\"cases\": [" + probe_case + "]}"), "results")["results"][0];
}

inline double at(const Json& list, std::size_t i) {
  return list[i].get<double>();
}
inline double at(const Json& rows, std::size_t i, std::size_t j) {
  return rows[i][j].get<double>();
}

}  // namespace argil::scenario
