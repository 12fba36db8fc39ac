#pragma once

#include "solid/contacts.h"
#include "solid/elastic_strains.h"
#include "solid/energy.h"
#include "solid/forces.h"
#include "solid/model.h"
#include "solid/predict.h"
#include "solid/residual.h"
#include "solid/scratch.h"
#include "solid/solver_history.h"
#include "solid/state.h"
#include "solid/system.h"

namespace argil::solid {

/// A body and all that its steps write, by the stage that writes it.
struct Body {
  Body(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<Support> supports,
       const SolidParams& params, int threads);
  Body(const Body&) = delete;  // owners refer to one another
  Body& operator=(const Body&) = delete;

  const Model model;
  Materials materials;
  SolidState committed;                         ///< where the step begins
  SolidState trial;                             ///< its iterate
  const TensorField* plastic_strain = nullptr;  ///< of the step
  Kinematics kinematics;                        ///< at the iterate
  mutable ElasticStrains elastic;               ///< there, with the step's plastic strain
  Prediction prediction;
  Forces forces;
  ContactActivity contacts;
  System system;
  NewtonMeasures newton;
  EnergySums energies;
  Scratch scratch;
  SolverHistory history;
  bool is_state_changed = false;  ///< the state may be another than the committed one

  bool is_newton() const { return prediction.is_static || model.params.iteration == Iteration::newton; }
  bool is_explicit() const {
    return !prediction.is_static && model.params.integrator == Integrator::symplectic_euler;
  }
  /// Do contacts change within a step?
  bool has_implicit_contact() const { return model.params.solves_contact() && !prediction.is_static; }
  Strained strained() const { return strained(*plastic_strain); }
  Strained strained(const TensorField& strain) const {
    return {model, materials, kinematics, strain, forces.volume, elastic.arrays()};
  }
  StepContacts step_contacts(std::span<const PointStiffness> list) const { return {list, committed.x}; }
};

/// At rest as it was made.
SolidState make_rest_state(const Model& model);

}  // namespace argil::solid
