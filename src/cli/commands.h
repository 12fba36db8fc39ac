#pragma once

namespace CLI {
class App;
}

namespace argil::cli {

// Each adds commands to `app`. The exit code of the one that is called goes to `code`, which must live until
// the command line is parsed.
void add_run_commands(CLI::App& app,
                      int& code);  ///< run, live, devices, validate, show, place, new, schema, info, export, compare
void add_law_commands(CLI::App& app, int& code);    ///< probe, ccd, cage
void add_study_commands(CLI::App& app, int& code);  ///< chart, stability, sweep

}  // namespace argil::cli
