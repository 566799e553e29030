#include "burin/optimize/machine_profile.h"

#include <cmath>

#include "burin/optimize/carving/toml_file.h"
#include "burin/render/error.h"
#include "burin/render/files/json_file.h"

namespace burin {
namespace {

const std::vector<std::string> kScratch{"G0 X{x0} Y{y0}", "G1 Z{z_carve} F{plunge_feed}", "G4 P{dwell_s}",
                                        "G1 X{x1} Y{y1} F{feed}", "G0 Z{z_safe}"};

MachineProfile grbl() {
  MachineProfile machine;
  machine.start = {"G21 G90 G17 G94 G54", "G0 Z{z_safe}"};
  machine.per_scratch = kScratch;
  machine.end = {"G0 Z{z_safe}", "M2"};
  return machine;
}

MachineProfile linuxcnc() {
  MachineProfile machine = grbl();
  machine.name = "linuxcnc";
  machine.dialect = GcodeDialect::linuxcnc;
  // G61: go through the programmed ends exactly instead of rounding them off; no tool or length offsets left over.
  machine.start = {"G21 G90 G17 G94 G54", "G40 G49 G80 G61", "G0 Z{z_safe}"};
  machine.max_lines = 0;
  return machine;
}

MachineProfile marlin() {
  MachineProfile machine;
  machine.name = "marlin";
  machine.dialect = GcodeDialect::marlin;
  // Marlin moves G0 with the last feed it was told, so every line says its own; M400 waits for the queue to drain.
  machine.start = {"G21", "G90", "G0 Z{z_safe} F{rapid_z}"};
  machine.per_scratch = {"G0 X{x0} Y{y0} F{rapid}", "G1 Z{z_carve} F{plunge_feed}", "G4 S{dwell_s}",
                         "G1 X{x1} Y{y1} F{feed}", "G0 Z{z_safe} F{rapid_z}"};
  machine.end = {"G0 Z{z_safe} F{rapid_z}", "M400"};
  return machine;
}

std::optional<MachineProfile> built_in(const std::string& name) {
  if (name == "grbl") return grbl();
  if (name == "linuxcnc") return linuxcnc();
  if (name == "marlin") return marlin();
  return std::nullopt;
}

void read_block(JsonObject& json, const std::string& key, std::vector<std::string>& block) {
  if (!json.has(key)) return;
  const Json& lines = json.raw(key);
  if (!lines.is_array()) json.fail_field(key, "is no array", "write an array of lines, each in double quotes");
  block.clear();
  for (const Json& line : lines) {
    if (!line.is_string() || line.get<std::string>().find('\n') != std::string::npos)
      json.fail_field(key, "has an entry that is not one line of text", "write each line of G-code in double quotes");
    block.push_back(line.get<std::string>());
  }
}

MachineLimits read_limits(JsonObject json) {
  MachineLimits limits;
  const auto length = [&](const char* key, double smallest) {
    const double v = json.number(key, 0);
    if (v != 0 && v < smallest)
      json.fail_field(key, "is " + Json(v).dump(),
                      "write a length in mm of at least " + Json(smallest).dump() + ", or 0 for no limit");
    return v;
  };
  limits.step_mm = length("step_mm", 1e-4);
  limits.shortest_mm = length("shortest_mm", 1e-3);
  limits.longest_mm = length("longest_mm", 1e-3);
  limits.distance_mm = length("min_distance_mm", 1e-4);
  limits.max_overlap = json.number("max_overlap", 0);
  if (limits.max_overlap < 0 || limits.max_overlap > 1)
    json.fail_field("max_overlap", "is no share of a groove",
                    "write a number above 0 and up to 1, or 0 for no limit (no crossings at all: \"max_grooves\": 1)");
  limits.max_grooves = json.integer("max_grooves", 0);
  if (limits.max_grooves < 0)
    json.fail_field("max_grooves", "is negative", "write how many may lie over one place, or 0 for no limit");
  // Both ends move to a step, so a length can be held only if some steps lie between shortest and longest.
  if (limits.longest_mm > 0 && limits.longest_mm < limits.shortest_mm + 2 * limits.step_mm)
    json.fail_field("longest_mm", "leaves no length above shortest_mm",
                    "make it longer than shortest_mm by at least two steps");
  json.finish();
  return limits;
}

MachineProfile read_profile(const Json& content, const std::filesystem::path& file) {
  JsonObject json(content, file.string());
  const std::string base = json.text("based_on", "grbl");
  const std::optional<MachineProfile> known = built_in(base);
  if (!known) json.fail_field("based_on", "is \"" + base + "\"", "write grbl, linuxcnc or marlin");
  MachineProfile machine = *known;
  machine.name = json.text("name", file.stem().string());
  machine.carve_feed_mm_min = json.positive("carve_feed_mm_min", machine.carve_feed_mm_min);
  machine.plunge_feed_mm_min = json.positive("plunge_feed_mm_min", machine.plunge_feed_mm_min);
  machine.rapid_mm_min = json.positive("rapid_mm_min", machine.rapid_mm_min);
  machine.rapid_z_mm_min = json.positive("rapid_z_mm_min", machine.rapid_z_mm_min);
  machine.acceleration_mm_s2 = json.positive("acceleration_mm_s2", machine.acceleration_mm_s2);
  machine.acceleration_z_mm_s2 = json.positive("acceleration_z_mm_s2", machine.acceleration_z_mm_s2);
  machine.safe_z_mm = json.positive("safe_z_mm", machine.safe_z_mm);
  machine.dwell_s = json.number("dwell_s", machine.dwell_s);
  if (machine.dwell_s < 0) json.fail_field("dwell_s", "is negative", "write 0 or a time in seconds");
  machine.decimals = json.integer("decimals", machine.decimals);
  if (machine.decimals < 2 || machine.decimals > 6)
    json.fail_field("decimals", "is " + std::to_string(machine.decimals), "write 2 to 6");
  machine.max_lines = json.integer("max_lines", machine.max_lines);
  if (machine.max_lines != 0 && machine.max_lines < 100)
    json.fail_field("max_lines", "is " + std::to_string(machine.max_lines), "write 0 for no limit, or at least 100");
  machine.force = json.number("force", machine.force);
  if (json.has("limits")) machine.limits = read_limits(json.object("limits"));
  if (json.has("travel_mm")) {
    const Eigen::MatrixXd travel = json.matrix("travel_mm", 2, 2);
    machine.travel = MachineBounds{travel.row(0).transpose(), travel.row(1).transpose()};
    if (!(machine.travel->min_mm.array() < machine.travel->max_mm.array()).all())
      json.fail_field("travel_mm", "is " + to_json(travel).dump(), "write the lower-left, then the upper-right corner");
  }
  read_block(json, "start", machine.start);
  read_block(json, "per_scratch", machine.per_scratch);
  read_block(json, "end", machine.end);
  json.finish();
  return machine;
}

}  // namespace

MachineProfile read_machine_profile(const std::filesystem::path& file) {
  if (file.extension() != ".toml") return read_profile(read_json(file, "burin/machine", 1), file);
  const TomlFile toml = read_toml(file, "burin/machine", 1);
  MachineProfile machine;
  with_line(file, toml, [&] { machine = read_profile(toml.content, file); });
  return machine;
}

MachineProfile machine_profile(const std::string& name_or_file) {
  if (const std::optional<MachineProfile> known = built_in(name_or_file)) return *known;
  if (!std::filesystem::exists(name_or_file))
    fail("machine \"" + name_or_file + "\"", "is neither a built-in profile nor a file",
         "choose grbl, linuxcnc or marlin, or name a burin/machine file");
  return read_machine_profile(name_or_file);
}

double move_time_s(double length_mm, double feed_mm_min, double acceleration_mm_s2) {
  const double speed_mm_s = feed_mm_min / 60;
  const double ramps_mm = speed_mm_s * speed_mm_s / acceleration_mm_s2;  // speeding up and slowing down together
  if (length_mm >= ramps_mm) return length_mm / speed_mm_s + speed_mm_s / acceleration_mm_s2;
  return 2 * std::sqrt(length_mm / acceleration_mm_s2);
}

}  // namespace burin
