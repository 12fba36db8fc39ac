#include "scenario/probe.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "base/error.h"
#include "base/mandel.h"
#include "contact/penalty.h"
#include "material/effective_medium.h"
#include "material/eshelby.h"
#include "material/plasticity.h"
#include "scenario/json_document.h"
#include "scenario/medium_check.h"
#include "scenario/strain_models.h"
#include "solid/element.h"

namespace argil::scenario {
namespace {

/// One case, read key by key; a key that no one asked for is an error, too.
class Case {
 public:
  Case(const Json& json, std::string place) : m_json(json), m_place(std::move(place)) {
    if (!json.is_object()) throw InputError("probe", m_place, json.dump() + " is not an object", "give {…}");
  }
  double number(const std::string& key, std::optional<double> fallback = {}) {
    const Json* value = find(key, fallback.has_value());
    if (!value) return *fallback;
    if (!value->is_number()) refuse(key, *value, "a number");
    return value->get<double>();
  }
  double not_negative(const std::string& key, const std::string& unit = "") {
    const double value = number(key);
    if (!(value >= 0.0)) refuse_range(key, "[0, ∞)" + (unit.empty() ? "" : " " + unit));
    return value;
  }
  bool flag(const std::string& key, bool fallback) {
    const Json* value = find(key, true);
    if (!value) return fallback;
    if (!value->is_boolean()) refuse(key, *value, "true or false");
    return value->get<bool>();
  }
  std::size_t word(const std::string& key, const std::vector<std::string>& words, std::size_t fallback) {
    const Json* value = find(key, true);
    if (!value) return fallback;
    for (std::size_t i = 0; i < words.size(); ++i)
      if (*value == words[i]) return i;
    std::string list;
    for (const std::string& w : words) list += (list.empty() ? "" : ", ") + w;
    refuse(key, *value, "one of " + list);
  }
  /// Numbers of a list, nested or flat, in order.
  std::vector<double> numbers(const std::string& key, std::size_t count, bool optional = false) {
    const Json* value = find(key, optional);
    std::vector<double> list;
    if (!value) return list;
    const Json entries = value->is_array() ? value->flatten() : Json::object();
    for (const Json& entry : entries)
      if (entry.is_number()) list.push_back(entry.get<double>());
    if (list.size() != count || entries.size() != count)
      refuse(key, *value, std::to_string(count) + " numbers");
    return list;
  }
  Mat3 matrix(const std::string& key) {
    const std::vector<double> a = numbers(key, 9);
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(a.data());
  }
  /// Symmetric tensor: 3×3 or Mandel 6; optional ones are zero. Tells in `as_matrix` which was given.
  Vec6 tensor(const std::string& key, bool optional, bool* as_matrix = nullptr) {
    const Json* value = find(key, optional);
    if (!value) return Vec6::Zero();
    const bool six = value->is_array() && value->flatten().size() == 6;
    if (as_matrix) *as_matrix = !six;
    if (!six) return to_mandel(matrix(key));
    const std::vector<double> a = numbers(key, 6);
    return Eigen::Map<const Vec6>(a.data());
  }
  std::array<Vec3, 4> points(const std::string& key) {
    const std::vector<double> a = numbers(key, 12);
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = Vec3(a[3 * i], a[3 * i + 1], a[3 * i + 2]);
    return p;
  }
  /// Every key must have been asked for.
  void finish() const {
    for (const auto& [key, value] : m_json.items())
      if (!m_asked.contains(key))
        throw InputError("probe", m_place + "." + key, "is not a known key", "keys are: " + list_keys());
  }
  [[noreturn]] void refuse_range(const std::string& key, const std::string& range) const {
    throw InputError("probe", m_place + "." + key, m_json[key].dump() + " is outside " + range,
                     "give a value in that range");
  }

