#include "burin/optimize/write_measured_machine.h"

#include <system_error>

#include "burin/base/error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/named_paths.h"
#include "burin/optimize/machine_measured_json.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/toml_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// The first unused name next to `file`: machine.json.former, machine.json.former-2, ...
fs::path former_name(const fs::path& file) {
  fs::path out = file;
  out += ".former";
  for (int i = 2; fs::exists(out); ++i) {
    out = file;
    out += ".former-" + std::to_string(i);
  }
  return out;
}

Json content_of(const std::string& machine, const fs::path& out) {
  if (!fs::exists(machine)) {
    (void)machine_profile(machine);  // throws Error with the built-in names for an unknown one
    return {{"format", "burin/machine"}, {"version", 1}, {"name", out.stem().string()}, {"based_on", machine}};
  }
  (void)read_machine_profile(machine);
  if (fs::path(machine).extension() == ".toml") return read_toml(machine, "burin/machine", 1).content;
  return read_json(machine, "burin/machine", 1);
}

}  // namespace

std::optional<fs::path> write_measured_machine(const std::string& machine, const MachineMeasured& measured,
                                               const fs::path& out) {
  if (out.extension() != ".json")
    fail(out.string(), "is no .json file", "name one: comments of a TOML file would be lost");
  std::error_code unknown;
  const bool in_place = fs::exists(machine) && fs::equivalent(machine, out, unknown);
  if (!in_place && fs::exists(out))
    fail(out.string(), "is there already", "name another file, or give it as --machine to be brought up to date");
  Json json = content_of(machine, out);
  const DepthTable table = measured_table(measured);
  if (!table.rows.empty() && machine_profile(machine).depth_by != DepthBy::fixed_z) {
    json["depth_table"] = Json::array();
    for (const DepthStep& row : table.rows) json["depth_table"].push_back({row.depth_um, row.command, row.sigma_um});
  }
  json["measured"] = measured_json(measured);
  std::optional<fs::path> former;
  FilesTogether all;
  if (in_place) {
    allow_change_of(out);
    former = former_name(out);
    copy_whole(out, *former);
  }
  write_file(json_text(json, out), out, Durability::on_disk,
             [](const fs::path& file) { (void)read_machine_profile(file); });
  all.put();
  return former;
}

}  // namespace burin
