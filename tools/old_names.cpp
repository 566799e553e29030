#include "tools/old_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "burin/base/files/table.h"
#include "tools/output_mode.h"

namespace burin {
namespace {

constexpr OldName kOldNames[] = {
    {"calibrate", "--camera-as-seed", "--free", "lens"},
    {"capture", "--light", "--lamp"},
    {"design", "--scratches", "--count"},
    {"design", "--tolerance-mm", "--tolerance"},
    {"design", "--carve-hours", "--carve-time", "", "h"},
    {"design", "--drop-count", "--drop-share"},
    {"design", "--free-width", "--free", "width"},
    {"design", "--free-depth", "--free", "depth"},
    {"design", "--free-alpha", "--free", "alpha"},
    {"lens", "--square-mm", "--square"},
    {"loop", "--again", "--force"},
    {"loop", "--keep", "--allow-stale"},
    {"loop", "--accept-unknown", "--allow-undetermined"},
    {"new", "--scratches", "--count"},
    {"plan", "--camera-as-seed", "--free", "lens"},
    {"plan", "--focus-mm", "--focus"},
    {"probe", "--ball-mm", "--ball"},
    {"refine", "--keep-lamp", "--fix", "lamp"},
    {"refine", "--pixel-mm", "--pixel"},
    {"render", "--light", "--lamp"},
    {"render", "--seconds", "--duration"},
    {"sheet", "--focus-mm", "--focus"},
    {"simulate", "--views", "--view"},
    {"toolpath", "--keep-order", "--order", "keep"},
    {"watch", "--light", "--lamp"},
};

const OldName* old_name(std::string_view command, std::string_view word) {
  const auto is = [&](const OldName& name, std::string_view of) { return word == name.old_name && name.command == of; };
  for (const OldName& name : kOldNames) {
    if (is(name, command)) return &name;
    for (const char* forwarded : {"design", "toolpath", "capture"})
      if (command == "loop" && is(name, forwarded)) return &name;
  }
  return nullptr;
}

std::string with_unit(const OldName& name, const std::string& value) {
  return *name.unit != 0 && number_in(value) ? value + name.unit : value;
}

}  // namespace

void replace_old_names(const std::string& command, std::size_t behind, std::vector<std::string>& arguments) {
  for (std::size_t i = behind; i < arguments.size() && arguments[i] != "--"; ++i) {
    const std::size_t equals = std::min(arguments[i].find('='), arguments[i].size());
    const OldName* name = old_name(command, std::string_view(arguments[i]).substr(0, equals));
    if (name == nullptr) continue;
    const std::string value = *name->value == 0 ? "" : std::string(" ") + name->value;
    tell({FindingCode::old_name,
          Finding::Severity::note,
          {},
          fmt::format("{} is called {}{} now", name->old_name, name->new_name, value),
          "the old name works until the next version",
          name->old_name});
    if (*name->value != 0) {
      arguments[i] = std::string(name->new_name) + "=" + name->value;
    } else if (equals < arguments[i].size()) {
      arguments[i] = std::string(name->new_name) + "=" + with_unit(*name, arguments[i].substr(equals + 1));
    } else {
      arguments[i] = name->new_name;
      if (i + 1 < arguments.size()) arguments[i + 1] = with_unit(*name, arguments[i + 1]);
    }
  }
}

NamedValues with_new_name(const std::string& command, const std::string& name, std::vector<std::string> values) {
  const OldName* old = old_name(command, "--" + name);
  if (old == nullptr) return {name, std::move(values)};
  for (std::string& value : values) value = with_unit(*old, value);
  if (*old->value != 0) values.emplace_back(old->value);
  return {std::string(old->new_name).substr(2), std::move(values)};
}

}  // namespace burin