 private:
  const Json* find(const std::string& key, bool optional) {
    m_asked.insert(key);
    if (m_json.contains(key)) return &m_json[key];
    if (!optional) throw InputError("probe", m_place + "." + key, "is missing", "add it");
    return nullptr;
  }
  [[noreturn]] void refuse(const std::string& key, const Json& value, const std::string& wanted) const {
    throw InputError("probe", m_place + "." + key, value.dump() + " is not " + wanted, "give " + wanted);
  }
  std::string list_keys() const {
    std::string list;
    for (const std::string& key : m_asked) list += (list.empty() ? "" : ", ") + key;
    return list;
  }

  const Json& m_json;
  std::string m_place;
  std::set<std::string> m_asked;
};

/// Rows of a matrix as nested lists.
template <class Matrix>
Json to_json(const Matrix& a) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < a.cols(); ++j) row.push_back(a(i, j));
    rows.push_back(row);
  }
  return rows;
}

Json list(const Vec3& a) {
  return {a(0), a(1), a(2)};
}

material::Elastic read_elastic(Case& c) {
  material::Elastic e{c.number("youngs_modulus_Pa"), c.number("poissons_ratio")};
  if (!(e.youngs_modulus > 0.0)) c.refuse_range("youngs_modulus_Pa", "(0, ∞) Pa");
  if (!(e.poissons_ratio > -1.0 && e.poissons_ratio < 0.5)) c.refuse_range("poissons_ratio", "(-1, 0.5)");
  return e;
}

Json probe_effective_medium(Case& c) {
  std::vector<std::string> names;
  for (const auto& scheme : scheme_names()) names.push_back(scheme.second);
  const material::Elastic solid = read_elastic(c);
  material::EffectiveMedium medium;
  medium.fluid_bulk_modulus = c.number("fluid_bulk_modulus_Pa", 0.0);
  medium.fluid_shear_modulus = c.number("fluid_shear_modulus_Pa", 0.0);
  medium.scheme = scheme_names()[c.word("scheme", names, 0)].first;
  medium.aspect = c.number("aspect", 1.0);
  medium.orientation = c.word("orientation", {"random", "aligned"}, 0) == 0 ? material::Orientation::random
                                                                            : material::Orientation::aligned;
  const double phi = c.number("phi");
  if (!(medium.fluid_bulk_modulus >= 0.0)) c.refuse_range("fluid_bulk_modulus_Pa", "[0, ∞) Pa");
  if (!(medium.fluid_shear_modulus >= 0.0)) c.refuse_range("fluid_shear_modulus_Pa", "[0, ∞) Pa");
  if (!(medium.aspect >= 0.0)) c.refuse_range("aspect", "[0, ∞)");
  if (medium.aspect == 0.0 && !(medium.fluid_shear_modulus > 0.0))
    c.refuse_range("aspect", "(0, ∞): a layer without shear modulus has no limit,");
  if (!(phi >= 0.0 && phi <= 1.0)) c.refuse_range("phi", "[0, 1]");
  if (!material::is_supported(medium)) c.refuse_range("scheme", "those that aligned spheroids allow");
  const material::MediumResult result = material::compute_effective_medium(solid, medium, phi);
  constexpr std::array<const char*, 3> kStatus = {"ok", "above_voigt", "not_positive_definite"};
  return {{"bulk_modulus_Pa", result.bulk_modulus},
          {"shear_modulus_Pa", result.shear_modulus},
          {"stiffness_mandel", to_json(result.stiffness)},
          {"status", kStatus[static_cast<std::size_t>(result.status)]},
          {"mode", result.mode}};
}

Json probe_eshelby(Case& c) {
  const double nu = c.number("poissons_ratio");
  const double aspect = c.number("aspect", 1.0);
  if (!(nu > -1.0 && nu < 0.5)) c.refuse_range("poissons_ratio", "(-1, 0.5)");
  if (!(aspect >= 0.0)) c.refuse_range("aspect", "[0, ∞)");
  return {{"eshelby_mandel", to_json(material::compute_eshelby_tensor(nu, aspect))}};
}

Json describe_penalty(const contact::Penalty& penalty) {
  Json intervals = Json::array();
  for (int i = 0; i < penalty.num_intervals; ++i) {
    const contact::Interval& interval = penalty.intervals[static_cast<std::size_t>(i)];
    intervals.push_back({interval.begin, interval.end});
  }
  return {{"intervals", intervals},
          {"integral", list(penalty.integral)},
          {"entry_weights", penalty.weights},
          {"inside_at_end", penalty.inside_at_end}};
}

