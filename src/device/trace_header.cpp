#include <cmath>
#include <span>

#include "base/error.h"
#include "base/hash.h"
#include "device/csv.h"
#include "device/trace_parser.h"
#include "device/trace_units.h"

namespace argil::device::internal {
namespace {

std::vector<double> header_numbers(const Parser& parser, std::size_t line, std::string_view value,
                                   std::size_t count) {
  std::vector<double> numbers;
  std::size_t at = 0;
  while ((at = value.find_first_not_of(" \t,", at)) != std::string_view::npos) {
    const std::size_t end = std::min(value.find_first_of(" \t,", at), value.size());
    const auto number = find_number(value.substr(at, end - at));
    if (!number || !std::isfinite(*number)) break;
    numbers.push_back(*number);
    at = end;
  }
  if (numbers.size() != count || at != std::string_view::npos)
    throw InputError(parser.file, parser.place(line),
                     quote(value) + " is not " + std::to_string(count) + " finite numbers",
                     "separate numbers by blanks");
  return numbers;
}

Quat header_rotation(const Parser& parser, std::size_t line, std::string_view value) {
  const std::vector<double> q = header_numbers(parser, line, value, 4);
  const Quat rotation(q[3], q[0], q[1], q[2]);
  constexpr double kMaxUnitError = 1e-3;
  if (!(std::abs(rotation.norm() - 1.0) <= kMaxUnitError))
    throw InputError(parser.file, parser.place(line), "rotation " + quote(value) + " is not of unit length",
                     "give x y z w with norm 1");
  return make_unit(rotation);
}

void read_header_entry(Parser& parser, std::size_t line, std::string_view key, std::string_view value) {
  RawTrace& raw = parser.raw;
  if (key == "device") {
    raw.device = value;
  } else if (key == "units") {
    if (!find_length_unit(value))
      throw InputError(parser.file, parser.place(line), "unit of length " + quote(value),
                       "use m, cm, mm or um");
    parser.header_unit = value;
  } else if (key == "rate_hz") {
    raw.rate_hz = header_numbers(parser, line, value, 1)[0];
    if (!(raw.rate_hz > 0.0))
      throw InputError(parser.file, parser.place(line), "rate " + std::string(value) + " Hz",
                       "give a positive rate");
  } else if (key == "device_to_world_scale") {
    raw.device_to_world.scale = header_numbers(parser, line, value, 1)[0];
    if (!(raw.device_to_world.scale > 0.0))
      throw InputError(parser.file, parser.place(line), "scale " + std::string(value),
                       "give a positive scale");
  } else if (key == "device_to_world_rotation_xyzw") {
    raw.device_to_world.rotation = header_rotation(parser, line, value);
  } else if (key == "device_to_world_translation_m") {
    const std::vector<double> v = header_numbers(parser, line, value, 3);
    raw.device_to_world.translation = Vec3(v[0], v[1], v[2]);
  } else if (key == "sha256") {
    parser.body_sha256 = value;
  } else {
    throw InputError(parser.file, parser.place(line), "unknown header key " + quote(key),
                     "known: device, units, rate_hz, device_to_world_scale, device_to_world_rotation_xyzw, "
                     "device_to_world_translation_m, sha256");
  }
}

}  // namespace

void read_header_line(Parser& parser, std::size_t line, std::string_view comment, bool& ours) {
  const std::size_t colon = comment.find(':');
  const std::string_view key = trim(comment.substr(0, std::min(colon, comment.size())));
  const std::string_view value =
      colon == std::string_view::npos ? std::string_view() : trim(comment.substr(colon + 1));
  if (line == 1 && key == "argil-trace") {
    if (value != "1")
      throw InputError(parser.file, parser.place(line), "format version " + quote(value),
                       "this program reads version 1");
    ours = true;
    parser.raw.is_time_given = true;  // the format's unit is s
  } else if (ours) {
    if (colon == std::string_view::npos)
      throw InputError(parser.file, parser.place(line), "header line without ':'", "write '# key: value'");
    read_header_entry(parser, line, key, value);
  }
}

void check_body(const Parser& parser, std::string_view body) {
  const std::string& stated = parser.body_sha256;
  if (stated.empty() || stated.find_first_not_of('-') == std::string::npos)
    return;  // "---…": recorder was killed
  const std::string found = Sha256().add(std::as_bytes(std::span(body))).hex_digest();
  if (found != stated)
    throw InputError(parser.file, "header", "sha256 " + stated + " but the body has " + found,
                     "the file was changed after it was recorded; restore it, or remove the sha256 line");
}

}  // namespace argil::device::internal
