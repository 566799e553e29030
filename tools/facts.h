// tools/facts.h - the result of a command as named values. Its text and its JSON come from the same statements:
//
//   Report report;
//   Facts lens = report.in("lens");
//   lens.line("lens     {}: focal length {:.2f} px, +- {:.2f} px\n", fact("model", lens.model),
//             fact("focal", focal_px, "px", sigma_px), sigma_px);
//
// prints "lens     LENSMODEL_OPENCV5: focal length ..." and gives
//   "data": { "lens": { "model": "LENSMODEL_OPENCV5", "focal": { "value": 3000, "unit": "px", "sigma": 0.2 } } }
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/files/json_file.h"
#include "burin/base/input_error.h"

namespace burin {

/// A named value of a command's result. Text shows the value, with the format of its place.
template <typename T>
struct Fact {
  const char* name;  ///< key in JSON, snake_case
  T value;
  const char* unit;  ///< "mm", "px"; empty: a number without unit, a text
  std::optional<double> sigma;
};

template <typename T>
Fact<T> fact(const char* name, T value, const char* unit = "", std::optional<double> sigma = std::nullopt) {
  return {name, std::move(value), unit, sigma};
}

class Report;

/// One object of a report's data, and the text behind it. Valid as long as the report.
class Facts {
 public:
  /// Adds to the text, and the facts among the values to the data. The text ends with its own line break.
  template <typename... T>
  void line(fmt::format_string<T...> format, T&&... values) {
    (take(values), ...);
    add_text(fmt::format(format, std::forward<T>(values)...));
  }

  /// Adds a value to the data alone: { "value", "unit", "sigma" } with a unit or sigma, else the value itself.
  void set(const std::string& name, Json value, const std::string& unit = "", Json sigma = nullptr);

  /// The object `name` within this one.
  Facts in(const std::string& name) const;

  /// A new object at the end of the list `name` within this one.
  Facts add(const std::string& name) const;

 private:
  friend class Report;
  Facts(Report& report, Json::json_pointer at) : report_(&report), at_(std::move(at)) {}

  template <typename T>
  void take(const T&) {}  // a value for the text alone, such as a sigma
  template <typename T>
  void take(const Fact<T>& fact) {
    set(fact.name, fact.value, fact.unit, fact.sigma ? Json(*fact.sigma) : Json());
  }
  void add_text(const std::string& text);

  Report* report_;
  Json::json_pointer at_;
};

/// Result of a command.
class Report {
 public:
  Facts all() { return {*this, Json::json_pointer()}; }
  Facts in(const std::string& name) { return all().in(name); }
  Facts add(const std::string& list) { return all().add(list); }
  template <typename... T>
  void line(fmt::format_string<T...> format, T&&... values) {
    all().line(format, std::forward<T>(values)...);
  }

  Json data = Json::object();
  std::string text;                            ///< for people; lines
  std::vector<std::vector<std::string>> next;  ///< further commands that run as they are: { "burin", "plan", ... }
  std::optional<InputError> failure;           ///< the result exists, and the command fails all the same
};

}  // namespace burin

template <typename T>
struct fmt::formatter<burin::Fact<T>> : fmt::formatter<T> {
  template <typename Context>
  auto format(const burin::Fact<T>& fact, Context& context) const {
    return fmt::formatter<T>::format(fact.value, context);
  }
};