/// Four moving points, with sizes whose sixth powers, squares of volumes, are numbers, too.
contact::PairPath read_path(Case& c) {
  constexpr double kLargest = 1e50;
  constexpr double kSmallest = 1e-50;
  const contact::PairPath path{c.points("t0"), c.points("t1")};
  double extent = 0.0;
  for (const char* key : {"t0", "t1"})
    for (const Vec3& point : key[1] == '0' ? path.t0 : path.t1) {
      if (!(point.cwiseAbs().maxCoeff() <= kLargest)) c.refuse_range(key, "[-1e50, 1e50] m");
      extent = std::max(extent, (point - path.t0[0]).cwiseAbs().maxCoeff());
    }
  if (!(extent >= kSmallest)) c.refuse_range("t0", "what is computed: points less than 1e-50 m apart");
  return path;
}

Json probe_vertex_face(Case& c) {
  const contact::PairPath path = read_path(c);
  return describe_penalty(contact::compute_vertex_face_penalty(path, c.flag("inside_at_start", false)));
}

Json probe_edge_edge(Case& c) {
  const contact::PairPath path = read_path(c);
  return describe_penalty(contact::compute_edge_edge_penalty(path, c.flag("inside_at_start", false), 0.0));
}

Json probe_polar(Case& c) {
  const Mat3 F = c.matrix("F");
  const Mat3 R = solid::compute_rotation(F);
  return {{"R", to_json(R)}, {"S", to_json(Mat3(R.transpose() * F))}};
}

solid::StrainModel read_strain_model(Case& c) {
  const auto models = strain_model_names();
  std::vector<std::string> names;
  for (const auto& model : models) names.push_back(model.second);
  return models[c.word("model", names, 0)].first;
}

Json probe_element(Case& c) {
  const std::vector<double> rest_list = c.numbers("rest", 12);
  const std::vector<double> deformed_list = c.numbers("deformed", 12);
  const solid::Mat34 rest = Eigen::Map<const solid::Mat34>(rest_list.data());
  const solid::Mat34 deformed = Eigen::Map<const solid::Mat34>(deformed_list.data());
  const material::Elastic e = read_elastic(c);
  const solid::StrainModel model = read_strain_model(c);
  const solid::ElasticLaw& law = find_law(model);
  const Vec6 plastic = c.tensor("plastic_strain", true);
  if (law.plastic_split == solid::PlasticSplit::multiplicative &&
      !(Eigen::SelfAdjointEigenSolver<Mat3>(from_mandel(plastic)).eigenvalues()(0) > -1.0))
    c.refuse_range("plastic_strain",
                   std::string("strains that leave a stretch, eigenvalues above -1, for ") + law.name);
  if (law.plastic_split == solid::PlasticSplit::none && !plastic.isZero(0.0))
    c.refuse_range("plastic_strain", std::string("nothing but zeros for ") + law.name + ", which is elastic");
  const solid::TetGeometry tet = solid::make_tet_geometry(rest);
  if (!(tet.volume > 0.0)) c.refuse_range("rest", "tets of positive volume");
  const solid::PointMotion motion =
      solid::make_motion(model, solid::compute_deformation_gradient(deformed, tet.gradient));
  if (!law.bears_inversion && !(motion.F.determinant() > 0.0))
    c.refuse_range("deformed", std::string("tets of positive volume, all that ") + law.name + " bears");
  const double E = e.youngs_modulus;
  const double nu = e.poissons_ratio;
  const solid::Elasticity elasticity{E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))};
  const solid::Mat34 force = solid::compute_element_force(tet, model, motion, plastic, elasticity);
  const Mat6 C = solid::make_isotropic_stiffness(elasticity.lambda, elasticity.mu);
  const solid::Mat12 stiffness =
      law.is_quadratic ? solid::compute_element_stiffness(tet, motion.R, C)
                       : solid::compute_element_stiffness(
                             tet, solid::compute_positive_tangent(model, motion, plastic, elasticity));
  return {{"force", to_json(Eigen::MatrixXd(force.transpose()))},
          {"energy_J", tet.volume * solid::compute_energy_density(model, motion, plastic, elasticity)},
          {"stiffness", to_json(stiffness)}};
}

