#include "tools/loop/printed_sheet.h"

#include <fmt/format.h>

#include <optional>
#include <sstream>

#include "burin/base/error.h"
#include "tools/content_hash.h"
#include "tools/loop/record.h"
#include "tools/version.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

fs::path sheet_record(const Project& project) { return project.folder / "made" / "sheet.json"; }

std::string place_text(const Eigen::Vector3d& p_mm) {
  return fmt::format("{:.1f} {:.1f} {:.1f}", p_mm.x(), p_mm.y(), p_mm.z());
}

// People cannot use a drawing with higher accuracy.
bool is_same_place(const std::string& a, const std::string& b) {
  constexpr double kSame_mm = 5;
  Eigen::Vector3d p, q;
  std::istringstream in_a(a), in_b(b);
  return in_a >> p.x() >> p.y() >> p.z() && in_b >> q.x() >> q.y() >> q.z() && (p - q).norm() < kSame_mm;
}

constexpr const char* kScratches = "scratches";

// Returns the values on a sheet, by name.
OptionTexts shown_on_sheet(const WantedBench& wanted) {
  OptionTexts out;
  for (const DesignView& view : wanted.design.views) {
    out["view \"" + view.view + "\""] =
        place_text(find_view(wanted.bench, view.view, "the design").T_camera_board.inverse().translation());
    for (const std::string& id : light_names(view.light))
      if (const Light light = find_light(wanted.bench, id, "the design"); light.is_near())
        out["lamp \"" + id + "\""] = place_text(light.position_mm);
  }
  if (!wanted.scratches.empty()) out[kScratches] = content_hash(wanted.scratches);
  return out;
}

}  // namespace

void record_sheet(const Project& project, const WantedBench& wanted, const std::vector<fs::path>& files) {
  MadeRecord record;
  record.stage = "sheet";
  record.status = MadeRecord::Status::done;
  record.burin = version();
  record.options = shown_on_sheet(wanted);
  for (const fs::path& file : {wanted.board_file, wanted.bench_file, wanted.scratches})
    if (!file.empty()) record.inputs[path_in_project(project.folder, file)] = content_hash(file);
  for (const fs::path& file : files) record.outputs[path_in_project(project.folder, file)] = content_hash(file);
  write_record(record, sheet_record(project));
}

std::string changed_since_sheet(const Project& project) {
  try {
    const std::optional<MadeRecord> record = read_record(sheet_record(project));
    if (!record) return "";
    std::string out;
    const OptionTexts now = shown_on_sheet(wanted_bench(project));
    for (const auto& [name, text] : now) {
      const auto then = record->options.find(name);
      if (then != record->options.end() &&
          (name == kScratches ? then->second == text : is_same_place(then->second, text)))
        continue;
      out += (out.empty() ? "" : ", ") +
             (name == kScratches ? "the scratches that its photos are planned for" : "the place of " + name);
    }
    return out;
  } catch (const Error&) {  // a file during editing: its next reader reports the error
    return "";
  }
}

}  // namespace burin
