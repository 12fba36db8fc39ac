// A run that Python steps: ticks and what there is to read between them. Arrays are one entity a row, in the
// order of the result file.

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <atomic>
#include <memory>
#include <utility>

#include "base/error.h"
#include "mesh/order.h"
#include "output/info.h"
#include "python/bindings.h"
#include "run/stepper.h"

namespace argil::python {
namespace {

namespace py = pybind11;
using Numbers3 = std::array<double, 3>;
using Numbers4 = std::array<double, 4>;

/// Read-only rows of a matrix that `owner` keeps: its columns, which lie in memory as numpy's rows do.
template <class Matrix>
py::array view(const Matrix& columns, const py::handle& owner) {
  using Number = typename Matrix::Scalar;
  const py::ssize_t size = sizeof(Number), rows = columns.cols(), width = columns.rows();
  const bool is_list = Matrix::ColsAtCompileTime == 1;
  py::array array = is_list ? py::array(py::dtype::of<Number>(), {width}, {size}, columns.data(), owner)
                            : py::array(py::dtype::of<Number>(), {rows, width}, {size * width, size},
                                        columns.data(), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// The same of a matrix that the array keeps.
template <class Matrix>
py::array keep(Matrix columns) {
  auto owned = std::make_unique<Matrix>(std::move(columns));
  const Matrix& matrix = *owned;
  const py::capsule owner(owned.get(), [](void* kept) { delete static_cast<Matrix*>(kept); });
  owned.release();
  return view(matrix, owner);
}

py::array keep_vector(const Vec3& vector) {
  return keep(Field(vector));
}

device::ToolMode parse_mode(const std::string& name) {
  if (const auto mode = device::find_tool_mode(name)) return *mode;
  throw InputError("mode", name, "is no mode of a tool", "give push, pull, wet or dry");
}

class SteppedRun {
 public:
  SteppedRun(const LoadedScenario& loaded, int threads, const std::string& record,
             const std::optional<Numbers3>& position, const std::optional<Numbers4>& orientation,
             const std::optional<std::string>& mode) {
    run::StepperOptions options{record, loaded.options.trace, std::nullopt};
    const LoadedScenario scenario = with_threads(loaded, threads);
    if (position) {
      device::DeviceSample start;
      start.mode = run::find_fixed_mode(scenario.s).value_or(start.mode);
      options.start = place(start, *position, orientation, mode);
    }
    const py::gil_scoped_release others_may_go_on;
    m_stepper = std::make_unique<run::Stepper>(scenario.s, options);
  }

  void tick() {
    make([&] { return m_stepper->tick(); });
  }
  void tick_at(const Numbers3& position, const std::optional<Numbers4>& orientation,
               const std::optional<std::string>& mode) {
    make([&] { return m_stepper->tick(place(m_stepper->hand(), position, orientation, mode)); });
  }
  void finish(bool is_interrupted) {
    const Use use(*this);
    const py::gil_scoped_release others_may_go_on;
    m_stepper->finish(is_interrupted);
  }

  /// What reads the run between two ticks.
  template <class Read>
  auto read(const Read& read) {
    const Use use(*this);
    return read(*m_stepper);
  }

  /// The body as it is now, made once a tick.
  py::array frame(py::array (*choose)(const sim::Frame&, const py::handle&)) {
    const Use use(*this);
    if (!m_frame) {
      const py::gil_scoped_release others_may_go_on;
      const sim::Simulation& simulation = m_stepper->simulation();
      m_frame =
          std::make_shared<const sim::Frame>(simulation.body_side().make_frame(simulation.hand().pose()));
    }
    auto kept = std::make_unique<std::shared_ptr<const sim::Frame>>(m_frame);
    const py::capsule owner(
        kept.get(), [](void* frame) { delete static_cast<std::shared_ptr<const sim::Frame>*>(frame); });
    kept.release();
    return choose(*m_frame, owner);
  }

 private:
  /// While it lives, no other thread of Python gets in.
  class Use {
   public:
    explicit Use(SteppedRun& run) : m_is_used(run.m_is_used) {
      if (m_is_used.exchange(true)) throw std::runtime_error("this simulation is in use by another thread");
    }
    ~Use() { m_is_used = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    std::atomic<bool>& m_is_used;
  };

  static device::DeviceSample place(device::DeviceSample sample, const Numbers3& position,
                                    const std::optional<Numbers4>& orientation,
                                    const std::optional<std::string>& mode) {
    sample.position = Vec3(position.data());
    if (orientation) sample.orientation = Quat(Vec4(orientation->data()));  // x, y, z, w
    if (mode) sample.mode = parse_mode(*mode);
    return sample;
  }

  template <class Tick>
  void make(const Tick& tick) {
    const Use use(*this);
    m_frame.reset();
    const py::gil_scoped_release others_may_go_on;
    const StepStatus status = tick();
    if (!status.is_ok())
      throw RunFailed{
          {run::kRunFailed, "run failed: " + output::describe_failure(status.failure()), status.failure()}};
  }

  std::unique_ptr<run::Stepper> m_stepper;
  std::shared_ptr<const sim::Frame> m_frame;
  std::atomic<bool> m_is_used = false;
};

/// As in /physics of a result.
py::dict list_parts(const sim::ForceErrorParts& parts) {
  using namespace py::literals;
  return py::dict("mesh"_a = parts.mesh, "step"_a = parts.step, "contact"_a = parts.contact,
                  "solver"_a = parts.solver, "left_out"_a = parts.left_out);
}

py::dict list_physics(const sim::PhysicsRecord& r) {
  using namespace py::literals;
  return py::dict("tick"_a = r.tick, "time"_a = r.time, "kinetic_energy"_a = r.kinetic_energy,
                  "elastic_energy"_a = r.elastic_energy, "plastic_dissipation"_a = r.plastic_dissipation,
                  "contact_work"_a = r.contact_work, "water_mass"_a = r.water_mass,
                  "water_added"_a = r.water_added, "water_removed"_a = r.water_removed,
                  "newton_iterations"_a = r.newton_iterations, "iterations"_a = r.iterations,
                  "factorisations"_a = r.factorisations, "residual"_a = r.residual,
                  "active_nodes"_a = r.active_nodes, "min_volume_ratio"_a = r.min_volume_ratio,
                  "max_plastic_strain"_a = r.max_plastic_strain, "limited_tets"_a = r.limited_tets,
                  "limited_tet"_a = r.limited_tet, "epoch"_a = r.epoch);
}

/// As in /mesh of a result.
py::dict list_mesh(run::Stepper& stepper) {
  const sim::Body& body = stepper.simulation().body();
  py::dict mesh;
  mesh["rest_position"] = keep(Points(body.mesh.vertices));
  mesh["tets"] = keep(mesh::in_file_order(body.mesh, body.mesh.tets));
  mesh["surface_triangles"] = keep(Triangles(body.topology.boundary));
  mesh["skin_triangles"] = keep(Triangles(body.skin.triangles));
  mesh["tool_vertices"] = keep(Points(stepper.scene().tool.vertices));
  mesh["tool_triangles"] = keep(Triangles(stepper.scene().tool.triangles));
  return mesh;
}

std::vector<std::string> list_notes(const run::Stepper& stepper) {
  std::vector<std::string> notes = stepper.scene().notes;
  if (!stepper.scene().contact_cells.empty()) notes.push_back(stepper.scene().contact_cells);
  return notes;
}

/// A property of the last tick's record.
template <class Choose>
auto haptic(const Choose& choose) {
  return [choose](SteppedRun& run) {
    return run.read([&](run::Stepper& stepper) { return choose(stepper.simulation().haptic_record()); });
  };
}

/// A property of the body as it is now.
template <auto member>
py::array frame(SteppedRun& run) {
  return run.frame([](const sim::Frame& now, const py::handle& owner) { return view(now.*member, owner); });
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<SteppedRun>(module, "Simulation")
      .def(py::init<const LoadedScenario&, int, const std::string&, const std::optional<Numbers3>&,
                    const std::optional<Numbers4>&, const std::optional<std::string>&>())
      .def("tick", &SteppedRun::tick)
      .def("tick_at", &SteppedRun::tick_at)
      .def("finish", &SteppedRun::finish)
      .def_property_readonly("ticks", haptic([](const sim::HapticRecord& r) { return r.tick; }))
      .def_property_readonly("time", haptic([](const sim::HapticRecord& r) { return r.time; }))
      .def_property_readonly("force", haptic([](const sim::HapticRecord& r) { return keep_vector(r.force); }))
      .def_property_readonly("torque",
                             haptic([](const sim::HapticRecord& r) { return keep_vector(r.torque); }))
      .def_property_readonly("force_error",
                             haptic([](const sim::HapticRecord& r) { return r.error.total(); }))
      .def_property_readonly("force_error_parts",
                             haptic([](const sim::HapticRecord& r) { return list_parts(r.error); }))
      .def_property_readonly("device_force",
                             haptic([](const sim::HapticRecord& r) { return keep_vector(r.device_force); }))
      .def_property_readonly("tool_position",
                             haptic([](const sim::HapticRecord& r) { return keep_vector(r.tool_position); }))
      .def_property_readonly("tool_orientation", haptic([](const sim::HapticRecord& r) {
                               return keep(Field(r.tool_orientation.coeffs()));
                             }))
      .def_property_readonly(
          "mode", haptic([](const sim::HapticRecord& r) { return std::string(to_string(r.mode)); }))
      .def_property_readonly("num_contacts",
                             haptic([](const sim::HapticRecord& r) { return r.num_contacts; }))
      .def_property_readonly("positions", &frame<&sim::Frame::position>)
      .def_property_readonly("saturation", &frame<&sim::Frame::saturation>)
      .def_property_readonly("plastic_strain", &frame<&sim::Frame::plastic_strain>)
      .def_property_readonly("skin_positions", &frame<&sim::Frame::skin_position>)
      .def_property_readonly("skin_saturation", &frame<&sim::Frame::skin_saturation>)
      .def("physics",
           [](SteppedRun& run) {
             return run.read(
                 [](run::Stepper& stepper) { return list_physics(stepper.simulation().physics_record()); });
           })
      .def_property_readonly(
          "epoch",
          [](SteppedRun& run) {
            return run.read([](run::Stepper& stepper) { return stepper.simulation().body().epoch; });
          })
      .def("mesh", [](SteppedRun& run) { return run.read(list_mesh); })
      .def("notes", [](SteppedRun& run) { return run.read(list_notes); })
      .def("state_hash",
           [](SteppedRun& run) {
             return run.read([](run::Stepper& stepper) { return stepper.simulation().state_hash(); });
           })
      .def_property_readonly("period",
                             [](SteppedRun& run) {
                               return run.read([](run::Stepper& stepper) {
                                 return stepper.scenario().params.rates.haptic_period;
                               });
                             })
      .def_property_readonly("num_ticks", [](SteppedRun& run) {
        return run.read([](run::Stepper& stepper) { return stepper.num_ticks(); });
      });
}

}  // namespace argil::python