Json probe_plastic_update(Case& c) {
  bool as_matrix = true;
  const Vec6 strain = c.tensor("strain", false, &as_matrix);
  const Vec6 plastic = c.tensor("plastic_strain", true);
  material::Plasticity law;
  law.creep_per_s = c.not_negative("creep_per_s", "1/s");
  law.max = c.not_negative("max");
  law.deviatoric = c.flag("deviatoric", false);
  using material::FlowForm;
  constexpr std::array<FlowForm, 4> kForms = {FlowForm::rate, FlowForm::rate_to_yield, FlowForm::literal,
                                              FlowForm::j2};
  law.form = kForms[c.word("form", {"rate", "rate_to_yield", "literal", "j2"}, 0)];
  law.norm = c.word("norm", {"frobenius", "voigt6"}, 0) == 0 ? material::StrainNorm::frobenius
                                                             : material::StrainNorm::voigt6;
  material::FlowPoint point{c.not_negative("yield")};
  Vec6 drive;
  if (const std::vector<double> C = c.numbers("stiffness_mandel", 36, true); !C.empty()) {
    const Mat6 stiffness = Eigen::Map<const Mat6>(C.data());
    if (!(Eigen::LLT<Mat6>(stiffness).info() == Eigen::Success &&
          stiffness.isApprox(stiffness.transpose(), 1e-9)))
      c.refuse_range("stiffness_mandel", "symmetric positive definite matrices");
    drive = material::compute_stress_drive(stiffness * (strain - plastic),
                                           material::compute_shape_stiffness(stiffness));
    point.drive = &drive;
  }
  const Vec6 after =
      material::compute_plastic_strain(strain, plastic, point, law, c.not_negative("step_s", "s"));
  if (as_matrix) return {{"plastic_strain", to_json(from_mandel(after))}};
  return {{"plastic_strain", std::vector<double>(after.data(), after.data() + 6)}};
}

Json probe_clay_kernel(Case& c) {
  material::ClayKernel kernel;
  kernel.k1 = c.not_negative("k1", "1/m");
  kernel.k2 = c.not_negative("k2", "1/m");
  kernel.radius = c.not_negative("radius_m", "m");
  return {{"weight", material::compute_clay_weight(c.not_negative("r_m", "m"), kernel)}};
}

using Kernel = Json (*)(Case&);
constexpr std::array<std::pair<const char*, Kernel>, 8> kKernels = {
    {{"effective_medium", probe_effective_medium},
     {"eshelby", probe_eshelby},
     {"vertex_face", probe_vertex_face},
     {"edge_edge", probe_edge_edge},
     {"polar", probe_polar},
     {"element", probe_element},
     {"plastic_update", probe_plastic_update},
     {"clay_kernel", probe_clay_kernel}}};

}  // namespace

std::string run_probe(const std::string& kernel, const std::string& text) {
  std::string names;
  for (const auto& [name, probe] : kKernels) {
    names += (names.empty() ? "" : ", ") + std::string(name);
    if (kernel != name) continue;
    const Json input = parse_json(text, "standard input");
    if (!input.is_object() || !input.contains("cases") || !input["cases"].is_array() || input.size() != 1)
      throw InputError("standard input", "", "is not {\"cases\": [...]}", "give a list of cases");
    Json results = Json::array();
    for (std::size_t i = 0; i < input["cases"].size(); ++i) {
      Case c(input["cases"][i], "cases[" + std::to_string(i) + "]");
      results.push_back(probe(c));
      c.finish();
    }
    return Json({{"results", results}}).dump() + "\n";
  }
  throw InputError("probe", kernel, "is not a kernel", "choose one of " + names);
}

}  // namespace argil::scenario
