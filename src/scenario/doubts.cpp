#include "scenario/doubts.h"

#include <sstream>

#include "scenario/strain_models.h"

namespace argil::scenario {
namespace {

// Clay at the liquid limit and steel, with room to spare.
constexpr double kSoftest = 100.0;  // [Pa]
constexpr double kStiffest = 1e12;  // [Pa]
constexpr double kLargestYieldStrain = 1.0;
constexpr double kLeastStrength = 10.0;  // [Pa]
// Of the contact's stiffness over Young's modulus. The chosen one is tens of moduli a cell, and cells are
// from tens of micrometres to decimetres; a pair's is about a modulus times a cell.
constexpr double kLeastPressureStiffness = 10.0;   // [1/m]
constexpr double kLargestPressureStiffness = 1e8;  // [1/m]
constexpr double kLeastPairStiffness = 1e-6;       // [m]
constexpr double kLargestPairStiffness = 100.0;    // [m]

class Doubts {
 public:
  explicit Doubts(const Scenario& s) : m_file(s.file) {}
  void add(const std::string& pointer, const std::string& problem, const std::string& remedy) {
    list.push_back(m_file + ": " + pointer + ": " + problem + "; " + remedy);
  }
  std::vector<std::string> list;

 private:
  std::string m_file;
};

std::string print(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void doubt_supports(const Scenario& s, Doubts& doubts) {
  if (!s.body.fixed.empty()) return;
  doubts.add("/body/fixed", "is empty: nothing holds the body, and it moves away from the tool",
             "hold its foot, for instance by [{\"kind\": \"half_space\", \"normal\": [0, 0, 1], "
             "\"offset_m\": 0.005}]");
}

void doubt_moduli(const Scenario& s, Doubts& doubts) {
  const double E = s.params.elastic.youngs_modulus;
  if (E >= kSoftest && E <= kStiffest) return;
  const bool is_soft = E < kSoftest;
  doubts.add(
      "/material/youngs_modulus_Pa",
      print(E) + " Pa is " + (is_soft ? "softer" : "stiffer") + " than anything solid; clay has 1e4 to 1e8",
      is_soft ? "write " + print(E) + " kPa as " + print(1e3 * E) + ", MPa as " + print(1e6 * E)
              : "give it in pascals");
}

void doubt_flow(const Scenario& s, Doubts& doubts) {
  const material::Plasticity& flow = s.params.plasticity;
  if (!flow.enabled) return;
  const std::string place = "/material/plasticity/";
  if (flow.yield > kLargestYieldStrain)
    doubts.add(place + "yield",
               print(flow.yield) + " is a strain that clay never has, so that it does not flow",
               "a strength of " + print(flow.yield) +
                   " Pa is written strength_Pa in its place; yield strains are about 0.01");
  if (flow.strength > 0.0 && flow.strength < kLeastStrength)
    doubts.add(place + "strength_Pa", print(flow.strength) + " Pa is that of a soup",
               flow.strength < kLargestYieldStrain
                   ? "a yield strain of " + print(flow.strength) + " is written yield, with creep_per_s"
                   : "clay has thousands of pascals; " + print(flow.strength) + " kPa is " +
                         print(1e3 * flow.strength));
  if (flow.strength > s.params.elastic.youngs_modulus)
    doubts.add(place + "strength_Pa",
               print(flow.strength) + " Pa is more than Young's modulus, so that the clay does not flow",
               "give both in pascals; the modulus of clay is 50 to 200 strengths");
  const bool is_by_rate = flow.form != material::FlowForm::j2;
  const bool flows = is_by_rate && flow.creep_per_s > 0.0;
  if (is_by_rate && flow.yield > 0.0 && !flows)
    doubts.add(place + "creep_per_s", "is 0, so that clay past its yield strain does not flow",
               "give for instance 20, or strength_Pa in the place of yield");
  if (flows && !(flow.max > 0.0) &&
      find_law(s.params.solid.model).plastic_split == solid::PlasticSplit::additive)
    doubts.add(place + "max",
               "is 0: without a cap the clay turns inside out near a plastic strain of 1.2 in this model",
               "give 0.5, or strength_Pa in the place of yield, which needs no cap");
}

void doubt_contact(const Scenario& s, Doubts& doubts) {
  const contact::ContactParams& c = s.params.contact;
  const double E = s.params.elastic.youngs_modulus;
  const auto is_within = [&](double stiffness, double low, double high) {
    return !(stiffness > 0.0) || (stiffness >= low * E && stiffness <= high * E);
  };
  if (c.law == contact::ContactLaw::pressure) {
    if (is_within(c.pressure_stiffness, kLeastPressureStiffness, kLargestPressureStiffness)) return;
    doubts.add("/contact/stiffness_Pa_per_m",
               print(c.pressure_stiffness) + " Pa/m is out of reason beside a modulus of " + print(E) + " Pa",
               "leave it out: it is then chosen, about 80 moduli a cell");
    return;
  }
  if (!is_within(c.vertex_face_stiffness, kLeastPairStiffness, kLargestPairStiffness))
    doubts.add(
        "/contact/vertex_face_stiffness_N_per_m",
        print(c.vertex_face_stiffness) + " N/m is out of reason beside a modulus of " + print(E) + " Pa",
        "give about the modulus times a cell's size, or leave the pairs' law for pressure");
}

}  // namespace

std::vector<std::string> list_doubts(const Scenario& s) {
  Doubts doubts(s);
  doubt_moduli(s, doubts);
  if (s.mode == Mode::dynamic) {
    doubt_supports(s, doubts);
    doubt_flow(s, doubts);
    doubt_contact(s, doubts);
  }
  return doubts.list;
}

}  // namespace argil::scenario
