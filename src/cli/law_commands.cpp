// Single laws and tools: what a run is made of.

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <iterator>
#include <memory>

#include "cli/commands.h"
#include "cli/finite_number.h"
#include "contact/queries.h"
#include "embed/cage.h"
#include "mesh/quality.h"
#include "mesh_files/readers.h"
#include "run/files.h"
#include "run/run.h"
#include "scenario/cell_sizes.h"
#include "scenario/probe.h"

namespace argil::cli {
namespace {

using run::ExitCode;

/// What the commands of this file are given; they share it, for only one of them runs.
struct Options {
  std::string first, second;
  double separation = 0.0;
  embed::CageOptions cage;
  std::string fit = "surface";
  std::string motion;
  double near_size = 0.0;  // [m]
  double scale = 1.0;
};

int make_cage_file(const Options& o) {
  const std::string& surface = o.first;
  const std::string& output = o.second;
  run::require_input_file(surface);
  run::check_cage_name(surface, output);
  embed::CageOptions options = o.cage;
  options.fit = o.fit == "surface" ? embed::Fit::surface : embed::Fit::enclose;
  mesh_files::FileVertices vertices;
  const mesh::TriangleMesh skin = mesh_files::read_triangle_mesh(surface, o.scale, &vertices);
  if (vertices.num_left_out() > 0)
    std::fprintf(stderr, "argil: note: %s\n", vertices.describe(surface, "triangle").c_str());
  embed::Cage cage = embed::make_cage(skin, options, surface);
  std::printf("%s: %d vertices, %s\n", output.c_str(), cage.mesh.num_vertices(),
              embed::describe(cage.report).c_str());
  if (!o.motion.empty()) {
    run::require_input_file(o.motion);
    cage.mesh = scenario::grade_cage(cage, options.fit, skin, device::read_trace(o.motion, {}), o.near_size);
    std::printf("near %s: %d vertices, %d tets\n", o.motion.c_str(), cage.mesh.num_vertices(),
                cage.mesh.num_tets());
  }
  mesh_files::write_gmsh(cage.mesh, output);
  return ExitCode::kDone;
}

int print_times_of_impact(const std::string& kind, const std::string& queries, double separation) {
  const auto pair = kind == "vertex-face" ? contact::PairKind::vertex_face : contact::PairKind::edge_edge;
  run::require_input_file(queries);
  const contact::QueryFile file = contact::read_queries(queries);
  std::puts("query,hit,time_of_impact");
  for (std::size_t q = 0; q < file.paths.size(); ++q) {
    if (const auto time = contact::find_time_of_impact(pair, file.paths[q], separation))
      std::printf("%zu,1,%.17g\n", q, *time);
    else
      std::printf("%zu,0,\n", q);
  }
  return ExitCode::kDone;
}

}  // namespace

void add_law_commands(CLI::App& app, int& code) {
  const auto o = std::make_shared<Options>();
  CLI::App* probe = app.add_subcommand("probe", "one law at a point: JSON on standard input and output");
  probe->add_option("KERNEL", o->first, "the law; src/scenario/README.md lists them")->required();
  probe->callback([o, &code] {
    const std::string text((std::istreambuf_iterator<char>(std::cin)), std::istreambuf_iterator<char>());
    std::cout << scenario::run_probe(o->first, text);
  });

  CLI::App* ccd =
      app.add_subcommand("ccd", "time of impact of each query of a file, by the simulation's own detection");
  ccd->add_option("--kind", o->second, "vertex-face or edge-edge")
      ->required()
      ->check(CLI::IsMember({"vertex-face", "edge-edge"}));
  ccd->add_option("QUERIES", o->first, "CSV, eight rows of rational coordinates a query")->required();
  ccd->add_option("--minimum-separation", o->separation,
                  "report pairs that come this near, in the file's unit")
      ->check(finite_number(true))
      ->capture_default_str();
  ccd->callback([o, &code] { code = print_times_of_impact(o->second, o->first, o->separation); });

  CLI::App* cage = app.add_subcommand("cage", "make a tetrahedral body of a surface");
  cage->add_option("SURFACE", o->first, "OBJ, OFF, PLY or STL, clean or not")->required();
  cage->add_option("-o,--output", o->second, "cage (Gmsh, .msh)")->required();
  cage->add_option("--tets", o->cage.target_tets, "wanted number of tets")
      ->check(CLI::Range(100, 5000000))
      ->capture_default_str();
  cage->add_option("--fit", o->fit, "surface: the boundary lies on it; enclose: it is all inside")
      ->check(CLI::IsMember({"surface", "enclose"}))
      ->capture_default_str();
  CLI::Option* near = cage->add_option("--near", o->motion, "trace: cells are small where it goes");
  CLI::Option* size = cage->add_option("--near-size", o->near_size, "their size there, in metres")
                          ->check(finite_number(false));
  near->needs(size);
  size->needs(near);
  cage->add_option("--scale", o->scale, "metres per unit of the file")->check(finite_number(false));
  cage->callback([o, &code] { code = make_cage_file(*o); });
}

}  // namespace argil::cli
