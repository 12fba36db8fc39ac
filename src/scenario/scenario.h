#pragma once

#include <string>
#include <vector>

#include "device/hand_model.h"
#include "device/trace.h"
#include "embed/cage.h"
#include "output/frame_precision.h"
#include "shapes/shapes.h"
#include "sim/params.h"
#include "solid/loads.h"

namespace argil::scenario {

enum class BodyKind { mesh, shape, surface };
enum class ToolKind { sphere, capsule, stylus, mesh };
enum class ModeChoice { push, pull, wet, dry, trace };

/// What is computed.
enum class Mode {
  dynamic,      ///< the hand's motion over a trace
  equilibrium,  ///< "static": one equilibrium under the loads, without tool and trace
};

/// Settings that stand below a scenario's own keys.
enum class Preset {
  none,
  paper,  ///< the paper to the letter: linear strain, dilute scheme, per-step kernel, literal flow, 14 ticks'
          ///< hold
};

/// Whether a body gets new cells while the run goes on.
enum class RemeshWhen {
  never,
  when_spoilt,  ///< by the flow of the clay
};

enum class CellKind {
  even,    ///< all of one size
  graded,  ///< small where the tool comes
};

/// A ball in which cells are small.
struct CellRegion {
  Vec3 centre = Vec3::Zero();  ///< [m]
  double radius = 0.0;         ///< [m]
  double size = 0.0;           ///< of cells within, at most [m]
};

struct CellSpec {
  CellKind kind = CellKind::even;
  RemeshWhen remesh = RemeshWhen::when_spoilt;
  double near_tool = 0.0;           ///< graded: size where the tool comes [m]; 0: chosen
  double growth = 0.0;              ///< graded: of the size per distance from there [–]; 0: chosen
  std::vector<CellRegion> regions;  ///< graded
};

/// Where the body comes from. Exactly one kind is given.
struct BodySpec {
  BodyKind kind = BodyKind::shape;
  std::string file;                      ///< mesh, surface
  std::string cage_file;                 ///< surface: a cage made before; empty: made now
  double scale = 1.0;                    ///< file's unit in metres
  shapes::Shape shape;                   ///< shape
  int target_tets = 10000;               ///< shape; surface without a cage file
  embed::Fit fit = embed::Fit::enclose;  ///< surface, shape with a skin
  int skin_triangles = 20000;            ///< shape: at least so many; 0: no skin
  double sliver = 1.0;                   ///< shape: height of one tet over what it was [–]; 1: as it was
  std::string saturation_field;          ///< mesh: cell data with the initial saturation; empty: uniform
  std::string modulus_field;             ///< mesh: cell data with Young's modulus [Pa]; empty: the material's
  std::string
      pore_axis_field;  ///< mesh: cell data NAME_x, NAME_y, NAME_z along aligned pores; empty: one axis
  std::vector<solid::Support> fixed;
  solid::Loads loads;
  CellSpec cells;
};

struct ToolSpec {
  ToolKind kind = ToolKind::sphere;
  double radius = 0.008;      ///< [m]
  double tip_radius = 0.001;  ///< stylus [m]
  double length = 0.05;       ///< capsule, stylus [m]
  int subdivisions = 3;       ///< sphere
  int segments = 24;          ///< capsule, stylus: around the axis
  std::string file;           ///< mesh
  double scale = 1.0;         ///< mesh
  ModeChoice mode = ModeChoice::trace;
};

struct TraceSpec {
  std::string file;
  device::TraceOptions options;
  double start = 0.0;     ///< [s] into the trace
  double duration = 0.0;  ///< [s]; 0: to its end
};

/// Who moves the tool.
enum class HandKind {
  prescribed,  ///< it is where the trace is
  simulated,   ///< a mass on a spring whose other end is where the trace is; it yields to the device's force
};

struct HandSpec {
  HandKind kind = HandKind::prescribed;
  device::HandParams params;
};

/// A validated scene in SI units; paths resolved against the scenario's folder.
struct Scenario {
  Scenario();  ///< extent, law of contact and touched surface as they are where a scenario does not say

  std::string file;
  std::string about;
  Preset preset = Preset::none;
  Mode mode = Mode::dynamic;
  BodySpec body;
  ToolSpec tool;
  TraceSpec trace;
  HandSpec hand;
  sim::Params params;
  int checkpoint_period_ticks = 1000;  ///< of runs with a trace; 0: none but where a signal ends it
  output::FramePrecision frame_precision = output::FramePrecision::whole;
  double accuracy = 0.0;       ///< wanted of the force at the hand [–]: cells are chosen; 0: as given
  bool allow_locking = false;  ///< run nearly incompressible tets although they lock
  std::string medium_status;   ///< where eq. 6 stands at all that the run can reach; empty when it
                               ///< takes the mesh's fields to know (then Scene has it)
  std::vector<std::string> warnings;  ///< of validation; a run prints them and writes them to its file
};

/// One `--set /json/pointer=value`.
struct Setting {
  std::string pointer;
  std::string value;  ///< JSON; anything that is no JSON is taken as a string
};

/// Splits "/a/b=value". Throws InputError.
Setting parse_setting(const std::string& text);

/// Where the motion of a scenario comes from.
enum class MotionSource {
  trace,   ///< /trace/file must be there
  device,  ///< it need not: a device, or a program
};

/// Reads, applies the preset and the settings, checks every key, type and range, and the combinations that
/// cannot run. Throws InputError naming file, JSON pointer, value, allowed range and unit; IoError when the
/// file cannot be read.
Scenario load_scenario(const std::string& file, const std::vector<Setting>& settings,
                       MotionSource motion = MotionSource::trace);

/// A file that a run reads.
struct InputFile {
  std::string pointer;  ///< of the key that names it; empty: the scenario itself
  std::string file;
};

/// The scenario and every file that it names, both of a TetGen pair.
std::vector<InputFile> list_input_files(const Scenario& scenario);

/// The scene with every default written out, keys in the table's order, as JSON. Loading it gives it again.
std::string print_resolved(const Scenario& scenario);

/// The same with files relative to the scenario's folder: what a result keeps and hashes, so that two
/// checkouts write the same bits. `unchecked` settings come on top, also such as no scenario may have.
std::string print_portable(const Scenario& scenario, const std::vector<Setting>& unchecked = {});

/// JSON Schema (2020-12) of a scenario.
std::string print_schema();

/// Reference page (Markdown): one row a key.
std::string print_reference();

}  // namespace argil::scenario
