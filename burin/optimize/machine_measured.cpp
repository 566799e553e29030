#include "burin/optimize/machine_measured.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include "burin/optimize/carving/toml_file.h"
#include "burin/optimize/machine_measured_json.h"
#include "burin/optimize/machine_profile.h"
#include "burin/render/error.h"
#include "burin/render/files/files_together.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

std::optional<MeasuredNumber> number(JsonObject& json, const std::string& key, const std::string& sigma_key) {
  if (!json.has(key)) return std::nullopt;
  MeasuredNumber out{json.number(key), json.number(sigma_key)};
  if (out.sigma < 0) json.fail_field(sigma_key, "is negative", "write a standard deviation");
  return out;
}

void put(Json& json, const std::string& key, const std::string& sigma_key, const std::optional<MeasuredNumber>& v) {
  if (!v) return;
  json[key] = v->value;
  json[sigma_key] = v->sigma;
}

// Rows that stand for one or several cells.
struct Pooled {
  double depth_um, weight, command, cells;

  double sigma_um() const { return 1 / std::sqrt(weight); }
};

Pooled together(const Pooled& a, const Pooled& b) {
  const double weight = a.weight + b.weight, cells = a.cells + b.cells;
  return {(a.weight * a.depth_um + b.weight * b.depth_um) / weight, weight,
          (a.cells * a.command + b.cells * b.command) / cells, cells};
}

// The first name beside `file` that nothing has: machine.json.former, machine.json.former-2, ...
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
    (void)machine_profile(machine);  // says what there is, if it is no built-in one
    return {{"format", "burin/machine"}, {"version", 1}, {"name", out.stem().string()}, {"based_on", machine}};
  }
  (void)read_machine_profile(machine);
  if (fs::path(machine).extension() == ".toml") return read_toml(machine, "burin/machine", 1).content;
  return read_json(machine, "burin/machine", 1);
}

}  // namespace

MachineMeasured read_measured(JsonObject json) {
  MachineMeasured out;
  out.coupon = json.integer("coupon");
  out.date = json.text("date");
  out.tool_width_um = json.positive("tool_width_um");
  out.usual_feed_mm_min = json.positive("usual_feed_mm_min");
  out.usual_spacing_mm = json.positive("usual_spacing_mm");
  for (JsonObject& item : json.objects("cells")) {
    MeasuredCell cell;
    cell.command = item.number("command");
    cell.feed_mm_min = item.positive("feed_mm_min");
    cell.spacing_mm = item.positive("spacing_mm");
    cell.fans = item.integer("fans");
    cell.depth_um = number(item, "depth_um", "depth_sigma_um");
    cell.alpha = number(item, "alpha", "alpha_sigma");
    item.finish();
    out.cells.push_back(cell);
  }
  if (json.has("repeat")) {
    JsonObject repeat = json.object("repeat");
    out.repeat_depth = number(repeat, "depth", "depth_sigma");
    out.repeat_alpha = number(repeat, "alpha", "alpha_sigma");
    repeat.finish();
  }
  if (json.has("wear")) {
    JsonObject wear = json.object("wear");
    out.wear_over_mm = wear.positive("over_mm");
    out.wear_depth = number(wear, "depth", "depth_sigma");
    out.wear_alpha = number(wear, "alpha", "alpha_sigma");
    wear.finish();
  }
  if (json.has("travel")) {
    JsonObject travel = json.object("travel");
    out.travel_depth = number(travel, "depth", "depth_sigma");
    out.travel_towards_deg = travel.number("towards_deg");
    travel.finish();
  }
  json.finish();
  return out;
}

Json measured_json(const MachineMeasured& m) {
  Json json = {{"coupon", m.coupon},
               {"date", m.date},
               {"tool_width_um", m.tool_width_um},
               {"usual_feed_mm_min", m.usual_feed_mm_min},
               {"usual_spacing_mm", m.usual_spacing_mm},
               {"cells", Json::array()}};
  for (const MeasuredCell& cell : m.cells) {
    Json item = {{"command", cell.command},
                 {"feed_mm_min", cell.feed_mm_min},
                 {"spacing_mm", cell.spacing_mm},
                 {"fans", cell.fans}};
    put(item, "depth_um", "depth_sigma_um", cell.depth_um);
    put(item, "alpha", "alpha_sigma", cell.alpha);
    json["cells"].push_back(std::move(item));
  }
  if (m.repeat_depth || m.repeat_alpha) {
    json["repeat"] = Json::object();
    put(json["repeat"], "depth", "depth_sigma", m.repeat_depth);
    put(json["repeat"], "alpha", "alpha_sigma", m.repeat_alpha);
  }
  if (m.wear_depth || m.wear_alpha) {
    json["wear"] = {{"over_mm", m.wear_over_mm}};
    put(json["wear"], "depth", "depth_sigma", m.wear_depth);
    put(json["wear"], "alpha", "alpha_sigma", m.wear_alpha);
  }
  if (m.travel_depth) {
    json["travel"] = {{"towards_deg", m.travel_towards_deg}};
    put(json["travel"], "depth", "depth_sigma", m.travel_depth);
  }
  return json;
}

DepthTable measured_table(const MachineMeasured& measured) {
  std::vector<Pooled> rows;
  for (const MeasuredCell& cell : measured.cells)
    if (cell.depth_um && cell.depth_um->sigma > 0 && cell.feed_mm_min == measured.usual_feed_mm_min &&
        cell.spacing_mm == measured.usual_spacing_mm)
      rows.push_back({cell.depth_um->value, std::pow(cell.depth_um->sigma, -2), cell.command, 1});
  // The coupon's cells are softest first. What falls is taken together with its neighbor.
  for (std::size_t i = 0; i + 1 < rows.size();) {
    const Pooled &a = rows[i], &b = rows[i + 1];
    if (b.depth_um > a.depth_um) {
      ++i;
      continue;
    }
    constexpr double kBeyondChance = 2;
    if (a.depth_um - b.depth_um > kBeyondChance * std::hypot(a.sigma_um(), b.sigma_um())) return {};
    rows[i] = together(a, b);
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    if (i > 0) --i;
  }
  DepthTable out;
  if (rows.size() < 2) return out;
  for (const Pooled& row : rows) out.rows.push_back({row.depth_um, row.command, row.sigma_um()});
  return out;
}

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
    former = former_name(out);
    copy_whole(out, *former);
  }
  write_file(json_text(json, out), out, Durability::on_disk,
             [](const fs::path& file) { (void)read_machine_profile(file); });
  all.put();
  return former;
}

}  // namespace burin
