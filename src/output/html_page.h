#pragma once

#include <string>
#include <vector>

namespace argil::output {

struct PageOptions {
  std::string viewer;             ///< the page without data that scripts/build_viewer makes
  double frame_megabytes = 12.0;  ///< [MB] for all frames before compression; says how many frames are shown
  bool wants_cage = false;        ///< the boundary of the cage, also where there is a skin
};

/// Writes one page that shows a result in a browser without a network: moving surface coloured by a field,
/// tool, force and its plot. Where the frames do not fit, fewer are shown. Returns what the page leaves out
/// or rounds, in the words that stand on it. Throws IoError or InputError.
std::vector<std::string> write_html(const std::string& result_file, const std::string& html_file,
                                    const PageOptions& options);

}  // namespace argil::output
