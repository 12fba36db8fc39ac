#pragma once

// What a result file contains: every name, type, unit and meaning once, for the writer, the reader and the
// checks. The table in this folder's README follows it.

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "hdf5/file.h"

namespace argil::output::schema {

inline constexpr const char* kFormat = "argil-result";
inline constexpr int kFormatVersion = 1;

/// Column of a series: one row a haptic tick or a physics step.
struct Column {
  const char* name;
  hdf5::Element element;
  unsigned width;  ///< numbers in a row
  hdf5::Label label;
};

using enum hdf5::Element;

inline constexpr std::array kHaptic = {
    Column{"tick", int64, 1, {"1", "count of haptic periods since the start"}},
    Column{"time", real64, 1, {"s", "time since the start, tick times period"}},
    Column{"tool_position", real64, 3, {"m", "hand's point of the tool, world coordinates"}},
    Column{"tool_orientation", real64, 4, {"1", "unit quaternion x, y, z, w, tool frame to world"}},
    Column{"force", real64, 3, {"N", "force on the hand before the output gate"}},
    Column{"torque", real64, 3, {"N m", "torque on the hand about the hand's point, before the output gate"}},
    Column{"device_force", real64, 3, {"N", "force after the output gate, as the device renders it"}},
    Column{"mode", uint8, 1, {"1", "what the tool does: 0 push, 1 pull, 2 wet, 3 dry"}},
    Column{"force_age", int32, 1, {"1", "haptic periods since the force was computed"}},
    Column{"num_contacts", int32, 1, {"1", "contacts that made the force"}},
    Column{"gate_events",
           uint8,
           1,
           {"1",
            "what the output gate did, sum of 1 not finite, 2 clamped, 4 slew, 8 ramp, 16 watchdog, 32 no "
            "sample yet"}},
    Column{"port_energy",
           real64,
           1,
           {"J", "work of device force and torque on the hand since the start; > 0: made by the simulation"}},
    Column{"passivity_energy",
           real64,
           1,
           {"J", "energy that the passivity controller has kept from the hand since the start"}},
};

/// In the same group, in runs that estimate it: by how much the force is off.
inline constexpr std::array kForceError = {
    Column{"force_error",
           real64,
           1,
           {"N", "estimate: by how much the force on the hand is off, the sum of the parts"}},
    Column{
        "force_error_parts",
        real64,
        5,
        {"N",
         "mesh, step, contact, solver, left out; mesh (>= 0, too stiff) and contact (<= 0, too soft) have a "
         "sign and count as the size of their sum"}},
};

inline constexpr std::array kPhysics = {
    Column{"tick", int64, 1, {"1", "haptic tick of the physics step"}},
    Column{"time", real64, 1, {"s", "time since the start, tick times haptic period"}},
    Column{"kinetic_energy", real64, 1, {"J", "kinetic energy of the body"}},
    Column{"elastic_energy", real64, 1, {"J", "elastic energy of the body"}},
    Column{"plastic_dissipation", real64, 1, {"J", "energy dissipated by plastic flow since the start"}},
    Column{"contact_work", real64, 1, {"J", "work of the contact forces on the body since the start"}},
    Column{"water_mass", real64, 1, {"kg", "water in the body"}},
    Column{"water_added", real64, 1, {"kg", "water given by the tool since the start"}},
    Column{"water_removed", real64, 1, {"kg", "water taken by the tool since the start"}},
    Column{"newton_iterations", int32, 1, {"1", "linearisations of this step"}},
    Column{"iterations", int32, 1, {"1", "iterations of the linear solver in this step"}},
    Column{"factorisations", int32, 1, {"1", "factorisations of the system matrix since the start"}},
    Column{"residual", real64, 1, {"1", "relative residual of the linear solve"}},
    Column{"active_nodes", int32, 1, {"1", "vertices that were solved for"}},
    Column{"min_volume_ratio", real64, 1, {"1", "smallest det F over the tets"}},
    Column{
        "max_plastic_strain", real64, 1, {"1", "largest Frobenius norm of the plastic strain over the tets"}},
    Column{
        "limited_tets",
        int32,
        1,
        {"1",
         "tets whose motion was limited, or they would have turned inside out; all: the whole body's was"}},
    Column{"limited_tet", int32, 1, {"1", "number of the worst of them; -1: none"}},
    Column{"epoch", int32, 1, {"1", "how often the body has got new cells before the step: in /epochs"}},
};

/// A step that may leave out parts of the model, and its error where a full run goes beside.
inline constexpr const char* kFidelity = "fidelity";
inline constexpr std::array kFidelityStep = {
    Column{"tick", int64, 1, {"1", "haptic tick of the physics step"}},
    Column{"rung",
           uint8,
           1,
           {"1", "what was computed: 0 nothing, the body sleeps; 1 no solve, it coasts; 2 the whole step"}},
    Column{"bound", real64, 1, {"N", "error that the force at the hand may have"}},
    Column{"estimate", real64, 1, {"N", "by what the step left out"}},
    Column{"large_strain",
           real64,
           1,
           {"1", "mean strain: of the force, by which other laws of elasticity may differ"}},
};
inline constexpr Column kFidelityError{
    "error", real64, 1, {"N", "that it had since the last step, beside a full run of the same motion"}};
inline constexpr std::array kFidelityCheckedStep = {kFidelityStep[0], kFidelityStep[1], kFidelityStep[2],
                                                    kFidelityStep[3], kFidelityStep[4], kFidelityError};

/// A live session's side of each haptic tick: what it took from outside.
inline constexpr const char* kSession = "session";
inline constexpr std::array kSessionTick = {
    Column{"sample", int64, 1, {"1", "number of the device's sample that the tick consumed, from 1"}},
    Column{"seen_step", int64, 1, {"1", "last physics step whose surface the tick met; 0: none"}},
    Column{"begun_step", int64, 1, {"1", "physics step that took its input at the tick's end; 0: none"}},
    Column{"device_state",
           uint8,
           1,
           {"1", "0 stopped, 1 connecting, 2 ready, 3 stale, 4 lost: as the device said in the tick"}},
    Column{"feed",
           uint8,
           1,
           {"1", "what the force rested on: 0 fresh, 1 a sample or a surface that was too old, 2 no sample"}},
};
inline constexpr hdf5::Label kStartPosition{"m", "hand's point before the first tick"};
inline constexpr hdf5::Label kStartOrientation{"1", "unit quaternion x, y, z, w before the first tick"};
inline constexpr hdf5::Label kStartMode{"1", "mode before the first tick, as in /haptic"};

/// Wall clock of each tick and of each step of a live session, in /timing.
inline constexpr std::array kTickTiming = {
    Column{"wake_late", real64, 1, {"s", "how late the hand's thread woke for the tick"}},
    Column{"work", real64, 1, {"s", "from waking to the force that was sent"}},
    Column{"sample_age", real64, 1, {"s", "of the consumed sample on the device's clock"}},
    Column{"missed", int32, 1, {"1", "periods that passed without a tick before it"}},
};
inline constexpr std::array kStepTiming = {
    Column{"wait", real64, 1, {"s", "from the hand's giving to the step's begin"}},
    Column{"work", real64, 1, {"s", "that the step took"}},
    Column{"late", int32, 1, {"1", "ticks beyond the planned ones that the step had to wait for"}},
};

/// Cells that the body got while the run went on, in groups by number, from 000001.
inline constexpr const char* kEpochs = "epochs";
/// Of a frame or an epoch: its group.
inline std::string name_number(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  return std::string(6 - std::min<std::size_t>(6, digits.size()), '0') + digits;
}
/// The cells of an epoch; those of the start are in /mesh.
inline hdf5::Group open_mesh(const hdf5::Group& root, int epoch) {
  if (epoch == 0) return root.open_group("mesh");
  return root.open_group(kEpochs)
      .open_group(name_number(static_cast<std::uint64_t>(epoch)))
      .open_group("mesh");
}
/// In /timing: what the ticks of passes before the result's own took of all processors [s].
inline constexpr const char* kCpuOfPasses = "cpu_of_passes";
inline constexpr const char* kAccuracy = "accuracy";  ///< group: attributes of a run to /fidelity/accuracy
inline constexpr const char* kEpoch = "epoch";        ///< attribute of a frame; none in the first
inline constexpr hdf5::Label kTouchedPosition{"m", "what the tool meets: positions of its vertices, at rest"};
inline constexpr hdf5::Label kTouchedTriangles{"1", "what the tool meets: vertex numbers, outward"};
inline constexpr hdf5::Label kSkinRestPosition{"m", "rest positions of the skin's vertices"};
inline constexpr hdf5::Label kRestVolumeRatio{"1",
                                              "volume of each tet without pressure, over that of its mesh"};
inline constexpr hdf5::Label kHeld{"1", "vertices that a support of the scenario holds"};
inline constexpr hdf5::Label kYoungsModulus{"Pa", "Young's modulus of each tet, dry"};

/// Haptic ticks and physics steps that are kept in memory before they are written: about a second and about
/// two kB a column; a killed run loses at most these.
inline constexpr std::uint64_t kHapticChunk = 1024;
inline constexpr std::uint64_t kPhysicsChunk = 256;

/// Group of what frames' arrays are views of, where a run was packed: in order, a distinct one a row.
inline constexpr const char* kPacked = "packed";

/// Group of an unfinished run's last checkpoint; its arrays are the state's by name, one entity a row.
inline constexpr const char* kCheckpoint = "checkpoint";
inline constexpr hdf5::Label kState{"-", "part of the state from which the run is resumed, SI units"};

// Arrays of /mesh and of each frame.
inline constexpr hdf5::Label kRestPosition{"m", "rest positions of the cage's vertices"};
inline constexpr hdf5::Label kTets{"1", "vertex numbers of the tets, from 0, positive volume"};
inline constexpr hdf5::Label kSurfaceTriangles{"1", "boundary of the tets, vertex numbers, outward"};
inline constexpr hdf5::Label kSkinTriangles{"1", "triangles of the skin, numbers of skin vertices, outward"};
inline constexpr hdf5::Label kToolVertices{"m", "vertices of the tool's surface in its own frame"};
inline constexpr hdf5::Label kToolTriangles{"1", "triangles of the tool's surface, outward"};
inline constexpr hdf5::Label kTouchedPlaces{"m", "x, y, z, radius of the places by which cells were graded"};
inline constexpr hdf5::Label kPosition{"m", "positions of the cage's vertices"};
inline constexpr hdf5::Label kSaturation{"1", "water saturation of each tet, 0 to 1"};
inline constexpr hdf5::Label kPlasticStrain{"1",
                                            "plastic strain of each tet, Mandel: 11 22 33 √2·23 √2·13 √2·12"};
inline constexpr hdf5::Label kPlasticNorm{"1", "Frobenius norm of the plastic strain of each tet"};
inline constexpr hdf5::Label kSkinPosition{"m", "positions of the skin's vertices"};
inline constexpr hdf5::Label kSkinSaturation{"1", "water saturation at the skin's vertices, 0 to 1"};
inline constexpr hdf5::Label kSkinInfluence{
    "1", "the tool's region of influence at the skin's vertices, 0 to 1; 0 without a clay kernel"};

}  // namespace argil::output::schema
