// Writes the tables of results/verification: argil_solid_tables FOLDER. Each is one CSV, a line a
// computation.
#include <algorithm>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "solid_cases.h"

namespace argil::verification {
namespace {

using solid::ElementKind;
using solid::Integrator;
using solid::Iteration;
using solid::StrainModel;

constexpr std::pair<ElementKind, const char*> kElements[] = {
    {ElementKind::p1, "p1"}, {ElementKind::p1_nodal, "p1_nodal"}, {ElementKind::p2, "p2"}};
constexpr std::pair<Integrator, const char*> kIntegrators[] = {
    {Integrator::backward_euler, "backward_euler"},
    {Integrator::bdf2, "bdf2"},
    {Integrator::newmark, "newmark"},
    {Integrator::symplectic_euler, "symplectic_euler"}};

/// A table that also shows on the terminal how far it is.
class Table {
 public:
  Table(const std::string& folder, const std::string& name, const std::string& head)
      : m_name(name), m_file(folder + '/' + name + ".csv") {
    m_file << head << '\n' << std::setprecision(8);
  }
  template <typename... Values>
  void add(const Values&... values) {
    const char* between = "";
    ((m_file << between << values, between = ","), ...);
    m_file << std::endl;
    std::cerr << m_name << ' ';
    ((std::cerr << values << ' '), ...);
    std::cerr << '\n';
  }

 private:
  std::string m_name;
  std::ofstream m_file;
};

void make_beams(const std::string& folder) {
  Table cantilever(folder, "cantilever", "element,cells,deflection_m,timoshenko_m");
  Table torsion(folder, "torsion", "element,cells,constant,saint_venant");
  Table twisted(folder, "twisted_beam", "element,force,cells,tip,literature");
  Table cook(folder, "cook", "element,cells,tip,literature");
  Table cook_strain(folder, "cook_plane_strain", "element,cells,tip,fine");
  const double fine = solve_cook(ElementKind::p2, 0.4999, true, 32);
  for (const auto& [element, name] : kElements) {
    for (const int n : {2, 4, 8, 16}) cook_strain.add(name, n, solve_cook(element, 0.4999, true, n), fine);
    if (element == ElementKind::p1_nodal) continue;  // up to ν = 0.3 it is p1
    const bool is_quadratic = element == ElementKind::p2;
    for (const int n : {1, 2, 4, 8}) {
      if (is_quadratic && n > 4) continue;
      cantilever.add(name, n, solve_cantilever(element, 0.0, n), compute_timoshenko_deflection(0.0));
      if (n < 8) torsion.add(name, 2 * n, solve_torsion(element, 2 * n), kSquareTorsion);
    }
    for (const int n : {1, 2, 4}) {
      twisted.add(name, "along_width", n, solve_twisted_beam(element, TipForce::along_width, n),
                  kTwistedAlongWidth);
      twisted.add(name, "along_thickness", n, solve_twisted_beam(element, TipForce::along_thickness, n),
                  kTwistedAlongThickness);
    }
    for (const int n : {2, 4, 8, 16, 32})
      cook.add(name, n, solve_cook(element, 1.0 / 3.0, false, n), kCookPlaneStress);
  }
}

void make_manufactured(const std::string& folder) {
  Table table(folder, "manufactured", "element,poissons_ratio,cells,l2,h1");
  for (const auto& [element, name] : kElements)
    for (const int n : {2, 4, 8, 16}) {
      if (element == ElementKind::p2 && n > 8) continue;
      const double nu = element == ElementKind::p1_nodal ? 0.45 : 0.3;  // up to 0.3 it is p1
      const FieldErrors errors = solve_manufactured(element, nu, n);
      table.add(name, nu, n, errors.l2, errors.h1);
    }
}

void make_locking(const std::string& folder) {
  Table table(folder, "locking", "element,model,poissons_ratio,deflection_m,reference_m");
  for (const double nu : {0.3, 0.4, 0.45, 0.48, 0.49, 0.495, 0.499, 0.4995, 0.4999}) {
    const double reference = solve_cantilever(ElementKind::p2, nu, 4);
    const auto add = [&, nu = nu](ElementKind element, const char* name, StrainModel model, const char* law) {
      const int n = element == ElementKind::p2 ? 2 : 4;  // equally many nodes
      table.add(name, law, nu, solve_cantilever(element, nu, n, model), reference);
    };
    for (const auto& [element, name] : kElements) add(element, name, StrainModel::linear, "linear");
    add(ElementKind::p1_nodal, "p1_nodal", StrainModel::corotational, "corotational");
    add(ElementKind::p1_nodal, "p1_nodal", StrainModel::neo_hookean, "neo_hookean");
  }
}

void make_time(const std::string& folder) {
  Table swing(folder, "swing", "integrator,steps,error");
  Table spin(folder, "spin", "integrator,iteration,steps_a_turn,energy_drift,momentum_drift");
  for (const auto& [integrator, name] : kIntegrators) {
    for (const int steps : {50, 100, 200, 400, 800}) {
      if (integrator == Integrator::symplectic_euler && steps < 100) continue;
      swing.add(name, steps, solve_swing(integrator, steps));
    }
    for (const Iteration iteration : {Iteration::one, Iteration::newton}) {
      if (integrator == Integrator::symplectic_euler && iteration == Iteration::newton) continue;
      for (const int steps : {25, 50, 100, 200, 400, 800}) {
        const SpinDrift drift = solve_spin(integrator, iteration, steps);
        spin.add(name, iteration == Iteration::one ? "one" : "newton", steps, drift.energy, drift.momentum);
      }
    }
  }
}

}  // namespace
}  // namespace argil::verification

int main(int argc, char** argv) {
  using namespace argil::verification;
  const std::map<std::string, void (*)(const std::string&)> makers = {{"manufactured", make_manufactured},
                                                                      {"beams", make_beams},
                                                                      {"locking", make_locking},
                                                                      {"time", make_time}};
  if (argc < 2) {
    std::cerr << "argil_solid_tables FOLDER [manufactured | beams | locking | time] ...\n";
    return 2;
  }
  const std::vector<std::string> wanted(argv + 2, argv + argc);
  testing::GTEST_FLAG(throw_on_failure) = true;  // a table with a failed solution is none
  testing::InitGoogleTest();
  for (const auto& [name, make] : makers)
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end()) make(argv[1]);
  return 0;
}
