#pragma once

#include <string>

namespace argil::run {

/// How `argil export` was called.
struct ExportOptions {
  std::string result;
  std::string html;         ///< page to write; empty: none
  std::string vtu;          ///< list (.pvd) of a series of .vtu files to write; empty: none
  double megabytes = 12.0;  ///< [MB] that the frames of a page may take before compression
  bool cage = false;        ///< show the cage's boundary also where there is a skin
};

/// Writes what other programs look at results with; says on standard output what it wrote and left out.
/// Returns kDone. Throws InputError, IoError.
int export_result(const ExportOptions& options);

}  // namespace argil::run
